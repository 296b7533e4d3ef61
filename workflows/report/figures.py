"""The figures of the report, as SVG: Campbell diagram, velocity over time, damping capacity over amplitude."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.report import drawing, palette
from workflows.report.drawing import Sheet
from workflows.report.envelope import envelope, oscillations
from workflows.results import curves
from workflows.results.crossings import crossings, orders
from workflows.results.curves import Curve
from workflows.scene import paper
from workflows.solve.records import Floats, Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LINE = 0.045
"""Height of a line of text, in heights of the Campbell diagram."""

_SWINGS_AN_INCH = 10.0
"""More than that are drawn as an envelope."""

_CYCLES_AT_MOST = 80
"""Cycles of a ring-down of which each is drawn; beyond, there are as many pieces."""


def campbell(results: Results, sheet: Sheet) -> str:
    """The Campbell diagram for a page; nothing for a plate at rest."""
    figure, said = campbell_drawn(results, sheet), "Campbell diagram: natural frequencies over rotation speed"
    return "" if figure is None else drawing.svg(figure, sheet, "campbell", said, live=True)


def campbell_drawn(results: Results, sheet: Sheet) -> Figure | None:
    """Frequencies over speed with the engine orders that excite them; None for a plate at rest."""
    tracks, fastest = curves.campbell(results), max(point.rpm for point in results.speeds)
    if not tracks or fastest == 0:
        return None
    figure, (axes,) = drawing.canvas(sheet, 3.5)
    highest = 1.06 * max(float(track.y.max()) for track in tracks)
    axes.set(xlim=(0, fastest), ylim=(0, highest), xlabel="rotation speed, rpm", ylabel="frequency, Hz")
    _engine_orders(axes, orders(results.scene), fastest, highest)
    colours = [_branch(axes, track) for track in tracks]
    heights = _apart([float(track.y[-1]) for track in tracks], _LINE * highest)
    for y, track, colour in zip(heights, tracks, colours, strict=True):
        axes.annotate(track.label, (fastest, y), (24, 0), textcoords="offset points", va="center", color=colour)
    meetings = crossings(results)
    met = [meeting.rpm for meeting in meetings], [meeting.frequency_hz for meeting in meetings]
    axes.plot(*met, "o", ms=2.4, color=palette.INK, zorder=3)
    _table_two(axes, results)
    return figure


def velocity(results: Results, sheet: Sheet) -> str:
    """The velocity over time for a page; nothing without a ring-down."""
    figure = velocity_drawn(results, sheet)
    return "" if figure is None else drawing.svg(figure, sheet, "velocity", "Velocity of the structure over time")


def velocity_drawn(results: Results, sheet: Sheet) -> Figure | None:
    """The structure's velocity over time at one speed, where the ball stops marked (Fig. 2), or None."""
    point = next((p for p in results.speeds if curves.velocity(p)), None)
    if point is None or point.damping is None:
        return None
    figure, (axes,) = drawing.canvas(sheet, 2.5)
    axes.axhline(0, color=palette.MUTED, lw=0.5)
    tracks = curves.velocity(point)
    for track, colour in zip(tracks, palette.CATEGORIES, strict=False):
        _oscillation(axes, track, colour, sheet)
    end = max(1e3 * float(track.x[-1]) for track in tracks)
    stop = point.damping.stopped
    if stop is not None and 1e3 * stop < end:
        _stop(axes, 1e3 * stop, end)
    axes.set(xlim=(0, end), xlabel="time, ms", ylabel="velocity, m/s")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


def capacity(results: Results, sheet: Sheet) -> str:
    """Specific damping capacity over amplitude for every load: all of it, and the ball's part (Fig. 3)."""
    lines = curves.capacity(results)
    dampings = [p.damping for p in results.speeds if p.damping is not None and np.isfinite(p.damping.sdc).any()]
    if not lines:
        return ""
    # Without damping of its own the structure's part is nothing, and the two pictures would be one.
    panels = 2 if any(damping.intrinsic_sdc for damping in dampings) else 1
    figure, drawn = drawing.canvas(sheet, 3.1, panels)
    whole, part = drawn[0], drawn[-1]
    edges = _pieces(lines)
    for line, damping, colour in zip(lines, dampings, palette.shades(len(lines)), strict=True):
        if panels == 2:
            _cycles(whole, line, 100 * line.y, edges, colour)
        _cycles(part, line, 100 * (line.y - damping.intrinsic_sdc), edges, colour)
        if damping.cutoff_g is not None:
            part.axvline(damping.cutoff_g, ymax=0.035, color=colour, lw=1.6)
    _title(whole, part, lines, results)
    for axes in drawn:
        axes.set(xlabel="amplitude of the acceleration, g", xscale=_scale(lines))
    drawing.key(figure, part, sheet, title="load", reverse=sheet is drawing.WIDE)
    return drawing.svg(figure, sheet, "capacity", "Specific damping capacity over acceleration amplitude")


def is_fast(track: Curve, sheet: Sheet = drawing.NARROW) -> bool:
    """Whether a vibration swings too often for each swing to be drawn."""
    return oscillations(track.y) > _SWINGS_AN_INCH * sheet.width


