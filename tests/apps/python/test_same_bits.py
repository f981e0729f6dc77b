# SPDX-License-Identifier: MIT
"""The module and the program compute the same bits."""

import json

import numpy as np
import pytest

import nlos
from conftest import LETTER, ROOT

SMALL = {"scan": {"sensing_points": [8, 8]}, "time_axis": {"bin_width_m": 0.016, "num_bins": 200}}
SMALL_SET = ["scan.sensing_points=[8,8]", "time_axis.bin_width_m=0.016", "time_axis.num_bins=200"]


@pytest.mark.parametrize(
    "settings",
    [
        {"method": "auto"},
        {"method": "third_bounce", "target_error": 0.05},
        {"method": "path", "samples": 64, "max_bounces": 4, "seed": 7, "by_order": True, "variance": True},
        {"method": "ellipsoidal", "samples": 64},
        {"method": "restir", "samples": 64},
    ],
    ids=lambda s: s["method"],
)
def test_render(program, tmp_path, settings):
    texts = SMALL_SET + [f"render.{key}={json.dumps(value)}" for key, value in settings.items()]
    program("render", LETTER, "-o", "program.h5", "--set", *texts)
    theirs = nlos.read(tmp_path / "program.h5")
    ours = nlos.render(nlos.load_scene(LETTER, **SMALL), **settings)
    assert np.array_equal(ours.H, theirs.H) and ours.H.any()
    assert np.array_equal(ours.sensing_points_m, theirs.sensing_points_m)
    if "by_order" in settings:
        assert np.array_equal(ours.variance, theirs.variance)
        assert all(np.array_equal(ours.by_order[k], theirs.by_order[k]) for k in (3, 4))


@pytest.mark.parametrize("scene", ["room", "traffic"])
def test_render_of_cameras_and_sequences(program, tmp_path, scene):
    path = ROOT / "scenes" / scene / "scene.json"
    small = {"samples": 2}
    texts = ["render.samples=2"]
    if scene == "room":
        small["camera"] = {"resolution": [16, 12]}
        texts.append("camera.resolution=[16,12]")
    program("render", path, "-o", "program.h5", "--set", *texts)
    theirs = nlos.read(tmp_path / "program.h5")
    ours = nlos.render(path, **small)
    assert np.array_equal(ours.H, theirs.H) and ours.H.any()
    assert len(ours.frames) == len(theirs.frames)
    assert all(np.array_equal(a, b) for a, b in zip(ours.frames, theirs.frames))


@pytest.mark.parametrize("method", ["auto", "lct", "dlct", "fk", "phasor", "bp", "fbp", "solver"])
def test_reconstruct(program, tmp_path, capture, method):
    capture.write(tmp_path / "capture.h5")
    program("reconstruct", "capture.h5", "-o", "volume.h5", "--method", method, "--set", "volume.voxels=[16,16,48]")
    theirs = nlos.read_volume(tmp_path / "volume.h5")
    ours = nlos.reconstruct(capture, method, volume={"voxels": [16, 16, 48]})
    assert np.array_equal(ours.volume, theirs.volume) and ours.volume.any()
    assert np.array_equal(ours.depth_m, theirs.depth_m, equal_nan=True)
    assert np.array_equal(ours.points_m, theirs.points_m)
    assert ours.method == theirs.method
    assert ours.settings == theirs.settings


def test_noise(program, tmp_path, capture):
    capture.write(tmp_path / "capture.h5")
    program("simulate-noise", "capture.h5", "-o", "noisy.h5", "--photons-per-point", "50", "--seed", "3")
    theirs = nlos.read(tmp_path / "noisy.h5")
    ours = nlos.simulate_noise(capture, photons_per_point=50, seed=3)
    assert np.array_equal(ours.H, theirs.H) and ours.H.sum() > 0
    assert (ours.unit, ours.counts_per_radiance) == (theirs.unit, theirs.counts_per_radiance)


def test_counts_of_a_sensor(program, tmp_path, capture):
    program("render", ROOT / "data/walk/scene.json", "-o", "walk.h5", "--set", "frames.count=2")
    program("simulate-noise", "walk.h5", "-o", "counts.h5", "--sensor", "--seed", "3")
    walk = nlos.render(ROOT / "data/walk/scene.json", frames={"count": 2})
    theirs = nlos.read(tmp_path / "counts.h5")
    ours = nlos.simulate_noise(walk, sensor=True, seed=3)
    assert np.array_equal(ours.H, theirs.H) and ours.H.any()
    assert len(ours.frames) == len(theirs.frames) == 2
    with pytest.raises(nlos.Error, match="sensor"):
        nlos.simulate_noise(capture, sensor=True)


