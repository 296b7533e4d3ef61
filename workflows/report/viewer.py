"""What the viewer in a page shows (templates/viewer.js): the surface, its modes at every speed kept, as plain data."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from workflows.report import packing, thinning
from workflows.scene import plate_mesh
from workflows.solve.records import Floats, Results, SpeedPoint, Surface, shown

POINTS = 1200
"""Points of a surface in a page that has more to show."""

_LEAST = 300
"""Points down to which a surface is thinned to make room for its shapes."""


@dataclass(frozen=True)
class Room:
    """What a page has room for: points of a surface, and bytes of its shapes' vectors before they are text."""

    points: int = POINTS
    bytes: int = 60_000


IN_A_REPORT = Room()


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
    mark = None
    if results.scene.damper is not None:
        mark = plate_mesh.damper_at(results.scene, results.surface.points.T[:2])
    plate = results.scene.plate
    thickness = None if plate is None or not isinstance(plate.thickness, float) else plate.thickness
    return of_surface(results.surface, results.speeds, mark, thickness, (shown(results.speeds), 0))


def of_surface(
    surface: Surface,
    speeds: tuple[SpeedPoint, ...] = (),
    mark: tuple[float, float] | None = None,
    thickness: float | None = None,
    first: tuple[int, int] = (0, 0),
    room: Room = IN_A_REPORT,
) -> View:
    """The viewer of a surface.

    Args:
        surface: with as many shapes as there are, also none.
        speeds: those of the run, which `surface.at` counts.
        mark: where the damper is (x, y) [m], if there is one.
        thickness: of the whole plate [m]; None where `surface` has it or it is not known.
        first: which of the speeds is shown first, or the one kept next to it, and which of its modes, both from 0.
        room: what the page has room for.
    """
    surface = surface.finer or surface
    drawn = thinning.shown(surface, room.points)
    shapes, behind = _shapes(surface, drawn.kept)
    found = packing.packed(np.concatenate([shapes, behind])) if len(shapes) else None
    fit = room.points if found is None else max(_LEAST, room.bytes // (2 * max(found.rank, 1)))
    if fit < len(drawn.kept) and fit < room.points:
        return of_surface(surface, speeds, mark, thickness, first, replace(room, points=fit))
    data = _plate(surface, drawn, thickness) | {"damper": None if mark is None else list(map(float, mark))}
    data |= {"speeds": [], "behind": bool(len(behind)), "shapes": [], "first": [0, 0]}
    if found is not None:
        data["speeds"] = [_speed(speeds[at], surface.shapes.shape[1]) for at in surface.at]
        data["first"] = [int(np.argmin(np.abs(np.asarray(surface.at) - first[0]))), first[1]]
        data["shapes"] = packing.vectors(found)
    return View(_for_a_page(data), len(surface.points), len(drawn.kept), found is not None)


def _plate(surface: Surface, drawn: thinning.Shown, thickness: float | None) -> dict[str, Any]:
    """Points, triangles, edges and what is marked on them."""
    places = surface.points[drawn.kept, :2]
    low, span = places.min(axis=0), np.ptp(places, axis=0)
    return {
        "low": low.tolist(),
        "span": span.tolist(),
        "points": packing.whole(np.round((places - low) / span * 65535.0)),
        "triangles": packing.whole(drawn.triangles),
        "edges": "" if drawn.edges is None else packing.whole(drawn.edges),
        "outline": packing.whole(drawn.outline),
        "root": packing.whole(drawn.root),
        "thickness": _thickness(surface, drawn, thickness),
    }


def _thickness(surface: Surface, drawn: thinning.Shown, thickness: float | None) -> dict[str, Any]:
    """The thickness [m] of all points, or of each as a part of the largest; 0 where it is not known."""
    if surface.thickness is None:
        return {"largest": thickness or 0.0, "parts": ""}
    largest = float(surface.thickness.max())
    return {"largest": largest, "parts": packing.shorts(surface.thickness[drawn.kept], largest)}


def _shapes(surface: Surface, kept: thinning.Indices) -> tuple[Floats, Floats]:
    """Shapes (speeds × modes, n, 3) in phase, and a quarter of a period behind; each with a largest swing of 1.

    None of the latter where all points of a mode move in phase.
    """
    if not surface.shapes.size:
        return np.zeros((0, len(kept), 3)), np.zeros((0, len(kept), 3))
    shapes = surface.shapes.reshape(-1, *surface.shapes.shape[2:])
    behind = None if surface.behind is None else surface.behind.reshape(shapes.shape)
    squares = (shapes**2).sum(axis=2) if behind is None else (shapes**2 + behind**2).sum(axis=2)
    largest = np.sqrt(squares.max(axis=1))
    most = np.abs(shapes).reshape(len(shapes), -1).argmax(axis=1)
    sign = np.where(shapes.reshape(len(shapes), -1)[np.arange(len(shapes)), most] < 0, -1.0, 1.0)
    scale = (sign / np.where(largest > 0, largest, 1.0))[:, None, None]
    return shapes[:, kept] * scale, np.zeros((0, len(kept), 3)) if behind is None else behind[:, kept] * scale


def _speed(point: SpeedPoint, count: int) -> dict[str, Any]:
    """What the selectors say of a speed's modes with a shape: numbers as in `results.json`."""
    modes = [{"hz": mode.frequency_hz, "family": mode.family, "branch": mode.branch} for mode in point.modes[:count]]
    return {"rpm": point.rpm, "modes": modes}


def _for_a_page(data: dict[str, Any]) -> str:
    """JSON that ends no script element."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
