"""A face that is told what to show: timing, errors, muscles of one's own, and a program that dies while it smiles."""

import os
import pathlib
import signal
import unittest

import sailor
from sailor import BIN, Case, children

HEAD = "/usr/share/assimp/models/Collada/human.zae"
WORLD = ("rate 50Hz", "start face_fem", f"create mesh head file {HEAD}", "create face f skin head", "step")


def least_jerk(s):
    s = min(max(s, 0.0), 1.0)
    return s**3 * (10 - 15 * s + 6 * s * s)


def vectors(text):
    numbers = list(map(float, text.split()))
    return [numbers[k : k + 3] for k in range(0, len(numbers), 3)]


def farthest(text):
    return max((sum(x * x for x in d) ** 0.5 for d in vectors(text)), default=0.0)


@unittest.skipUnless((BIN / "face_fem").exists() and pathlib.Path(HEAD).exists(), "no face_fem or no head file")
class Express(Case):
    def stage(self, *arguments):
        manager = self.manager(*arguments)
        for line in WORLD:
            manager.must(line, timeout=120)
        return manager

    def number(self, manager, field):
        return float(manager.must(f"get f.{field}"))

    def test_an_expression_comes_stays_and_goes(self):
        manager = self.stage()
        self.assertEqual(manager.must("get f.status"), "ok", manager.must("get f.reason"))
        self.assertEqual(farthest(manager.must("get f.displacement")), 0)
        manager.must("express f AU12L=0.8 for 1s onset 200ms offset 400ms")
        for tick in range(1, 60):
            manager.must("step")
            time = 0.02 * tick
            expected = 0.8 * least_jerk(time / 0.2) * (1 - least_jerk((time - 0.6) / 0.4))
            self.assertAlmostEqual(self.number(manager, "AU12L"), expected, 12)
            self.assertEqual(self.number(manager, "AU12R"), 0)
        self.assertEqual(farthest(manager.must("get f.displacement")), 0)
        self.assertEqual(manager.must("get f.expressing"), '""')

    def test_sides_move_alone(self):
        manager = self.stage()
        manager.must("express f AU12L onset 20ms")
        manager.must("run 100ms")
        moved = vectors(manager.must("get f.displacement"))
        whole = farthest(manager.must("get f.displacement"))
        # the pull is up and outward, to the person's left, which is +x
        strong = [d for d in moved if sum(x * x for x in d) > 0.09 * whole**2]
        self.assertGreater(sum(d[0] for d in strong), 0)
        self.assertGreater(sum(d[1] for d in strong), 0)
        self.assertGreater(whole, 0.005)

    def test_relax_and_speech_end_where_they_began(self):
        manager = self.stage()
        manager.must("express f smile=0.7 AU4")
        manager.must("speak f m a=200ms m o length 120ms")
        manager.must("run 300ms")
        self.assertGreater(self.number(manager, "jaw"), 0.02)
        self.assertIn("speech", manager.must("get f.expressing"))
        manager.must("run 1s")
        self.assertEqual(self.number(manager, "jaw"), 0)
        self.assertIn("smile 0.7", manager.must("get f.expressing"))
        manager.must("relax f offset 100ms")
        manager.must("run 120ms")
        self.assertEqual(farthest(manager.must("get f.displacement")), 0)

    def test_wrong_words_are_refused_whole(self):
        manager = self.stage()
        for line, kind, pattern in (
            ("express f", "syntax", "expected express FACE"),
            ("express nobody smile", "unknown", "nobody"),
            ("express head smile", "unknown", "has no face"),
            ("express f smlle=1", "unknown", "did you mean smile"),
            ("express f smile=1.5", "range", "expected 0 to 1"),
            ("express f smile AU4=-1", "range", "expected 0 to 1"),
            ("express f smile=much", "type", "smile"),
            ("express f smile for 0s", "range", "more than 0"),
            ("express f smile for 1m", "unit", ""),
            ("express f smile for", "syntax", ""),
            ("express f smile for 1s for 2s", "syntax", ""),
            ("express f smile for 1s onset 800ms offset 300ms", "range", "no more than the 1 s"),
            ("relax f smile", "syntax", ""),
            ("speak f", "syntax", ""),
            ("speak f smile", "unknown", "no viseme"),
            ("speak f a=0s", "range", ""),
            ("muscles f perhaps", "syntax", "on|off"),
        ):
            with self.subTest(line):
                manager.refused(line, kind, pattern)
        manager.must("step")
        self.assertEqual(farthest(manager.must("get f.displacement")), 0)
        self.assertEqual(manager.must("get f.expressing"), '""')
        manager.must("express f smile")
        manager.must("step 5")
        self.assertGreater(farthest(manager.must("get f.displacement")), 0)

    def test_an_expression_of_ones_own(self):
        manager = self.stage()
        manager.must("create expression smirk parts AU12L=0.6 AU14R=0.3")
        manager.must("express f smirk=0.5 onset 20ms")
        manager.must("step 3")
        self.assertAlmostEqual(self.number(manager, "AU12L"), 0.3)
        self.assertAlmostEqual(self.number(manager, "AU14R"), 0.15)
        manager.must("set smirk.parts AU12L=2")
        manager.refused("express f smirk", "range", "smirk")
        manager.must("set smirk.parts smirk")
        manager.refused("express f smirk", "unknown", "smirk")

    def test_muscles_in_the_world(self):
        manager = self.stage()
        manager.must("muscles f on")
        manager.must("step 2")
        self.assertGreater(len(manager.must("list f/*").splitlines()), 40)
        manager.must("express f AU12 onset 20ms")
        manager.must("step 3")
        self.assertEqual(manager.must("get f/left_zygomaticus_major.activation"), "1")
        before = farthest(manager.must("get f.displacement"))
        force = float(manager.must("get f/left_zygomaticus_major.force"))
        self.assertGreater(force, 0)
        manager.must(f"set f/left_zygomaticus_major.force {2 * force}")
        manager.must("step")
        self.assertGreater(farthest(manager.must("get f.displacement")), 1.1 * before)
        # an end outside all tissue is told and changes nothing
        manager.must("set f/left_zygomaticus_major.insertion 0 0 3")
        manager.must("step")
        self.assertIn("zygomaticus_major", manager.must("get f.reason"))
        manager.must("muscles f off")
        manager.must("step")
        manager.refused("list f/*", "unknown")
        self.assertAlmostEqual(farthest(manager.must("get f.displacement")), before, 6)

    def test_a_face_without_a_head_says_so(self):
        manager = self.manager()
        self.file("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        for line in ("start face_fem", "create face f", "step"):
            manager.must(line, timeout=60)
        self.assertEqual(manager.must("get f.status"), "no_head")
        for name, word in (("nowhere.obj", "nowhere.obj"), ("cube.obj", "cube.obj")):
            manager.must(f"create mesh m_{name[:4]} file {name}")
            manager.must(f"set f.skin m_{name[:4]}")
            manager.must("step")
            self.assertEqual(manager.must("get f.status"), "no_face")
            self.assertIn(word, manager.must("get f.reason"))
        manager.must("express f AU12")
        manager.must("step 30")
        self.assertAlmostEqual(self.number(manager, "AU12L"), 1)

    def test_the_method_follows_the_budget(self):
        manager = self.stage()
        manager.must("set f.method auto")
        manager.must("express f AU12 onset 20ms")
        manager.must("step 3")
        self.assertEqual(manager.must("get f.method_used"), "contact")
        manager.must("budget time 0.1ms")
        manager.must("step")
        self.assertEqual(manager.must("get f.method_used"), "basis")
        manager.must("budget error 1cm")
        manager.must("step")
        self.assertEqual(manager.must("get f.method_used"), "contact")

    def test_a_program_that_dies_while_it_smiles_leaves_no_trace(self):
        def play(kill_at=()):
            manager = self.stage("--seed", "4")
            manager.must("express f smile=0.8 for 900ms")
            hashes = []
            for tick in range(60):
                if tick == 10:
                    manager.must("speak f m a o length 150ms")
                if tick == 35:
                    manager.must("relax f")
                if tick in kill_at:
                    os.kill(children(manager.pid)[0], signal.SIGKILL)
                manager.must("step", timeout=60)
                hashes.append((manager.hash(), manager.must("get f.displacement")))
            manager.end()
            return hashes

        undisturbed = play()
        self.assertEqual(undisturbed, play(kill_at=(7, 22)))


if __name__ == "__main__":
    sailor.main()
