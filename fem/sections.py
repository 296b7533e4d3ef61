"""The section of a plate: its layers, and what a varying thickness makes of fields and weights.

Where the thickness h varies, z is counted in parts of it: the fields that z multiplies, the rotations, are taken h
times as large, the weights of the points are those of the volume, and the layers are those of a plate of thickness 1.
Every integral over such fields then has the h of its place, and a constant thickness has none of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.discretisation import Layer
from fem.fields import Block

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

GAUSS = 0.5 / np.sqrt(3.0)
"""Two points through a thickness of 1, exact for quadratics in z."""


def layers(thickness: float | Array, flat: bool = False) -> tuple[Layer, ...]:
    """The layers of a plate: u, v and w and the rotations, by z; flat: the mid-surface alone."""
    arms = (0.0,) if flat else (-GAUSS, GAUSS)
    if isinstance(thickness, float):
        return tuple(_layer(arm * thickness, thickness / len(arms), arm * thickness) for arm in arms)
    return tuple(_layer(arm * thickness, 1.0 / len(arms), arm) for arm in arms)


def weighed(dx: Array, thickness: float | Array) -> Array:
    """Weights of the points for fields in parts of the thickness: in m² where it is constant, otherwise in m³."""
    return dx if isinstance(thickness, float) else dx * thickness


def stretched(block: Block, thickness: float | Array, start: int = 0) -> Block:
    """Fields from number start on that z multiplies, in parts of the thickness."""
    if isinstance(thickness, float):
        return block
    table = block.table.copy()
    table[:, :, start:] *= thickness[:, :, None, None]
    return Block(table, block.dofs)


def _layer(z: float | Array, weight: float, arm: float) -> Layer:
    displacement = np.zeros((3, 5))
    displacement[:, :3] = np.eye(3)
    displacement[0, 3] = displacement[1, 4] = -arm
    products = np.diag([1.0, 1.0, 1.0, -arm, -arm])
    gradient, quadratic = (np.einsum("kf,ab->kafb", m, np.eye(2)).reshape(-1, 2, 10) for m in (displacement, products))
    return Layer(z, weight, displacement, gradient, quadratic)
