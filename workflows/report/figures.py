"""The figures of a run, each drawn by one function: for its report, and as axes of matplotlib's for Python."""

from __future__ import annotations

import html
from base64 import b64encode
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from workflows.errors import BadInput, present
from workflows.formatting import amount, rounded_rpm, significant
from workflows.io import files
from workflows.report import plots
from workflows.report.mode_viewer import POINTS, Indices, damper_mark, screen_exists, thinned
from workflows.report.plots import PAGE, Target, Value
from workflows.scene import paper
from workflows.scene.scene import Scene, as_typed, omega_of
from workflows.solve import limits
from workflows.solve.engine_orders import branches, crossings, orders
from workflows.solve.results import BallPath, Figures, Floats, OwnFigures, Results, SpeedPoint, Surface, middle_speed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LINE = 0.052
"""Height of a line of text, in heights of the Campbell diagram."""

_SWINGS_AN_INCH = 10.0
"""More than that are drawn as an envelope."""

_CYCLES_AT_MOST = 80
"""Cycles of a ring-down of which each is drawn; beyond, there are as many pieces."""

_LEAST_AMPLITUDE = 0.1
"""Part of the least amplitude of any curve at which the axis begins at the latest, whatever ticks lie below it."""

_OTHER_WAYS = {"from_above": (0, (4, 2)), "slow_ramp": (0, (4, 2, 1, 2)), "abrupt_start": (0, (1, 2))}
"""Lines of damping curves from other starts."""

_MARGIN = 1.1
"""By what the axis goes beyond its ends."""

_LEAST_SHOWN = 1e-3
"""Share of the largest damping ratio at which the axis ends, unless a peak is lower than ten times that."""

_AXES = (plots.CATEGORIES[0], plots.CATEGORIES[2])
"""Along the axes 1 and 2."""

_LINED = 2.0
"""Cycles of which the way is drawn as a line: more would cover each other."""

_FINE = 0.03
"""Part of a picture's height that is too small to be drawn: the last bounces before the ball stays at a wall."""

_LENGTH = 4.0
"""Of a picture over time, in its heights."""

_DOT = 0.004
"""Part of the time shown that a dot covers."""

_LONGEST_IN_MM = 2.0
"""Plates [m] up to which the axes are in mm."""

_SMALLEST = 1.8
"""Points of a side of a cell below which the cells would be a grey block."""

_LOWEST, _HIGHEST = 1.1, 4.0
"""Inches that the axes are high."""

_LABELS = 0.9
"""Inches that labels take beside the axes, and below."""

_SWING = 0.14
"""Largest displacement drawn, in lengths of the plate."""

SHOWN = {
    "campbell": "Campbell diagram: natural frequencies over rotation speed",
    "mesh": "Mesh of the plate from above: cells and root",
    "velocity": "Velocity of the structure over time",
    "capacity": "Specific damping capacity over acceleration amplitude",
    "working": "Damping ratio by the ball over the amplitude of the vibration",
    "path": "The ball’s path in its cavity",
}
"""The figures of a report, and what they show."""


def report(results: Results) -> dict[str, str]:
    """Every figure of a run as an SVG element of its report; empty where there is nothing to draw."""
    values, page = {"campbell": _frequencies, "working": _damping_ratios}, {}
    draws = (campbell, mesh, velocity, capacity, damping_ratio, cavity_path)
    for (name, description), draw in zip(SHOWN.items(), draws, strict=True):
        figure, page[name] = draw(results), ""
        if figure is not None:
            if name == "path" and (path := path_shown(results)) is not None:
                description += f" at {amount(path[1].rpm)} rpm, seen from above"
            named = values[name](results) if name in values else ()
            page[name] = plots.svg(figure, name, description, named, frames=name == "path")
    return page


def _frequencies(results: Results) -> Iterator[Value]:
    """Frequencies with their errors, which lead to the mode; then crossings with engine orders."""
    surface_speeds = () if results.surface is None else results.surface.at
    for branch in branches(results):
        for at, number in branch.places:
            mode, rpm = results.speeds[at].modes[number], results.speeds[at].rpm
            error = "" if mode.error_estimate is None else f", ± {significant(100 * mode.error_estimate, 2)} %"
            here = "" if mode.family == branch.family else f" ({mode.family} here)"
            title = f"{branch.label}{here}, mode {number + 1}: {rpm:.6g} rpm, {mode.frequency_hz:.6g} Hz{error}"
            leads = (surface_speeds.index(at), number) if at in surface_speeds else None
            yield Value(rpm, mode.frequency_hz, title, leads)
    for meeting in crossings(results):
        title = f"{meeting.order}× meets {meeting.label}: {meeting.rpm:.6g} rpm, {meeting.frequency_hz:.6g} Hz"
        yield Value(meeting.rpm, meeting.frequency_hz, title)


