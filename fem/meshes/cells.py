"""Cells in space: shape functions, points of integration, faces, and where a point lies in a cell.

The order of nodes is that of meshio and VTK. The shape functions are the polynomials of each kind of cell that are 1 at
one of its nodes and 0 at the others.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from fem.linalg import Array, Ints


@dataclass(frozen=True, eq=False)
class Cell:
    """A kind of cell.

    Attributes:
        nodes: reference places of its nodes, (k, d).
        powers: exponents of its monomials, (k, d).
        simplex: how many of the reference coordinates, the first, are those of a simplex, from 0 on with a sum of at
            most 1; the others are from -1 to 1.
        faces: of each face the local nodes around it, mid-side nodes between corners; of a flat cell itself.
        rule: points (p, d) and weights (p,) that integrate a product of two shape functions on a straight cell.
    """

    nodes: Array
    powers: Ints
    simplex: int
    faces: tuple[tuple[int, ...], ...]
    rule: tuple[Array, Array]
    inverse: Array

    @property
    def dimension(self) -> int:
        """2 of a flat cell, 3 of one with a volume."""
        return int(self.nodes.shape[1])

    def shape(self, at: Array) -> Array:
        """Shape functions (p, k) at reference places (p, d)."""
        return np.asarray(_monomials(at, self.powers) @ self.inverse)

    def slopes(self, at: Array) -> Array:
        """Their derivatives (p, k, d) by the reference coordinates."""
        slopes = []
        for axis in range(self.dimension):
            lowered = self.powers.copy()
            lowered[:, axis] = np.maximum(lowered[:, axis] - 1, 0)
            slopes.append((_monomials(at, lowered) * self.powers[:, axis]) @ self.inverse)
        return np.stack(slopes, axis=2)

    def clipped(self, at: Array) -> Array:
        """The nearest reference place (d,) within the cell, coordinate by coordinate."""
        clipped = np.clip(at, -1.0, 1.0)
        if self.simplex:
            share = np.maximum(at[: self.simplex], 0.0)
            clipped[: self.simplex] = share / max(1.0, float(share.sum()))
        return clipped

    def nearest(self, corners: Array, point: Array) -> tuple[Array, float]:
        """Where in a cell with nodes (k, 3) a point (3,) lies, or what of the cell is nearest to it.

        Returns:
            Reference place (d,), and the distance of its image from the point.
        """
        at = np.full(self.dimension, 1.0 / 3.0)
        at[self.simplex :] = 0.0
        best, least = at, np.inf
        for _ in range(_STEPS):
            off = point - self.shape(at[None])[0] @ corners
            distance = float(np.linalg.norm(off))
            if distance < least:
                best, least = at, distance
            step = np.linalg.lstsq((corners.T @ self.slopes(at[None])[0]), off, rcond=None)[0]
            moved = self.clipped(at + step)
            if np.abs(moved - at).max() < _STILL:
                break
            at = moved
        return best, least

    def gradients(self, corners: Array, at: Array) -> tuple[Array, Array]:
        """Derivatives of the shape functions by x, y and z, and the size of the mapping.

        Args:
            corners: nodes of cells, (c, k, 3).
            at: reference places, (p, d).

        Returns:
            Gradients (c, p, k, 3), of a flat cell those within its surface; volume or area per unit of the reference
            cell (c, p), negative where a cell with a volume is turned inside out.
        """
        slopes, mapping = self.slopes(at), self._mapping(corners, at)
        return np.einsum("pkd,cpdi->cpki", slopes, np.linalg.pinv(mapping)), self._size(mapping)

    def sizes(self, corners: Array, at: Array) -> Array:
        """The size of the mapping alone (c, p), as `gradients` gives it."""
        return self._size(self._mapping(corners, at))

    def _mapping(self, corners: Array, at: Array) -> Array:
        return np.asarray(np.einsum("cki,pkd->cpid", corners, self.slopes(at)))

    def _size(self, mapping: Array) -> Array:
        if self.dimension == 3:
            return np.asarray(np.linalg.det(mapping))
        return np.asarray(np.sqrt(np.linalg.det(np.swapaxes(mapping, 2, 3) @ mapping)))


_STEPS = 40
"""Steps in which a place in a cell is looked for; Newton's take four."""

_STILL = 1e-13
"""Step in reference coordinates that ends the search."""


def _monomials(at: Array, powers: Ints) -> Array:
    return np.asarray(np.prod(at[:, None, :] ** powers[None], axis=2))


def _rule(simplex: int, dimension: int) -> tuple[Array, Array]:
    """Gauss points: three along each coordinate, those of a simplex drawn together (Duffy), which takes one more."""
    line, share = np.polynomial.legendre.leggauss(4 if simplex else 3)
    points = np.array(list(product(line, repeat=dimension)))
    weights = np.array([np.prod(each) for each in product(share, repeat=dimension)])
    if simplex:
        points[:, :simplex] = (points[:, :simplex] + 1.0) / 2.0
        left = [np.prod(1.0 - points[:, :k], axis=1) for k in range(simplex)]
        points[:, :simplex] *= np.column_stack(left)
        weights = weights / 2.0**simplex * np.prod(left, axis=0)
    return points, weights


_TRIANGLE = [(0, 0), (1, 0), (0, 1)]
_SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1)]


def _with_middles(corners: Array, edges: list[tuple[int, int]]) -> Array:
    return np.vstack([corners, [(corners[a] + corners[b]) / 2.0 for a, b in edges]])


