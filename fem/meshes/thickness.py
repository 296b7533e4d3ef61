"""Thickness that varies over the planform, h(x, y): a polynomial, a table, or values at a mesh's points.

The mid-surface stays flat: the plate lies between z = -h/2 and h/2. What is integrated over the thickness takes h where
it is integrated over the planform. Plate theories take the faces as if they were parallel, and so leave out the square
of their slope; a solid has them as they are.
"""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from fem.linalg import Array, Ints
from fem.meshes.planform import TOLERANCE, locate, outside, position, twice_areas

LATTICE = 9
"""Points along a cell's side at which a thickness is looked at for its least and greatest."""

SLOPE = 0.7
"""Plate theories understate frequencies by up to this times the square of the faces' slope.

Wedges of 20 to 5 and 40 to 10 mm over 0.1 and 0.2 m, 0.08 m wide, nu = 0, against bricks: 0.4 to 0.7 in the six lowest
modes.
"""


NEWTON = 30
"""Steps of Newton's method to a place in a quadrilateral; it takes some six."""


@dataclass(frozen=True)
class Polynomial:
    """h = sum of coefficients[i][j] x^i y^j, in m^(1 - i - j); x and y are those of the mesh."""

    coefficients: tuple[tuple[float, ...], ...]

    def at(self, points: Array) -> Array:
        """The thickness (ncell, npoint)."""
        width = max(map(len, self.coefficients))
        table = np.array([[*row, *[0.0] * (width - len(row))] for row in self.coefficients])
        return np.asarray(np.polynomial.polynomial.polyval2d(points[0], points[1], table))

    def near(self, place: tuple[float, float]) -> float:
        """The thickness at a place."""
        return float(self.at(np.asarray(place)))


