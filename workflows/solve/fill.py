"""What the factor of a plate's stiffness will have, told by its mesh before there is a stiffness.

The unknowns of a corner, an edge or a cell, of bricks those at one height, share their neighbours, so that they are
eliminated together: the factor of the small matrix that has one for each is the pattern of the whole in blocks
(quotient graph; George and Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, ch. 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csc_array

_PRODUCTS = 130.0
"""Products that take as long as what is done once for each entry of a factor."""


_AT_THE_ROOT = 1e-6
"""Part of the length within which a corner lies on the clamped edge."""


@dataclass(frozen=True)
class Fill:
    """Unknowns of a mesh; entries of its factor, and the work that this takes, in products."""

    unknowns: float
    entries: float
    work: float

    def __add__(self, other: Fill) -> Fill:
        return Fill(self.unknowns + other.unknowns, self.entries + other.entries, self.work + other.work)


NOTHING = Fill(0.0, 0.0, 0.0)


def of_each(model: str, mesh: Any) -> tuple[Any, tuple[int, int, int]]:
    """The mesh as a theory takes it, and the unknowns of each of its corners, edges and cells."""
    from fem.theory.kirchhoff import is_rectangles
    from fem.theory.solid import quadrilaterals

    name, quads = model.partition("/")[0], mesh.t.shape[0] == 4
    if name == "kirchhoff" and quads and not is_rectangles(mesh):
        mesh, quads = mesh.to_meshtri(), False
    if name == "kirchhoff":
        return mesh, (6, 2, 2) if quads else (8, 3, 0)
    if name == "solid":
        column = 3 * (2 * _layers(model) + 1)
        return quadrilaterals(mesh), (column, column, column)
    return mesh, (5, 5, 5 if quads else 2)


def fill(model: str, mesh: Any) -> Fill:
    """What the factor of a stiffness on a mesh has, in a theory, without what is clamped."""
    from scipy.sparse import csc_array, kron

    from fem.linalg.lanczos import factorise

    mesh, each = of_each(model, mesh)
    corners, edges, cells = mesh.p.shape[1], mesh.facets.shape[1], mesh.t.shape[1]
    nodes = np.vstack([mesh.t, corners + mesh.t2f, corners + edges + np.arange(cells)])
    rooted = mesh.p[0] <= mesh.p[0].min() + _AT_THE_ROOT * np.ptp(mesh.p[0])
    clamped = np.concatenate([rooted, rooted[mesh.facets].all(axis=0), np.zeros(cells, bool)])
    weights = np.repeat(np.array(each, float), (corners, edges, cells))
    free = np.flatnonzero(~clamped & (weights > 0))
    touched = csc_array(
        (np.ones(nodes.size), (np.broadcast_to(np.arange(cells), nodes.shape).ravel(), nodes.ravel())),
        shape=(cells, clamped.size),
    )
    upwards = _upwards(_layers(model))
    touched, heights = kron(touched[:, free], upwards).tocsc(), upwards.shape[1]
    weights = np.repeat(weights[free] / heights, heights)
    graph = (touched.T @ touched).tocsc()
    graph.data[:] = -1.0
    graph.setdiag(float(weights.size))
    factor = factorise(graph).lu
    eliminated = np.empty(weights.size)
    eliminated[factor.perm_c] = weights
    pattern = factor.L
    pattern.data[:] = 1.0
    long = pattern.T @ eliminated - 0.5 * eliminated
    entries = float(eliminated @ long)
    return Fill(float(weights.sum()), entries, float(eliminated @ long**2) + _PRODUCTS * entries)


def _layers(model: str) -> int:
    """Of bricks through the thickness; 0 where there are none."""
    name, _, layers = model.partition("/")
    return int(layers or 2) if name == "solid" else 0


def _upwards(layers: int) -> csc_array:
    """Which of its heights, three of them, each layer touches; one of one where there are no layers."""
    from scipy.sparse import csc_array

    if layers == 0:
        return csc_array(np.ones((1, 1)))
    layer, own = np.repeat(np.arange(layers), 3), (2 * np.arange(layers)[:, None] + np.arange(3)).ravel()
    return csc_array((np.ones(own.size), (layer, own)), shape=(layers, 2 * layers + 1))
