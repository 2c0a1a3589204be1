"""Checkpoints: a program that dies is told its state and what came after it, and the world ends as if nothing had happened."""

import os
import random
import re
import signal
import time

import sailor
from sailor import BIN, Case, children, until

SCENE = ["create node probe", "create walker w", "create walker v reach 0.5"]


class Checkpoints(Case):
    def script(self, name, text):
        self.file(name, "#!/bin/sh\n" + text)
        os.chmod(self.folder / name, 0o755)

    def walk(self, *arguments, every="every 5", ticks=40, journal=(), scene=SCENE):
        """A manager with the walker (told these arguments) after a while: manager and hash."""
        (self.folder / "fault.done").unlink(missing_ok=True)
        (self.folder / "heard").unlink(missing_ok=True)
        manager = self.manager("--seed", "3", *journal)
        manager.must(f"checkpoints {every}")
        manager.must("start walker" + ("".join(" " + word for word in ("--", *arguments)) if arguments else ""))
        for line in scene:
            manager.must(line)
        manager.must(f"step {ticks}", timeout=120)
        return manager, manager.hash()

    def column(self, manager, name, program="walker"):
        line = next(line for line in manager.must("manipulators").splitlines() if line.startswith(program + " "))
        return re.search(rf" {name}=(\S+)", line)[1]

    def lives(self):
        """What each life of the walker heard."""
        return [("hello" + life).splitlines() for life in (self.folder / "heard").read_text().split("hello")[1:]]


