#!/usr/bin/env python3
"""Plays a dialogue to the real dialog_manager and compares every answer.

A dialogue is a script in the language; what is expected stands in comments below each command:

    get ball.radius
    #= 0.04                       a line of the answer, literally
    #~ 0[.]0[0-9]+                a line of the answer, as a regular expression
    #...                          any lines
    set ball.radius 3kg
    #! unit 17 length             refused: kind, column (may be left out), regular expression of the sentence

It is played three times: line by line as a program would (--framed), as a script file, and through standard input.
`#@ modes script piped` at the top restricts this.  Without #! the whole must end with status 0, otherwise with 1.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "process"))
import sailor  # noqa: E402

ERROR = re.compile(r"^(?P<file>.*?):(?P<line>\d+):(?P<column>\d+): error (?P<kind>\w+) (?P<sentence>.*)$")


class Turn:
    """A command with what is expected of it."""

    def __init__(self, number, command):
        self.number = number
        self.command = command
        self.body = []
        self.error = None

    def expect(self, comment, place):
        mark, rest = comment[:2], comment[2:]
        rest = rest[1:] if rest.startswith(" ") else rest
        if mark == "#!":
            words = re.fullmatch(r"(\w+)(?: (\d+))?(?: (.*))?", rest)
            if not words or words[1] not in sailor.KINDS:
                raise SystemExit(f"{place}: not an expectation: {comment}")
            self.error = (words[1], int(words[2]) if words[2] else None, words[3] or "")
        elif comment.rstrip() == "#...":
            self.body.append(("any", ""))
        else:
            self.body.append(("literal" if mark == "#=" else "regex", rest))


def read(path):
    """The modes and turns of a dialogue."""
    modes, turns = ["framed", "script", "piped"], []
    continued = False
    for number, line in enumerate(path.read_text().split("\n"), 1):
        if line.startswith("#@ modes "):
            modes = line.split()[2:]
        elif re.match(r"#[=~!]|#\.\.\.$", line):
            turns[-1].expect(line, f"{path}:{number}")
        elif continued:
            turns[-1].command += "\n" + line
        elif line.strip() and not line.startswith("#"):
            turns.append(Turn(number, line))
        continued = bool(turns) and turns[-1].command.endswith("\\") and not line.startswith("#")
    return modes, turns


def matches(wanted, got):
    """Whether the lines are those wanted, `any` standing for as many as fit."""
    if not wanted:
        return not got
    kind, text = wanted[0]
    if kind == "any":
        return any(matches(wanted[1:], got[skip:]) for skip in range(len(got) + 1))
    if not got:
        return False
    same = text == got[0] if kind == "literal" else re.fullmatch(text, got[0])
    return bool(same) and matches(wanted[1:], got[1:])


def show(wanted):
    return "\n".join({"literal": "  = ", "regex": "  ~ ", "any": "  ..."}[kind] + text for kind, text in wanted) or "  nothing"


def differs(turn, kind, column, sentence):
    """The complaint about an error that came, or None."""
    if turn.error is None:
        return f"expected success, got: error {kind} {column} {sentence}"
    if kind != turn.error[0]:
        return f"expected an error of kind {turn.error[0]}, got: error {kind} {column} {sentence}"
    if turn.error[1] is not None and column != turn.error[1]:
        return f"expected the error at column {turn.error[1]}, got: error {kind} {column} {sentence}"
    if not re.search(turn.error[2], sentence):
        return f"expected {turn.error[2]!r} in: error {kind} {column} {sentence}"
    return None


def play_framed(path, turns, folder, complain):
    manager = sailor.Manager(cwd=folder)
    try:
        for turn in turns:
            reply = manager.ask(turn.command)
            if not reply.ok:
                complaint = differs(turn, reply.kind, reply.column - len(f"@t{manager.tag} "), reply.sentence)
                if complaint:
                    complain(turn, complaint)
            elif turn.error:
                complain(turn, f"expected error {turn.error[0]}, it was accepted: {reply.body}")
            if not matches(turn.body, reply.body):
                complain(turn, "expected\n" + show(turn.body) + "\ngot\n" + "\n".join("    " + line for line in reply.body))
        status = manager.finish()
        if status != int(any(turn.error for turn in turns)):
            complain(turns[-1], f"exit status {status}")
    finally:
        manager.end()


def play_whole(path, turns, folder, complain, piped):
    command = [sailor.BIN / "dialog_manager", "--keep-going"] + ([] if piped else [path])
    done = subprocess.run(command, cwd=folder, env=sailor.environment(folder), input=path.read_bytes() if piped else b"",
                          capture_output=True, timeout=3 * sailor.PATIENCE, check=False)
    wanted = [entry for turn in turns for entry in turn.body]
    got = done.stdout.decode().split("\n")[:-1]
    if not matches(wanted, got):
        complain(turns[0], "expected\n" + show(wanted) + "\ngot\n" + "\n".join("    " + line for line in got))
    came = {}
    for line in done.stderr.decode().split("\n"):
        error = ERROR.match(line)
        if error:
            came[int(error["line"])] = error
            if not piped and pathlib.Path(error["file"]).name != path.name:
                complain(turns[0], f"the error names the file {error['file']!r}: {line}")
    for turn in turns:
        error = came.pop(turn.number, None)
        if error:
            complaint = differs(turn, error["kind"], int(error["column"]), error["sentence"])
            if complaint:
                complain(turn, complaint)
        elif turn.error:
            complain(turn, f"expected error {turn.error[0]} on stderr, there is none for this line")
    for number, error in came.items():
        complain(turns[0], f"an error for line {number}, where no command begins: {error[0]}")
    if done.returncode != int(any(turn.error for turn in turns)):
        complain(turns[-1], f"exit status {done.returncode}\n{done.stderr.decode()}")


def main():
    if len(sys.argv) < 2:
        print("usage: play.py DIALOGUE.dlg ...", file=sys.stderr)
        sys.exit(2)
    complaints = 0
    for name in sys.argv[1:]:
        path = pathlib.Path(name).resolve()
        modes, turns = read(path)
        for mode in modes:
            def complain(turn, text, mode=mode):
                nonlocal complaints
                complaints += 1
                print(f"{os.path.relpath(path)}:{turn.number}: ({mode}) {turn.command}\n{text}\n")

            with tempfile.TemporaryDirectory(prefix="sailor-") as folder:
                if mode == "framed":
                    play_framed(path, turns, folder, complain)
                else:
                    play_whole(path, turns, folder, complain, mode == "piped")
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
