"""Planforms: the rectangle, the checks of a mid-surface mesh, and where a point lies in it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.linalg import Array, Ints

MERGED = 1e-9
"""Distance relative to the plate's size within which points are one."""


ROOT_TOLERANCE = 1e-3
"""How far an end of an edge of the root may lie off the smallest x, as part of the edge's length."""

ROUNDING = 1e-6
"""The same as part of the plate's extent along x: short edges of coordinates with few digits."""

ROOT_BEND = np.radians(20.0)
"""Turn between two edges of the boundary up to which one continues the other."""


class MeshError(ValueError):
    """A mesh that cannot be the mid-surface of a clamped plate; the message says what is wrong."""


def position(point: Sequence[float] | Array) -> str:
    """The coordinates of a point in six digits, as messages give them."""
    return f"({', '.join(f'{each:.6g}' for each in point)})"


def rectangle(length: float, width: float, nx: int, ny: int) -> Any:
    """A structured `skfem.MeshQuad` of equal cells on 0 <= x <= length, |y| <= width/2.

    Args:
        length: along x [m].
        width: along y [m].
        nx: cells along x.
        ny: cells along y.
    """
    from skfem import MeshQuad

    check_sides(length, width)
    if nx < 1 or ny < 1:
        raise ValueError(f"a rectangle needs at least one cell each way, got {nx} x {ny}")
    return MeshQuad.init_tensor(np.linspace(0.0, length, nx + 1), np.linspace(-0.5 * width, 0.5 * width, ny + 1))


def check_sides(length: float, width: float) -> None:
    """Raise ValueError unless a rectangle can have these sides (m)."""
    if not (0.0 < length < np.inf and 0.0 < width < np.inf):
        raise ValueError(f"length and width must be positive and finite, got {length!r} and {width!r}")


def root(mesh: Any) -> float:
    """Where the plate is clamped: the smallest x (m) of a mesh."""
    return float(mesh.p[0].min())


def root_facets(mesh: Any) -> Ints:
    """Numbers of the boundary facets on the smallest x, within `ROOT_TOLERANCE` of their lengths."""
    boundary = np.asarray(mesh.boundary_facets())
    x, y = mesh.p[:, mesh.facets[:, boundary]]
    off = x.max(axis=0) - root(mesh)
    length = np.hypot(np.diff(x, axis=0)[0], np.diff(y, axis=0)[0])
    return np.asarray(boundary[off <= np.maximum(ROOT_TOLERANCE * length, ROUNDING * np.ptp(mesh.p[0]))])


def lengths(mesh: Any, facets: Ints) -> Array:
    """Lengths (n,) in m of facets by their numbers."""
    return np.asarray(np.linalg.norm(np.diff(mesh.p[:, mesh.facets[:, facets]], axis=1)[:, 0], axis=0))


def clamped_length(mesh: Any) -> float:
    """Length (m) of the root edge."""
    return float(lengths(mesh, root_facets(mesh)).sum())


def check_mesh(mesh: Any) -> None:
    """Refuse a mesh that no plate can be made of.

    Raises:
        MeshError: it is not planar, its cells are not upright or not connected without seams, or its root is not one
            straight edge.
    """
    name = type(mesh).__name__
    if not name.startswith(("MeshTri", "MeshQuad")):
        raise MeshError(f"a plate needs a surface mesh of triangles or quadrilaterals, got {name}")
    p, t = mesh.p, mesh.t
    if p.shape[0] != 2 or t.shape[1] == 0:
        raise MeshError(f"a plate needs a mesh in the plane with at least one cell, got {t.shape[1]} cells")
    if not np.isfinite(p).all():
        raise MeshError("the mesh has points with coordinates that are not finite")
    at = p[:, t]
    corners = np.stack([_turn(at[:, k - 1], at[:, k], at[:, (k + 1) % len(t)]) for k in range(len(t))])
    upright = corners * np.sign(corners[0])
    _reject(upright.min(axis=0) <= 1e-12 * np.abs(corners).max(), mesh, "inverted or flat")
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    left, right = mesh.f2t[:, inner]
    folded = _side(mesh, inner, left) * _side(mesh, inner, right) > 0.0
    _reject(np.isin(np.arange(t.shape[1]), left[folded]), mesh, "folded over a neighbour")
    _reject_seams(mesh)
    parts = connected(mesh.f2t[:, inner], t.shape[1])[0]
    if parts > 1:
        raise MeshError(f"the mesh is in {parts} parts that share no edge; a plate must be one piece")
    _reject_root(mesh)


