"""Shapes as displacements of the mesh's vertices, for pictures and files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]


def displacement(operators: Operators, shapes: Array) -> Array:
    """Displacements of the mid-surface at the mesh's vertices, columns u, v, w.

    shapes: unknowns (n,), giving (nvertices, 3), or of several shapes (n, count), giving (count, nvertices, 3). In m if
    a shape is a static displacement, per unit of the shape otherwise.

    Raises:
        ValueError: for another number of unknowns.
    """
    if np.ndim(shapes) not in (1, 2) or len(shapes) != operators.model.dofs:
        n = operators.model.dofs
        raise ValueError(f"shapes must be ({n},) or ({n}, count), got {np.shape(shapes)}")
    mesh = operators.model.mesh
    padded = np.concatenate([shapes, np.zeros((1, *shapes.shape[1:]))])
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]] if mesh.t.shape[0] == 4 else [[0, 0], [1, 0], [0, 1]])
    cells = np.arange(mesh.t.shape[1])
    moved = np.zeros((mesh.p.shape[1], 3, *shapes.shape[1:]), dtype=padded.dtype)
    for k, space in enumerate(operators.model.spaces):
        for j, corner in enumerate(corners):
            at = np.repeat(corner[:, None].astype(float), cells.size, axis=1)
            weights, dofs = space.probe(cells, at)
            moved[mesh.t[j], k] = np.einsum("cd,cd...->c...", weights, padded[dofs])
    moved = moved[: operators.plate.mesh.p.shape[1]]  # a model may split cells; it adds vertices at the end
    return moved if shapes.ndim == 1 else np.moveaxis(moved, -1, 0)
