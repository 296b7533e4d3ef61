"""Pictures of a forced response."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.findings import worth
from workflows.report import plots as plot
from workflows.results import curves
from workflows.studies.response import peaks
from workflows.studies.response.records import Response, Through
from workflows.wording import significant, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARKS = {"locked": "s", "periodic": "o", "modulated": "^", "chaotic": "D", "not settled": "x"}
"""What happens at a crossing, as a mark."""


def campbell(found: Response) -> str:
    """Frequencies over speed, the orders asked for, and what happens where they cross."""
    fastest = max(point.rpm for point in found.results.speeds)
    with plot.style():
        figure, (axes,) = plot.canvas(3.3)
        tracks = curves.campbell(found.results)
        for number, track in enumerate(tracks):
            axes.plot(track.x, track.y, color=plot.CATEGORIES[number % len(plot.CATEGORIES)], label=track.label)
        crossings = [through.crossing for through in found.passed] + [crossing for crossing, _ in found.idle]
        top = max((track.y.max() for track in tracks), default=0.0)
        top = 1.06 * max(top, *(1.3 * crossing.frequency_hz for crossing in crossings), 1.0)
        for order in found.excitation.orders:
            end = min(fastest, 60 * top / order)
            axes.plot([0, end], [0, order * end / 60], color=plot.MUTED, lw=0.6, ls=(0, (1, 2)))
            small: dict[str, Any] = {"fontsize": 6.5, "color": plot.MUTED}
            axes.annotate(f"{order}×", (end, order * end / 60), (3, -2), textcoords="offset points", **small)
        for through in found.passed:
            kinds = [row.regime for row in peaks.rows(found) if row.through is through]
            for kind in dict.fromkeys(kinds):
                _mark(axes, through, kind)
        for crossing, _ in found.idle:
            axes.plot(crossing.rpm, crossing.frequency_hz, "+", color=plot.MUTED, ms=6)
        axes.set(xlim=(0, fastest), ylim=(0, top), xlabel="rotation speed, rpm", ylabel="frequency, Hz")
        handles, labels = axes.get_legend_handles_labels()
        unique = dict(zip(labels, handles, strict=True))
        if unique:
            figure.legend(list(unique.values()), list(unique), loc="outside lower left", ncols=3)
        return plot.svg(figure, "crossings", "Campbell diagram with what happens at the crossings")


def _mark(axes: Axes, through: Through, kind: str) -> None:
    c = through.crossing
    size = 5 + 2 * list(_MARKS).index(kind)
    axes.plot(
        c.rpm,
        c.frequency_hz,
        _MARKS[kind],
        color=plot.INK,
        mfc="none",
        mew=0.8,
        ms=size,
        ls="",
        label=kind,
        zorder=4,
    )


def response(found: Response, through: Through, name: str, shades: Sequence[str]) -> str:
    """Amplitude over speed for each force: without the ball, and with it from the least cycle to the greatest."""
    with plot.style():
        figure, (axes,) = plot.canvas(3.3)
        rpm = through.omega * 30 / np.pi
        states = through.states
        least, mean, greatest = (through.shaped(getattr(states, key)) for key in ("least", "mean", "greatest"))
        without = np.abs(through.shaped(states.without))
        for k, (force, colour) in enumerate(zip(through.forces, shades, strict=True)):
            axes.plot(rpm, 1e3 * without[:, k], color=colour, lw=0.8, ls=(0, (4, 2)))
            axes.fill_between(
                rpm, 1e3 * least[:, k].min(axis=1), 1e3 * greatest[:, k].max(axis=1), color=colour, alpha=0.25, lw=0
            )
            for start in range(mean.shape[2]):
                label = f"{significant(force)} {found.excitation.unit}" if start == 0 else None
                axes.plot(rpm, 1e3 * mean[:, k, start], color=colour, lw=1.0, label=label)
        axes.set(yscale="log", xlabel="rotation speed, rpm", ylabel="amplitude at the cavity, mm")
        plot.legend(figure, axes, title=found.excitation.kind)
        return plot.svg(figure, f"response-{name}", "Amplitude over speed, without and with the ball")


def ratios(found: Response, through: Through, name: str) -> str:
    """Amplitude with the ball over the one without, over speed and force: the largest of the answers."""
    from matplotlib.colors import LinearSegmentedColormap

    with plot.style():
        figure, (axes,) = plot.canvas(2.6)
        rpm = through.omega * 30 / np.pi
        mean = through.shaped(through.states.mean).max(axis=2)
        ratio = mean / np.abs(through.shaped(through.states.without))
        levels = len(through.forces)
        reach = max(0.02, float(np.abs(np.log10(ratio)).max()))
        strength = np.log10((ratio[1:] + ratio[:-1]) / 2).T
        colours = LinearSegmentedColormap.from_list("", [plot.CATEGORIES[0], "#ffffff00", plot.CATEGORIES[1]])
        rows = np.arange(levels + 1) - 0.5
        axes.pcolormesh(rpm, rows, strength, cmap=colours, vmin=-reach, vmax=reach, rasterized=True)
        axes.set_yticks(range(levels), [significant(force) for force in through.forces])
        axes.set(
            xlim=(rpm[0], rpm[-1]),
            xlabel="rotation speed, rpm",
            ylabel=f"{found.excitation.kind}, {found.excitation.unit}",
        )
        low, high = (significant(end, 3) for end in (ratio.min(), ratio.max()))
        axes.set_title(f"blue: smaller with the ball, orange: larger; ratios from {low} to {high}")
        axes.grid(visible=False)
        return plot.svg(figure, f"ratios-{name}", "Ratio of amplitudes over speed and force")


def damping(found: Response) -> str:
    """The ball's equivalent damping ratio over amplitude at each crossing, its working range, and what the air does."""
    shown = [through for through in found.passed if through.figures.amplitude.size]
    if not shown:
        return ""
    with plot.style():
        figure, (axes,) = plot.canvas(3.0)
        for through, colour in zip(shown, plot.shades(len(shown)), strict=True):
            figures, c = through.figures, through.crossing
            some = figures.damping_ratio > 0
            label = f"order {c.order}, {whole(c.rpm)} rpm"
            axes.plot(1e3 * figures.amplitude[some], 100 * figures.damping_ratio[some], color=colour, label=label)
            low, high = (1e3 * end for end in figures.range)
            if np.isfinite(low) and np.isfinite(high):
                axes.plot([low, high], [50 * figures.peak] * 2, color=colour, lw=3, alpha=0.35)
        air = [100 * ratio for ratio in worth.AIR]
        axes.axhspan(*air, color=plot.RULE, lw=0)
        least = 100 * min(through.figures.peak for through in shown) / 30
        axes.set(xscale="log", yscale="log", ylim=(min(least, air[0] / 2), None))
        axes.set(xlabel="amplitude at the cavity, mm", ylabel="damping ratio by the ball, %")
        plot.legend(figure, axes, ncols=1)
        return plot.svg(figure, "zeta", "Damping ratio by the ball over amplitude")


def path(found: Response, through: Through, name: str) -> str:
    """The ball in its cavity over some cycles, at the speed and under the force of the largest amplitude."""
    taken = through.path
    with plot.style():
        figure, panels = plot.canvas(2.4, 2)
        along, place = panels
        axis = through.axis
        along.plot(1e3 * taken.time, 1e3 * taken.ball[:, axis], color=plot.CATEGORIES[0], label="ball in its cavity")
        size = np.abs(taken.structure[:, axis]).max() or 1.0
        scale = np.abs(taken.ball[:, axis]).max() or 1.0
        along.plot(
            1e3 * taken.time, 1e3 * scale * taken.structure[:, axis] / size, color=plot.MUTED, lw=0.8,
            label="structure, scaled",
        )  # fmt: skip
        along.set(xlabel="time, ms", ylabel="place, mm")
        along.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
        place.plot(1e3 * taken.structure[:, axis], 1e3 * taken.ball[:, axis], color=plot.CATEGORIES[0], lw=0.8)
        place.set(xlabel="displacement of the structure, mm", ylabel="place of the ball, mm")
        return plot.svg(figure, f"path-{name}", "The ball's path in its cavity")