def is_band(cycles: Floats) -> bool:
    """Whether a ring-down has too many cycles (n,) for each to be drawn."""
    return len(cycles) > _CYCLES_AT_MOST


def _branch(axes: Axes, track: Curve) -> str:
    """One frequency over speed; its colour."""
    colour, marker = palette.of_family(track.label.rsplit(" ", 1)[0])
    axes.plot(track.x, track.y, color=colour, marker=marker if len(track.x) <= 12 else "", clip_on=False)
    return colour


def _table_two(axes: Axes, results: Results) -> None:
    """The frequencies that the paper has at these speeds, if it has them."""
    known = [(point.rpm, row) for point in results.speeds if (row := paper.row(results.scene, point.load_g))]
    if known:
        ring: dict[str, Any] = {"ls": "", "marker": "o", "ms": 7, "mfc": "none", "mec": palette.INK, "mew": 0.8}
        theirs = [row.frequency for _, row in known]
        axes.plot([rpm for rpm, _ in known], theirs, label="Table II", clip_on=False, zorder=4, **ring)
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)


def _oscillation(axes: Axes, track: Curve, colour: str, sheet: Sheet) -> None:
    """A vibration over time; only how far it swings where there are too many swings for the sheet."""
    if not is_fast(track, sheet):
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
    axes.axvline(stop, color=palette.INK, lw=0.8, ls=(0, (4, 3)))
    axes.annotate(
        "the ball comes to rest",
        (stop, 1.0),
        (-4 if late else 4, -1),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        va="top",
        ha="right" if late else "left",
    )


def _scale(lines: list[Curve]) -> str:
    low, high = min(float(line.x.min()) for line in lines), max(float(line.x.max()) for line in lines)
    return "log" if high > 3 * low > 0 else "linear"


def _pieces(lines: list[Curve]) -> Floats:
    """Ends of the pieces in which long ring-downs are drawn."""
    low, high = min(float(line.x.min()) for line in lines), max(float(line.x.max()) for line in lines)
    spaced = np.geomspace if _scale(lines) == "log" else np.linspace
    return np.asarray(spaced(low, high, _CYCLES_AT_MOST + 1))


def _cycles(axes: Axes, line: Curve, percent: Floats, edges: Floats, colour: str) -> None:
    """What each cycle takes; of many cycles the mean, between the least and the most."""
    if not is_band(line.y):
        axes.plot(line.x, percent, color=colour, marker="o", ms=2.4, lw=1.1, label=line.label)
        return
    reach = envelope(line.x, percent, edges)
    axes.fill_between(reach.x, reach.low, reach.high, color=colour, alpha=0.25, lw=0)
    axes.plot(reach.x, reach.mean, color=colour, lw=1.1, label=line.label)


def _title(whole: Axes, part: Axes, lines: list[Curve], results: Results) -> None:
    """Titles, the range of the axis, and what the paper reports."""
    top = 100 * max(float(line.y.max()) for line in lines)
    if part is not whole and any(paper.row(results.scene, point.load_g) for point in results.speeds):
        low, high = (100 * value for value in paper.SDC_RANGE)
        whole.axhspan(low, high, color=palette.RULE, lw=0)
        middle = (0.97, (low + high) / 2)
        whole.annotate("the paper’s range", middle, xycoords=("axes fraction", "data"), ha="right", va="center")
        top = max(top, high)
    whole.set(ylim=(0, 1.12 * top or 1.0), title="All that is lost in a cycle", ylabel="specific damping capacity, %")
    if part is not whole:
        part.set(title="Beyond the structure’s own damping")


def _engine_orders(axes: Axes, orders: tuple[int, ...], fastest: float, highest: float) -> None:
    """Multiples of the rotation speed, with their names at the edge that they leave the picture by."""
    aside: list[tuple[int, float]] = []
    for order in orders:
        end = order * fastest / 60
        if end < 0.04 * highest:
            continue
        axes.plot([0, fastest], [0, end], color=palette.MUTED, lw=0.5, ls=(0, (1, 2)))
        if end <= 0.97 * highest:
            aside.append((order, end))
        else:
            _order(axes, order, 60 * 0.97 * highest / order, 0.97 * highest)
    for (order, _), y in zip(aside, _apart([end for _, end in aside], 0.65 * _LINE * highest), strict=True):
        _order(axes, order, fastest, y)


def _order(axes: Axes, order: int, x: float, y: float) -> None:
    small: dict[str, Any] = {"fontsize": 6.5, "color": palette.MUTED, "va": "center", "annotation_clip": False}
    axes.annotate(f"{order}×", (x, y), (6, 0), textcoords="offset points", **small)


def _apart(values: list[float], gap: float) -> list[float]:
    """Label positions moved up just enough to be `gap` apart."""
    placed: dict[int, float] = {}
    last = -np.inf
    for index in sorted(range(len(values)), key=values.__getitem__):
        last = max(values[index], last + gap)
        placed[index] = last
    return [placed[index] for index in range(len(values))]
