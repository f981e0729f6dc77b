# SPDX-License-Identifier: MIT
"""Gradients against central differences, and what one does with them."""

import numpy as np
import pytest

import nlos

GRID = {"sensing_points": [5, 4]}
AXIS = {"opl_start_m": 0.4, "bin_width_m": 0.02, "num_bins": 140}


def random_scene(rng):
    """Two random triangles behind two that hide parts of them, and an interleaved quadrilateral."""
    objects = []
    for index in range(4):
        depth = 0.8 if index < 2 else 0.5
        size = 0.35 if index < 2 else 0.2
        centre = np.array([*rng.uniform(-0.15, 0.15, 2), depth + rng.uniform(-0.05, 0.05)])
        corners = centre + size * rng.uniform(-1.0, 1.0, (3, 3)) * [1.0, 1.0, 0.3]
        objects.append(nlos.Object(corners, [[0, 1, 2]], name=f"triangle {index}", albedo=rng.uniform(0.2, 0.9)))
    return nlos.Scene(objects, scan=GRID, time_axis=AXIS)


def moved(scene, index, vertices=None, albedo=None):
    objects = scene.objects
    old = objects[index]
    objects[index] = nlos.Object(old.vertices if vertices is None else vertices, old.faces, name=old.name,
                                 albedo=old.albedo if albedo is None else albedo)
    return scene.with_objects(objects)


@pytest.mark.parametrize("seed", range(20))
def test_gradients_match_central_differences(seed):
    rng = np.random.default_rng(seed)
    scene = random_scene(rng)
    H, pullback = nlos.third_bounce_vjp(scene)
    weights = rng.standard_normal(H.shape)
    gradients = pullback(weights)

    def loss(changed):
        return float((nlos.third_bounce_vjp(changed)[0] * weights).sum())

    step = 1e-7  # [m]; rounding adds about as much as curvature does
    scale = np.sqrt(sum((vertices**2).sum() for vertices, _ in gradients))
    for index, (by_vertices, by_albedo) in enumerate(gradients):
        vertices = scene.objects[index].vertices.copy()
        direction = rng.standard_normal(vertices.shape)
        difference = (loss(moved(scene, index, vertices + step * direction)) -
                      loss(moved(scene, index, vertices - step * direction))) / (2 * step)
        assert difference == pytest.approx((by_vertices * direction).sum(), abs=1e-4 * scale)
        albedo = scene.objects[index].albedo
        difference = (loss(moved(scene, index, albedo=albedo + 0.01)) -
                      loss(moved(scene, index, albedo=albedo - 0.01))) / 0.02
        assert difference == pytest.approx(by_albedo, rel=1e-6, abs=1e-9 * scale)


def test_histograms_are_those_of_the_renderer():
    for seed in range(4):
        scene = random_scene(np.random.default_rng(seed))
        H, _ = nlos.third_bounce_vjp(scene, tolerance=0.002)
        rendered = nlos.render(scene, method="third_bounce", target_error=0.002).H
        assert np.linalg.norm(H - rendered) < 0.006 * np.linalg.norm(rendered)


def test_shadows_count():
    # Light lost to a screen that moves sideways comes from nowhere but its edge.
    back = nlos.Object([[-0.3, -0.3, 0.8], [0.3, -0.3, 0.8], [0.3, 0.3, 0.8], [-0.3, 0.3, 0.8]], [[0, 1, 2], [0, 2, 3]])
    screen = nlos.Object([[0.02, -0.4, 0.5], [0.4, -0.4, 0.5], [0.4, 0.4, 0.5], [0.02, 0.4, 0.5]],
                         [[0, 1, 2], [0, 2, 3]], albedo=0.0)
    scene = nlos.Scene([back, screen], scan=GRID, time_axis=AXIS)
    H, pullback = nlos.third_bounce_vjp(scene)
    by_screen = pullback(np.ones_like(H))[1][0]
    assert by_screen[[0, 3], 0].min() > 0.0  # the edge at x = 0.02 uncovers the square
    assert np.abs(by_screen[[1, 2], 0]).max() < 0.2 * by_screen[[0, 3], 0].min()


def test_what_has_no_gradient_is_refused():
    mirror = nlos.Object([[0, 0, 0.5], [0.1, 0, 0.5], [0, 0.1, 0.5]], [[0, 1, 2]], surface="retroreflective")
    with pytest.raises(nlos.Error, match="must be Lambertian"):
        nlos.third_bounce_vjp(nlos.Scene([mirror], scan=GRID))
    scene = random_scene(np.random.default_rng(0))
    H, pullback = nlos.third_bounce_vjp(scene)
    with pytest.raises(nlos.Error, match="gradient: has shape"):
        pullback(H[1:])
    with pytest.raises(nlos.Error, match="found auto"):
        nlos.third_bounce_vjp(scene, axis="auto")


def test_operators_are_transposed(capture):
    rng = np.random.default_rng(1)
    cone = nlos.LightConeOperator(capture, response={"jitter_fwhm_ps": 60})
    pairs = nlos.PairOperator(capture, cone.x_m[:5], cone.y_m[:4], [0.6, 0.7, 0.75], spot_m=0.02)
    for operator in (cone, pairs):
        volume = rng.random(operator.volume_shape, dtype=np.float32)
        histograms = rng.random(capture.H.shape, dtype=np.float32)
        forwards = (operator.forward(volume).astype(float) * histograms).sum()
        back = (operator.adjoint(histograms).astype(float) * volume).sum()
        assert forwards == pytest.approx(back, rel=1e-5) and forwards > 0


def test_torch_differentiates_operators(capture):
    torch = pytest.importorskip("torch")
    import nlos.torch

    operator = nlos.PairOperator(capture, [0.0, 0.1], [0.0, 0.1], [0.6, 0.7])
    data = torch.from_numpy(capture.H.copy())
    volume = torch.rand(operator.volume_shape, requires_grad=True)
    residual = nlos.torch.light_cone(volume, operator) - data
    (0.5 * (residual**2).sum()).backward()
    expected = operator.adjoint(residual.detach().numpy())
    assert np.allclose(volume.grad.numpy(), expected, rtol=1e-4, atol=1e-6 * np.abs(expected).max())
    assert torch.allclose(nlos.torch.backproject(data, operator), torch.from_numpy(operator.adjoint(capture.H)))


def test_torch_moves_a_mesh():
    torch = pytest.importorskip("torch")
    import nlos.torch

    square = np.array([[-0.2, -0.2, 0.6], [0.2, -0.2, 0.6], [0.2, 0.2, 0.6], [-0.2, 0.2, 0.6]])
    scene = nlos.Scene([nlos.Object(square, [[0, 1, 2], [0, 2, 3]], albedo=0.7)], scan=GRID, time_axis=AXIS)
    truth = torch.tensor(nlos.third_bounce_vjp(scene)[0])
    shift = torch.tensor([0.05, -0.04, 0.06], dtype=torch.float64, requires_grad=True)
    albedo = torch.tensor(0.5, dtype=torch.float64, requires_grad=True)
    optimiser = torch.optim.Adam([shift, albedo], lr=0.01)
    for _ in range(150):
        optimiser.zero_grad()
        H = nlos.torch.third_bounce(scene, torch.from_numpy(square) + shift, albedo)
        loss = ((H - truth)**2).sum() / (truth**2).sum()
        loss.backward()
        optimiser.step()
    assert shift.detach().abs().max() < 0.005
    assert float(albedo) == pytest.approx(0.7, abs=0.03)
