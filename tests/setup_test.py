#!/usr/bin/env python3
"""Every header from outside the project belongs to a package that scripts/setup installs, itself or by dependency.

Headers that are not on this machine are not judged: they belong to optional peers.
"""

import collections
import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(os.environ.get("SOURCE_DIR", pathlib.Path(__file__).resolve().parents[1]))
ROOTS = ("usr/include/", "usr/include/eigen3/", "usr/include/x86_64-linux-gnu/", "usr/include/freetype2/", "usr/include/suitesparse/")


def includes():
    """Header -> files that include it as <header>."""
    found = collections.defaultdict(set)
    for folder in ("objdb", "dialog_manager", "manipulators", "tests"):
        for path in sorted((SOURCE / folder).rglob("*")):
            if path.suffix in (".cc", ".h"):
                for header in re.findall(r"^\s*#\s*include\s*<([^>]+)>", path.read_text("utf-8"), re.MULTILINE):
                    found[header].add(str(path.relative_to(SOURCE)))
    return found


def owners(headers):
    """Header -> the packages that hold it."""
    wanted = {"/" + root + header: header for header in headers for root in ROOTS}
    found = collections.defaultdict(set)
    for listing in pathlib.Path("/var/lib/dpkg/info").glob("*.list"):
        for line in listing.read_text("utf-8").split("\n"):
            if line in wanted:
                found[wanted[line]].add(listing.stem.partition(":")[0])
    return found


def installed():
    """Package -> the names it depends on; names that are only provided point to their providers."""
    depends = collections.defaultdict(set)
    status = subprocess.run(["dpkg-query", "--show", "--showformat=${Package}\t${Depends}, ${Pre-Depends}\t${Provides}\n"],
                            capture_output=True, text=True, check=True).stdout
    for line in status.splitlines():
        package, needs, provides = line.split("\t")
        depends[package] |= set(re.findall(r"(?:^|[,|])\s*([a-z0-9][a-z0-9.+-]*)", needs))
        for name in re.findall(r"(?:^|,)\s*([a-z0-9][a-z0-9.+-]*)", provides):
            depends[name].add(package)
    return depends


def main():
    listed = subprocess.run([SOURCE / "scripts/setup", "--list"], capture_output=True, text=True, check=True).stdout.split()
    depends = installed()
    reached, open_ = set(), list(listed)
    while open_:
        name = open_.pop()
        if name not in reached:
            reached.add(name)
            open_ += depends.get(name, ())
    headers = includes()
    missing = 0
    for header, packages in sorted(owners(headers).items()):
        if not packages & reached:
            missing += 1
            print(f"<{header}> of {' or '.join(sorted(packages))} is not in scripts/setup; included by {', '.join(sorted(headers[header]))}")
    sys.exit(1 if missing else 0)


if __name__ == "__main__":
    main()
