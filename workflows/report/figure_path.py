"""The figure of the ball in its cavity, seen from above, beside its places and the structure's motion over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workflows.report import drawing, palette
from workflows.report.drawing import Sheet
from workflows.report.thinning import Indices
from workflows.results import curves
from workflows.solve.records import BallPath, Floats, Results, SpeedPoint
from workflows.wording import amount

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = (palette.CATEGORIES[0], palette.CATEGORIES[2])
"""Along the axes 1 and 2."""

LINED = 2.0
"""Cycles of which the way is drawn as a line: more would cover each other."""

_FINE = 0.03
"""Part of a picture's height that is too small to be drawn: the last bounces before the ball stays at a wall."""

_LENGTH = 4.0
"""Of a picture over time, in its heights."""

_DOT = 0.004
"""Part of the time shown that a dot covers."""


def of(results: Results) -> tuple[BallPath, SpeedPoint] | None:
    """The path kept and the speed it belongs to; None where no ball moved."""
    for point in results.speeds:
        if point.damping is not None and point.damping.path is not None:
            return point.damping.path, point
    return None


def frequency(point: SpeedPoint) -> float:
    """Of the structure with the ball at rest in its cavity [Hz]."""
    if point.reduced is None:
        raise ValueError("a ball has moved in a structure that is not known")
    return point.reduced.f1_hz


def cavity_path(results: Results, sheet: Sheet) -> str:
    """The ball's path for a page; nothing where no ball moved."""
    found, given = of(results), results.scene.damper
    if found is None or given is None:
        return ""
    path, point = found
    figure, (above, ball, structure) = drawing.beside(sheet, 2.5, 2)
    _from_above(above, path, given.cavity, given.radius, LINED / frequency(point))
    _over_time(ball, path, path.ball)
    for i in curves.moving(path.ball):
        half = 1e3 * (given.cavity[i] / 2 - given.radius)
        for side in (-half, half):
            ball.axhline(side, color=COLOURS[i], lw=0.7, ls=(0, (4, 3)))
    at, axis = _hits(path)
    ball.plot(1e3 * path.t[at], 1e3 * path.ball[at, axis], "o", ms=2.4, color=palette.CATEGORIES[1], zorder=3)
    _over_time(structure, path, path.structure)
    ball.set(title="Ball from the middle of its cavity, mm")
    structure.set(title="Structure at the cavity, mm", xlabel="time, ms")
    if len(curves.moving(path.structure)) == 2 or len(curves.moving(path.ball)) == 2:
        structure.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    said = f"The ball’s path in its cavity at {amount(point.rpm)} rpm, seen from above"
    return drawing.svg(figure, sheet, "path", said, live=True)


def contacts(path: BallPath, radius: float) -> Floats:
    """Places on the walls that were hit, (k, 2) [m], those that a dot shows apart."""
    at, axes = _hits(path)
    places = path.ball[at].copy()
    rows = np.arange(len(places))
    places[rows, axes] += radius * np.sign(places[rows, axes])
    grid = _DOT * np.abs(places).max(initial=1.0e-300)
    return places[np.unique(np.round(places / grid), axis=0, return_index=True)[1]]


def _apart(places: Floats, least: float) -> list[int]:
    """Of places (n, 2) one after another those that lie at least so far from the last one taken, and both ends."""
    kept = [0]
    for k in range(1, len(places) - 1):
        if np.hypot(*(places[k] - places[kept[-1]])) >= least:
            kept.append(k)
    return [*kept, len(places) - 1]


def _from_above(axes: Axes, path: BallPath, cavity: tuple[float, float], radius: float, line: float) -> None:
    """The cavity to scale, the ball where it began, its way for the time `line` [s] and where it hit the walls."""
    from matplotlib.patches import Circle, Rectangle

    a, b = (1e3 * side for side in cavity)
    axes.add_patch(Rectangle((-a / 2, -b / 2), a, b, fill=False, ec=palette.INK, lw=1.3))
    begun = Circle((1e3 * path.ball[0, 0], 1e3 * path.ball[0, 1]), 1e3 * radius)
    begun.set(fill=False, ec=palette.MUTED, lw=0.8, ls=(0, (1.5, 2)))
    axes.add_patch(begun)
    way = path.ball[path.t <= path.t[0] + line]
    axes.plot(*(1e3 * way[_apart(way, _FINE * max(cavity))].T), color=COLOURS[0], lw=0.7)
    axes.plot(*(1e3 * contacts(path, radius).T), "o", ms=2.4, color=palette.CATEGORIES[1])
    axes.set(xlim=(-0.53 * a, 0.53 * a), ylim=(-0.53 * b, 0.53 * b), aspect="equal")
    axes.set(title="Cavity from above, mm", xlabel="axis 1, bending", ylabel="axis 2, across")
    axes.grid(visible=False)


def _over_time(axes: Axes, path: BallPath, motion: Floats) -> None:
    t, reach = (path.t - path.t[0]) / (path.t[-1] - path.t[0]), np.abs(motion).max()
    for i in curves.moving(motion):
        kept = _apart(np.column_stack([_LENGTH * t, motion[:, i] / reach]), _FINE)
        axes.plot(1e3 * path.t[kept], 1e3 * motion[kept, i], color=COLOURS[i], lw=0.9, label=f"axis {i + 1}")
    axes.set(xlim=(1e3 * path.t[0], 1e3 * path.t[-1]))


def _hits(path: BallPath) -> tuple[Indices, Indices]:
    """Which of the times have a wall hit and along which axis; of several that one dot shows, the first."""
    hits = np.flatnonzero([kind == "hit" for kind in path.kind])
    at, axis = path.at[hits], path.axis[hits]
    side = np.sign(path.ball[at, axis]) + 3 * axis
    square = np.column_stack([side, np.floor((path.t[at] - path.t[0]) / (_DOT * (path.t[-1] - path.t[0])))])
    first = np.unique(square, axis=0, return_index=True)[1]
    return at[first], axis[first]
