# SPDX-License-Identifier: MIT
"""Captures of the letter scene, rendered by the program with the scan that a layout can hold."""
from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from case import Source

LETTER = Path(__file__).resolve().parents[3] / "scenes" / "letter"
LASER_M = [-0.5, 0.1, 0.25]
DETECTOR_M = [-0.4, -0.2, 0.3]


def _rim_to_rim(count: int, span_m: float) -> float:
    """Size of a wall whose `count` cell centres lie `span_m` apart from first to last."""
    return span_m * count / (count - 1) if count > 1 else 0.1


def _irregular_points(count: int) -> np.ndarray:
    points = np.zeros((count, 3))
    points[:, :2] = np.random.default_rng(count).uniform(-0.4, 0.4, (count, 2))
    return points


def _scan(source: Source) -> dict:
    scan: dict = {"pattern": source.pattern}
    if len(source.points) == 1:
        points = _irregular_points(source.points[0])
        scan["sensing_points_m"] = points.tolist()
        scan["sensing_normals"] = [[0, 0, 1]] * len(points)
    else:
        scan["sensing_points"] = source.points
    if source.pattern == "exhaustive":
        scan["illumination_points"] = source.lit_points
    if source.pattern == "single":
        scan["illumination_m"] = [
            -span / 2 + span * at / (count - 1)
            for span, at, count in zip(source.size_m, source.laser_at, source.points)] + [0]
    if source.segments:
        both = [0.0, 0.0, source.device_m]
        laser_m, detector_m = (both, both) if source.device_m else (LASER_M, DETECTOR_M)
        scan |= {"opl_origin": "device", "laser_m": laser_m, "detector_m": detector_m}
    return scan


def _scene(source: Source) -> dict:
    scene = json.loads((LETTER / "scene.json").read_text())
    scene["geometry"] = str(LETTER / "scene.glb")
    if len(source.points) == 2:
        scene["relay_wall"]["size_m"] = [
            _rim_to_rim(count, span) for count, span in zip(source.points, source.size_m)]
    scene["scan"] = _scan(source)
    scene["time_axis"] = {"opl_start_m": source.start_m, "bin_width_m": source.bin_width_m,
                          "num_bins": source.num_bins}
    scene["render"]["max_bounces"] = 3
    return scene


def render_source(source: Source, folder: Path, run: Callable[..., None]) -> Path:
    """The capture of a source, rendered once; `run` calls the program with arguments."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = json.dumps(_scene(source))
    name = hashlib.sha256(scene.encode()).hexdigest()[:16]
    capture = folder / f"{name}.h5"
    if not capture.exists():
        description = folder / f"{name}.json"
        description.write_text(scene)
        run("render", description, "-o", capture)
    return capture
