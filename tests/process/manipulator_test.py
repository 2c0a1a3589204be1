"""Programs that die, hang, lie or flood: told as events, never fatal, and the world ends as if nothing had happened."""

import os
import pathlib
import signal
import time

import sailor
from sailor import Case, alive, children, descendants, until, zombies


class Walkers(Case):
    """Runs of the walker, to be compared with an undisturbed one."""

    TICKS = 40

    def walk(self, *arguments, ticks=None):
        """A manager with the walker (told these arguments), run for a while: manager and hash."""
        manager = self.manager("--seed", "3")
        manager.must("create node probe")
        manager.must("start walker" + ("".join(" " + word for word in ("--", *arguments)) if arguments else ""))
        manager.must("create walker w")
        manager.must("create walker v reach 0.5")
        manager.must(f"step {ticks or self.TICKS}", timeout=60)
        return manager, manager.hash()

    def undisturbed(self):
        manager, expected = self.walk()
        manager.end()
        (self.folder / "fault.done").unlink(missing_ok=True)
        return expected

    def assert_no_trace(self, manager):
        """The manager has exactly its one program, no zombie, and ends cleanly with all its children."""
        until(lambda: not zombies(manager.pid), "zombies")
        everything = descendants(manager.pid)
        self.assertEqual(manager.finish(), 0)
        for pid in everything:
            until(lambda pid=pid: not alive(pid), f"process {pid} outlived the manager")

    def program(self, manager):
        """The process number of the one program."""
        until(lambda: len(children(manager.pid)) == 1, "one child")
        return children(manager.pid)[0]


