"""The sailor follows a ball with head and eyes: the scene keeps what it promises, also when the eyes are killed on the way."""

import os
import re
import signal

import sailor
from sailor import SOURCE, Case

# everything about the eyes that is drawn by chance or wears out
RESTLESS = "later_sigma 1 drift_speed 0.003 microsaccade_rate 1.5 blink_rate 1 slip_noise 0.002 listing_tilt 0.25 integrator_time 25"


def scene():
    """The scene without arms, body and pictures, as lines."""
    figures = SOURCE / "scripts/figures"
    text = (SOURCE / "scripts/scenes/follow.dlg").read_text()
    text = re.sub(r"(?m)^(start (render|arm_ik)|create (light|camera) .*|snapshot .*|trace .*|#.*)$", "", text)
    text = text.replace("source figures/sailor.dlg under sailor", f"source {figures}/skeleton.dlg under sailor\nsource {figures}/gaze.dlg under sailor")
    return [line for line in text.split("\n") if line]


class Gaze(Case):
    def column(self, manager, name):
        """A number that the manager tells of the eyes' program."""
        line = next(line for line in manager.must("manipulators").splitlines() if line.startswith("eye_control "))
        return int(re.search(rf" {name}=(\d+)", line)[1])

    def play(self, lines, killed=()):
        """The scene line by line; before the lines with these numbers the eyes are killed. The hash at the end."""
        manager = self.manager("--seed", "7")
        manager.must("checkpoints every 25")
        for number, line in enumerate(lines):
            if number in killed:
                os.kill(self.column(manager, "pid"), signal.SIGKILL)
            manager.must(line, timeout=sailor.PATIENCE * 6)
        self.assertEqual(self.column(manager, "restarts"), len(killed))
        found = manager.hash()
        manager.end()
        return found

    def test_the_scene_keeps_what_it_promises(self):
        self.play(scene())

    def test_killed_on_the_way_restless_eyes_go_on_to_the_same_bits(self):
        lines = [line for line in scene() if not line.startswith("expect")]
        # the runs in pieces, so that there are moments to be killed at
        pieces = []
        for line in lines:
            if line.startswith("run "):
                length = float(line[4:-1])
                pieces += [f"run {length / 4!r}s"] * 4
            else:
                pieces.append(line)
        at = next(n for n, line in enumerate(pieces) if line.startswith("look "))
        words = RESTLESS.split()
        pieces[at:at] = [f"set sailor/gaze.{name} {value}" for name, value in zip(words[::2], words[1::2])]
        runs = [n for n, line in enumerate(pieces) if line.startswith("run ")]
        calm = self.play(pieces)
        # in a saccade far aside, then in pursuit with the head turning and at the near ball
        for killed in ((runs[17],), (runs[27], runs[-3])):
            self.assertEqual(self.play(pieces, killed), calm)


if __name__ == "__main__":
    sailor.main()
