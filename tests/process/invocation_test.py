"""How dialog_manager is started, what it prints where, and with which status it ends."""

import os
import signal
import subprocess

import sailor
from sailor import BIN, Case


class Invocation(Case):
    def check(self, done, status, stdout=None, stderr=None):
        self.assertEqual(done.returncode, status, f"stdout {done.stdout!r}, stderr {done.stderr!r}")
        if stdout is not None:
            self.assertEqual(done.stdout, stdout, done.stderr)
        if stderr is not None:
            self.assertRegex(done.stderr, stderr)

    def check_said(self, done, status, pattern):
        self.assertEqual(done.returncode, status, f"stdout {done.stdout!r}, stderr {done.stderr!r}")
        self.assertRegex(done.stdout, rf"\A{pattern}\Z")

    def test_commands_and_scripts_run_in_the_order_of_the_command_line(self):
        self.file("one.dlg", "create node a\necho one\n")
        self.file("two.dlg", "list\necho two\n")
        done = self.run_manager("-c", "echo zero", "one.dlg", "-c", "create node b", "two.dlg", "-c", "echo end")
        self.check(done, 0, "zero\none\na\nb\ntwo\nend\n", "^$")

    def test_success_says_nothing(self):
        self.check(self.run_manager("-c", "create node a", "-c", "set a.visible false"), 0, "", "^$")

    def test_commands_come_from_a_pipe(self):
        self.check(self.run_manager(stdin=b"create node a\nlist\n"), 0, "a\n", "^$")

    def test_output_to_a_pipe_has_no_prompt_and_no_colour(self):
        done = self.run_manager(stdin=b"create node a\nhelp\nlist\nnonsense\n")
        self.assertNotIn("\x1b", done.stdout + done.stderr)
        self.assertNotRegex(done.stdout, r"(?m)^> ")

    def test_the_first_error_stops_a_batch(self):
        done = self.run_manager(stdin=b"create node a\nnonsense\ncreate node b\nlist\n")
        self.check(done, 1, "", r"(?m)^\S*:2:1: error unknown .*nonsense")

    def test_keep_going_goes_on_and_still_fails(self):
        done = self.run_manager("--keep-going", stdin=b"create node a\nnonsense\ncreate node b\nlist\n")
        self.check(done, 1, "a\nb\n", r"(?m)^\S*:2:1: error unknown .*nonsense")

    def test_an_error_in_a_script_names_file_line_and_column(self):
        self.file("bad.dlg", "create node a\n\n  set a.visible perhaps\ncreate node b\n")
        done = self.run_manager("bad.dlg", "-c", "list")
        self.check(done, 1, "", r"(?m)^bad\.dlg:3:17: error type .*perhaps")

    def test_an_error_in_a_sourced_script_names_that_script(self):
        self.file("inner.dlg", "create node a\ncreate node a\n")
        self.file("outer.dlg", "echo begin\nsource inner.dlg\n")
        done = self.run_manager("outer.dlg")
        self.check(done, 1, "begin\n", r"(?m)^inner\.dlg:2:13: error exists .*\ba\b")

    def test_an_error_in_a_command_stops_before_the_next_script(self):
        self.file("good.dlg", "echo good\n")
        self.check(self.run_manager("-c", "nonsense", "good.dlg"), 1, "", "error unknown")

    def test_usage_errors_end_with_2(self):
        for arguments in (["--nonsense"], ["-c"], ["--seed"], ["--seed", "x"], ["--seed", "-1"], ["--seed", "18446744073709551616"], ["--seed", "0x10"],
                          ["--pace", "sideways"], ["--pace", "1e-300"], ["--pace", "1e300"], ["--journal"]):
            with self.subTest(arguments):
                done = self.run_manager(*arguments)
                self.check(done, 2, "")
                self.assertLess(len(done.stderr.splitlines()), 12, "one clear message, no page of help")
                self.assertTrue(done.stderr.strip())

    def test_a_missing_script_is_an_io_error_or_a_usage_error(self):
        done = self.run_manager("missing.dlg")
        self.assertIn(done.returncode, (1, 2))
        self.assertIn("missing.dlg", done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_a_folder_is_no_script(self):
        done = self.run_manager("-c", "echo before", ".")
        self.assertIn(done.returncode, (1, 2))
        self.assertTrue(done.stderr.strip())

    def test_help_goes_to_standard_output(self):
        done = self.run_manager("--help")
        self.check(done, 0)
        for option in ("--framed", "--keep-going", "--seed", "--journal", "--resume", "--pace", "--check", "-c", "-i", "--norc"):
            self.assertIn(option, done.stdout)

    def test_check_changes_nothing_and_finds_errors(self):
        self.file("good.dlg", "type t\nfield t.x real m\ncreate t a x 4cm\nset a.x 3mm\nsave out.dlg\n")
        self.check(self.run_manager("--check", "good.dlg"), 0)
        self.assertFalse((self.folder / "out.dlg").exists(), "--check wrote a file")
        self.file("bad.dlg", "type t\nfield t.x real m\ncreate t a x 4kg\n")
        self.check(self.run_manager("--check", "bad.dlg"), 1, None, r"(?m)^bad\.dlg:3:14: error unit")
        self.file("verb.dlg", "nonsense\n")
        self.check(self.run_manager("--check", "verb.dlg"), 1, None, r"(?m)^verb\.dlg:1:1: error unknown")

    def test_check_sees_what_is_put_off_and_how_long_it_runs(self):
        for line, place, kind in (("at 1 nonsense", 6, "unknown"), ("run 3kg", 5, "unit"), ("rate 0", 6, "range"),
                                  ("wait a.visible == perhaps", 19, "type"), ("get a.nothing", 7, "unknown"),
                                  ("every 0 echo x", 7, "range"), ("commit", 1, "unknown")):
            self.file("one.dlg", f"create node a\n{line}\n")
            self.check(self.run_manager("--check", "one.dlg"), 1, "", rf"(?m)^one\.dlg:2:{place}: error {kind}")
        self.file("good.dlg", "begin\ncreate node a\nrollback\ncreate node a\nat 1 set a.visible false\nrun 2\nget a\nhash\n"
                              "expect a.visible == false\ntrace t.csv a\njournal j\nquit\n")
        self.check(self.run_manager("--check", "good.dlg"), 0, "")
        self.assertFalse((self.folder / "t.csv").exists() or (self.folder / "j").exists(), "--check wrote a file")

    def test_framed_commands_and_scripts_are_a_batch_and_a_framed_conversation_is_none(self):
        self.check_said(self.run_manager("--framed", "-c", "nonsense", "-c", "echo x"), 1, "error unknown 1 .*\n")
        self.check_said(self.run_manager("--framed", "--keep-going", "-c", "nonsense", "-c", "echo x"), 1, "error unknown 1 .*\n  x\n")
        self.check_said(self.run_manager("--framed", stdin=b"@1 nonsense\n@2 echo x\n"), 1, "@1 error unknown 4 .*\n  x\n@2 ok\n")
        self.file("bad.dlg", "nonsense\necho one\n")
        self.check_said(self.run_manager("--framed", "-i", "bad.dlg", "-c", "echo two", stdin=b"@2 echo x\n"), 1,
                   "error unknown 1 .*\n  x\n@2 ok\n")

    def test_an_error_of_what_took_time_names_the_verb(self):
        self.check_said(self.run_manager("--framed", "--keep-going", stdin=b"create node a\n@12 wait a.visible == false for 0\n"), 1,
                   "@12 error timeout 5 .*\n")

    def test_the_version(self):
        self.check_said(self.run_manager("--version"), 0, r"dialog_manager [0-9.]+\n")

    def test_a_half_line_at_the_end_of_a_pipe_is_not_executed(self):
        done = self.run_manager("--framed", stdin=b"@1 create node a\n@2 create node b")
        self.assertIn("@1 ok\n", done.stdout)
        self.assertNotIn("@2 ok", done.stdout)
        done = self.run_manager("--journal", "kept", stdin=b"create node a\ncreate node b")
        self.assertNotIn("create node b", (self.folder / "kept").read_text())

    def test_a_half_line_at_the_end_of_a_script_is_executed_with_a_warning(self):
        self.file("half.dlg", "create node a\ncreate node b")
        done = self.run_manager("half.dlg", "-c", "list")
        self.check(done, 0, "a\nb\n", r"half\.dlg:2.*warning")

    def test_a_carriage_return_before_the_newline_is_tolerated(self):
        self.file("dos.dlg", "create node a\r\n# comment\r\n\r\nset a.visible false\r\nget a.visible\r\n")
        self.check(self.run_manager("dos.dlg"), 0, "false\n", "^$")

    def test_a_byte_order_mark_is_an_error_or_skipped(self):
        self.file("bom.dlg", b"\xef\xbb\xbfcreate node a\nlist\n")
        done = self.run_manager("bom.dlg")
        self.assertTrue((done.returncode == 0 and done.stdout == "a\n") or (done.returncode == 1 and "bom.dlg:1:1" in done.stderr),
                        f"{done.returncode} {done.stdout!r} {done.stderr!r}")

    def test_standard_input_may_be_a_file_a_folder_dev_null_or_closed(self):
        path = self.file("script.dlg", "create node a\nlist\n")
        with open(path, "rb") as script:
            self.check(self.run_manager(stdin=script), 0, "a\n")
        with open("/dev/null", "rb") as nothing:
            self.check(self.run_manager(stdin=nothing), 0, "")
            self.check(self.run_manager("-c", "echo x", stdin=nothing), 0, "x\n")
        done = self.run_manager("-c", "echo x", preexec_fn=lambda: os.close(0))
        self.check(done, 0, "x\n")
        done = self.run_manager(preexec_fn=lambda: os.close(0))
        self.check(done, 0, "")
        folder = os.open(self.folder, os.O_RDONLY)
        done = self.run_manager(stdin=folder)
        os.close(folder)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertTrue(done.stderr.strip())

    def test_closed_or_full_output_is_reported_and_not_fatal_to_the_machine(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([BIN / "dialog_manager", "-c", "echo x"], cwd=self.folder, stdout=full, stderr=subprocess.PIPE,
                                  stdin=subprocess.DEVNULL, env=sailor.environment(self.folder), timeout=sailor.PATIENCE, check=False)
        self.assertEqual(done.returncode, 1, "writing to a full device is an error")
        done = subprocess.run([BIN / "dialog_manager", "-c", "echo x"], cwd=self.folder, stderr=subprocess.PIPE,
                              stdin=subprocess.DEVNULL, env=sailor.environment(self.folder), timeout=sailor.PATIENCE, check=False,
                              preexec_fn=lambda: os.close(1))
        self.assertGreaterEqual(done.returncode, 0, "ended by a signal")
        # nothing of the output may have landed in a file of the manager's
        done = self.run_manager("--journal", "kept", "-c", "create node a", preexec_fn=lambda: (os.close(0), os.close(1), os.close(2)))
        self.assertGreaterEqual(done.returncode, 0, "ended by a signal")

    def test_runs_from_any_folder_through_a_link(self):
        link = self.folder / "dm"
        link.symlink_to(BIN / "dialog_manager")
        done = subprocess.run([link, "-c", "start wave", "-c", "create wave w", "-c", "step", "-c", "get w.height"], cwd="/",
                              env=sailor.environment(self.folder), capture_output=True, timeout=sailor.PATIENCE, check=False)
        self.assertEqual((done.returncode, done.stdout), (0, b"0.1\n"), done.stderr)

    def test_the_rc_file_is_read_at_the_prompt_only(self):
        self.file(".dialog_managerrc", "create node from_rc\n")
        self.check(self.run_manager(stdin=b"list\n"), 0, "")
        self.check(self.run_manager("-c", "list"), 0, "")

    def test_the_seed_is_told_to_programs(self):
        self.file("show", "#!/bin/sh\nread hello\necho \"$hello\" > heard\necho ready\nwhile read line; do echo done; done\n")
        os.chmod(self.folder / "show", 0o755)
        self.check(self.run_manager("--seed", "77", "-c", "start ./show"), 0)
        self.assertRegex((self.folder / "heard").read_text(), r"^hello protocol=1 name=show seed=77 tick=\S+ ")

    def test_numbers_are_printed_with_a_point_under_a_comma_locale(self):
        locale = "de_DE.UTF-8"
        made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", self.folder / locale], capture_output=True, check=False)
        if made.returncode:
            self.skipTest(f"no German locale: {made.stderr.decode()}")
        environ = sailor.environment(self.folder, LOCPATH=str(self.folder))
        environ["LC_ALL"] = locale
        done = self.run_manager(environ=environ, stdin=b"type t\nfield t.x real\ncreate t a x 0.5\nget a.x\nset a.x 2.5e-320\nget a.x\n"
                                b"set a.x 1.5e-400\nget a.x\nset a.x 1,5\n")
        self.check(done, 1, "0.5\n2.5e-320\n0\n", "error type .*1,5")

    def test_an_interrupted_batch_ends_by_its_signal_or_with_failure(self):
        process = subprocess.Popen([BIN / "dialog_manager", "-c", "echo begun", "-c", "pace realtime", "-c", "run 1000"],
                                   cwd=self.folder, env=sailor.environment(self.folder), stdout=subprocess.PIPE,
                                   stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), b"begun\n")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=sailor.PATIENCE)
        self.assertIn(process.returncode, (1, 130, -signal.SIGINT))


if __name__ == "__main__":
    sailor.main()
