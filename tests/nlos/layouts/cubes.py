# SPDX-License-Identifier: MIT
"""Layouts that are one cube of histograms of a confocal square, under a name of its own.

None of these files says where its points are. Common to all, as the publications draw them: x grows
along its axis, y falls along its axis, the first and last samples lie on the rim of the scanned
square, and the square is centred on the origin.
"""
from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from capture import Capture
from case import (Case, Source, Written, extents_m, path_length_m, picoseconds_m, require,
                  require_axis, require_confocal_grid)
from matlab_files import write_v5, write_v73

STANFORD_2018_BIN_PS = 4
DIRECT_RETURN_BINS = 600
FK_BIN_PS = 32
FK_WALL_M = 2.0
CDT_BIN_PS = 16
CDT_WALL_M = 0.70


def _x_y_t(H: np.ndarray) -> np.ndarray:
    """(x, y, t) with y falling, of (t, x, y) with both growing."""
    return np.moveaxis(H, 0, 2)[:, ::-1]


def _y_x_t(H: np.ndarray) -> np.ndarray:
    return _x_y_t(H).swapaxes(0, 1)


def _observed(H: np.ndarray, begin: int, end: int) -> np.ndarray:
    """The same bins of every histogram, from the first that was observed to one past the last."""
    return np.stack([np.full(H.shape[1:], begin), np.full(H.shape[1:], end)])


def _counted(capture: Capture, layout: str, bin_width_m: float) -> Capture:
    require_confocal_grid(capture, layout)
    require_axis(capture, layout, bin_width_m)
    return replace(capture.as_counts(), start_m=0.0, bin_width_m=bin_width_m)


def _wall_setting(capture: Capture) -> str:
    x_m, y_m = extents_m(capture.sensing)
    return f"capture.wall_size_m=[{x_m!r},{y_m!r}]"


def write_stanford_2018(capture: Capture, folder: Path) -> Written:
    """`rect_data` uint16 (x, y, t); `width` is half the scanned width. Light that returns directly
    from the wall, of length 0, is centred in bin 0; the authors drop the first 600 bins."""
    expected = _counted(capture, "stanford-2018", picoseconds_m(STANFORD_2018_BIN_PS))
    expected.start_m = -0.5 * expected.bin_width_m
    rect_data = _x_y_t(expected.H).astype(np.uint16)
    rect_data[:, :, 3] = 7  # the direct return, which the reader must not take for the object
    H = expected.H.copy()
    H[:DIRECT_RETURN_BINS] = 0.0
    path = folder / "data_letter.mat"
    write_v5(path, {"rect_data": rect_data, "width": extents_m(capture.sensing)[0] / 2})
    observed = _observed(H, DIRECT_RETURN_BINS, expected.num_bins)
    return Written(path, replace(expected, H=H, observed=observed))


def write_stanford_fk_2019(capture: Capture, folder: Path, variable: str = "meas",
                           tof: bool = False) -> Written:
    """`meas` (y, x, t) of 2 m; `tofgrid` (y, x) [ps] beside it is when each point's light reaches
    the wall, to be cut off in whole bins, rounded down."""
    expected = _counted(capture, "stanford-fk-2019", picoseconds_m(FK_BIN_PS))
    cube = _y_x_t(expected.H)
    if tof:
        delays = np.arange(cube.shape[0] * cube.shape[1]).reshape(cube.shape[:2]) * 7 % 60
        write_v73(folder / "tof.mat", {"tofgrid": delays * FK_BIN_PS + delays % FK_BIN_PS + 0.5})
        cube, expected.H = _delayed(cube, expected.H, delays)
        ends = expected.num_bins - delays[::-1].T
        expected.observed = np.stack([np.zeros_like(ends), ends])
    path = folder / ("meas_10min.mat" if variable == "meas" else f"{variable}.mat")
    write_v73(path, {variable: cube})
    size = extents_m(capture.sensing)
    published = max(abs(size[0] - FK_WALL_M), abs(size[1] - FK_WALL_M)) < 1e-6
    return Written(path, expected, () if published else (_wall_setting(capture),))


