#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a capture in the layouts of other groups, from descriptions of those layouts alone.

    write_layouts.py                            lists the layouts, and what each needs
    write_layouts.py CAPTURE.h5 LAYOUT FOLDER   writes a capture of ours

Beside the file stands expected.h5: what a reader must make of it, in y-tal's layout.
"""
from __future__ import annotations

import sys
from pathlib import Path

import cubes
import described
import point_lists
import sensors
from capture import read_ytal, write_ytal
from case import Case, Written

CASES: list[Case] = [*cubes.CASES, *point_lists.CASES, *described.CASES, *sensors.CASES]


def write_case(case: Case, source: Path, folder: Path) -> Written:
    """Writes `source` as the case says into an empty folder, and expected.h5 beside it."""
    files = folder / "files"
    files.mkdir(parents=True)
    written = case.write(read_ytal(source), files)
    write_ytal(folder / "expected.h5", written.expected)
    return written


def main(arguments: list[str]) -> int:
    if not arguments:
        for case in CASES:
            print(f"{case.name:36} {case.source}")
        return 0
    if len(arguments) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    source, name, folder = arguments
    case = next((case for case in CASES if case.name == name), None)
    if case is None:
        print(f"{name} is no layout; known are {', '.join(case.name for case in CASES)}",
              file=sys.stderr)
        return 2
    written = write_case(case, Path(source), Path(folder))
    print(" ".join([f"wrote {written.path}", *(f"--set {key}" for key in written.settings)]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
