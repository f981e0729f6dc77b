#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes where the vest of data/walk was, and its counted frames as a sensor's driver sends them.

    walk_frames.py SCENE.json COUNTS.h5 TRUTH.json FRAMES.jsonl
"""
import json
import sys
from pathlib import Path

import h5py


def centre_of(obj: Path) -> list[float]:
    lines = [line.split()[1:] for line in obj.read_text().splitlines() if line.startswith("v ")]
    return [sum(float(v[axis]) for v in lines) / len(lines) for axis in range(3)]


def main(scene_path: str, counts: str, truth_path: str, frames_path: str) -> None:
    scene = json.loads(Path(scene_path).read_text())
    start = centre_of(Path(scene_path).parent / scene["geometry"])
    velocity = scene["objects"]["vest"]["velocity_m_per_s"]
    step_s = scene["frames"]["frame_s"]
    times = [frame * step_s for frame in range(scene["frames"]["count"])]
    truth = [{"time_s": t,
              "targets": [{"position_m": [p + t * v for p, v in zip(start, velocity)]}]}
             for t in times]
    Path(truth_path).write_text(json.dumps({"frames": truth}))
    with h5py.File(counts) as file:
        frames = file["nlos/frames"][()]  # (frame, bin, zone)
    frames = frames.reshape(len(times), frames.shape[1], -1).transpose(0, 2, 1)
    with open(frames_path, "w") as file:
        for t, histograms in zip(times, frames):
            file.write(json.dumps({"t": t, "histograms": histograms.tolist()}) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
