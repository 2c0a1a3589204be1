"""Signals at every stage of a session: it ends at once with what it started, and leaves nothing behind."""

import os
import pathlib
import signal
import time

import sailor
from sailor import Case, children, descendants, until, zombies

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


class Signals(Case):
    def start(self, stage):
        """A manager in the middle of something."""
        manager = self.manager("--journal", "kept")
        for line in ("create node probe", "listen ear", "start walker", "create walker w", "trace t.csv w.position", "watch w.position"):
            manager.must(line)
        getattr(self, stage)(manager)
        return manager

    def idle(self, manager):
        pass

    def a_run(self, manager):
        manager.must("pace realtime")
        manager.send(b"@r run 1000\n")
        until(lambda: self.stepped(manager), "it runs")

    def a_fast_run(self, manager):
        manager.send(b"@r run 1000000\n")
        until(lambda: self.stepped(manager), "it runs")

    def time_by_itself(self, manager):
        manager.must("resume")
        until(lambda: self.stepped(manager), "it runs")

    def stepped(self, _):
        return b"set w.position" in (self.folder / "kept").read_bytes()

    def a_start(self, manager):
        manager.send(b"@s start walker as two -- hang! hello\n")
        until(lambda: len(children(manager.pid)) == 2, "the second program")

    def a_tick_that_hangs(self, manager):
        manager.must("start walker as two serving none* -- hang! tick")
        manager.send(b"@r step\n")
        time.sleep(0.05)

    def a_verb(self, manager):
        manager.must("end walker")
        manager.must("start walker -- hang! verb")
        manager.send(b"@v jump w\n")
        time.sleep(0.05)

    def a_pause_before_a_restart(self, manager):
        manager.must("end walker")
        manager.must("start walker -- kill! tick")
        manager.send(b"@r step\n")
        manager.event("gone walker")
        time.sleep(0.02)

    def a_restart_that_takes_its_time(self, manager):
        program = self.folder / "slow"
        program.write_text("#!/bin/sh\nif [ -e again ]; then sleep 0.3; fi\n: > again\n"
                           f"exec {sailor.PROGRAMS}/walker kill! tick\n")
        program.chmod(0o755)
        (self.folder / "again").unlink(missing_ok=True)
        manager.must("end walker")
        manager.must("start ./slow as walker")
        manager.send(b"@r step\n")
        manager.event("gone walker")
        time.sleep(0.1)

    def a_transaction(self, manager):
        manager.must("begin")
        manager.must("set w.reach 0.3")

    def a_long_script(self, manager):
        self.file("long.dlg", "set probe.visible false\nset probe.visible true\n" * 300000)
        manager.send(b"@s source long.dlg\n")
        time.sleep(0.02)

    def a_replay(self, manager):
        manager.must("step 2000", timeout=60)
        manager.must("branch other")
        manager.send(b"@r replay other\n")
        time.sleep(0.02)

    def half_a_line(self, manager):
        manager.send(b"set probe.visi")

    def an_end_that_is_not_heard(self, manager):
        manager.must("end walker")
        manager.must("start walker -- hang! quit")
        manager.send(b"quit\n")
        time.sleep(0.05)

    def answers_that_nobody_reads(self, manager):
        manager.send(b"help\n" * 2000)
        time.sleep(0.05)

    STAGES = ("idle", "a_run", "a_fast_run", "time_by_itself", "a_start", "a_tick_that_hangs", "a_verb", "a_pause_before_a_restart",
              "a_restart_that_takes_its_time", "a_transaction",
              "a_long_script", "a_replay", "half_a_line", "an_end_that_is_not_heard", "answers_that_nobody_reads")

    def check(self, stage, number):
        for name in ("kept", "other", "t.csv"):
            (self.folder / name).unlink(missing_ok=True)
        shared = set(pathlib.Path("/dev/shm").iterdir())
        manager = self.start(stage)
        everything = descendants(manager.pid)
        until(lambda: not zombies(manager.pid), "zombies")
        began = time.monotonic()
        os.kill(manager.pid, number)
        status = manager.process.wait(sailor.PATIENCE)
        # a program that does not listen gets 2 s, one that ignores that 2 s more
        self.assertLess(time.monotonic() - began, 6 if not sailor.SANITIZED else 20)
        # where it was at its end already it may have ended by itself
        self.assertIn(status, (128 + number, 0) if stage == "an_end_that_is_not_heard" else (128 + number,))
        for pid in everything:
            until(lambda pid=pid: not sailor.alive(pid), f"process {pid} outlived the manager")
        self.assertFalse(set(pathlib.Path("/dev/shm").iterdir()) - shared)
        self.assertFalse((self.folder / "ear").exists(), "its FIFO was left")
        self.assertFalse(list(self.folder.glob("*.part")))
        # what was kept can be gone on with
        done = self.run_manager("--resume", "kept", "-c", "get w.steps", timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_every_stage(self):
        for at, stage in enumerate(self.STAGES):
            number = SIGNALS[at % len(SIGNALS)]
            with self.subTest(f"{number.name} in {stage}"):
                self.check(stage, number)

    def test_a_signal_again_and_again(self):
        manager = self.start("a_fast_run")
        everything = descendants(manager.pid)
        for _ in range(50):
            try:
                os.kill(manager.pid, signal.SIGTERM)
                os.kill(manager.pid, signal.SIGHUP)
            except ProcessLookupError:
                break
        self.assertIn(manager.process.wait(sailor.PATIENCE), (128 + signal.SIGTERM, 128 + signal.SIGHUP))
        for pid in everything:
            until(lambda pid=pid: not sailor.alive(pid), "it outlived the manager")

    def test_stopped_and_continued_is_as_if_nothing_had_been(self):
        manager = self.start("idle")
        manager.must("pace realtime")
        manager.send(b"@r run 300ms\n")
        os.kill(manager.pid, signal.SIGSTOP)
        time.sleep(0.4)
        os.kill(manager.pid, signal.SIGCONT)
        self.assertTrue(manager.answer("r").ok)
        manager.must("get w.steps")
        self.assertFalse([event for event in manager.events if "gone" in event], manager.events)


class SlowSignals(Signals):
    def test_every_signal_in_every_stage(self):
        for stage in self.STAGES:
            for number in SIGNALS:
                with self.subTest(f"{number.name} in {stage}"):
                    self.check(stage, number)


if __name__ == "__main__":
    sailor.main()
