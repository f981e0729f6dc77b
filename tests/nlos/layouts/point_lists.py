# SPDX-License-Identifier: MIT
"""Layouts that list points and histograms, in MATLAB files."""
from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from capture import Capture, pairs_of
from case import Case, Source, Written, path_length_m, require, require_axis
from matlab_files import write_v5, write_v73

SURFACE_BIN_M = 1.2e-3
CONV_WALL_M = 1.1


def write_general_nlos(capture: Capture, folder: Path, pitch_m: float) -> Written:
    """`sub_Sig` (pairs, bins), `C_i` and `C_d` (depth, horizontal, vertical) on a grid of indices,
    one file per variable. Neither the pitch nor the bin width is there."""
    counted = capture.as_counts()
    corner = capture.sensing.reshape(-1, 3).min(axis=0)
    lit, seen, histograms = pairs_of(counted)
    indices = [np.round((points - corner) / pitch_m).astype(int) for points in (lit, seen)]
    for name, index in zip(("C_i", "C_d"), indices):
        require(index.min() >= 0 and index.max() < 256, "general-nlos", "points on a grid")
        write_v5(folder / f"{name}.mat", {name: index[:, [2, 0, 1]].astype(np.uint8)})
    write_v5(folder / "sub_Sig.mat", {"sub_Sig": histograms.astype(np.float64)})

    def on_grid(points: np.ndarray) -> np.ndarray:
        return np.round((points - corner) / pitch_m) * pitch_m
    expected = replace(counted, sensing=on_grid(capture.sensing),
                       illumination=on_grid(capture.illumination), start_m=0.0)
    return Written(folder, expected, (f"capture.pitch_m={pitch_m!r}",
                                      f"capture.bin_width_m={capture.bin_width_m!r}"))


def write_general_nlos_setup(capture: Capture, folder: Path) -> Written:
    """`sub_Sig` beside a setup.mat of `laserpoints` and `detectpoints` [m], row after row in squares
    that the first point fills up."""
    counted = capture.as_counts()
    lit, seen, histograms = pairs_of(counted)
    side = int(np.ceil(np.sqrt(len(lit))))

    def folded(points: np.ndarray) -> np.ndarray:
        rest = np.repeat(points[:1], side * side - len(points), axis=0)
        return np.concatenate([points, rest]).reshape(side, side, 3)
    write_v5(folder / "setup.mat", {"laserpoints": folded(lit), "detectpoints": folded(seen)})
    write_v5(folder / "sub_Sig.mat", {"sub_Sig": histograms.astype(np.float64)})
    return Written(folder, replace(counted, start_m=0.0),
                   (f"capture.bin_width_m={capture.bin_width_m!r}",))


def write_general_nlos_data(capture: Capture, folder: Path) -> Written:
    """`data` of a square of histograms beside its setup.mat."""
    require(capture.pattern == "confocal", "general-nlos-data", "a confocal scan")
    counted = capture.as_counts()
    write_v5(folder / "setup.mat", {"laserpoints": counted.sensing, "detectpoints": counted.sensing})
    write_v5(folder / "data.mat", {"data": np.moveaxis(counted.H, 0, -1).astype(np.float64)})
    return Written(folder, replace(counted, start_m=0.0),
                   (f"capture.bin_width_m={capture.bin_width_m!r}",))


def write_surface_optimisation(capture: Capture, folder: Path) -> Written:
    """`transient` (points, bins) and `lighting` (points, 3) [m]; confocal, 1.2 mm per bin. The
    authors' lists come from MATLAB's grids, whose first index, here x, is the fastest, and whose y
    runs downwards."""
    require(capture.pattern == "confocal", "surface-optimisation", "a confocal scan")
    require_axis(capture, "surface-optimisation", SURFACE_BIN_M)
    expected = replace(capture.as_counts(), start_m=0.0, bin_width_m=SURFACE_BIN_M)
    x_fastest = expected
    if expected.sensing.ndim == 3:
        x_fastest = replace(expected, H=expected.H.swapaxes(1, 2),
                            sensing=expected.sensing.swapaxes(0, 1))
    _, points, histograms = pairs_of(x_fastest)
    path = folder / "transient.mat"
    write_v5(path, {"transient": histograms.astype(np.float64), "lighting": points * [1, -1, 1]})
    return Written(path, expected)


def write_phasor_field_2019(capture: Capture, folder: Path) -> Written:
    """Struct `dataset`: data (laser, camera, t), positions (N, 3) and devices [m], t0 and deltat
    [m]; lengths include the segments. One camera spot and many laser spots: the published captures
    move the laser, so a single-laser scan is written with lasers and cameras exchanged, which by
    reciprocity is the same measurement."""
    require(capture.opl_origin == "device", "phasor-field-2019", "lengths that include the segments")
    counted = capture.as_counts()
    listed = counted.as_list()
    single = capture.pattern == "single"
    data = np.moveaxis(listed.H, 0, -1)
    data = data[:, np.newaxis] if single else data
    laser = (listed.sensing, listed.sensing_normals, listed.detector_m)
    camera = (listed.illumination, listed.illumination_normals, listed.laser_m)
    if not single:
        laser, camera = camera, laser
    path = folder / "dataset.mat"
    write_v73(path, {
        "dataset": {
            "data": data.astype(np.float32), "t": float(listed.num_bins),
            "t0": listed.start_m, "deltat": listed.bin_width_m,
            "laserPos": laser[0], "laserNorm": laser[1], "laserOrigin": laser[2],
            "cameraPos": camera[0], "cameraNorm": camera[1], "cameraOrigin": camera[2]},
        "minimalpos": np.array([-0.5, -0.5, 0.4]), "maximalpos": np.array([0.5, 0.5, 1.0]),
        "sampling_grid_spacing": 0.02})
    return Written(path, counted)