class Manipulators(Walkers):
    def test_a_killed_or_hanging_program_leaves_no_trace_in_the_world(self):
        expected = self.undisturbed()
        for fault in ("kill", "exit", "exit3", "hang", "stop", "close", "half", "deaf"):
            for stage in ("tick", "set", "done", "checkpoint"):
                with self.subTest(f"{fault} at {stage}"):
                    (self.folder / "fault.done").unlink(missing_ok=True)
                    manager, got = self.walk(fault, stage, "17" if stage != "checkpoint" else "0")
                    if stage != "checkpoint" or (self.folder / "fault.done").exists():
                        self.assertTrue((self.folder / "fault.done").exists(), "the fault did not happen")
                        manager.event("walker")
                    self.assertEqual(got, expected)
                    self.assertEqual(manager.must("get w.steps"), str(self.TICKS))
                    self.assert_no_trace(manager)

    def test_a_program_that_talks_nonsense_leaves_no_trace_in_the_world(self):
        expected = self.undisturbed()
        for fault in ("garbage", "usage", "flood", "long", "nul", "foreign", "range", "nan", "unit", "hello", "declare", "ready", "reply",
                      "wrong", "past", "twice", "memory", "done", "done_x", "nonsense"):
            with self.subTest(fault):
                (self.folder / "fault.done").unlink(missing_ok=True)
                manager, got = self.walk(fault, "tick", "17")
                self.assertTrue((self.folder / "fault.done").exists(), "the fault did not happen")
                self.assertEqual(got, expected)
                self.assertEqual(manager.must("get probe.visible"), "true")
                self.assert_no_trace(manager)

    def test_a_program_killed_from_outside_at_random_moments(self):
        expected = self.undisturbed()
        for delay in (0, 0.002, 0.01, 0.03):
            with self.subTest(delay):
                manager = self.manager("--seed", "3")
                for line in ("create node probe", "start walker", "create walker w", "create walker v reach 0.5"):
                    manager.must(line)
                victim = self.program(manager)
                manager.send(f"@run step {self.TICKS}\n".encode())
                time.sleep(delay)
                os.kill(victim, signal.SIGKILL)
                self.assertTrue(manager.answer("run", 60).ok)
                self.assertEqual(manager.hash(), expected)

    def test_a_stopped_program_is_restarted(self):
        expected = self.undisturbed()
        manager = self.manager("--seed", "3")
        for line in ("create node probe", "start walker", "create walker w", "create walker v reach 0.5", "step 10"):
            manager.must(line)
        victim = self.program(manager)
        os.kill(victim, signal.SIGSTOP)
        manager.must(f"step {self.TICKS - 10}", timeout=60)
        self.assertEqual(manager.hash(), expected)
        until(lambda: not alive(victim), "the stopped program is ended")

    def test_what_it_is_asked_while_it_dies_gets_an_answer(self):
        # one that only hangs is waited for: a verb may take its time (a movie takes minutes)
        for fault in ("kill", "exit", "garbage"):
            with self.subTest(fault):
                (self.folder / "fault.done").unlink(missing_ok=True)
                manager = self.manager()
                for line in ("create node probe", f"start walker -- {fault} verb", "create walker w", "step 3"):
                    manager.must(line)
                reply = manager.ask("jump w", timeout=30)
                if not reply.ok:
                    self.assertIn(reply.kind, ("gone", "timeout"), repr(reply))
                manager.must("step 3")
                manager.must("jump w")
                self.assertEqual(manager.must("get w.position"), "0 0 0")

    def test_a_program_that_fails_again_and_again_is_given_up_visibly(self):
        for fault in ("kill!", "exit!", "usage!"):
            with self.subTest(fault):
                manager = self.manager()
                for line in ("create node probe", f"start walker -- {fault} tick", "create walker w"):
                    manager.must(line)
                before = manager.hash()
                began = time.monotonic()
                reply = manager.ask("step", timeout=60)
                self.assertLess(time.monotonic() - began, 30)
                if not reply.ok:
                    self.assertIn(reply.kind, ("gone", "timeout"), repr(reply))
                self.assertRegex(manager.must("manipulators"), "failed|quarantine|ended|stopped")
                self.assertEqual(manager.hash(), before)
                manager.must("set probe.visible false")
                manager.ask("end walker")
                until(lambda manager=manager: not descendants(manager.pid), "its processes are gone")

    def test_a_program_that_fails_before_it_is_ready(self):
        for fault in ("kill", "exit", "exit3", "garbage", "usage", "flood", "nul", "long", "hello", "nonsense", "close"):
            for stage in ("hello", "declare"):
                with self.subTest(f"{fault} at {stage}"):
                    manager = self.manager()
                    manager.must("create node probe")
                    reply = manager.ask(f"start walker -- {fault}! {stage}", timeout=60)
                    if not reply.ok:
                        self.assertIn(reply.kind, ("gone", "timeout", "io", "syntax", "unknown", "limit", "exists"), repr(reply))
                    self.assertEqual(manager.must("get probe.visible"), "true")
                    manager.must("set probe.visible false")
                    manager.must("step", timeout=60) if reply.ok else manager.must("step")
                    manager.end()

    def test_a_program_that_never_gets_ready_times_out(self):
        manager = self.manager()
        manager.must("create node probe")
        reply = manager.ask("start walker -- hang! hello", timeout=60)
        self.assertIn(reply.kind, ("timeout", "gone"), repr(reply))
        manager.must("get probe.visible")
        until(lambda: not descendants(manager.pid), "it is ended")

    def test_missing_and_unsuitable_programs(self):
        manager = self.manager()
        manager.must("create node probe")
        before = manager.hash()
        self.file("plain.txt", "not a program\n")
        self.file("broken", "\x7fELF nonsense\n")
        os.chmod(self.folder / "broken", 0o755)
        self.file("lost", "#!/no/such/interpreter\n")
        os.chmod(self.folder / "lost", 0o755)
        for program in ("no_such_program_here", "./no_such_file", "./plain.txt", "./broken", "./lost", "/etc", "."):
            with self.subTest(program):
                reply = manager.ask(f"start {program}", timeout=30)
                self.assertFalse(reply.ok, "it was started")
                self.assertIn(reply.kind, ("unknown", "io", "gone", "syntax"), repr(reply))
                self.assert_recovered(manager, before)
        self.assertEqual(children(manager.pid), [])
        manager.refused("start", "syntax")
        manager.refused("end nobody", "unknown")

    def test_ordinary_programs_that_do_not_speak_the_language(self):
        manager = self.manager()
        manager.must("create node probe")
        before = manager.hash()
        for program in ("true", "false", "ls with env -- /", "yes", "cat with env"):
            with self.subTest(program):
                reply = manager.ask(f"start {program}", timeout=60)
                self.assertFalse(reply.ok, "it was taken for a manipulator")
                self.assert_recovered(manager, before)
        until(lambda: not descendants(manager.pid), "they are ended")

    def test_a_name_is_given_once(self):
        manager = self.manager()
        manager.must("start walker as first")
        manager.refused("start walker as first", "exists")
        self.assertIn("first", manager.must("manipulators"))
        # a second program writing the same fields: one of them has to be refused
        reply = manager.ask("start walker as second")
        if reply.ok:
            manager.must("create walker w")
            manager.must("step")
        manager.must("end first")
        self.assertNotIn("first", manager.must("manipulators"))

    def test_a_program_may_write_only_what_it_declared(self):
        manager, _ = self.walk("foreign!", "tick", ticks=2)
        self.assertEqual(manager.must("get probe.visible"), "true")
        self.assertIn("owner", "\n".join(manager.events + manager.errors) + manager.must("manipulators") + manager.must("stats"))

    def test_what_a_person_writes_is_told_to_the_program(self):
        manager, _ = self.walk(ticks=2)
        manager.must("set w.steps 99")
        manager.must("set w.position 7 8 9")
        manager.must("step")
        self.assertEqual(manager.must("get w.steps"), "100")
        manager.must("expect w.position == 7 8 9 +- 0.1")

    def test_a_hundred_megabytes_on_standard_error_do_not_stop_a_run(self):
        expected = self.undisturbed()
        manager, got = self.walk("complain", "tick", "17")
        self.assertEqual(got, expected)
        if not sailor.SANITIZED:
            self.assertLess(manager.memory(), 200 << 20)

    def test_standard_error_that_nobody_reads_does_not_make_the_manager_grow(self):
        reading, writing = os.pipe()
        self.addCleanup(os.close, reading)
        manager = self.manager("--seed", "3", stderr=writing)
        os.close(writing)
        for line in ("create node probe", "start walker -- complain tick 2", "create walker w", "step"):
            manager.must(line)
        manager.send(b"@2 step 2\n")
        deadline = time.monotonic() + 3
        while time.monotonic() < deadline:
            if not sailor.SANITIZED:
                self.assertLess(manager.memory(), 64 << 20)
            time.sleep(0.05)

    def test_standard_error_is_passed_on_with_the_name(self):
        self.file("moan", "#!/bin/sh\nread hello\necho ready\necho oh dear >&2\nwhile read line; do echo done; done\n")
        os.chmod(self.folder / "moan", 0o755)
        done = self.run_manager("-c", "start ./moan", "-c", "end moan")
        self.assertRegex(done.stderr, r"(?m)^moan\W.*oh dear$")

    def test_grandchildren_go_with_their_program(self):
        expected = self.undisturbed()
        manager, got = self.walk("child", "tick", "17")
        self.assertEqual(got, expected)
        pid = int((self.folder / "grandchild").read_text())
        until(lambda: not alive(pid), "the grandchild is ended")

    def test_programs_get_no_foreign_descriptors(self):
        self.file("fds", "#!/bin/sh\nls /proc/self/fd | tr '\\n' ' ' > $0.list\nread hello\necho ready\nwhile read line; do echo done; done\n")
        os.chmod(self.folder / "fds", 0o755)
        manager = self.manager("--journal", "kept")
        manager.must("start walker")
        manager.must("start ./fds")
        # 3 is the folder that ls reads
        self.assertEqual((self.folder / "fds.list").read_text().split(), ["0", "1", "2", "3"])

    def test_programs_find_ordinary_signals(self):
        self.file("signals", "#!/bin/sh\ngrep -E 'Sig(Blk|Ign)' /proc/self/status > $0.list\nread hello\necho ready\n"
                  "while read line; do echo done; done\n")
        os.chmod(self.folder / "signals", 0o755)
        manager = self.manager()
        manager.must("start ./signals")
        for line in (self.folder / "signals.list").read_text().splitlines():
            self.assertEqual(int(line.split()[1], 16), 0, line)

    def test_a_program_that_is_slow_is_waited_for_within_its_time(self):
        expected = self.undisturbed()
        manager, got = self.walk("slow", "tick", "17")
        self.assertEqual(got, expected)
        self.assertFalse([event for event in manager.events if "gone" in event], "0.3 s are within its timeout of 1 s")

    def test_verbs_of_programs_stand_beside_those_of_the_manager(self):
        manager, _ = self.walk(ticks=3)
        self.assertIn("jump", manager.must("help"))
        self.assertIn("WALKER", manager.must("help jump"))
        self.assertNotEqual(manager.must("get w.position"), "0 0 0")
        manager.must("jump w")
        self.assertEqual(manager.must("get w.position"), "0 0 0")
        manager.refused("jump nobody", "unknown")
        manager.must("end walker")
        reply = manager.ask("jump w")
        self.assertFalse(reply.ok)
        self.assertIn(reply.kind, ("unknown", "gone"))

    def test_quit_ends_everything_also_what_does_not_listen(self):
        for fault in ("hang", "stop", "deaf", "kill", "flood", "garbage"):
            with self.subTest(fault):
                (self.folder / "fault.done").unlink(missing_ok=True)
                manager = self.manager()
                for line in (f"start walker -- {fault} quit", "create walker w", "step 2"):
                    manager.must(line)
                everything = descendants(manager.pid)
                manager.send(b"quit\n")
                self.assertEqual(manager.process.wait(15), 0)
                for pid in everything:
                    until(lambda pid=pid: not alive(pid), "it outlived the manager")

    def test_a_killed_manager_takes_its_programs_along(self):
        manager, _ = self.walk(ticks=2)
        everything = descendants(manager.pid)
        self.assertTrue(everything)
        os.kill(manager.pid, signal.SIGKILL)
        manager.process.wait()
        for pid in everything:
            until(lambda pid=pid: not alive(pid), "it outlived the manager", 10)

    def test_nothing_stays_in_shared_memory(self):
        before = set(pathlib.Path("/dev/shm").iterdir())
        manager, _ = self.walk("kill", "tick", "17")
        manager.finish()
        self.assertFalse(set(pathlib.Path("/dev/shm").iterdir()) - before)

    def test_the_end_of_a_program_is_told_with_its_reason(self):
        manager = self.manager()
        for line in ("start walker -- kill tick 2", "create walker w", "step 3"):
            manager.must(line)
        manager.event(r"^event gone walker killed 9$")

    def test_a_verb_acts_on_the_world_as_it_stands(self):
        manager, _ = self.walk(ticks=2)
        manager.send(b"set w.position 1 2 3\n@w where w\n")
        self.assertEqual(manager.answer("w").body, ["1.0 2.0 3.0"])

    def test_a_program_is_not_told_its_own_writes(self):
        manager, _ = self.walk("log", ticks=3)
        manager.must("set w.position 1 2 3")
        manager.must("step")
        told = [line for line in (self.folder / "heard").read_text().splitlines() if line.startswith("set w.position")]
        self.assertEqual(told, ["set w.position 1 2 3"])

    def test_writing_a_field_covers_subtypes(self):
        manager, _ = self.walk(ticks=1)
        manager.must("type runner extends walker")
        manager.must("create runner r reach 0.9")
        manager.must("step 2")
        self.assertEqual(manager.must("get r.steps"), "2")

    def test_objects_come_and_go(self):
        manager, _ = self.walk(ticks=2)
        manager.must("delete w")
        manager.must("step")
        manager.must("create walker w")
        manager.must("step 2")
        self.assertEqual(manager.must("get w.steps"), "2")
        manager.must("delete **")
        manager.must("step")
        self.assertEqual(manager.must("list"), "")

    def test_the_environment_is_inherited_and_a_launcher_stands_before(self):
        self.file("show", "#!/bin/sh\nread hello\necho \"$TEST_WORD $*\" > shown\necho ready\nwhile read line; do echo done; done\n")
        os.chmod(self.folder / "show", 0o755)
        environ = sailor.environment(self.folder, TEST_WORD="inherited")
        done = self.run_manager("-c", "start ./show -- one 'two words'".replace("'", '"'), environ=environ)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "shown").read_text(), "inherited one two words\n")
        done = self.run_manager("-c", "start ./show with env TEST_WORD=launched -- three", environ=environ)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "shown").read_text(), "launched three\n")

    def test_a_world_of_many_types_that_name_each_other_is_told(self):
        count = 60
        manager = self.manager()
        manager.must("type t0 extends node")
        manager.must("field t0.next ref:node")
        for n in range(1, count):
            manager.must(f"type t{n} extends t0")
            manager.must(f"field t{n}.own{n} real = {n}")
        self.file("ear", "#!/bin/sh\necho 'reads t0'\necho ready\nwhile read verb what rest; do\necho \"$verb $what $rest\" >> heard\n"
                  "[ $verb = tick ] && echo done $what\ndone\n")
        os.chmod(self.folder / "ear", 0o755)
        manager.must("start ./ear")
        for n in range(count):
            manager.must(f"create t{n} o{n}")
        for n in range(count - 1):
            manager.must(f"set o{n}.next o{n + 1}")
        manager.must(f"set o{count - 1}.next o0")
        manager.must("step 2")
        manager.finish()
        heard = (self.folder / "heard").read_text().splitlines()
        self.assertEqual(len([line for line in heard if line.startswith("create t")]), count)
        for n in range(count):
            self.assertTrue([line for line in heard if f"o{(n + 1) % count}" in line.split() and line.startswith((f"set o{n}.next", f"create t{n} o{n} "))], n)

    def test_rate_and_timeout_of_a_program(self):
        self.file("slow", "#!/bin/sh\necho 'rate 5Hz'\necho ready\nwhile read verb number rest; do\n[ $verb = tick ] && echo $number >> ticks\n"
                  "echo done $number\ndone\n")
        os.chmod(self.folder / "slow", 0o755)
        manager = self.manager()
        for line in ("rate 20Hz", "start ./slow", "run 2"):
            manager.must(line)
        self.assertIn(len((self.folder / "ticks").read_text().split()), (10, 11))

    def test_the_small_program_of_the_documentation(self):
        manager = self.manager()
        for line in ("start wave", "create wave w height 1 middle 0 2 0", "rate 10Hz", "run 0.5"):
            manager.must(line)
        # its period is 2 s
        manager.must("expect w.position == 0 3 0 +- 1e-15")
        manager.must("set w.height 2")
        manager.must("run 1")
        manager.must("expect w.position == 0 0 0 +- 1e-14")


class SlowManipulators(Walkers):
    """Kills at many moments of a longer run."""

    TICKS = 300

    def test_thirty_kills(self):
        expected = self.undisturbed()
        manager = self.manager("--seed", "3")
        for line in ("create node probe", "start walker", "create walker w", "create walker v reach 0.5"):
            manager.must(line)
        for round_ in range(self.TICKS // 10):
            manager.send(b"@run step 10\n")
            # between two kills longer than the window in which too many starts count as failure
            time.sleep(0.001 * round_)
            for pid in children(manager.pid):
                os.kill(pid, signal.SIGKILL)
            self.assertTrue(manager.answer("run", 60).ok)
            time.sleep(2.1)
        self.assertEqual(manager.hash(), expected)


if __name__ == "__main__":
    sailor.main()