def _damping_ratios(results: Results) -> Iterator[Value]:
    """The damping ratio by the ball over the amplitude at each load."""
    for line in files.damping_ratio(results):
        for x, y in zip(1e3 * line.x, 100 * line.y, strict=True):
            if y > 0:
                yield Value(x, y, f"{line.label}: {x:.6g} mm, {y:.6g} %")


def campbell(results: Results, target: Target = PAGE) -> Figure | None:
    """Frequencies over speed with the engine orders that excite them; None for a plate at rest."""
    tracks, fastest = files.campbell(results), max(point.rpm for point in results.speeds)
    if not tracks or fastest == 0:
        return None
    figure, (axes,) = plots.canvas(3.5, target=target)
    highest = 1.06 * max(float(track.y.max()) for track in tracks)
    axes.set(xlim=(0, fastest), ylim=(0, highest), xlabel="rotation speed, rpm", ylabel="frequency, Hz")
    _engine_orders(axes, orders(results.scene), fastest, highest)
    colours = [_branch(axes, track) for track in tracks]
    heights = _spread([float(track.y[-1]) for track in tracks], _LINE * highest)
    for y, track, colour in zip(heights, tracks, colours, strict=True):
        plots.note(axes, track.label, (fastest, y), (24, 0), va="center", color=colour)
    meetings = crossings(results)
    met = [meeting.rpm for meeting in meetings], [meeting.frequency_hz for meeting in meetings]
    axes.plot(*met, "o", ms=2.4, color=plots.INK, zorder=3)
    _table_two(axes, results)
    return figure


def velocity(results: Results, target: Target = PAGE) -> Figure | None:
    """The structure's velocity over time at one speed, where the ball stops marked (Fig. 2), or None."""
    point = next((p for p in results.speeds if files.velocity(p)), None)
    if point is None or point.damper is None:
        return None
    figure, (axes,) = plots.canvas(2.5, target=target)
    axes.axhline(0, color=plots.MUTED, lw=0.5)
    tracks = files.velocity(point)
    for track, colour in zip(tracks, plots.CATEGORIES, strict=False):
        _oscillation(axes, track, colour)
    end = max(1e3 * float(track.x[-1]) for track in tracks)
    stop = point.damper.stopped
    if stop is not None and 1e3 * stop < end:
        _stop(axes, 1e3 * stop, end)
    axes.set(xlim=(0, end), xlabel="time, ms", ylabel="velocity, m/s")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


def capacity(results: Results) -> Figure | None:
    """Specific damping capacity over amplitude for every load: all of it, and the ball's part (Fig. 3)."""
    lines = files.capacity(results)
    dampings = [p.damper for p in results.speeds if p.damper is not None and np.isfinite(p.damper.sdc).any()]
    if not lines:
        return None
    # Without damping of its own the structure's part is nothing, and the two pictures would be one.
    panels = 2 if any(damping.intrinsic_sdc for damping in dampings) else 1
    figure, drawn = plots.canvas(3.1, panels)
    whole, part = drawn[0], drawn[-1]
    low, high = min(float(line.x.min()) for line in lines), max(float(line.x.max()) for line in lines)
    scale = "log" if high > 3 * low > 0 else "linear"
    edges = np.asarray((np.geomspace if scale == "log" else np.linspace)(low, high, _CYCLES_AT_MOST + 1))
    for line, damping, colour in zip(lines, dampings, plots.shades(len(lines)), strict=True):
        if panels == 2:
            _cycles(whole, line, 100 * line.y, edges, colour)
        _cycles(part, line, 100 * (line.y - damping.intrinsic_sdc), edges, colour)
        if damping.cutoff_g is not None:
            part.axvline(damping.cutoff_g, ymax=0.035, color=colour, lw=1.6)
    _title(whole, part, lines, results)
    for axes in drawn:
        axes.set(xlabel="amplitude of the acceleration, g", xscale=scale)
    plots.legend(figure, part, title="load")
    return figure


def is_fast(track: files.Curve) -> bool:
    """Whether a vibration swings too often for each swing to be drawn."""
    return oscillations(track.y) > _SWINGS_AN_INCH * plots.WIDTH


