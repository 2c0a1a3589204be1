#!/usr/bin/env python3
"""Time from `set ball.position` said to the dialog manager to changed pixels on the screen of an X server.

    render_latency.py BIN [ROUNDS]

The server keeps its screen in a file (Xvfb -fbdir), which is watched; nothing is asked of the server meanwhile.
"""

import mmap
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

FIGURES = pathlib.Path(__file__).resolve().parents[2] / "scripts/figures"
WORLDS = {
    "a ball": [],
    "a ball and the sailor": [f"source {FIGURES}/skeleton.dlg under sailor", f"source {FIGURES}/body.dlg under sailor"],
}


def screen(folder):
    """The rows of the screen: an XWD file, whose header says how long it is and where the pixels begin."""
    with open(os.path.join(folder, "Xvfb_screen0"), "rb") as file:
        memory = mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ)
    header = struct.unpack(">25I", memory[:100])
    begin = header[0] + 12 * header[19]
    row = header[12]
    return memory, begin + 300 * row, 120 * row


def measure(name, world, bin_folder, display, folder, rounds):
    manager = subprocess.Popen([f"{bin_folder}/dialog_manager", "--framed"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, env={**os.environ, "DISPLAY": display})

    def say(line, wait=True):
        manager.stdin.write(f"@t {line}\n".encode())
        manager.stdin.flush()
        while wait and not manager.stdout.readline().startswith(b"@t"):
            pass

    for line in ("start render", *world, "create sphere ball radius 0.2 position 0.4 0.9 0.5 color 0.8 0.1 0.1",
                 "create node aim position 0 0.9 0", "create camera front position 0 1 3.4 target aim",
                 "create view v camera front quality draft", "window on size 1280x720"):
        say(line)
    time.sleep(1)
    memory, begin, length = screen(folder)
    times = []
    for k in range(rounds):
        before = memory[begin:begin + length]
        started = time.perf_counter()
        say(f"set ball.position {0.45 - 0.05 * (k % 2)} 0.9 0.5", wait=False)
        say("window refresh", wait=False)
        while memory[begin:begin + length] == before:
            if time.perf_counter() - started > 5:
                raise TimeoutError("no pixel changed")
        times.append(time.perf_counter() - started)
        time.sleep(0.15)
    manager.stdin.close()
    manager.wait()
    times.sort()
    print(f"  {name:44s} {times[0] * 1e3:10.1f} {times[len(times) // 2] * 1e3:16.1f}")


def main():
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 15
    with tempfile.TemporaryDirectory() as folder:
        read_end, write_end = os.pipe()
        server = subprocess.Popen(["Xvfb", "-displayfd", str(write_end), "-screen", "0", "1280x720x24", "-nolisten", "tcp",
                                   "-fbdir", folder], pass_fds=[write_end], stderr=subprocess.DEVNULL)
        os.close(write_end)
        try:
            display = ":" + os.fdopen(read_end).readline().strip()
            print("\nfrom `set ball.position` to pixels on the screen, draft, 1280x720")
            print(f"  {'':44s} {'best ms':>10s} {'median ms':>16s}")
            for name, world in WORLDS.items():
                measure(name, world, sys.argv[1], display, folder, rounds)
        finally:
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
