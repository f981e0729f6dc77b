# SPDX-License-Identifier: MIT
"""The light of scenes and voxels as functions of PyTorch, with gradients; needs torch."""

from __future__ import annotations

from typing import Any

import torch

from . import _core


class _Linear(torch.autograd.Function):
    """One linear function forwards, its transpose for gradients."""

    @staticmethod
    def forward(ctx: Any, values: torch.Tensor, map_: Any, transpose: Any) -> torch.Tensor:
        ctx.maps = transpose, map_
        return _tensor(map_(_array(values)), values)

    @staticmethod
    def backward(ctx: Any, gradient: torch.Tensor) -> tuple[torch.Tensor, None, None]:
        return _Linear.apply(gradient, *ctx.maps), None, None


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
    return torch.from_numpy(array).to(device=like.device, dtype=like.dtype)