class Checkpoint(Checkpoints):
    def test_how_often_does_not_matter(self):
        hashes = {every: self.walk(every=every)[1] for every in ("off", "every 1", "every 7", "every 1000000 1")}
        self.assertEqual(len(set(hashes.values())), 1, hashes)

    def test_every_fault_around_a_checkpoint_leaves_no_trace(self):
        expected = self.walk()[1]
        for fault in ("kill", "exit", "hang", "stop", "close", "half", "garbage", "flood", "foreign", "range", "nan", "unit", "past", "twice"):
            for stage in ("checkpoint", "tick", "set", "done"):
                if fault in ("past", "twice", "flood", "garbage") and stage == "done":
                    continue
                with self.subTest(f"{fault} at {stage}"):
                    manager, got = self.walk(fault, stage, "23")
                    self.assertTrue((self.folder / "fault.done").exists(), "the fault did not happen")
                    self.assertEqual(got, expected)
                    self.assertEqual(manager.must("get w.steps"), "40")
                    self.assertEqual(manager.must("get probe.visible"), "true")
                    manager.end()

    def test_a_restart_is_told_the_world_and_what_came_after_the_checkpoint(self):
        expected = self.walk(every="off", ticks=230)[1]
        manager, _ = self.walk("log", every="every 20", ticks=215)
        self.assertEqual(self.column(manager, "checkpoint"), "200")
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step 15")
        self.assertEqual(manager.hash(), expected)
        first, second = self.lives()
        self.assertEqual(len([line for line in first if line.startswith("tick")]), 215)
        ticks = [line.split()[1] for line in second if line.startswith("tick")]
        self.assertEqual(ticks, [str(tick) for tick in range(201, 231)])
        # its own values come back, the private ones as they were written
        self.assertTrue([line for line in second if line.startswith("set w.state ")])
        self.assertTrue([line for line in second if line.startswith("set w.position ")])

    def test_what_is_kept_does_not_grow_with_the_run(self):
        manager, _ = self.walk(every="every 20", ticks=100)
        before = int(self.column(manager, "log"))
        for tick in range(300):
            manager.must(f"set w.reach {0.1 + tick % 7 / 10}")
            manager.must("step 5")
        self.assertLess(int(self.column(manager, "log")), before + 300 * 40)
        for _ in range(200):
            manager.send(b"".join(b"set w.reach 0.%d\nset v.reach 0.%d\nstep\n" % (n, n) for n in range(1, 51)))
            manager.must("time")
        # 20 000 lines of 18 bytes and 10 000 ticks were told meanwhile
        self.assertLess(int(self.column(manager, "log")), 300_000)
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step")
        manager.must("expect w.steps == 11601")

    def test_a_program_without_checkpoint_is_told_everything(self):
        self.script("plain", "while read verb n rest; do\necho $verb $n >> told\n"
                    "case $verb in hello) echo 'type thing'; echo 'field thing.n int'; echo 'writes thing.n'; echo ready;;\n"
                    "tick) echo set a.n $n; echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("checkpoints every 2", "start ./plain", "create thing a", "step 9"):
            manager.must(line)
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step")
        self.assertEqual(manager.must("get a.n"), "10")
        told = (self.folder / "told").read_text().splitlines()
        self.assertNotIn("checkpoint", told)
        again = told[len(told) - 1 - told[::-1].index("hello protocol=1"):]
        self.assertEqual([line for line in again if line.startswith("tick")], [f"tick {n}" for n in range(1, 11)])

    def test_a_program_without_memory_says_so_and_is_told_the_world(self):
        self.script("plain", "while read verb n rest; do\necho $verb $n >> told\n"
                    "case $verb in hello) echo 'type thing'; echo 'field thing.n int'; echo 'writes thing.n'; echo checkpoint; echo ready;;\n"
                    "checkpoint) echo done;; tick) echo set a.n $n; echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("checkpoints every 3", "start ./plain", "create thing a", "step 8"):
            manager.must(line)
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step")
        told = (self.folder / "told").read_text().splitlines()
        again = told[len(told) - 1 - told[::-1].index("hello protocol=1"):]
        self.assertEqual(again, ["hello protocol=1", "create thing", "set a.n", "tick 7", "tick 8", "tick 9"])

    def test_a_program_that_cannot_write_it_down_is_asked_no_longer(self):
        self.script("mute", "while read verb n rest; do\n"
                    "case $verb in hello) echo 'type thing'; echo 'field thing.n int private'; echo 'timeout 0.2s'; echo ready;;\n"
                    "checkpoint) read forever;; tick) echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("checkpoints every 2", "start ./mute", "create thing a"):
            manager.must(line)
        manager.must("step 20", timeout=30)
        manager.event("^event checkpoint mute is asked for no longer")
        self.assertEqual(self.column(manager, "restarts", "mute"), "2")

    def test_a_checkpoint_with_a_mistake_is_not_taken(self):
        # the second object's state is out of its range: the first one's must not count either
        self.script("wrong", "while read verb n rest; do\necho $verb $n $rest >> told\n"
                    "case $verb in hello) echo 'type thing'; echo 'field thing.n int = 0 in 0 9 private'; echo 'field thing.m int'\n"
                    "echo 'writes thing.m'; echo ready;;\n"
                    "checkpoint) echo set a.n 5; echo set a.m 3; echo set b.n 77; echo done;; tick) echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("checkpoints every 2", "start ./wrong", "create thing a", "create thing b", "step 8"):
            manager.must(line)
        self.assertEqual(manager.must("get a.m"), "3", "what else it said counts")
        self.assertEqual(self.column(manager, "refused", "wrong"), "3")
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step")
        told = (self.folder / "told").read_text().splitlines()
        again = told[len(told) - 1 - [line.split()[0] for line in told[::-1]].index("hello"):]
        self.assertEqual([line for line in again if "tick" in line.split()[:1]][0].split()[1], "1")

    def test_the_words_of_the_verb(self):
        manager, _ = self.walk(every="off", ticks=3)
        self.assertEqual(self.column(manager, "checkpoint"), "0")
        self.assertEqual(manager.must("checkpoints"), "off")
        manager.must("checkpoints now")
        manager.must("step")
        self.assertEqual(self.column(manager, "checkpoint"), "3")
        before = manager.hash()
        for line, kind in (("checkpoints every", "syntax"), ("checkpoints often", "syntax"), ("checkpoints every 0", "range"), ("checkpoints every 2.5", "range"),
                           ("checkpoints every 5 -1", "range"), ("checkpoints every 5 5 5", "syntax")):
            manager.refused(line, kind)
            self.assert_recovered(manager, before)

    def test_private_state_is_no_part_of_the_hash_and_stands_in_the_world(self):
        manager, before = self.walk(every="off", ticks=3)
        manager.must("checkpoints now")
        state = manager.must("get w.state")
        manager.must("step")
        self.assertNotEqual(manager.must("get w.state"), state)
        self.assertRegex(manager.must("why w.state"), "by walker at tick 3")

    def test_objects_keep_the_order_in_which_they_were_met(self):
        # b is met when a names it; a program that goes through its objects in order must find them so again
        self.script("order", "while read verb n rest; do\necho $verb $n $rest >> told\n"
                    "case $verb in hello) echo 'reads link'; echo checkpoint; echo ready;;\n"
                    "checkpoint) echo done;; tick) echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("type link extends node", "field link.next ref:node", "create node b", "create link a", "checkpoints every 2", "start ./order", "step",
                     "set a.next b", "step 4"):
            manager.must(line)
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step")
        told = (self.folder / "told").read_text().splitlines()
        again = told[len(told) - 1 - [line.split()[0] for line in told[::-1]].index("hello"):]
        self.assertEqual([line for line in again if line.startswith(("create", "set"))], ["create link a", "create node b", "set a.next b"])

    def test_a_program_that_dies_after_its_answer_while_another_computes(self):
        self.script("tortoise", "while read verb n rest; do\n"
                    "case $verb in hello) echo ready;; tick) [ $n = 10 ] && sleep 0.5; echo done $n;; *) ;; esac\ndone\n")
        scene = SCENE + ["start ./tortoise"]
        expected = self.walk(scene=scene)[1]
        manager, got = self.walk("kill", "done", "10", scene=scene)
        manager.event("gone walker killed 9")
        self.assertEqual(got, expected)

    def test_a_delayed_read_sees_the_tick_before_also_from_an_earlier_stage(self):
        self.script("first", "while read verb n rest; do\n"
                    "case $verb in hello) echo 'type thing'; echo 'field thing.n int'; echo 'field thing.m int'; echo 'writes thing.n'; echo ready;;\n"
                    "tick) echo set a.n $n; echo done $n;; esac\ndone\n")
        self.script("second", "while read verb n rest; do\necho $verb $n $rest >> told\n"
                    "case $verb in hello) echo 'reads thing.m'; echo 'reads thing.n delayed'; echo ready;; tick) echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("start ./first", "start ./second", "create thing a", "step 4"):
            manager.must(line)
        told = [line.split()[:3] for line in (self.folder / "told").read_text().splitlines() if line.startswith(("set", "tick"))]
        self.assertEqual([" ".join(words[:2] if words[0] == "tick" else words) for words in told],
                         ["tick 1", "set a.n 1", "tick 2", "set a.n 2", "tick 3", "set a.n 3", "tick 4"])

    def test_fields_that_come_later_are_told(self):
        self.script("late", "while read verb n rest; do\necho $verb $n $rest >> told\n"
                    "case $verb in hello) echo 'reads thing'; echo checkpoint; echo ready;; checkpoint) echo done;; tick) echo done $n;; esac\ndone\n")
        self.script("other", "while read verb n rest; do\n"
                    "case $verb in hello) echo 'field thing.late real m'; echo 'field node.mark int'; echo ready;; tick) echo done $n;; esac\ndone\n")
        manager = self.manager()
        for line in ("type thing extends node", "create thing a", "start ./late", "step", "start ./other", "set a.late 2", "set a.mark 5", "checkpoints every 1", "step 3"):
            manager.must(line)
        told = (self.folder / "told").read_text().splitlines()
        self.assertLess(told.index("field thing.late real m"), told.index("set a.late 2"))
        self.assertLess(told.index("field node.mark int"), told.index("set a.mark 5"))
        os.kill(children(manager.pid)[0], signal.SIGKILL)
        manager.must("step")
        again = (self.folder / "told").read_text().splitlines()[len(told):]
        self.assertLess(again.index("field thing.late real m"), again.index("set a.late 2"))

    def test_a_resumed_session_is_told_what_came_after_the_checkpoint(self):
        expected = self.walk(every="every 20", ticks=60)[1]
        manager, _ = self.walk("log", every="every 20", ticks=50, journal=("--journal", "kept"))
        os.kill(manager.pid, signal.SIGKILL)
        manager.process.wait()
        (self.folder / "heard").unlink()
        other = self.manager("--resume", "kept")
        other.must("step 10")
        self.assertEqual(other.hash(), expected)
        ticks = [line.split()[1] for line in self.lives()[0] if line.startswith("tick")]
        self.assertEqual(ticks[0], "41")
        # and again, after a resumed session that ended badly
        os.kill(other.pid, signal.SIGKILL)
        other.process.wait()
        third = self.manager("--resume", "kept")
        self.assertEqual(third.hash(), expected)
        replayed = self.manager()
        replayed.must("replay kept")
        self.assertEqual(replayed.hash(), expected)

    def test_a_journal_cut_within_a_checkpoint(self):
        manager, _ = self.walk(every="every 4", ticks=12, journal=("--journal", "kept"))
        manager.finish()
        data = (self.folder / "kept").read_bytes()
        lines = data.splitlines(keepends=True)
        places = [n for n, line in enumerate(lines) if b" checkpoint - " in line or b"set w.state" in line or b"set v.state" in line]
        self.assertGreater(len(places), 6)
        hashes = {}
        for ticks in range(4, 13):
            manager, hashes[ticks] = self.walk(every="off", ticks=ticks)
            manager.end()
        for place in places:
            for length in (sum(map(len, lines[:place])), sum(map(len, lines[:place + 1]))):
                with self.subTest(lines[place]):
                    name = f"cut{place}.{length}"
                    self.file(name, data[:length])
                    other = self.manager("--resume", name)
                    steps = int(other.must("get w.steps"))
                    self.assertEqual(other.hash(), hashes[steps])
                    other.must(f"step {12 - steps}")
                    self.assertEqual(other.hash(), hashes[12])
                    other.end()


SAILOR = """start render
start arm_ik
start head_ik
start eye_control
source figures/sailor.dlg under sailor
create sphere ball radius 4cm position -0.30 1.15 0.42
reach sailor/right_arm ball
look sailor ball
"""


class Sailors(Checkpoints):
    """The real programs: whole state, the same bits."""

    # the ball goes round, with a jump now and then, so that eyes make saccades and the arm changes its way
    ROUND = [f"set ball.position {x} {y} {z}" for x, y, z in
             ((-0.3, 1.15, 0.42), (-0.2, 1.42, 0.45), (0.1, 1.22, 0.42), (-0.1, 1.04, 0.45), (0.3, 1.6, 0.3), (-0.6, 0.9, 0.2), (-0.25, 1.3, 0.4))]

    def run_sailor(self, ticks, every, kill=lambda manager, tick: None, chunk=20):
        manager = self.manager("--seed", "5")
        manager.must(f"checkpoints {every}")
        self.file("sailor.dlg", SAILOR)
        manager.must("source sailor.dlg", timeout=60)
        for tick in range(0, ticks, chunk):
            manager.must(self.ROUND[tick // chunk % len(self.ROUND)])
            kill(manager, tick)
            manager.must(f"step {chunk}", timeout=300)
        return manager, manager.hash()

    def killer(self, seed, odds, cadence=2.1):
        """Ends one of the programs now and then, at a random moment of the ticks that follow."""
        chance = random.Random(seed)
        last = [0.0]

        def kill(manager, tick):
            if chance.random() > odds:
                return
            # more than five starts in ten seconds would be taken for a fault of the program
            time.sleep(max(0, last[0] + cadence - time.monotonic()))
            last[0] = time.monotonic()
            victim = int(self.column(manager, "pid", chance.choice(["arm_ik", "head_ik", "eye_control"])))
            self.killed = getattr(self, "killed", 0) + 1
            manager.send(b"@k step %d\n" % (ahead := chance.randrange(1, 12)))
            time.sleep(chance.random() * 0.003 * ahead)
            os.kill(victim, signal.SIGKILL)
            assert manager.answer("k", 60).ok
            manager.must(f"step {12 - ahead}", timeout=60)

        return kill

    def test_each_of_them_goes_on_with_the_same_bits(self):
        def rest(manager, tick):
            if tick % 100 == 60:
                manager.must("step 12")

        expected = self.run_sailor(200, "off", rest)[1]
        for program in ("arm_ik", "head_ik", "eye_control"):
            with self.subTest(program):
                def kill(manager, tick, program=program):
                    if tick % 100 != 60:
                        return
                    manager.must("step 7")
                    os.kill(int(self.column(manager, "pid", program)), signal.SIGKILL)
                    manager.must("step 5")

                manager, got = self.run_sailor(200, "every 25", kill)
                self.assertEqual(self.column(manager, "restarts", program), "2")
                self.assertNotEqual(self.column(manager, "checkpoint", program), "0")
                self.assertEqual(got, expected)
                manager.end()


class SlowSailors(Sailors):
    def test_twenty_thousand_ticks_with_kills(self):
        chance_odds, seed = 0.03, 11
        first = random.Random(seed)

        def undisturbed(manager, tick):
            if first.random() > chance_odds:
                return
            first.choice([0, 1, 2])
            first.randrange(1, 12)
            first.random()
            manager.must("step 12")

        manager, expected = self.run_sailor(20_000, "every 60", undisturbed)
        manager.end()
        disturbed, got = self.run_sailor(20_000, "every 60", self.killer(seed, chance_odds))
        self.assertGreater(self.killed, 10)
        self.assertEqual(got, expected)
        self.assertLess(int(self.column(disturbed, "log", "eye_control")), 2 << 20)

    def test_the_cost_of_a_restart_is_flat(self):
        costs = []
        for ticks in (600, 6000):
            manager, _ = self.run_sailor(ticks, "every 60")
            taken = []
            for _ in range(5):
                os.kill(int(self.column(manager, "pid", "arm_ik")), signal.SIGKILL)
                began = time.monotonic()
                manager.must("step", timeout=60)
                taken.append(time.monotonic() - began)
                time.sleep(2.1)
            costs.append(sorted(taken)[2])
            manager.end()
        # ten times the run; a factor of two for the noise of a shared machine
        self.assertLess(costs[1], 2 * costs[0] + 0.02, costs)


if __name__ == "__main__":
    sailor.main()
