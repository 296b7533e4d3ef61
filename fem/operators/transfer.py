"""A plate's displacement on one mesh as a start on another one of the same planform."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.linalg.lanczos import factorise
from fem.meshes.thickness import of
from fem.theory.fields import gram
from fem.theory.kind import Kind, kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]

FIELDS = ((0, ()), (1, ()), (2, ()), (2, (0,)), (2, (1,)))
"""u, v, w and the slopes of w, which the rotations of a thin plate are."""

AT_ONCE = 500
"""Points looked up together: neighbours, which have few cells to choose from."""


def transfer(state: Array, known: Operators, asked: Operators) -> Array | None:
    """The displacement (n,) on the mesh asked for nearest to one known on another.

    Nearest in the mean square of u, v, w, and of the rotations times the thickness. None for solids, and where a point
    is not found in the known mesh.
    """
    model = asked.model
    if kind(model.theory) is Kind.SOLID:
        return None
    points = model.points[:2].reshape(2, -1)
    padded = np.append(state, 0.0)  # the clamped unknowns, numbered -1
    try:
        pieces = [_fields(padded, known, points[:, k : k + AT_ONCE]) for k in range(0, points.shape[1], AT_ONCE)]
    except Exception:  # scikit-fem's search tolerates next to no rounding, and raises what it likes
        return None
    values = np.concatenate(pieces, axis=1).reshape(len(FIELDS), *model.points.shape[1:])
    thickness = of(asked.plate.thickness, model.points[:2])
    weigh = np.ones(len(FIELDS))
    if isinstance(thickness, float):
        weigh[3:] = thickness**2
    else:  # the model's rotations are in parts of it (`fem.theory.sections`)
        values[3:] *= thickness
    matrix = gram((model.displacement, np.diag(weigh)))
    return factorise(matrix).solve(model.displacement.load(weigh[:, None, None] * values))


def _fields(padded: Array, known: Operators, points: Array) -> Array:
    """FIELDS (5, k) of a state, with a zero behind it, at points (2, k) in m."""
    mesh = known.model.mesh
    mapping = mesh.mapping()
    cells = mesh.element_finder(mapping=mapping)(*points)
    reference = mapping.invF(points[:, :, None], tind=cells)[:, :, 0]
    values = []
    for number, derivative in FIELDS:
        weights, unknowns = known.model.spaces[number].probe(cells, reference, derivative)
        values.append((weights * padded[unknowns]).sum(axis=1))
    return np.array(values)
