"""The figure of the energy books: where the energy of the release went, a bar for each speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workflows.report import drawing, palette
from workflows.report.drawing import Sheet
from workflows.solve.quantity import Quantity, entries
from workflows.solve.records import Energy, Results
from workflows.wording import amount

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEFT, *_LOST = (
    (each.name, each.what.short) for each in entries(Energy) if isinstance(each.what, Quantity) and each.what.short
)
PARTS = (*_LOST, _LEFT)
"""Parts of the books and what the record calls them: what was lost, first to the structure, then what is left."""

_COLOURS = (palette.CATEGORIES[5], palette.CATEGORIES[2], palette.CATEGORIES[1], palette.CATEGORIES[3], palette.RULE)

_BARS_AT_MOST = 40
"""Speeds that a picture has bars for."""


def rows(results: Results) -> list[tuple[float, Energy]]:
    """Speed [rpm] and books of the ring-downs that the figure shows, evenly chosen where there are many."""
    found = [(p.rpm, p.damping.energy) for p in results.speeds if p.damping and p.damping.energy.initial > 0]
    if len(found) <= _BARS_AT_MOST:
        return found
    return [found[k] for k in np.unique(np.linspace(0, len(found) - 1, _BARS_AT_MOST).round().astype(int))]


def panels(bars: list[tuple[float, Energy]]) -> list[tuple[tuple[str, str], ...]]:
    """The parts that each panel shows."""
    return [PARTS, PARTS[1:4]] if any(energy.structure > 0.0 for _, energy in bars) else [PARTS]


def books(results: Results, sheet: Sheet) -> str:
    """Shares of the energy of the release; beside what the structure took, what the ball did on a scale of its own."""
    bars = rows(results)
    if not bars:
        return ""
    shown = panels(bars)
    figure, drawn = drawing.canvas(sheet, 0.75 + 0.2 * len(bars), len(shown))
    for axes, parts in zip(drawn, shown, strict=True):
        _bars(axes, bars, parts)
        axes.set(xlabel="share of the energy at the start, %")
    drawn[0].set(xlim=(0, 100))
    if len(shown) == 2:
        drawn[0].set(title="All of it")
        drawn[1].set(title="What the ball took", xlim=(0, max(drawn[1].get_xlim()[1], 1e-6)))
    drawing.key(figure, drawn[0], sheet)
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
