# SPDX-License-Identifier: MIT
"""Bad input raises an exception that names the argument, and nothing crashes."""

import numpy as np
import pytest

import nlos

GRID = np.stack(np.meshgrid([-0.2, 0.0, 0.2], [-0.2, 0.0, 0.2], [0.0], indexing="ij"), -1)[:, :, 0]
H = np.ones((8, 3, 3), np.float32)
TRIANGLE = [[0, 0, 0.5], [0.1, 0, 0.5], [0, 0.1, 0.5]]


def make(values=H, points=GRID, **fields):
    return nlos.Capture(values, points, **{"bin_width_m": 0.01, **fields})


def with_nan():
    capture = make(H.copy())
    capture.H[3, 1, 1] = np.nan
    return capture


def closed_file(tmp_path):
    path = tmp_path / "empty.h5"
    path.write_bytes(b"")
    return path


def itself():
    values = {}
    values["a"] = values
    return values


CASES = {
    # name: (call, part of the message)
    "shape of H": (lambda: make(np.ones((8, 4, 3), np.float32)), "H: has shape (8, 4, 3)"),
    "axes of H": (lambda: make(np.ones(8, np.float32)), "H: has 1 axes"),
    "empty H": (lambda: make(np.ones((0, 3, 3), np.float32)), "H:"),
    "complex H": (lambda: make(H.astype(complex)), "H: holds values of type complex128"),
    "text H": (lambda: make(np.full((8, 3, 3), "a")), "H: holds values of type"),
    "object H": (lambda: make(np.full((8, 3, 3), None)), "H: holds values of type object"),
    "truth values": (lambda: make(H > 0), "H: holds values of type bool"),
    "ragged H": (lambda: make([[1.0], [1.0, 2.0]]), ""),
    "None as H": (lambda: make(None), "H: holds values of type object"),
    "NaN in H": (lambda: make(np.full_like(H, np.nan)), "capture: H"),
    "masked H": (lambda: make(np.ma.masked_greater(np.cumsum(H).reshape(H.shape), 5)), "H: is a masked array"),
    "infinite H": (lambda: make(np.full_like(H, np.inf)), "capture: H"),
    "NaN written later": (lambda: nlos.reconstruct(with_nan(), "bp"), "capture: H"),
    "points without coordinates": (lambda: make(points=np.zeros((3, 3, 2))), "sensing_points_m: has shape (3, 3, 2)"),
    "NaN points": (lambda: make(points=np.full((3, 3, 3), np.nan)), "sensing_points_m: holds a number that is not"),
    "text points": (lambda: make(points="wall"), "sensing_points_m: holds values"),
    "normals of another length": (lambda: make(sensing_normals=np.ones((2, 3))), "normals"),
    "normals of length 0": (lambda: make(sensing_normals=np.zeros((3, 3, 3))), "normals"),
    "no bin width": (lambda: nlos.Capture(H, GRID), "bin_width_m"),
    "negative bin width": (lambda: make(bin_width_m=-1.0), "bin_width_m: found -1"),
    "NaN bin width": (lambda: make(bin_width_m=float("nan")), "bin_width_m: found nan"),
    "unknown pattern": (lambda: make(pattern="spiral"), "pattern: found \"spiral\""),
    "unknown keyword": (lambda: make(colour=1), "colour: found an unknown key"),
    "device without positions": (lambda: make(opl_origin="device"), "opl_origin"),
    "faces out of range": (lambda: nlos.Object(TRIANGLE, [[0, 1, 3]]), "faces: found vertex 3"),
    "negative faces": (lambda: nlos.Object(TRIANGLE, [[0, 1, -1]]), "faces: found vertex -1"),
    "faces of reals": (lambda: nlos.Object(TRIANGLE, [[0.0, 1.0, 2.0]]), "faces: holds values of type float64"),
    "faces of four": (lambda: nlos.Object(TRIANGLE, [[0, 1, 2, 0]]), "faces: has shape (1, 4)"),
    "faces without area": (lambda: nlos.Object(TRIANGLE, [[0, 1, 1]]), "faces: holds no triangle"),
    "infinite vertices": (lambda: nlos.Object(np.full((3, 3), np.inf), [[0, 1, 2]]), "vertices: holds a number"),
    "albedo above 1": (lambda: nlos.Object(TRIANGLE, [[0, 1, 2]], albedo=1.5), "albedo: found 1.5"),
    "scene of nothing": (lambda: nlos.Scene([]), "objects: found none"),
    "unknown setting": (lambda: nlos.render(scene(), sample=3), "sample: found an unknown key; known keys are"),
    "unknown nested setting": (lambda: nlos.render(scene(), restir={"chart": 1}), "render.restir.chart"),
    "negative samples": (lambda: nlos.render(scene(), samples=-1), "render.samples: found -1"),
    "samples of half": (lambda: nlos.render(scene(), samples=0.5), "render.samples: found 0.5"),
    "scan of text": (lambda: nlos.render(scene(), scan="grid"), "scan: found"),
    "setting of an object": (lambda: nlos.render(scene(), samples=object()), "samples: found an object of type object"),
    "keys that are numbers": (lambda: nlos.render(scene(), scan={1: 2}), "scan: found a key that is no text"),
    "settings within themselves": (lambda: nlos.render(scene(), scan=itself()), "nested too deeply"),
    "scene of a number": (lambda: nlos.render(3), "scene: found int"),
    "scene that is not there": (lambda: nlos.render("missing.json"), "missing.json: cannot be opened"),
    "capture that is not there": (lambda: nlos.reconstruct("missing.h5"), "missing.h5"),
    "capture of None": (lambda: nlos.reconstruct(None), "capture: found NoneType"),
    "unknown method": (lambda: nlos.reconstruct(make(), "magic"), "method: found \"magic\""),
    "lct of one bin": (lambda: nlos.reconstruct(make(np.ones((1, 3, 3), np.float32)), "lct"), "method"),
    "negative counts": (lambda: nlos.simulate_noise(make(-H), photons=5), "negative"),
    "threads of text": (lambda: nlos.render(scene(), threads="two"), "threads: found 'two'"),
    "negative threads": (lambda: nlos.render(scene(), threads=-2), "threads: found -2"),
    "progress of text": (lambda: nlos.render(scene(), progress="bar"), "progress: found str"),
    "comparison of kinds": (lambda: nlos.compare(make(), scene()), "result: found Capture against Scene"),
    "threshold": (lambda: nlos.compare(scene(), scene(), fscore_threshold_m=-1.0), "fscore_threshold_m: found -1"),
    "layout that is unknown": (lambda: nlos.read(__file__, layout="mine"), "mine"),
    "list of no paths": (lambda: nlos.read([]), "path: found list"),
    "path of a number": (lambda: nlos.read_volume(3), "path: found int"),
    "path to write to": (lambda: make().write(3), "path: found 3; must be a path"),
    "suffix that is unknown": (lambda: make().write("capture.xyz"), ".xyz"),
    "folder that is not there": (lambda: make().write("/nowhere/capture.h5"), "/nowhere"),
    "function without settings": (lambda: nlos.settings("paint"), "function: found 'paint'"),
    "fit without an object of the name": (lambda: nlos.fit(make(), scene(), free={"ghost": ["pose"]}), "ghost"),
    "volume of another shape": (lambda: operator().forward(np.zeros((2, 2, 2))), "volume: has shape (2, 2, 2)"),
    "histograms of another shape": (lambda: operator().adjoint(np.zeros((7, 3, 3))), "H: has shape (7, 3, 3)"),
    "no voxels": (lambda: nlos.PairOperator(make(), [], [0.0], [0.5]), "x_m: has shape (0)"),
}


