"""Long arrays: by shared memory or as text, the same world; what is wrong is refused; what dies leaves no trace."""

import os
import pathlib
import re
import resource
import signal
import struct
import time

import sailor
from sailor import Case, children, until

TEXT = "with env SAILOR_ARRAYS=text"


class Arrays(Case):
    def sheets(self, ticks, *, fill="", read="", count=2000, journal=(), kill=lambda manager, tick: None, chunk=None, every="every 5"):
        """A run with a program that fills and one that reads: manager and hash."""
        manager = self.manager("--seed", "3", *journal)
        for line in (f"checkpoints {every}", f"start sheets as fill {fill} -- fill", f"start sheets as read {read} -- read", f"create sheet s count {count}", "create reader r"):
            manager.must(line)
        chunk = chunk or ticks
        for tick in range(0, ticks, chunk):
            kill(manager, tick)
            manager.must(f"step {chunk}", timeout=300)
        return manager, manager.hash()

    def paint(self, *words, ticks=12, **options):
        (self.folder / "fault.done").unlink(missing_ok=True)
        manager = self.manager(**options)
        for line in ("start painter" + "".join(" " + word for word in ("--", *words) if words), "create sheet sheet", "create node probe"):
            manager.must(line)
        manager.must(f"step {ticks}", timeout=60)
        return manager, manager.hash()

    def assert_unharmed(self, manager, before):
        """As assert_recovered(), of a world that has no probe."""
        self.assertEqual(manager.hash(), before, "the world has changed")
        manager.must("create node probe")
        self.assert_recovered(manager, manager.hash())
        manager.must("delete probe")
        self.assertEqual(manager.hash(), before, "the world has changed")

    def resident(self, manager):
        """Bytes of memory that it has now."""
        return int(re.search(r"VmRSS:\s+(\d+) kB", pathlib.Path(f"/proc/{manager.pid}/status").read_text())[1]) * 1024

    def pid(self, manager, name):
        line = next(line for line in manager.must("manipulators").splitlines() if line.startswith(name + " "))
        return int(re.search(r" pid=(\d+)", line)[1])


