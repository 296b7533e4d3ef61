"""The figure of what the damper is: its equivalent damping ratio over amplitude, a curve for each load."""

from __future__ import annotations

from workflows import curves, drawing, wording, worth
from workflows.records import Results

_LEGEND_AT_MOST = 16
"""Curves that a legend can name."""

_LEAST_SHOWN = 1e-3
"""Damping ratio below the largest peak, as a share of it, at which the axis ends."""


def working(results: Results) -> str:
    """Damping ratio over amplitude with peaks and cut-offs, beside what the air does; nothing without a damper."""
    lines = curves.damping_ratio(results)
    felt = [w for point in results.speeds if (w := worth.felt(point)) is not None and w.amplitude.size]
    if not lines:
        return ""
    figure, (axes,) = drawing.canvas(3.1, left=0.11, right=0.85, top=0.95, bottom=0.145)
    for line, figures, colour in zip(lines, felt, drawing.shades(len(lines)), strict=True):
        shown = line.y > 0
        axes.plot(1e3 * line.x[shown], 100 * line.y[shown], color=colour, lw=1.3, label=line.label)
        axes.plot(1e3 * figures.peak_amplitude, 100 * figures.peak, "o", color=colour, ms=4)
        if figures.cutoff > 0:
            axes.axvline(1e3 * figures.cutoff, ymax=0.035, color=colour, lw=1.6)
    air = [100 * ratio for ratio in worth.AIR]
    axes.axhspan(*air, color=drawing.RULE, lw=0)
    axes.annotate(
        "air alone, turbine blades",
        (0.99, air[0]),
        (0, -3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        ha="right",
        va="top",
        color=drawing.MUTED,
    )
    limit = worth.endured(results)
    if limit is not None and 1e3 * limit < axes.get_xlim()[1]:
        axes.axvline(1e3 * limit, color=drawing.INK, lw=0.8, ls=(0, (4, 3)))
    top = 100 * max(figures.peak for figures in felt)
    least = 100 * min(figures.peak for figures in felt)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set(
        xlabel="amplitude at the cavity, mm",
        ylabel="damping ratio by the ball, %",
        ylim=(max(least / 10, _LEAST_SHOWN * min(top, air[0])), 2 * max(top, air[1])),
    )
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: wording.significant(value))
    if len(lines) <= _LEGEND_AT_MOST:
        axes.legend(title="load", loc="center left", bbox_to_anchor=(1.01, 0.5), reverse=True)
    return drawing.svg(figure, "working", "Damping ratio by the ball over the amplitude of the vibration")
