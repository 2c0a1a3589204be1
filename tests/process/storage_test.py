"""A disk that is full, that breaks, that writes half; a manager killed between any two of its writes."""

import os
import pathlib
import random
import resource
import signal
import subprocess
import time

import sailor
from sailor import BIN, Case

FAILING_DISK = BIN.parent / "tests/libfailing_disk.so"
# long tags: the answers fill many writes, so that there are many moments between two of them
LINES = [b"@%064d set ball.position %d 0 0\n" % (n, n) for n in range(1, 3001)]
EIO, ENOSPC, EINTR = 5, 28, 4


class Disk(Case):
    def failing(self, call, number, what, *arguments, lines, timeout=60):
        """A manager over a disk that fails, told these lines: status, standard output, standard error."""
        # the sanitizer's own library wants to stand first and does not need to
        sanitizer = os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0"
        environ = sailor.environment(self.folder, LD_PRELOAD=str(FAILING_DISK), FAILING=f"{call} {number} {what}")
        environ["ASAN_OPTIONS"] = sanitizer
        done = subprocess.run([BIN / "dialog_manager", "--framed", "--keep-going", *arguments], cwd=self.folder, env=environ,
                              input=b"".join(lines), capture_output=True, timeout=timeout, check=False)
        return done.returncode, done.stdout, done.stderr.decode("utf-8", "replace")

    def fresh(self):
        (self.folder / "kept").unlink(missing_ok=True)

    def resumed(self, field="ball.position", name="kept"):
        """What a field is for a manager that goes on with the journal."""
        done = self.run_manager("--resume", name, "-c", f"get {field}", timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def answered(self, output):
        """Number of the last line that was acknowledged."""
        return max([int(line.split()[0][1:]) for line in output.splitlines(keepends=True) if line.endswith(b" ok\n")], default=-1)

    def check_killed(self, call, number, when, lines=None):
        """Killed before or after a call: no answer was given for what the journal does not have. Whether it was killed."""
        self.fresh()
        status, output, errors = self.failing(call, number, when, "--journal", "kept",
                                              lines=[b"@0 create sphere ball\n", *(lines or LINES)])
        if status == 0:
            return False
        self.assertEqual(status, -signal.SIGKILL, errors)
        acknowledged = self.answered(output)
        if acknowledged >= 0:
            self.assertGreaterEqual(int(self.resumed().split()[0]), acknowledged, f"{when} at {call} {number}")
        return True


class Storage(Disk):
    def test_nothing_is_acknowledged_before_it_is_kept(self):
        happened = 0
        for call in ("write", "pwrite"):
            for when in ("kill", "killed"):
                for number in (1, 2, 3, 7, 20, 40):
                    with self.subTest(f"{when} at {call} {number}"):
                        happened += self.check_killed(call, number, when)
        self.assertGreaterEqual(happened, 12)

    def test_short_writes_and_interrupted_ones_are_gone_on_with(self):
        for what in ("short", EINTR):
            for call in ("pwrite", "write"):
                for number in ("1", "2", "3", "1+") if what == "short" else ("1", "2", "3"):
                    with self.subTest(f"{what} at {call} {number}"):
                        self.fresh()
                        # half of a half ... of one byte is that byte: this ends
                        status, output, errors = self.failing(call, number, what, "--journal", "kept",
                                                              lines=[b"@0 create sphere ball\n", *LINES[:400]])
                        self.assertEqual(status, 0, errors)
                        self.assertEqual(output.count(b" ok\n"), 401)
                        self.assertEqual(self.resumed(), "400 0 0")

    def test_a_disk_that_breaks_ends_the_manager_and_nothing_unkept_was_acknowledged(self):
        for call, first in (("pwrite", b"journal kept\n"), ("fdatasync", b"journal kept always\n")):
            for what in (EIO, ENOSPC):
                for number in ("1", "2", "3+", "7+"):
                    with self.subTest(f"{what} at {call} {number}"):
                        self.fresh()
                        status, output, errors = self.failing(call, number, what, lines=[first, b"@0 create sphere ball\n", *LINES])
                        if status == 0:
                            # the call did not come that often
                            self.assertEqual(self.resumed(), "3000 0 0")
                            continue
                        self.assertEqual(status, 1, errors)
                        self.assertRegex(errors + output.decode(), "error io .*journal kept cannot be written")
                        if output.startswith(b"error io "):
                            # it never began
                            continue
                        acknowledged = self.answered(output)
                        if acknowledged > 0:
                            self.assertGreaterEqual(int(self.resumed().split()[0]), acknowledged)

    def test_a_disk_that_has_no_room_refuses_the_line_and_takes_the_next(self):
        for number in range(2, 5):
            with self.subTest(number):
                self.fresh()
                lines = [b"@0 create sphere ball\n", *[b"@%d set ball.radius 1 # %s\n" % (n, b"x" * 60000) for n in range(1, 30)],
                         b"@30 set ball.radius 2\n@31 hash\n"]
                # both tries, with room ahead and without
                status, output, errors = self.failing("fallocate", 2 * number, ENOSPC, "--journal", "kept", lines=lines)
                self.assertIn(status, (0, 1), errors)
                self.assertIn(b"@30 ok", output)
                self.assertEqual(self.resumed("ball.radius"), "2")

    def test_a_full_disk_stops_time_not_the_manager(self):
        def small():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000))

        manager = self.manager("--seed", "3", "--journal", "kept", preexec=small)
        for line in ("create node probe", "start walker", "create walker w"):
            manager.must(line)
        steps = 0
        while (reply := manager.ask("step")).ok:
            steps += 1
            self.assertLess(steps, 500, "the disk never got full")
        self.assertEqual(reply.kind, "io", repr(reply))
        self.assertIn("kept", reply.sentence)
        before = manager.hash()
        self.assertEqual(manager.must("get w.steps"), str(steps), "a tick that was refused had an effect")
        for _ in range(3):
            manager.refused("step", "io", "kept")
            manager.refused("set w.reach 0.9 # " + "x" * 5900, "io", "kept")
        self.assertEqual(manager.hash(), before)
        self.assertNotIn("failed", manager.must("manipulators"))
        # without the journal the world goes on
        manager.must("journal off")
        manager.must("step")
        self.assertEqual(manager.must("get w.steps"), str(steps + 1))
        manager.finish()
        self.assertEqual(self.resumed("w.steps"), str(steps))

    def test_time_that_flows_by_itself_stops_at_a_full_disk(self):
        def small():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000))

        manager = self.manager("--journal", "kept", preexec=small)
        manager.must("resume")
        manager.event("journal kept .*", 30)
        first = manager.must("time")
        self.assertEqual(manager.must("time"), first, "time goes on")
        manager.must("journal off")
        manager.must("resume")
        sailor.until(lambda: manager.must("time") != first, "time goes on")
        manager.must("pause")

    def test_a_file_system_without_room(self):
        """The real thing where one may be mounted: a disk of 64 kB."""
        if os.geteuid() != 0:
            self.skipTest("mounting needs root")
        disk = self.folder / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k,mode=700", "tmpfs", disk], capture_output=True, check=False).returncode:
            self.skipTest("nothing can be mounted here")
        self.addCleanup(subprocess.run, ["umount", "-l", disk], check=False)
        manager = self.manager("--journal", "disk/kept")
        manager.must("create sphere ball")
        accepted = 0
        while (reply := manager.ask(f"set ball.position {accepted + 1} 0 0 # " + "x" * 500)).ok:
            accepted += 1
        self.assertEqual(reply.kind, "io", repr(reply))
        self.assertRegex(reply.sentence, "No space left")
        self.assertGreater(accepted, 50)
        before = manager.hash()
        manager.refused("set ball.position 0 0 0 # " + "x" * 500, "io", "No space left")
        manager.refused("save disk/world.dlg", "io", "No space left")
        manager.refused("branch disk/other", "io", "No space left")
        self.assertFalse(list(disk.glob("*.part")), "half a file was left")
        self.assertEqual(manager.hash(), before)
        # room again: the next line is taken at once
        subprocess.run(["mount", "-o", "remount,size=1m", disk], check=True)
        manager.must(f"set ball.position {accepted + 1} 0 0")
        manager.finish()
        self.assertEqual(self.resumed(name="disk/kept"), f"{accepted + 1} 0 0")

    def test_a_trace_that_cannot_be_written_says_so_and_ends(self):
        def small():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        manager = self.world(preexec=small)
        manager.must("trace t.csv ball.position")
        manager.must("step 2000", timeout=60)
        manager.event("trace t.csv .*File too large")
        manager.refused("trace t.csv", "unknown")
        self.assertLessEqual((self.folder / "t.csv").stat().st_size, 4096)
        manager.refused("trace /dev/full ball.position", "io", "/dev/full")
        os.mkfifo(self.folder / "pipe")
        manager.refused("trace pipe ball.position", "io", "pipe")
        manager.must("echo it does not wait for a reader")


