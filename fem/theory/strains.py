"""Strains that are not linear in the fields, their stress, and what both do to forces and stiffness.

The elastic energy is the integral of e.C e / 2 over strains e(f) of fields f: forces are (de/df)' C e, the tangent
stiffness is (de/df)' C (de/df) + (C e).(d²e/df²). `Quadratic` has the strains of layers (`fem.theory.sections.Layer`),
E = sym D g + (1/2) sum_m (Q g)_a (Q g)_b: Green's for solids; for plates von Kármán's and, in addition, the in-plane
products, so that turning a plate in its own plane does not strain it. `fem.theory.finite_rotation` is for plates that
turn further.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from fem.theory.sections import products, strain_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.theory.fields import Fields
    from fem.theory.sections import Layer

    Array = NDArray[np.float64]
    Terms = tuple[tuple[Fields, Array], ...]


class Stressed(Protocol):
    """A part of the elastic energy at a state."""

    def force(self) -> Array:
        """The internal force (n,), the energy's derivative."""
        ...

    def ahead(self, step: Array) -> Array:
        """The stress that a step (n,) leads to, to first order."""
        ...

    def terms(self, stress: Array | None = None) -> Terms:
        """Fields and coefficients of the tangent stiffness (see `gram`), or of that under a given stress."""
        ...


class Energy(Protocol):
    """A part of the elastic energy."""

    def at(self, state: Array) -> Stressed:
        """The same at a state (n,)."""
        ...


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

    def terms(self, stress: Array | None = None) -> Terms:
        """Fields and coefficients of the tangent stiffness, under another stress if one is given."""
        stress = self.stress if stress is None else stress
        stiff = np.tensordot(self.energy.modulus, self.variation, 1)
        material = np.einsum("sgcp,shcp->ghcp", self.variation, stiff, optimize=True)
        return ((self.energy.fields, material + np.tensordot(self.energy.products.transpose(1, 2, 0), stress, 1)),)


def of_layers(fields: Fields, layers: tuple[Layer, ...], stiffness: Array) -> Quadratic:
    """Make the energy of layers of a stiffness (nstrain, nstrain) in Pa over the gradient fields."""
    modulus = np.asarray(np.kron(np.diag([layer.weight for layer in layers]), stiffness))
    linear = np.concatenate([strain_matrix(layer) for layer in layers])
    return Quadratic(fields, modulus, linear, np.concatenate([products(layer) for layer in layers]))
