"""The journal: what was acknowledged is there again after any end, and never half a tick."""

import os
import random
import resource
import signal
import time

import sailor
from sailor import BIN, Case

SETUP = ["rate 10Hz", "create sphere ball radius 4cm", "start walker", "create walker w reach 0.5"]


class Journals(Case):
    def recorded(self, ticks=6):
        """A session with a journal: the hash after every tick, the last one at its end."""
        manager = self.manager("--seed", "4", "--journal", "kept")
        for line in SETUP:
            manager.must(line)
        hashes = [manager.hash()]
        for tick in range(ticks):
            manager.must(f"set ball.position {tick} 0 0")
            hashes.append(manager.hash())
            manager.must("step")
            hashes.append(manager.hash())
        self.assertEqual(manager.finish(), 0)
        return hashes

    def replayed(self, name):
        """A manager that has replayed a journal without its programs."""
        manager = self.manager()
        reply = manager.ask(f"replay {name}", timeout=60)
        return manager, reply

    def check_replay(self, name, expected):
        """A journal replayed without its programs ends in the world of this hash."""
        manager, reply = self.replayed(name)
        self.assertTrue(reply.ok, repr(reply))
        self.assertEqual(manager.hash(), expected)


class Journal(Journals):
    def test_replay_gives_the_same_world_without_programs(self):
        hashes = self.recorded()
        manager, reply = self.replayed("kept")
        self.assertTrue(reply.ok, repr(reply))
        self.assertEqual(manager.hash(), hashes[-1])
        self.assertEqual(sailor.children(manager.pid), [], "replay needs no programs")
        self.assertEqual(manager.must("get ball.position"), "5 0 0")
        self.assertIn("0.6", manager.must("time"))

    def test_resume_goes_on_where_it_ended(self):
        hashes = self.recorded()
        manager = self.manager("--resume", "kept")
        self.assertEqual(manager.hash(), hashes[-1])
        manager.must("step 4")
        end = manager.hash()
        manager.end()
        whole = self.manager("--seed", "4")
        for line in SETUP:
            whole.must(line)
        for tick in range(6):
            whole.must(f"set ball.position {tick} 0 0")
            whole.must("step")
        whole.must("step 4")
        self.assertEqual(whole.hash(), end)

    def test_the_journal_is_text_that_tells_who_said_what(self):
        self.recorded()
        text = (self.folder / "kept").read_text()
        self.assertIn("set ball.position 3 0 0", text)
        self.assertIn("create walker w reach 0.5", text)
        self.assertRegex(text, r"(?m)^.*walker.*set w\.position")

    def test_a_journal_command_begins_one_in_mid_session(self):
        manager = self.world()
        manager.must("set ball.position 1 2 3")
        manager.must("journal later")
        manager.must("set ball.position 4 5 6")
        manager.must("step 3")
        expected = manager.hash()
        manager.finish()
        self.check_replay("later", expected)

    def put_off(self, manager):
        return [manager.must(verb) for verb in ("at", "every", "when", "budget", "time")]

    def test_what_is_put_off_keeps_its_number_when_the_story_is_told_again(self):
        manager = self.world("--journal", "kept")
        for line in ("rate 10Hz", "budget error 1mm", "at 0.5 set ball.position 5 0 0", "at 9 echo x", "every 0.2 set ball.visible true",
                     "when ball.position == 5 0 0 set probe.visible false", "run 0.3", "forget 2", "every 0.5 set ball.radius 1",
                     "forget 5", "step"):
            manager.must(line)
        then, hash_then = self.put_off(manager), manager.hash()
        manager.must("run 0.6")
        end = manager.hash()
        self.assertNotEqual(end, hash_then)
        manager.must("rewind 0.4")
        self.assertEqual((self.put_off(manager), manager.hash()), (then, hash_then))
        manager.must("at 5 echo y")
        manager.must("forget 6")
        manager.must("run 0.6")
        self.assertEqual(manager.hash(), end)
        manager.finish()
        resumed = self.manager("--resume", "kept")
        self.assertEqual(resumed.hash(), end)
        self.assertEqual(resumed.must("budget"), "error 0.001")
        resumed.must("forget 3")

    def test_a_journal_of_mid_session_takes_up_what_was_put_off_before(self):
        manager = self.world()
        for line in ("rate 10Hz", "budget time 1ms", "at 5 echo x", "every 0.3 set ball.visible true", "every 0.2 echo x",
                     "when ball.visible == true set ball.position 1 1 1", "at 0.9 set probe.position 2 2 \"2\"", "forget 1", "forget 3",
                     "forget 5", 'at 0.9 "set probe.position 2 2 2"', "at 3 echo x", "forget 7", "run 0.4", "journal later", "at 4 echo z",
                     "forget 8", "forget 2", "run 0.8"):
            manager.must(line)
        expected, end = self.put_off(manager), manager.hash()
        manager.finish()
        resumed = self.manager("--resume", "later")
        self.assertEqual((self.put_off(resumed), resumed.hash()), (expected, end))
        resumed.finish()
        other, reply = self.replayed("later")
        self.assertTrue(reply.ok, repr(reply))
        self.assertEqual(other.hash(), end)
        other.finish()
        # put off here and there: the numbers would not be the same
        third = self.manager()
        third.must("at 1 echo x")
        third.refused("replay later", "exists", "put off")

    def test_verbs_of_programs_that_are_put_off_are_replayed_without_them(self):
        manager = self.manager("--journal", "kept")
        manager.must("start walker")
        manager.must("create walker w")
        manager.must("at 0.05 jump w")
        manager.must("step 5")
        expected = manager.hash()
        manager.finish()
        self.check_replay("kept", expected)

    def test_nobody_speaks_under_a_name_of_the_journal(self):
        manager = self.world("--journal", "kept")
        for name in ("tick", "ask", "checkpoint", "rewind", "later", "main", "schedule"):
            manager.refused(f"listen {name}", "exists", f"[.]/{name}")
            manager.refused(f"start walker as {name}", "exists", "manager's own")
        self.assertEqual(manager.must("sources"), "main")

    def test_undo_transactions_and_scripts_are_replayed(self):
        self.file("part.dlg", "create node from_script\nset from_script.position 1 1 1\n")
        manager = self.manager("--journal", "kept")
        for line in ("create node a", "set a.position 1 2 3", "set a.position 4 5 6", "undo", "begin", "create node b", "rollback", "begin",
                     "create node c", "commit", "source part.dlg", "source part.dlg under c", "source part.dlg under made", "delete a", "undo", "redo", "step 2"):
            manager.must(line)
        manager.refused("nonsense", "unknown")
        expected = manager.hash()
        manager.finish()
        (self.folder / "part.dlg").unlink()
        self.check_replay("kept", expected)

    def test_a_journal_cut_anywhere_gives_a_world_that_was(self):
        hashes = set(self.recorded())
        data = (self.folder / "kept").read_bytes()
        before = self.worlds_of_setup()
        lengths = range(0, len(data)) if not sailor.SANITIZED else range(0, len(data), 17)
        lengths = random.Random(1).sample(list(lengths), 60)
        for length in sorted(lengths) + [len(data) - 1]:
            with self.subTest(length):
                self.file("cut", data[:length])
                done = self.run_manager("--keep-going", "--resume", "cut", "-c", "hash", timeout=60)
                self.assertGreaterEqual(done.returncode, 0, done.stderr)
                lines = done.stdout.split()
                if lines:
                    self.assertIn(lines[-1], hashes | before)

    def worlds_of_setup(self):
        """The hashes between the lines of the setup."""
        manager = self.manager("--seed", "4")
        worlds = {manager.hash()}
        for line in SETUP:
            manager.must(line)
            worlds.add(manager.hash())
        return worlds

    def test_a_flipped_bit_gives_a_world_that_was_or_is_told(self):
        hashes = set(self.recorded())
        data = (self.folder / "kept").read_bytes()
        before = self.worlds_of_setup()
        chance = random.Random(2)
        for _ in range(60):
            place = chance.randrange(len(data))
            flipped = bytearray(data)
            flipped[place] ^= 1 << chance.randrange(8)
            with self.subTest(f"byte {place}: {flipped[max(0, place - 20):place + 20]!r}"):
                self.file("flipped", bytes(flipped))
                done = self.run_manager("--keep-going", "--resume", "flipped", "-c", "hash", timeout=60)
                self.assertGreaterEqual(done.returncode, 0, done.stderr)
                lines = done.stdout.split()
                if lines and lines[-1] not in hashes | before:
                    self.fail(f"a world that never was, silently: {done.stderr!r}")

    def test_acknowledged_lines_survive_the_end_of_the_manager(self):
        for round_ in range(5):
            with self.subTest(round_):
                (self.folder / "kept").unlink(missing_ok=True)
                manager = self.manager("--journal", "kept")
                manager.must("create sphere ball")
                manager.send(b"".join(b"@%d set ball.position %d 0 0\n" % (n, n) for n in range(1, 5000)))
                for n in range(1, 101):
                    manager.answer(str(n))
                os.kill(manager.pid, signal.SIGKILL)
                manager.process.wait()
                acknowledged = 100
                while (line := manager.line()) is not None:
                    # the last one may be half an answer
                    if line.endswith(" ok"):
                        acknowledged = int(line.split()[0][1:])
                other = self.manager("--resume", "kept")
                self.assertGreaterEqual(float(other.must("get ball.position").split()[0]), acknowledged)

    def test_a_full_disk_refuses_writing_and_goes_on_reading(self):
        for limit in (0, 1, 100, 300, 301, 302, 303, 304, 305, 350, 400, 500, 1000):
            with self.subTest(limit):
                (self.folder / "kept").unlink(missing_ok=True)

                def small(limit=limit):
                    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

                manager = sailor.Manager("--journal", "kept", cwd=self.folder, preexec=small)
                self.addCleanup(manager.end)
                try:
                    reply = manager.ask("create sphere ball")
                except (AssertionError, BrokenPipeError):
                    # it may refuse to begin at all, saying so
                    self.assertEqual(manager.process.wait(), 1)
                    manager.error_reader.join(sailor.PATIENCE)
                    self.assertRegex("\n".join(manager.errors), "io")
                    continue
                accepted = 0
                for n in range(60):
                    reply = manager.ask(f"set ball.position {n} 0 0")
                    if not reply.ok:
                        break
                    accepted = n
                self.assertFalse(reply.ok, "the disk never got full")
                self.assertIn(reply.kind, ("io", "unknown"), repr(reply))
                if reply.kind == "io":
                    if accepted:
                        self.assertEqual(manager.must("get ball.position"), f"{accepted} 0 0", "a refused line had an effect")
                    manager.must("hash")
                manager.end()
                done = self.run_manager("--keep-going", "--resume", "kept", "-c", "get ball.position")
                if accepted:
                    self.assertEqual(done.stdout.strip(), f"{accepted} 0 0", done.stderr)

    def test_a_program_that_could_not_be_started_does_not_stand_in_the_way(self):
        manager = self.manager("--seed", "4", "--journal", "kept")
        for program in ("false", "no_such_program", "walker as early -- exit! declare"):
            self.assertFalse(manager.ask(f"start {program}").ok)
        for line in SETUP:
            manager.must(line)
        manager.must("step 3")
        manager.must("start walker as second serving none*")
        manager.must("end second")
        manager.must("step 3")
        expected = manager.hash()
        manager.finish()
        other = self.manager("--resume", "kept")
        self.assertEqual(other.hash(), expected)
        self.assertEqual(len(sailor.children(other.pid)), 1)
        other.must("step")

    def test_devices_folders_and_missing_places_as_journal(self):
        for name in ("/dev/full", ".", "no/such/folder/kept"):
            with self.subTest(name):
                done = self.run_manager("--journal", name, "-c", "create node a", "-c", "echo x")
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("io", done.stderr)
        done = self.run_manager("--resume", "missing", "-c", "echo x")
        self.assertIn(done.returncode, (1, 2))
        self.assertIn("missing", done.stderr)

    def test_what_is_no_journal_is_refused(self):
        for name, content in (("empty", b""), ("noise", os.urandom(5000)), ("script", b"create node a\nset a.visible false\n"),
                              ("nul", bytes(4096))):
            with self.subTest(name):
                self.file(name, content)
                manager = self.manager()
                manager.must("create node probe")
                before = manager.hash()
                reply = manager.ask(f"replay {name}")
                if not reply.ok:
                    self.assert_recovered(manager, before)

    def test_two_managers_on_one_journal(self):
        first = self.manager("--journal", "kept")
        first.must("create node a")
        done = self.run_manager("--journal", "kept", "-c", "create node b")
        self.assertEqual(done.returncode, 1, "the second one must be refused")
        self.assertRegex(done.stderr, "io|busy")
        first.must("set a.visible false")
        first.finish()
        manager, reply = self.replayed("kept")
        self.assertTrue(reply.ok, repr(reply))
        self.assertEqual(manager.must("list"), "a")

    def test_a_journal_of_a_killed_program(self):
        expected = self.recorded()[-1]
        (self.folder / "kept").unlink()
        manager = self.manager("--seed", "4", "--journal", "kept")
        for line in SETUP[:2] + ["start walker -- kill tick 3"] + SETUP[3:]:
            manager.must(line)
        for tick in range(6):
            manager.must(f"set ball.position {tick} 0 0")
            manager.must("step")
        self.assertEqual(manager.hash(), expected)
        manager.finish()
        self.check_replay("kept", expected)


    def live(self, name):
        """What `replay --live` says, and the manager."""
        manager = self.manager()
        return manager, manager.ask(f"replay --live {name}", timeout=60)

    def test_a_live_replay_runs_the_programs_again(self):
        manager = self.manager("--seed", "4", "--journal", "kept")
        for line in SETUP + ["at 0.25s set w.reach 0.9", "every 0.2s set ball.visible false", "when w.steps > 4 set ball.radius 9cm", "checkpoints every 3", "step 3", "jump w", "step 2",
                             "begin", "set ball.position 1 1 1", "set ball.position 2 1 1", "commit", "undo", "step 3", "end walker", "step 2",
                             "start walker as second", "create walker v", "step 4"]:
            manager.must(line)
        expected, time_ = manager.hash(), manager.must("time")
        manager.finish()
        for command in ("replay --live kept", "replay kept --live"):
            other = self.manager()
            other.must(command, timeout=60)
            self.assertEqual(other.hash(), expected)
            self.assertEqual(other.must("time"), time_)
            self.assertEqual(len(sailor.children(other.pid)), 1, "its programs run")
            # and it goes on
            other.must("step 5")
            self.assertEqual(other.must("get v.steps"), "9")

    def test_a_live_replay_names_the_first_field_that_differs(self):
        self.recorded(ticks=6)
        text = (self.folder / "kept").read_text().rstrip("\0")
        # another program of that name, which goes wrong in tick 4
        walker = (sailor.PROGRAMS / "walker").read_text()
        other = walker.replace('say(f"set {path}.steps {walker[\'steps\']}")', 'say(f"set {path}.steps {walker[\'steps\'] + (tick == 4)}")')
        self.assertNotEqual(other, walker)
        (self.folder / "bin").mkdir()
        self.file("bin/walker", other)
        os.chmod(self.folder / "bin/walker", 0o755)
        environ = sailor.environment(self.folder)
        environ["PATH"] = f"{self.folder}/bin:" + environ["PATH"]
        manager = self.manager(environ=environ)
        reply = manager.ask("replay --live kept", timeout=60)
        self.assertEqual(reply.kind, "range", repr(reply))
        self.assertEqual(reply.sentence, "tick 4: w.steps is 5, the journal says 4")
        manager.must("create node after")
        self.assertIn("walker", text)

    def test_a_live_replay_whose_program_is_missing_or_answers_otherwise(self):
        self.recorded(ticks=3)
        environ = sailor.environment(self.folder)
        environ["PATH"] = "/usr/bin:/bin"
        manager = self.manager(environ=environ)
        reply = manager.ask("replay --live kept", timeout=60)
        self.assertEqual(reply.kind, "unknown", repr(reply))
        self.assertIn("start walker", reply.sentence)
        manager.must("echo still here")
        for command, kind in (("replay --live", "io"), ("replay --live a b", "syntax"), ("replay kept kept", "syntax"), ("replay --live missing", "io")):
            manager.refused(command, kind)

    def test_two_managers_resume_one_journal(self):
        self.recorded(ticks=2)
        first = self.manager("--resume", "kept")
        first.must("step")
        done = self.run_manager("--resume", "kept", "-c", "step")
        self.assertEqual(done.returncode, 1)
        self.assertIn("busy", done.stderr)
        self.assertIn("written by another manager", done.stderr)
        other = self.manager()
        other.refused("journal kept", "busy")
        # to read it is no harm
        other.must("replay kept")
        first.must("step")
        self.assertEqual(first.must("get w.steps"), "4")


