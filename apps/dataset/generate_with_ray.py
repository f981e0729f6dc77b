#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes a data set on all processors of a Ray cluster, or of this machine.

    generate_with_ray.py RECIPE.json FOLDER [PARTS]

All machines must see the folder under the same name. What is finished is kept: a part whose machine
was lost is tried again by Ray, and the same command goes on after anything else.
"""
import sys
from pathlib import Path

import ray

import nlos


@ray.remote
def part(recipe: str, folder: str, i: int, n: int) -> None:
    nlos.generate(recipe, folder, shard=(i, n), threads=1)  # one processor, as Ray plans


def main(recipe: str, folder: str, parts: str = "8") -> None:
    n = int(parts)
    paths = [str(Path(path).resolve()) for path in (recipe, folder)]
    ray.init()
    ray.get([part.remote(*paths, i, n) for i in range(n)])


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
