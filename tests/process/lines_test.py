"""Lines as bytes: what is broken is refused at its column, changes nothing, and the next line works."""

import os
import random
import subprocess
import time

import sailor
from sailor import BIN, Case

# every one of these is refused, whatever the manager knows
REFUSED = {
    b"nonsense": "unknown",
    b"set nowhere.position 1 2 3": "unknown",
    b"set ball.colour 1": "unknown",
    b"set ball.position 1 2": "syntax",
    b"set ball.position 1 2 3 4": "syntax",
    b"set ball.position 1 2 x": "type",
    b"set ball.position 1 2 nan": "type",
    b"set ball.position inf 2 3": "type",
    b"set ball.position 0x1p3 2 3": "type",
    b"set ball.position 1,5 2 3": "type",
    b"set ball.radius 1e309": "range",
    b"set ball.radius -1": "range",
    b"set ball.radius 3kg": "unit",
    b"set ball.radius 3deg": "unit",
    b"set ball.radius \"3": "syntax",
    b"set \"ball.radius 3": "syntax",
    b"create sphere ball": "exists",
    b"create sphere no/such": "unknown",
    b"create blob x": "unknown",
    b"delete nowhere": "unknown",
    b"get ball.radius\x00": "syntax",
    b"\x00": "syntax",
    b"get ball\x00.radius": "syntax",
    b"get ball.radius \x1b[A": "syntax",
    b"get ball.radius\x7f": "syntax",
    b"get \xff": "syntax",
    b"get \xc3": "syntax",
    b"get \xc0\xaf": "syntax",
    b"get \xed\xa0\x80": "syntax",
    b"get \xf4\x90\x80\x80": "syntax",
    b"echo a # \xff": "syntax",
}


