"""Points and weights at which solid cells are integrated, by default as CalculiX does.

Products of Gauss's points; on tetrahedra and triangles the symmetric rules of lowest order (Zienkiewicz, Taylor and
Zhu, The Finite Element Method, 7th ed., tables 3.2 and 3.3). Hexahedra of 20 nodes have 2 x 2 x 2 points for stiffness
and mass (C3D20R), which do not lock where cells are thin; "full" is 3 x 3 x 3 (C3D20). Tetrahedra of 10 nodes have 4
(C3D10), wedges of 15 nodes 9 (C3D15), hexahedra of 8 nodes 2 x 2 x 2 and of 27 nodes 3 x 3 x 3.
"""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Rule = tuple[Array, Array]


@cache
def rule(kind: str, full: bool = False) -> Rule:
    """Points (npoint, 3) and weights (npoint,) on the reference cell of a kind, for stiffness and mass."""
    if kind.startswith("hexahedron"):
        return _gauss(3 if kind == "hexahedron27" or (full and kind == "hexahedron20") else 2)
    if kind.startswith("wedge"):
        return _wedge(3 if kind == "wedge15" else 2)
    a, b = (5.0 + 3.0 * 5.0**0.5) / 20.0, (5.0 - 5.0**0.5) / 20.0
    return np.array([(b, b, b), (a, b, b), (b, a, b), (b, b, a)]), np.full(4, 1.0 / 24.0)


def _gauss(order: int) -> Rule:
    x, w = np.polynomial.legendre.leggauss(order)
    points = np.array([(a, b, c) for c, b, a in product(x, repeat=3)])
    return points, np.array([a * b * c for c, b, a in product(w, repeat=3)])


def _wedge(line: int) -> Rule:
    z, w = np.polynomial.legendre.leggauss(line)
    triangle = np.array([(1.0, 1.0), (4.0, 1.0), (1.0, 4.0)]) / 6.0
    points = np.array([(*at, height) for height in z for at in triangle])
    return points, np.repeat(w, 3) / 6.0