class Array(Arrays):
    def test_by_memory_and_as_text_the_world_is_the_same(self):
        hashes = {}
        for fill in ("", TEXT):
            for read in ("", TEXT):
                manager, hashes[fill, read] = self.sheets(12, fill=fill, read=read)
                self.assertEqual(manager.must("get r.torn"), "0")
                self.assertEqual(manager.must("get r.frames"), "12")
                self.assertRegex(manager.must("why s.points").splitlines()[1], "put s.points slot=" if not fill else "set s.points")
                manager.end()
        self.assertEqual(len(set(hashes.values())), 1, hashes)

    def test_everything_that_is_done_with_a_value(self):
        manager, _ = self.sheets(5)
        self.assertEqual(manager.must("get s.points[1..2]"), "20.0029296875 20.00390625 20.0048828125 20.005859375 20.0068359375 20.0078125")
        self.assertEqual(len(manager.must("get s.points").split()), 6000)
        self.assertIn('"points":[[20.0,20.0009765625,20.001953125],', manager.must("print --json s.points"))
        # a person writes an element, then undoes it
        before = manager.hash()
        manager.must("set s.points[0] 1 2 3")
        self.assertEqual(manager.must("get s.points[0]"), "1 2 3")
        manager.must("undo")
        self.assertEqual(manager.hash(), before)
        manager.must("save world.dlg")
        manager.must("watch s.points")
        manager.must("step")
        event = manager.event("^event s.points 24 24.0009765625 ")
        self.assertEqual(len(event.split()), 6002)
        other = self.manager()
        other.must("source world.dlg")
        self.assertEqual(other.hash(), before)

    def test_an_array_grows_and_shrinks(self):
        manager, _ = self.sheets(3)
        for count in (100, 5000, 20000, 1, 0, 2000):
            manager.must(f"set s.count {count}")
            manager.must("step 3")
            self.assertEqual(len(manager.must("get s.points").split()), max(3 * count, 1))
            self.assertEqual(manager.must("get r.torn"), "0")

    def refused_of(self, manager, count):
        """The complaints, which are read beside the answers: so many come, more are not waited for."""
        def complaints():
            return [line for line in manager.errors if "refused" in line]
        until(lambda: len(complaints()) >= count, "the complaint is told")
        return complaints()

    def test_mistakes_are_refused_and_leave_no_trace(self):
        expected = self.paint()[1]
        for mistake, kind, sentence in (
                ("stale", "range", "seq is 4, expected 5"), ("ahead", "range", "seq is 6, expected 5"), ("unfilled", "range", "holds sequence 2, expected 5"),
                ("slot", "range", r"slot is 0, expected 2 \(seq modulo 3\)"), ("long", "range", "holds 1099511627776 numbers, expected at most 1500"),
                ("nan", "range", "not finite"), ("inf", "range", "not finite"), ("words", "syntax", "expected put PATH.FIELD slot=K seq=N"),
                ("foreign", "owner", "was given no memory for probe.points"), ("odd", "range", r"is a vec3\[\], the slot holds 1000 numbers")):
            with self.subTest(mistake):
                manager, got = self.paint(mistake, "6")
                self.assertTrue((self.folder / "fault.done").exists(), "the mistake was not made")
                self.assertEqual(got, expected)
                refused = self.refused_of(manager, 2 if mistake == "words" else 1)
                self.assertRegex(refused[0], f"painter: refused: {kind} .*{sentence}")
                self.assertEqual(len(refused), 2 if mistake == "words" else 1)
                self.assert_recovered(manager, expected)
                manager.end()

    def test_a_person_cannot_announce(self):
        manager, before = self.paint(ticks=3)
        manager.refused("put sheet.points slot=1 seq=1", "owner", "expected set")
        manager.refused("put sheet.points slot=1", "syntax")
        self.assert_recovered(manager, before)

    def test_a_program_that_dies_around_an_announcement(self):
        expected = self.paint()[1]
        for mistake in ("kill", "kill_half", "announced"):
            with self.subTest(mistake):
                manager, got = self.paint(mistake, "6")
                manager.event("gone painter killed 9")
                self.assertEqual(got, expected)

    def test_what_was_announced_is_taken_at_once(self):
        # the program writes other numbers into the slot after it was announced: they are not the world's, or the line is refused
        manager, _ = self.paint("scribble", "1")
        self.assertIn(manager.must("get sheet.points[0]").split()[0], [str(tick) for tick in range(1, 13)] + ["0"])

    def test_the_memory_is_whole_and_sealed(self):
        (self.folder / "look").touch()
        self.paint()
        first, *refusals = (self.folder / "look").read_text().splitlines()
        size, allocated = map(int, first.split())
        self.assertEqual(size, 4096 + 3 * 12288)
        self.assertGreaterEqual(allocated, size, "it is sparse")
        self.assertEqual(refusals, ["Operation not permitted"] * 2)

    def test_without_room_for_memory_it_stays_text(self):
        expected = self.paint()[1]

        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

        manager, got = self.paint(preexec=small)
        manager.event("^event array sheet.points stays text: shared memory has no room")
        self.assertEqual(got, expected)
        self.assertEqual(len([event for event in manager.events if "stays text" in event]), 1)

    def test_what_is_written_later_tears_nothing(self):
        # all slots are written over between two announcements: the world, its hash and a slow reader see nothing of it
        results = []
        for mistake in ("silent", "late"):
            manager = self.manager()
            for line in (f"start painter -- {mistake} 7", "start looker", "create sheet sheet", "create eye eye", "step 12"):
                manager.must(line)
            self.assertEqual(manager.must("get sheet.points[0]"), "6 6.0009765625 6.001953125")
            results.append((manager.hash(), manager.must("get sheet.points"), manager.must("get eye.sum")))
            self.assertEqual(manager.must("get eye.changed"), "0")
            self.assert_unharmed(manager, results[0][0])
            manager.end()
        self.assertEqual(results[0], results[1])
        self.assertEqual(float(results[0][2]), sum(6 + i / 1024 for i in range(1500)))

    def test_a_slow_reader_reads_where_the_numbers_stand_and_can_change_none(self):
        manager = self.manager()
        for line in ("start painter", "start looker", "create sheet sheet", "create eye eye"):
            manager.must(line)
        for tick in (6, 12, 18, 24):
            manager.must("step 6")
            self.assertEqual(float(manager.must("get eye.sum")), sum(tick + i / 1024 for i in range(1500)))
        self.assertEqual(manager.must("get eye.changed"), "0")
        self.assertEqual((self.folder / "tried").read_text().splitlines(), ["Operation not permitted"] * 4)
        self.assert_unharmed(manager, manager.hash())

    def test_more_frames_in_a_tick_than_there_are_slots(self):
        hashes = set()
        for fill in ("", TEXT):
            manager = self.manager()
            for line in (f"start sheets as fill {fill} -- fill", "start sheets as read -- read", "create sheet s count 2000", "create reader r", "step 3", "set s.times 7", "step 3"):
                manager.must(line)
            self.assertEqual(manager.errors, [])
            self.assertEqual(manager.must("get s.points[0]").split()[0], "24")
            hashes.add(manager.hash())
            manager.end()
        self.assertEqual(len(hashes), 1)

    def test_where_memory_ends_numbers_stay_with_the_manager(self):
        # room for the slots that the program fills, none for those that others read; then for some of these
        expected = self.paint()[1]
        for most in (45000, 60000):
            with self.subTest(most):
                def small(most=most):
                    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

                manager = self.manager(preexec=small)
                for line in ("start painter", "start sheets as read -- read", "create sheet sheet", "create node probe", "step 12"):
                    manager.must(line)
                manager.event("^event array sheet.points is told as text: shared memory has no room")
                self.assertEqual(len([event for event in manager.events if "told as text" in event]), 1)
                self.assertEqual(manager.must("get sheet.points[0]").split()[0], "12")
                self.assert_recovered(manager, manager.hash())
                manager.must("end read")
                self.assertEqual(manager.hash(), expected)
                manager.end()

    def test_killed_readers_and_writers_leave_no_trace(self):
        expected = self.sheets(60)[1]
        for name in ("fill", "read"):
            with self.subTest(name):
                def kill(manager, tick, name=name):
                    if tick % 30 == 15:
                        os.kill(self.pid(manager, name), signal.SIGKILL)

                manager, got = self.sheets(60, kill=kill, chunk=5)
                self.assertEqual(manager.must("get r.torn"), "0")
                self.assertEqual(got, expected)
                self.assertRegex(manager.must("manipulators"), rf"(?m)^{name} .*restarts=2")
                manager.end()

    def test_a_journal_keeps_arrays_beside_it(self):
        expected = self.sheets(20)[1]
        longer = self.sheets(30)[1]
        manager, got = self.sheets(20, journal=("--journal", "kept"), chunk=5)
        manager.must("branch other")
        self.assertEqual(got, expected)
        os.kill(manager.pid, signal.SIGKILL)
        manager.process.wait()
        arrays = self.folder / "kept.arrays"
        self.assertEqual(arrays.stat().st_mode & 0o777, 0o600)
        # the first frame of each life of the program is text
        self.assertEqual(arrays.stat().st_size, 19 * 6000 * 8)
        for name in ("kept", "other"):
            replayed = self.manager()
            replayed.must(f"replay {name}")
            self.assertEqual(replayed.hash(), expected)
            resumed = self.manager("--resume", name)
            self.assertEqual(resumed.hash(), expected)
            resumed.must("step 10")
            self.assertEqual(resumed.hash(), longer)
            self.assertEqual(resumed.must("get r.torn"), "0")
            resumed.end()

    def test_arrays_of_a_journal_that_are_damaged(self):
        manager, _ = self.sheets(10, journal=("--journal", "kept"))
        manager.finish()
        arrays = self.folder / "kept.arrays"
        data = arrays.read_bytes()
        for content, pattern in ((data[:100_000], "expected 6000 numbers at byte 96000"), (data[:50_000] + b"!" + data[50_001:], "the check of the array at byte 48000"),
                                 (b"", "has 0 bytes"), (None, "cannot be read: No such file")):
            with self.subTest(pattern):
                arrays.unlink(missing_ok=True)
                if content is not None:
                    arrays.write_bytes(content)
                replayed = self.manager()
                replayed.refused("replay kept", "io", pattern)

    def test_rewinding(self):
        manager, _ = self.sheets(10, journal=("--journal", "kept"))
        for line in ("rewind 0.1", "step 4"):
            manager.must(line, timeout=60)
        expected = self.sheets(10)[1]
        self.assertEqual(manager.hash(), expected)
        manager.finish()
        replayed = self.manager()
        replayed.must("replay kept")
        self.assertEqual(replayed.hash(), expected)

    def test_memory_stays_flat_and_nothing_is_left(self):
        before = set(pathlib.Path("/dev/shm").iterdir())
        manager, _ = self.sheets(50, count=10000, every="every 60")
        size = manager.memory()
        manager.must("step 400", timeout=120)
        if not sailor.SANITIZED:
            self.assertLess(manager.memory(), size + (40 << 20))
        descriptors = len(os.listdir(f"/proc/{manager.pid}/fd"))
        for _ in range(5):
            manager.must("delete s")
            manager.must("create sheet s count 10000")
            manager.must("step 4")
        self.assertLessEqual(len(os.listdir(f"/proc/{manager.pid}/fd")), descriptors + 2)
        self.assertEqual(manager.finish(), 0)
        self.assertEqual(set(pathlib.Path("/dev/shm").iterdir()) - before, set())

    def test_a_delayed_reader_and_a_slow_one(self):
        self.file("late", "#!/bin/sh\nwhile read verb n rest; do\ncase $verb in hello) echo 'reads sheet.points delayed'; echo 'rate 20Hz'; echo ready;;\n"
                  "set|put) echo $verb ${rest%%${rest#????????????????????}} >> told;; tick) echo tick $n >> told; echo done $n;; esac\ndone\n")
        os.chmod(self.folder / "late", 0o755)
        manager = self.manager()
        for line in ("start painter", "start ./late", "create sheet sheet", "step 9"):
            manager.must(line)
        told = (self.folder / "told").read_text().splitlines()
        self.assertEqual([line for line in told if line.startswith("tick")], ["tick 3", "tick 6", "tick 9"])
        # as text, and never what was written in the same tick
        values = [float(line.split()[1]) for line in told if line.startswith("set") and "." not in line.split()[1]]
        self.assertEqual(values, [2.0, 5.0, 8.0])


