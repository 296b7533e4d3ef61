"""The modes in motion in a page (templates/viewer.js): surface and shapes as plain data.

A surface with more points than a page has room for is thinned, its edges kept; shapes are packed as sums of few vectors
of 16-bit numbers.
"""

from __future__ import annotations

import base64
import json
import os
import sys
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from workflows.scene import plate_mesh
from workflows.scene.scene import Scene
from workflows.solve.results import Floats, Results, SpeedPoint, Surface, middle_speed

POINTS, _BYTES = 1200, 110_000
"""Points of a surface in a page that has more to show, and bytes of its shapes' vectors before they are text."""

_FEWEST = 300
"""Points down to which a surface is thinned to make room for its shapes."""

Indices = npt.NDArray[np.int64]

_BENT = 0.1
"""Rise of the paraboloid that a plate is laid on to be thinned, over its extent: so little that no cell is upright."""

_FOLD = 30.0
"""Angle [deg] between triangles from which their edge is one of the structure's."""

ERROR = 1e-3
"""Largest departure of a packed displacement, in parts of the shape's largest."""


@dataclass(frozen=True)
class View:
    """A viewer's data, as JSON that may stand in a page, and what to say beside the picture.

    Attributes:
        data: the JSON.
        of: points of the mesh.
        points: of these, those that are drawn.
        moving: whether there are modes.
    """

    data: str
    of: int
    points: int
    moving: bool

    @property
    def thinned(self) -> bool:
        """Whether points were left out."""
        return self.points < self.of


def view(results: Results) -> View | None:
    """The viewer of a run, within the room a report has; None without a plate."""
    if results.surface is None:
        return None
    mark, even = damper_mark(results.scene, results.surface), even_thickness(results.scene)
    return of_surface(results.surface, results.speeds, mark, even, (middle_speed(results.speeds), 0))


def even_thickness(scene: Scene) -> float | None:
    """Of the whole plate [m]; None where it varies, or where there is no plate."""
    thickness = None if scene.plate is None else scene.plate.thickness
    return thickness if isinstance(thickness, float) else None


def damper_mark(scene: Scene, surface: Surface) -> tuple[float, ...] | None:
    """Where the damper is, (x, y) on a plate, (x, y, z) in space as it is drawn [m]; None where there is none."""
    if surface.frame is not None:
        return None if surface.mark is None else tuple(surface.drawn(surface.mark).tolist())
    return None if scene.damper is None else plate_mesh.damper_at(scene, surface.points.T[:2])


