# SPDX-License-Identifier: MIT
"""A recipe whose items take a few milliseconds, and how the tests of data sets run the program."""
from __future__ import annotations

import filecmp
import json
import subprocess
from pathlib import Path

TIMEOUT_S = 600


def write_recipe(path: Path, items: int, shards: int, samples: int = 64, **changes: object) -> Path:
    """Plates and boxes before 4 x 4 points with 64 bins; 1,000 samples take about 5 ms."""
    recipe = {
        "items": items,
        "items_per_shard": -(-items // shards),
        "meshes": {"shapes": ["plate", "box"]},
        "objects": {"count": {"integers": [1, 2]}},
        "scene": {
            "scan": {"pattern": "confocal", "sensing_points": [4, 4]},
            "time_axis": {"opl_start_m": 0.6, "bin_width_m": 0.04, "num_bins": 64},
            "render": {"method": "path", "samples": samples},
            "ground_truth": {"depth_resolution": [8, 8]},
        },
        "detector": {"photons_per_point": 1000},
        "draw": {"scene.relay_wall.albedo": {"uniform": [0.5, 0.9]}},
        "truths": ["depth", "mask", "poses"],
        "storage": {"histograms": "uint16"},
        **changes,
    }
    path.write_text(json.dumps(recipe, indent=2), encoding="utf-8")
    return path


def generate(program: str, *arguments: object) -> str:
    """Runs `nlos generate`, which must succeed; returns what it printed."""
    done = subprocess.run([program, "generate", *map(str, arguments)], capture_output=True,
                          text=True, timeout=TIMEOUT_S)
    if done.returncode != 0:
        raise SystemExit(f"nlos generate {' '.join(map(str, arguments))}: {done.stderr[-2000:]}")
    return done.stdout


def is_whole(program: str, folder: Path) -> bool:
    done = subprocess.run([program, "generate", "--verify", str(folder)], capture_output=True,
                          text=True, timeout=TIMEOUT_S)
    return done.returncode == 0


def shards_of(folder: Path) -> list[Path]:
    """The shards that stand there with a manifest, in order."""
    manifests = sorted(folder.glob("shard-*.json"))
    return [folder / json.loads(path.read_text(encoding="utf-8"))["file"] for path in manifests]


def differences(expected: Path, found: Path) -> list[str]:
    """What differs: bytes of shards, items of manifests, files of killed runs."""
    names = [path.name for path in shards_of(expected)]
    problems = []
    if [path.name for path in shards_of(found)] != names:
        problems.append("other shards")
    for name in names:
        if not (found / name).exists():
            problems.append(f"{name} is missing")
        elif not filecmp.cmp(expected / name, found / name, shallow=False):
            problems.append(f"{name} differs")
    items = [json.loads(path.read_text(encoding="utf-8"))["items"]
             for path in sorted(found.glob("shard-*.json"))]
    ends = [0, *(end for _, end in items)]
    if [begin for begin, _ in items] != ends[:-1]:
        problems.append(f"items are not each there once: {items}")
    left = [path.name for path in found.iterdir() if path.name.startswith(".")]
    if left:
        problems.append(f"files of killed runs are left: {left}")
    return problems
