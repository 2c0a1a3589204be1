#!/usr/bin/env python3
"""Runs what the documentation shows: every `console` block of the README, the guide to the language, and pages with a line `<!-- tested -->`.

A line `$ command` is run by bash in a folder of the page's own, with the executables on PATH and SAILOR_ROOT naming the sources; the lines below it are what it has to print
(standard output and error together; `...` stands for any lines, `…` for the rest of a line). A command that shows no error must succeed.
Other pages can be named on the command line.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(os.environ.get("SOURCE_DIR", pathlib.Path(__file__).resolve().parents[1]))
BIN = pathlib.Path(os.environ.get("BIN_DIR", SOURCE / "build/release/bin"))


def commands(page):
    """Line number, command and expected lines of every `$ ` in the console blocks of a page."""
    found, inside, open_command = [], False, False
    for number, line in enumerate(page.read_text("utf-8").split("\n"), 1):
        if line.startswith("```"):
            inside = line.strip() == "```console"
            open_command = False
        elif inside and line.startswith("$ "):
            found.append([number, line[2:], []])
            open_command = line.endswith("\\")
        elif inside and open_command:
            found[-1][1] += "\n" + line
            open_command = line.endswith("\\")
        elif inside and found:
            found[-1][2].append(line)
    return found


def fits(wanted, got):
    """Whether the lines are those wanted; `...` stands for as many as fit."""
    if not wanted:
        return not got
    if wanted[0] == "...":
        return any(fits(wanted[1:], got[skip:]) for skip in range(len(got) + 1))
    if not got:
        return False
    pattern = ".*".join(re.escape(part) for part in wanted[0].split("…"))
    return bool(re.fullmatch(pattern, got[0])) and fits(wanted[1:], got[1:])


def main():
    pages = [pathlib.Path(name).resolve() for name in sys.argv[1:]] or [
        SOURCE / "README.md", SOURCE / "docs/language.md",
        *(page for page in sorted((SOURCE / "docs").glob("*.md")) if "\n<!-- tested -->\n" in page.read_text("utf-8"))]
    environment = {**os.environ, "PATH": f"{BIN}:{SOURCE / 'tests/process/programs'}:{os.environ['PATH']}", "SAILOR_ROOT": str(SOURCE), "LC_ALL": "C.UTF-8"}
    failed = count = 0
    for page in pages:
        with tempfile.TemporaryDirectory(prefix="sailor-") as folder:
            for number, command, wanted in commands(page) if page.exists() else ():
                count += 1
                done = subprocess.run(["bash", "-c", command], cwd=folder, env={**environment, "HOME": folder}, stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False)
                got = done.stdout.decode("utf-8", "replace").removesuffix("\n").split("\n") if done.stdout else []
                unexpected = done.returncode != 0 and not any("error" in line for line in wanted)
                if unexpected or not fits(wanted, got):
                    failed += 1
                    print(f"{page.relative_to(SOURCE)}:{number}: $ {command}")
                    print("shows", *(f"  {line}" for line in wanted), sep="\n")
                    print(f"but printed (status {done.returncode})", *(f"  {line}" for line in got), "", sep="\n")
    print(f"{count} commands, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
