"""The storm: programs are killed at random, a FIFO is flooded, nobody reads; the world ends as in calm weather."""

import contextlib
import fcntl
import os
import pathlib
import queue
import random
import re
import signal
import subprocess
import threading
import time

import sailor
from sailor import BIN, PROGRAMS, SOURCE, Case, children, descendants, until

# every line is refused or only looks: nothing of the flood may change the world
FLOOD = (b"set nowhere.position 1 2 3\nnonsense\nset ball.position nan 0 0\n# nothing\n\x00\xff\xfe\nexpect 1 == 2\nundo\x01\n"
         b"create sphere nowhere/ball\nstep 0\nbegin now\n" + b"x" * 5000 + b"\n") * 3

WALK = """start walker as a serving left*
start walker as b serving right*
start wave
create sphere ball
create walker left1
create walker right1 reach 0.7
create wave sea height 0.4
at 0.1 set sea.height 0.9
every 150ms set left1.reach 0.2
run 4.6s
"""


def reach():
    """The scene without its pictures: four programs, a ball that is carried about, assertions on the way."""
    text = (SOURCE / "scripts/scenes/reach.dlg").read_text()
    return re.sub(r"(?m)^snapshot .*$", "", text)


class Storms(Case):
    def end_of(self, text):
        """The undisturbed hash of a scene."""
        self.file("calm.dlg", text + "hash\n")
        done = self.run_manager("--seed", "7", "calm.dlg", timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def storm(self, text, pace, seed, between):
        """The hash of a scene in bad weather, and how often a program was killed."""
        chance = random.Random(seed)
        for name in ("ear", "deaf", "kept"):
            (self.folder / name).unlink(missing_ok=True)
        os.mkfifo(self.folder / "ear", 0o600)
        os.mkfifo(self.folder / "deaf", 0o600)
        # a reader that is there and never reads
        deaf = os.open(self.folder / "deaf", os.O_RDONLY | os.O_NONBLOCK)
        fcntl.fcntl(deaf, fcntl.F_SETPIPE_SZ, 4096)
        reading, unread = os.pipe()
        shared = set(pathlib.Path("/dev/shm").iterdir())
        starts = re.findall(r"(?m)^start .*$", text)
        first_run = re.search(r"(?m)^run ", text).start()
        self.file("storm.dlg", f"listen ear\n{text[:first_run]}watch **\ntrace deaf ball.position ball.world_position\n{text[first_run:]}")
        manager = self.manager("--seed", "7", "--journal", "kept", "--pace", pace, "-i", "storm.dlg", "-c", "echo arrived", stderr=unread)
        os.close(unread)
        stop = threading.Event()
        seen = set()

        def flood():
            out = os.open(self.folder / "ear", os.O_WRONLY)
            with contextlib.suppress(BrokenPipeError):
                while not stop.is_set():
                    os.write(out, FLOOD[:4096 + chance.randrange(4096)])
            os.close(out)

        flooder = threading.Thread(target=flood)
        trace_ended = False
        kills, peak, settled, next_kill = 0, 0, 0, time.monotonic() + 0.3
        deadline = time.monotonic() + 300
        try:
            until(lambda: len(children(manager.pid)) == len(starts), "all programs", 60)
            flooder.start()
            while True:
                with contextlib.suppress(queue.Empty):
                    line = manager.lines.get(timeout=0.02)
                    self.assertIsNotNone(line, "the manager ended")
                    if line == "  arrived":
                        break
                    self.assertFalse(line.startswith("error"), line)
                    trace_ended = trace_ended or line.startswith("event trace deaf ended")
                self.assertLess(time.monotonic(), deadline, "the scene does not end")
                if time.monotonic() < next_kill:
                    continue
                everything = children(manager.pid)
                seen |= set(descendants(manager.pid))
                if len(everything) == len(starts):
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(chance.choice(everything), chance.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV)))
                        kills += 1
                # no more than 5 starts of one program in 10 s, or it is given up
                next_kill = time.monotonic() + between * (0.7 + 0.6 * chance.random())
                size = int(re.search(r"VmRSS:\s+(\d+) kB", pathlib.Path(f"/proc/{manager.pid}/status").read_text())[1])
                settled = settled or size
                peak = max(peak, size)
        finally:
            stop.set()
            os.close(reading)
        got = manager.hash()
        self.assertTrue(trace_ended, "nobody reads the trace, and nobody was told")
        seen |= set(descendants(manager.pid))
        manager.must("unlisten ear")
        flooder.join(20)
        self.assertFalse(flooder.is_alive(), "the flooder hangs")
        manager.finish(30)
        os.close(deaf)
        for pid in seen:
            until(lambda pid=pid: not sailor.alive(pid), f"process {pid} outlived the manager")
        self.assertFalse(set(pathlib.Path("/dev/shm").iterdir()) - shared)
        if settled and not sailor.SANITIZED:
            self.assertLess(peak - settled, 40 << 10, f"kB: from {settled} to {peak}")
        done = self.run_manager("--resume", "kept", "-c", "hash", timeout=120)
        self.assertEqual(done.stdout.strip(), got, done.stderr)
        return got, kills


class Storm(Storms):
    def test_small_programs(self):
        expected = self.end_of(WALK)
        got, kills = self.storm(WALK, "1", 1, 0.9)
        self.assertEqual(got, expected)
        self.assertGreater(kills, 2)


class SlowStorm(Storms):
    def test_the_reach_scene(self):
        missing = [name for name in ("arm_ik", "head_ik", "eye_control", "render") if not (BIN / name).exists()]
        if missing:
            self.skipTest(f"{missing[0]} is not built")
        expected = self.end_of(reach())
        total = 0
        for seed, pace in ((1, "1"), (2, "0.5"), (3, "0.25"), (4, "0.1")):
            with self.subTest(seed=seed):
                got, kills = self.storm(reach(), pace, seed, 3.0)
                self.assertEqual(got, expected)
                total += kills
        self.assertGreater(total, 15)

    def test_small_programs_for_a_minute(self):
        expected = self.end_of(WALK)
        got, kills = self.storm(WALK, "0.08", 5, 3.0)
        self.assertEqual(got, expected)
        self.assertGreater(kills, 12)


if __name__ == "__main__":
    sailor.main()