def is_band(cycles: Floats) -> bool:
    """Whether a ring-down has too many cycles (n,) for each to be drawn."""
    return len(cycles) > _CYCLES_AT_MOST


def _branch(axes: Axes, track: files.Curve) -> str:
    """One frequency over speed; its colour."""
    colour, marker = plots.of_family(track.label.rsplit(" ", 1)[0])
    axes.plot(track.x, track.y, color=colour, marker=marker if len(track.x) <= 12 else "", clip_on=False)
    return colour


def _table_two(axes: Axes, results: Results) -> None:
    """The frequencies that the paper has at these speeds, if it has them."""
    known = [(point.rpm, row) for point in results.speeds if (row := paper.row(results.scene, point.load_g))]
    if known:
        ring: dict[str, Any] = {"ls": "", "marker": "o", "ms": 7, "mfc": "none", "mec": plots.INK, "mew": 0.8}
        theirs = [row.frequency for _, row in known]
        axes.plot([rpm for rpm, _ in known], theirs, label="Table II", clip_on=False, zorder=4, **ring)
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)


def _oscillation(axes: Axes, track: files.Curve, colour: str) -> None:
    """A vibration over time; only how far it swings where there are too many swings for the figure."""
    if not is_fast(track):
        axes.plot(1e3 * track.x, track.y, color=colour, lw=0.9, label=track.label)
        return
    pieces = oscillations(track.y) // 2
    reach = envelope(track.x, track.y, np.linspace(track.x[0], track.x[-1], pieces + 1))
    time = 1e3 * np.concatenate([track.x[:1], reach.x[1:-1], track.x[-1:]])
    axes.fill_between(time, reach.low, reach.high, color=colour, alpha=0.25, lw=0, label=track.label)
    for side in (reach.low, reach.high):
        axes.plot(time, side, color=colour, lw=0.9)


def _stop(axes: Axes, stop: float, end: float) -> None:
    late = stop > 0.6 * end
    axes.axvline(stop, color=plots.INK, lw=0.8, ls=plots.DASHED)
    side, offset = ("right", (-4, -1)) if late else ("left", (4, -1))
    plots.note(axes, "the ball comes to rest", (stop, 1.0), offset, ("data", "axes fraction"), va="top", ha=side)


def _cycles(axes: Axes, line: files.Curve, percent: Floats, edges: Floats, colour: str) -> None:
    """What each cycle takes; of many cycles the mean, between the least and the most."""
    if not is_band(line.y):
        axes.plot(line.x, percent, color=colour, marker="o", ms=2.4, lw=1.1, label=line.label)
        return
    reach = envelope(line.x, percent, edges)
    axes.fill_between(reach.x, reach.low, reach.high, color=colour, alpha=0.25, lw=0)
    axes.plot(reach.x, reach.mean, color=colour, lw=1.1, label=line.label)


def _title(whole: Axes, part: Axes, lines: list[files.Curve], results: Results) -> None:
    """Titles, the range of the axis, and what the paper reports."""
    top = 100 * max(float(line.y.max()) for line in lines)
    if part is not whole and paper.is_known(results.scene, (point.load_g for point in results.speeds)):
        low, high = (100 * value for value in paper.SDC_RANGE)
        whole.axhspan(low, high, color=plots.RULE, lw=0)
        middle = (0.97, (low + high) / 2)
        whole.annotate("the paper’s range", middle, xycoords=("axes fraction", "data"), ha="right", va="center")
        top = max(top, high)
    whole.set(
        ylim=(0, 1.12 * top or 1.0),
        title="All that a ring-down loses in a cycle",
        ylabel="specific damping capacity, %",
    )
    if part is not whole:
        part.set(title="Beyond the structure’s own damping")


def _engine_orders(axes: Axes, orders: tuple[int, ...], fastest: float, highest: float) -> None:
    """Multiples of the rotation speed, with their names at the edge that they leave the picture by."""
    aside: list[tuple[int, float]] = []
    for order in orders:
        end = order * fastest / 60
        if end < 0.04 * highest:
            continue
        axes.plot([0, fastest], [0, end], color=plots.MUTED, lw=0.5, ls=plots.DOTTED)
        if end <= 0.97 * highest:
            aside.append((order, end))
        else:
            _order(axes, order, 60 * 0.97 * highest / order, 0.97 * highest)
    for (order, _), y in zip(aside, _spread([end for _, end in aside], 0.65 * _LINE * highest), strict=True):
        _order(axes, order, fastest, y)


