"""The report: one self-contained HTML page for a person."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass
from functools import partial
from typing import Any

from workflows import wording
from workflows.findings import answer, cutoffs, of_the_ball, trust, worth
from workflows.findings.assumptions import assumptions
from workflows.report import (
    drawing,
    figure_books,
    figure_path,
    figure_working,
    figures,
    hover,
    mesh_figure,
    palette,
    player,
    templating,
    viewer,
)
from workflows.report.mode_shape import Picture
from workflows.report.viewer import View
from workflows.results import curves, resolved
from workflows.results.crossings import Crossing, crossings
from workflows.results.provenance import hashes, versions
from workflows.scene import paper
from workflows.solve.records import Results, SpeedPoint

_MODES_AT_MOST = 7
"""Columns of the table of a plate without a damper."""


@dataclass(frozen=True)
class Drawings:
    """The pictures of a report: SVG elements (empty where there is nothing to draw) and the mode shape."""

    campbell: str
    mesh: str
    velocity: str
    capacity: str
    working: str
    books: str
    path: str
    css: str
    shape: Picture | None = None
    view: View | None = None


def draw(results: Results) -> Drawings:
    """Make the figures; the slow part of a report."""
    with drawing.style():
        return Drawings(
            campbell=drawing.both(partial(figures.campbell, results)),
            mesh=drawing.both(partial(mesh_figure.mesh, results)),
            velocity=drawing.both(partial(figures.velocity, results)),
            capacity=drawing.both(partial(figures.capacity, results)),
            working=drawing.both(partial(figure_working.working, results)),
            books=drawing.both(partial(figure_books.books, results)),
            path=drawing.both(partial(figure_path.cavity_path, results)),
            css=palette.shades_css(len(results.speeds)),
            view=viewer.view(results),
        )


def render(results: Results, drawings: Drawings) -> str:
    """The page. Everything that comes from a scene is escaped."""
    words = (wording.fixed, wording.amount, wording.significant, wording.percent, wording.curly)
    return templating.page(
        "report.html.j2",
        {word.__name__: word for word in words},
        drawings.css,
        **_said(results),
        **_tabulated(results),
        **_pictured(results, drawings),
        **_of_the_mode(results, drawings),
    )


def _said(results: Results) -> dict[str, Any]:
    """What there is in words: the answer, what was taken for granted, where it all comes from."""
    return {
        "results": results,
        "scene": results.scene,
        "answer": answer.answer(results),
        "thick": _thick(results),
        "held": mesh_figure.held(results.scene),
        "assumptions": assumptions(results),
        "versions": versions(),
        "hashes": hashes(results),
        "settings": _settings(resolved.scene(results.scene, results.effects, results.theory)),
    }


def _tabulated(results: Results) -> dict[str, Any]:
    """What tables show, and the yardsticks beside it."""
    return {
        "rows": [_row(results, point) for point in results.speeds],
        "errors": trust.worst(results),
        "error_parts": trust.PARTS,
        "mode_columns": min(len(results.speeds[0].modes), _MODES_AT_MOST),
        "driven": _driven(results),
        "tilts": any(p.tilted for p in results.speeds),
        "has_table": any(paper.row(results.scene, p.load_g) for p in results.speeds),
        "air": worth.AIR,
        "endured": worth.endured(results),
        "beyond": worth.beyond(results),
        "marks": worth.legend(results),
        "at_rest": cutoffs.legend(results),
    }


def _pictured(results: Results, drawings: Drawings) -> dict[str, Any]:
    """The figures, the values under the pointer, and the player of the ball's path."""
    from markupsafe import Markup

    names = ("campbell", "mesh", "velocity", "capacity", "working", "books", "path")
    return {name: Markup(getattr(drawings, name)) for name in names} | {
        "points": {
            "campbell": hover.campbell(results) if drawings.campbell else "",
            "working": hover.working(results) if drawings.working else "",
            "books": hover.books(results) if drawings.books else "",
        },
        "hovering": templating.script("hover.js"),
        "cells_drawn": results.surface is not None and mesh_figure.cells_are_drawn(results.surface),
        "fast": any(figures.is_fast(track) for p in results.speeds for track in curves.velocity(p)),
        "bands": any(figures.is_band(p.damping.sdc) for p in results.speeds if p.damping),
        "shown": next((p for p in results.speeds if p.damping and p.damping.history), None),
        "playing": player.data(results) if drawings.path else "",
        "playing_script": templating.script("player.js"),
        "stretch": _stretch(results),
    }


def _of_the_mode(results: Results, drawings: Drawings) -> dict[str, Any]:
    """The first mode's picture, and the viewer in which every mode is turned."""
    shape = drawings.shape
    return {
        "shape": None if shape is None else base64.b64encode(shape.png).decode(),
        "shape_remark": "" if shape is None else shape.remark,
        "shape_point": _shape_point(results),
        "view": drawings.view,
        "script": templating.script("viewer.js"),
    }


def _thick(results: Results) -> str:
    """How thick the plate is, in words: one thickness, or the least and the greatest."""
    plate, surface = results.scene.plate, results.surface
    if plate is None:
        return ""
    if isinstance(plate.thickness, float):
        return f"{wording.significant(1e3 * plate.thickness)} mm thick"
    if surface is None or surface.thickness is None:
        return "its thickness varies"
    low, high = (wording.significant(1e3 * float(end)) for end in (surface.thickness.min(), surface.thickness.max()))
    return f"{low} to {high} mm thick"


def _driven(results: Results) -> list[Crossing] | None:
    """Where the orders of the scene's [excitation] meet modes; None without that table."""
    asked = results.scene.excitation
    if asked is None:
        return None
    return [meeting for meeting in crossings(results) if meeting.order in asked.orders]


def _stretch(results: Results) -> dict[str, Any] | None:
    """What the figure of the ball's path says of the stretch that it shows; None without one."""
    found = figure_path.of(results)
    if found is None:
        return None
    path, point = found
    begin, end = (float(path.t[k]) for k in (0, -1))
    return {
        "point": point,
        "cycles": (end - begin) * figure_path.frequency(point),
        "begin": 1e3 * begin,
        "hits": path.kind.count("hit"),
    }


def _row(results: Results, point: SpeedPoint) -> dict[str, Any]:
    """A line of the tables."""
    return {
        "point": point,
        "frequency": answer.first_frequency(point),
        "paper": paper.row(results.scene, point.load_g),
        "mark": worth.mark(results, point),
        "cutoff": cutoffs.shown(results, point),
        "share": -math.expm1(-4 * math.pi * point.working.peak) if point.working else 0.0,
        "damping": point.damping,
        "lost": None if point.damping is None else of_the_ball.lost_at_most(point.damping),
    }


def _shape_point(results: Results) -> SpeedPoint | None:
    from workflows.solve.records import shown

    return results.speeds[shown(results.speeds)] if results.surface is not None else None


def _settings(scene: dict[str, Any]) -> list[tuple[str, list[tuple[str, str]]]]:
    """The resolved scene as tables of text, in SI."""
    top = [(key, _text(value)) for key, value in scene.items() if not isinstance(value, dict)]
    tables = [("", top)]
    tables += [
        (f"[{name}]", [(key, _text(value)) for key, value in table.items()])
        for name, table in scene.items()
        if isinstance(table, dict)
    ]
    return tables


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        items = [_text(item) for item in value]
        return f"[{', '.join(items[:12])}{', …' if len(items) > 12 else ''}]"
    return f'"{value}"' if isinstance(value, str) else str(value)
