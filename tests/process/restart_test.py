"""A program killed at every stage of its life, and of the life after that: the world ends as if nothing had happened."""

import sailor
from sailor import Case, alive, children, descendants, until, zombies

# one life: what it is told and says in order; joined by a comma, two lives in a row
FIRST = ("told", "tick", "set", "done", "verb", "verbset", "verbdone", "checkpoint", "checkpointset", "checkpointdone")
AGAIN = ("hello", "declare", "ready", "told", "tick", "set", "done", "verb", "verbset", "verbdone")


class Lives(Case):
    def live(self, *arguments):
        """A session of the walker with ticks, a verb and what a person changes between: manager and hash."""
        (self.folder / "fault.done").unlink(missing_ok=True)
        manager = self.manager("--seed", "3")
        for line in ("create node probe", "checkpoints every 7", "start walker" + ("".join(" " + word for word in ("--", *arguments)) if arguments else ""),
                     "create walker w", "create walker v reach 0.5", "step 12", "jump w", "set v.reach 0.3", "step 12", "set w.position 1 2 3",
                     "create walker late", "jump v", "step 12", "delete late", "jump w", "step 3"):
            manager.must(line, timeout=60)
        return manager, manager.hash()

    def check(self, fault, stages, expected):
        with self.subTest(f"{fault} at {stages}"):
            manager, got = self.live(fault, stages, "9")
            self.assertEqual((self.folder / "fault.done").stat().st_size, len(stages.split(",")), "the fault did not happen")
            self.assertEqual(got, expected)
            until(lambda: len(children(manager.pid)) == 1 and not zombies(manager.pid), "one program and no zombie")
            # a good command works at once, and time goes on
            manager.must("set probe.visible false")
            manager.must("step", timeout=60)
            everything = descendants(manager.pid)
            self.assertEqual(manager.finish(), 0)
            for pid in everything:
                until(lambda pid=pid: not alive(pid), "it outlived the manager")


class Restart(Lives):
    def test_killed_at_every_stage(self):
        _, expected = self.live()
        for stage in FIRST:
            self.check("kill", stage, expected)

    def test_killed_again_in_the_life_after(self):
        _, expected = self.live()
        for first, again in (("tick", "hello"), ("set", "declare"), ("done", "ready"), ("tick", "told"), ("tick", "tick"), ("verbset", "verbset"),
                             ("verb", "hello"), ("checkpointset", "tick"), ("verbdone", "done")):
            self.check("kill", f"{first},{again}", expected)

    def test_an_early_end_of_other_kinds(self):
        _, expected = self.live()
        for fault, stage in (("exit", "verbset"), ("close", "verbdone"), ("half", "checkpointset"), ("exit3", "tick,ready")):
            self.check(fault, stage, expected)


class SlowRestart(Lives):
    def test_every_pair_of_stages(self):
        _, expected = self.live()
        for first in FIRST:
            for again in AGAIN:
                self.check("kill", f"{first},{again}", expected)

    def test_every_kind_of_end_at_every_stage(self):
        _, expected = self.live()
        for fault in ("exit", "exit3", "close", "half", "stop", "hang", "garbage", "usage", "memory"):
            for stage in FIRST:
                self.check(fault, stage, expected)


if __name__ == "__main__":
    sailor.main()
