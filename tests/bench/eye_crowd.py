#!/usr/bin/env python3
"""What a tick costs when many pairs of eyes follow a moving ball: eye_crowd.py [FIGURES] [-- METHOD...]

Runs the dialog manager twice, for 2 and for 4 simulated seconds at 60 Hz, and takes the difference, so that neither the start nor the making of the scene counts.
Processor time of both programs together; the eyes' own part as they report it, the rest is the manager's: lines read, checked, stored and told, on both sides.
"""

import os
import pathlib
import resource
import subprocess
import sys
import tempfile

BIN = pathlib.Path(__file__).resolve().parents[2] / "build/release/bin"


def scene(figures, method, seconds):
    lines = ["start eye_control", "start wave", "create wave ball middle 0 1.6 3 height 0.4 period 2.5"]
    for k in range(figures):
        s, head = f"s{k}", f"s{k}/head"
        lines += [f"create node {s} position {k % 40 * 0.1 - 2} 0 {-(k // 40) * 0.5}", f"create node {head} parent {s} position 0 1.6 0",
                  f"create eye {s}/l parent {head} position 0.03 0.03 0.085", f"create eye {s}/r parent {head} position -0.03 0.03 0.085",
                  f"create gaze {s}/gaze left {s}/l right {s}/r head {head} target ball method {method}"]
    return "\n".join(lines + [f"run {seconds}s", "get s0/gaze.elapsed", "hash"]) + "\n"


def run(figures, method, seconds):
    """Processor time of manager and programs together, s; and what the eyes say of one figure's tick, s."""
    with tempfile.NamedTemporaryFile("w", suffix=".dlg") as script:
        script.write(scene(figures, method, seconds))
        script.flush()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        said = subprocess.run([BIN / "dialog_manager", script.name], check=True, capture_output=True, text=True,
                              env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}).stdout.split()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, float(said[-2])


def main():
    words = sys.argv[1:]
    figures = int(words.pop(0)) if words and words[0] != "--" else 1000
    for method in words[1:] or ["snap", "full"]:
        short, _ = run(figures, method, 2)
        long, elapsed = run(figures, method, 4)
        tick, eyes = 1e3 * (long - short) / 120, 1e3 * elapsed * figures
        print(f"{figures} figures, {method}: {tick:.2f} ms a tick, of these the eyes {eyes:.2f}, manager and lines {tick - eyes:.2f}")


if __name__ == "__main__":
    main()