def _order(axes: Axes, order: int, x: float, y: float) -> None:
    small: dict[str, Any] = {"fontsize": 6.5, "color": plots.MUTED, "va": "center", "annotation_clip": False}
    plots.note(axes, f"{order}×", (x, y), (6, 0), **small)


def _spread(values: list[float], gap: float) -> list[float]:
    """Label positions moved up just enough to be `gap` apart."""
    positions: dict[int, float] = {}
    last = -np.inf
    for index in sorted(range(len(values)), key=values.__getitem__):
        last = max(values[index], last + gap)
        positions[index] = last
    return [positions[index] for index in range(len(values))]


def damping_ratio(results: Results, target: Target = PAGE) -> Figure | None:
    """Damping ratio over amplitude with peaks and cut-offs, beside what the air does; None without a damper."""
    lines = files.damping_ratio(results)
    points = [p for p in results.speeds if p.damping_curve is not None and p.damping_curve.amplitude.size]
    ranges, ends = [present(p.damping_curve) for p in points], [limits.endured(results, p.omega) for p in points]
    if not lines:
        return None
    figure, (axes,) = plots.canvas(3.1, target=target)
    top = 100 * limits.AIR[1]
    for line, figures, end, colour in zip(lines, ranges, ends, plots.shades(len(lines)), strict=True):
        borne = line.x <= end
        beyond = ~borne | np.append(~borne[1:], False)  # from the last point within the limit on
        parts = [(part, alpha) for part, alpha in ((borne, None), (beyond, _PALE)) if (line.y[part] > 0).any()]
        for (part, alpha), label in zip(parts, (line.label, None), strict=False):
            plots.damping_curve(axes, line.x[part], line.y[part], color=colour, lw=1.3, alpha=alpha, label=label)
        axes.plot(1e3 * figures.peak_amplitude, 100 * figures.peak, "o", color=colour, ms=4)
        for way, style in _OTHER_WAYS.items() if figures.ways_differ else ():
            other: Figures = getattr(figures, way)
            place = other.amplitude
            apart = (place > figures.folds[0] / _MARGIN) & (place < figures.folds[1] * _MARGIN)
            plots.damping_curve(axes, place[apart], other.damping_ratio[apart], color=colour, lw=1.0, ls=style)
            top = max(top, 100 * float(other.damping_ratio.max(initial=0.0)))
        if figures.cutoff > 0:
            axes.axvline(1e3 * figures.cutoff, ymax=0.035, color=colour, lw=1.6)
    peaks = [100 * figures.peak for figures in ranges]
    top = max(top, *peaks)
    least = max(min(peaks) / 10, _LEAST_SHOWN * max(peaks))
    plots.damping_axes(axes)
    axes.set(xlim=_from_to(lines, ranges), ylim=(min(least, 50 * limits.AIR[0]), 2 * top))
    words, look = "air alone, turbine blades", {"ha": "right", "va": "bottom", "color": plots.MUTED}
    plots.note(axes, words, (0.99, 100 * limits.AIR[1]), (0, 3), ("axes fraction", "data"), **look)
    plots.legend(figure, axes, target, title="speed")
    return figure


_PALE = 0.3
"""Opacity of a curve beyond the amplitude that the structure endures at its speed."""


def _from_to(lines: list[files.Curve], ranges: list[OwnFigures]) -> tuple[float, float]:
    """Ends of the axis [mm]: all of the curves, and ticks that are not far below them."""
    shown = np.concatenate([line.x[line.y > 0] for line in lines])
    ticks = [figures.cutoff for figures in ranges if figures.cutoff > 0]
    low = max(min([*ticks, shown.min()]), _LEAST_AMPLITUDE * shown.min())
    return 1e3 * low / _MARGIN, 1e3 * shown.max() * _MARGIN


def path_shown(results: Results) -> tuple[BallPath, SpeedPoint] | None:
    """The path kept and the speed it belongs to; None where no ball moved."""
    kept = ((point.damper.path, point) for point in results.speeds if point.damper is not None)
    return next(((path, point) for path, point in kept if path is not None), None)


