"""Pictures of what accuracy and effects cost."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from workflows import drawing, wording
from workflows.costs.ladder import Ladder
from workflows.costs.switching import Switched, Switches

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SMALLEST = 1e-16
"""An error of nothing is drawn here, on the axis' edge."""

_NEGLIGIBLE = 1e-12
"""Changes below this are rounding."""

_LONGEST = 100
"""Characters of a reason that fit into the figure."""


def ladder(found: Ladder, name: str, asked: float | None) -> str:
    """Time against error, both on log axes, a line for each method; the accuracy asked for dashed."""
    with drawing.style():
        figure, (axes,) = drawing.canvas(3.4, left=0.09, right=0.66, top=0.95, bottom=0.14)
        _work_precision(axes, found, asked)
        axes.legend(loc="center left", bbox_to_anchor=(1.02, 0.5))
        return drawing.svg(figure, name, f"Time against error: {found.quantity}")


def overview(ladders: list[Ladder], asked: float | None) -> str:
    """Some ladders side by side."""
    with drawing.style():
        figure, panels = drawing.canvas(3.9, len(ladders), left=0.08, right=0.985, top=0.93, bottom=0.42, wspace=0.24)
        for axes, found in zip(panels, ladders, strict=True):
            _work_precision(axes, found, asked)
            axes.set_title(found.stage)
            axes.legend(loc="upper left", bbox_to_anchor=(-0.05, -0.2), ncols=1, fontsize=6.5)
        return drawing.svg(figure, "overview", "Time against error")


def effects(found: Switches) -> str:
    """The largest change that each effect makes to any quantity, and to which, beside the time it takes."""
    with drawing.style():
        height = 0.9 + 0.34 * len(found.rows)
        figure, (left, right) = drawing.canvas(height, 2, left=0.23, right=0.97, top=0.88, bottom=0.16, wspace=0.12)
        rows = found.rows[::-1]
        for place, row in enumerate(rows):
            colour = drawing.CATEGORIES[0] if row.on else drawing.CATEGORIES[6]
            _change(left, place, row, colour)
            if row.within_noise:
                right.annotate(
                    "within noise",
                    (0.0, place),
                    (4.0, 0.0),
                    textcoords="offset points",
                    va="center",
                    color=drawing.MUTED,
                    fontsize=7,
                )
            elif row.time_share is not None:
                right.barh(place, 100 * row.time_share, color=colour, height=0.5)
        names = [label for place, row in enumerate(rows) for label in _labels(place, row)]
        left.set_yticks([place for place, _ in names], [name for _, name in names])
        right.set_yticks([])
        for axes in (left, right):
            axes.set_ylim(-0.6, len(rows) - 0.4)
            axes.tick_params(axis="y", length=0.0)
            axes.grid(visible=False, axis="y")
        sizes = [abs(row.largest[1]) for row in rows if row.largest is not None]
        left.set(
            xscale="log",
            xlim=(_NEGLIGIBLE, 10 * max(1.0, found.asked, *sizes)),
            title="largest relative change of any quantity",
            xlabel=f"dashed: the scene's own accuracy, {found.asked:g}",
        )
        left.axvline(found.asked, color=drawing.MUTED, lw=0.8, ls=(0, (4, 3)))
        right.set(title="share of the run's time with it, %")
        return drawing.svg(figure, "effects", "What each effect changes and costs")


def _change(axes: Axes, place: int, row: Switched, colour: str) -> None:
    top = row.largest
    if top is None or abs(top[1]) <= _NEGLIGIBLE:
        words = row.failed or "; ".join(("nothing in numbers", *row.remarks) if row.remarks else ("nothing",))
        text = textwrap.shorten(words, _LONGEST, placeholder=" …")
        axes.text(2 * _NEGLIGIBLE, place, text, va="center", color=drawing.MUTED, fontsize=7)
        return
    axes.plot([_NEGLIGIBLE, abs(top[1])], [place, place], color=colour, lw=1.2)
    axes.plot([abs(top[1])], [place], "o", color=colour, ms=4)


def _labels(place: int, row: Switched) -> list[tuple[float, str]]:
    """An effect and what it changes most, at heights of their own: lines of one text come out ragged in a browser."""
    name, top = row.effect.replace("_", " "), row.largest
    if top is None or abs(top[1]) <= _NEGLIGIBLE:
        return [(place, name)]
    changed = f"{top[0].replace('_', ' ')}, {wording.significant(100 * top[1], 2)} %"
    return [(place + 0.2, name), (place - 0.2, changed)]


def _work_precision(axes: Axes, found: Ladder, asked: float | None) -> None:
    methods = list(dict.fromkeys(row.method for row in found.rows))
    for number, method in enumerate(methods):
        rows = [row for row in found.rows if row.method == method and row.time_s is not None and row.error is not None]
        if rows:
            axes.plot(
                [max(row.error or 0.0, _SMALLEST) for row in rows],
                [row.time_s or 0.0 for row in rows],
                color=drawing.CATEGORIES[number % len(drawing.CATEGORIES)],
                marker=drawing.MARKERS[number % len(drawing.MARKERS)],
                ls="-" if number < len(drawing.CATEGORIES) else (0, (3, 2)),
                lw=1.0,
                label=method,
            )
    if asked is not None:
        axes.axvline(asked, color=drawing.MUTED, lw=0.8, ls=(0, (4, 3)))
    axes.set(xscale="log", yscale="log", xlabel="relative error", ylabel="time, s")
    axes.invert_xaxis()