class SlowArray(Arrays):
    def torn(self, ticks, count):
        manager, _ = self.sheets(ticks, count=count, every="every 600", chunk=5000)
        self.assertEqual(manager.must("get r.frames"), str(ticks))
        self.assertEqual(manager.must("get r.torn"), "0")
        return manager

    def test_no_torn_frame_in_a_million(self):
        self.torn(1_000_000, 400)

    def test_no_torn_frame_of_fifty_thousand_points(self):
        self.torn(20_000 if sailor.SANITIZED else 1_000_000, 50_000)

    def test_a_program_that_stands_still(self):
        expected = self.sheets(60, count=5000)[1]
        for name in ("fill", "read"):
            with self.subTest(name):
                def stop(manager, tick, name=name):
                    if tick == 30:
                        os.kill(self.pid(manager, name), signal.SIGSTOP)

                manager, got = self.sheets(60, count=5000, kill=stop, chunk=10)
                manager.event(f"gone {name} timeout")
                self.assertEqual(manager.must("get r.torn"), "0")
                self.assertEqual(got, expected)
                self.assert_unharmed(manager, expected)
                manager.end()

    def test_more_told_than_is_kept(self):
        # without checkpoints 256 MiB of a program's story are kept, 223 frames of 1.2 MB
        manager, _ = self.sheets(200, count=50_000, every="off")
        full = self.resident(manager)
        manager.must("step 700", timeout=120)
        size = self.resident(manager)
        if not sailor.SANITIZED:
            self.assertLess(size, full, "a story that is not kept takes memory")
        manager.must("step 2000", timeout=120)
        if not sailor.SANITIZED:
            self.assertLess(self.resident(manager), size + (20 << 20))
        before = manager.hash()
        self.assertEqual(manager.must("get r.torn"), "0")
        # its end is the end of the run: it cannot be made again
        os.kill(self.pid(manager, "read"), signal.SIGKILL)
        manager.event("failed read", timeout=20)
        self.assert_unharmed(manager, before)

    def test_killed_at_random_moments(self):
        expected = self.sheets(4000, chunk=50, count=5000, every="every 60")[1]
        last = [0.0]

        def kill(manager, tick):
            if tick % 400 != 200:
                return
            time.sleep(max(0, last[0] + 2.1 - time.monotonic()))
            last[0] = time.monotonic()
            victim = self.pid(manager, ("fill", "read")[tick // 400 % 2])
            manager.send(b"@k step 25\n")
            time.sleep(0.0007 * (tick // 400))
            os.kill(victim, signal.SIGKILL)
            assert manager.answer("k", 60).ok

        manager = self.manager("--seed", "3")
        for line in ("checkpoints every 60", "start sheets as fill -- fill", "start sheets as read -- read", "create sheet s count 5000", "create reader r"):
            manager.must(line)
        ticks = 0
        while ticks < 4000:
            kill(manager, ticks)
            step = 25 if ticks % 400 == 200 else 50
            manager.must(f"step {step}", timeout=60)
            ticks += 50
        self.assertEqual(manager.must("get r.torn"), "0")
        self.assertEqual(manager.hash(), expected)


if __name__ == "__main__":
    sailor.main()