class SlowStorage(Disk):
    SETUP = ["rate 10Hz", "create sphere ball radius 4cm", "start walker", "create walker w reach 0.5"]

    def recorded(self):
        """A short journal and every world on its way, by their hashes."""
        manager = self.manager("--seed", "4", "--journal", "kept")
        worlds = {manager.hash()}
        for line in self.SETUP:
            manager.must(line)
            worlds.add(manager.hash())
        for tick in range(3):
            manager.must(f"set ball.position {tick} 0 0")
            worlds.add(manager.hash())
            manager.must("step")
            worlds.add(manager.hash())
        self.assertEqual(manager.finish(), 0)
        return (self.folder / "kept").read_bytes(), worlds

    def check_damaged(self, data, worlds):
        """Replayed without programs: a world that was, or no journal at all."""
        self.file("damaged", data)
        done = self.run_manager("--keep-going", "--framed", "-c", "replay damaged", "-c", "hash", timeout=60)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        self.assertIn(done.stdout.split()[-1], worlds, done.stdout + done.stderr)

    def test_a_journal_cut_at_every_byte(self):
        data, worlds = self.recorded()
        empty = self.run_manager("-c", "hash").stdout.strip()
        for length in range(len(data)):
            with self.subTest(length):
                self.check_damaged(data[:length], worlds | {empty})

    def test_a_journal_with_a_flipped_bit_in_every_byte(self):
        data, worlds = self.recorded()
        empty = self.run_manager("-c", "hash").stdout.strip()
        for place in range(len(data)):
            with self.subTest(place):
                damaged = bytearray(data)
                damaged[place] ^= 1 << (place % 8)
                self.check_damaged(bytes(damaged), worlds | {empty})

    def test_killed_before_and_after_every_write(self):
        for call in ("write", "pwrite"):
            for when in ("kill", "killed"):
                number = 1
                while self.check_killed(call, number, when):
                    number += 1
                self.assertGreater(number, 4, f"{when} at {call}")

    def test_full_at_every_size(self):
        for limit in range(0, 1500, 7):
            with self.subTest(limit):
                self.fresh()

                def small(limit=limit):
                    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

                lines = b"@0 create sphere ball\n" + b"".join(b"@%d set ball.position %d 0 0\n" % (n, n) for n in range(1, 60))
                done = subprocess.run([BIN / "dialog_manager", "--framed", "--keep-going", "--journal", "kept"], cwd=self.folder,
                                      input=lines, capture_output=True, env=sailor.environment(self.folder), preexec_fn=small,
                                      timeout=60, check=False)
                self.assertEqual(done.returncode, 1, done.stderr)
                acknowledged = self.answered(done.stdout)
                refused = done.stdout.count(b" error io ")
                if acknowledged > 0:
                    self.assertEqual(refused, 59 - acknowledged)
                    self.assertEqual(self.resumed(), f"{acknowledged} 0 0")
                self.assertLessEqual(pathlib.Path(self.folder / "kept").stat().st_size, limit)


