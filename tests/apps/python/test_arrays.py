# SPDX-License-Identifier: MIT
"""Arrays are views of the objects' memory, in shapes and units as documented."""

import gc
import os
import subprocess
import sys

import numpy as np
import pytest

import nlos


def test_histograms_are_seen_and_written_in_place(capture):
    mine = capture.copy()
    first = mine.H
    first[100, 3, 5] = 7.0
    assert mine.H[100, 3, 5] == 7.0
    assert np.shares_memory(first, mine.H)
    assert not np.shares_memory(first, capture.H)
    assert first.dtype == np.float32 and first.flags.writeable


def test_views_outlive_the_names_of_their_owners(letter):
    H = nlos.render(letter).H
    volume = nlos.reconstruct(nlos.render(letter), "lct").volume
    expected = float(H.sum()), float(volume.sum())
    gc.collect()
    np.zeros(10_000_000)  # would be put where freed memory was
    assert (float(H.sum()), float(volume.sum())) == expected


def test_time_fastest_arrays_are_borrowed_and_others_copied(capture):
    points = capture.sensing_points_m
    theirs = np.moveaxis(np.zeros((16, 16, 200), np.float32), 2, 0)
    borrowed = nlos.Capture(theirs, points, bin_width_m=0.016)
    assert np.shares_memory(borrowed.H, theirs)
    theirs[5] = 1.0
    assert borrowed.H[5].min() == 1.0
    for values in (
        np.ascontiguousarray(theirs),
        np.asfortranarray(theirs)[::-1][::-1].copy(order="C"),
        theirs.astype(np.float64),
        np.repeat(theirs, 2, axis=1)[:, ::2],
        np.ascontiguousarray(theirs[::-1])[::-1],
        np.ascontiguousarray(theirs[:, ::-1])[:, ::-1],
        theirs.astype(np.uint16),
    ):
        copied = nlos.Capture(values, points, bin_width_m=0.016)
        assert not np.shares_memory(copied.H, values)
        assert np.array_equal(copied.H, theirs)
    read_only = theirs.view()
    read_only.flags.writeable = False
    assert not np.shares_memory(nlos.Capture(read_only, points, bin_width_m=0.016).H, theirs)


def test_borrowed_memory_lives_as_long_as_its_capture(capture):
    def make():
        values = np.full((16, 16, 50), 3.0, np.float32)
        return nlos.Capture(np.moveaxis(values, 2, 0), capture.sensing_points_m, bin_width_m=0.1)

    made = make()
    gc.collect()
    np.zeros(1_000_000)
    assert made.H.min() == made.H.max() == 3.0
    assert made.copy().H.sum() == made.H.sum()


def test_shapes_of_scans(letter):
    points = np.array([[0.1, 0.2, 0.0], [0.3, -0.1, 0.0], [0.0, 0.0, 0.0]])
    for scan, shape in [
        ({"pattern": "single", "illumination_m": [0.1, 0.0, 0.0]}, (200, 16, 16)),
        ({"pattern": "exhaustive", "illumination_points": [2, 3], "sensing_points": [4, 5]}, (200, 2, 3, 4, 5)),
        ({"sensing_points_m": points, "sensing_normals": [[0, 0, 1]] * 3}, (200, 3)),
    ]:
        capture = nlos.render(letter, scan=scan)
        assert capture.H.shape == shape
        again = nlos.Capture(
            np.ascontiguousarray(capture.H),
            capture.sensing_points_m,
            capture.sensing_normals,
            None if capture.pattern == "confocal" else capture.illumination_points_m,
            **capture_fields(capture),
        )
        assert nlos.compare(again, capture)["rel_l2"] == 0.0
        like = nlos.render(letter, scan=capture)
        assert np.array_equal(like.H, capture.H)


def capture_fields(capture):
    return {"bin_width_m": capture.bin_width_m, "opl_start_m": capture.opl_start_m, "pattern": capture.pattern}


def test_axes_run_as_documented(square):
    # A square at positive x and y lights the wall points at positive x and y first.
    scene = nlos.Scene([nlos.Object(square.vertices + [0.3, 0.2, 0.0], square.faces)],
                       scan={"sensing_points": [4, 6]}, time_axis={"num_bins": 300})
    capture = nlos.render(scene)
    arrival = (capture.H > 0).argmax(axis=0)
    nearest = np.unravel_index(arrival.argmin(), arrival.shape)
    assert nearest == (3, 4)
    assert np.allclose(capture.sensing_points_m[nearest], [0.375, 0.25, 0.0])
    result = nlos.reconstruct(capture, "bp")
    brightest = np.unravel_index(result.volume.argmax(), result.volume.shape)
    found = [result.x_m[brightest[0]], result.y_m[brightest[1]], result.z_m[brightest[2]], 1.0]
    assert np.allclose((result.world_from_wall @ found)[:3], [0.3, 0.2, 0.5], atol=0.17)