def connected(pairs: Ints, count: int) -> tuple[int, NDArray[np.int32]]:
    """Number of parts that pairs (2, n) connect so many things into, and the part of each thing (count,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(pairs.shape[1]), tuple(pairs)), shape=(count, count))
    return connected_components(graph, directed=False)


def _reject_root(mesh: Any) -> None:
    """Raise `MeshError` unless the root is one straight run of edges that ends where the boundary turns."""
    facets = root_facets(mesh)
    if facets.size == 0:
        raise MeshError(
            f"no edge lies on the smallest x ({root(mesh):.6g}), so there is nothing to clamp: {_STRAIGHT_ROOT}"
        )
    nodes, ends = np.unique(mesh.facets[:, facets], return_inverse=True)
    parts, part = connected(ends.reshape(2, -1), nodes.size)
    if parts > 1:
        y = [mesh.p[1, nodes[part == k]] for k in range(parts)]
        runs = ", ".join(f"{low:.6g} to {high:.6g}" for low, high in sorted((v.min(), v.max()) for v in y))
        raise MeshError(f"the edges on the smallest x fall into {parts} runs (y from {runs}): {_STRAIGHT_ROOT}")
    y = mesh.p[1, nodes]
    others = np.setdiff1d(mesh.boundary_facets(), facets)
    for end, outwards in ((nodes[y.argmin()], -1.0), (nodes[y.argmax()], 1.0)):
        for other in mesh.facets[:, others[(mesh.facets[:, others] == end).any(axis=0)]].T:
            across, along = (mesh.p[:, other].sum(axis=1) - 2.0 * mesh.p[:, end])[::-1]
            if abs(along) < np.tan(ROOT_BEND) * outwards * across:
                raise MeshError(
                    f"the root is not straight: beyond {position(mesh.p[:, end])} its edge continues "
                    f"at {np.degrees(np.arctan(abs(along / across))):.2g}° to the clamped part, of length "
                    f"{clamped_length(mesh):.6g}: {_STRAIGHT_ROOT}"
                )


_STRAIGHT_ROOT = "the root must be one straight, unbroken edge with x constant"


def _reject_seams(mesh: Any) -> None:
    """Raise `MeshError` where cells meet at points that coincide but are not one: there the plate would be cracked."""
    from scipy.spatial import cKDTree

    points = mesh.p[:, np.unique(mesh.t)].T
    near = MERGED * np.ptp(points, axis=0).min()
    first, second = cKDTree(points).query_pairs(near, p=np.inf, output_type="ndarray").T
    if first.size:
        raise MeshError(
            f"{np.unique(second).size} points coincide with others, the first one at {position(points[first.min()])}: "
            "merge them, or leave a gap where the plate is slit"
        )


def _turn(c: Array, a: Array, b: Array) -> Array:
    """Twice the signed areas (n,) of triangles with corners (2, n), anticlockwise."""
    return np.asarray((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def twice_areas(corners: Array) -> Array:
    """Twice the signed areas (ncell,) of cells with corners (2, ncorner, ncell), anticlockwise."""
    turned = np.roll(corners, -1, axis=1)
    return np.asarray((corners[0] * turned[1] - corners[1] * turned[0]).sum(axis=0))


def _side(mesh: Any, facets: Ints, cells: Ints) -> Array:
    """On which side (sign) of each facet the middle of a cell lies."""
    return _turn(mesh.p[:, mesh.t[:, cells]].mean(axis=1), *mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2))


def _reject(bad: NDArray[np.bool_], mesh: Any, what: str) -> None:
    if bad.any():
        middle = mesh.p[:, mesh.t[:, np.flatnonzero(bad)[0]]].mean(axis=1)
        raise MeshError(
            f"{np.count_nonzero(bad)} of {bad.size} cells are {what}, the first one near {position(middle)}"
        )


TOLERANCE = 1e-6
"""How far outside a cell, in its own coordinates, a point still counts as in it."""


class PlaceError(ValueError):
    """A place that is not on the plate, or where what is asked for does not move; the message says which."""


def locate(mesh: Any, point: tuple[float, float]) -> tuple[int, Array]:
    """Cell that holds a point (x, y) in m, and the reference coordinates (2,) there.

    Raises:
        PlaceError: for a point off the plate.
        ValueError: for one that is none.
    """
    target = np.asarray(point, dtype=float)
    if target.shape != (2,):
        raise ValueError(f"a place on the plate is (x, y) in m, got {point!r}")
    corners = mesh.p[:, mesh.t]
    low, high = corners.min(axis=1), corners.max(axis=1)
    margin = TOLERANCE * (high - low).max(axis=0)
    near = ((low - margin <= target[:, None]) & (target[:, None] <= high + margin)).all(axis=0)
    best, where, excess = -1, np.zeros(2), np.inf
    for cell in np.flatnonzero(near):
        reference = x, y = _invert(corners[:, :, cell], target)
        off = max(float(outside(x, y, mesh.t.shape[0])), 0.0)
        if off < excess:
            best, where, excess = int(cell), reference, off
    if excess > TOLERANCE:
        raise PlaceError(f"the point {position(point)} m does not lie on the plate")
    return best, where


def _invert(corners: Array, target: Array) -> Array:
    """Find the reference coordinates of a target by Newton's method; exact in one step for triangles."""
    p = corners
    at = np.full(2, 1.0 / 3.0 if p.shape[1] == 3 else 0.5)
    for _ in range(50):
        x, y = at
        if p.shape[1] == 3:
            value = p[:, 0] * (1 - x - y) + p[:, 1] * x + p[:, 2] * y
            jacobian = np.stack([p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]], axis=1)
        else:
            value = p @ np.array([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
            jacobian = p @ np.array([[y - 1, x - 1], [1 - y, -x], [y, x], [-y, 1 - x]])
        step = np.linalg.solve(jacobian, target - value)
        at = at + step
        if np.abs(step).max() < 1e-14:
            break
    return at


def outside(x: Any, y: Any, corners: int) -> Array:
    """How far reference coordinates, any shape (...), lie outside a cell of so many corners; negative inside."""
    return np.asarray(np.max([-x, -y, (x + y if corners == 3 else np.maximum(x, y)) - 1.0], axis=0))
