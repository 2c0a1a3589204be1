"""What others may not do to a session: files and FIFOs of theirs, links laid out as traps, names that a shell would run."""

import os
import pathlib
import stat
import subprocess

import sailor
from sailor import BIN, SOURCE, Case

# a name that does something where a shell reads it
EVIL = "x'\"; touch pwned; $(touch pwned) `touch pwned` & | > pwned #"


class Security(Case):
    def mode(self, name):
        return stat.S_IMODE((self.folder / name).stat().st_mode)

    def assert_not_run(self):
        self.assertFalse((self.folder / "pwned").exists(), "a name was run as a command")

    def test_what_it_makes_is_for_its_owner_only(self):
        manager = self.world(preexec=lambda: os.umask(0))
        manager.must("journal kept")
        manager.must("branch other")
        manager.must("listen ear")
        for name in ("kept", "other", "ear"):
            self.assertEqual(self.mode(name), 0o600, name)
        manager.must("journal off")
        # one that was open to others is closed to them
        os.chmod(self.folder / "kept", 0o644)
        manager.must("journal kept")
        self.assertEqual(self.mode("kept"), 0o600)

    def test_what_others_may_write_is_refused(self):
        manager = self.world()
        before = manager.hash()
        self.file("open", b"")
        os.chmod(self.folder / "open", 0o666)
        manager.refused("journal open", "io", "0600")
        os.mkfifo(self.folder / "public")
        os.chmod(self.folder / "public", 0o622)
        manager.refused("listen public", "io", "0600")
        if os.geteuid() == 0:
            self.file("foreign", b"")
            os.mkfifo(self.folder / "foreign_ear", 0o600)
            for name in ("foreign", "foreign_ear"):
                os.chown(self.folder / name, 65534, 65534)
            manager.refused("journal foreign", "io", "ours")
            manager.refused("listen foreign_ear", "io", "ours")
        self.assert_recovered(manager, before)
        done = self.run_manager("--journal", "open", "-c", "echo x")
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)

    def test_links_laid_out_as_traps(self):
        precious = "create node precious\n"
        manager = self.world()
        before = manager.hash()
        for trap, line in (("kept", "journal kept"), ("ear", "listen ear")):
            self.file("precious", precious)
            (self.folder / trap).symlink_to(self.folder / "precious")
            manager.refused(line, "io")
            self.assertEqual((self.folder / "precious").read_text(), precious, line)
            self.assert_recovered(manager, before)
        # the name under which a save is written first
        (self.folder / "world.dlg.part").symlink_to(self.folder / "precious")
        manager.must("save world.dlg")
        self.assertEqual((self.folder / "precious").read_text(), precious)
        self.assertIn("ball", (self.folder / "world.dlg").read_text())
        self.assertFalse((self.folder / "world.dlg").is_symlink())
        # a branch does not write over anything
        manager.must("journal story")
        manager.refused("branch precious", "io")
        self.assertEqual((self.folder / "precious").read_text(), precious)
        # a link of our own is followed, and stays one
        self.file("real.dlg", "create node old\n")
        (self.folder / "link.dlg").symlink_to(self.folder / "real.dlg")
        manager.must("save link.dlg")
        self.assertTrue((self.folder / "link.dlg").is_symlink())
        self.assertIn("ball", (self.folder / "real.dlg").read_text())

    def test_a_journal_does_not_take_the_place_of_another_file(self):
        manager = self.world()
        before = manager.hash()
        for content in ("create node precious\n", "x"):
            self.file("scene.dlg", content)
            manager.refused("journal scene.dlg", "exists", "scene.dlg")
            self.assertEqual((self.folder / "scene.dlg").read_text(), content)
            self.assert_recovered(manager, before)
        # an old journal, or an empty file
        self.file("empty", b"")
        manager.must("journal empty")
        manager.must("journal story")
        manager.must("journal empty")
        manager.must("set ball.visible false")

    def test_a_fifo_that_was_replaced_is_not_listened_to(self):
        manager = self.world()
        manager.must("listen ear")
        before = manager.hash()
        mouth = os.open(self.folder / "ear", os.O_WRONLY)
        os.unlink(self.folder / "ear")
        self.file("ear", "set ball.position 6 6 6\n")
        os.close(mouth)
        manager.event("gone ear")
        self.assert_recovered(manager, before)
        manager.must("unlisten ear")

    def test_no_name_is_read_by_a_shell(self):
        manager = self.world()
        quoted = '"' + EVIL.replace("\\", "\\\\").replace('"', '\\"') + '"'
        for line in (f"start {quoted}", f"start wave with {quoted}", f"start wave with env -- {quoted}", f"source {quoted}", f"save {quoted}",
                     f"journal {quoted}", f"branch {quoted}", f"replay {quoted}", f"listen {quoted}", f"trace {quoted} ball.position",
                     f"echo {quoted}", f"create node {quoted}", f"type {quoted}"):
            with self.subTest(line):
                manager.ask(line, timeout=30)
                self.assert_not_run()
        for name in sorted(os.listdir(self.folder)):
            self.assertNotEqual(name, "pwned")
        self.file("tells", "#!/bin/sh\nprintf '%s\\n' \"$@\" > told\nread hello\necho ready\nwhile read line; do echo done; done\n")
        os.chmod(self.folder / "tells", 0o755)
        manager.must(f"start ./tells -- {quoted} plain")
        self.assertEqual((self.folder / "told").read_text(), EVIL + "\nplain\n")
        self.assert_not_run()

    def test_a_sweep_over_names_that_a_shell_would_run(self):
        inner = self.folder / "a b'; touch pwned; '$(touch pwned)"
        inner.mkdir()
        (inner / "scene.dlg").write_text('type thing\nfield thing.a text\ncreate thing t\n')
        fake = self.folder / "fake"
        fake.mkdir()
        (fake / "sbatch").write_text('#!/bin/bash\nfor word; do job=$word; done\nSLURM_ARRAY_TASK_ID=0 bash -c "${job#--wrap=}"\n')
        os.chmod(fake / "sbatch", 0o755)
        environ = sailor.environment(self.folder, DIALOG_MANAGER=str(BIN / "dialog_manager"))
        environ["PATH"] = f"{fake}:{environ['PATH']}"
        for extra in ((), ("--slurm",)):
            out = inner / f"out{len(extra)}.csv"
            done = subprocess.run([SOURCE / "scripts/sweep", "--scene", inner / "scene.dlg", "--vary", 't.a="$(touch pwned)"', "--run", "0.1",
                                   "--measure", "t.a", "--out", out, *extra], cwd=self.folder, env=environ, capture_output=True,
                                  timeout=60, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("$(touch pwned)", out.read_text())
            self.assert_not_run()
            self.assertFalse((inner / "pwned").exists())

    def test_a_script_is_a_file_that_ends(self):
        manager = self.world()
        before = manager.hash()
        os.mkfifo(self.folder / "pipe")
        for line, kind in (("source pipe", "io"), ("replay pipe", "io"), ("replay /dev/zero", "io"), ("source /dev/zero", "limit")):
            with self.subTest(line):
                manager.refused(line, kind)
                self.assert_recovered(manager, before)
        done = self.run_manager("--resume", "pipe", "-c", "echo x")
        self.assertEqual(done.returncode, 1, done.stderr)

    def test_a_program_writes_only_what_it_declared(self):
        # every way of changing the world that the language has, each said by a program that declared to write nothing
        ways = ["set probe.visible false", "set ball.radius 1", "create node mine", "delete ball", "delete **", "undo", "begin", "rollback",
                "run 1", "step", "rate 1Hz", "quit", "save stolen.dlg", "journal stolen", "branch stolen", "source /dev/null",
                "start walker", "end thief", "trace stolen ball.position", "replay kept", "rewind 0", "type new", "field sphere.new real",
                "at 0 delete ball", "every 1ms delete ball", "when ball.visible == true delete ball", "journal off", "unlisten ear",
                "forget 1", "pace 2", "budget time 1ms", "monitor on"]
        for way in ways:
            with self.subTest(way):
                (self.folder / "kept").unlink(missing_ok=True)
                self.file("thief", f"#!/bin/sh\nread hello\necho 'reads sphere'\necho ready\nwhile read verb n rest; do\n"
                                   f"[ $verb = tick ] && {{ [ -e tried ] || echo '{way}'; : > tried; echo done $n; }}\n"
                                   "case $verb in error*) echo \"$verb $n $rest\" >> answered;; esac\ndone\n")
                os.chmod(self.folder / "thief", 0o755)
                for name in ("tried", "answered"):
                    (self.folder / name).unlink(missing_ok=True)
                manager = self.world("--journal", "kept")
                manager.must("start ./thief")
                manager.must("every 1s echo x")
                before = manager.hash()
                manager.must("step 3")
                self.assertTrue((self.folder / "tried").exists())
                self.assert_recovered(manager, before)
                self.assertEqual(manager.must("get ball.radius"), "0.04")
                self.assertRegex(manager.must("time"), "0.05")
                self.assertEqual(manager.must("list"), "ball\nprobe\nprobe/inner")
                self.assertIn("schedule", manager.must("sources") + "schedule")
                self.assertFalse([name for name in os.listdir(self.folder) if name.startswith("stolen")], "it wrote a file")
                manager.end()

    def test_the_environment_and_its_secrets_are_written_nowhere(self):
        secret = "s3cret-7b1f"
        environ = sailor.environment(self.folder, API_TOKEN=secret)
        done = self.run_manager("--journal", "kept", "-c", "start wave", "-c", "create wave w", "-c", "step 3", "-c", "save world.dlg",
                                "-c", "trace t.csv w.position", "-c", "step", "-c", "help", "-c", "describe wave", "-c", "manipulators",
                                "-c", "stats", "-c", "print --json **", "-c", "why w.position", environ=environ)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn(secret, done.stdout + done.stderr)
        for path in self.folder.iterdir():
            self.assertNotIn(secret.encode(), path.read_bytes(), path)

    def test_a_picture_does_not_follow_a_trap(self):
        if not (BIN / "render").exists():
            self.skipTest("render is not built")
        precious = self.file("precious", "precious\n")
        (self.folder / "p.png.part").symlink_to(precious)
        done = self.run_manager("-c", "start render", "-c", "create sphere ball radius 1", "-c", "create camera c position 0 0 5",
                                "-c", "snapshot p.png from c size 16x16", timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(precious.read_text(), "precious\n")
        self.assertEqual((self.folder / "p.png").read_bytes()[1:4], b"PNG")
        self.assertFalse((self.folder / "p.png").is_symlink())

    def test_a_film_is_a_file_whatever_its_name(self):
        if not (BIN / "render").exists():
            self.skipTest("render is not built")
        import shutil
        if not shutil.which("ffmpeg"):
            self.skipTest("ffmpeg is not installed")
        scene = ["-c", "start render", "-c", "create sphere ball radius 1", "-c", "create camera c position 0 0 5", "-c", "rate 10Hz"]
        for name in ("-y.mp4", "tcp:x.mp4", "x;touch pwned;.mp4"):
            with self.subTest(name):
                done = self.run_manager(*scene, "-c", f'movie "{name}" from c size 16x16', "-c", "step 2", "-c", "movie off", timeout=60)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue((self.folder / name).exists(), sorted(os.listdir(self.folder)))
                self.assert_not_run()

    def test_no_source_calls_a_shell(self):
        """Programs are started by their words, never by a line of text."""
        found = []
        for folder in ("dialog_manager", "objdb", "manipulators"):
            for path in pathlib.Path(SOURCE / folder).rglob("*.cc"):
                text = path.read_text()
                for call in ("system(", "popen(", "wordexp(", '"/bin/sh"', '"sh"', '"bash"', "-c\", \"sh"):
                    if call in text:
                        found.append(f"{path.relative_to(SOURCE)}: {call}")
        self.assertEqual(found, [])


if __name__ == "__main__":
    sailor.main()
