"""What accuracy and effects cost, as files and as text: JSON, CSV, a plot, and one page for a person."""

from __future__ import annotations

import csv
import json
import math
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows import formatting
from workflows.output import folder as store
from workflows.report import plots as plot
from workflows.report.page import from_template
from workflows.studies.work_precision.effects import Switched, Switches
from workflows.studies.work_precision.study import WITH_THEORY
from workflows.studies.work_precision.timing import POLICY, POLICY_OF_DIFFERENCES, Costs, Ladder, Rung

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


def ladder_plot(found: Ladder, name: str, asked: float | None) -> str:
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


def write_accuracy(found: Costs, out: Path) -> None:
    """Write `accuracy.json`, `accuracy.csv`, `accuracy.svg` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    asked = found.asked["frequency"]
    named = list(enumerate(found.ladders))
    figures = [ladder_plot(ladder, f"ladder{number}", _asked(found, ladder)) for number, ladder in named]
    first = [ladder for ladder in found.ladders if ladder.stage in ("plate", "damper")]
    with store.replacing(out) as folder:
        (folder / "accuracy.json").write_text(dumps(found.document()) + "\n", encoding="utf-8")
        (folder / "accuracy.svg").write_text(plot.standalone(overview(first, asked)), encoding="utf-8")
        _write_csv(
            folder / "accuracy.csv",
            ("stage", "method", "setting", "unknowns", "time_s", "error", "uncertainty", "failed"),
            [{"stage": ladder.stage, **vars(row)} for ladder in found.ladders for row in ladder.rows],
        )
        page = _render(
            "accuracy.html.j2",
            found=found,
            figures=figures,
            policy=POLICY,
            verdict=verdict(found),
            not_drawn=not_drawn,
        )
        (folder / "report.html").write_text(page, encoding="utf-8")


def write_effects(found: Switches, out: Path) -> None:
    """Write `effects.json`, `effects.csv`, `effects.svg` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    figure = effects(found)
    with store.replacing(out) as folder:
        (folder / "effects.json").write_text(dumps(found.document()) + "\n", encoding="utf-8")
        (folder / "effects.svg").write_text(plot.standalone(effects(found)), encoding="utf-8")
        times = ("time_s", "time_least_s", "time_most_s", "within_noise", "time_share")
        _write_csv(
            folder / "effects.csv",
            ("effect", "on", "called_for", *times, *_quantities(found), "remarks", "failed"),
            [_flat(row) for row in found.rows],
        )
        page = _render("effects.html.j2", found=found, figure=figure, policy=POLICY_OF_DIFFERENCES, spent=_spent)
        (folder / "report.html").write_text(page, encoding="utf-8")


