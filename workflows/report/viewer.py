"""What the viewer in a page shows (templates/viewer.js): the surface, its modes at every speed kept, as plain data."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from workflows.report import packing, thinning
from workflows.scene import plate_mesh
from workflows.scene.scene import Scene
from workflows.solve.records import Floats, Results, SpeedPoint, Surface, shown

POINTS = 1200
"""Points of a surface in a page that has more to show."""

_BYTES = 60_000
"""What the vectors of the shapes may take there, before they are written as text."""

_LEAST = 300
"""Points down to which a surface is thinned to make room for its shapes."""


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
    kept = shown(results.speeds)
    return of_surface(results.surface, results.speeds, results.scene, kept)


def of_surface(
    surface: Surface, speeds: tuple[SpeedPoint, ...], scene: Scene | None, first: int = 0, most: int = POINTS
) -> View:
    """The viewer of a surface.

    Args:
        surface: with as many shapes as there are, also none.
        speeds: those of the run, which `surface.at` counts.
        scene: says where the damper is and how thick the plate; None for a mesh alone.
        first: which of the speeds is shown first, or the one kept next to it.
        most: points to be drawn.
    """
    drawn = thinning.shown(surface, most)
    shapes, behind = _shapes(surface, drawn.kept)
    found = packing.packed(np.concatenate([shapes, behind])) if len(shapes) else None
    room = most if found is None else max(_LEAST, _BYTES * most // POINTS // (2 * max(found.rank, 1)))
    if room < len(drawn.kept):
        return of_surface(surface, speeds, scene, first, room)
    data = _plate(surface, drawn, scene) | {"speeds": [], "behind": bool(len(behind)), "shapes": []}
    if found is not None:
        data["speeds"] = [_speed(speeds[at], surface.shapes.shape[1]) for at in surface.at]
        data["first"] = int(np.argmin(np.abs(np.asarray(surface.at) - first)))
        data["shapes"] = packing.vectors(found)
    return View(_for_a_page(data), len(surface.points), len(drawn.kept), found is not None)


def _plate(surface: Surface, drawn: thinning.Shown, scene: Scene | None) -> dict[str, Any]:
    """Points, triangles, edges and what is marked on them."""
    places = surface.points[drawn.kept, :2]
    low, span = places.min(axis=0), np.ptp(places, axis=0)
    data: dict[str, Any] = {
        "low": low.tolist(),
        "span": span.tolist(),
        "points": packing.whole(np.round((places - low) / span * 65535.0)),
        "triangles": packing.whole(drawn.triangles),
        "edges": "" if drawn.edges is None else packing.whole(drawn.edges),
        "outline": packing.whole(drawn.outline),
        "root": packing.whole(drawn.root),
        "thickness": _thickness(surface, drawn, scene),
        "damper": None,
    }
    if scene is not None and scene.damper is not None:
        data["damper"] = list(map(float, plate_mesh.damper_at(scene, surface.points.T[:2])))
    return data


def _thickness(surface: Surface, drawn: thinning.Shown, scene: Scene | None) -> dict[str, Any]:
    """The thickness [m] of all points, or of each as a part of the largest; 0 where it is not known."""
    if surface.thickness is not None:
        largest = float(surface.thickness.max())
        return {"largest": largest, "parts": packing.shorts(surface.thickness[drawn.kept], largest)}
    known = None if scene is None or scene.plate is None else scene.plate.thickness
    return {"largest": known if isinstance(known, float) else 0.0, "parts": ""}


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
