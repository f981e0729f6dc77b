# SPDX-License-Identifier: MIT
"""Checks an installed module: renders, reconstructs, compares, fits, writes, reads, draws pictures.

    python tests/apps/python/installed_wheel.py
"""

import tempfile
from pathlib import Path

import numpy as np

import nlos

DEPTH_M = 0.5


def letter(depth_m: float) -> nlos.Scene:
    """An L of two rectangles in front of the middle of a wall."""
    x = [-0.2, -0.08, -0.08, 0.2, 0.2, -0.2]
    y = [0.3, 0.3, -0.18, -0.18, -0.3, -0.3]
    vertices = np.stack([x, y, np.full(6, depth_m)], axis=1)
    faces = [[0, 5, 2], [0, 2, 1], [5, 4, 2], [4, 3, 2]]
    return nlos.Scene([nlos.Object(vertices, faces, name="letter")],
                      relay_wall={"size_m": [1, 1]}, scan={"sensing_points": [32, 32]},
                      time_axis={"opl_start_m": 0.0, "bin_width_m": 0.016, "num_bins": 256})


def check(what: str, holds: bool) -> None:
    print(("ok      " if holds else "FAILED  ") + what)
    if not holds:
        raise SystemExit(1)


scene = letter(DEPTH_M)
capture = nlos.render(scene)
total = float(capture.H.sum())
check(f"render: shape {capture.H.shape}", capture.H.shape == (256, 32, 32))
check(f"render: sum {total:.4f}", abs(total - 12.23) < 0.01)

result = nlos.reconstruct(capture, method="lct")
depth_m = float(np.nanmedian(result.depth_m))
check(f"reconstruct: depth {depth_m:.4f} m", abs(depth_m - DEPTH_M) < 0.005)
scores = nlos.compare(result, scene)
check(f"compare: depth_mae_m {scores['depth_mae_m']:.5f}", scores["depth_mae_m"] < 0.003)
check(f"compare: fscore {scores['fscore']:.3f}", scores["fscore"] > 0.8)

shipped = nlos.load_scene(nlos.data_folder() / "scenes" / "letter" / "scene.json")
check(f"scenes that come with it: {nlos.data_folder()}", len(shipped.objects) == 1)

fit = nlos.fit(capture, letter(DEPTH_M + 0.02), free={"letter": ["pose"]})
error_m = float(np.abs(fit.scene.objects[0].vertices - scene.objects[0].vertices).max())
check(f"fit: within {error_m:.1e} m", error_m < 1e-3)

with tempfile.TemporaryDirectory() as folder:
    fit.scene.write(str(Path(folder, "scene.json")))
    objects = nlos.load_scene(Path(folder, "scene.json")).objects
    check(f"write and read: scene of {objects[0].name}", len(objects) == 1)
    for suffix in (".h5", ".npz", ".mat", ".exr"):
        path = str(Path(folder, "capture" + suffix))
        capture.write(path)
        values = [np.sort(c.H, axis=None) for c in (capture, nlos.read(path))]
        check(f"write and read: {suffix}", np.array_equal(*values))  # points in the file's order
    Path(folder, "damaged.h5").write_bytes(Path(folder, "capture.h5").read_bytes()[:5000])
    try:
        nlos.read(Path(folder, "damaged.h5"))
        check("read: a damaged file is refused", False)
    except nlos.Error as error:
        check(f"read: a damaged file is refused: {error}", True)

for name, shown in (("capture", capture), ("result", result), ("fit", fit)):
    picture = shown.picture()
    check(f"picture of {name}: {len(picture)} bytes", picture.startswith(b"\x89PNG"))