def of_surface(
    surface: Surface,
    speeds: tuple[SpeedPoint, ...] = (),
    mark: tuple[float, ...] | None = None,
    thickness: float | None = None,
    first: tuple[int, int] = (0, 0),
    most: int = POINTS,
    size: int = _BYTES,
) -> View:
    """The viewer of a surface.

    Args:
        surface: with as many shapes as there are, also none.
        speeds: those of the run, which `surface.at` counts.
        mark: where the damper is, (x, y) on a plate, (x, y, z) in space as it is drawn [m], if there is one.
        thickness: of the whole plate [m]; None where `surface` has it or it is not known.
        first: which of the speeds is shown first, or the one kept next to it, and which of its modes, both from 0.
        most: points that the page has room for.
        size: bytes of vectors that it has room for.
    """
    surface = surface.finer or surface
    drawn = thinned(surface, most)
    shapes, behind = _shapes(surface, drawn.kept)
    few = [_few(np.concatenate([shapes, behind])[:, :, k]) for k in range(3)] if len(shapes) else []
    rank = sum(len(along) for along, _ in few)
    fit = max(_FEWEST, size // (2 * max(rank, 1))) if few else most
    if fit < len(drawn.kept) and fit < most:
        return of_surface(surface, speeds, mark, thickness, first, fit, size)
    data = _plate(surface, drawn, thickness) | {"damper": None if mark is None else list(map(float, mark))}
    data |= {"speeds": [], "behind": bool(len(behind)), "shapes": [], "first": [0, 0]}
    if few:
        for point in (speeds[at] for at in surface.at):
            modes = [{"hz": m.frequency_hz, "family": m.family, "branch": m.branch} for m in point.modes]
            data["speeds"].append({"rpm": point.rpm, "modes": modes[: surface.shapes.shape[1]]})
        data["first"] = [surface.row(first[0]), first[1]]
        data["shapes"] = vectors(few)
    return View(for_a_page(data), len(surface.points), len(drawn.kept), bool(few))


def _plate(surface: Surface, drawn: Thinned, thickness: float | None) -> dict[str, Any]:
    """Points, triangles, edges and what is marked on them."""
    places = surface.drawn(surface.points[drawn.kept])[:, : 2 if surface.frame is None else 3]
    low = places.min(axis=0)
    span = np.maximum(np.ptp(places, axis=0), 1e-6 * np.ptp(places, axis=0).max())
    return {
        "low": low.tolist(),
        "span": span.tolist(),
        "points": unsigned(np.round((places - low) / span * 65535.0)),
        "triangles": unsigned(drawn.triangles),
        "edges": "" if drawn.edges is None else unsigned(drawn.edges),
        "outline": unsigned(drawn.outline),
        "root": unsigned(drawn.root),
        "thickness": _thickness(surface, drawn, thickness),
        "axes": _axes(surface),
    }


def _axes(surface: Surface) -> dict[str, list[float]]:
    """Directions of the coordinates and of the spin axis, if it is known, as they are drawn."""
    named = {**dict(zip("xyz", np.eye(3), strict=True)), "spin axis": surface.axis}
    return {name: np.round(surface.drawn(axis), 4).tolist() for name, axis in named.items() if axis is not None}


def _thickness(surface: Surface, drawn: Thinned, thickness: float | None) -> dict[str, Any]:
    """The thickness [m] of all points, or of each as a part of the largest; 0 where it is not known."""
    if surface.thickness is None:
        return {"largest": thickness or 0.0, "parts": ""}
    largest = float(surface.thickness.max())
    return {"largest": largest, "parts": shorts(surface.thickness[drawn.kept], largest)}


def _shapes(surface: Surface, nodes: Indices) -> tuple[Floats, Floats]:
    """Shapes (speeds × modes, n, 3) in phase, and a quarter of a period behind; each with a largest swing of 1.

    None of the latter where all points of a mode move in phase.
    """
    if not surface.shapes.size:
        return np.zeros((0, len(nodes), 3)), np.zeros((0, len(nodes), 3))
    shapes = surface.drawn(surface.shapes.reshape(-1, *surface.shapes.shape[2:]))
    behind = None if surface.behind is None else surface.behind.reshape(shapes.shape)
    squares = (shapes**2).sum(axis=2) if behind is None else (shapes**2 + behind**2).sum(axis=2)
    largest = np.sqrt(squares.max(axis=1))
    most = np.abs(shapes).reshape(len(shapes), -1).argmax(axis=1)
    sign = np.where(shapes.reshape(len(shapes), -1)[np.arange(len(shapes)), most] < 0, -1.0, 1.0)
    scale = (sign / np.where(largest > 0, largest, 1.0))[:, None, None]
    return shapes[:, nodes] * scale, np.zeros((0, len(nodes), 3)) if behind is None else behind[:, nodes] * scale


def for_a_page(data: dict[str, Any]) -> str:
    """JSON that ends no script element."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


@dataclass(frozen=True, eq=False)
class Thinned:
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


def thinned(surface: Surface, most: int) -> Thinned:
    """The mesh itself where it has at most so many points, or else about as many of its points in triangles."""
    if len(surface.points) > most:
        return _decimated(surface, most)
    cells, edges = surface.cells[1], surface.lines
    if edges is None:
        sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2)
        edges = np.asarray(np.unique(np.sort(sides, axis=1), axis=0))
    return Thinned(np.arange(len(surface.points)), surface.triangles, edges, surface.outline, surface.root)


def _decimated(surface: Surface, most: int) -> Thinned:
    """The triangles that the curvature of a surface needs, between about so many of its points.

    A plate is laid on a paraboloid for it, which is as curved everywhere: else a flat part would need no point.
    """
    import pyvista as pv
    from scipy.spatial import KDTree

    from fem.modal_model import edges

    points = surface.points
    if surface.frame is None:
        square = ((points - points.mean(axis=0)) ** 2).sum(axis=1)
        points = np.column_stack([points[:, :2], _BENT * square / np.ptp(points, axis=0).max()])
    whole = pv.PolyData.from_regular_faces(points, surface.triangles)
    left = whole.decimate_pro(1.0 - most / len(points), feature_angle=_FOLD, preserve_topology=True)
    triangles = np.asarray(left.regular_faces, dtype=np.int64)
    nodes = np.asarray(KDTree(points).query(left.points)[1], dtype=np.int64)
    outline = edges(surface.points[nodes], triangles)
    at_root = np.isin(nodes, surface.root)
    return Thinned(nodes, triangles, None, outline, outline[at_root[outline].all(axis=1)])


def _few(along: Floats) -> tuple[Floats, Floats]:
    """The fewest vectors (r, n), and shares (count, r), whose product is `along` (count, n) to half of ERROR."""
    # Of the small matrix of inner products, for singular values below ERROR are of no use: far faster than an SVD.
    left = np.linalg.eigh(along @ along.T)[1][:, ::-1]
    right, rest, rank = left.T @ along, along.copy(), 0
    while rank < len(left) and np.abs(rest).max(initial=0.0) > 0.5 * ERROR:
        rest -= np.outer(left[:, rank], right[rank])
        rank += 1
    return right[:rank], left[:, :rank]


def shorts(values: Floats, largest: float) -> str:
    """Numbers between -largest and largest as 16-bit integers, in base64."""
    return base64_of(np.round(values * (32767.0 / (largest or 1.0))).astype("<i2"))


def unsigned(numbers: Any) -> str:
    """Numbers from 0 to 65535 as 16-bit integers, in base64."""
    return base64_of(np.asarray(numbers).astype("<u2"))


def base64_of(array: Any) -> str:
    """The bytes of an array in base64."""
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def vectors(few: list[tuple[Floats, Floats]]) -> list[dict[str, Any]]:
    """Vectors (scaled by `largest`) and shares (32-bit floats) of each direction, ready for JSON."""
    packed = []
    for along, shares in few:
        largest = float(np.abs(along).max(initial=0.0))
        scaled = {"rank": len(along), "largest": largest, "vectors": shorts(along, largest)}
        packed.append(scaled | {"shares": base64_of(shares.astype("<f4"))})
    return packed


def screen_exists() -> bool:
    """Whether this machine, as far as it tells, has a screen to open a window on."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
