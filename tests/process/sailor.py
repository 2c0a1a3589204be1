"""The dialog manager as a process: start it, talk to it, look after what it leaves behind.

Tests are unittest classes in *_test.py; classes whose name starts with Slow run only with the argument `slow`.
Executables are found in BIN_DIR, the sources in SOURCE_DIR.
"""

import contextlib
import os
import pathlib
import queue
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

SOURCE = pathlib.Path(os.environ.get("SOURCE_DIR", pathlib.Path(__file__).resolve().parents[2]))
BIN = pathlib.Path(os.environ.get("BIN_DIR", SOURCE / "build/release/bin"))
PROGRAMS = SOURCE / "tests/process/programs"
SANITIZED = os.environ.get("SANITIZED", "") == "ON"
# seconds until a missing answer is a failure: only failing tests wait for it
PATIENCE = 40 if SANITIZED else 10

KINDS = "syntax unknown exists type unit range owner busy timeout gone limit io".split()


def environment(home, **more):
    """The environment of a test: test programs on PATH, no settings of the person who runs it."""
    wanted = {name: os.environ[name] for name in ("ASAN_OPTIONS", "LSAN_OPTIONS", "UBSAN_OPTIONS", "DISPLAY") if name in os.environ}
    path = os.pathsep.join([str(PROGRAMS), str(BIN.parent / "tests/programs"), "/usr/local/bin:/usr/bin:/bin"])
    return {**wanted, "PATH": path, "HOME": str(home), "LC_ALL": "C.UTF-8", "TERM": "xterm", **more}


class Reply:
    """What a tagged line got: body lines, and how it closed."""

    def __init__(self, body, closing):
        self.body = body
        words = closing.split(" ", 3)
        self.ok = words[0] == "ok"
        if self.ok:
            self.kind, self.column, self.sentence = "", 0, ""
        else:
            assert words[0] == "error" and len(words) == 4, f"not a closing line: {closing!r}"
            self.kind, self.column, self.sentence = words[1], int(words[2]), words[3]
            assert self.kind in KINDS, f"unknown kind of error: {closing!r}"

    def __repr__(self):
        return "\n".join(self.body) if self.ok else f"error {self.kind} {self.column} {self.sentence}"


class Manager:
    """A dialog_manager with `--framed --keep-going` and whatever else, asked line by line."""

    def __init__(self, *arguments, cwd, binary=None, prefix=(), environ=None, preexec=None, stderr=None):
        command = [*prefix, str(binary or BIN / "dialog_manager"), "--framed", "--keep-going", *map(str, arguments)]
        self.cwd = pathlib.Path(cwd)
        self.process = subprocess.Popen(
            command, cwd=cwd, env=environ or environment(cwd), preexec_fn=preexec,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE if stderr is None else stderr)
        self.pid = self.process.pid
        self.events = []
        self.errors = []
        self.lines = queue.Queue()
        self.tag = 0
        threading.Thread(target=self._read, daemon=True).start()
        if stderr is None:
            self.error_reader = threading.Thread(target=self._read_errors, daemon=True)
            self.error_reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(line.decode("utf-8", "replace").rstrip("\n"))
        self.lines.put(None)

    def _read_errors(self):
        for line in self.process.stderr:
            self.errors.append(line.decode("utf-8", "replace").rstrip("\n"))

    def send(self, data):
        """Bytes as they are."""
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def line(self, timeout=PATIENCE):
        """The next line that the manager says, None at its end."""
        try:
            line = self.lines.get(timeout=timeout)
        except queue.Empty:
            raise AssertionError(f"no answer within {timeout} s") from None
        return line

    def answer(self, tag, timeout=PATIENCE):
        """The reply to a tag; events that come before or after a body are kept, one inside a body is a failure."""
        body = []
        deadline = time.monotonic() + timeout
        while True:
            line = self.line(max(0.01, deadline - time.monotonic()))
            assert line is not None, f"the manager ended (status {self.process.wait()}): {self.errors[-5:]}"
            if line.startswith(f"@{tag} "):
                return Reply(body, line[len(tag) + 2:])
            if line.startswith("  "):
                body.append(line[2:])
            else:
                # an untagged line that was refused is told as an error without tag
                assert line.startswith(("event ", "error ")), f"neither body nor event nor @{tag}: {line!r}"
                assert not body, f"an event inside a reply: {line!r}"
                self.events.append(line)

    def ask(self, command, timeout=PATIENCE):
        """Says a line and waits for its reply."""
        self.tag += 1
        tag = f"t{self.tag}"
        data = command if isinstance(command, bytes) else command.encode()
        self.send(f"@{tag} ".encode() + data + b"\n")
        return self.answer(tag, timeout)

    def must(self, command, timeout=PATIENCE):
        """Says a line that has to succeed; its body as one text."""
        reply = self.ask(command, timeout)
        assert reply.ok, f"{command!r}: {reply!r}"
        return "\n".join(reply.body)

    def refused(self, command, kind, pattern=""):
        """Says a line that has to be refused with this kind of error."""
        reply = self.ask(command)
        assert not reply.ok, f"{command!r} was accepted: {reply.body}"
        assert reply.kind == kind, f"{command!r}: expected an error of kind {kind}, got: {reply!r}"
        assert re.search(pattern, reply.sentence), f"{command!r}: no {pattern!r} in: {reply!r}"
        return reply

    def event(self, pattern, timeout=PATIENCE):
        """Waits until an event matches; nothing else may be said meanwhile."""
        deadline = time.monotonic() + timeout
        while True:
            for event in self.events:
                if re.search(pattern, event):
                    return event
            line = self.line(max(0.01, deadline - time.monotonic()))
            assert line is not None, "the manager ended"
            assert line.startswith("event "), f"not an event: {line!r}"
            self.events.append(line)

    def hash(self):
        value = self.must("hash")
        assert re.fullmatch("[0-9a-f]{16}", value), f"hash is {value!r}"
        return value

    def children(self):
        """Process numbers of its living children."""
        return children(self.pid)

    def memory(self):
        """Largest resident size so far, bytes."""
        return int(re.search(r"VmHWM:\s+(\d+) kB", pathlib.Path(f"/proc/{self.pid}/status").read_text())[1]) * 1024

    def processor_time(self):
        """Seconds of processor time used so far."""
        fields = pathlib.Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def finish(self, timeout=PATIENCE):
        """Closes its input and waits: the exit status."""
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        return self.process.wait(timeout)

    def end(self):
        """Ends it by force, with what it started."""
        everything = descendants(self.pid)
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for pid in everything:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(BrokenPipeError, OSError):
            self.process.stdin.close()


