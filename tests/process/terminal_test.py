"""The prompt on a terminal: editing, completion, history, interrupts, and the terminal as it was afterwards."""

import os
import pty
import re
import select
import signal
import subprocess
import termios
import time

import sailor
from sailor import BIN, Case


class Terminal(Case):
    def setUp(self):
        super().setUp()
        self.main, self.other = pty.openpty()
        self.before = termios.tcgetattr(self.other)
        self.seen = ""
        self.addCleanup(os.close, self.main)
        self.addCleanup(os.close, self.other)

    def start(self, *arguments):
        self.process = subprocess.Popen([BIN / "dialog_manager", *arguments], cwd=self.folder, env=sailor.environment(self.folder),
                                        stdin=self.other, stdout=self.other, stderr=self.other, start_new_session=True,
                                        preexec_fn=lambda: __import__("fcntl").ioctl(0, termios.TIOCSCTTY, 0))
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)
        self.prompt()

    def read(self, wait=0.05):
        while select.select([self.main], [], [], wait)[0]:
            self.seen += os.read(self.main, 65536).decode("utf-8", "replace")

    def until(self, pattern):
        deadline = time.monotonic() + sailor.PATIENCE
        while not re.search(pattern, self.plain()):
            self.assertLess(time.monotonic(), deadline, f"no {pattern!r} in {self.seen!r}")
            self.read()

    def plain(self):
        """What was shown, without the sequences that move and colour."""
        return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b[()][A-Z0-9]|\x1b[=>]", "", self.seen).replace("\r", "").replace("\a", "")

    def prompt(self):
        self.until(r"> ?$")

    def type(self, text):
        self.seen = ""
        os.write(self.main, text.encode())

    def say(self, line):
        """Types a line; what is shown until the next prompt."""
        self.type(line + "\r")
        self.until(r"\n(.*\n)*.*> ?$")
        return self.plain()

    def test_commands_answers_and_errors(self):
        self.start("--norc")
        self.say("create node ball")
        self.assertIn("0 0 0", self.say("get ball.position"))
        self.assertRegex(self.say("nonsense"), "error unknown")
        self.assertRegex(self.say("crate node x"), "did you mean .*create")
        self.say("set ball.position 1 2 3")
        self.assertIn("1 2 3", self.say("get ball.position"))

    def test_verbs_may_be_shortened(self):
        self.start("--norc")
        self.say("create node ball")
        self.assertIn("ball", self.say("lis"))

    def test_tab_completes_verbs_paths_fields_and_words(self):
        self.start("--norc")
        for line in ("create node elephant", "type star", "field star.mood word of melancholy merry", "create star sun"):
            self.say(line)
        self.type("rollb\t")
        self.until("rollback")
        self.say("")
        self.type("get eleph\t")
        self.until("get elephant")
        self.type(".posit\t")
        self.until("position")
        self.assertIn("0 0 0", self.say(""))
        self.type("set sun.mood mel\t")
        self.until("melancholy")
        self.say("")
        self.assertIn("melancholy", self.say("get sun.mood"))

    def test_history_lasts_from_session_to_session(self):
        self.start("--norc")
        self.say("echo remembered_line")
        self.type("quit\r")
        self.assertEqual(self.process.wait(sailor.PATIENCE), 0)
        self.seen = ""
        self.start("--norc")
        self.type("\x1b[A\x1b[A")
        self.until("remembered_line")

    def test_the_rc_file(self):
        self.file(".dialog_managerrc", "create node from_rc\n")
        self.start()
        self.assertIn("from_rc", self.say("list"))

    def test_interactive_after_scripts(self):
        self.file("scene.dlg", "create node from_scene\n")
        self.start("--norc", "-i", "scene.dlg")
        self.assertIn("from_scene", self.say("list"))

    def test_an_interrupt_drops_the_line(self):
        self.start("--norc")
        self.type("create node half\x03")
        self.until("> ?$")
        self.say("create node whole")
        shown = self.say("list")
        self.assertIn("whole", shown)
        self.assertNotRegex(shown, r"(?m)^half")

    def test_an_interrupt_stops_a_long_run(self):
        self.start("--norc")
        self.say("pace realtime")
        self.type("run 1000\r")
        time.sleep(0.3)
        self.type("\x03")
        self.until("> ?$")
        self.assertRegex(self.say("time"), r"\d")

    def test_end_of_file_ends_it(self):
        self.start("--norc")
        self.type("\x04")
        self.assertEqual(self.process.wait(sailor.PATIENCE), 0)

    def test_the_terminal_is_as_it_was(self):
        for how in ("quit\r", "\x04", signal.SIGTERM, signal.SIGHUP):
            with self.subTest(str(how)):
                self.seen = ""
                self.start("--norc")
                if isinstance(how, str):
                    self.type(how)
                else:
                    self.process.send_signal(how)
                self.process.wait(sailor.PATIENCE)
                self.assertEqual(termios.tcgetattr(self.other)[:4], self.before[:4])
                self.assertTrue(os.get_blocking(self.other), "the terminal was left non-blocking")

    def test_a_long_line_and_a_continued_line(self):
        self.start("--norc")
        self.assertIn("x" * 300, self.say("echo " + "x" * 300).replace("\n", ""))
        self.type("create sphere ball \\\r")
        self.until(">")
        self.say("radius 4cm")
        self.assertIn("0.04", self.say("get ball.radius"))

    def test_output_of_programs_does_not_break_the_prompt(self):
        self.start("--norc")
        self.say("start wave")
        self.say("create wave w")
        self.say("step 3")
        self.assertIn("wave", self.say("manipulators"))


if __name__ == "__main__":
    sailor.main()