@dataclass(frozen=True)
class Bilinear:
    """values[i][j] in m at (x[i], y[j]) in m, both ascending, and bilinear between them.

    With one y, or one x, it is the same all along it.

    Raises:
        ValueError: for numbers that do not fit together.
    """

    x: tuple[float, ...]
    y: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        if len(self.values) != len(self.x) or any(len(row) != len(self.y) for row in self.values):
            raise ValueError(f"values must be {len(self.x)} rows, one for each x, of {len(self.y)} numbers")
        for name in ("x", "y"):
            if not (np.diff(getattr(self, name)) > 0.0).all():
                raise ValueError(f"{name} must be in ascending order, got {getattr(self, name)!r}")

    def at(self, points: Array) -> Array:
        """The thickness (ncell, npoint); ValueError outside the table."""
        table = np.array(self.values)
        (i, a), (j, b) = (self._between(name, p) for name, p in zip("xy", points, strict=True))
        rows, columns = (np.minimum(k + 1, n - 1) for k, n in zip((i, j), table.shape, strict=True))
        near = (1.0 - b) * table[i, j] + b * table[i, columns]
        far = (1.0 - b) * table[rows, j] + b * table[rows, columns]
        return np.asarray((1.0 - a) * near + a * far)

    def near(self, place: tuple[float, float]) -> float:
        """The thickness at a place."""
        return float(self.at(np.asarray(place)))

    def _between(self, name: str, values: Array) -> tuple[Ints, Array]:
        """The interval of a coordinate that values lie in, and the part of it before them."""
        knots = np.array(getattr(self, name))
        if knots.size == 1:
            return np.zeros(values.shape, dtype=np.int64), np.zeros(values.shape)
        margin = TOLERANCE * np.ptp(knots)
        if values.min() < knots[0] - margin or values.max() > knots[-1] + margin:
            raise ValueError(
                f"the table of the thickness has {name} from {knots[0]:g} to {knots[-1]:g} m, and the plate"
                f" from {values.min():g} to {values.max():g} m"
            )
        k = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, knots.size - 2)
        return k, np.clip((values - knots[k]) / (knots[k + 1] - knots[k]), 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Nodal:
    """Values (npoint,) in m at a mesh's points, and linear (triangles) or bilinear (quadrilaterals) in its cells.

    The plate's mesh is that mesh, or one that splits each of its cells alike, cell number k in those of number k, k +
    ncell, k + 2 ncell and so on, as scikit-fem does; the thickness stays the same function.

    Raises:
        ValueError: for values that do not fit the mesh.
    """

    mesh: Any
    values: Array

    def __post_init__(self) -> None:
        if self.values.shape != self.mesh.p.shape[1:]:
            raise ValueError(f"expected {self.mesh.p.shape[1]} values, one for each point, got {self.values.shape}")

    def at(self, points: Array) -> Array:
        """The thickness (ncell, npoint); ValueError for cells that are not in those of the mesh."""
        cells = np.arange(points.shape[1]) % self.mesh.t.shape[1]
        x, y = _reference(self.mesh.p[:, self.mesh.t[:, cells]], points)
        if not outside(x, y, self.mesh.t.shape[0]).max() <= TOLERANCE:
            raise ValueError("the cells of the plate's mesh do not lie within those of the thickness")
        corners = self.values[self.mesh.t[:, cells]][:, :, None]
        return np.asarray((corner_shapes(x, y, len(corners)) * corners).sum(axis=0))

    def near(self, place: tuple[float, float]) -> float:
        """The thickness at a place."""
        cell, (x, y) = locate(self.mesh, place)
        return float(corner_shapes(x, y, self.mesh.t.shape[0]) @ self.values[self.mesh.t[:, cell]])


Profile: TypeAlias = Polynomial | Bilinear | Nodal
"""A thickness over the planform: `at` points of the plate's mesh, cell by cell, and `near` one place."""


def of(thickness: float | Profile, points: Array) -> float | Array:
    """A thickness at points (2, ncell, npoint) of a plate's mesh: itself, or (ncell, npoint). ValueError below 0."""
    if isinstance(thickness, float | int):
        return float(thickness)
    values = thickness.at(points)
    if not (values > 0.0).all():  # not a number, too
        worst = int(np.argmin(np.nan_to_num(values, nan=-np.inf)))
        here, least = position(points.reshape(2, -1)[:, worst]), values.ravel()[worst]
        raise ValueError(f"the thickness must be above 0 everywhere on the plate, but it is {least:.6g} m at {here} m")
    return values


def spread(thickness: float | Profile, mesh: Any) -> tuple[float, float, float]:
    """Least, mean and greatest thickness [m] on a mesh.

    They are those of a lattice of points in each cell, corners included.
    """
    if isinstance(thickness, float | int):
        return (float(thickness),) * 3
    values = of(thickness, lattice(mesh))
    area = np.abs(twice_areas(mesh.p[:, mesh.t]))
    return float(values.min()), float(np.average(np.mean(values, axis=1), weights=area)), float(values.max())  # type: ignore[union-attr]


def slope(thickness: float | Profile, mesh: Any) -> float:
    """Greatest slope of a face against the mid-surface, on average over a cell of a mesh."""
    if isinstance(thickness, float | int):
        return 0.0
    points = lattice(mesh)
    place = points - points.mean(axis=2, keepdims=True)
    moment = np.einsum("acp,bcp->cab", place, place)
    fitted = np.linalg.solve(moment, np.einsum("acp,cp->ca", place, thickness.at(points))[:, :, None])
    return 0.5 * float(np.linalg.norm(fitted[:, :, 0], axis=1).max())


def lattice(mesh: Any) -> Array:
    """Points (2, ncell, n) in m on and in the cells of a mesh, corners included."""
    side = np.linspace(0.0, 1.0, LATTICE)
    x, y = (a.ravel() for a in np.meshgrid(side, side))
    corners = mesh.t.shape[0]
    inside = outside(x, y, corners) <= TOLERANCE
    return np.asarray(np.einsum("dvc,vk->dck", mesh.p[:, mesh.t], corner_shapes(x[inside], y[inside], corners)))


def corner_shapes(x: Any, y: Any, corners: int) -> Array:
    """Linear or bilinear functions of a cell's corners.

    Args:
        x: first reference coordinate, any shape (...).
        y: the second.
        corners: 3 of a triangle, 4 of a quadrilateral.

    Returns:
        Shape (corners, ...).
    """
    if corners == 3:
        return np.stack([1.0 - x - y, x, y])
    return np.stack([(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y])


def _reference(corners: Array, points: Array) -> Array:
    """Reference coordinates (2, ncell, npoint) of points in cells of corners (2, ncorner, ncell)."""
    at = np.full(points.shape, 1.0 / 3.0)
    a, b, c = corners[:, 0, :, None], corners[:, 1, :, None], corners[:, -1, :, None]
    bent = np.zeros_like(a) if corners.shape[1] == 3 else a - b - c + corners[:, 2, :, None]
    for _ in range(NEWTON):
        x, y = at
        along, across = b - a + bent * y, c - a + bent * x
        missed = points - (a + (b - a) * x + (c - a) * y + bent * x * y)
        turn = along[0] * across[1] - along[1] * across[0]
        step = np.stack([missed[0] * across[1] - missed[1] * across[0], along[0] * missed[1] - along[1] * missed[0]])
        at = at + step / turn
        if np.abs(step / turn).max() < 1e-14:
            break
    return at
