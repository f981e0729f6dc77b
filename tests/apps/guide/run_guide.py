#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Follows a page of the guide from top to bottom, as a reader does, in an empty folder.

    run_guide.py [--update] NLOS PAGE.md

Indented lines that begin with one of COMMANDS are run by the shell and must succeed, or end with the
status that a comment `# exit status N` gives. Fenced blocks mean, by the word behind the language:

    ```json scene.json                 a file that the page makes; matlab files are run, if Octave is there
    ```cpp tests/install/main.cpp      a name with a folder: equal to this file of the checkout
    ```text                            lines of what the command before printed; numbers within 10 %

Other blocks are not run. Pictures of the page are those that its commands write under the same name:
both must have the same size within 1 %, and --update replaces the page's. The folder sees apps, data and scenes
of the checkout.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TIMEOUT_S = 300
COMMANDS = ("nlos", "python3", "cmake", "cp", "mkdir")
NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
TOLERANCE = 0.1
OCTAVE_FUNCTIONS = Path(__file__).resolve().parent / "octave"  # those of MATLAB that it lacks


class Mismatch(Exception):
    """The page says something else than the program."""


class Follower:
    def __init__(self, program: str, page: Path, folder: Path):
        self.page, self.folder = page, folder
        self.root = page.parents[2]
        self.output = ""  # of the last command
        for name in ("apps", "data", "scenes"):
            os.symlink(self.root / name, folder / name)
        tools = folder / ".tools"
        tools.mkdir()
        os.symlink(Path(program).resolve(), tools / "nlos")
        os.symlink(sys.executable, tools / "python3")
        self.environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}",
                            "LC_ALL": "C.UTF-8", "PYTHONDONTWRITEBYTECODE": "1"}

    def run(self, command: str) -> None:
        announced = re.search(r"# exit status (\d+)", command)
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=TIMEOUT_S)
        self.output = done.stdout
        print("$", command, done.stdout, sep="\n", flush=True)
        if done.returncode != int(announced[1] if announced else 0):
            raise Mismatch(f"status {done.returncode} of: {command}")

    def take_block(self, language: str, name: str, body: str) -> None:
        if language == "text":
            for line in body.splitlines():
                if not any(same(line, printed) for printed in self.output.splitlines()):
                    raise Mismatch(f"not printed: {line}")
        elif "/" in name:
            if (self.root / name).read_text(encoding="utf-8") != body:
                raise Mismatch(f"differs from the file {name}")
        elif name:
            (self.folder / name).write_text(body, encoding="utf-8")
            if language == "matlab" and shutil.which("octave"):
                self.run(f"octave --no-gui --quiet --path {OCTAVE_FUNCTIONS} {name}")

    def check_picture(self, link: str, update: bool) -> None:
        shown = self.page.parent / link
        written = sorted(self.folder.rglob(shown.name))
        if not written:
            raise Mismatch(f"no command writes {shown.name}")
        if update:
            shown.parent.mkdir(exist_ok=True)
            shutil.copyfile(written[0], shown)
        sizes = size_of_png(shown), size_of_png(written[0])
        if any(abs(a - b) > 0.01 * b for a, b in zip(*sizes)):
            raise Mismatch(f"{link} is stale, {sizes[0]} pixels for {sizes[1]}: --update")


def same(announced: str, printed: str) -> bool:
    """A line of the page and one that was printed: numbers agree within TOLERANCE, `...` stands for
    anything, and any space for any other."""
    pattern, wanted = "", []
    for piece in re.findall(rf"\.\.\.|\s+|{NUMBER}|.", announced.strip()):
        if re.fullmatch(NUMBER, piece):
            wanted.append(float(piece))
            pattern += f"({NUMBER})"
        else:
            pattern += ".*" if piece == "..." else r"\s+" if piece.isspace() else re.escape(piece)
    found = re.fullmatch(pattern, printed.strip())
    return found is not None and all(
        abs(float(number) - value) <= TOLERANCE * abs(value)
        for number, value in zip(found.groups(), wanted))


def size_of_png(path: Path) -> tuple[int, int]:
    head = path.read_bytes()[:24]
    return int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")


def follow(page: Path, follower: Follower, update: bool) -> None:
    text = page.read_text(encoding="utf-8")
    lines = iter(text.splitlines())
    commands = 0
    for line in lines:
        if line.startswith("```"):
            language, _, name = line[3:].partition(" ")
            body = []
            while not (line := next(lines)).startswith("```"):
                body.append(line + "\n")
            follower.take_block(language, name.strip(), "".join(body))
        elif line.startswith("    ") and line.split()[0] in COMMANDS:
            follower.run(line.strip())
            commands += 1
    for link in re.findall(r"!\[[^]]*\]\(([^)]*\.png)\)", text):
        follower.check_picture(link, update)
    if not commands and "```" not in text:
        raise Mismatch("holds no command")


def main(arguments: list[str]) -> int:
    update = arguments[0] == "--update"
    program, page = arguments[update:]
    with tempfile.TemporaryDirectory(prefix="guide_") as folder:
        try:
            follow(Path(page).resolve(),
                   Follower(program, Path(page).resolve(), Path(folder)), update)
        except Mismatch as problem:
            print(f"{page}: {problem}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