class Lines(Case):
    def test_every_bad_line_is_refused_and_nothing_else_happens(self):
        manager = self.world()
        before = manager.hash()
        for line, kind in REFUSED.items():
            with self.subTest(line):
                reply = manager.ask(line)
                self.assertFalse(reply.ok, f"accepted: {reply}")
                self.assertEqual(reply.kind, kind, repr(reply))
                self.assert_recovered(manager, before)

    def test_the_column_is_that_of_the_word_at_fault(self):
        manager = self.world()
        for line, word in ((b"set ball.position 1 2 x", b"x"), (b"set ball.radius  3kg", b"3kg"), (b"get nowhere", b"nowhere"),
                           (b"create sphere no/such", b"no/such"), (b"echo \"abc", b"\"abc"), (b"echo a\x01b", b"\x01")):
            with self.subTest(line):
                reply = manager.ask(line)
                self.assertEqual(reply.column, len(f"@t{manager.tag} ") + line.index(word) + 1, repr(reply))

    def test_numbers_at_the_edge(self):
        manager = self.world()
        manager.must("type edge")
        manager.must("field edge.x real")
        manager.must("create edge e")
        for text, printed in ((b"-0", "-0"), (b"1e308", "1e+308"), (b"-1e308", "-1e+308"), (b"5e-324", "5e-324"), (b"1e-400", "0"),
                              (b"1" + b"0" * 300, "1e+300"), (b"0." + b"0" * 300 + b"1", "1e-301"), (b"9" * 400, None),
                              (b"1e309", None), (b"1e99999999999999999999", None), (b"1e-99999999999999999999", "0")):
            with self.subTest(text[:20]):
                reply = manager.ask(b"set e.x " + text)
                if printed is None:
                    self.assertEqual(reply.kind, "range", repr(reply)[:200])
                else:
                    self.assertTrue(reply.ok, repr(reply)[:200])
                    self.assertEqual(manager.must("get e.x"), printed)

    def test_every_byte_at_the_beginning_in_the_middle_and_at_the_end(self):
        manager = self.world()
        before = manager.hash()
        for byte in range(256):
            if byte == 10:
                continue
            one = bytes([byte])
            for line in (one + b"echo x", b"echo " + one + b" x", b"echo x" + one):
                reply = manager.ask(line)
                control = byte < 32 and byte != 9 or byte == 127 or byte >= 128
                # a carriage return right before the newline is tolerated
                if control and not (byte == 13 and line.endswith(one)):
                    self.assertEqual(reply.kind, "syntax", f"{line!r}: {reply!r}")
        self.assert_recovered(manager, before)

    def test_lines_at_the_limit(self):
        manager = self.world()
        before = manager.hash()
        for length in (65534, 65535, 65536):
            line = b"@long echo " + b"x" * (length - 12) + b"\n"
            self.assertEqual(len(line), length)
            manager.send(line)
            reply = manager.answer("long")
            self.assertTrue(reply.ok, f"{length} bytes: {reply!r}")
            self.assertEqual(len(reply.body[0]), length - 12)
        for length in (65537, 65538, 131072, 1000000):
            manager.send(b"@long echo " + b"x" * (length - 12) + b"\n")
            self.assert_limit(manager, "long")
        self.assert_recovered(manager, before)

    def assert_limit(self, manager, tag):
        """A line that is too long is answered: under its tag, which stands at its beginning."""
        reply = manager.answer(tag)
        self.assertEqual(reply.kind, "limit", repr(reply)[:200])

    def test_a_hundred_megabytes_without_newline_leave_memory_flat(self):
        manager = self.world()
        before = manager.hash()
        size = manager.memory()
        block = b"x" * (1 << 20)
        manager.send(b"@huge echo ")
        for _ in range(100):
            manager.send(block)
        manager.send(b"\n")
        self.assert_limit(manager, "huge")
        if not sailor.SANITIZED:
            self.assertLess(manager.memory() - size, 8 << 20)
        self.assert_recovered(manager, before)

    def test_a_hundred_megabytes_of_joined_lines_leave_memory_flat(self):
        # a backslash at its end joins a line with the next, where people write
        process = subprocess.Popen([BIN / "dialog_manager", "--keep-going"], cwd=self.folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, env=sailor.environment(self.folder))
        block = b"x" * 1000 + b"\\\n"
        for _ in range(1000):
            process.stdin.write(block * 100)
        process.stdin.write(b"x\necho after\n")
        process.stdin.flush()
        self.assertEqual(process.stdout.readline(), b"after\n")
        process.stdin.close()
        self.assertIn(b"error limit", process.stderr.read())
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stdout.close()
        process.stderr.close()
        self.assertEqual(process.returncode, 1)
        if not sailor.SANITIZED:
            self.assertLess(usage.ru_maxrss, 32 << 10, "kB")

    def test_a_mistake_in_the_last_of_many_values_changes_none(self):
        manager = self.world()
        manager.must("type row")
        manager.must("field row.x real[]")
        manager.must("field row.places vec3[] m in -10 10")
        manager.must("create row r x 1 2 3")
        before = manager.hash()
        for line, kind in (("set r.x 1 2 3 4 5 6 7 8 9 10 eleven", "type"), ("set r.x 1 2 3 4 5 6 7 8 9 10 1e309", "range"),
                           ("set r.places 1 2 3 4 5 6 7 8 11", "range"), ("set r.places 1 2 3 4 5", "syntax"),
                           ("set r.x 1 2 3 4 5 6 7 8 9 10 4kg", "unit"), ("create row s x 1 2 3 places 1 2 nan", "type"),
                           ("create sphere t radius 1 position 0 0 0 orientation 1 0 0 x", "type")):
            with self.subTest(line):
                manager.refused(line, kind)
                self.assertEqual(manager.must("get r.x"), "1 2 3")
                self.assert_recovered(manager, before)

    def test_one_byte_per_write(self):
        manager = self.world()
        for byte in b"@1 create node slow\n@2 get slow.visible\n":
            manager.send(bytes([byte]))
        self.assertTrue(manager.answer("1").ok)
        self.assertEqual(manager.answer("2").body, ["true"])

    def test_many_lines_in_one_write_are_answered_in_order(self):
        manager = self.world()
        manager.send(b"".join(b"@n%d set ball.position %d 0 0\n" % (n, n) for n in range(20000)))
        for n in range(20000):
            self.assertTrue(manager.answer(f"n{n}").ok)
        self.assertEqual(manager.must("get ball.position"), "19999 0 0")

    def test_a_stream_cut_at_every_byte_executes_whole_lines_only(self):
        stream = b"create node a\nset a.position 1 2 3\n\"\n"
        for length in range(len(stream) + 1):
            path = self.folder / "kept"
            path.unlink(missing_ok=True)
            done = self.run_manager("--keep-going", "--journal", "kept", stdin=stream[:length])
            self.assertIn(done.returncode, (0, 1), done.stderr)
            kept = path.read_text() if path.exists() else ""
            self.assertEqual("create node a" in kept, length >= 14, f"cut at {length}")
            self.assertEqual("set a.position" in kept, length >= 35, f"cut at {length}")

    def test_a_half_line_ends_a_pipe_that_stops_at_errors(self):
        for stream in (b"get a", b"create node a\nget a", b"create node a\nset a.visible \\\nfalse", b"echo \\\n"):
            for option in ((), ("--keep-going",)):
                done = self.run_manager(*option, stdin=stream)
                self.assertEqual(done.returncode, 1 if not stream.endswith(b"\n") else 0, (stream, done.stderr))
                errors = [line for line in done.stderr.splitlines() if "error" in line]
                self.assertEqual(len(errors), 0 if stream.endswith(b"\n") else 1, (stream, done.stderr))

    def test_tags_come_back_as_they_were(self):
        manager = self.world()
        for tag in ("1", "a", "x" * 60, "a-b.c:d/e", "0"):
            manager.send(f"@{tag} echo hello\n".encode())
            self.assertEqual(manager.answer(tag).body, ["hello"])

    def test_an_untagged_line_is_silent_on_success(self):
        manager = self.world()
        manager.send(b"set probe.visible false\n\n# comment\n@after echo x\n")
        self.assertEqual(manager.line(), "  x")
        self.assertEqual(manager.line(), "@after ok")

    def test_a_body_may_look_like_a_closing_line(self):
        manager = self.world()
        self.assertEqual(manager.must('echo "@1 ok"'), "@1 ok")
        self.assertEqual(manager.must('echo "event gone x"'), "event gone x")

    def test_unambiguous_abbreviations_are_refused_in_pipes(self):
        manager = self.world()
        manager.refused("lis", "unknown")
        manager.refused("creat node x", "unknown", "create")