def write_phasor_field_2020(capture: Capture, folder: Path, v73: bool) -> Written:
    """`rect_data` (y, x, t) with y falling, `ts` [s], `sampling_spacing` [m]; the detector looks at
    pixel `SPAD_index`, counted from 1, first index first, while the laser moves. By reciprocity a
    single-laser scan, written here with the laser's spot as that pixel."""
    require(capture.pattern == "single" and capture.sensing.ndim == 3, "phasor-field-2020",
            "a single-laser scan of a grid")
    expected = replace(capture.as_counts(), start_m=0.0)
    spacing_m = float(capture.sensing[1, 0, 0] - capture.sensing[0, 0, 0])
    rect_data = np.moveaxis(expected.H, 0, 2)[:, ::-1].swapaxes(0, 1)
    distances = np.linalg.norm(capture.sensing[:, ::-1] - capture.illumination.reshape(3), axis=-1)
    x, y = np.unravel_index(np.argmin(distances), distances.shape)
    require(distances[x, y] < 1e-6, "phasor-field-2020", "its laser on a sensing point")
    path = folder / "performat_letter.mat"
    (write_v73 if v73 else write_v5)(path, {
        "rect_data": rect_data.astype(np.float64), "ts": capture.bin_width_m / path_length_m(1.0),
        "sampling_spacing": spacing_m, "SPAD_index": np.array([[y + 1.0, x + 1.0]]),
        "aperturefullsize": np.array([[1.0, 1.0]])})
    return Written(path, expected)


def write_conv_nlos(capture: Capture, folder: Path) -> Written:
    """Struct NLOSDATA: transient (x, y, t) or (n_l, n_s, n_t), points l and s (N, 3) with the wall
    at z = target_dist and the object around the origin, which is half a turn about y. The authors
    interpolate between bins at lengths times(i), which are the bins' centres, and count the points
    of a confocal grid x slowest."""
    counted = capture.as_counts()
    listed = counted.as_list()
    confocal = capture.pattern == "confocal"
    transient = np.moveaxis(counted.H if confocal else listed.H, 0, -1)
    centres = capture.start_m + capture.bin_width_m * (np.arange(capture.num_bins) + 0.5)
    turned = np.array([-1.0, 1.0, -1.0])
    wall = np.array([0.0, 0.0, CONV_WALL_M])
    path = folder / "letter_transient.mat"
    write_v5(path, {"NLOSDATA": {
        "obj_name": "letter", "transient": transient.astype(np.float64),
        "l": listed.illumination * turned + wall, "s": listed.sensing * turned + wall,
        "times": centres, "delta": capture.bin_width_m, "is_confocal": confocal,
        "target_dist": CONV_WALL_M, "target_size": 0.6}})
    return Written(path, counted)


_PITCH_M = 0.05
_ON_PITCH = Source(points=(12, 9), size_m=(11 * _PITCH_M, 8 * _PITCH_M))
_EXHAUSTIVE = Source(pattern="exhaustive", points=(5, 4), size_m=(0.6, 0.45))
_AWAY = {"segments": True, "num_bins": 384, "start_m": 0.5}

CASES = [
    *(Case(f"general-nlos, {pattern}", replace(_ON_PITCH, pattern=pattern, points=points),
           partial(write_general_nlos, pitch_m=_PITCH_M))
      for pattern, points in (("confocal", (12, 9)), ("single", (12, 9)))),
    Case("general-nlos, exhaustive", replace(_ON_PITCH, pattern="exhaustive", points=(4, 3),
                                             size_m=(12 * _PITCH_M, 10 * _PITCH_M),
                                             lit_points=(2, 3)),
         partial(write_general_nlos, pitch_m=_PITCH_M)),
    *(Case(f"general-nlos-setup, {source.pattern}", source, write_general_nlos_setup)
      for source in (Source(), _EXHAUSTIVE)),
    Case("general-nlos-data", Source(points=(10, 10)), write_general_nlos_data),
    *(Case(f"surface-optimisation, {kind}",
           Source(points=points, bin_width_m=SURFACE_BIN_M, num_bins=2048),
           write_surface_optimisation) for kind, points in (("grid", (12, 10)), ("list", (40,)))),
    Case("phasor-field-2019, single", Source(pattern="single", **_AWAY), write_phasor_field_2019),
    Case("phasor-field-2019, exhaustive", replace(_EXHAUSTIVE, **_AWAY),
         write_phasor_field_2019),
    Case("phasor-field-2020 in v5", Source(pattern="single", size_m=(0.77, 0.63)),
         partial(write_phasor_field_2020, v73=False)),
    Case("phasor-field-2020 in v7.3", Source(pattern="single", size_m=(0.77, 0.63)),
         partial(write_phasor_field_2020, v73=True)),
    Case("conv-nlos, confocal", Source(), write_conv_nlos),
    Case("conv-nlos, exhaustive", _EXHAUSTIVE, write_conv_nlos),
]