class SlowJournal(Journals):
    def test_the_manager_killed_three_hundred_times(self):
        chance = random.Random(7)
        lost = 0
        for _ in range(300):
            (self.folder / "kept").unlink(missing_ok=True)
            manager = self.manager("--seed", "4", "--journal", "kept")
            for line in SETUP:
                manager.must(line)
            manager.send(b"".join(b"@%d set ball.position %d 0 0\n@s%d step\n@h%d hash\n" % (n, n, n, n) for n in range(1, 200)))
            time.sleep(chance.random() * 0.1)
            os.kill(manager.pid, signal.SIGKILL)
            manager.process.wait()
            acknowledged = ticks = 0
            hashes = {}
            body = ""
            while (line := manager.line()) is not None:
                if line.startswith("  "):
                    body = line.strip()
                elif line.startswith("@s"):
                    ticks = int(line.split()[0][2:])
                elif line.startswith("@h"):
                    hashes[int(line.split()[0][2:])] = body
                elif line.startswith("@"):
                    acknowledged = int(line.split()[0][1:])
            manager.end()
            done = self.run_manager("--resume", "kept", "-c", "get ball.position", "-c", "get w.steps", "-c", "hash")
            self.assertEqual(done.returncode, 0, done.stderr)
            ball, steps, state = done.stdout.splitlines()
            lost += float(ball.split()[0]) < acknowledged or int(steps) < ticks
            if int(steps) == float(ball.split()[0]) and int(steps) in hashes:
                self.assertEqual(state, hashes[int(steps)])
        self.assertEqual(lost, 0)


if __name__ == "__main__":
    sailor.main()
