"""Pictures of what accuracy and effects cost."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING, Any

from workflows import wording
from workflows.report import plots as plot
from workflows.studies.costs.ladder import Ladder
from workflows.studies.costs.switching import Switched, Switches

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SMALLEST = 1e-16
"""An error of nothing is drawn here, on the axis' edge."""

_ROUNDING = 1e-12
"""Changes below this are none at all."""

_UNSEEN = 1e-2
"""Changes below this part of the accuracy asked for are said to be none, so that the others can be told apart."""

_LONGEST = 50
"""Characters of a line of a reason beside an effect's name; the whole of a longer one is its title."""

_SAID: dict[str, Any] = {
    "textcoords": "offset points",
    "va": "center",
    "color": plot.MUTED,
    "fontsize": 7,
    "bbox": {"facecolor": plot.PAPER, "edgecolor": "none", "pad": 1.0},
}
"""How words instead of a bar are set."""


def ladder(found: Ladder, name: str, asked: float | None) -> str:
    """Time against error, both on log axes, a line for each method; the accuracy asked for dashed."""
    with plot.style():
        figure, (axes,) = plot.canvas(3.4)
        _work_precision(axes, found, asked)
        plot.legend(figure, axes, ncols=1)
        return plot.svg(figure, name, f"Time against error: {found.quantity}")


def overview(ladders: list[Ladder], asked: float | None) -> str:
    """Some ladders side by side."""
    with plot.style():
        figure, panels = plot.canvas(4.0, len(ladders))
        for axes, found in zip(panels, ladders, strict=True):
            _work_precision(axes, found, asked)
            axes.set_title(found.stage)
            axes.legend(loc="upper left", bbox_to_anchor=(-0.05, -0.2), ncols=1, fontsize=6.5)
        return plot.svg(figure, "overview", "Time against error")


def effects(found: Switches) -> str:
    """The largest change that each effect makes to any quantity, and to which, beside the time it takes."""
    with plot.style():
        figure, (left, right) = plot.canvas(0.9 + 0.34 * len(found.rows), 2)
        rows, least = found.rows[::-1], _least(found)
        for place, row in enumerate(rows):
            colour = plot.CATEGORIES[0] if row.on else plot.CATEGORIES[6]
            _change(left, place, row, colour, least)
            _time(right, place, row, colour)
        labels = [label for place, row in enumerate(rows) for label in _labels(place, row, least)]
        left.set_yticks([place for place, _ in labels], [label for _, label in labels])
        right.set_yticks(range(len(rows)), [_name(row) for row in rows])
        for axes in (left, right):
            axes.set_ylim(-0.6, len(rows) - 0.4)
            axes.tick_params(axis="y", length=0.0)
            axes.grid(visible=False, axis="y")
        sizes = [abs(row.largest[1]) for row in rows if row.largest is not None]
        left.set(
            xscale="log",
            xlim=(least, 10 * max(1.0, found.asked, *sizes)),
            title="largest relative change of any quantity",
            xlabel=f"dashed: the scene's own accuracy, {found.asked:g}",
        )
        left.axvline(found.asked, color=plot.MUTED, lw=0.8, ls=(0, (4, 3)))
        right.set(title="share of the run's time with it, %")
        unseen = [(place, _unseen(row, least)) for place, row in enumerate(rows) if not _is_seen(row, least)]
        whole = [plot.Value(left, 1.1 * least, place, reason) for place, reason in unseen if len(reason) > _LONGEST]
        return plot.svg(figure, "effects", "What each effect changes and costs", whole)


def _least(found: Switches) -> float:
    """Where the axis of changes begins."""
    return float(10.0 ** math.floor(math.log10(_UNSEEN * found.asked)))


def _is_seen(row: Switched, least: float) -> bool:
    return row.largest is not None and abs(row.largest[1]) > least


def _change(axes: Axes, place: int, row: Switched, colour: str, least: float) -> None:
    if row.largest is not None and _is_seen(row, least):
        size = abs(row.largest[1])
        axes.plot([least, size], [place, place], color=colour, lw=1.2)
        axes.plot([size], [place], "o", color=colour, ms=4)
        return
    text = textwrap.fill(_unseen(row, least), _LONGEST, max_lines=2, placeholder=" …")
    axes.annotate(text, (0.0, place), (4.0, 0.0), xycoords=("axes fraction", "data"), **_SAID)


def _unseen(row: Switched, least: float) -> str:
    """Why an effect has no bar."""
    if row.failed is not None:
        return row.failed
    top = row.largest
    none = "none" if top is None or abs(top[1]) <= _ROUNDING else f"none above {wording.significant(100 * least)} %"
    return "; ".join((f"{none} in numbers" if row.remarks else none, *row.remarks))


def _time(axes: Axes, place: int, row: Switched, colour: str) -> None:
    if row.within_noise:
        axes.annotate("within noise", (0.0, place), (4.0, 0.0), **_SAID)
    elif row.time_share is not None:
        axes.barh(place, 100 * row.time_share, color=colour, height=0.5)


def _labels(place: int, row: Switched, least: float) -> list[tuple[float, str]]:
    """An effect and what it changes most, at heights of their own: lines of one text come out ragged in a browser."""
    top = row.largest
    if top is None or not _is_seen(row, least):
        return [(place, _name(row))]
    changed = f"{top[0].replace('_', ' ')}, {wording.significant(100 * top[1], 2)} %"
    return [(place + 0.2, _name(row)), (place - 0.2, changed)]


def _name(row: Switched) -> str:
    return row.effect.replace("_", " ")


def _work_precision(axes: Axes, found: Ladder, asked: float | None) -> None:
    methods = list(dict.fromkeys(row.method for row in found.rows))
    for number, method in enumerate(methods):
        rows = [row for row in found.rows if row.method == method and row.time_s is not None and row.error is not None]
        if rows:
            axes.plot(
                [max(row.error or 0.0, _SMALLEST) for row in rows],
                [row.time_s or 0.0 for row in rows],
                color=plot.CATEGORIES[number % len(plot.CATEGORIES)],
                marker=plot.MARKERS[number % len(plot.MARKERS)],
                ls="-" if number < len(plot.CATEGORIES) else (0, (3, 2)),
                lw=1.0,
                label=method,
            )
    if asked is not None:
        axes.axvline(asked, color=plot.MUTED, lw=0.8, ls=(0, (4, 3)))
    axes.set(xscale="log", yscale="log", xlabel="relative error", ylabel="time, s")
    axes.invert_xaxis()