def _delayed(cube: np.ndarray, H: np.ndarray, delays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(y, x, t) with every histogram later by its delay in bins, on a longer axis.

    What was counted before light reached the wall is no light of the scene. The authors rotate it
    to the end, and cut that off; a reader drops it, and knows that nothing was observed there.
    """
    longest = int(delays.max())
    raw = np.zeros((*cube.shape[:2], cube.shape[2] + longest), np.float32)
    for y, x in np.ndindex(delays.shape):
        raw[y, x, delays[y, x]:delays[y, x] + cube.shape[2]] = cube[y, x]
        raw[y, x, :delays[y, x]] = 2.0
    return raw, np.concatenate([H, np.zeros((longest, *H.shape[1:]), np.float32)])


def write_stanford_fk_interactive(capture: Capture, folder: Path,
                                  only: int | None = None) -> Written:
    """`meas` (frame, y, x, t) with one `tof_32.mat` for all frames; a user may want one of them."""
    expected = _counted(capture, "stanford-fk-2019", picoseconds_m(FK_BIN_PS))
    frames = np.stack([np.roll(expected.H, shift, axis=1) for shift in (2, 1, 0)])
    write_v73(folder / "tof_32.mat", {"tofgrid": np.zeros(expected.H.shape[1:]).T})
    path = folder / "meas_32.mat"
    write_v73(path, {"meas": np.stack([_y_x_t(frame) for frame in frames])})
    if only is not None:
        return Written(path, replace(expected, H=frames[only]), (f"capture.frame={only}",))
    return Written(path, replace(expected, frames=frames))


def write_stanford_fk_nonplanar(capture: Capture, folder: Path) -> Written:
    """`meas` (y, x, t), and beside the delays of tof.mat the points `pos` (y, x, 3) of a wall that
    is no square around the origin. Normals follow from the points; a tilted plane's are known."""
    angle = np.radians(20.0)
    tilt = np.array([[np.cos(angle), 0.0, np.sin(angle)], [0.0, 1.0, 0.0],
                     [-np.sin(angle), 0.0, np.cos(angle)]])
    points = capture.sensing @ tilt.T + [0.3, -0.1, 0.2]
    normals = np.broadcast_to(tilt @ [0.0, 0.0, 1.0], points.shape)
    expected = replace(_counted(capture, "stanford-fk-2019", picoseconds_m(FK_BIN_PS)),
                       sensing=points, illumination=points, sensing_normals=normals,
                       illumination_normals=normals)
    path = folder / "meas_150sec.mat"
    write_v73(path, {"meas": _y_x_t(expected.H)})
    write_v73(folder / "tof.mat", {"tofgrid": np.zeros(points.shape[:2]).T,
                                   "pos": points[:, ::-1].swapaxes(0, 1)})
    return Written(path, expected)


def write_stanford_cdt_2020(capture: Capture, folder: Path) -> Written:
    """`meas` (t, y, x), so that HDF5 has x slowest; 0.70 m scanned, 16 ps. The authors' figures
    draw HDF5's first axis to the right and its second one downwards."""
    expected = _counted(capture, "stanford-cdt-2020", picoseconds_m(CDT_BIN_PS))
    x_m, y_m = extents_m(capture.sensing)
    require(max(abs(x_m - CDT_WALL_M), abs(y_m - CDT_WALL_M)) < 1e-6, "stanford-cdt-2020",
            f"{CDT_WALL_M} m from the first to the last point")
    path = folder / "letter.mat"
    write_v73(path, {"meas": _x_y_t(expected.H).T})
    return Written(path, expected)


def write_ustc_long_range(capture: Capture, folder: Path) -> Written:
    """`sig_in` (x, y, t) with bin width [s], pulse [ps], half width [m] and spot radius [m]. The
    detector was gated: bins that are empty everywhere were not observed."""
    expected = _counted(capture, "ustc-long-range", capture.bin_width_m)
    path = folder / "long_range.mat"
    write_v5(path, {"sig_in": _x_y_t(expected.H).astype(np.float64),
                    "timeRes": expected.bin_width_m / path_length_m(1.0), "pulsewidth": 500.0,
                    "width": extents_m(capture.sensing)[0] / 2, "radius": 0.03})
    lit = np.flatnonzero(expected.H.sum(axis=(1, 2)))
    return Written(path, replace(expected, observed=_observed(expected.H, lit[0], lit[-1] + 1)))


def write_hybrid_18m(capture: Capture, folder: Path) -> Written:
    """`sig` (x, y, t), which says nothing else."""
    expected = _counted(capture, "hybrid-18m", capture.bin_width_m)
    path = folder / "sig.mat"
    write_v5(path, {"sig": _x_y_t(expected.H).astype(np.float64)})
    return Written(path, expected, (_wall_setting(capture),
                                    f"capture.bin_width_m={expected.bin_width_m!r}"))


_SQUARE = Source(points=(12, 12), size_m=(0.7, 0.7))
_FK = Source(points=(12, 12), size_m=(FK_WALL_M, FK_WALL_M), bin_width_m=picoseconds_m(FK_BIN_PS))
_FK_REDUCED = replace(_FK, size_m=(0.9, 0.9))

CASES = [
    Case("stanford-2018", replace(_SQUARE, bin_width_m=picoseconds_m(STANFORD_2018_BIN_PS),
                                  num_bins=2048), write_stanford_2018),
    Case("stanford-fk-2019", _FK, write_stanford_fk_2019),
    Case("stanford-fk-2019 with tof.mat", _FK, partial(write_stanford_fk_2019, tof=True)),
    *(Case(f"stanford-fk-2019 as {name}", _FK_REDUCED, partial(write_stanford_fk_2019,
                                                               variable=name))
      for name in ("measlr", "final_meas", "data", "sig")),
    Case("stanford-fk-2019 interactive", _FK, write_stanford_fk_interactive),
    Case("stanford-fk-2019 interactive, one frame", _FK,
         partial(write_stanford_fk_interactive, only=1)),
    Case("stanford-fk-2019 nonplanar", _FK, write_stanford_fk_nonplanar),
    Case("stanford-cdt-2020", replace(_SQUARE, bin_width_m=picoseconds_m(CDT_BIN_PS),
                                      num_bins=512), write_stanford_cdt_2020),
    Case("ustc-long-range", replace(_SQUARE, bin_width_m=path_length_m(32e-12)),
         write_ustc_long_range),
    Case("hybrid-18m", _SQUARE, write_hybrid_18m),
]
