#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Kills `nlos generate` at random times and checks that nothing is lost, doubled or different.

    kill_test.py NLOS [--items N] [--shards N] [--kills N] [--format hdf5|webdataset] [--seed N]

A data set is made once undisturbed. Then the same command is started and killed by SIGKILL over
and over; whenever a data set is whole before the kills are used up, it is compared byte for byte
and the next one begun.
"""
from __future__ import annotations

import argparse
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tiny_data_set import differences, generate, is_whole, shards_of, write_recipe


def run_until(command: list[str], seconds: float) -> bool:
    """Starts a command and kills it after so long; whether it was still running then."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        status = process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True
    if status != 0:
        raise SystemExit(f"ended by itself with status {status}")
    return False


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--items", type=int, default=200)
    parser.add_argument("--shards", type=int, default=10)
    parser.add_argument("--kills", type=int, default=15)
    parser.add_argument("--format", default="hdf5")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="kill_") as name:
        folder = Path(name)
        recipe = write_recipe(folder / "recipe.json", options.items, options.shards, samples=300,
                              format=options.format)
        begin = time.monotonic()
        generate(options.program, recipe, "-o", folder / "undisturbed")
        whole_s = time.monotonic() - begin
        # A killed run finishes two shards in the mean; the first takes longer, for the preview.
        longest_s = {"from nothing": whole_s, "going on": 4 * whole_s / options.shards}

        kills = sets = resumed = 0

        def wants_more() -> bool:
            # On a busy machine all kills may fall before the first shard or behind the last.
            return kills < options.kills or (resumed == 0 and kills < 10 * options.kills)

        disturbed = folder / "disturbed"
        command = [options.program, "generate", str(recipe), "-o", str(disturbed)]
        while True:
            goes_on = disturbed.exists() and 0 < len(shards_of(disturbed)) < options.shards
            resumed += goes_on
            longest = longest_s["going on" if goes_on else "from nothing"]
            if wants_more() and run_until(command, rng.uniform(0, longest)):
                kills += 1
                continue
            generate(*command[:1], *command[2:])
            sets += 1
            problems = differences(folder / "undisturbed", disturbed)
            if not is_whole(options.program, disturbed):
                problems.append("--verify finds it not whole")
            if problems:
                print("\n".join(problems))
                return 1
            if not wants_more():
                break
            shutil.rmtree(disturbed)
        print(f"{kills} kills over {sets} data sets of {options.items} items in {options.shards} "
              f"shards ({whole_s:.1f} s undisturbed): {resumed} runs went on from shards of "
              "earlier ones, all bytes as undisturbed")
        if resumed == 0:
            print("no run was killed between its first and its last shard: nothing was tested")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
