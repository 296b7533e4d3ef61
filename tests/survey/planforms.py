"""Planforms made of blocks: rectangles, L, T and holes, then tapered and swept."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from skfem import MeshQuad

from fem.meshes.mesh_sequence import crowded

OCTAGON = np.tan(np.pi / 8.0)
"""Half a side of a regular octagon over half its width."""


@dataclass(frozen=True)
class Hole:
    """A regular octagon of a width of 2 half about (x, y); beyond 2 half from there no cell is moved. In m."""

    x: float
    y: float
    half: float

    def drawn_in(self, points):
        """Points (2, n) of a grid with a square hole, drawn in to the octagon around it."""
        from_centre = (points - [[self.x], [self.y]]) / self.half
        size = np.abs(from_centre)
        ring = size.max(axis=0)
        gauge = np.maximum(ring, size.sum(axis=0) / np.sqrt(2.0))
        share = np.clip(ring - 1.0, 0.0, 1.0)
        drawn = share + (1.0 - share) * ring / np.where(gauge > 0.0, gauge, 1.0)
        return points + self.half * from_centre * (drawn - 1.0)


@dataclass(frozen=True)
class Planform:
    """Blocks between lines xs and ys (m) but those removed, given by their number along and across.

    taper: width at the tip over that at the root. sweep: angle in degrees by which the tip is moved towards y.
    cells: about how many a mesh of fineness 1 has.
    """

    xs: tuple
    ys: tuple
    removed: tuple = ()
    taper: float = 1.0
    sweep: float = 0.0
    hole: Hole | None = None
    cells: int = 48

    @property
    def sides(self):
        """Length and width in m before the sweep, of what encloses it."""
        return self.xs[-1] - self.xs[0], self.ys[-1] - self.ys[0]

    @property
    def root(self):
        """Width in m of the clamped edge; of an L or a T that of its arm."""
        return sum(b - a for j, (a, b) in enumerate(pairwise(self.ys)) if (0, j) not in self.removed)

    def graded(self, fineness):
        """A mesh of `skfem.MeshQuad` that shrinks towards every line; fineness: whole multiple of the coarsest."""
        return self._mesh(fineness, crowded)

    def even(self, fineness):
        """The same with cells of about one size."""
        return self._mesh(fineness, lambda count: np.linspace(-1.0, 1.0, count + 1))

    def _mesh(self, fineness, spaced):
        along, across = (_line(breaks, self._cell, fineness, spaced) for breaks in (self.xs, self.ys))
        whole = MeshQuad.init_tensor(along, across)
        middle = whole.p[:, whole.t].mean(axis=1)
        blocks = np.array(
            [np.searchsorted(breaks, at) - 1 for breaks, at in zip((self.xs, self.ys), middle, strict=True)]
        )
        kept = [k for k, block in enumerate(blocks.T.tolist()) if tuple(block) not in self.removed]
        mesh = whole.restrict(np.array(kept)) if self.removed else whole
        return MeshQuad(self._mapped(mesh.p), mesh.t)

    @property
    def _cell(self):
        """Side in m of the cells of fineness 1."""
        areas = np.outer(np.diff(self.xs), np.diff(self.ys))
        return np.sqrt((areas.sum() - sum(areas[block] for block in self.removed)) / self.cells)

    def _mapped(self, points):
        x, y = points if self.hole is None else self.hole.drawn_in(points)
        part = (x - self.xs[0]) / self.sides[0]
        return np.array([x, y * (1.0 - (1.0 - self.taper) * part) + np.tan(np.radians(self.sweep)) * x])


def _line(breaks, cell, fineness, spaced):
    """Coordinates from the first break to the last."""
    found = [breaks[:1]]
    for a, b in pairwise(breaks):
        count = fineness * max(1, round((b - a) / cell))
        found += [(a + 0.5 * (b - a) * (1.0 + spaced(count)))[1:-1], [b]]
    return np.concatenate(found)


def rectangle(length, width, **keys):
    """Clamped at x = 0, |y| up to width / 2."""
    return Planform((0.0, length), (-0.5 * width, 0.5 * width), **keys)


def ell(length, width, arm, across):
    """An arm as wide as across, which carries on its side y > 0 a tip that reaches from x = arm to the length."""
    return Planform((0.0, arm, length), (-0.5 * across, 0.5 * across, width - 0.5 * across), ((0, 1),))


def tee(length, width, arm, across):
    """An arm as wide as across, which carries in its middle a tip that reaches from x = arm to the length."""
    ys = (-0.5 * width, -0.5 * across, 0.5 * across, 0.5 * width)
    return Planform((0.0, arm, length), ys, ((0, 0), (0, 2)))


def window(length, width, opening, **keys):
    """A rectangle with a rectangular hole; opening: (x, x, y, y) in m."""
    x1, x2, y1, y2 = opening
    return Planform((0.0, x1, x2, length), (-0.5 * width, y1, y2, 0.5 * width), ((1, 1),), **keys)


def eyed(length, width, hole, **keys):
    """A rectangle with an octagonal hole."""
    lines = [(middle + hole.half * np.array([-1.0, -OCTAGON, OCTAGON, 1.0])).tolist() for middle in (hole.x, hole.y)]
    inside = tuple((i, j) for i in (1, 2, 3) for j in (1, 2, 3))
    xs, ys = (0.0, *lines[0], length), (-0.5 * width, *lines[1], 0.5 * width)
    return Planform(xs, ys, inside, hole=hole, **keys)


def marked(length, width, at):
    """A rectangle with lines, and so a node of every mesh, through a place (x, y)."""
    x, y = at
    return Planform((0.0, x, length) if x < length else (0.0, length), (-0.5 * width, y, 0.5 * width))
