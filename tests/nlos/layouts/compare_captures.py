# SPDX-License-Identifier: MIT
"""Whether two captures are the same."""
from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from capture import Capture, pairs_of

POINT_TOLERANCE_M = 1e-6
AXIS_TOLERANCE = 1e-9
NORMAL_TOLERANCE = 1e-6


def _scan_differences(expected: Capture, found: Capture) -> list[str]:
    """Unit, segments, devices and axis."""
    differences = [f"{name} is {getattr(found, name)}, not {getattr(expected, name)}"
                   for name in ("unit", "opl_origin", "num_bins")
                   if getattr(found, name) != getattr(expected, name)]
    width_m = expected.bin_width_m
    if abs(found.bin_width_m - width_m) > AXIS_TOLERANCE * width_m:
        differences.append(f"bins are {found.bin_width_m!r} m wide, not {width_m!r}")
    scale_m = max(abs(expected.start_m), width_m)
    if abs(found.start_m - expected.start_m) > AXIS_TOLERANCE * scale_m:
        differences.append(f"the axis starts at {found.start_m!r} m, not {expected.start_m!r}")
    return differences


def _pairing(expected: Capture, found: Capture) -> tuple[np.ndarray, float]:
    """For every pair of `expected` the nearest of `found`, and how far off the worst one is."""
    lit, seen, _ = pairs_of(expected)
    found_lit, found_seen, _ = pairs_of(found)
    distances, order = cKDTree(np.hstack([found_lit, found_seen])).query(np.hstack([lit, seen]))
    return order, float(distances.max())


def _exchanged(capture: Capture) -> Capture:
    """A capture with one illumination point as its reciprocal, many points lit and one seen."""
    listed = capture.as_list()
    return Capture(H=listed.H[:, :, np.newaxis], sensing=listed.illumination,
                   illumination=listed.sensing, sensing_normals=listed.illumination_normals,
                   illumination_normals=listed.sensing_normals, start_m=listed.start_m,
                   bin_width_m=listed.bin_width_m, pattern="exhaustive", unit=listed.unit,
                   opl_origin=listed.opl_origin, laser_m=listed.detector_m,
                   detector_m=listed.laser_m)


def _angle_differences(expected: Capture, found: Capture, order: np.ndarray) -> list[str]:
    """Normals of the sensing points of every pair."""
    def of_pairs(capture: Capture) -> np.ndarray:
        normals = np.reshape(capture.sensing_normals, (-1, 3))
        return np.resize(normals, (len(order), 3))  # pairs repeat the sensing points
    worst = np.abs(of_pairs(expected) - of_pairs(found)[order]).max()
    return [f"normals are off by {worst:.3g}"] if worst > NORMAL_TOLERANCE else []


def _observed_differences(expected: Capture, found: Capture, order: np.ndarray) -> list[str]:
    """Bins that were observed, where the expectation says so."""
    if expected.observed is None:
        return []
    if found.observed is None:
        return ["nothing says which bins were observed"]
    wanted, got = (c.observed.reshape(2, -1) for c in (expected, found))
    same = np.array_equal(wanted, got[:, order])
    return [] if same else ["other bins count as observed"]


def _histogram_differences(expected: Capture, found: Capture, order: np.ndarray) -> list[str]:
    """H, frames and bounce orders, bit for bit."""
    differences = []
    for name in ("H", "frames", "by_order"):
        wanted, got = getattr(expected, name), getattr(found, name)
        if wanted is None and got is None:
            continue
        if wanted is None or got is None:
            differences.append(f"{name} is {'missing' if got is None else 'there'}")
            continue
        stacks = [stack if name != "H" else stack[np.newaxis] for stack in (wanted, got)]
        wanted, got = (stack.reshape(*stack.shape[:2], -1) for stack in stacks)
        if wanted.shape != got.shape:
            differences.append(f"{name} has shape {got.shape}, not {wanted.shape}")
        elif not np.array_equal(wanted, got[..., order]):
            wrong = np.count_nonzero(wanted != got[..., order])
            differences.append(f"{name} differs in {wrong} of {wanted.size} values")
    if expected.orders != found.orders:
        differences.append(f"orders are {found.orders}, not {expected.orders}")
    return differences


def capture_differences(expected: Capture, found: Capture) -> list[str]:
    """How a capture differs from what was expected; points may stand in any order."""
    differences = _scan_differences(expected, found)
    if expected.pattern == "single" and found.pattern == "exhaustive":
        expected = _exchanged(expected)
    if found.pattern != expected.pattern:
        return [*differences, f"the scan is {found.pattern}, not {expected.pattern}"]
    if expected.opl_origin == "device":
        for name in ("laser_m", "detector_m"):
            if np.abs(getattr(found, name) - getattr(expected, name)).max() > POINT_TOLERANCE_M:
                differences.append(f"{name} is {getattr(found, name)}")
    order, distance_m = _pairing(expected, found)
    if distance_m > POINT_TOLERANCE_M:
        return [*differences, f"points lie up to {distance_m:.3g} m away"]
    if len(np.unique(order)) != len(order):
        return [*differences, "two points of the file became one"]
    if found.sensing.ndim == 3 and np.ptp(found.sensing[..., 0], axis=1).max() > POINT_TOLERANCE_M:
        differences.append("the first index of the grid is not x")
    for compare in (_angle_differences, _observed_differences, _histogram_differences):
        differences += compare(expected, found, order)
    return differences
