"""The figure of what the damper is: its equivalent damping ratio over amplitude, a curve for each load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workflows.findings import worth
from workflows.report import drawing, palette
from workflows.results import curves
from workflows.solve.records import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from workflows.report.drawing import Sheet
    from workflows.results.curves import Curve
    from workflows.solve.records import OwnFigures

_LEFT = 0.1
"""Part of the least amplitude of any curve at which the axis begins at the latest, whatever ticks lie below it."""

_MARGIN = 1.1
"""By what the axis goes beyond its ends."""

_MIDDLE = 0.5
"""Where the line of what the plate endures has the words left of it, as a share of the axis: there is room for them."""

_LEAST_SHOWN = 1e-3
"""Share of the largest damping ratio at which the axis ends, unless a peak is lower than ten times that."""


def working(results: Results, sheet: Sheet) -> str:
    """The damping ratio over amplitude for a page; nothing without a damper."""
    figure, said = drawn(results, sheet), "Damping ratio by the ball over the amplitude of the vibration"
    return "" if figure is None else drawing.svg(figure, sheet, "working", said, live=True)


def drawn(results: Results, sheet: Sheet) -> Figure | None:
    """Damping ratio over amplitude with peaks and cut-offs, beside what the air does; None without a damper."""
    lines = curves.damping_ratio(results)
    felt = [w for point in results.speeds if (w := point.working) is not None and w.amplitude.size]
    if not lines:
        return None
    figure, (axes,) = drawing.canvas(sheet, 3.1)
    for line, figures, colour in zip(lines, felt, palette.shades(len(lines)), strict=True):
        shown = line.y > 0
        axes.plot(1e3 * line.x[shown], 100 * line.y[shown], color=colour, lw=1.3, label=line.label)
        axes.plot(1e3 * figures.peak_amplitude, 100 * figures.peak, "o", color=colour, ms=4)
        if figures.cutoff > 0:
            axes.axvline(1e3 * figures.cutoff, ymax=0.035, color=colour, lw=1.6)
    peaks = [100 * figures.peak for figures in felt]
    top = max(*peaks, 100 * worth.AIR[1])
    least = max(min(peaks) / 10, _LEAST_SHOWN * max(peaks))
    axes.set(xscale="log", yscale="log", ylim=(min(least, 50 * worth.AIR[0]), 2 * top))
    axes.set_xlim(_from_to(lines, felt))
    axes.set(xlabel="amplitude at the cavity, mm", ylabel="damping ratio by the ball, %")
    _beside(axes, worth.endured(results))
    drawing.key(figure, axes, sheet, title="load", reverse=sheet is drawing.WIDE)
    return figure


def _from_to(lines: list[Curve], felt: list[OwnFigures]) -> tuple[float, float]:
    """Ends of the axis [mm]: all of the curves, and ticks that are not far below them."""
    shown = np.concatenate([line.x[line.y > 0] for line in lines])
    ticks = [figures.cutoff for figures in felt if figures.cutoff > 0]
    low = max(min([*ticks, shown.min()]), _LEFT * shown.min())
    return 1e3 * low / _MARGIN, 1e3 * shown.max() * _MARGIN


def _beside(axes: Axes, limit: float | None) -> None:
    """What the air does, and the amplitude [m] up to which the plate endures; the words do not meet its line."""
    low, high = (100 * ratio for ratio in worth.AIR)
    axes.axhspan(low, high, color=palette.RULE, lw=0)
    end, (left, right) = 0.99, np.log(axes.get_xlim())
    if limit is not None and np.log(1e3 * limit) < right:
        axes.axvline(1e3 * limit, color=palette.INK, lw=0.8, ls=(0, (4, 3)))
        share = (np.log(1e3 * limit) - left) / (right - left)
        end = share - 0.01 if share > _MIDDLE else end
    axes.annotate(
        "air alone, turbine blades",
        (end, low),
        (0, -3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        ha="right",
        va="top",
        color=palette.MUTED,
    )