class SlowKills(Disk):
    TRIALS = int(os.environ.get("KILLS", "10000"))

    def life(self, first, chance):
        """One manager: what it found (line, tick, hash) or None when it was killed before it said so; what it acknowledged after that."""
        process = subprocess.Popen([BIN / "dialog_manager", "--framed", "--keep-going", *first], cwd=self.folder, stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=sailor.environment(self.folder))
        try:
            begin = b"create sphere ball\n" if first[0] == "--journal" else b""
            process.stdin.write(begin + b"@p get ball.position\n@n time\n@w hash\n")
            process.stdin.flush()
            if chance.random() < 0.1:
                # in the middle of its reading
                time.sleep(chance.random() * 0.005)
                return None, []
            said = []
            while len(said) < 6:
                answer = process.stdout.readline().decode()
                self.assertTrue(answer, "it ended by itself")
                # that the last tick was not whole is told first
                if not answer.startswith("event journal"):
                    said.append(answer)
            self.assertEqual([said[n] for n in (1, 3, 5)], ["@p ok\n", "@n ok\n", "@w ok\n"])
            line, tick = int(said[0].split()[0]), round(float(said[2]) * 60)
            last = b"@t%d step\n" % line if line > tick else b""
            process.stdin.write(last + b"".join(b"@s%d set ball.position %d 0 0\n@t%d step\n@h%d hash\n" % (n, n, n, n)
                                                for n in range(line + 1, line + 300)))
            process.stdin.flush()
            time.sleep(chance.random() * 0.01)
            process.kill()
            return (line, tick, said[4].strip()), process.stdout.read().decode().splitlines(keepends=True)
        finally:
            process.kill()
            process.wait()
            process.stdout.close()
            try:
                process.stdin.close()
            except BrokenPipeError:
                pass

    def test_killed_at_random_ten_thousand_times(self):
        """Each life goes on with the journal of the one before, says which world it found, works on and is killed."""
        chance = random.Random(7)
        kept = False
        lost = half = compared = lines = 0
        for trial in range(self.TRIALS):
            if not kept or line > 5000:
                self.fresh()
                worlds, line, tick, kept = {}, 0, 0, False
            found, output = self.life(["--resume" if kept else "--journal", "kept"], chance)
            if found is None:
                continue
            if kept:
                # nothing that was acknowledged is lost, and a tick is there whole or not at all
                lost += found[0] < line or found[1] < tick
                half += found[0] - found[1] not in (0, 1)
                if found[0] == found[1] and found[0] in worlds:
                    compared += 1
                    half += found[2] != worlds[found[0]]
            kept = True
            line, tick = found[:2]
            body = ""
            for answer in output:
                if not answer.endswith("\n"):
                    break
                if answer.startswith("  "):
                    body = answer.strip()
                    continue
                tag, verdict = answer.split(" ", 1)
                self.assertEqual(verdict, "ok\n", answer)
                number = int(tag[2:])
                lines += 1
                if tag.startswith("@s"):
                    line = number
                elif tag.startswith("@t"):
                    tick = number
                else:
                    worlds[number] = body
            if (trial + 1) % 1000 == 0:
                print(f"{trial + 1} kills, {lines} lines acknowledged, {lost} lost, {half} half ({compared} worlds compared)", flush=True)
        self.assertEqual((lost, half), (0, 0))


if __name__ == "__main__":
    sailor.main()
