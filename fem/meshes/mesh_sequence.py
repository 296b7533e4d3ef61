"""Sequences of meshes of a planform, coarse to fine, and the order at which errors fall along them.

Where a clamped edge meets a free one the stress is singular, and along the free edges of a plate with shear there is a
layer as wide as the plate is thick, which carries the twisting moment: even meshes converge slowly for their sake. A
rectangle's cells therefore shrink towards its edges, with the square of the distance (Babuska, Kellogg and
Pitkaranta, Numer. Math. 33 (1979) 447; Arnold and Falk, SIAM J. Math. Anal. 27 (1996) 486).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from fem.linalg import Array
from fem.meshes.planform import check_sides, lengths, root_facets, twice_areas
from fem.meshes.thickness import Nodal

GRADING = 2
"""Power of the distance from an edge with which cells shrink."""

COARSEST = 3
"""Root of the number of cells of a rectangle's coarsest grid."""

MOST_CELLS = 10_000
"""Cells up to which a given mesh is split: seconds for a factor."""

CELLS_PER_MODE = 10
"""Cells for each mode wanted of a mesh that counts as more than the coarsest."""

STRAIGHT = 0.03
"""Relative difference from a straight angle that is none, as where a curve is drawn by edges."""

MOST_SLENDER = 4.0
"""Sides' ratio up to which a rectangle's cells are kept about square."""


def enough_cells(planform: Planform, size: int, count: int) -> bool:
    """Whether a mesh has enough cells for a number of modes.

    Args:
        planform: of the plate.
        size: of the mesh.
        count: of modes.
    """
    if isinstance(planform, Rectangle):
        along, across = planform.cells(size)
        return along * across >= CELLS_PER_MODE * count
    return int(planform.mesh(size).t.shape[1]) >= CELLS_PER_MODE * count


def begun_with(planform: Planform, count: int) -> int:
    """The finer of the two sizes with which a search for a mesh begins.

    It is the first with enough cells for so many modes.
    """
    sizes = planform.sizes
    return next((size for size in sizes[1:] if enough_cells(planform, size, count)), sizes[-1])


@dataclass(frozen=True)
class Rectangle:
    """0 <= x <= length, |y| <= width/2 in m, clamped at x = 0. A size is a multiple of a coarsest grid.

    Attributes:
        node: a place (x, y) in m that is a node of every mesh, unless an edge of the plate is nearer than any other
            line: what a point mass does to a mesh hangs on where in a cell it sits.

    Raises:
        ValueError: for sides that no rectangle has.
    """

    length: float
    width: float
    orders: tuple[float, float] = (3.0, 4.0)
    sizes: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32)
    node: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        check_sides(self.length, self.width)

    @property
    def sides(self) -> tuple[float, float]:
        """Length and width in m."""
        return self.length, self.width

    @property
    def corner(self) -> float:
        """Infinite: it has no inward corner."""
        return np.inf

    def cells(self, size: int) -> tuple[int, int]:
        """Cells along and across, in the same proportion for every size."""
        stretch = np.sqrt(np.clip(self.length / self.width, 1.0 / MOST_SLENDER, MOST_SLENDER))
        return size * round(COARSEST * stretch), size * round(COARSEST / stretch)

    def mesh(self, size: int) -> Any:
        """The mesh of one size, an `skfem.MeshQuad`.

        Raises:
            ValueError: for a size below 1.
        """
        if size < 1:
            raise ValueError(f"size must be a whole number from 1, got {size!r}")
        return graded(self.length, self.width, *self.cells(size), self.node)

    def edge(self, size: int) -> float:
        """How wide the cells along the sides are, in m."""
        return 0.5 * self.width * float(np.diff(crowded(self.cells(size)[1]))[0])


