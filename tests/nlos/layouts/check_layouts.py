#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that the program reads every layout as it is meant.

    check_layouts.py NLOS [--only TEXT] [--keep FOLDER]

For each layout: the program renders a capture, write_layouts.py writes it in that layout, `nlos
convert` reads it, and histograms must agree bit for bit, points to a micrometre, the axis to 1e-9,
unit, pattern and segments exactly. Prints a line per case; exit status 1 if any failed, 77 if numpy,
scipy or h5py are missing.
"""
from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    from compare_captures import capture_differences
    from render_source import render_source
    from write_layouts import CASES, write_case
except ModuleNotFoundError as missing:
    print(f"skipped: {missing}; install python3-numpy, python3-scipy and python3-h5py")
    sys.exit(77)

from capture import read_ytal
from case import Case

TIMEOUT_S = 120


class CommandFailed(Exception):
    """A command of the program that did not succeed, with its message."""


def run(program: str, *arguments: object) -> None:
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True,
                          timeout=TIMEOUT_S)
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).strip().splitlines() or ["no message"]
        raise CommandFailed(f"nlos {arguments[0]} ends with {done.returncode}: {lines[-1]}")


def check_case(case: Case, program: str, sources: Path, folder: Path) -> list[str]:
    """Everything that a case does not keep to; empty when it is read as meant."""
    try:
        source = render_source(case.source, sources, lambda *a: run(program, *a))
        written = write_case(case, source, folder)
        converted = folder / "converted.h5"
        settings = ("--set", *written.settings) if written.settings else ()
        run(program, "convert", written.path, converted, *settings)
        return capture_differences(written.expected, read_ytal(converted))
    except (CommandFailed, subprocess.TimeoutExpired) as failure:
        return [str(failure)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="the nlos executable")
    parser.add_argument("--only", default="", help="cases whose name contains this")
    parser.add_argument("--keep", help="a folder that the files stay in")
    options = parser.parse_args()
    failed = 0
    cases = [case for case in CASES if options.only in case.name]
    with tempfile.TemporaryDirectory(prefix="layouts_") as temporary:
        folder = Path(options.keep or temporary)
        for case in cases:
            name = case.name.replace(", ", "_").replace(" ", "_")
            problems = check_case(case, options.program, folder / "sources", folder / name)
            print(f"{'FAIL' if problems else 'ok  '} {case.name}", flush=True)
            for problem in problems:
                print(f"       {problem}", flush=True)
            failed += bool(problems)
    print(f"{len(cases) - failed} passed, {failed} failed")
    return 1 if failed or not cases else 0


if __name__ == "__main__":
    sys.exit(main())
