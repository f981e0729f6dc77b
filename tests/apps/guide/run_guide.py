#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the commands of a page of the guide from top to bottom, in an empty folder.

    run_guide.py NLOS PAGE.md

Commands are the indented lines that begin with nlos or python3; `< FILE` at the end is their input.
Each must succeed. The folder sees
apps, data and scenes of the checkout, as a reader does who follows the page there.
"""
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

TIMEOUT_S = 300


def commands_of(page: str) -> list[list[str]]:
    lines = [line.strip() for line in page.splitlines() if line.startswith("    ")]
    return [shlex.split(line) for line in lines if line.startswith(("nlos ", "python3 "))]


def main(program: str, page: str) -> int:
    commands = commands_of(Path(page).read_text(encoding="utf-8"))
    if not commands:
        sys.exit(f"{page}: holds no command")
    root = Path(page).resolve().parents[2]
    with tempfile.TemporaryDirectory(prefix="guide_") as folder:
        for name in ("apps", "data", "scenes"):
            os.symlink(root / name, Path(folder) / name)
        for command in commands:
            words = [program if command[0] == "nlos" else sys.executable, *command[1:]]
            given = ""
            if "<" in words:
                given = (Path(folder) / words[-1]).read_text(encoding="utf-8")
                words = words[:words.index("<")]
            done = subprocess.run(words, cwd=folder, capture_output=True, text=True, input=given,
                                  timeout=TIMEOUT_S)
            print("$", " ".join(command), done.stdout, done.stderr, sep="\n", flush=True)
            if done.returncode != 0:
                print(f"{page}: status {done.returncode}")
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
