# SPDX-License-Identifier: MIT
"""The light of scenes and voxels as functions of PyTorch, with gradients; needs torch."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
import torch

from . import Object, Scene, _core, third_bounce_vjp
from ._errors import Error


class _Linear(torch.autograd.Function):
    """One linear function forwards, its transpose for gradients."""

    @staticmethod
    def forward(ctx: Any, values: torch.Tensor, map_: Any, transpose: Any) -> torch.Tensor:
        ctx.maps = transpose, map_
        return _tensor(map_(_array(values)), values)

    @staticmethod
    def backward(ctx: Any, gradient: torch.Tensor) -> tuple[torch.Tensor, None, None]:
        return _Linear.apply(gradient, *ctx.maps), None, None


class _ThirdBounce(torch.autograd.Function):
    """H of the vertices and albedos of a scene's objects, in turns."""

    @staticmethod
    def forward(ctx: Any, scene: Any, scan: Any, axis: Any, settings: Any, *values: torch.Tensor) -> torch.Tensor:
        objects = [
            Object(_array(vertices), old.faces, name=old.name, role=old.role, albedo=float(albedo))
            for old, vertices, albedo in zip(scene.objects, values[::2], values[1::2])
        ]
        H, ctx.pullback = third_bounce_vjp(scene.with_objects(objects), scan, axis, **settings)
        ctx.like = values
        return _tensor(H, values[0])

    @staticmethod
    def backward(ctx: Any, gradient: torch.Tensor) -> tuple[Any, ...]:
        gradients: list[Any] = [None] * 4
        for (vertices, albedo), like in zip(ctx.pullback(_array(gradient)), ctx.like[::2]):
            gradients += [_tensor(vertices, like), torch.tensor(albedo, dtype=like.dtype, device=like.device)]
        return tuple(gradients)


def third_bounce(
    scene: Scene,
    vertices: torch.Tensor | Sequence[torch.Tensor],
    albedo: torch.Tensor | Sequence[torch.Tensor] | None = None,
    *,
    scan: Any = None,
    axis: Any = None,
    **settings: Any,
) -> torch.Tensor:
    """H (T, Sx, Sy) of a scene whose objects have other vertices and albedos, with gradients by both.

    scene     Scene of Lambertian objects; its faces, wall, scan and axis are kept
    vertices  (N, 3) of its object [m], or a list with one tensor per object
    albedo    scalar of its object, or a list; None: the scene's
    settings  of third_bounce_vjp()
    """
    objects = scene.objects
    moved = [vertices] if isinstance(vertices, torch.Tensor) else list(vertices)
    if albedo is None:
        albedo = [torch.tensor(o.albedo, dtype=moved[0].dtype) for o in objects]
    albedos = [albedo] if isinstance(albedo, torch.Tensor) else list(albedo)
    if len(moved) != len(objects) or len(albedos) != len(objects):
        raise Error("vertices", f"found {len(moved)} tensors and {len(albedos)} albedos",
                    f"must be one of each of the scene's {len(objects)} objects")
    return _ThirdBounce.apply(scene, scan, axis, settings, *(t for pair in zip(moved, albedos) for t in pair))


def light_cone(volume: torch.Tensor, operator: _core.LightConeOperator | _core.PairOperator) -> torch.Tensor:
    """Histograms (T, Sx, Sy) of a volume (X, Y, Z), with gradients by the volume.

    operator   LightConeOperator of a confocal grid, or PairOperator of any scan
    """
    return _Linear.apply(volume, operator.forward, operator.adjoint)


def backproject(H: torch.Tensor, operator: _core.PairOperator | _core.LightConeOperator) -> torch.Tensor:
    """The transpose of light_cone(): a volume (X, Y, Z) of histograms, with gradients by them."""
    return _Linear.apply(H, operator.adjoint, operator.forward)


def _array(values: torch.Tensor) -> Any:
    return values.detach().cpu().numpy()


def _tensor(array: Any, like: torch.Tensor) -> torch.Tensor:
    return torch.from_numpy(np.array(array)).to(device=like.device, dtype=like.dtype)