def scene():
    return nlos.Scene([nlos.Object(TRIANGLE, [[0, 1, 2]])], scan={"sensing_points": [2, 2]}, time_axis={"num_bins": 300})


def operator():
    return nlos.PairOperator(make(), [0.0], [0.0, 0.1], [0.5])


@pytest.mark.parametrize("name", CASES)
def test_message_names_the_argument(name):
    call, message = CASES[name]
    with pytest.raises((ValueError, TypeError)) as raised:
        call()
    assert message in str(raised.value)
    if isinstance(raised.value, nlos.Error):
        assert raised.value.where and raised.value.allowed
        assert str(raised.value).count("\n") == 0


def test_errors_can_be_told_apart():
    assert issubclass(nlos.Error, ValueError) and issubclass(nlos.Failure, RuntimeError)
    with pytest.raises(nlos.Error) as raised:
        nlos.render(scene(), samples=-1)
    assert raised.value.where == "render.samples" and raised.value.found == "found -1"


def test_truncated_files(tmp_path):
    make().write(str(tmp_path / "capture.h5"))
    whole = (tmp_path / "capture.h5").read_bytes()
    for size in (0, 10, len(whole) // 2, len(whole) - 100):
        (tmp_path / "cut.h5").write_bytes(whole[:size])
        with pytest.raises(nlos.Error, match="cut.h5"):
            nlos.read(tmp_path / "cut.h5")
