# SPDX-License-Identifier: MIT
"""Layouts that give points and axis themselves: Zaragoza, NLOS-DIRAC, Bonn, y-tal, npz."""
from __future__ import annotations

import json
import struct
from dataclasses import replace
from functools import partial
from pathlib import Path

import h5py
import numpy as np

from capture import Capture, write_ytal
from case import Case, Source, Written, extents_m, require, require_confocal_grid
from matlab_files import write_v5

ZARAGOZA_BOUNCES = 6
ZARAGOZA_FIRST_ORDER = 2
# A wall in the plane of x and z, as that data set has them: (x, y, z) becomes (x, -z, y).
ZARAGOZA_FROM_OURS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def _in_parts(H: np.ndarray) -> np.ndarray:
    """(bounce, colour, as H): values whose sums are exact in any order, the first bounce empty."""
    whole = np.round(H * (2**20 / float(H.max())))
    parts = np.zeros((ZARAGOZA_BOUNCES, 3, *H.shape), np.float32)
    parts[1, 0] = np.floor(whole / 2)
    parts[1, 2] = np.floor(whole / 5)
    parts[2, 1] = whole - parts[1, 0] - parts[1, 2]
    return parts


def _in_zaragoza_order(parts: np.ndarray, pattern: str) -> np.ndarray:
    """(y, x, bounce, t, colour) or (ly, lx, sy, sx, bounce, t, colour)."""
    grids = parts[:, :, :, np.newaxis, np.newaxis] if pattern == "single" else parts
    data = np.moveaxis(grids, (0, 1, 2), (-3, -1, -2))
    x_before_y = range(data.ndim - 3)
    return np.moveaxis(data, x_before_y, [axis ^ 1 for axis in x_before_y])


def write_zaragoza(capture: Capture, folder: Path, reverse: bool, matlab: bool = False) -> Written:
    """data (y, x, bounce, t, colour), or with (y, x) of the laser and of the camera in front, or
    all of that in reverse; grids (y, x, 3) accordingly. The axis starts at t0 with bins of deltaT,
    both metres, segments included. Colours are to be summed; bounces are kept by order, from the two
    that light takes from the laser's spot straight to another point of the wall."""
    require(capture.opl_origin == "device" and capture.sensing.ndim == 3, "zaragoza",
            "grids, and lengths that include the segments")
    parts = _in_parts(capture.H)
    data = _in_zaragoza_order(parts, capture.pattern)

    def stored(array: np.ndarray) -> np.ndarray:
        return array.T if reverse else array

    by_order = parts.sum(axis=1, dtype=np.float64).astype(np.float32)
    lit = [i for i in range(ZARAGOZA_BOUNCES) if by_order[i].any()]
    turned = {"H": by_order.sum(axis=0, dtype=np.float64).astype(np.float32),
              "by_order": by_order[lit], "orders": [i + ZARAGOZA_FIRST_ORDER for i in lit]}
    fields = {"data": stored(data)}
    for device, points, normals, position in (
            ("camera", "sensing", "sensing_normals", "detector_m"),
            ("laser", "illumination", "illumination_normals", "laser_m")):
        for name in (points, normals, position):
            turned[name] = getattr(capture, name) @ ZARAGOZA_FROM_OURS.T
        fields[f"{device}GridPositions"] = stored(turned[points].swapaxes(0, 1))
        fields[f"{device}GridNormals"] = stored(turned[normals].swapaxes(0, 1))
        fields[f"{device}Position"] = turned[position]
        fields[f"{device}GridPoints"] = np.array(turned[points].shape[:2], np.float64)
        fields[f"{device}GridSize"] = np.array(extents_m(getattr(capture, points)))
    scalars = {"deltaT": capture.bin_width_m, "t0": capture.start_m, "t": capture.num_bins,
               "isConfocal": int(capture.pattern == "confocal"),
               "hiddenVolumePosition": np.array([0.0, -0.7, 0.0]),
               "hiddenVolumeRotation": np.zeros(3), "hiddenVolumeSize": np.full(3, 0.6)}
    path = folder / ("letter_conf.mat" if matlab else "letter_conf.hdf5")
    if matlab:
        write_v5(path, fields | scalars)
    else:
        with h5py.File(path, "w") as file:
            for name, value in (fields | scalars).items():
                file[name] = value
    return Written(path, replace(capture, **turned))


def write_nlos_dirac(capture: Capture, folder: Path) -> Written:
    """data_t (t, x, y) at points xg, yg (x, y) of the wall z = 0, lengths da of the bins' starts;
    with an offset of the laser the segments are no part of them."""
    require_confocal_grid(capture, "nlos-dirac")
    points = capture.sensing
    path = folder / "letter_dirac.hdf5"
    with h5py.File(path, "w") as file:
        file["data_t"] = capture.H
        file["xa"], file["ya"] = points[:, 0, 0], points[0, :, 1]
        file["xg"], file["yg"] = points[..., 0], points[..., 1]
        file["da"] = capture.start_m + capture.bin_width_m * np.arange(capture.num_bins)
        file["offset_camera"] = np.full(points.shape[0] * points.shape[1], 0.5)
        file["offset_laser"] = np.array([0.5])
        file["sample_x"], file["sample_y"] = 0.1, 0.1
    return Written(path, capture)


