"""What a program leaves behind when it is ended, saved, journalled, or given up: nothing is lost silently."""

import os
import random
import signal
import time

import sailor
from sailor import Case, children, zombies

# adds one at each tick; of its own: dies, or talks, as its argument says
COUNTER = """#!/usr/bin/python3 -u
import os, sys
policy, fault, at = (sys.argv[1:] + ["stop", "", "0"])[:3]
counts = {}
for line in sys.stdin:
    words = line.split()
    if words[0] == "hello":
        print("type counter\\nfield counter.n int\\nwrites counter.n\\ncheckpoint\\ntimeout 1s\\npolicy", policy)
        print("verb die \\"\\"\\nready")
    elif words[0] == "create" and words[1] == "counter":
        counts[words[2]] = int(words[words.index("n") + 1]) if "n" in words else 0
    elif words[0] == "set":
        counts[words[1].split(".")[0]] = int(words[2])
    elif words[0] == "tick":
        if fault == "die" and words[1] == at: os._exit(3)
        if fault == "talk" and int(words[1]) >= int(at): print("set nothing.at 1\\n" * 120)
        for name in counts:
            counts[name] += 1
            print("set", name + ".n", counts[name])
        print("done", words[1])
    elif words[0] == "checkpoint":
        print("done")
    elif words[0].startswith("@"):
        os._exit(4)
    elif words[0] == "quit":
        break
"""


