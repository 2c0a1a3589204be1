"""The prompt on a terminal: editing, completion, history, interrupts, and the terminal as it was afterwards."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time

import sailor
from sailor import BIN, Case


class Terminal(Case):
    def setUp(self):
        super().setUp()
        self.main, self.other = pty.openpty()
        self.before = termios.tcgetattr(self.other)
        self.seen = ""
        self.addCleanup(os.close, self.main)
        self.addCleanup(os.close, self.other)

    def start(self, *arguments):
        self.process = subprocess.Popen([BIN / "dialog_manager", *arguments], cwd=self.folder, env=sailor.environment(self.folder),
                                        stdin=self.other, stdout=self.other, stderr=self.other, start_new_session=True,
                                        preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)
        self.prompt()

    def size(self, rows, columns):
        fcntl.ioctl(self.other, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def read(self, wait=0.05):
        while select.select([self.main], [], [], wait)[0]:
            self.seen += os.read(self.main, 65536).decode("utf-8", "replace")

    def until(self, pattern):
        deadline = time.monotonic() + sailor.PATIENCE
        while not re.search(pattern, self.plain()):
            self.assertLess(time.monotonic(), deadline, f"no {pattern!r} in {self.seen!r}")
            self.read()

    def plain(self):
        """What was shown, without the sequences that move and colour."""
        return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b[()][A-Z0-9]|\x1b[=>]", "", self.seen).replace("\r", "").replace("\a", "")

    def prompt(self):
        self.until(r"> ?$")

    def type(self, text):
        self.seen = ""
        os.write(self.main, text.encode())

    def say(self, line):
        """Types a line; what is shown until the next prompt."""
        self.type(line + "\r")
        self.until(r"\n(.*\n)*.*> ?$")
        return self.plain()

    def test_commands_answers_and_errors(self):
        self.start("--norc")
        self.say("create node ball")
        self.assertIn("0 0 0", self.say("get ball.position"))
        self.assertRegex(self.say("nonsense"), "error unknown")
        self.assertRegex(self.say("crate node x"), "did you mean .*create")
        self.say("set ball.position 1 2 3")
        self.assertIn("1 2 3", self.say("get ball.position"))

    def test_verbs_may_be_shortened(self):
        self.start("--norc")
        self.say("create node ball")
        self.assertIn("ball", self.say("lis"))

    def test_tab_completes_verbs_paths_fields_and_words(self):
        self.start("--norc")
        for line in ("create node elephant", "type star", "field star.mood word of melancholy merry", "create star sun"):
            self.say(line)
        self.type("rollb\t")
        self.until("rollback")
        self.say("")
        self.type("get eleph\t")
        self.until("get elephant")
        self.type(".posit\t")
        self.until("position")
        self.assertIn("0 0 0", self.say(""))
        self.type("set sun.mood mel\t")
        self.until("melancholy")
        self.say("")
        self.assertIn("melancholy", self.say("get sun.mood"))

    def test_tab_offers_what_the_syntax_names(self):
        self.file("my_scene.dlg", "echo hello\n")
        self.start("--norc")
        for line in ("create node tree", "create node tree/branch", "create camera front"):
            self.say(line)
        for typed, shown in (("source my_\t", "source my_scene.dlg"), ("source follo\t", "source follow.dlg"), ("start wa\t", "start wave"),
                             ("budget er\t", "budget error"), ("pace real\t", "pace realtime"), ("help und\t", "help undo"),
                             ("replay --l\t", "replay --live"), ("at 3s echo\t", "at 3s echo"), ("list tree/\t", "list tree/branch"),
                             ("create cam\t", "create camera"), ("run \t", "run DURATION"), ("describe came\t", "describe camera")):
            with self.subTest(typed):
                self.type(typed)
                self.until(re.escape(shown))
                self.type("\x03")
                self.prompt()

    def test_an_error_is_pointed_at(self):
        self.start("--norc")
        self.say("create node ball")
        shown = self.say("get ball.colour").split("\n")
        self.assertEqual(shown[1].index("^"), shown[0].index("colour") + len("> "), shown)
        self.assertRegex(shown[2], "^<stdin>:2:10: error unknown ")

    def test_an_event_leaves_the_typed_line_alone(self):
        self.start("--norc")
        for line in ("create node ball", "listen ear", "watch ball"):
            self.say(line)
        self.type("echo one two\x1b[D")  # the cursor stands before the last letter
        with open(self.folder / "ear", "w", encoding="utf-8") as ear:
            ear.write("set ball.visible false\n")
        self.until(r"event ball.visible false\n> > echo one two\x08$")  # a carriage return between the marks
        self.assertIn("one twXo", self.say("X"))

    def test_a_wrapped_line_is_taken_off_whole(self):
        self.size(24, 40)
        self.start("--norc")
        self.say("listen ear")
        self.type("echo " + "x" * 100)
        self.until("x{27}$")
        self.seen = ""
        with open(self.folder / "ear", "w", encoding="utf-8") as ear:
            ear.write("echo heard\n")
        self.until("heard")
        self.assertIn("\r\x1b[2A\x1b[J", self.seen)

    def test_letters_of_all_languages(self):
        self.start("--norc")
        self.assertIn("grüße 船乗り", self.say("echo grüße 船乗りX\b").split("\n", 1)[1])

    def test_two_hundred_lines_pasted_at_once(self):
        self.start("--norc")
        self.type("".join(f"create node n{i} position {i} 0 0\r" for i in range(200)) + "echo all of them\r")
        self.until(r"\nall of them\n> ?$")
        self.assertEqual(self.say("list n*").count("\n"), 201)

    def test_long_work_shows_how_far_it_is(self):
        self.start("--norc")
        self.say("pace 2")
        self.type("run 4s\r")
        self.until(r"\[#+\.+\] +\d+ %, \d+ s left")
        self.until(r"\n> ?$|\x1b\[K> ?$|> ?$")
        self.assertRegex(self.say("time"), r"\n4\n")

    def test_an_interrupt_drops_a_continued_line(self):
        self.start("--norc")
        self.type("create node half\\\r")
        self.until(r"\.\.\.> $")
        self.type("\x03")
        self.until(r"\^C\n> $")
        self.assertEqual(self.say("list"), "list\n> ")

    def test_history_is_kept_when_the_session_is_killed(self):
        self.start("--norc")
        self.say("echo remembered_line")
        self.process.kill()
        self.process.wait()
        self.assertIn("echo remembered_line\n", (self.folder / ".dialog_manager_history").read_text())
        self.assertEqual((self.folder / ".dialog_manager_history").stat().st_mode & 0o777, 0o600)

    def test_no_prompt_where_nobody_sees_it(self):
        done = subprocess.Popen([BIN / "dialog_manager", "--norc"], cwd=self.folder, env=sailor.environment(self.folder), stdin=self.other,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(done.kill)
        os.write(self.main, b"echo quietly\nquit\n")
        out, errors = done.communicate(timeout=sailor.PATIENCE)
        self.assertEqual((out, errors), (b"quietly\n", b""))

    def test_history_lasts_from_session_to_session(self):
        self.start("--norc")
        self.say("echo remembered_line")
        self.type("quit\r")
        self.assertEqual(self.process.wait(sailor.PATIENCE), 0)
        self.seen = ""
        self.start("--norc")
        self.type("\x1b[A\x1b[A")
        self.until("remembered_line")

    def test_the_rc_file(self):
        self.file(".dialog_managerrc", "create node from_rc\n")
        self.start()
        self.assertIn("from_rc", self.say("list"))

    def test_interactive_after_scripts(self):
        self.file("scene.dlg", "create node from_scene\n")
        self.start("--norc", "-i", "scene.dlg")
        self.assertIn("from_scene", self.say("list"))

    def test_an_interrupt_drops_the_line(self):
        self.start("--norc")
        self.type("create node half\x03")
        self.until("> ?$")
        self.say("create node whole")
        shown = self.say("list")
        self.assertIn("whole", shown)
        self.assertNotRegex(shown, r"(?m)^half")

    def test_an_interrupt_stops_a_long_run(self):
        self.start("--norc")
        self.say("pace realtime")
        self.type("run 1000\r")
        time.sleep(0.3)
        self.type("\x03")
        self.until("> ?$")
        self.assertRegex(self.say("time"), r"\d")

    def test_end_of_file_ends_it(self):
        self.start("--norc")
        self.type("\x04")
        self.assertEqual(self.process.wait(sailor.PATIENCE), 0)

    def test_the_terminal_is_as_it_was(self):
        for how in ("quit\r", "\x04", signal.SIGTERM, signal.SIGHUP):
            with self.subTest(str(how)):
                self.seen = ""
                self.start("--norc")
                if isinstance(how, str):
                    self.type(how)
                else:
                    self.process.send_signal(how)
                self.process.wait(sailor.PATIENCE)
                self.assertEqual(termios.tcgetattr(self.other)[:4], self.before[:4])
                self.assertTrue(os.get_blocking(self.other), "the terminal was left non-blocking")

    def test_a_long_line_and_a_continued_line(self):
        self.start("--norc")
        self.assertIn("x" * 300, self.say("echo " + "x" * 300).replace("\n", ""))
        self.type("create sphere ball \\\r")
        self.until(">")
        self.say("radius 4cm")
        self.assertIn("0.04", self.say("get ball.radius"))

    def test_output_of_programs_does_not_break_the_prompt(self):
        self.start("--norc")
        self.say("start wave")
        self.say("create wave w")
        self.say("step 3")
        self.assertIn("wave", self.say("manipulators"))


if __name__ == "__main__":
    sailor.main()
