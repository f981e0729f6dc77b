# SPDX-License-Identifier: MIT
"""To and from the field's other Python packages; none of them is required."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._core import Capture, Object
from ._errors import Error


def from_tal(data: Any) -> Capture:
    """The Capture that a NLOSCaptureData of y-tal (package `y-tal`) holds.

    H must be time-resolved: its formats T_Sx_Sy, T_Si, T_Lx_Ly_Sx_Sy or T_Li_Si. Path lengths
    include the segments to laser and sensor where `t_accounts_first_and_last_bounces` says so.
    """
    H = _tal_histograms(data)
    sensing = np.asarray(data.sensor_grid_xyz, float)
    laser = np.asarray(data.laser_grid_xyz, float)
    exhaustive = H.ndim == 5 or getattr(data.H_format, "name", "") == "T_Li_Si"
    same = laser.shape == sensing.shape and np.allclose(laser, sensing, atol=1e-6)
    fields: dict[str, Any] = {}
    if exhaustive:
        fields["pattern"] = "exhaustive"
    elif laser.size == 3:
        fields["pattern"] = "single"
        laser = laser.reshape(1, 1, 3)
    elif same:
        fields["pattern"] = "confocal"
    else:
        raise Error("laser_grid_xyz", f"has shape {laser.shape}",
                    "must be one point, or the sensor's points, for an H without laser axes")
    if data.t_accounts_first_and_last_bounces:
        fields.update(opl_origin="device", laser_m=np.ravel(data.laser_xyz), detector_m=np.ravel(data.sensor_xyz))
    lists = {} if fields["pattern"] == "confocal" else {
        "illumination_points_m": laser,
        "illumination_normals": _like(data.laser_grid_normals, laser),
    }
    return Capture(H, sensing, _like(data.sensor_grid_normals, sensing), **lists,
                   bin_width_m=float(data.delta_t), opl_start_m=float(data.t_start or 0.0), **fields)


def to_tal(capture: Capture) -> Any:
    """The NLOSCaptureData of y-tal that holds a capture; H shares its memory.

    What y-tal has no place for (unit, variance, orders, frames, unobserved bins) is left out.
    """
    from tal.enums import GridFormat, HFormat
    from tal.io.capture_data import NLOSCaptureData

    if capture.is_image:
        raise Error("capture", "found an image of a camera", "must be a scan of a relay wall")
    data = NLOSCaptureData()
    data.H = capture.H
    data.H_format = {2: HFormat.T_Si, 3: HFormat.T_Sx_Sy if capture.pattern != "exhaustive" else HFormat.T_Li_Si,
                     5: HFormat.T_Lx_Ly_Sx_Sy}[capture.H.ndim]
    for name, points, normals in (("sensor", capture.sensing_points_m, capture.sensing_normals),
                                  ("laser", capture.illumination_points_m, capture.illumination_normals)):
        setattr(data, f"{name}_grid_xyz", points)
        setattr(data, f"{name}_grid_normals", normals)
        setattr(data, f"{name}_grid_format", GridFormat.X_Y_3 if points.ndim == 3 else GridFormat.N_3)
    data.delta_t = capture.bin_width_m
    data.t_start = capture.opl_start_m
    data.t_accounts_first_and_last_bounces = capture.opl_origin == "device"
    data.laser_xyz = np.asarray(capture.laser_m)
    data.sensor_xyz = np.asarray(capture.detector_m)
    data.scene_info = capture.scene_info
    return data


def from_mitransient(transient: Any, sensing_points_m: Any, *, opl_start_m: float, bin_width_m: float,
                     **fields: Any) -> Capture:
    """The Capture of a transient image that mitransient rendered of a relay wall.

    transient         (Sx, Sy, T) or (Sx, Sy, T, C), for instance ``np.array(transient)[..., 0]``;
                      colours are averaged; without them it is taken as it lies in memory
    sensing_points_m  (Sx, Sy, 3), in the order of the pixels
    opl_start_m       `start_opl` of the film [m]
    bin_width_m       `bin_width_opl` of the film [m]
    fields            illumination_points_m, sensing_normals, pattern, opl_origin, ... as of Capture
    """
    values = np.asarray(transient)
    if values.ndim == 4:
        values = values[..., 0] if values.shape[3] == 1 else values.mean(axis=3)
    if values.ndim != 3:
        raise Error("transient", f"has shape {values.shape}", "must have shape (Sx, Sy, T) or (Sx, Sy, T, C)")
    return Capture(np.moveaxis(values, 2, 0), sensing_points_m, opl_start_m=opl_start_m,
                   bin_width_m=bin_width_m, **fields)


def from_trimesh(mesh: Any, **fields: Any) -> Object:
    """The Object of a mesh of trimesh, or of anything with `vertices` [m] and `faces`.

    fields    name, albedo, surface, roughness, role, velocity_m_per_s
    """
    return Object(np.asarray(mesh.vertices), np.asarray(mesh.faces), **fields)


def to_xarray(capture: Capture) -> Any:
    """H as a DataArray with named axes and units; it shares the capture's memory."""
    import xarray

    H = capture.H
    points = {1: ["s"], 2: ["x", "y"]}
    names = ["opl_m"]
    if capture.pattern == "exhaustive":
        dims = capture.illumination_points_m.ndim - 1
        names += {1: ["l"], 2: ["lx", "ly"]}[dims]
    names += ["column", "row"] if capture.is_image else points[capture.sensing_points_m.ndim - 1]
    centres = capture.opl_start_m + (np.arange(capture.num_bins) + 0.5) * capture.bin_width_m
    array = xarray.DataArray(H, dims=names, coords={"opl_m": centres}, name="H")
    array.attrs.update(units="counts" if capture.unit == "counts" else "W m-2 sr-1", pattern=capture.pattern,
                       opl_origin=capture.opl_origin, bin_width_m=capture.bin_width_m)
    array["opl_m"].attrs.update(units="m", long_name="optical path length at the bin's centre")
    return array


def _tal_histograms(data: Any) -> np.ndarray:
    name = getattr(getattr(data, "H_format", None), "name", "UNKNOWN")
    if name not in ("T_Sx_Sy", "T_Si", "T_Lx_Ly_Sx_Sy", "T_Li_Si"):
        raise Error("H_format", f"found {name}", "must be T_Sx_Sy, T_Si, T_Lx_Ly_Sx_Sy or T_Li_Si")
    return np.asarray(data.H)


def _like(normals: Any, points: np.ndarray) -> np.ndarray | None:
    if normals is None:
        return None
    return np.asarray(normals, float).reshape(points.shape)
