"""The section of a plate: its layers, their strains and energy, and what a varying thickness makes of fields.

Where the thickness h varies, z is counted in parts of it: the fields that z multiplies, the rotations, are taken h
times as large, the weights of the points are those of the volume, and the layers are those of a plate of thickness 1.
Every integral over such fields then has the h of its place, and a constant thickness has none of it.

Strains need not be linear in the fields. The elastic energy is the integral of e.C e / 2 over strains e(f) of fields f:
forces are (de/df)' C e, the tangent stiffness is (de/df)' C (de/df) + (C e).(d²e/df²). `Quadratic` has the strains of
layers, E = sym D g + (1/2) sum_m (Q g)_a (Q g)_b: Green's for solids; for plates von Kármán's and, in addition, the
in-plane products, so that turning a plate in its own plane does not strain it. `fem.theory.finite_rotation` is for
plates that turn further.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.linalg import Array
from fem.theory.fields import Block, Fields

Terms = tuple[tuple[Fields, Array], ...]

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
    unit = thickness if isinstance(thickness, float) else 1.0
    return tuple(_layer(arm * thickness, unit / len(arms), arm * unit) for arm in arms)


def weighed(dx: Array, thickness: float | Array) -> Array:
    """Weights of points for fields in parts of the thickness [m², or m³ where it varies]."""
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


@dataclass(frozen=True, eq=False)
class Quadratic:
    """Strains linear_sf f_f + products_sfg f_f f_g / 2 of fields f, with a stiffness (nstrain, nstrain)."""

    fields: Fields
    modulus: Array
    linear: Array
    products: Array

    def at(self, state: Array) -> QuadraticStress:
        """The energy at a state (n,)."""
        values = self.fields.evaluate(state)
        turned = np.tensordot(self.products, values, 1)
        strain = np.tensordot(self.linear, values, 1) + 0.5 * np.einsum("sfcp,fcp->scp", turned, values)
        return QuadraticStress(self, self.linear[:, :, None, None] + turned, np.tensordot(self.modulus, strain, 1))


@dataclass(frozen=True, eq=False)
class QuadraticStress:
    """A variation of the strains with the fields (nstrain, nfield, ncell, npoint), and a stress (nstrain, ...)."""

    energy: Quadratic
    variation: Array
    stress: Array

    def force(self) -> Array:
        """The internal force (n,)."""
        return self.energy.fields.load(np.einsum("sgcp,scp->gcp", self.variation, self.stress))

    def ahead(self, step: Array) -> Array:
        """The stress (nstrain, ncell, npoint) that a step (n,) leads to, to first order."""
        strain = np.einsum("sgcp,gcp->scp", self.variation, self.energy.fields.evaluate(step))
        return np.asarray(self.stress + np.tensordot(self.energy.modulus, strain, 1))

    def terms(self, stress: Array) -> Terms:
        """Fields and coefficients of the tangent stiffness under a stress, its own or another."""
        stiff = np.tensordot(self.energy.modulus, self.variation, 1)
        material = np.einsum("sgcp,shcp->ghcp", self.variation, stiff, optimize=True)
        return ((self.energy.fields, material + np.tensordot(self.energy.products.transpose(1, 2, 0), stress, 1)),)


def of_layers(fields: Fields, layers: tuple[Layer, ...], stiffness: Array) -> Quadratic:
    """The energy of layers over the gradient fields.

    Args:
        fields: the gradients.
        layers: of the plate.
        stiffness: shape (nstrain, nstrain) [Pa].
    """
    modulus = np.asarray(np.kron(np.diag([layer.weight for layer in layers]), stiffness))
    linear = np.concatenate([strain_matrix(layer) for layer in layers])
    return Quadratic(fields, modulus, linear, np.concatenate([products(layer) for layer in layers]))
