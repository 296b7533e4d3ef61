"""Mode shapes as displacements, at mesh vertices and between them, for pictures."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.assembly import Operators, motion_rows
from fem.linalg import Array, Ints
from fem.meshes.thickness import corner_shapes
from fem.modal_model import ModalModel, ModesAtSpeed
from fem.reduction.modal import drawn_rows
from fem.sweep.campbell import Campbell


@dataclass(frozen=True, eq=False)
class Finer:
    """A mesh of parts of the cells, and shapes on it.

    Attributes:
        mesh: a `skfem` mesh in the plane.
        lines: its edges that lie on those of the plate's cells, (k, 2).
        displacement: of its vertices, (count, nvertices, 3), as of :func:`fem.displacement`.
    """

    mesh: Any
    lines: Ints
    displacement: Array


@dataclass(frozen=True, eq=False)
class _Grid:
    """A cell in parts: reference points (n, 2), numbers of those along each side, from a corner, and of its parts."""

    points: Array
    sides: list[list[int]]
    parts: Ints


def between(operators: Operators, shapes: Array, parts: int) -> Finer:
    """Displacements at the corners of parts of the cells, each side in so many; shapes: unknowns (n, count).

    The elements' own functions between the vertices. Where an element lets its neighbours differ, their mean.
    """
    mesh = operators.model.mesh
    grid = _quadrilateral(parts) if mesh.t.shape[0] == 4 else _triangle(parts)
    numbers = _numbers(mesh, grid)
    x, y = grid.points.T
    corners = np.ascontiguousarray(corner_shapes(x, y, len(grid.sides)).T)
    points = np.zeros((2, int(numbers.max()) + 1))
    points[:, numbers] = np.einsum("pk,dkc->dcp", corners, mesh.p[:, mesh.t])
    sub = np.concatenate([numbers[:, part] for part in grid.parts])
    return Finer(type(mesh)(points, sub.T), _lines(operators, grid, numbers), _moved(operators, shapes, grid, numbers))


def _quadrilateral(parts: int) -> _Grid:
    at = np.arange((parts + 1) ** 2).reshape(parts + 1, parts + 1)  # along x, along y
    i, j = np.divmod(at.ravel(), parts + 1)
    sides = [at[:, 0], at[-1, :], at[::-1, -1], at[0, ::-1]]
    cells = [at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]]
    parts_of = np.stack([each.ravel() for each in cells], axis=1)
    return _Grid(np.stack([i, j], axis=1) / parts, [side.tolist() for side in sides], parts_of)


def _triangle(parts: int) -> _Grid:
    places = [(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    at = {place: number for number, place in enumerate(places)}
    run = range(parts + 1)
    sides = [[at[k, 0] for k in run], [at[parts - k, k] for k in run], [at[0, parts - k] for k in run]]
    up = [(at[i, j], at[i + 1, j], at[i, j + 1]) for i, j in places if i + j < parts]
    down = [(at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i, j in places if i + j < parts - 1]
    return _Grid(np.array(places) / parts, sides, np.array(up + down))


def _numbers(mesh: Any, grid: _Grid) -> Ints:
    """Numbers (cells, n) of the points of every cell: the mesh's vertices, then points on sides, then inner ones."""
    cells, per_side = np.asarray(mesh.t.T), len(grid.sides[0]) - 2
    numbers = np.full((len(cells), len(grid.points)), -1)
    along = np.arange(per_side)
    for k, (chain, side) in enumerate(zip(grid.sides, mesh.t2f, strict=True)):
        forward = cells[:, k] < np.roll(cells, -1, axis=1)[:, k]
        places = np.where(forward[:, None], along, along[::-1])
        numbers[:, chain[1:-1]] = mesh.p.shape[1] + side[:, None] * per_side + places
        numbers[:, chain[0]] = cells[:, k]
    inner = np.flatnonzero(numbers[0] < 0)
    begun = mesh.p.shape[1] + mesh.facets.shape[1] * per_side
    numbers[:, inner] = begun + np.arange(len(cells) * len(inner)).reshape(len(cells), -1)
    return numbers


def _lines(operators: Operators, grid: _Grid, numbers: Ints) -> Ints:
    """Edges along the sides of the plate's own cells, which a model may have split."""
    mesh = operators.model.mesh
    own, every = (np.sort(each.facets, axis=0).T.tolist() for each in (operators.plate.mesh, mesh))
    known = set(map(tuple, own))
    drawn = np.array([tuple(ends) in known for ends in every])
    chains = [numbers[drawn[side]][:, chain] for chain, side in zip(grid.sides, mesh.t2f, strict=True)]
    lines = [np.stack([chain[:, :-1], chain[:, 1:]], axis=2).reshape(-1, 2) for chain in chains]
    return np.asarray(np.unique(np.sort(np.concatenate(lines), axis=1), axis=0))


