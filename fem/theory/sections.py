"""The section of a plate: its layers, and what a varying thickness makes of fields and weights.

Where the thickness h varies, z is counted in parts of it: the fields that z multiplies, the rotations, are taken h
times as large, the weights of the points are those of the volume, and the layers are those of a plate of thickness 1.
Every integral over such fields then has the h of its place, and a constant thickness has none of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.theory.fields import Block

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

GAUSS = 0.5 / np.sqrt(3.0)
"""Two points through a thickness of 1, exact for quadratics in z."""

VOIGT = {
    2: ((0, 0), (1, 1), (0, 1)),
    3: ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)),
}
"""Index pairs of the strain components, shear counted twice."""


@dataclass(frozen=True, eq=False)
class Layer:
    """One point of the integration through the thickness.

    z and weight in m (for solids 0 and 1); where the thickness varies z is (ncell, npoint) and the weight a part of it,
    see the top of this module.

    Attributes:
        displacement: T, (3, nfield).
        gradient: D, (3, d, ngradient), with H[k, a] = dU_k/dX_a for the d directions in which the theory has strains.
        quadratic: Q, (m, d, ngradient), whose products Q_ma Q_mb / 2 are the second-order part of the strain: D itself
            for solids; in plates the terms of grad u times grad theta are left out, as von Karman does
            (`fem.theory.finite_rotation` has them).
    """

    z: float | Array
    weight: float
    displacement: Array
    gradient: Array
    quadratic: Array


def strain_matrix(layer: Layer) -> Array:
    """B (nstrain, ngradient): the linear strains (Voigt) from the gradient fields."""
    d = layer.gradient
    return np.array([d[a, b] if a == b else d[a, b] + d[b, a] for a, b in VOIGT[d.shape[1]]])


def products(layer: Layer) -> Array:
    """A (nstrain, ngradient, ngradient): the second-order strains (Voigt) are half its products with the gradients."""
    q = layer.quadratic
    pairs = [q[:, a].T @ q[:, b] for a, b in VOIGT[q.shape[1]]]
    return np.array([pair if a == b else pair + pair.T for (a, b), pair in zip(VOIGT[q.shape[1]], pairs, strict=True)])


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
