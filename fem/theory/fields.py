"""Scalar fields on a mesh as tables at quadrature points, and the quadratic forms they make.

Every operator of the plate is a form sum_ij integral c_ij f_i f_j over fields f_i that are linear in the
unknowns: the physics is in the small matrix c, the discretisation in the tables. `gram` joins the two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fem.linalg import Array, Ints

if TYPE_CHECKING:
    from scipy.sparse import csc_array

CLAMPED = -1
"""Number of an unknown that is held at zero."""


@dataclass(frozen=True, eq=False)
class Block:
    """Fields that depend on the same unknowns.

    Attributes:
        table: (ncell, npoint, nfield, ndof), the value of each field for a unit of each unknown of the cell.
        dofs: (ncell, ndof), the numbers of these unknowns; `CLAMPED` where they are held.
    """

    table: Array
    dofs: Ints

    @property
    def size(self) -> int:
        """Number of fields."""
        return int(self.table.shape[2])


@dataclass(frozen=True, eq=False)
class Fields:
    """An ordered set of scalar fields, block after block, with the integration weights of their points.

    Attributes:
        dx: (ncell, npoint), in m² (plates) or m³ (solids).
        dofs: number of unknowns that are free.
    """

    blocks: tuple[Block, ...]
    dx: Array
    dofs: int

    @property
    def size(self) -> int:
        """Number of fields."""
        return sum(block.size for block in self.blocks)

    def evaluate(self, vector: Array) -> Array:
        """Values of all fields at the points, (nfield, ncell, npoint, ...), for unknowns (dofs, ...)."""
        padded = np.concatenate([vector, np.zeros((1, *vector.shape[1:]))])
        columns = padded.reshape(len(padded), -1)
        values = [_at_points(block.table, columns[block.dofs]) for block in self.blocks]
        return np.concatenate(values).reshape(-1, *self.dx.shape, *vector.shape[1:])

    def load(self, density: Array) -> Array:
        """Vector (dofs,) of sum_i integral density_i f_i, with density (nfield, ncell, npoint)."""
        total = np.zeros(self.dofs + 1)
        start = 0
        for block in self.blocks:
            part = density[start : start + block.size] * self.dx
            start += block.size
            cellwise = np.einsum("cpfd,fcp->cd", block.table, part, optimize=True)
            total += np.bincount(block.dofs.ravel() % (self.dofs + 1), cellwise.ravel(), self.dofs + 1)
        return total[:-1]


def gram(*terms: tuple[Fields, Array]) -> csc_array:
    """Sparse matrix (dofs, dofs) of the sum over terms of integral c_ij f_i f_j.

    terms: pairs of fields and coefficients c, symmetric (nfield, nfield) or pointwise (nfield, nfield, ncell, npoint),
    or skew (nfield, nfield). Pairs of blocks whose coefficients vanish are not computed and leave no entries.
    """
    from scipy.sparse import coo_array

    parts: dict[tuple[int, int, float], tuple[Block, Block, Array]] = {}
    for fields, coefficients in terms:
        for left, right, mirrored, cells in _pairs(fields, coefficients):
            same = id(left.dofs), id(right.dofs), mirrored
            parts[same] = left, right, parts[same][2] + cells if same in parts else cells
    n = terms[0][0].dofs
    if not parts:
        return coo_array((n, n)).tocsc()
    entries = [_entries(*part) for part in parts.values()]
    images = [(col, row, sign * value) for (row, col, value), (_, _, sign) in zip(entries, parts, strict=True) if sign]
    row, col, value = (np.concatenate(column) for column in zip(*entries, *images, strict=True))
    return coo_array((value, (row, col)), shape=(n, n)).tocsc()


def _pairs(fields: Fields, coefficients: Array) -> Iterator[tuple[Block, Block, float, Array]]:
    """Pairs of blocks, either way round once, whose coefficients do not vanish.

    With each come the sign of its mirror image, 0 if it has none, and the cell matrices (ncell, ndof left, ndof right);
    those of equal tables and coefficients are computed once.
    """
    starts = np.cumsum([0, *(block.size for block in fields.blocks)])
    sign = -1.0 if coefficients.ndim == 2 and np.array_equal(coefficients.T, -coefficients) else 1.0
    known: dict[tuple[int, int, bytes], Array] = {}
    for a, left in enumerate(fields.blocks):
        for b, right in enumerate(fields.blocks[a:], a):
            c = coefficients[starts[a] : starts[a + 1], starts[b] : starts[b + 1]]
            if not c.any():
                continue
            alike = id(left.table), id(right.table), c.tobytes()
            if alike not in known:
                known[alike] = _cell_matrices(left.table, c, right.table, fields.dx)
            yield left, right, sign if a != b else 0.0, known[alike]


def _entries(left: Block, right: Block, cells: Array) -> tuple[NDArray[np.int32], NDArray[np.int32], Array]:
    """Rows, columns and values of cell matrices, but for unknowns that are held."""
    row = np.broadcast_to(left.dofs.astype(np.int32)[:, :, None], cells.shape)
    col = np.broadcast_to(right.dofs.astype(np.int32)[:, None], cells.shape)
    free = (row != CLAMPED) & (col != CLAMPED)
    return row[free], col[free], cells[free]


def _cell_matrices(left: Array, c: Array, right: Array, dx: Array) -> Array:
    """Cell matrices (ncell, ndof left, ndof right)."""
    ncell, npoint, nleft, ndof = left.shape
    weighted = (
        np.moveaxis(np.broadcast_to(c, (*c.shape[:2], *dx.shape)), (0, 1), (2, 3)) @ right
        if c.ndim == 4
        else np.matmul(c, right)
    ) * dx[:, :, None, None]
    flat = left.reshape(ncell, npoint * nleft, ndof)
    return np.asarray(np.matmul(flat.transpose(0, 2, 1), weighted.reshape(ncell, npoint * nleft, right.shape[3])))


def _at_points(table: Array, unknowns: Array) -> Array:
    """Fields (nfield, ncell, npoint, k) of a table for unknowns (ncell, ndof, k)."""
    ncell, npoint, nfield, ndof = table.shape
    values = np.matmul(table.reshape(ncell, npoint * nfield, ndof), unknowns)
    return np.moveaxis(values.reshape(ncell, npoint, nfield, -1), 2, 0)