def test_results_have_their_arrays(capture):
    noisy = nlos.simulate_noise(capture, photons_per_point=300)
    result = nlos.reconstruct(noisy, "lct")
    columns = result.volume.shape[:2]
    assert result.volume.shape == (len(result.x_m), len(result.y_m), len(result.z_m))
    assert result.depth_m.shape == result.depth_sigma_m.shape == result.surface_probability.shape == columns
    assert result.normals.shape == (*columns, 3)
    assert len(result.points_m) == np.isfinite(result.depth_m).sum() > 0
    vertices, faces = result.mesh()
    assert vertices.shape[1] == faces.shape[1] == 3 and faces.max() < len(vertices)
    assert result.picture().startswith(b"\x89PNG") and noisy.picture().startswith(b"\x89PNG")
    assert result.picture("pdf").startswith(b"%PDF") and b"<svg" in noisy.picture(format="svg")
    with pytest.raises(ValueError, match="png"):
        result.picture("jpg")


def test_scenes_from_arrays_can_be_written(square, tmp_path):
    scene = nlos.Scene([square], relay_wall={"albedo": 0.5}, scan={"sensing_points": [8, 8]})
    scene.write(str(tmp_path / "scene.json"))
    again = nlos.load_scene(tmp_path / "scene.json")
    assert again.settings["relay_wall"]["albedo"] == 0.5
    assert np.allclose(again.objects[0].vertices, square.vertices, atol=1e-7)
    assert nlos.compare(nlos.render(again), nlos.render(scene))["rel_l2"] < 1e-5
    depth = scene.depth_map()
    assert np.nanmin(depth["depth_m"]) == pytest.approx(0.5)


MEASURE = """
import resource, sys
import numpy as np, nlos
def peak(): return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
values = np.zeros((128, 128, 8192), np.float32)
values[:] = 1e-3
grid = np.stack(np.meshgrid(np.linspace(-1, 1, 128), np.linspace(-1, 1, 128), [0.0], indexing="ij"), -1)[:, :, 0]
before = peak()
capture = nlos.Capture(np.moveaxis(values, 2, 0), grid, bin_width_m=0.0005)
total = capture.H.sum(dtype=np.float64)
after_view = peak()
print(values.nbytes / 2**20, after_view - before)
"""


def test_no_copy_of_half_a_gigabyte():
    done = subprocess.run([sys.executable, "-c", MEASURE], capture_output=True, text=True, check=True, env=os.environ)
    size, grown = map(float, done.stdout.split())
    assert size == 512.0
    assert grown < 40.0


def turned_wall():
    """A pose of a wall that stands and looks elsewhere: axes in columns, and the middle."""
    turn, roll = np.radians([40, 20])
    about_y = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    about_z = np.array([[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
    return about_z @ about_y, np.array([2.0, 0.5, -1.0])


def test_wall_frame_leads_to_the_world(square):
    axes, middle = turned_wall()
    moved = nlos.Object(square.vertices @ axes.T + middle, square.faces, name="square", albedo=0.5)
    scene = nlos.Scene(
        [moved], relay_wall={"center_m": middle.tolist(), "normal": axes[:, 2].tolist(), "up": axes[:, 1].tolist()},
        scan={"sensing_points": [16, 16]}, time_axis={"opl_start_m": 0.5, "bin_width_m": 0.016, "num_bins": 96})
    capture = nlos.render(scene)
    result = nlos.reconstruct(capture, "lct")
    assert np.allclose(result.world_from_wall[:3, :3], axes, atol=1e-6)
    assert np.allclose(result.world_from_wall[:3, 3], middle, atol=1e-6)
    places = result.to_world(result.x_m[:, None], result.y_m, result.depth_m)
    assert places.shape == (16, 16, 3) and places.dtype == np.float64
    surface = places[~np.isnan(result.depth_m)]
    assert len(surface) >= 4 and np.allclose(surface, result.points_m, atol=1e-9)
    assert np.allclose((surface - middle) @ axes[:, 2], 0.5, atol=0.01)
    assert np.allclose(result.to_world(0.1, -0.2, 0.5), axes @ [0.1, -0.2, 0.5] + middle, atol=1e-6)
    truth = scene.depth_map()
    assert np.allclose(truth["world_from_wall"], result.world_from_wall, atol=1e-6)
    for operator in (nlos.PairOperator(capture, x_m=[0.0], y_m=[0.0], z_m=[0.5]), nlos.LightConeOperator(capture)):
        assert np.allclose(operator.world_from_wall, result.world_from_wall, atol=1e-6)
        assert np.allclose(operator.to_world(0, 0, 1), axes[:, 2] + middle, atol=1e-6)
    for wrong in ([1, "a"], [1, 2j]):
        with pytest.raises(nlos.Error, match="y_m"):
            result.to_world(0, wrong, 0)
