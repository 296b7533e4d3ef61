"""What effects change and cost, as files and as text: JSON, CSV, a plot, and one page for a person."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows import formatting
from workflows.io.files import as_json, as_table, write_study
from workflows.report import plots
from workflows.report.page import from_template
from workflows.studies.work_precision.effects import Switched, Switches
from workflows.studies.work_precision.timing import POLICY_OF_DIFFERENCES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROUNDING = 1e-12
"""Changes below this are none at all."""


_UNSEEN = 1e-2
"""Changes below this part of the accuracy asked for are said to be none, so that the others can be told apart."""


_LONGEST = 50
"""Characters of a line of a reason beside an effect's name; the whole of a longer one is its title."""


_SAID: dict[str, Any] = {
    "textcoords": "offset points",
    "va": "center",
    "color": plots.MUTED,
    "fontsize": 7,
    "bbox": {"facecolor": plots.PAPER, "edgecolor": "none", "pad": 1.0},
}
"""How words instead of a bar are set."""


def draw(found: Switches) -> str:
    """The largest change that each effect makes to any quantity, and to which, beside the time it takes."""
    with plots.style():
        figure, (left, right) = plots.canvas(0.9 + 0.34 * len(found.rows), 2)
        rows, least = found.rows[::-1], _least(found)
        for place, row in enumerate(rows):
            colour = plots.CATEGORIES[0] if row.on else plots.CATEGORIES[6]
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
        left.axvline(found.asked, color=plots.MUTED, lw=0.8, ls=(0, (4, 3)))
        right.set(title="share of the run's time with it, %")
        unseen = [(place, _unseen(row, least)) for place, row in enumerate(rows) if not _is_seen(row, least)]
        whole = [plots.Value(left, 1.1 * least, place, reason) for place, reason in unseen if len(reason) > _LONGEST]
        return plots.svg(figure, "effects", "What each effect changes and costs", whole)


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
    none = "none" if top is None or abs(top[1]) <= _ROUNDING else f"none above {formatting.significant(100 * least)} %"
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
    changed = f"{top[0].replace('_', ' ')}, {formatting.significant(100 * top[1], 2)} %"
    return [(place + 0.2, _name(row)), (place - 0.2, changed)]


def _name(row: Switched) -> str:
    return row.effect.replace("_", " ")


def write(found: Switches, out: Path) -> None:
    """Write `effects.json`, `effects.csv`, `effects.svg` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    from markupsafe import Markup

    figure = draw(found)
    times = ("time_s", "time_least_s", "time_most_s", "within_noise", "time_share")
    quantities = dict.fromkeys(name for row in found.rows for name in row.changes)
    columns = ("effect", "on", "called_for", *times, *quantities, "remarks", "failed")
    words = {"significant": formatting.significant}
    constant: dict[str, Any] = {"policy": POLICY_OF_DIFFERENCES, "spent": _spent}
    contents = {
        "effects.json": dumps(found) + "\n",
        "effects.svg": plots.standalone(figure),
        "effects.csv": as_table(columns, map(_flat, found.rows)),
        "report.html": from_template("effects.html.j2", words, found=found, figure=Markup(figure), **constant),
    }
    write_study(out, contents)


def text(found: Switches) -> str:
    """The effects as a table; what has no place in it is below its row."""
    lines = [f"{'effect':<20} {'on':<4} {'called for':<11} {'largest change':>14}  {'of':<16} {'time, ms':>24}  why"]
    for row in found.rows:
        top = row.largest
        quantity, size = ("", formatting.DASH) if top is None else (top[0], f"{100 * top[1]:.3g} %")
        on, called = ("yes" if flag else "no" for flag in (row.on, row.called_for))
        lines.append(f"{row.effect:<20} {on:<4} {called:<11} {size:>14}  {quantity:<16} {_spent(row):>24}  {row.why}")
        lines += [f"{'':<20} {remark}" for remark in row.remarks]
        if row.failed is not None and row.failed != row.why:
            lines.append(f"{'':<20} no numbers: {row.failed}")
    return "\n".join(lines)


def _spent(row: Switched) -> str:
    """What an effect adds to a run [ms], as a person may believe it."""
    if row.time_s is None or row.time_spread_s is None:
        return formatting.DASH
    low, high = (formatting.significant(1e3 * end, 2) for end in row.time_spread_s)
    middle = "within noise" if row.within_noise else formatting.significant(1e3 * row.time_s, 2)
    return f"{middle} ({low} to {high})"


def _flat(row: Switched) -> dict[str, Any]:
    low, high = row.time_spread_s or (None, None)
    times = {"time_least_s": low, "time_most_s": high, "within_noise": row.within_noise}
    return vars(row) | times | row.changes | {"remarks": "; ".join(row.remarks)}


FILES = r"effects\.(json|csv|svg)"
"""Names of what is written besides the page."""


def dumps(found: Switches) -> str:
    """The machine-readable result."""
    return as_json(found.document())