def cavity_path(results: Results) -> Figure | None:
    """The ball from above, and over time with the structure's motion below; None where no ball moved."""
    from matplotlib.figure import Figure

    shown_path, spec = path_shown(results), results.scene.damper
    if shown_path is None or spec is None:
        return None
    path, point = shown_path
    figure = Figure(figsize=(plots.WIDTH, 5.6))
    figure.set_layout_engine("constrained", hspace=0.08)
    grid = figure.add_gridspec(3, 1, height_ratios=(2.6, 1.25, 1.25))  # a square, and two panels below it
    above, ball, structure = (figure.add_subplot(grid[k]) for k in range(3))
    _from_above(above, path, spec.cavity, spec.radius, _LINED / present(point.reduced).f1_hz)
    _over_time(ball, path, path.ball)
    for i in files.moving_axes(path.ball):
        half = 1e3 * (spec.cavity[i] / 2 - spec.radius)
        for side in (-half, half):
            ball.axhline(side, color=_AXES[i], lw=0.7, ls=plots.DASHED)
    at, axis = _hits(path)
    ball.plot(1e3 * path.t[at], 1e3 * path.ball[at, axis], "o", ms=2.4, color=plots.CATEGORIES[1], zorder=3)
    _over_time(structure, path, path.structure)
    ball.set(title="Ball from the middle of its cavity, mm")
    structure.set(title="Structure at the cavity, mm", xlabel="time, ms")
    if len(files.moving_axes(path.structure)) == 2 or len(files.moving_axes(path.ball)) == 2:
        structure.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


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
    indices = [0]
    for k in range(1, len(places) - 1):
        if np.hypot(*(places[k] - places[indices[-1]])) >= least:
            indices.append(k)
    return [*indices, len(places) - 1]


def _from_above(axes: Axes, path: BallPath, cavity: tuple[float, float], radius: float, line: float) -> None:
    """The cavity to scale, the ball where it began, its way for the time `line` [s] and where it hit the walls."""
    from matplotlib.patches import Circle, Rectangle

    a, b = (1e3 * side for side in cavity)
    axes.add_patch(Rectangle((-a / 2, -b / 2), a, b, fill=False, ec=plots.INK, lw=1.3))
    look: dict[str, Any] = {"fill": False, "ec": plots.MUTED, "lw": 0.8, "ls": (0, (1.5, 2))}
    axes.add_patch(Circle(tuple(1e3 * path.ball[0]), 1e3 * radius, **look))
    way = path.ball[path.t <= path.t[0] + line]
    axes.plot(*(1e3 * way[_apart(way, _FINE * max(cavity))].T), color=_AXES[0], lw=0.7)
    axes.plot(*(1e3 * contacts(path, radius).T), "o", ms=2.4, color=plots.CATEGORIES[1])
    axes.set(xlim=(-0.53 * a, 0.53 * a), ylim=(-0.53 * b, 0.53 * b), aspect="equal")
    axes.set(title="Cavity from above, mm", xlabel="axis 1, bending", ylabel="axis 2, across")
    axes.grid(visible=False)


def _over_time(axes: Axes, path: BallPath, motion: Floats) -> None:
    t, reach = (path.t - path.t[0]) / (path.t[-1] - path.t[0]), np.abs(motion).max()
    for i in files.moving_axes(motion):
        indices = _apart(np.column_stack([_LENGTH * t, motion[:, i] / reach]), _FINE)
        axes.plot(1e3 * path.t[indices], 1e3 * motion[indices, i], color=_AXES[i], lw=0.9, label=f"axis {i + 1}")
    axes.set(xlim=(1e3 * path.t[0], 1e3 * path.t[-1]))


def _hits(path: BallPath) -> tuple[Indices, Indices]:
    """Which of the times have a wall hit and along which axis; of several that one dot shows, the first."""
    hits = np.flatnonzero([kind == "hit" for kind in path.kind])
    at, axis = path.at[hits], path.axis[hits]
    side = np.sign(path.ball[at, axis]) + 3 * axis
    square = np.column_stack([side, np.floor((path.t[at] - path.t[0]) / (_DOT * (path.t[-1] - path.t[0])))])
    first = np.unique(square, axis=0, return_index=True)[1]
    return at[first], axis[first]


def mesh(results: Results, target: Target = PAGE) -> Figure | None:
    """The plate from above, in its own axes; None without a plate."""
    surface, scene = results.surface, results.scene
    if surface is None or surface.frame is not None:
        return None
    return mesh_of(surface, damper_mark(scene, surface), held(scene), target)


