"""Surfaces with more points than a picture can show: fewer of them, the edges of the plate kept."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from workflows.solve.records import Floats, Surface

Indices = npt.NDArray[np.int64]

_CORNER = 0.94
"""Cosine of the turn from which a boundary point is a corner, and kept."""

_CLEAR = 0.6
"""Spacings that inner points keep away from the boundary's, so that no triangle reaches across it."""

_AT_ONCE = 2_000_000
"""Pairs of points and edges that are looked at together."""


@dataclass(frozen=True, eq=False)
class Shown:
    """The surface as it is drawn.

    Attributes:
        kept: which points of the surface, (n,).
        triangles: (m, 3), numbers of kept points, as all below.
        edges: of the cells, (k, 2); None where the triangles are not those of the mesh.
        outline, root: ends of boundary edges and of those that are held, (edges, 2).
    """

    kept: Indices
    triangles: Indices
    edges: Indices | None
    outline: Indices
    root: Indices


def shown(surface: Surface, most: int) -> Shown:
    """The mesh itself where it has at most so many points, or else about as many of its points in triangles."""
    cells = surface.cells[1]
    if len(surface.points) > most:
        return _thinned(surface, most)
    triangles = cells if cells.shape[1] == 3 else np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    edges = surface.lines if surface.lines is not None else _sides(cells)
    return Shown(np.arange(len(surface.points)), triangles, edges, surface.outline, surface.root)


def _sides(cells: Indices) -> Indices:
    """The edges of cells (m, 3 or 4), each once, (k, 2)."""
    sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.asarray(np.unique(np.sort(sides, axis=1), axis=0))


def _thinned(surface: Surface, most: int) -> Shown:
    from scipy.spatial import Delaunay, KDTree

    places = surface.points[:, :2]
    spacing = np.sqrt(_area(places, surface.cells[1]) / (0.8 * most))
    rims = [_along(places, loop, spacing) for loop in loops(surface.outline)]
    rim = np.concatenate(rims)
    inner = np.setdiff1d(_one_a_square(places, spacing), surface.outline)
    inner = inner[KDTree(places[rim]).query(places[inner])[0] > _CLEAR * spacing]
    kept = np.concatenate([rim, inner])
    number = {int(point): k for k, point in enumerate(kept)}
    outline = np.array([(number[a], number[b]) for loop in rims for a, b in zip(loop, np.roll(loop, -1), strict=True)])
    triangles = np.asarray(Delaunay(places[kept]).simplices, dtype=np.int64)
    middles = places[kept][triangles].mean(axis=1)
    triangles = triangles[_inside(middles, places[kept][outline])]
    held = np.isin(kept, surface.root)
    return Shown(kept, triangles, None, outline, outline[held[outline].all(axis=1)])


def _area(places: Floats, cells: Indices) -> float:
    x, y = places[cells].transpose(2, 0, 1)
    return float(0.5 * np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)).sum())


def loops(outline: Indices) -> list[Indices]:
    """The edges (k, 2) put one after another: closed chains of points."""
    beside: dict[int, list[int]] = defaultdict(list)
    for a, b in outline.tolist():
        beside[a].append(b)
        beside[b].append(a)
    found = []
    while beside:
        start = at = next(iter(beside))
        loop = []
        while True:
            loop.append(at)
            onwards = beside[at].pop()
            beside[onwards].remove(at)
            for point in (at, onwards):
                if point in beside and not beside[point]:
                    del beside[point]
            at = onwards
            if at == start:
                break
        found.append(np.array(loop))
    return found


def _along(places: Floats, loop: Indices, spacing: float) -> Indices:
    """Points of a loop: its corners, and others at least `spacing` apart."""
    at = places[loop]
    on = np.roll(at, -1, axis=0) - at
    on /= np.linalg.norm(on, axis=1)[:, None]
    corner = (on * np.roll(on, 1, axis=0)).sum(axis=1) < _CORNER
    far = np.concatenate([[0.0], np.linalg.norm(np.diff(at, axis=0), axis=1).cumsum()])
    keep, last = [], -np.inf
    for k in range(len(loop)):
        if corner[k] or far[k] - last >= spacing:
            keep.append(k)
            last = far[k]
    if len(keep) < 3:
        keep = np.unique(np.linspace(0, len(loop) - 1, min(len(loop), 8)).astype(int)).tolist()
    return loop[keep]


def _one_a_square(places: Floats, spacing: float) -> Indices:
    """Of the points in each square of a grid, that nearest to its middle."""
    square = np.floor((places - places.min(axis=0)) / spacing)
    off = np.linalg.norm((places - places.min(axis=0)) / spacing - square - 0.5, axis=1)
    order = np.lexsort((off, square[:, 1], square[:, 0]))
    first = np.r_[True, np.any(np.diff(square[order], axis=0) != 0, axis=1)]
    return np.asarray(order[first], dtype=np.int64)


def _inside(points: Floats, edges: Floats) -> npt.NDArray[np.bool_]:
    """Which points (n, 2) the edges (k, 2, 2) enclose: a ray to the right meets an odd number of them."""
    (xa, ya), (xb, yb) = edges[:, 0].T, edges[:, 1].T
    rise = np.where(ya == yb, 1.0, yb - ya)
    found = np.zeros(len(points), dtype=bool)
    step = max(1, _AT_ONCE // len(edges))
    for start in range(0, len(points), step):
        x, y = points[start : start + step].T[..., None]
        met = (ya > y) != (yb > y)
        found[start : start + step] = (met & (x < xa + (y - ya) / rise * (xb - xa))).sum(axis=1) % 2 == 1
    return found
