"""A program that moves the vertices of a face, and the pictures that render takes of it."""

import sailor
from sailor import Case

# a square of 9 x 9 vertices before a camera; vertex 40 is its middle
SHEET = "".join(f"v {0.1 * c - 0.4} {0.1 * r - 0.4} 0\n" for r in range(9) for c in range(9)) + "".join(
    f"f {d - 10} {d - 9} {d} {d - 1}\n" for d in (9 * r + c + 1 for r in range(1, 9) for c in range(1, 9)))
WORLD = ("create mesh sheet file sheet.obj", "create camera front position 0.5 0.6 1.5 target sheet",
         "create view v camera front width 160 height 120 ground none")
FACE = "create face f skin sheet vertices 40 41 31"


class Faces(Case):
    def stage(self, *first):
        self.file("sheet.obj", SHEET)
        manager = self.manager()
        for line in (*first, *WORLD):
            manager.must(line, timeout=30)
        return manager

    def picture(self, manager, name):
        manager.must(f"snapshot {name}.png", timeout=30)
        return (self.folder / f"{name}.png").read_bytes()

    def test_the_picture_follows_the_program(self):
        for first in (("start mime", "start render"), ("start render", "start mime")):
            with self.subTest(first=first):
                manager = self.stage(*first)
                rest = self.picture(manager, "rest")
                manager.must(FACE)
                self.assertEqual(self.picture(manager, "still"), rest, "a face that was not computed yet is at rest")
                manager.must("set f.push 20cm")
                manager.must("step")
                pushed = self.picture(manager, "pushed")
                self.assertNotEqual(pushed, rest)
                self.assertEqual(manager.must("get sheet.reason"), '""')
                manager.must("set f.push 0")
                manager.must("step")
                self.assertEqual(self.picture(manager, "again"), rest)
                # without the face there is the sheet of the file again
                manager.must("set f.push 20cm")
                manager.must("step")
                self.assertEqual(self.picture(manager, "pushed_again"), pushed)
                manager.must("delete f")
                self.assertEqual(self.picture(manager, "bare"), rest)

    def test_the_face_stays_when_its_program_is_gone(self):
        manager = self.stage("start mime", "start render")
        manager.must(FACE)
        manager.must("set f.push 20cm")
        manager.must("step")
        pushed = self.picture(manager, "pushed")
        manager.must("end mime")
        self.assertEqual(self.picture(manager, "left"), pushed)

    def test_a_face_that_does_not_fit_is_told(self):
        manager = self.stage("start mime", "start render")
        rest = self.picture(manager, "rest")
        manager.must("create face f skin sheet vertices 40 99")
        manager.must("step")
        self.assertEqual(self.picture(manager, "wrong"), rest)
        self.assertIn("vertex 99 is none of the surface's 81", manager.must("get sheet.reason"))
        manager.must("set f.vertices 40")
        manager.must("set f.push 20cm")
        manager.must("step")
        self.assertNotEqual(self.picture(manager, "right"), rest)
        self.assertEqual(manager.must("get sheet.reason"), '""')


if __name__ == "__main__":
    sailor.main()