def mesh_of(surface: Surface, mark: tuple[float, ...] | None, root: str, target: Target = PAGE) -> Figure:
    """A surface from above, as it is drawn, with its damper (x, y, …) [m], if any; `root` says what its root is.

    Outwards is measured from the spin axis of a structure in space.
    """
    names = ("x, radial", "y, across") if surface.frame is None else _named_axes(surface.frame)
    axis = 0.0
    if surface.origin is not None and names[0] == _OUTWARDS:
        axis = float(surface.drawn(surface.origin)[0])
    surface = replace(surface, points=surface.drawn(surface.points) - np.array([axis, 0.0, 0.0]))
    mark = None if mark is None else (mark[0] - axis, *mark[1:])
    metres, unit = (1e3, "mm") if np.ptp(surface.points, axis=0).max() <= _LONGEST_IN_MM else (1.0, "m")
    points = metres * surface.points[:, :2]
    length, width = np.ptp(points, axis=0)
    inside = plots.WIDTH - _LABELS
    height = float(np.clip(inside * width / length, _LOWEST, _HIGHEST))
    figure, (axes,) = plots.canvas(height + _LABELS, target=target)
    seen = seen_from_above(surface)
    if cells_are_drawn(surface):
        around = np.column_stack([surface.cells[1], surface.cells[1][:, 0]])
        lines = around if surface.lines is None else surface.lines[seen[surface.lines].all(axis=1)]
        _draw(axes, points, lines, plots.MUTED, 0.35)
    _draw(axes, points, surface.outline[seen[surface.outline].all(axis=1)], plots.INK, 0.9)
    _draw(axes, points, surface.root, plots.CATEGORIES[0], 3.0)
    axes.plot([], [], color=plots.CATEGORIES[0], lw=3.0, label=root)
    if mark is not None:
        x, y = (metres * value for value in mark[:2])
        axes.plot(x, y, "o", ms=7, mfc="none", mec=plots.CATEGORIES[1], mew=1.6, label="damper", zorder=5)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel=f"{names[0]}, {unit}", ylabel=f"{names[1]}, {unit}")
    axes.grid(visible=False)
    plots.legend(figure, axes, target, loc="outside upper left", ncols=2)
    return figure


def seen_from_above(surface: Surface) -> npt.NDArray[np.bool_]:
    """Which points (n,) are corners of triangles that look upwards, of a closed surface in space; of others all."""
    cells, every = surface.cells[1], np.ones(len(surface.points), dtype=bool)
    a, b, c = surface.points[cells[:, :3]].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    if surface.frame is None or np.linalg.norm(normals.sum(axis=0)) > _CLOSED * np.linalg.norm(normals, axis=1).sum():
        return every
    return np.asarray(np.isin(np.arange(len(every)), cells[normals[:, 2] > 0.0]))


_CLOSED = 1e-6
"""Sum of a surface's vector areas over that of its areas up to which it is closed; of a solid it is 0."""


def _named_axes(frame: Floats) -> tuple[str, str]:
    """What the axes to the right and upwards are, of a surface in space drawn by this frame."""
    return ("x", "y") if np.array_equal(frame, np.eye(3)) else (_OUTWARDS, "across")


_OUTWARDS = "outwards"
"""Along the load, from the spin axis on."""


def held(scene: Scene) -> str:
    """What the root is."""
    return "clamped root" if scene.plate is None or scene.plate.root is None else "root on springs"


def cells_are_drawn(surface: Surface) -> bool:
    """Whether a figure shows each cell: beyond some thousands they would be one grey block."""
    length, width, _ = np.ptp(surface.points, axis=0)
    inside = 72.0 * (plots.WIDTH - _LABELS)
    scale = min(inside / length, 72.0 * _HIGHEST / width)
    return bool(scale * np.sqrt(length * width / len(surface.cells[1])) >= _SMALLEST)