@dataclass(frozen=True, eq=False)
class Given:
    """A mesh made elsewhere; a size is how many parts each of its edges is split into, up to MOST_CELLS cells.

    Attributes:
        thickness: of the plate, where it came with the mesh.
    """

    given: Any
    orders: tuple[float, float] = (1.0, 3.0)
    thickness: Nodal | None = None

    @property
    def sizes(self) -> tuple[int, ...]:
        """1 alone for a mesh that is large as it is."""
        cells = self.given.t.shape[1]
        return (1, *(size for size in (2, 4, 8) if cells * size**2 <= MOST_CELLS))

    @property
    def corner(self) -> float:
        """Of its bluntest corners, at which strains grow as the power of the distance of Williams (1952)."""
        angles = inner_angles(self.given)
        clamped = np.isin(self.given.boundary_nodes(), self.given.facets[:, root_facets(self.given)])
        return min(corner_order(float(angles.max())), root_order(float(np.sort(angles[clamped])[:2].max())))

    @property
    def sides(self) -> tuple[float, float]:
        """Extent along x and across in m."""
        length, width = np.ptp(self.given.p, axis=1)
        return float(length), float(width)

    def mesh(self, size: int) -> Any:
        """The mesh with its edges split.

        Raises:
            ValueError: for a size that is no power of 2.
        """
        if size < 1 or size & (size - 1):
            raise ValueError(f"size must be 1, 2, 4, 8 and so on, got {size!r}")
        return self.given if size == 1 else self.given.refined(int(np.log2(size)))

    def edge(self, size: int) -> float:
        """How wide the cells along the edges are, in m; the median."""
        mesh = self.given
        facets = mesh.boundary_facets()
        twice = np.abs(twice_areas(mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]]))
        return float(np.median(twice / lengths(mesh, facets))) / (size if mesh.t.shape[0] == 3 else 2 * size)


Planform: TypeAlias = Rectangle | Given
"""What a mesh is chosen of: its `sizes`, ascending, the `mesh` of each, and the `orders`, least and greatest power of
the cell size, with which errors in frequency fall."""


def inner_angles(mesh: Any) -> Array:
    """Angles (n,) in rad between the edges at each point of a mesh's boundary, inside of it."""
    corners = mesh.p[:, mesh.t]
    back, forth = (np.roll(corners, step, axis=1) - corners for step in (1, -1))
    cosine = (back * forth).sum(axis=0) / np.linalg.norm(back, axis=0) / np.linalg.norm(forth, axis=0)
    angles = np.zeros(mesh.p.shape[1])
    np.add.at(angles, mesh.t, np.arccos(np.clip(cosine, -1.0, 1.0)))
    return np.asarray(angles[mesh.boundary_nodes()])


def corner_order(angle: float) -> float:
    """Power of the cell size with which frequencies converge at a corner between free edges.

    It holds for even cells.

    Twice the least root of sin(k angle) = -k sin(angle) (Williams, J. Appl. Mech. 19 (1952) 526); infinite up to a
    straight angle.
    """
    if angle <= np.pi * (1.0 + STRAIGHT):
        return np.inf
    if angle >= 2.0 * np.pi * (1.0 - STRAIGHT):
        return 1.0
    from scipy.optimize import brentq

    return 2.0 * float(brentq(lambda k: np.sin(k * angle) + k * np.sin(angle), 0.5, np.pi / angle + 0.05))


def root_order(angle: float) -> float:
    """The same at a corner between the clamped root and a free edge; infinite up to a right angle.

    sin²(k angle) = (4 - k² (1 - nu)² sin² angle) / ((3 + nu) (1 - nu)), which is above 1: k angle has a real part of
    about pi / 2, whatever nu.
    """
    return np.pi / angle if angle > 0.5 * np.pi * (1.0 + STRAIGHT) else np.inf


def graded(length: float, width: float, nx: int, ny: int, node: tuple[float, float] | None = None) -> Any:
    """A structured `skfem.MeshQuad` whose cells shrink towards the plate's edges.

    Args:
        length: of the plate [m].
        width: of the plate [m].
        nx: cells along x.
        ny: cells along y.
        node: place (x, y) at which a node lies [m]; see `Rectangle`.
    """
    from skfem import MeshQuad

    lines = 0.5 * length * (1.0 + crowded(nx)), 0.5 * width * crowded(ny)
    return MeshQuad.init_tensor(*(lines if node is None else map(_drawn_to, lines, node)))


def _drawn_to(lines: Array, place: float) -> Array:
    """Lines (n,), ascending, of which the one next to a place is moved there, and the others in proportion."""
    first, last, nearest = lines[0], lines[-1], lines[np.abs(lines - place).argmin()]
    if nearest in (first, last, place):
        return lines
    before = first + (lines - first) * (place - first) / (nearest - first)
    beyond = last - (last - lines) * (last - place) / (last - nearest)
    return np.asarray(np.where(lines <= nearest, before, beyond))


def crowded(count: int) -> Array:
    """Ends (count + 1,) of intervals from -1 to 1 that shrink towards both."""
    even = np.linspace(-1.0, 1.0, count + 1)
    return np.asarray(np.sign(even) * (1.0 - (1.0 - np.abs(even)) ** GRADING))