def write_bonn_ti(capture: Capture, folder: Path, version: int) -> Written:
    """Little endian; pixel u + uRes v, bins fastest. A bin is known by the time of its centre, so
    tMin is that of the first one. Older versions state tMax instead of the width, tMin + bins *
    width, and nothing of the wall: the user's wall size gives its pixels, and the laser lights its
    middle, as in the authors' scenes. The authors' conversion of TI00 takes its second number for
    the bins."""
    require(capture.pattern == "single" and capture.sensing.ndim == 3, "bonn-ti",
            "a single-laser scan of a grid")
    values = np.moveaxis(capture.H, 0, 2)[:, ::-1].swapaxes(0, 1)  # (v down, u right, t)
    v_res, u_res, bins = values.shape
    start_m, width_m = capture.start_m, capture.bin_width_m
    corners = [capture.sensing[i, j] for i, j in ((0, -1), (-1, -1), (0, 0), (-1, 0))]
    block = struct.pack("<II", u_res, v_res) + np.array(
        [*corners, capture.illumination.reshape(3)], "<f4").tobytes()
    first_m, last_m = np.float32(start_m + 0.5 * width_m), np.float32(start_m + bins * width_m)
    headers = {
        4: b"TI04" + struct.pack("<IIIffI", 10, u_res * v_res, bins, first_m, width_m, len(block)),
        1: b"TI01" + struct.pack("<IIIff", bins, u_res, v_res, first_m, last_m),
        0: b"TI00" + struct.pack("<IIIff", v_res, bins, u_res, first_m, last_m)}
    stored_m = (float(last_m) - float(first_m)) / bins
    if version == 4:
        stored_m = float(np.float32(width_m))
    expected = replace(capture, bin_width_m=stored_m, start_m=float(first_m) - 0.5 * stored_m)
    path = folder / f"letter_{version:02}.ti"
    path.write_bytes(headers[version] + values.astype("<f4").tobytes() +
                     (block if version == 4 else b"") +
                     json.dumps({"Image": {"Source": "Simulation"}}).encode())
    x_m, y_m = extents_m(capture.sensing)
    settings = () if version == 4 else (f"capture.wall_size_m=[{x_m!r},{y_m!r}]",)
    return Written(path, expected, settings)


def write_ytal_file(capture: Capture, folder: Path) -> Written:
    path = folder / "letter.hdf5"
    write_ytal(path, capture)
    return Written(path, capture)


def write_npz(capture: Capture, folder: Path) -> Written:
    """What numpy opens without pickles: names as in y-tal's layout, texts as 0-d strings."""
    path = folder / "letter.npz"
    np.savez_compressed(
        path, H=capture.H, sensor_grid_xyz=capture.sensing, laser_grid_xyz=capture.illumination,
        sensor_grid_normals=capture.sensing_normals,
        laser_grid_normals=capture.illumination_normals, sensor_xyz=capture.detector_m,
        laser_xyz=capture.laser_m, t_start=capture.start_m, delta_t=capture.bin_width_m,
        unit=capture.unit, pattern=capture.pattern, opl_origin=capture.opl_origin, scene_info="{}")
    return Written(path, capture)


_SINGLE = Source(pattern="single")
_AWAY = {"segments": True, "num_bins": 384, "start_m": 0.5}
_EXHAUSTIVE = Source(pattern="exhaustive", points=(5, 4), size_m=(0.6, 0.45))
_LIST = Source(points=(40,))
_WITH_SEGMENTS = Source(**_AWAY)

CASES = [
    *(Case(f"zaragoza, {source.pattern}, {'reversed' if reverse else 'as written'}", source,
           partial(write_zaragoza, reverse=reverse))
      for source in (_WITH_SEGMENTS, replace(_WITH_SEGMENTS, pattern="single"),
                     replace(_EXHAUSTIVE, **_AWAY))
      for reverse in (False, True)),
    Case("zaragoza in v5", _WITH_SEGMENTS, partial(write_zaragoza, reverse=False, matlab=True)),
    Case("nlos-dirac", Source(), write_nlos_dirac),
    *(Case(f"bonn-ti, TI{version:02}", replace(_SINGLE, points=(13, 9), laser_at=(6, 4)),
           partial(write_bonn_ti, version=version)) for version in (4, 1, 0)),
    *(Case(f"{name}, {kind}", source, write)
      for name, write in (("y-tal", write_ytal_file), ("npz", write_npz))
      for kind, source in (("confocal", Source()), ("single", replace(_SINGLE, **_AWAY)),
                           ("exhaustive", _EXHAUSTIVE), ("list", _LIST))),
]