def _draw(axes: Axes, points: Floats, chains: np.ndarray, colour: str, width: float) -> None:
    """Polylines through points, chains (n, points of each), as one path, which keeps the page small."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    codes = np.full(chains.shape, Path.LINETO)
    codes[:, 0] = Path.MOVETO
    path = Path(points[chains].reshape(-1, 2), codes.ravel())
    axes.add_patch(PathPatch(path, fill=False, edgecolor=colour, lw=width, capstyle="round"))


@dataclass(frozen=True, eq=False)
class Envelope:
    """What a curve does in each piece that it passes through: mean x; least, mean and most of y; all (pieces,)."""

    x: Floats
    low: Floats
    mean: Floats
    high: Floats


def envelope(x: Floats, y: Floats, edges: Floats) -> Envelope:
    """The pieces of a curve, x and y (n,), between ascending `edges`; what lies beyond belongs to the outermost."""
    piece = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    order = np.argsort(piece, kind="stable")
    first = np.flatnonzero(np.diff(piece[order], prepend=-1))
    count = np.diff(first, append=len(x))
    along, up = x[order], y[order]
    return Envelope(
        x=np.add.reduceat(along, first) / count,
        low=np.minimum.reduceat(up, first),
        mean=np.add.reduceat(up, first) / count,
        high=np.maximum.reduceat(up, first),
    )


def oscillations(y: Floats) -> int:
    """How often a curve swings up and down through zero."""
    signs = np.sign(y[y != 0.0])
    return int(np.count_nonzero(np.diff(signs))) // 2


@dataclass(frozen=True, eq=False)
class ModeView:
    """A mode in three dimensions, the plate at rest in outline; the last line of a notebook's cell shows its picture.

    Attributes:
        surface: the plate and its shapes.
        row: of the shapes, the speed.
        number: of the mode, from 1.
        title: mode, family, frequency and speed.
    """

    surface: Surface
    row: int
    number: int
    title: str

    def show(self) -> None:
        """Open a window, in which the mouse turns the plate, until it is closed.

        Raises:
            BadInput: this machine has no screen.
        """
        if not screen_exists():
            raise BadInput("no screen to open a window on: expected screenshot(path)", key="show")
        self.plotter().show()

    def screenshot(self, path: str | PathLike[str]) -> Path:
        """Write the picture as PNG; it needs no screen."""
        written = Path(path)
        written.write_bytes(self._png)
        return written

    def plotter(self) -> Any:
        """A `pyvista.Plotter` with the plate, for pictures of your own."""
        import pyvista as pv

        points, cells = self.surface.points, self.surface.cells[1]
        moved, swing = _swinging(points, self.surface.shapes[self.row, self.number - 1])
        plotter = pv.Plotter()
        plate = pv.PolyData(moved, np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel())
        plate["swing, of the largest"] = swing
        plotter.add_mesh(plate, cmap="plasma", show_edges=True, clim=(0.0, 1.0))
        for edges, colour, width in ((self.surface.outline, "grey", 2), (self.surface.root, plots.CATEGORIES[0], 6)):
            lines = np.column_stack([np.full(len(edges), 2), edges]).ravel()
            plotter.add_mesh(pv.PolyData(points, lines=lines), color=colour, line_width=width)
        plotter.add_text(self.title, font_size=10)
        return plotter

    @cached_property
    def _png(self) -> bytes:
        return mode_picture(self.surface, self.row, self.number)

    def __repr__(self) -> str:
        return f"<ModeView: {self.title}>"

    def _repr_png_(self) -> bytes:
        return self._png

    def _repr_html_(self) -> str:
        words, coded = html.escape(f"{self.title}."), b64encode(self._png).decode()
        picture = f'<img alt="{words}" style="max-width:40em" src="data:image/png;base64,{coded}">'
        return f"<figure>{picture}<figcaption>{words}</figcaption></figure>"


@dataclass(frozen=True, eq=False)
class Plots:
    """What can be drawn of results; `axes.figure.savefig("campbell.pdf")` writes a picture.

    Each draws into the axes `ax`, or into a new current figure of pyplot: a notebook shows it, and so does
    `matplotlib.pyplot.show()`. Each raises BadInput where the run has nothing of the kind, and TypeError where `ax` is
    something else than axes.
    """

    results: Results

    def campbell(self, ax: Axes | None = None) -> Axes:
        """Natural frequencies [Hz] over the rotation speed [rpm], with engine orders and their crossings."""
        return self._drawn(campbell, ax, "a plate that turns")

    def damping(self, ax: Axes | None = None) -> Axes:
        """Damping ratio by the ball [%] over the amplitude at the cavity [mm], a curve for each load."""
        return self._drawn(damping_ratio, ax, "a damper whose ball can move")

    def ringdown(self, ax: Axes | None = None) -> Axes:
        """Velocity of the structure [m/s] over time [ms] after the release, at the run's middle speed."""
        return self._drawn(velocity, ax, "a ring-down")

    def mesh(self, ax: Axes | None = None) -> Axes:
        """The plate from above: cells, root, place of the damper."""
        instead = "" if self.results.surface is None else "; mode() draws this structure"
        return self._drawn(mesh, ax, f"a plate{instead}")

    def mode(self, number: int = 1, rpm: float | None = None) -> ModeView:
        """A mode in three dimensions, the plate at rest in outline.

        Args:
            number: of the mode, from 1.
            rpm: rotation speed, one of those kept; the middle one by default.

        Returns:
            A picture in a notebook; `.show()` opens a window, `.screenshot(path)` writes the picture, and `.plotter()`
            is a `pyvista.Plotter`.
        """
        surface = self.results.surface
        if surface is None:
            raise _without("a plate")
        omega = None if rpm is None else omega_of(rpm, "rpm")
        row = chosen(surface, self.results.speeds, omega, number, ("rpm", "number"))
        point = self.results.speeds[surface.at[row]]
        mode = point.modes[number - 1]
        title = f"mode {number}, {mode.family}, {mode.frequency_hz:.2f} Hz at {amount(point.rpm)} rpm"
        return ModeView(surface, row, number, title)

    @plots.style()
    def _drawn(self, draw: Callable[[Results, Target], Figure | None], ax: Axes | None, needed: str) -> Axes:
        """The axes that a figure is drawn into."""
        from matplotlib.axes import Axes

        if not (ax is None or isinstance(ax, Axes)):
            raise TypeError(f"ax must be axes of matplotlib, such as figure.add_subplot(), got {type(ax).__name__}")
        figure = draw(self.results, Target(pyplot=ax is None, ax=ax))
        if figure is None:
            raise _without(needed)
        if ax is None:
            figure.set_facecolor(plots.PAPER)
        axes = ax or figure.axes[0]
        plots.plain([axes])
        plots.coloured(ax or figure, len(self.results.speeds))
        return axes