def test_fit(program, tmp_path, capture):
    noisy = nlos.simulate_noise(capture, photons_per_point=1000)
    noisy.write(tmp_path / "noisy.h5")
    model = {"scene": str(LETTER), "free": {"letter": ["pose", "albedo"]}}
    (tmp_path / "model.json").write_text(json.dumps(model))
    program("fit", "noisy.h5", "model.json", "-o", "fit.json")
    theirs = json.loads((tmp_path / "fit.json").read_text())
    ours = nlos.fit(noisy, LETTER, free=model["free"])
    assert ours.converged
    for key in ("objects", "sigma", "ambient", "deviance", "iterations"):
        assert json.loads(json.dumps(ours.values[key])) == theirs[key], key
    ours.write(tmp_path / "ours.json")
    assert (tmp_path / "ours.scene.json").exists() and (tmp_path / "ours.glb").exists()
    program("compare", "fit.json", LETTER, "-o", "metrics.json")
    check_scores(nlos.compare(tmp_path / "fit.json", LETTER), tmp_path / "metrics.json")
    theirs = json.loads((tmp_path / "metrics.json").read_text())
    for key, value in nlos.compare(ours, LETTER).items():  # files hold vertices as float32
        assert key == "seconds" or value == pytest.approx(theirs[key], rel=1e-4, abs=1e-7), key


def test_compare(program, tmp_path, capture, letter):
    result = nlos.reconstruct(capture, "lct")
    result.write(tmp_path / "volume.h5")
    program("compare", "volume.h5", LETTER, "-o", "metrics.json")
    check_scores(nlos.compare(result, letter), tmp_path / "metrics.json")
    check_scores(nlos.compare(tmp_path / "volume.h5", LETTER), tmp_path / "metrics.json")
    other = nlos.render(letter, method="path", samples=16)
    capture.write(tmp_path / "a.h5")
    other.write(tmp_path / "b.h5")
    program("compare", "a.h5", "b.h5", "-o", "metrics.json")
    check_scores(nlos.compare(capture, other), tmp_path / "metrics.json")
    program("compare", LETTER.with_suffix(".glb"), LETTER, "-o", "metrics.json")
    check_scores(nlos.compare(letter, letter), tmp_path / "metrics.json")


def check_scores(scores, path):
    """Of two runs, but for how long they took and what else the process held."""
    theirs = json.loads(path.read_text())
    runs = {"seconds", "peak_rss_bytes"}
    names = {key for key, value in theirs.items() if isinstance(value, float)} - runs
    assert names and set(scores) - runs == names
    assert {key: scores[key] for key in names} == {key: theirs[key] for key in names}


def test_calibrate(program, tmp_path):
    program("calibrate", ROOT / "data" / "setup.json", "-o", "calibration.json")
    theirs = json.loads((tmp_path / "calibration.json").read_text())
    ours = nlos.calibrate(ROOT / "data" / "setup.json")
    assert ours["points_m"] == theirs["points_m"] and ours["response"] == theirs["response"]
    small = {"scan": {"sensing_points": [8, 8]}, "time_axis": {"bin_width_m": 0.016, "num_bins": 300}}
    program("render", LETTER, "-o", "calibrated.h5", "--calibration", "calibration.json",
            "--set", "scan.sensing_points=[8,8]", "time_axis.bin_width_m=0.016", "time_axis.num_bins=300")
    calibrated = nlos.render(nlos.load_scene(LETTER, **small), calibration=ours)
    assert np.array_equal(calibrated.H, nlos.read(tmp_path / "calibrated.h5").H)


def test_info_and_report(program, tmp_path, capture):
    capture.write(tmp_path / "capture.h5")
    assert nlos.info(tmp_path / "capture.h5") == program("info", tmp_path / "capture.h5")
    assert nlos.info(LETTER) == program("info", LETTER)
    nlos.report(tmp_path, tmp_path / "report.html")
    assert "<html" in (tmp_path / "report.html").read_text()


def test_threads_do_not_change_bits(letter):
    one = nlos.render(letter, method="path", samples=32, threads=1)
    two = nlos.render(letter, method="path", samples=32, threads=2)
    assert np.array_equal(one.H, two.H)