def dumps(document: dict[str, Any]) -> str:
    """The machine-readable result."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


def accuracy_text(found: Costs) -> str:
    """The ladders as a table."""
    lines = []
    for ladder in found.ladders:
        lines += [f"{ladder.stage}: {ladder.quantity}", f"  against {ladder.reference}", ""]
        wide = max(22, *(len(row.setting) for row in ladder.rows))
        lines.append(f"  {'method':<30} {'setting':<{wide}} {'unknowns':>9} {'time, ms':>10} {'error':>9}")
        lines += [f"  {row.method:<30} {row.setting:<{wide}} {_numbers(row)}" for row in ladder.rows]
        lines.append("")
    lines += ["chosen by the scene's accuracy"]
    for stage, chosen in found.chosen.items():
        estimate, error = (_exponent(value) for value in (chosen.error_estimate, chosen.error))
        lines.append(f"  {stage}: {chosen.method}, {chosen.setting}; estimate {estimate}, true {error}")
    return "\n".join(lines)


def effects_text(found: Switches) -> str:
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


def verdict(found: Costs) -> list[str]:
    """Who is cheapest for which error, in sentences, and what speaks against it."""
    return [
        f"{ladder.stage[0].upper()}{ladder.stage[1:]}: {_winner(ladder, _asked(found, ladder))}"
        f"{_theory_error(found, ladder)}."
        for ladder in found.ladders
        if len({row.method for row in ladder.rows}) > 1
    ]


def not_drawn(ladder: Ladder) -> list[str]:
    """The rows that have no place in the plot, and why, in a line for each method."""
    found: dict[str, list[str]] = {}
    for row in ladder.rows:
        if row.failed is not None:
            found.setdefault(row.method, []).append(f"{row.setting} ({row.failed})")
    return [f"{method}: {', '.join(settings)}" for method, settings in found.items()]


def _asked(found: Costs, ladder: Ladder) -> float:
    return found.asked["damping" if ladder.stage == "damper" or "damping" in ladder.stage else "frequency"]


def _judged(ladder: Ladder) -> list[tuple[float, float, Rung]]:
    """Time, error and row, the cheapest first."""
    known = [(row.time_s, row.error, row) for row in ladder.rows if row.time_s is not None and row.error is not None]
    return sorted(known, key=lambda item: item[0])


def _best(ladder: Ladder, asked: float) -> Rung | None:
    return next((row for _, error, row in _judged(ladder) if error <= asked), None)


def _winner(ladder: Ladder, asked: float) -> str:
    best, limit = _best(ladder, asked), f"{formatting.significant(100 * asked)} %"
    if best is None:
        return f"nothing meets {limit}{_doubt(ladder, asked)}"
    text = f"{best.method} ({best.setting}) is the cheapest that meets {limit}, in {_milliseconds(best)} ms"
    second = next(
        (row for _, error, row in _judged(ladder) if error <= asked and row.method != best.method),
        None,
    )
    if second is None:
        return f"{text}; no other does{_doubt(ladder, asked)}"
    times = formatting.significant((second.time_s or 0.0) / (best.time_s or 1.0), 2)
    return f"{text}; next comes {second.method} ({second.setting}), {times} times as long{_doubt(ladder, asked)}"


def _doubt(ladder: Ladder, asked: float) -> str:
    """Whether the reference is too uncertain to tell if the winner, or what is cheaper, meets the accuracy."""
    best = _best(ladder, asked)
    open_ones = []
    for _, error, row in _judged(ladder):
        if row.uncertainty is not None and abs(error - asked) < row.uncertainty:
            open_ones.append(row.uncertainty)
        if row is best:
            break
    if not open_ones:
        return ""
    good = formatting.significant(100 * max(open_ones), 1)
    return f"; the reference, itself good to about {good} %, leaves this open"


def _theory_error(found: Costs, ladder: Ladder) -> str:
    """What the winner's theory adds, which the ladder of each theory by itself does not see."""
    asked = _asked(found, ladder)
    best = _best(ladder, asked)
    if ladder.stage != "plate" or best is None:
        return ""
    theirs = [other for other in found.ladders if other.stage == WITH_THEORY]
    rows = [row for other in theirs for row in other.rows if (row.method, row.setting) == (best.method, best.setting)]
    if not rows or rows[0].error is None:
        return "; how far its theory is from a solid is not known here"
    error, trust = rows[0].error, rows[0].uncertainty or 0.0
    off, good = (formatting.significant(100 * value, 2) for value in (error, trust))
    if error - trust > asked:
        return f"; but against a solid {best.method} errs by {off} %: its theory is not that good"
    if error + trust > asked:
        known = f"against a solid, itself known to about {good} %, {best.method} errs by {off} %"
        return f"; {known}, which leaves open whether its theory is that good"
    return ""


def _numbers(row: Rung) -> str:
    unknowns = "–" if row.unknowns is None else str(row.unknowns)
    if row.failed is not None:
        return f"{unknowns:>9}  {row.failed}"
    return f"{unknowns:>9} {_milliseconds(row):>10} {_exponent(row.error):>9}"


def _milliseconds(row: Rung) -> str:
    return formatting.significant(1e3 * (row.time_s or 0.0), 3)


def _exponent(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}"


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


def _quantities(found: Switches) -> list[str]:
    return list(dict.fromkeys(name for row in found.rows for name in row.changes))


def _write_csv(path: Path, columns: tuple[str, ...], rows: list[dict[str, Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, columns, extrasaction="ignore")
        table.writeheader()
        table.writerows(rows)


def _render(template: str, **values: Any) -> str:
    from markupsafe import Markup

    words: dict[str, Callable[..., str]] = {
        "svg": Markup,
        "significant": formatting.significant,
        "milliseconds": _milliseconds,
        "exponent": _exponent,
    }
    return from_template(template, words, **values)