def chosen(
    surface: Surface, speeds: tuple[SpeedPoint, ...], omega: float | None, number: int, keys: tuple[str, str]
) -> int:
    """Which of the speeds kept is meant [rad/s], the middle one where none is named; `number`: of a mode, from 1.

    A speed is meant that reads the same: 4274 rpm for 4273.6.

    Raises:
        BadInput: no shape was kept at that speed, or there is no such mode; with these keys.
    """
    row, kept = surface.row(middle_speed(speeds)), [speeds[at] for at in surface.at]
    if omega is not None:
        row = min(range(len(kept)), key=lambda k: abs(kept[k].omega - omega))
        if amount(kept[row].rpm) != amount(rounded_rpm(omega)):
            problem = f"expected a speed with shapes: {', '.join(amount(point.rpm) for point in kept)} rpm"
            raise BadInput(problem, key=keys[0], value=as_typed(rounded_rpm(omega)))
    if not isinstance(number, int | np.integer) or number not in range(1, surface.shapes.shape[1] + 1):
        raise BadInput(f"expected a mode from 1 to {surface.shapes.shape[1]}", key=keys[1], value=number)
    return row


def _without(needed: str) -> BadInput:
    return BadInput(f"the run has nothing to draw: expected {needed}", key="plot")


def mode_picture(surface: Surface, row: int, number: int) -> bytes:
    """A mode, numbered from 1, in three dimensions above the outline of the plate at rest, as PNG."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    surface = surface.finer or surface
    left = thinned(surface, POINTS)
    points, shape = (surface.drawn(each[left.kept]) for each in (surface.points, surface.shapes[row, number - 1]))
    moved, swing = _swinging(points, shape if shape[np.argmax(np.abs(shape[:, 2])), 2] >= 0 else -shape)
    figure = Figure(figsize=(8, 5), facecolor="none")
    axes: Any = figure.add_axes((0.0, -0.3, 1.0, 1.6), projection="3d", facecolor="none")
    colours = colormaps["plasma"](swing[left.triangles].mean(axis=1))
    faces = Poly3DCollection(moved[left.triangles], facecolors=colours, edgecolors=colours, linewidths=0.4)
    axes.add_collection3d(faces)
    if len(left.outline):
        axes.add_collection3d(Line3DCollection(points[left.outline], color="#8a8a8a", linewidth=1.2))
    else:  # a closed surface
        axes.add_collection3d(Poly3DCollection(points[left.triangles], facecolors="#8a8a8a", alpha=0.2))
    low, high = np.minimum(points, moved).min(axis=0), np.maximum(points, moved).max(axis=0)
    high = np.maximum(high, low + 1e-3 * np.ptp(points))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=0.94)
    axes.view_init(22, -62)
    axes.set_axis_off()
    out = BytesIO()
    figure.savefig(out)
    return out.getvalue()


def _swinging(points: Floats, shape: Floats) -> tuple[Floats, Floats]:
    """The points (n, 3) moved by a shape, and how far each swings, of the largest."""
    length = float(np.ptp(points, axis=0).max())
    swing = np.linalg.norm(shape, axis=1)
    largest = float(swing.max()) or 1.0
    return points + _SWING * length / largest * shape, swing / largest