def _up_to(degree: int, dimension: int) -> list[tuple[int, ...]]:
    return [p for p in product(range(degree + 1), repeat=dimension) if sum(p) <= degree]


def _serendipity(dimension: int) -> list[tuple[int, ...]]:
    """Quadratic ones whose degree without linear factors is 2 at most."""
    return [p for p in product(range(3), repeat=dimension) if sum(k for k in p if k > 1) <= 2]


_HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
_HEX_FACES: list[tuple[int, ...]] = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
_TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
_TET_FACES: list[tuple[int, ...]] = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
_WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
_WEDGE_FACES: list[tuple[int, ...]] = [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]


def _around(faces: list[tuple[int, ...]], edges: list[tuple[int, int]], corners: int) -> tuple[tuple[int, ...], ...]:
    """Faces with the mid-side nodes between their corners."""
    middle = {frozenset(edge): corners + k for k, edge in enumerate(edges)}
    return tuple(
        tuple(n for a, b in zip(face, (*face[1:], face[0]), strict=True) for n in (a, middle[frozenset((a, b))]))
        for face in faces
    )


def faces_of(cells: Iterable[tuple[str, Ints]]) -> list[tuple[Ints, Ints]]:
    """Nodes around the faces of cells (nface, nnode), and how many cells have each (nface,).

    They are given by the number of nodes of a face.
    """
    rings: dict[int, list[Ints]] = {}
    for name, nodes in cells:
        for ring in cell(name).faces:
            rings.setdefault(len(ring), []).append(nodes[:, ring])
    found = []
    for every in map(np.concatenate, rings.values()):
        _, first, times = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
        found.append((every[first], times))
    return found


def edges_of(cells: Iterable[tuple[str, Ints]]) -> Ints:
    """Edges (k, 2) of the faces on the boundary of cells, each once, in parts where nodes lie between their ends."""
    rings = [every[times == 1] for every, times in faces_of(cells)]
    sides = [np.stack([ring, np.roll(ring, -1, axis=1)], axis=2).reshape(-1, 2) for ring in rings]
    return np.asarray(np.unique(np.sort(np.concatenate(sides), axis=1), axis=0))


def _kinds() -> dict[str, tuple[Array, list[tuple[int, ...]], int, tuple[tuple[int, ...], ...]]]:
    """Nodes, powers, simplex and faces of the kinds of cells, by meshio's names."""
    square, triangle = np.array(_SQUARE, float), np.array(_TRIANGLE, float)
    cube = np.array([(*p, z) for z in (-1, 1) for p in _SQUARE], float)
    tetra = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    wedge = np.array([(*p, z) for z in (-1, 1) for p in _TRIANGLE], float)
    cube20 = _with_middles(cube, _HEX_EDGES)
    centres = np.array([(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1), (0, 0, 0)], float)
    square8 = _with_middles(square, [(0, 1), (1, 2), (2, 3), (3, 0)])
    both: list[tuple[int, ...]] = [(*p, k) for p in _up_to(1, 2) for k in range(2)]
    wedge15 = [(*p, k) for p in _up_to(2, 2) for k in range(2)] + [(*p, 2) for p in _up_to(1, 2)]
    linear, quadratic, flat, flat9 = (list(product(range(n), repeat=d)) for d, n in ((3, 2), (3, 3), (2, 2), (2, 3)))
    hex20_faces = _around(_HEX_FACES, _HEX_EDGES, 8)
    return {
        "hexahedron": (cube, linear, 0, tuple(_HEX_FACES)),
        "hexahedron20": (cube20, _serendipity(3), 0, hex20_faces),
        "hexahedron27": (np.vstack([cube20, centres]), quadratic, 0, hex20_faces),
        "tetra": (tetra, _up_to(1, 3), 3, tuple(_TET_FACES)),
        "tetra10": (_with_middles(tetra, _TET_EDGES), _up_to(2, 3), 3, _around(_TET_FACES, _TET_EDGES, 4)),
        "wedge": (wedge, both, 2, tuple(_WEDGE_FACES)),
        "wedge15": (_with_middles(wedge, _WEDGE_EDGES), wedge15, 2, _around(_WEDGE_FACES, _WEDGE_EDGES, 6)),
        "triangle": (triangle, _up_to(1, 2), 2, ((0, 1, 2),)),
        "triangle6": (_with_middles(triangle, [(0, 1), (1, 2), (2, 0)]), _up_to(2, 2), 2, ((0, 3, 1, 4, 2, 5),)),
        "quad": (square, flat, 0, ((0, 1, 2, 3),)),
        "quad8": (square8, _serendipity(2), 0, ((0, 4, 1, 5, 2, 6, 3, 7),)),
        "quad9": (np.vstack([square8, [(0.0, 0.0)]]), flat9, 0, ((0, 4, 1, 5, 2, 6, 3, 7),)),
    }


KINDS = _kinds()
"""What each kind of cell is made of, by meshio's names."""


@cache
def cell(name: str) -> Cell:
    """A kind of cell by meshio's name.

    Raises:
        KeyError: it is none of `KINDS`.
    """
    nodes, powers, simplex, faces = KINDS[name]
    exponents = np.array(powers, dtype=np.int64)
    inverse = np.asarray(np.linalg.inv(_monomials(nodes, exponents)), dtype=np.float64)
    return Cell(nodes, exponents, simplex, faces, _rule(simplex, nodes.shape[1]), inverse)
