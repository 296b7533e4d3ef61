"""Shapes as displacements of the mesh's vertices, for pictures and files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators import Operators

    Array = NDArray[np.float64]


def displacement(operators: Operators, shape: Array) -> Array:
    """Displacement (nvertices, 3) of the mid-surface at the mesh's vertices, for unknowns (n,).

    Columns u, v, w; in m if the shape is a static displacement, per unit of the shape otherwise.
    """
    mesh = operators.model.mesh
    padded = np.append(shape, 0.0)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]] if mesh.t.shape[0] == 4 else [[0, 0], [1, 0], [0, 1]])
    cells = np.arange(mesh.t.shape[1])
    moved = np.zeros((mesh.p.shape[1], 3), dtype=padded.dtype)
    for k, space in enumerate(operators.model.spaces):
        for j, corner in enumerate(corners):
            at = np.repeat(corner[:, None].astype(float), cells.size, axis=1)
            weights, dofs = space.probe(cells, at)
            moved[mesh.t[j], k] = (weights * padded[dofs]).sum(axis=1)
    return moved
