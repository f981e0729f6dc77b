# SPDX-License-Identifier: MIT
"""A capture in numpy arrays, and y-tal's HDF5 layout, in which the program writes captures.

Written from the description of the formats alone, so that the tests share no code with the program.
"""
from __future__ import annotations

import json
from dataclasses import dataclass, field, replace

import h5py
import numpy as np

SPEED_OF_LIGHT_M_PER_S = 299792458.0

H_FORMATS = {"T_Sx_Sy": 1, "T_Lx_Ly_Sx_Sy": 2, "T_Si": 3, "T_Li_Si": 4}


@dataclass
class Capture:
    """Histograms and where they belong; lengths in metres.

    H             float32, (T, Sx, Sy), (T, Si), (T, Lx, Ly, Sx, Sy) or (T, Li, Si)
    sensing       points on the wall, (X, Y, 3) or (N, 3); so is `illumination`
    pattern       "confocal", "single" or "exhaustive"
    opl_origin    "relay_wall", or "device" where lengths include the segments to laser and detector
    frames        (F, as H) of a sequence, whose last frame is H
    by_order      (K, as H), which sum to H, with their bounce orders in `orders`
    observed      (2, as H without T): first bin that could be recorded, and the one past the last
    """

    H: np.ndarray
    sensing: np.ndarray
    illumination: np.ndarray
    sensing_normals: np.ndarray
    illumination_normals: np.ndarray
    start_m: float
    bin_width_m: float
    pattern: str
    unit: str = "radiance"
    opl_origin: str = "relay_wall"
    laser_m: np.ndarray = field(default_factory=lambda: np.zeros(3))
    detector_m: np.ndarray = field(default_factory=lambda: np.zeros(3))
    frames: np.ndarray | None = None
    by_order: np.ndarray | None = None
    orders: list[int] | None = None
    observed: np.ndarray | None = None

    @property
    def num_bins(self) -> int:
        return self.H.shape[0]

    def with_points(self, points: np.ndarray) -> Capture:
        """The same confocal capture with its points elsewhere."""
        normals = np.broadcast_to([0.0, 0.0, 1.0], points.shape)
        return replace(self, sensing=points, illumination=points,
                       sensing_normals=normals, illumination_normals=normals)

    def as_list(self) -> Capture:
        """The same capture with lists of points instead of grids, x slowest."""
        def flat(points: np.ndarray) -> np.ndarray:
            return points.reshape(-1, 3)
        num_lit = flat(self.illumination).shape[0]
        lit = (num_lit,) if self.pattern == "exhaustive" else ()
        return replace(self, H=self.H.reshape(self.num_bins, *lit, -1),
                       sensing=flat(self.sensing), sensing_normals=flat(self.sensing_normals),
                       illumination=flat(self.illumination),
                       illumination_normals=flat(self.illumination_normals))

    def as_counts(self, peak: int = 900) -> Capture:
        """Whole numbers with the given maximum, as a detector counts them."""
        scale = peak / float(self.H.max())
        return replace(self, H=np.round(self.H * scale).astype(np.float32), unit="counts")


def pairs_of(capture: Capture) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Illumination and sensing point (P, 3) and histogram (P, T) of every measured pair."""
    listed = capture.as_list()
    histograms = listed.H.reshape(listed.num_bins, -1).T
    seen, lit = listed.sensing, listed.illumination
    if capture.pattern == "exhaustive":
        return np.repeat(lit, len(seen), axis=0), np.tile(seen, (len(lit), 1)), histograms
    if capture.pattern == "single":
        return np.tile(lit, (len(seen), 1)), seen, histograms
    return seen, seen, histograms


def _pattern(H: np.ndarray, sensing: np.ndarray, illumination: np.ndarray) -> str:
    if H.ndim == sensing.ndim + illumination.ndim - 1:
        return "exhaustive"
    confocal = illumination.shape == sensing.shape and np.array_equal(illumination, sensing)
    return "confocal" if confocal else "single"


def read_ytal(path: str) -> Capture:
    """Reads a capture that the program wrote; the pattern follows from the points."""
    with h5py.File(path, "r") as file:
        own = file.get("nlos", {})
        sensing = file["sensor_grid_xyz"][()].astype(np.float64)
        illumination = file["laser_grid_xyz"][()].astype(np.float64)
        H = file["H"][()]
        segments = bool(file["t_accounts_first_and_last_bounces"][()])
        return Capture(
            H=H, sensing=sensing, illumination=illumination,
            sensing_normals=file["sensor_grid_normals"][()].astype(np.float64),
            illumination_normals=file["laser_grid_normals"][()].astype(np.float64),
            start_m=float(file["t_start"][()]), bin_width_m=float(file["delta_t"][()]),
            pattern=_pattern(H, sensing, illumination),
            unit=str(own.attrs["unit"]) if own else "radiance",
            opl_origin="device" if segments else "relay_wall",
            laser_m=file["laser_xyz"][()].astype(np.float64),
            detector_m=file["sensor_xyz"][()].astype(np.float64),
            frames=own["frames"][()] if "frames" in own else None,
            by_order=own["H_by_order"][()] if "H_by_order" in own else None,
            orders=own["orders"][()].tolist() if "orders" in own else None,
            observed=own["observed_bins"][()] if "observed_bins" in own else None)


def write_ytal(path: str, capture: Capture) -> None:
    """Writes y-tal's layout with plain numbers where y-tal has enumerations, which is allowed."""
    grids = capture.sensing.ndim == 3
    names = ("T_Lx_Ly_Sx_Sy" if grids else "T_Li_Si") if capture.pattern == "exhaustive" else (
        "T_Sx_Sy" if grids else "T_Si")
    with h5py.File(path, "w") as file:
        file["H"] = capture.H.astype(np.float32)
        file["H_format"] = np.array([H_FORMATS[names]], np.int32)
        for device, points, normals, position in (
                ("sensor", capture.sensing, capture.sensing_normals, capture.detector_m),
                ("laser", capture.illumination, capture.illumination_normals, capture.laser_m)):
            file[f"{device}_xyz"] = np.asarray(position, np.float32)
            file[f"{device}_grid_xyz"] = points.astype(np.float32)
            file[f"{device}_grid_normals"] = np.asarray(normals, np.float32)
            file[f"{device}_grid_format"] = np.array([2 if grids else 1], np.int32)
        file["volume_format"] = np.array([2], np.int32)
        file["delta_t"] = float(capture.bin_width_m)
        file["t_start"] = float(capture.start_m)
        file["t_accounts_first_and_last_bounces"] = capture.opl_origin == "device"
        file.create_dataset("scene_info", data=json.dumps({}), dtype=h5py.string_dtype("utf-8"))
        _write_own_group(file, capture)


def _write_own_group(file: h5py.File, capture: Capture) -> None:
    """What y-tal has no name for, and refuses: only where there is some."""
    own_arrays = (capture.frames, capture.by_order, capture.observed)
    if capture.unit == "radiance" and all(array is None for array in own_arrays):
        return
    own = file.create_group("nlos")
    own.attrs["unit"] = capture.unit
    if capture.frames is not None:
        own["frames"] = capture.frames.astype(np.float32)
    if capture.by_order is not None:
        own["H_by_order"] = capture.by_order.astype(np.float32)
        own["orders"] = np.asarray(capture.orders, np.int32)
    if capture.observed is not None:
        own["observed_bins"] = np.asarray(capture.observed, np.int32)
