"""Transverse shear of a plate whose director turns far (`fem.theory.director`): r,a . d, in an assumed shear.

As at small rotations (`fem.theory.assumed_shear`), the covariant components are sampled at a few places of a cell, and
what is interpolated from them carries the energy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.theory.fields import Block, Fields

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from fem.theory.strains import Terms

    Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shear:
    """Transverse shear energy of an assumed shear.

    Attributes:
        samples: the fields u, v and w by the two reference coordinates and theta_x, theta_y, where the shear is
            sampled.
        sides: X, Y by the reference coordinates there, (2, 2, ncell, nsample).
        reduction: from the samples' covariant shear to the shear at the points, (ncell, npoint, 2, nsample, 2).
        modulus: (ncell, npoint) in N/m, dx in m².
    """

    samples: Fields
    sides: Array
    reduction: Array
    modulus: Array
    dx: Array

    def at(self, state: Array) -> ShearStress:
        """The energy at a state (n,); not a number where a director would turn beyond 90 degrees."""
        values = self.samples.evaluate(state)
        with np.errstate(invalid="ignore"):
            height = np.sqrt(1.0 - values[6] ** 2 - values[7] ** 2)
        director = np.stack([-values[6], -values[7], height])
        edges = values[:6].reshape(3, 2, *height.shape).copy()
        edges[:2] += self.sides
        covariant = np.einsum("kmcs,kcs->csm", edges, director)
        return ShearStress(self, director, edges, self.felt(covariant))

    def felt(self, covariant: Array) -> Array:
        """The energy's derivative by the samples' covariant shears (ncell, nsample, 2): (2, ncell, nsample)."""
        ncell, npoint = self.dx.shape
        shear = self._reduction @ covariant.reshape(ncell, -1, 1)
        stress = (self.modulus * self.dx)[:, :, None] * shear.reshape(ncell, npoint, 2)
        felt = stress.reshape(ncell, 1, -1) @ self._reduction
        return np.asarray(felt.reshape(ncell, -1, 2).transpose(2, 0, 1))

    @property
    def _reduction(self) -> Array:
        ncell, npoint, _, nsample, _ = self.reduction.shape
        return self.reduction.reshape(ncell, 2 * npoint, 2 * nsample)


@dataclass(frozen=True, eq=False)
class ShearStress:
    """A shear energy at a state.

    Attributes:
        director: (3, ncell, nsample).
        edges: r by the reference coordinates, (3, 2, ncell, nsample).
        felt: the energy's derivative by the samples' covariant shears, (2, ncell, nsample).
    """

    energy: Shear
    director: Array
    edges: Array
    felt: Array

    def force(self) -> Array:
        """The internal force (n,)."""
        return self.energy.samples.load(np.einsum("mfcs,mcs->fcs", self._variation, self.felt))

    def ahead(self, step: Array) -> Array:
        """What the samples would feel after a step (n,), to first order: (2, ncell, nsample)."""
        moved = np.einsum("mfcs,fcs->csm", self._variation, self.energy.samples.evaluate(step))
        return self.felt + self.energy.felt(moved)

    def terms(self, stress: Array | None = None) -> Terms:
        """Fields and coefficients of the tangent stiffness, where the samples feel something else if that is given."""
        samples = self.energy.samples
        blocks = tuple(Block(t, block.dofs) for t, block in zip(self._tables(), samples.blocks, strict=True))
        fields = Fields(blocks, self.energy.dx, samples.dofs)
        material = np.tile(np.eye(2), 2 * [len(blocks)])[:, :, None, None] * self.energy.modulus
        return (fields, material), (samples, self._curvature(self.felt if stress is None else stress))

    @property
    def _variation(self) -> Array:
        """How the covariant shears vary with the samples' fields, (2, 8, ncell, nsample)."""
        found = np.zeros((2, 8, *self.felt.shape[1:]))
        for m in range(2):
            found[m, m:6:2] = self.director
            found[m, 6:] = self.edges[2, m] * self._slope - self.edges[:2, m]
        return found

    @property
    def _slope(self) -> Array:
        """How the director's height varies with the turns, (2, ncell, nsample)."""
        return np.asarray(self.director[:2] / self.director[2])

    def _tables(self) -> Iterator[Array]:
        """What each block's unknowns add to the shear at the points, for a unit of each: (ncell, npoint, 2, ndof)."""
        ncell, npoint = self.energy.dx.shape
        variation, start = self._variation.transpose(2, 3, 0, 1), 0
        for block in self.energy.samples.blocks:
            part = variation[..., start : start + block.size] @ block.table
            shear = self.energy._reduction @ part.reshape(ncell, -1, part.shape[-1])
            yield shear.reshape(ncell, npoint, 2, -1)
            start += block.size

    def _curvature(self, felt: Array) -> Array:
        """What the shears' second derivatives carry where the samples feel (2, ncell, nsample): (8, 8, ...)."""
        total = np.zeros((8, 8, *felt.shape[1:]))
        for m, part in enumerate(felt):
            total[m, 6] = total[2 + m, 7] = -part
            total[4 + m, 6:] = part * self._slope
        total += total.transpose(1, 0, 2, 3)
        unit = np.eye(2)[:, :, None, None] / self.director[2]
        bend = unit + self._slope[:, None] * self._slope[None] / self.director[2]
        total[6:, 6:] -= (felt * self.edges[2]).sum(axis=0) * bend
        return total
