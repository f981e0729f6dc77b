# SPDX-License-Identifier: MIT
"""To and from y-tal, mitransient, trimesh and xarray; stand-ins where these are not installed."""

import enum
import types

import numpy as np
import pytest

import nlos

HFormat = enum.Enum("HFormat", ["T_Sx_Sy", "T_Lx_Ly_Sx_Sy", "T_Si", "T_Li_Si"])
DEVICE = np.array([0.3, 0.1, 0.8])


def grid(nx, ny):
    x, y = np.meshgrid(np.linspace(-0.4, 0.4, nx), np.linspace(-0.3, 0.3, ny), indexing="ij")
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def tal_like(H, laser, name, segments=False):
    points = grid(4, 3)
    return types.SimpleNamespace(
        H=H, H_format=HFormat[name], sensor_grid_xyz=points, sensor_grid_normals=np.zeros_like(points) + [0, 0, 1],
        laser_grid_xyz=laser, laser_grid_normals=np.zeros_like(laser) + [0, 0, 1], delta_t=0.01, t_start=0.5,
        t_accounts_first_and_last_bounces=segments, laser_xyz=DEVICE, sensor_xyz=DEVICE + [0.1, 0, 0])


def numbers(*shape):
    return np.random.default_rng(1).random(shape, dtype=np.float32)


@pytest.mark.parametrize(
    ("H", "laser", "name", "pattern"),
    [
        (numbers(7, 4, 3), grid(4, 3), "T_Sx_Sy", "confocal"),
        (numbers(7, 4, 3), np.zeros((1, 1, 3)), "T_Sx_Sy", "single"),
        (numbers(7, 2, 3, 4, 3), grid(2, 3), "T_Lx_Ly_Sx_Sy", "exhaustive"),
    ],
    ids=["confocal", "single", "exhaustive"],
)
@pytest.mark.parametrize("segments", [False, True])
def test_from_tal(H, laser, name, pattern, segments):
    capture = nlos.from_tal(tal_like(H, laser, name, segments))
    assert np.array_equal(capture.H, H)
    assert capture.pattern == pattern
    assert np.allclose(capture.sensing_points_m, grid(4, 3)) and np.allclose(capture.illumination_points_m, laser)
    assert (capture.bin_width_m, capture.opl_start_m) == (0.01, 0.5)
    assert capture.opl_origin == ("device" if segments else "relay_wall")
    if segments:
        assert np.allclose(capture.laser_m, DEVICE) and np.allclose(capture.detector_m, DEVICE + [0.1, 0, 0])


def test_from_tal_names_what_it_cannot_read():
    data = tal_like(numbers(7, 4, 3), grid(4, 3), "T_Sx_Sy")
    data.H_format = None
    with pytest.raises(nlos.Error, match="H_format"):
        nlos.from_tal(data)
    with pytest.raises(nlos.Error, match="laser_grid_xyz"):
        nlos.from_tal(tal_like(numbers(7, 4, 3), grid(2, 2), "T_Sx_Sy"))


def test_round_trip_by_ytal(capture):
    pytest.importorskip("tal")
    data = nlos.to_tal(capture)
    assert np.shares_memory(data.H, capture.H)
    assert data.is_confocal()
    again = nlos.from_tal(data)
    assert np.array_equal(again.H, capture.H)
    assert np.array_equal(again.sensing_points_m, capture.sensing_points_m)
    assert again.axis == capture.axis and again.pattern == capture.pattern


@pytest.mark.parametrize("colours", [None, 1, 3])
def test_from_mitransient(colours):
    image = numbers(4, 3, 7) if colours is None else numbers(4, 3, 7, colours)
    capture = nlos.from_mitransient(image, grid(4, 3), opl_start_m=0.5, bin_width_m=0.01)
    expected = image if colours is None else image.mean(axis=3)
    assert np.allclose(capture.H, np.moveaxis(expected, 2, 0), rtol=1e-6)
    assert (capture.bin_width_m, capture.opl_start_m, capture.pattern) == (0.01, 0.5, "confocal")


def test_from_mitransient_shares_memory():
    image = numbers(4, 3, 7)
    capture = nlos.from_mitransient(image, grid(4, 3), opl_start_m=0.5, bin_width_m=0.01)
    assert np.shares_memory(capture.H, image)


def test_from_mitransient_names_a_wrong_shape():
    with pytest.raises(nlos.Error, match="transient"):
        nlos.from_mitransient(numbers(4, 3), grid(4, 3), opl_start_m=0.0, bin_width_m=0.01)


def test_from_trimesh():
    mesh = types.SimpleNamespace(vertices=np.array([[0, 0, 0.5], [0.1, 0, 0.5], [0, 0.1, 0.5]]), faces=[[0, 1, 2]])
    made = nlos.from_trimesh(mesh, name="corner", albedo=0.25)
    assert np.array_equal(made.vertices, mesh.vertices) and made.faces.tolist() == mesh.faces
    assert (made.name, made.albedo) == ("corner", 0.25)


def test_to_xarray(capture):
    pytest.importorskip("xarray")
    array = capture.to_xarray()
    assert array.dims == ("opl_m", "x", "y") and array.attrs["units"] == "W m-2 sr-1"
    assert array["opl_m"].attrs["units"] == "m"
    assert float(array["opl_m"][0]) == pytest.approx(capture.opl_start_m + capture.bin_width_m / 2)
    assert np.shares_memory(array.values, capture.H)
