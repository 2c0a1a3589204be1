"""Conversations that go wrong: out of order, half done, broken off."""

import os
import re
import signal
import time

import sailor
from sailor import Case, children, until


class Session(Case):
    def test_declarations_of_programs_are_no_commands_of_people(self):
        manager = self.world()
        before = manager.hash()
        for line in ("hello protocol=1 name=me", "hello", "ready", "done 1", "tick 1 0 0.1", "checkpoint"):
            with self.subTest(line):
                reply = manager.ask(line)
                self.assertFalse(reply.ok)
                self.assertIn(reply.kind, ("unknown", "syntax", "owner"), repr(reply))
                self.assert_recovered(manager, before)

    def test_a_type_is_not_redefined(self):
        manager = self.world()
        manager.must("type thing extends node")
        manager.must("field thing.x real m = 1")
        before = manager.hash()
        manager.must("type thing extends node")
        manager.must("field thing.x real m = 1")
        for line in ("type thing", "type thing extends sphere", "field thing.x int", "field thing.x real m = 2", "field thing.x real s",
                     "type node extends sphere", "field thing.position real"):
            with self.subTest(line):
                self.assertFalse(manager.ask(line).ok)
                self.assert_recovered(manager, before)

    def test_what_is_referred_to_is_not_deleted(self):
        manager = self.world()
        manager.must("create node follower parent probe/inner")
        before = manager.hash()
        for line in ("delete probe", "delete probe/inner", "delete probe/**", "delete pro*"):
            with self.subTest(line):
                manager.refused(line, "busy", "follower")
                self.assert_recovered(manager, before)
        # all of them together may go
        manager.must("delete **")
        self.assertEqual(manager.must("list"), "")

    def test_deleting_what_is_watched_or_traced(self):
        manager = self.world()
        for line in ("watch ball.position", "trace t.csv ball.position", "when ball.visible == false set probe.visible false",
                     "every 10ms set ball.visible true", "delete ball"):
            manager.must(line)
        manager.ask("step 3")
        manager.must("create sphere ball")
        manager.must("step 3")
        manager.must("get ball.radius")

    def test_deleting_in_a_transaction_and_taking_it_back(self):
        manager = self.world()
        before = manager.hash()
        for line in ("begin", "delete ball", "create node ball", "set ball.position 9 9 9", "delete probe", "rollback"):
            manager.must(line)
        self.assert_recovered(manager, before)
        self.assertEqual(manager.must("get ball.radius"), "0.04")

    def test_rollback_after_an_error(self):
        manager = self.world()
        before = manager.hash()
        manager.must("begin")
        manager.must("set ball.position 7 7 7")
        manager.refused("set ball.position 1 2", "syntax")
        manager.refused("create sphere ball", "exists")
        manager.must("rollback")
        self.assert_recovered(manager, before)

    def test_a_group_of_any_length_is_taken_back_whole(self):
        # more changes than the commands of a tick are kept for
        manager = self.world()
        before = manager.hash()
        manager.must("begin")
        manager.send(b"".join(b"set ball.position %d 0 0\n" % n for n in range(70_000)))
        manager.must("rollback")
        self.assert_recovered(manager, before)

    def test_undo_and_redo_meet_the_same_worlds(self):
        manager = self.world()
        hashes = [manager.hash()]
        for line in ("set ball.position 1 2 3", "create node a", "create node a/b", "set a/b.parent ball", "delete probe", "create sphere probe",
                     "set a*.visible false", "type star extends node", "create star sun"):
            manager.must(line)
            hashes.append(manager.hash())
        while len(hashes) > 5:
            hashes.pop()
            manager.must("undo")
            if manager.hash() not in hashes[-2:]:
                self.assertEqual(manager.hash(), hashes[-1])

    def test_a_group_on_a_fifo_locks_nobody_out(self):
        # the lines of several writers mix on a FIFO and nobody knows when one of them leaves
        manager = self.world()
        manager.must("listen ear")
        with open(self.folder / "ear", "wb", buffering=0) as mouth:
            mouth.write(b"begin\nset ball.position 5 5 5\n")
        with open(self.folder / "ear", "wb", buffering=0) as mouth:
            mouth.write(b"create node heard\n")
        until(lambda: manager.ask("get heard.visible").ok, "the next writer is heard")
        manager.must("set probe.visible false")
        manager.must("step")

    def test_a_conversation_that_ends_inside_a_group_takes_it_back(self):
        done = self.run_manager("--keep-going", stdin=b"create node a\nbegin\nset a.position 1 2 3\n")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.file("open.dlg", "create node a\nbegin\nset a.position 1 2 3\n")
        done = self.run_manager("-c", "listen ear", "open.dlg", "-c", "rollback", "-c", "get a.position")
        self.assertEqual(done.stdout, "0 0 0\n", done.stderr)

    def test_scripts_that_source_themselves_nothing_or_a_folder(self):
        manager = self.world()
        before = manager.hash()
        self.file("self.dlg", "source self.dlg\n")
        self.file("a.dlg", "source b.dlg\n")
        self.file("b.dlg", "source a.dlg\n")
        for name, kinds in (("self.dlg", "limit"), ("a.dlg", "limit"), ("missing.dlg", "io|unknown"), (".", "io"), ("/", "io"),
                            ("/dev/null/x", "io|unknown")):
            with self.subTest(name):
                reply = manager.ask(f"source {name}")
                self.assertFalse(reply.ok)
                self.assertRegex(reply.kind, f"^({kinds})$", repr(reply))
                self.assert_recovered(manager, before)
        manager.must("source /dev/null")
        self.file("locked.dlg", "create node x\n")
        if os.geteuid():
            os.chmod(self.folder / "locked.dlg", 0)
            manager.refused("source locked.dlg", "io")

    def test_a_script_that_fails_in_the_middle_stops_or_goes_on(self):
        self.file("half.dlg", "create node first\nnonsense\nsave too_far.dlg\n")
        done = self.run_manager("-c", "source half.dlg", "-c", "save too_far.dlg")
        self.assertEqual(done.returncode, 1)
        self.assertIn("half.dlg:2:1: error unknown", done.stderr)
        self.assertFalse((self.folder / "too_far.dlg").exists(), "lines after the error were executed")
        manager = self.world()
        reply = manager.refused("source half.dlg", "unknown", "half.dlg:2:1")
        self.assertTrue((self.folder / "too_far.dlg").exists(), f"--keep-going goes on: {reply!r}")

    def test_saving_and_reading_gives_the_same_world(self):
        manager = self.world()
        for line in ("type star extends sphere \"it \\\"shines\\\"\"", "field star.names text[] = a c", "field star.kind word = dim of dim bright",
                     "field star.twin ref:star", "field star.curve real[] m", "create star sun kind bright curve 1 0.1 -0 1e-320",
                     "create star sirius twin sun names \"line\\nbreak\" \"tab\\t\" \"\"", "set sun.twin sirius", "create node late", "set ball.parent late",
                     "field star.later real = 0.1", "set sun.later 0.30000000000000004", "save world.dlg"):
            manager.must(line)
        other = self.manager()
        other.must("source world.dlg")
        self.assertEqual(other.hash(), manager.hash())
        self.assertEqual(other.must("get **"), manager.must("get **"))
        other.must("save again.dlg")
        self.assertEqual((self.folder / "again.dlg").read_bytes(), (self.folder / "world.dlg").read_bytes())
        done = self.run_manager("world.dlg", "-c", "hash")
        self.assertEqual(done.stdout.strip(), manager.hash(), done.stderr)

    def test_saving_where_one_cannot(self):
        manager = self.world()
        before = manager.hash()
        for path in (".", "no/such/folder/x.dlg", "/proc/x.dlg"):
            manager.refused(f"save {path}", "io")
            self.assert_recovered(manager, before)
        self.file("old.dlg", "create node precious\n")
        # what is no file is written to, not replaced
        os.mkfifo(self.folder / "pipe")
        reader = os.open(self.folder / "pipe", os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        manager.must("save pipe")
        self.assertTrue((self.folder / "pipe").is_fifo(), "the FIFO was replaced by a file")
        self.assertIn(b"ball", os.read(reader, 65536))
        manager.must("save old.dlg")
        self.assertIn("ball", (self.folder / "old.dlg").read_text())

    def test_why_tells_who_wrote_a_value(self):
        manager = self.world()
        manager.must("start wave")
        manager.must("create wave w")
        manager.must("step 3")
        self.assertIn("wave", manager.must("why w.position"))
        self.assertRegex(manager.must("why w.position"), r"\b3\b")
        manager.must("set ball.position 1 2 3")
        self.assertIn("set ball.position 1 2 3", manager.must("why ball.position"))
        # what nobody spoke of is a default, and no part of the story of an object
        self.assertIn("the default of node", manager.must("why ball.scale"))
        self.assertNotIn("scale", manager.must("why ball"))
        self.assertIn("ball.position 1 2 3", manager.must("why ball"))
        manager.refused("why nothing", "unknown")

    def test_watch_tells_changes_once_a_tick(self):
        manager = self.world()
        manager.must("start wave")
        manager.must("create wave w")
        manager.must("watch w.position")
        manager.must("step 3")
        told = [event for event in manager.events if "w.position" in event]
        reply = manager.must("echo x")
        told = [event for event in manager.events if "w.position" in event]
        self.assertEqual(len(told), 3, manager.events)
        manager.must("unwatch")
        manager.events.clear()
        manager.must("step 3")
        self.assertEqual([event for event in manager.events if "w.position" in event], [], reply)

    def test_monitor_shows_who_said_what(self):
        manager = self.world()
        manager.must("monitor on")
        manager.must("listen ear")
        with open(self.folder / "ear", "wb", buffering=0) as mouth:
            mouth.write(b"set probe.visible false\nnonsense\n")
        until(lambda: manager.must("get probe.visible") == "false", "it is heard")
        manager.must("start walker")
        manager.must("create walker w")
        manager.must("step")
        said = [event for event in manager.events if event.startswith("event said")]
        self.assertIn("event said ear set probe.visible false", said)
        self.assertTrue([event for event in said if event.startswith("event said walker set w.position")], said)
        self.assertFalse([event for event in said if "nonsense" in event], "a line that was refused")
        manager.must("monitor off")
        manager.events.clear()
        manager.must("step")
        self.assertEqual(manager.events, [])

    def test_trace_writes_numbers_with_units(self):
        manager = self.world()
        for line in ("rate 10Hz", "start wave", "create wave w height 1", "trace t.csv w.position ball.radius", "run 0.5", "sync x"):
            manager.must(line)
        manager.finish()
        lines = (self.folder / "t.csv").read_text().splitlines()
        self.assertEqual(lines[0].split(",")[0].split("_")[0].split("[")[0].strip(), "t")
        self.assertRegex(lines[0], r"w[./]position")
        self.assertRegex(lines[0], r"\bm\b|_m\b")
        self.assertGreaterEqual(len(lines), 6)
        width = lines[0].count(",")
        for line in lines[1:]:
            self.assertEqual(line.count(","), width)
            [float(cell) for cell in line.split(",")]
        self.assertAlmostEqual(float(lines[-1].split(",")[0]), 0.5)

    def test_trace_every_and_where_one_cannot(self):
        manager = self.world()
        manager.must("rate 100Hz")
        manager.must("trace t.csv ball.position every 100ms")
        manager.must("run 1")
        manager.refused("trace no/such/t.csv ball.position", "io")
        manager.refused("trace u.csv nothing.position", "unknown")
        manager.refused("trace u.csv ball.position every 0", "range")
        manager.finish()
        lines = (self.folder / "t.csv").read_text().splitlines()
        self.assertIn(len(lines), (11, 12), lines[:3])

    def test_sync_answers_after_everything_before_it(self):
        manager = self.world()
        manager.send(b"".join(b"set ball.position %d 0 0\n" % n for n in range(1000)) + b"@s sync token1\n@g get ball.position\n")
        manager.answer("s")
        self.assertEqual(manager.answer("g").body, ["999 0 0"])

    def test_rewind_and_branch(self):
        manager = self.manager("--seed", "5", "--journal", "kept")
        for line in ("rate 10Hz", "start walker", "create walker w", "run 1"):
            manager.must(line)
        middle = manager.hash()
        manager.must("run 1")
        end = manager.hash()
        manager.must("rewind 1")
        self.assertEqual(manager.hash(), middle)
        manager.must("run 1")
        self.assertEqual(manager.hash(), end)
        manager.refused("rewind 100", "range")
        manager.refused("rewind -1", "range")

    def test_limits_of_a_listening_fifo(self):
        manager = self.world()
        manager.refused("listen no/such/ear", "io")
        manager.must("listen made")
        self.assertTrue((self.folder / "made").is_fifo(), "it is made when it is not there")
        manager.must("unlisten made")
        self.file("plain", "create node x\n")
        manager.refused("listen plain", "io")
        manager.refused("unlisten nothing", "unknown")

    def test_signals_end_it_cleanly_at_every_stage(self):
        for stage in ("idle", "run", "start"):
            for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
                with self.subTest(f"{number.name} while {stage}"):
                    manager = self.manager()
                    manager.must("start walker")
                    manager.must("create walker w")
                    if stage == "run":
                        manager.must("pace realtime")
                        manager.send(b"@r run 1000\n")
                        time.sleep(0.05)
                    elif stage == "start":
                        manager.send(b"@r start walker as two -- hang! hello\n")
                        time.sleep(0.05)
                    everything = sailor.descendants(manager.pid)
                    os.kill(manager.pid, number)
                    if number == signal.SIGINT and stage == "idle":
                        # at a prompt an interrupt only drops the line; a framed conversation may end or stay
                        time.sleep(0.2)
                        manager.finish()
                    status = manager.process.wait(15)
                    self.assertIn(status, (0, 1, 128 + number, -number))
                    for pid in everything:
                        until(lambda pid=pid: not sailor.alive(pid), "it outlived the manager", 15)

    def test_file_names_are_relative_to_the_current_folder_or_the_script(self):
        (self.folder / "sub").mkdir()
        self.file("sub/outer.dlg", "source inner.dlg\n")
        self.file("sub/inner.dlg", "create node inner\n")
        done = self.run_manager("sub/outer.dlg", "-c", "list")
        self.assertEqual((done.returncode, done.stdout), (0, "inner\n"), done.stderr)

    def test_installed_scenes_are_found_from_any_folder(self):
        scenes = sorted((sailor.SOURCE / "scripts/scenes").glob("*.dlg")) if (sailor.SOURCE / "scripts/scenes").is_dir() else []
        if not scenes:
            self.skipTest("no scenes")
        done = self.run_manager("--check", scenes[0].name)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_json_is_json(self):
        import json
        manager = self.world()
        world = json.loads(manager.must("print --json **"))
        self.assertIn("ball", json.dumps(world))
        one = json.loads(manager.must("print --json ball.position"))
        self.assertIn("[0,1,0]", re.sub(r"\s|\.0\b", "", json.dumps(one)))

    def test_stats_count(self):
        manager = self.world()
        manager.must("stats reset")
        for _ in range(10):
            manager.must("set probe.visible true")
        manager.refused("nonsense", "unknown")
        self.assertRegex(manager.must("stats"), r"\d")

    def test_everything_in_help_is_described(self):
        manager = self.world()
        verbs = ("type field create set get delete list types describe help begin commit rollback undo redo run step pause resume pace rate time at "
                 "every when forget wait expect start end manipulators source save journal replay rewind branch listen unlisten sources monitor "
                 "watch unwatch trace print why budget methods hash stats sync echo quit").split()
        text = manager.must("help")
        for verb in verbs:
            with self.subTest(verb):
                self.assertRegex(text, rf"\b{verb}\b")
                self.assertIn(verb, manager.must(f"help {verb}"))
                self.assertIn(verb, manager.must(f"describe {verb}"))
        for type_ in ("node", "joint", "sphere", "box", "cylinder", "capsule", "mesh", "camera", "light"):
            self.assertIn(type_, manager.must("types"))
            self.assertIn(type_, manager.must(f"describe {type_}"))

    def test_a_hundred_sessions_leave_nothing_behind(self):
        for _ in range(20):
            manager = self.manager()
            manager.must("start wave")
            manager.must("create wave w")
            manager.must("step 2")
            self.assertEqual(manager.finish(), 0)
            self.assertEqual(children(manager.pid), [])


if __name__ == "__main__":
    sailor.main()
