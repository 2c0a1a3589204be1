"""Several speakers on a FIFO, readers that do not read, floods beside polite clients."""

import os
import resource
import subprocess
import sys
import threading
import time

import sailor
from sailor import BIN, Case, until

# writes COUNT lines of SIZE bytes, each setting one field of its own to its number
WRITER = """
import os, sys
path, name, count, size = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
out = os.open(path, os.O_WRONLY)
for n in range(1, count + 1):
    head = b"set %s.position %d 0 0 #" % (name.encode(), n)
    line = head + b"x" * (size - len(head) - 1) + b"\\n"
    while line:
        line = line[os.write(out, line):]
"""


class Fifo(Case):
    def listening(self, *arguments):
        os.mkfifo(self.folder / "ear")
        manager = self.world(*arguments)
        manager.must("listen ear")
        return manager

    def say(self, data):
        with open(self.folder / "ear", "wb", buffering=0) as mouth:
            mouth.write(data)

    def writers(self, count, lines, size):
        for n in range(count):
            yield subprocess.Popen([sys.executable, "-c", WRITER, str(self.folder / "ear"), f"n{n}", str(lines), str(size)])

    def settle(self, manager, path, value):
        until(lambda: manager.must(f"get {path}") == value, f"{path} becomes {value}")

    def test_four_writers_of_4096_bytes_are_never_mixed(self):
        lines = 400 if sailor.SANITIZED else 2000
        manager = self.listening()
        for n in range(4):
            manager.must(f"create node n{n}")
        for writer in list(self.writers(4, lines, 4096)):
            self.assertEqual(writer.wait(120), 0)
        for n in range(4):
            self.settle(manager, f"n{n}.position", f"{lines} 0 0")
        self.assertFalse([event for event in manager.events if "error" in event], manager.events[:3])
        self.assertFalse([line for line in manager.errors if "error" in line], manager.errors[:3])

    def test_answers_stand_apart_from_those_of_a_framed_conversation(self):
        manager = self.manager()
        for line in ("create sphere ball position 1 2 3", "listen ear"):
            manager.must(line)
        with open(self.folder / "ear", "w") as ear:
            ear.write("get ball.position\nlist ball\nget nobody.position\nwatch ball\n")
        manager.event("^event answer ear 1 2 3$")
        manager.event("^event answer ear ball")
        until(lambda: any(line.startswith("ear:3:5: error unknown") for line in manager.errors), "the error")
        self.assertEqual(manager.must("get ball.position"), "1 2 3")
        manager.must("set ball.position 4 5 6")
        manager.event("^event ball.position 4 5 6$")

    def test_who_is_not_listened_to_any_more_is_told_nothing(self):
        manager = self.manager()
        for line in ("create sphere ball", "listen ear"):
            manager.must(line)
        with open(self.folder / "ear", "w") as ear:
            ear.write("watch ball\nmonitor on\necho there\n")
        manager.event("^event answer ear there$")
        manager.must("unlisten ear")
        for n in range(100):
            manager.must(f"set ball.position {n} 2 3")
        self.assertFalse([event for event in manager.events if " 77 2 3" in event])

    def test_longer_lines_are_refused(self):
        manager = self.listening()
        before = manager.hash()
        manager.must("create node n0")
        for writer in list(self.writers(1, 50, 4097)):
            self.assertEqual(writer.wait(60), 0)
        self.say(b"create node after\n")
        until(lambda: manager.ask("get after.visible").ok, "the next line is heard")
        self.assertEqual(manager.must("get n0.position"), "0 0 0")
        manager.must("delete after")
        manager.must("delete n0")
        self.assert_recovered(manager, before)

    def test_a_writer_that_dies_in_the_middle_of_a_line(self):
        manager = self.listening()
        before = manager.hash()
        self.say(b"set ball.position 5 5")
        self.say(b"\ncreate node after\n")
        until(lambda: manager.ask("get after.visible").ok, "the next line is heard")
        manager.must("delete after")
        self.assert_recovered(manager, before)

    def test_writers_come_and_go_and_nothing_spins(self):
        manager = self.listening()
        for n in range(20):
            self.say(b"set ball.position %d 0 0\n" % n)
        self.settle(manager, "ball.position", "19 0 0")
        used = manager.processor_time()
        time.sleep(1)
        self.assertLess(manager.processor_time() - used, 0.2, "it spins while nobody writes")
        self.say(b"set ball.position 99 0 0\n")
        self.settle(manager, "ball.position", "99 0 0")

    def test_a_fifo_that_is_deleted_or_replaced(self):
        manager = self.listening()
        os.unlink(self.folder / "ear")
        manager.must("echo x")
        manager.must("unlisten ear")
        os.mkfifo(self.folder / "ear")
        manager.must("listen ear")
        self.say(b"create node heard\n")
        until(lambda: manager.ask("get heard.visible").ok, "the new one is heard")

    def test_bytes_that_are_no_text(self):
        manager = self.listening()
        before = manager.hash()
        self.say(os.urandom(4000).replace(b"q", b"x") + b"\n")
        self.say(b"create node after\n")
        until(lambda: manager.ask("get after.visible").ok, "the next line is heard")
        manager.must("delete after")
        self.assert_recovered(manager, before)

    def test_listening_twice_and_no_more(self):
        manager = self.listening()
        self.assertFalse(manager.ask("listen ear").ok)
        self.assertIn("ear", manager.must("sources"))
        manager.must("unlisten ear")
        self.assertNotIn("ear", manager.must("sources"))
        manager.refused("unlisten ear", "unknown")

    def test_one_fifo_under_two_names_is_one(self):
        manager = self.listening()
        self.assertIn("as ear", manager.refused("listen ./ear", "exists").sentence)
        self.assertEqual(manager.must("sources").split(), ["main", "ear"])

    def test_a_speaker_may_take_itself_and_others_away(self):
        manager = self.listening()
        manager.must("listen one")
        manager.must("listen two")
        self.say(b"unlisten two\nunlisten ear\ncreate node unheard\n")
        until(lambda: manager.must("sources").split() == ["main", "one"], "two speakers are gone")
        self.assertFalse(manager.ask("get unheard.visible").ok)

    def test_a_flood_beside_a_polite_client(self):
        manager = self.listening()
        stop = threading.Event()

        def flood():
            out = os.open(self.folder / "ear", os.O_WRONLY)
            block = b"set ball.position 1 1 1\n" * 160
            while not stop.is_set():
                os.write(out, block)
            os.close(out)

        thread = threading.Thread(target=flood)
        thread.start()
        try:
            worst = 0
            for n in range(50):
                began = time.monotonic()
                manager.must(f"set probe.position {n} 0 0")
                worst = max(worst, time.monotonic() - began)
        finally:
            stop.set()
            thread.join()
        self.assertLess(worst, 2, "the polite client waits")
        if not sailor.SANITIZED:
            self.assertLess(manager.memory(), 100 << 20)

    def test_more_fifos_than_descriptors(self):
        def few():
            resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))

        manager = self.manager(preexec=few)
        manager.must("create node probe")
        heard = refused = 0
        for n in range(100):
            os.mkfifo(self.folder / f"ear{n}")
            reply = manager.ask(f"listen ear{n}")
            heard += reply.ok
            if not reply.ok:
                refused += 1
                self.assertIn(reply.kind, ("limit", "io"), repr(reply))
        self.assertGreater(heard, 10)
        self.assertGreater(refused, 0)
        manager.must("set probe.visible false")
        # the sanitizer itself opens a pipe to look at memory, and takes a refusal for bad memory
        if sailor.SANITIZED:
            return
        reply = manager.ask("start wave")
        if not reply.ok:
            self.assertIn(reply.kind, ("limit", "io", "gone"), repr(reply))
        for n in range(heard):
            manager.ask(f"unlisten ear{n}")
        manager.must("start wave as second" if reply.ok else "start wave")


