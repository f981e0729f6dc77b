#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the Ray example of apps/dataset and compares its data set with one that the program makes.

    ray_test.py NLOS        exit status 77 without Ray, or without nlos.generate
"""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tiny_data_set import differences, generate, is_whole, write_recipe

try:
    import nlos
    import ray  # noqa: F401
except ModuleNotFoundError as missing:
    print(f"skipped: {missing}; bash apps/bench/field/install_peers.sh DIR installs Ray")
    sys.exit(77)

EXAMPLE = Path(__file__).resolve().parents[3] / "apps" / "dataset" / "generate_with_ray.py"
TIMEOUT_S = 300


def main(program: str) -> int:
    if not hasattr(nlos, "generate"):
        print("skipped: the module has no generate()")
        return 77
    with tempfile.TemporaryDirectory(prefix="ray_") as name:
        folder = Path(name)
        recipe = write_recipe(folder / "recipe.json", items=60, shards=12)
        generate(program, recipe, "-o", folder / "one_process")
        quiet = {**os.environ, "RAY_USAGE_STATS_ENABLED": "0"}
        # Relative paths, as a reader gives them.
        done = subprocess.run([sys.executable, EXAMPLE, "recipe.json", "ray", "4"], cwd=folder,
                              env=quiet, capture_output=True, text=True, timeout=TIMEOUT_S)
        if done.returncode != 0:
            print(done.stdout[-4000:], done.stderr[-4000:])
            return 1
        problems = differences(folder / "one_process", folder / "ray")
        if not is_whole(program, folder / "ray"):
            problems.append("--verify finds it not whole")
        print("\n".join(problems) or "4 parts by Ray: the bytes of one process")
        return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
