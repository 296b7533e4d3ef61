"""Assumed shear: the transverse shear strain interpolated in an edge space, so that thin plates do not lock.

The shear strain g = grad w - theta of the interpolated fields cannot vanish on every cell when the plate is
thin, and a plain element answers by not bending at all. A MITC element (mixed interpolation of tensorial
components) replaces g by R g, where R samples the covariant components of g at a few places and interpolates
them in a space of Nédélec type with continuous tangents: R grad w = grad w, while R theta has just the
freedom that bending needs. R is the same for every cell when it is written in reference coordinates.

Sources: Bathe and Dvorkin, Int. J. Numer. Meth. Engng 21 (1985) 367; Brezzi, Bathe and Fortin, ibid. 28
(1989) 1787 (the triangle is their MITC7); Bucalem and Bathe, ibid. 36 (1993) 3729 (the tying points of the
quadrilateral).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GAUSS2 = np.array([0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0)])
"""Two-point Gauss abscissae on [0, 1]."""


@dataclass(frozen=True, eq=False)
class Tying:
    """A reduction on the reference cell.

    Attributes:
        points: (2, nsample), where covariant shear is sampled.
        functionals: (n, nsample, 2), the weights of its two components in each functional.
        space: maps reference points (2, m) to the n spanning fields of the edge space there, (n, 2, m).
    """

    points: Array
    functionals: Array
    space: Callable[[Array], Array]

    def reduction(self, points: Array) -> Array:
        """Return R, (m, 2, nsample, 2): reduced covariant shear at points (2, m) from the samples."""
        unisolvence = np.einsum("fsb,kbs->fk", self.functionals, self.space(self.points))
        dual = np.linalg.solve(unisolvence.T, self.space(points).reshape(len(unisolvence), -1))
        nodal = dual.reshape(len(unisolvence), 2, -1)
        return np.asarray(np.einsum("fam,fsb->masb", nodal, self.functionals))


def quadrilateral() -> Tying:
    """Q12 x Q21 on the unit square: two Gauss points on each of three lines a direction."""
    lines = np.array([0.0, 0.5, 1.0])
    along, across = (a.ravel() for a in np.meshgrid(GAUSS2, lines, indexing="ij"))
    points = np.hstack([np.vstack([along, across]), np.vstack([across, along])])
    functionals = np.zeros((12, 12, 2))
    functionals[np.arange(6), np.arange(6), 0] = 1.0
    functionals[np.arange(6, 12), np.arange(6, 12), 1] = 1.0

    def space(at: Array) -> Array:
        x, y = at
        zero = np.zeros_like(x)
        first = [x**i * y**j for i in range(2) for j in range(3)]
        second = [y**i * x**j for i in range(2) for j in range(3)]
        return np.array([[p, zero] for p in first] + [[zero, p] for p in second])

    return Tying(points, functionals, space)


def triangle() -> Tying:
    """Second-order Nédélec space of the first kind: two Gauss points an edge and the cell's mean."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    edges = [(0, 1), (1, 2), (0, 2)]
    inner, weights = get_quadrature(RefTri, 5)
    on_edges = [corners[a] + s * (corners[b] - corners[a]) for a, b in edges for s in GAUSS2]
    points = np.hstack([np.array(on_edges).T, inner])
    functionals = np.zeros((8, points.shape[1], 2))
    for k, (a, b) in enumerate(edges):
        functionals[2 * k, 2 * k] = functionals[2 * k + 1, 2 * k + 1] = corners[b] - corners[a]
    functionals[6, 6:, 0] = functionals[7, 6:, 1] = weights

    def space(at: Array) -> Array:
        x, y = at
        zero, one = np.zeros_like(x), np.ones_like(x)
        linear = [[p, zero] for p in (one, x, y)] + [[zero, p] for p in (one, x, y)]
        return np.array([*linear, [-x * y, x * x], [-y * y, x * y]])

    return Tying(points, functionals, space)
