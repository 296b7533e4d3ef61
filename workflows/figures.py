"""The figures of the report, as SVG: Campbell diagram, velocity over time, damping capacity over amplitude."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workflows import curves, drawing, paper, wording
from workflows.records import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEGEND_AT_MOST = 16
"""Curves that a legend can name."""

_ENGINE_ORDERS = (1, 2, 3, 4, 6, 8, 12, 16)


def campbell(results: Results) -> str:
    """Frequencies over speed with the engine orders that excite them; nothing for a single speed at rest."""
    tracks = curves.campbell(results)
    if not tracks:
        return ""
    figure, (axes,) = drawing.canvas(3.5, left=0.085, right=0.86, top=0.97, bottom=0.13)
    fastest = max(point.rpm for point in results.speeds) or 1.0
    highest = 1.06 * max(float(track.y.max()) for track in tracks)
    _engine_orders(axes, fastest, highest)
    families: list[str] = []
    ends: list[tuple[float, str, str]] = []
    for track in tracks:
        family = track.label.rsplit(" ", 1)[0]
        if family not in families:
            families.append(family)
        kind = families.index(family)
        colour = drawing.CATEGORIES[kind % len(drawing.CATEGORIES)]
        marker = drawing.MARKERS[kind % len(drawing.MARKERS)] if len(track.x) <= 12 else ""
        axes.plot(track.x, track.y, color=colour, marker=marker, clip_on=False)
        ends.append((float(track.y[-1]), track.label, colour))
    rows = [row for point in results.speeds if (row := paper.row(results.scene, point.load_g)) is not None]
    if rows:
        found = [p.rpm for p in results.speeds if paper.row(results.scene, p.load_g) is not None]
        axes.plot(
            found,
            [row.frequency for row in rows],
            "o",
            ms=7,
            mfc="none",
            mec=drawing.INK,
            mew=0.8,
            label="Table II",
            clip_on=False,
            zorder=4,
        )
        axes.legend(loc="upper left")
    axes.set(xlim=(0, fastest), ylim=(0, highest), xlabel="rotation speed, rpm", ylabel="frequency, Hz")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: wording.fixed(value))
    for y, (_, label, colour) in zip(_apart([e[0] for e in ends], 0.045 * highest), ends, strict=True):
        axes.annotate(label, (fastest, y), (20, 0), textcoords="offset points", va="center", color=colour)
    return drawing.svg(figure, "campbell", "Campbell diagram: natural frequencies over rotation speed")


def velocity(results: Results) -> str:
    """The structure's velocity over time at one speed, where the ball stops marked (Fig. 2)."""
    point = next((p for p in results.speeds if curves.velocity(p)), None)
    if point is None or point.damping is None:
        return ""
    figure, (axes,) = drawing.canvas(2.5, left=0.085, right=0.985, top=0.9, bottom=0.17)
    axes.axhline(0, color=drawing.MUTED, lw=0.5)
    end = 0.0
    for track, colour in zip(curves.velocity(point), drawing.CATEGORIES, strict=False):
        axes.plot(1e3 * track.x, track.y, color=colour, lw=0.9, label=track.label)
        end = 1e3 * float(track.x[-1])
    stop = point.damping.stopped
    if stop is not None and 1e3 * stop < end:
        axes.axvline(1e3 * stop, color=drawing.INK, lw=0.8, ls=(0, (4, 3)))
        late = 1e3 * stop > 0.6 * end
        axes.annotate(
            "the ball comes to rest",
            (1e3 * stop, 1.0),
            (-4 if late else 4, -1),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            va="top",
            ha="right" if late else "left",
        )
    axes.set(xlim=(0, end), xlabel="time, ms", ylabel="velocity, m/s")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    return drawing.svg(figure, "velocity", "Velocity of the structure over time")


def capacity(results: Results) -> str:
    """Specific damping capacity over amplitude for every load: all of it, and the ball's part (Fig. 3)."""
    lines = curves.capacity(results)
    dampings = [p.damping for p in results.speeds if p.damping is not None and np.isfinite(p.damping.sdc).any()]
    if not lines:
        return ""
    # Without damping of its own the structure's part is nothing, and the two pictures would be one.
    columns = 2 if any(damping.intrinsic_sdc for damping in dampings) else 1
    figure, panels = drawing.canvas(3.1, columns, left=0.085, right=0.85, top=0.90, bottom=0.145, wspace=0.26)
    whole, part = panels[0], panels[-1]
    for line, damping, colour in zip(lines, dampings, drawing.shades(len(lines)), strict=True):
        size = 2.4 if len(line.x) <= 80 else 0
        style: dict[str, Any] = {"color": colour, "marker": "o", "ms": size, "lw": 1.1}
        if columns == 2:
            whole.plot(line.x, 100 * line.y, **style)
        part.plot(line.x, 100 * (line.y - damping.intrinsic_sdc), label=line.label, **style)
        if damping.cutoff_g is not None:
            part.axvline(damping.cutoff_g, ymax=0.035, color=colour, lw=1.6)
    top = 100 * max(float(line.y.max()) for line in lines)
    if columns == 2 and any(paper.row(results.scene, point.load_g) for point in results.speeds):
        low, high = (100 * value for value in paper.SDC_RANGE)
        whole.axhspan(low, high, color=drawing.RULE, lw=0)
        middle = (0.97, (low + high) / 2)
        whole.annotate("the paper’s range", middle, xycoords=("axes fraction", "data"), ha="right", va="center")
        top = max(top, high)
    whole.set(ylim=(0, 1.12 * top or 1.0), title="All that is lost in a cycle", ylabel="specific damping capacity, %")
    if columns == 2:
        part.set(title="Beyond the structure’s own damping")
    wide = max(float(line.x.max()) for line in lines) > 3 * min(float(line.x.min()) for line in lines)
    for axes in panels:
        axes.set(xlabel="amplitude of the acceleration, g")
        if wide:
            axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda value, _: wording.fixed(value))
    if len(lines) <= _LEGEND_AT_MOST:
        part.legend(title="load", loc="center left", bbox_to_anchor=(1.01, 0.5), reverse=True)
    return drawing.svg(figure, "capacity", "Specific damping capacity over acceleration amplitude")


def _engine_orders(axes: Axes, fastest: float, highest: float) -> None:
    for order in _ENGINE_ORDERS:
        end = order * fastest / 60
        if end < 0.04 * highest:
            continue
        axes.plot([0, fastest], [0, end], color=drawing.MUTED, lw=0.5, ls=(0, (1, 2)))
        x = min(fastest, 60 * 0.97 * highest / order)
        axes.annotate(
            f"{order}×",
            (x, order * x / 60),
            (2, 0),
            textcoords="offset points",
            va="center",
            fontsize=6.5,
            color=drawing.MUTED,
            annotation_clip=False,
        )


def _apart(values: list[float], gap: float) -> list[float]:
    """Label positions moved up just enough to be `gap` apart."""
    placed: dict[int, float] = {}
    last = -np.inf
    for index in sorted(range(len(values)), key=values.__getitem__):
        last = max(values[index], last + gap)
        placed[index] = last
    return [placed[index] for index in range(len(values))]