def _moved(operators: Operators, shapes: Array, grid: _Grid, numbers: Ints) -> Array:
    """Displacements (count, points, 3), means of what the cells say."""
    from scipy.sparse import coo_array

    padded = np.concatenate([shapes, np.zeros((1, shapes.shape[1]))])
    columns = padded.view(np.float64)  # of complex shapes real and imaginary parts
    count = int(numbers.max()) + 1
    moved = np.zeros((count, 3, columns.shape[1]))
    for k, space in enumerate(operators.model.spaces):
        weights = space.weights(grid.points.T)[: len(numbers)]  # (cells, places, functions); of bricks the first
        dofs = space.dofs[: len(numbers), None]
        rows, dofs = (np.broadcast_to(each, weights.shape) for each in (numbers[:, :, None], dofs))
        total = coo_array(
            (weights.ravel(), (rows.ravel(), dofs.ravel() % len(padded))), shape=(count, len(padded))
        ).tocsr()
        moved[:, k] = np.asarray(total @ columns)
    times = np.bincount(numbers.ravel(), minlength=count)
    return np.moveaxis((moved / times[:, None, None]).view(padded.dtype), -1, 0)


def displacement(operators: Operators, shapes: Array) -> Array:
    """Displacements u, v and w of the mid-surface at the mesh's vertices.

    Args:
        operators: of the plate.
        shapes: unknowns of one shape (n,) or of several (n, count).

    Returns:
        Shape (nvertices, 3), or (count, nvertices, 3): in m if a shape is a static displacement, per unit of the shape
        otherwise.

    Raises:
        ValueError: another number of unknowns.
    """
    if np.ndim(shapes) not in (1, 2) or len(shapes) != operators.model.dofs:
        n = operators.model.dofs
        raise ValueError(f"shapes must be ({n},) or ({n}, count), got {np.shape(shapes)}")
    moved = between(operators, shapes.reshape(len(shapes), -1), 1).displacement
    moved = moved[:, : operators.plate.mesh.p.shape[1]]  # a model may split cells; it adds vertices at the end
    return moved[0] if shapes.ndim == 1 else moved


def modal_model(
    operators: Operators,
    diagram: Campbell,
    numbers: Sequence[int],
    errors: Sequence[Array | None],
    at: tuple[float, float] | None = None,
) -> ModalModel:
    """A plate as a structure known by its modes: its mid-surface in space, the plate's axes, with rotations.

    Args:
        operators: the plate's matrices, without Coriolis forces.
        diagram: its modes over speed.
        numbers: which speeds of it, ascending.
        errors: relative errors of the frequencies at each, (modes,), as many as there are; None: not known.
        at: a place that becomes a node, where the damper sits.

    Raises:
        ValueError: the modes are complex.
    """
    if operators.gyroscopic is not None:
        raise ValueError("the modes are complex")
    mesh, rotor = operators.plate.mesh, operators.rotor
    places = np.asarray(mesh.p.T)
    if at is not None and np.linalg.norm(places - at, axis=1).min() > 0.0:
        places = np.vstack([places, at])
    rows = motion_rows(operators.model, places)
    drawn = drawn_rows(operators)
    speeds = []
    for number, error in zip(numbers, errors, strict=True):
        unknowns = diagram.shapes(number)[:, : None if error is None else error.size]
        moved, along, across = ((each @ unknowns).reshape(len(places), 3, -1) for each in rows)
        turned = np.stack([across[:, 2], -along[:, 2], 0.5 * (along[:, 1] - across[:, 0])], axis=1)
        speeds.append(
            ModesAtSpeed(
                float(diagram.omega[number]),
                np.asarray(diagram.frequencies_hz[number, : unknowns.shape[1]]),
                np.ascontiguousarray(moved.transpose(2, 0, 1)),
                rotations=np.ascontiguousarray(turned.transpose(2, 0, 1)),
                errors=error,
                drawn=np.asarray((drawn @ unknowns).T),
            )
        )
    points = np.column_stack([places, np.zeros(len(places))])
    root = np.array([float(mesh.p[0].min()), 0.0, 0.0])
    kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
    cells = ((kind, np.asarray(mesh.t.T, dtype=np.int64)),)
    return ModalModel(points, tuple(speeds), rotor.axis, root - rotor.hub_radius * rotor.outwards, cells)
