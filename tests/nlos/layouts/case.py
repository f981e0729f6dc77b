# SPDX-License-Identifier: MIT
"""What a layout's writer takes and gives, and how it is listed."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from capture import SPEED_OF_LIGHT_M_PER_S, Capture


def path_length_m(time_s: float) -> float:
    return time_s * SPEED_OF_LIGHT_M_PER_S


def picoseconds_m(time_ps: float) -> float:
    return path_length_m(time_ps * 1e-12)


@dataclass(frozen=True)
class Source:
    """The capture that a layout can hold, for the program to render.

    points        sensing points along x and y, or how many of an irregular list
    size_m        from the first to the last point along x and y
    lit_points    illumination points along x and y of an exhaustive scan
    laser_at      index of the sensing point that a single laser lights
    segments      whether lengths include the segments to the devices
    device_m      how far in front of the wall's middle both devices stand; 0: elsewhere, apart
    by_order      whether bounce orders are kept apart
    """

    pattern: str = "confocal"
    points: tuple[int, ...] = (12, 10)
    size_m: tuple[float, float] = (0.8, 0.7)
    bin_width_m: float = 0.01
    num_bins: int = 256
    start_m: float = 0.0
    lit_points: tuple[int, int] = (3, 2)
    laser_at: tuple[int, int] = (2, 3)
    segments: bool = False
    device_m: float = 0.0
    by_order: bool = False


@dataclass
class Written:
    """A file or folder in some layout, and the capture that a reader must make of it.

    settings    what a user must give because the layout does not hold it, for --set
    """

    path: Path
    expected: Capture
    settings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Case:
    name: str
    source: Source
    write: Callable[[Capture, Path], Written]


def require(condition: bool, layout: str, what: str) -> None:
    if not condition:
        raise SystemExit(f"{layout}: the capture does not fit; it must have {what}")


def require_confocal_grid(capture: Capture, layout: str) -> None:
    require(capture.pattern == "confocal" and capture.sensing.ndim == 3, layout,
            "a confocal scan of a grid")


def extents_m(points: np.ndarray) -> tuple[float, float]:
    """From the first to the last point of a grid along x and y."""
    span = points[-1, -1] - points[0, 0]
    return float(span[0]), float(span[1])


def require_axis(capture: Capture, layout: str, bin_width_m: float) -> None:
    require(abs(capture.bin_width_m / bin_width_m - 1.0) < 1e-9, layout,
            f"bins of {bin_width_m} m of path length")
