# SPDX-License-Identifier: MIT
"""Reconstructs a capture by y-tal: bp, lct, fk or phasor. README.md has y-tal's conventions."""
import os
import sys
import tempfile
from importlib import metadata

os.environ["HOME"] = (home := tempfile.TemporaryDirectory()).name  # y-tal writes a configuration there

import h5py
import numpy as np
import tal
from tal.enums import CameraSystem

from adapter import Timer, serve

VERSION = "y-tal " + metadata.version("y-tal")
CYCLES = 5  # of the phasor field's pulse, as ours


def read_in_wall_frame(request):
    # The phasor field takes depths, and f-k migration the wall's width, from these coordinates.
    data = tal.io.read_capture(request["capture"])
    wall_from_world = np.linalg.inv(request["world_from_wall"])
    for name in ("sensor_grid_xyz", "laser_grid_xyz", "sensor_xyz", "laser_xyz"):
        setattr(data, name, getattr(data, name) @ wall_from_world[:3, :3].T + wall_from_world[:3, 3])
    return data


def needs(method, data, xyz):
    points = data.sensor_grid_xyz
    yield data.H.ndim == 3, "wall points on a grid"
    yield not data.t_accounts_first_and_last_bounces, "path lengths from wall to wall"
    yield data.t_start >= 0, "a capture that starts at path length 0 or later"
    if method == "phasor":
        fits = xyz.shape[:2] == points.shape[:2] and np.allclose(xyz[:, :, 0, :2], points[..., :2], atol=1e-5)
        yield fits, "voxels straight before the wall points"
    else:
        yield data.is_confocal(), "a confocal capture"
        yield points.shape[0] == points.shape[1], "as many wall points along x as along y"


def backproject(data, xyz, memory_gb):
    # It holds some 50 bytes for every voxel and wall point at once: slabs of depths, one by one.
    count = max(1, int(1e9 * memory_gb / (50 * xyz[:, :, 0, 0].size * data.H[0].size)))
    slabs = [xyz[:, :, first:first + count] for first in range(0, xyz.shape[2], count)]
    return np.concatenate([tal.reconstruct.bp.solve(
        data, volume_xyz=slab, camera_system=CameraSystem.DIRECT_LIGHT, progress=False) for slab in slabs], axis=2)


def work(request):
    tal.set_log_level(tal.LogLevel.WARNING)
    method, timer, z_m = request["method"], Timer(), None
    if method == "lct" and not hasattr(tal.reconstruct, "lct"):
        sys.exit(f"{VERSION} has no lct, which came with 0.21")
    data = read_in_wall_frame(request)
    xyz = np.stack(np.meshgrid(*(request[axis] for axis in ("x_m", "y_m", "z_m")), indexing="ij"), axis=-1)
    if method != "bp":
        for is_met, need in needs(method, data, xyz):
            if not is_met:
                sys.exit(f"{method} of {VERSION} needs {need}")
        late = int(round(float(data.t_start) / float(data.delta_t)))  # their first bin is path length 0
        data.H, data.t_start = np.pad(data.H, ((late, 0), (0, 0), (0, 0))), 0.0
    with timer:
        if method == "bp":
            volume = backproject(data, xyz, request["memory_gb"])
        elif method == "phasor":
            volume = tal.reconstruct.pf.solve(data, c_wavelength=request["wavelength_m"], wave_cycles=CYCLES,
                                              camera_system=CameraSystem.DIRECT_LIGHT, volume=xyz)
        else:
            volume = np.moveaxis(getattr(tal.reconstruct, method).solve(data), 0, -1)
            z_m = (np.arange(volume.shape[-1]) + 0.5) * float(data.delta_t) / 2  # a bin's middle
    with h5py.File(request["output"], "w") as file:
        file["volume"] = np.abs(volume).astype(np.float32)
        if z_m is not None:
            file["z_m"] = z_m
    return {"version": VERSION, "work_cpu_s": timer.seconds}


serve(work)