class SlowLines(Case):
    def test_random_bytes_never_hurt(self):
        manager = self.world()
        chance = random.Random(1993)
        deadline = time.monotonic() + 20
        words = [b"set", b"ball.position", b"1", b"nan", b"\"", b"\\", b"#", b"@", b"create", b"node", b"delete", b"**", b"*",
                 b"begin", b"rollback", b"undo", b"redo", b"-", b"--", b"0", b"1e309", b"get", b"list", b"hash", b"time", b"help"]
        while time.monotonic() < deadline:
            lines = []
            for _ in range(200):
                if chance.random() < 0.5:
                    lines.append(bytes(chance.randrange(256) for _ in range(chance.randrange(80))).replace(b"\n", b""))
                else:
                    lines.append(b" ".join(chance.choice(words) for _ in range(chance.randrange(7))))
            manager.send(b"\n".join(line for line in lines if not line.strip().startswith(b"quit")) + b"\n@sync echo here\n")
            while True:
                line = manager.line()
                self.assertIsNotNone(line, f"the manager ended: {manager.errors[-3:]}")
                if line == "@sync ok":
                    break
        manager.ask("rollback")
        manager.must("create node survivor")
        self.assertEqual(manager.must("list survivor"), "survivor")


if __name__ == "__main__":
    sailor.main()