def children(pid):
    """Process numbers of the children of a process that are not zombies."""
    found = []
    for task in pathlib.Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, parent = task.read_text().rpartition(")")[2].split()[:2]
            if int(parent) == pid and state != "Z":
                found.append(int(task.parent.name))
    return found


def descendants(pid):
    """Children, their children and so on."""
    found = children(pid)
    for child in list(found):
        found += descendants(child)
    return found


def zombies(pid):
    """Children of a process that ended and were not waited for."""
    found = []
    for task in pathlib.Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, parent = task.read_text().rpartition(")")[2].split()[:2]
            if int(parent) == pid and state == "Z":
                found.append(int(task.parent.name))
    return found


def alive(pid):
    """Whether a process runs (a zombie does not)."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def until(condition, what, timeout=PATIENCE):
    """Waits for what cannot be asked for, such as the end of a process."""
    deadline = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < deadline, f"{what}: not within {timeout} s"
        time.sleep(0.005)


def run(*arguments, cwd, stdin=b"", timeout=PATIENCE, environ=None, **options):
    """Runs dialog_manager to its end: an object with returncode, stdout and stderr (text)."""
    if isinstance(stdin, bytes):
        options["input"] = stdin
    else:
        options["stdin"] = stdin
    done = subprocess.run([str(BIN / "dialog_manager"), *map(str, arguments)], cwd=cwd, env=environ or environment(cwd),
                          capture_output=True, timeout=timeout, check=False, **options)
    done.stdout = done.stdout.decode("utf-8", "replace")
    done.stderr = done.stderr.decode("utf-8", "replace")
    return done


def resource_limit(descriptors):
    """For a process that is about to be started: so many open files and no more."""
    resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))


class Case(unittest.TestCase):
    """A test with a folder of its own, whose processes are ended with it."""

    longMessage = True
    maxDiff = None

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sailor-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def manager(self, *arguments, **options):
        manager = Manager(*arguments, cwd=self.folder, **options)
        self.addCleanup(manager.end)
        return manager

    def world(self, *arguments, **options):
        """A manager with a small world to be damaged."""
        manager = self.manager(*arguments, **options)
        for line in ("create sphere ball radius 4cm position 0 1 0", "create node probe", "create node probe/inner"):
            manager.must(line)
        return manager

    def run_manager(self, *arguments, **options):
        return run(*arguments, cwd=self.folder, **options)

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def assert_recovered(self, manager, before):
        """The world is as it was, and a good command works at once."""
        self.assertEqual(manager.hash(), before, "the world has changed")
        manager.must("set probe.visible false")
        self.assertEqual(manager.must("get probe.visible"), "false")
        manager.must("set probe.visible true")
        self.assertEqual(manager.hash(), before, "the world has changed")


def main():
    """Runs the test classes of the calling file: everyday ones, or with the argument `slow` the others."""
    slow = "slow" in sys.argv[1:]
    names = [word for word in sys.argv[1:] if word != "slow"]
    module = sys.modules["__main__"]
    loader = unittest.TestLoader()
    suite = unittest.TestSuite()
    if names:
        suite.addTests(loader.loadTestsFromNames(names, module))
    else:
        for name, value in sorted(vars(module).items()):
            if isinstance(value, type) and issubclass(value, Case) and value.__module__ == "__main__":
                if name.startswith("Slow") == slow:
                    suite.addTests(loader.loadTestsFromTestCase(value))
    result = unittest.TextTestRunner(verbosity=2 if names else 1).run(suite)
    sys.exit(0 if result.wasSuccessful() else 1)
