"""The figure of the energy books: where the energy of the release went, a bar for each speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workflows.report import drawing
from workflows.report.drawing import Sheet
from workflows.solve.records import Energy, Results
from workflows.wording import amount

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PARTS = (
    ("structure", "structure"),
    ("rolling", "rolling"),
    ("impact", "wall hits"),
    ("slip", "slip"),
    ("final", "left"),
)
"""Parts of the books and what they are called."""

_COLOURS = (drawing.CATEGORIES[5], drawing.CATEGORIES[2], drawing.CATEGORIES[1], drawing.CATEGORIES[3], drawing.RULE)

_BARS_AT_MOST = 40
"""Speeds that a picture has bars for."""


def rows(results: Results) -> list[tuple[float, Energy]]:
    """Speed [rpm] and books of the ring-downs that the figure shows, evenly chosen where there are many."""
    found = [(p.rpm, p.damping.energy) for p in results.speeds if p.damping and p.damping.energy.initial > 0]
    if len(found) <= _BARS_AT_MOST:
        return found
    return [found[k] for k in np.unique(np.linspace(0, len(found) - 1, _BARS_AT_MOST).round().astype(int))]


def books(results: Results, sheet: Sheet) -> str:
    """Shares of the energy of the release, on two scales: all of it, and what the ball took."""
    bars = rows(results)
    if not bars:
        return ""
    height = 0.75 + 0.2 * len(bars)
    figure, (whole, ball) = drawing.canvas(sheet, height, 2)
    _bars(whole, bars, PARTS)
    _bars(ball, bars, PARTS[1:4])
    whole.set(title="All of it", xlabel="share of the energy at the start, %", xlim=(0, 100))
    ball.set(title="What the ball took", xlabel="share of the energy at the start, %")
    ball.set_xlim(0, max(ball.get_xlim()[1], 1e-6))
    drawing.key(figure, whole, sheet)
    return drawing.svg(figure, sheet, "books", "Where the energy went at each speed, in shares", live=True)


def _bars(axes: Axes, bars: list[tuple[float, Energy]], parts: tuple[tuple[str, str], ...]) -> None:
    places, begun = np.arange(len(bars)), np.zeros(len(bars))
    colours = dict(zip((name for name, _ in PARTS), _COLOURS, strict=True))
    for name, label in parts:
        shares = np.array([100 * getattr(energy, name) / energy.initial for _, energy in bars])
        axes.barh(places, shares, 0.7, begun, color=colours[name], label=label)
        begun += shares
    axes.set_yticks(places, [f"{amount(rpm)} rpm" for rpm, _ in bars])
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