class Supervision(Case):
    def setUp(self):
        super().setUp()
        self.file("counter", COUNTER)
        os.chmod(self.folder / "counter", 0o755)

    def walkers(self, *lines, journal=()):
        manager = self.manager("--seed", "3", *journal)
        for line in ("start walker", "create walker w", "create walker v reach 0.5", *lines):
            manager.must(line, timeout=60)
        return manager

    def undisturbed(self, ticks=30):
        return self.walkers(f"step {ticks}").hash()

    def column(self, manager, name, program):
        line = [line for line in manager.must("manipulators").splitlines() if line.startswith(program + " ")][0]
        return next(word.split("=", 1)[1] for word in line.split() if word.startswith(name + "="))

    # -- private state

    def test_an_ended_program_that_is_started_again_goes_on_where_it_was(self):
        expected = self.undisturbed()
        self.assertEqual(self.walkers("step 17", "end walker", "start walker", "step 13").hash(), expected)
        # also when it is just being started again
        manager = self.walkers("step 17")
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        for line in ("end walker", "start walker", "step 13"):
            manager.must(line)
        self.assertEqual(manager.hash(), expected)

    def test_a_save_has_the_private_state_as_it_is(self):
        expected = self.undisturbed()
        self.walkers("step 17", "save kept.dlg")
        manager = self.manager("--seed", "3")
        # the walker brings its types
        manager.must("start walker")
        lines = (self.folder / "kept.dlg").read_text()
        manager.must("source kept.dlg")
        manager.must("step 13")
        self.assertEqual(manager.hash(), expected, lines)

    def test_a_save_leaves_what_can_be_undone(self):
        manager = self.walkers("step 17", "set w.reach 0.3")
        before = manager.must("get w.reach")
        for line in ("set w.reach 0.7", "save kept.dlg", "undo"):
            manager.must(line)
        self.assertEqual(manager.must("get w.reach"), before)
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step 13")
        self.assertEqual(manager.hash(), self.walkers("step 17", "set w.reach 0.3", "step 13").hash())

    def test_a_save_in_a_transaction_asks_nobody(self):
        manager = self.walkers("step 17", "begin", "set w.reach 0.7", "save kept.dlg", "rollback", "step 13")
        self.assertEqual(manager.hash(), self.undisturbed())
        self.assertEqual(self.column(manager, "checkpoint", "walker"), "0")

    def test_a_save_that_is_put_off(self):
        manager = self.walkers("at 0.2 save kept.dlg", "every 100ms save other.dlg", "step 30")
        self.assertEqual(manager.hash(), self.undisturbed())
        self.assertNotIn("state 1 ", (self.folder / "kept.dlg").read_text())

    def test_a_journal_begun_in_mid_session_has_it_too(self):
        expected = self.undisturbed()
        manager = self.walkers("step 17", "journal kept", "step 5")
        os.kill(manager.pid, signal.SIGKILL)
        manager.process.wait()
        other = self.manager("--resume", "kept")
        other.must("step 8", timeout=60)
        self.assertEqual(other.hash(), expected)

    def test_an_end_in_a_journal(self):
        manager = self.walkers("step 17", "end walker", "start walker", "step 13", journal=("--journal", "kept"))
        expected = manager.hash()
        manager.finish()
        for line in ("replay kept", "replay --live kept"):
            other = self.manager()
            other.must(line, timeout=60)
            self.assertEqual(other.hash(), expected, line)
        other = self.manager("--resume", "kept")
        self.assertEqual(other.hash(), expected)

    def test_a_program_that_dies_of_a_save(self):
        for fault in ("kill", "hang"):
            with self.subTest(fault):
                (self.folder / "fault.done").unlink(missing_ok=True)
                manager = self.manager("--seed", "3")
                for line in (f"start walker -- {fault} checkpoint", "create walker w", "create walker v reach 0.5", "step 17", "save kept.dlg", "step 13"):
                    manager.must(line, timeout=60)
                self.assertEqual(manager.hash(), self.undisturbed())

    # -- given up

    def test_stop_holds_time_until_a_person_says_so(self):
        manager = self.manager()
        for line in ("start ./counter -- stop die 3", "create counter c", "step 2"):
            manager.must(line)
        manager.refused("step 5", "gone", "ended with exit status 3 at tick 3, 3 times in a row")
        self.assertEqual(manager.must("get c.n"), "2")
        # not silently without it
        for line in ("step", "run 1s", "wait c.n == 9 for 1s"):
            manager.refused(line, "gone", "expected end counter, or to start it again")
        manager.must("set c.n 5")
        manager.must("resume")
        manager.event("^event time stands still: counter ended with")
        manager.must("end counter")
        manager.must("step 2")
        self.assertEqual(manager.must("get c.n"), "5")

    def test_a_failure_in_the_last_tick_that_was_waited_for_is_an_error_too(self):
        for line in ("step", "step 3", "run 50ms", "wait c.n == 9 for 50ms"):
            at = "1" if line == "step" else "3"
            done = self.run_manager("-c", f"start ./counter -- stop die {at}", "-c", "create counter c", "-c", line, "-c", "echo on")
            self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
            self.assertIn("error gone counter ended with exit status 3 at tick " + at, done.stderr)

    def test_programs_that_stop_listening_or_talking_and_live_on(self):
        # with 1 MB to read that it never reads; its input closed, its output open; the other way round
        for name, rest in (("deaf", "sleep 1000"), ("shut", "exec 0<&-; sleep 1000"), ("mute", "exec 1>&-; sleep 1000")):
            with self.subTest(name):
                self.file(name, f"#!/bin/bash\nread hello\necho reads sphere\necho timeout 0.2s\necho ready\n{rest}\n")
                os.chmod(self.folder / name, 0o755)
                script = f"start ./{name}\n" + "".join(f"create sphere b{n}\n" for n in range(20000)) + "step\n"
                done = self.run_manager(stdin=script.encode(), timeout=60)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertRegex(done.stderr, rf"error (timeout|gone) {name} ended with (timeout|closed output) at tick")

    def test_forty_programs_and_few_descriptors(self):
        manager = self.manager(preexec=lambda: sailor.resource_limit(64))
        manager.must("create node probe")
        started = 0
        while (reply := manager.ask(f"start walker as w{started} serving w{started}", timeout=60)).ok:
            started += 1
        self.assertEqual(reply.kind, "limit")
        self.assertGreater(started, 8)
        manager.must("create walker w3")
        manager.must("step 5", timeout=60)
        self.assertEqual(manager.must("get w3.steps"), "5")
        # one that dies finds what it left
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step 5", timeout=60)
        self.assertEqual(len(children(manager.pid)), started)
        self.assertFalse(zombies(manager.pid))
        self.assertEqual(manager.finish(), 1, "a command was refused")

    def test_the_next_command_of_a_batch_is_carried_out(self):
        # its end comes from without, and the text that it stood in is at its end
        done = self.run_manager("--keep-going", "-c", "start ./counter -- stop die 3", "-c", "step 5", "-c", "step", "-c", "end counter", "-c", "step", "-c", "echo on")
        self.assertEqual((done.returncode, done.stdout), (1, "on\n"), done.stderr)
        self.assertEqual(done.stderr.count("error gone"), 2)

    def test_it_also_holds_when_nobody_waited(self):
        manager = self.manager()
        for line in ("start ./counter", "create counter c", "step 2"):
            manager.must(line)
        for _ in range(3):
            reply = manager.ask("die")
            self.assertTrue(reply.ok or reply.kind == "gone", repr(reply))
        manager.event("^event failed counter$")
        manager.refused("step", "gone", "expected end counter")
        # a failed one that is started again takes up its fields
        manager.must("start ./counter")
        manager.must("step 2")
        self.assertEqual(manager.must("get c.n"), "4")

    def test_hold_goes_on_without_it(self):
        manager = self.manager()
        for line in ("start ./counter -- hold die 3", "create counter c", "step 5"):
            manager.must(line)
        manager.event("^event failed counter$")
        self.assertEqual(manager.must("get c.n"), "2")
        manager.refused("die", "gone")
        manager.must("start ./counter")
        manager.must("step 2")
        self.assertEqual(manager.must("get c.n"), "4")

    def test_skip_leaves_out_the_tick_that_it_dies_of(self):
        manager = self.manager()
        for line in ("start ./counter -- skip die 3", "create counter c", "step 5"):
            manager.must(line)
        manager.event("^event skipped counter tick 3$")
        self.assertEqual(manager.must("get c.n"), "4")
        self.assertIn("counter active", manager.must("manipulators"))

    def test_garbage_in_two_lives_in_a_row_is_given_up(self):
        manager = self.manager()
        for line in ("start ./counter -- stop talk 3", "create counter c", "step 2"):
            manager.must(line)
        manager.refused("step 5", "gone", "ended with garbage at tick 4, twice in a row")
        self.assertEqual(self.column(manager, "restarts", "counter"), "1")

    def test_who_computes_while_another_fails_ends_its_tick(self):
        # what the slow one says counts in the tick in which it was asked, however long the other takes to fail
        self.file("tortoise", "#!/bin/sh\nwhile read verb n rest; do\ncase $verb in hello) echo 'type thing'; echo 'field thing.n int'; echo 'writes thing.n'\n"
                  "echo ready;; tick) sleep 0.3; echo set t.n $n; echo done $n;; esac\ndone\n")
        os.chmod(self.folder / "tortoise", 0o755)
        manager = self.manager()
        for line in ("start ./tortoise", "create thing t", "start ./counter -- stop die 2", "create counter c", "step"):
            manager.must(line)
        manager.refused("step 3", "gone")
        self.assertEqual(manager.must("get t.n"), "2")
        manager.must("end counter")
        manager.must("step")
        self.assertEqual(manager.must("get t.n"), "3")
        self.assertEqual(self.column(manager, "refused", "tortoise"), "0")

    # -- a program that says why it cannot be

    def test_an_error_before_ready_is_told_to_who_starts_it(self):
        self.file("blind", "#!/bin/sh\nread hello\necho error io no display, expected DISPLAY to be set\n")
        os.chmod(self.folder / "blind", 0o755)
        manager = self.manager()
        manager.refused("start ./blind", "io", "^blind: no display, expected DISPLAY to be set$")
        self.assertEqual(manager.must("manipulators"), "")

    def test_a_program_of_the_kit_refuses_another_protocol(self):
        done = sailor.subprocess.run([str(sailor.BIN / "flight")], input=b"hello protocol=2 name=flight\ntick 1 0.1 0.1\n", cwd=self.folder,
                                     capture_output=True, timeout=sailor.PATIENCE, check=False)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (1, b"error unknown 1 protocol is 2, expected 1\n", b""))

    # -- a killer that kills more often than a program may be started

    def storm(self, seed, between):
        """A script in a batch, and a killer: exit status, hash, errors."""
        chance = random.Random(seed)
        self.file("calm.dlg", "start walker\ncreate walker w\ncreate walker v reach 0.5\npace 2\nrun 6s\nhash\n")
        manager = sailor.subprocess.Popen([str(sailor.BIN / "dialog_manager"), "--seed", "3", "calm.dlg"], cwd=self.folder,
                                          env=sailor.environment(self.folder), stdin=sailor.subprocess.DEVNULL,
                                          stdout=sailor.subprocess.PIPE, stderr=sailor.subprocess.PIPE)
        while manager.poll() is None:
            time.sleep(between * chance.random())
            for pid in children(manager.pid):
                os.kill(pid, signal.SIGKILL)
        out, errors = manager.communicate()
        return manager.returncode, out.decode().strip(), errors.decode()

    def test_too_many_kills_are_an_error_and_not_another_world(self):
        done = self.run_manager("--seed", "3", "-c", "start walker", "-c", "create walker w", "-c", "create walker v reach 0.5", "-c", "run 6s",
                                "-c", "hash")
        for seed, between in ((1, 0.2), (2, 0.6)):
            with self.subTest(between):
                status, got, errors = self.storm(seed, between)
                if status == 0:
                    self.assertEqual(got, done.stdout.strip(), errors)
                else:
                    self.assertEqual((status, got), (1, ""))
                    self.assertRegex(errors, r"(?m)^event failed walker$|before it was ready|error gone")
                    self.assertRegex(errors, "error gone walker ended with killed 9")


if __name__ == "__main__":
    sailor.main()
