"""The show without its film: every claim of the script holds, and no joint leaves its range."""

import csv
import pathlib

import sailor
from sailor import Case, SOURCE

BODY = pathlib.Path("/usr/share/assimp/models/Collada/human.zae")


class Show(Case):
    def test_every_claim_holds_and_no_joint_leaves_its_range(self):
        if not BODY.exists():
            self.skipTest(f"{BODY} is not there")
        (self.folder / "out").mkdir()
        lines = (SOURCE / "scripts/scenes/sailor.dlg").read_text().replace("\\\n", " ").splitlines()
        shown = ("movie", "snapshot", "sheet")
        scene = "\n".join(line for line in lines if not line.startswith(shown))
        scene = scene.replace("source deck", f"source {SOURCE}/scripts/scenes/deck")
        scene = scene.replace("source gull", f"source {SOURCE}/scripts/scenes/gull")
        scene = scene.replace("source figures", f"source {SOURCE}/scripts/figures")
        self.file("scene.dlg", scene)
        done = self.run_manager("-c", "source scene.dlg", "-c", "get sailor/*.lower", "-c", "get sailor/*.upper", timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        limits = {}
        for line in done.stdout.splitlines():
            name, _, value = line.partition(" ")
            path, _, side = name.rpartition(".")
            limits.setdefault(path, {})[side] = float(value)
        self.assertGreater(len(limits), 60)
        with open(self.folder / "out/sailor_joints.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertGreater(len(rows), 190)
        moved = 0
        for path, limit in limits.items():
            column = f"{path}.angle_rad"
            angles = [float(row[column]) for row in rows]
            # the solvers clamp exactly; a picoradian is the rounding of a sum of shares
            self.assertGreaterEqual(min(angles), limit["lower"] - 1e-12, path)
            self.assertLessEqual(max(angles), limit["upper"] + 1e-12, path)
            moved += max(angles) - min(angles) > 0.01
        self.assertGreater(moved, 20)


if __name__ == "__main__":
    sailor.main()
