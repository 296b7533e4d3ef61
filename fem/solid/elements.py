"""Solid elements of first and second order: shape functions and quadrature.

An element is its nodes in the reference cell, in the order of VTK and Abaqus, and the monomials that its shape
functions are made of: each is 1 at its own node and 0 at the others. Hexahedra live on [-1, 1]³, tetrahedra on
x, y, z >= 0, x + y + z <= 1, wedges on the triangle x, y >= 0, x + y <= 1 times -1 <= z <= 1. Quadrature: products of
Gauss's points; on tetrahedra and triangles the conical product of Gauss-Jacobi points, and the symmetric rules of
lowest order (Zienkiewicz, Taylor and Zhu, The Finite Element Method, 7th ed., tables 3.2 and 3.3), where these are what
CalculiX integrates stiffness with.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Rule = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Element:
    """A solid element.

    Attributes:
        name: as in mesh files, without the number of nodes where that is the lowest.
        nodes: reference coordinates (nnode, 3).
        powers: exponents (nnode, 3) of the monomials.
        stiff, heavy: points (npoint, 3) and weights (npoint,) for stiffness and for mass.
        full: for stiffness, exact on cells with flat faces; the same as stiff where that is not reduced.
        corners: how many of the nodes are corners.
        faces: corners of each face, the normal outwards.
    """

    name: str
    nodes: Array
    powers: NDArray[np.int64]
    stiff: Rule
    heavy: Rule
    full: Rule
    corners: int
    faces: tuple[tuple[int, ...], ...]

    @property
    def order(self) -> int:
        """1 or 2."""
        return 1 if len(self.nodes) == self.corners else 2

    @cached_property
    def _coefficients(self) -> Array:
        return np.asarray(np.linalg.inv(_monomials(self.nodes, self.powers)))

    def values(self, points: Array) -> Array:
        """Shape functions (npoint, nnode) at reference points (npoint, 3)."""
        return np.asarray(_monomials(points, self.powers) @ self._coefficients)

    def gradients(self, points: Array) -> Array:
        """Their derivatives (npoint, 3, nnode) in the reference coordinates."""
        found = []
        for axis in range(3):
            lower = self.powers.copy()
            lower[:, axis] -= 1
            factor = self.powers[:, axis]
            found.append((_monomials(points, np.maximum(lower, 0)) * factor) @ self._coefficients)
        return np.stack(found, axis=1)


def _monomials(points: Array, powers: NDArray[np.int64]) -> Array:
    return np.asarray(np.prod(points[:, None, :] ** powers[None], axis=2))


def _gauss(order: int) -> Rule:
    x, w = np.polynomial.legendre.leggauss(order)
    points = np.array([(a, b, c) for c, b, a in product(x, repeat=3)])
    return points, np.array([a * b * c for c, b, a in product(w, repeat=3)])


def _jacobi(order: int, power: int) -> Rule:
    """Points and weights on [0, 1] for the weight (1 - x)^power."""
    from scipy.special import roots_jacobi

    x, w = roots_jacobi(order, power, 0)
    return 0.5 * (x + 1.0), w / 2.0 ** (power + 1)


def _conical(order: int) -> Rule:
    """The tetrahedron, exact for polynomials of degree 2 order - 1."""
    (x, u), (y, v), (z, w) = _jacobi(order, 2), _jacobi(order, 1), _jacobi(order, 0)
    points = [(a, b * (1 - a), c * (1 - a) * (1 - b)) for a, b, c in product(x, y, z)]
    return np.array(points), np.array([a * b * c for a, b, c in product(u, v, w)])


def _four() -> Rule:
    """The tetrahedron, exact for degree 2."""
    a, b = (5.0 + 3.0 * 5.0**0.5) / 20.0, (5.0 - 5.0**0.5) / 20.0
    return np.array([(b, b, b), (a, b, b), (b, a, b), (b, b, a)]), np.full(4, 1.0 / 24.0)


def _wedge(triangle: int, line: int) -> Rule:
    """A triangle's rule of 3 points, or the conical one, times Gauss's."""
    z, w = np.polynomial.legendre.leggauss(line)
    if triangle == 3:
        flat, share = np.array([(1.0, 1.0), (4.0, 1.0), (1.0, 4.0)]) / 6.0, np.full(3, 1.0 / 6.0)
    else:
        (x, u), (y, v) = _jacobi(3, 1), _jacobi(3, 0)
        flat = np.array([(a, b * (1 - a)) for a, b in product(x, y)])
        share = np.array([a * b for a, b in product(u, v)])
    points = np.array([(*at, height) for height in z for at in flat])
    return points, np.array([a * b for a in w for b in share])


_CUBE = np.array(
    [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)], dtype=float
)
_CUBE_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_CUBE_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
_TET = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
_TET_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_TET_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_PRISM = np.array([(0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)], dtype=float)
_PRISM_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
_PRISM_FACES = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))


def _middles(corners: Array, parts: tuple[tuple[int, ...], ...]) -> Array:
    return np.array([corners[list(part)].mean(axis=0) for part in parts])


_POWERS = [powers for powers in product(range(3), repeat=3)]
_UP = {
    "tet4": [p for p in _POWERS if sum(p) <= 1],
    "tet10": [p for p in _POWERS if sum(p) <= 2],
    "hex8": [p for p in _POWERS if max(p) <= 1],
    "hex20": [p for p in _POWERS if sum(k for k in p if k > 1) <= 2],  # superlinear degree
    "hex27": _POWERS,
    "wedge6": [p for p in _POWERS if p[0] + p[1] <= 1 and p[2] <= 1],
    "wedge15": [p for p in _POWERS if (p[0] + p[1] <= 2 and p[2] <= 1) or (p[0] + p[1] <= 1 and p[2] == 2)],
}
_FILE_NAMES = {
    "tetra": "tet4",
    "tetra10": "tet10",
    "hexahedron": "hex8",
    "hexahedron20": "hex20",
    "hexahedron27": "hex27",
    "wedge": "wedge6",
    "wedge15": "wedge15",
}
NAMES = tuple(_FILE_NAMES)
"""Kinds of cells as mesh files' readers name them."""


@cache
def element(kind: str) -> Element:
    """The element of a kind of cells, one of `NAMES`."""
    name = _FILE_NAMES[kind]
    if name.startswith("tet"):
        corners, edges, faces = _TET, _TET_EDGES, _TET_FACES
        stiff, heavy = (_four(), _four()) if name == "tet10" else (_conical(1), _four())
        full = _conical(2) if name == "tet10" else stiff
    elif name.startswith("hex"):
        corners, edges, faces = _CUBE, _CUBE_EDGES, _CUBE_FACES
        full = _gauss(2 if name == "hex8" else 3)
        stiff = _gauss(2) if name == "hex20" else full
        heavy = stiff
    else:
        corners, edges, faces = _PRISM, _PRISM_EDGES, _PRISM_FACES
        stiff = heavy = _wedge(3, 3 if name == "wedge15" else 2)
        full = _wedge(9, 3) if name == "wedge15" else stiff
    nodes = corners
    if len(_UP[name]) > len(corners):
        nodes = np.vstack([corners, _middles(corners, edges)])
    if name == "hex27":
        nodes = np.vstack([nodes, _middles(corners, _CUBE_FACES), np.zeros((1, 3))])
    return Element(name, nodes, np.array(_UP[name]), stiff, heavy, full, len(corners), faces)