class Readers(Case):
    def start(self, **options):
        process = subprocess.Popen([BIN / "dialog_manager", "--framed", "--keep-going"], cwd=self.folder, stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=sailor.environment(self.folder), **options)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def test_a_reader_that_never_reads_does_not_make_it_grow(self):
        process = self.start()
        process.stdin.write(b"create node a\n")
        process.stdin.flush()
        os.set_blocking(process.stdin.fileno(), False)
        block = b"@x get **\n" * 1000
        written = 0
        deadline = time.monotonic() + 5
        while time.monotonic() < deadline and written < 200 << 20 and process.poll() is None:
            try:
                written += os.write(process.stdin.fileno(), block)
            except BlockingIOError:
                time.sleep(0.01)
            except BrokenPipeError:
                break
        if process.poll() is None and not sailor.SANITIZED:
            with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
                peak = next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))
            self.assertLess(peak, 100 << 10, "kB")

    def peak(self, process):
        with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))

    def test_a_reader_that_is_always_behind_does_not_make_it_grow(self):
        process = self.start()
        question = b"@x echo " + b"x" * 4000 + b"\n"
        count, got = 15000, 0

        def ask():
            for _ in range(count // 100):
                process.stdin.write(question * 100)
            process.stdin.close()

        asking = threading.Thread(target=ask)
        asking.start()
        while data := os.read(process.stdout.fileno(), 32768):
            got += len(data)
            # there is always more to read than was read
            if got % 7 == 0:
                time.sleep(0.001)
        asking.join()
        self.assertEqual(got, count * (4000 + 3 + len("@x ok\n")))
        # 60 MB went through
        self.assertEqual(process.wait(sailor.PATIENCE), 0)
        if not sailor.SANITIZED:
            self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 100 << 10)

    def test_one_byte_at_a_time_keeps_nobody_waiting(self):
        process = self.start()
        process.stdin.write(b"create node a\nlisten ear\n@h help\n@h help\n@h help\n@l sync heard\n")
        process.stdin.flush()
        until(lambda: (self.folder / "ear").exists(), "it listens")
        with open(self.folder / "ear", "wb", buffering=0) as mouth:
            mouth.write(b"set a.position 1 2 3\nsave heard.dlg\n")
        until(lambda: (self.folder / "heard.dlg").exists(), "it is heard")
        got = b""
        while b"@l ok" not in got:
            got += os.read(process.stdout.fileno(), 1)
        self.assertEqual(got.count(b"@h ok\n"), 3)

    def test_watched_values_that_nobody_reads_are_told_at_their_newest(self):
        process = self.start()
        process.stdin.write(b"create node a\nwatch a.position\nlisten ear\n")
        process.stdin.flush()
        until(lambda: (self.folder / "ear").exists(), "it listens")
        last = 400000 if not sailor.SANITIZED else 60000
        with open(self.folder / "ear", "wb", buffering=0) as mouth:
            for first in range(0, last, 100):
                mouth.write(b"".join(b"set a.position %d 0 0\n" % n for n in range(first + 1, first + 101)))
            mouth.write(b"save done.dlg\n")
        until(lambda: (self.folder / "done.dlg").exists(), "all is heard", 60)
        if not sailor.SANITIZED:
            self.assertLess(self.peak(process), 60 << 10, "kB")
        process.stdin.write(b"@s sync end\n")
        process.stdin.close()
        told = process.stdout.read().splitlines()
        values = [float(line.split()[2]) for line in told if line.startswith(b"event a.position")]
        self.assertEqual(values[-1], last, "the newest value")
        self.assertEqual(values, sorted(values))
        self.assertIn(b"@s ok", told)

    def test_errors_that_nobody_reads_do_not_make_it_grow(self):
        reading, unread = os.pipe()
        self.addCleanup(os.close, reading)
        process = subprocess.Popen([BIN / "dialog_manager", "--framed", "--keep-going"], cwd=self.folder, stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=unread, env=sailor.environment(self.folder))
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        os.close(unread)
        process.stdin.write(b"create node a\nlisten ear\n")
        process.stdin.flush()
        until(lambda: (self.folder / "ear").exists(), "it listens")
        ear = os.open(self.folder / "ear", os.O_WRONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, ear)
        deadline = time.monotonic() + 3
        while time.monotonic() < deadline:
            try:
                os.write(ear, b"nonsense " * 100 + b"\n" + b"nonsense\n" * 300)
            except BlockingIOError:
                time.sleep(0.01)
        if not sailor.SANITIZED:
            self.assertLess(self.peak(process), 40 << 10, "kB")
        # the conversation goes on beside it
        process.stdin.write(b"@g get a.position\n")
        process.stdin.flush()
        self.assertEqual(process.stdout.readline(), b"  0 0 0\n")

    def test_a_reader_that_closes_is_no_crash(self):
        process = self.start()
        process.stdout.close()
        try:
            for _ in range(1000):
                process.stdin.write(b"@1 help\n")
                process.stdin.flush()
            process.stdin.close()
        except BrokenPipeError:
            pass
        self.assertGreaterEqual(process.wait(sailor.PATIENCE), -13)

    def test_a_slow_reader_gets_everything(self):
        process = self.start()
        process.stdin.write(b"".join(b"@%d echo %s\n" % (n, b"x" * 100) for n in range(3000)))
        process.stdin.close()
        got = b""
        while True:
            data = os.read(process.stdout.fileno(), 1000)
            if not data:
                break
            got += data
        self.assertEqual(got.count(b" ok\n"), 3000)
        self.assertEqual(process.wait(sailor.PATIENCE), 0)

    def test_head_closes_early(self):
        done = subprocess.run(["bash", "-c", f"set -o pipefail; for i in $(seq 3000); do echo help; done | '{BIN}/dialog_manager' | head -n 1"],
                              cwd=self.folder, env=sailor.environment(self.folder), capture_output=True, timeout=sailor.PATIENCE, check=False)
        self.assertEqual(done.stdout.count(b"\n"), 1)
        self.assertNotIn(b"terminate", done.stderr)


if __name__ == "__main__":
    sailor.main()
