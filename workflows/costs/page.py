"""What accuracy and effects cost, as files and as text: JSON, CSV, a plot, and one page for a person."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from workflows import drawing, store, wording
from workflows.costs import plots
from workflows.costs.ladder import Ladder, Row, Study
from workflows.costs.switching import Switched, Switches
from workflows.costs.timing import POLICY, POLICY_OF_DIFFERENCES

_TEMPLATES = Path(__file__).parent.parent / "templates"


def write_accuracy(found: Study, out: Path) -> None:
    """Write `accuracy.json`, `accuracy.csv`, `accuracy.svg` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    asked = found.asked["frequency"]
    named = list(enumerate(found.ladders))
    figures = [plots.ladder(ladder, f"ladder{number}", _asked(found, ladder)) for number, ladder in named]
    first = [ladder for ladder in found.ladders if ladder.stage in ("plate", "damper")]
    with store.replacing(out) as folder:
        (folder / "accuracy.json").write_text(dumps(found.document()) + "\n", encoding="utf-8")
        (folder / "accuracy.svg").write_text(drawing.standalone(plots.overview(first, asked)), encoding="utf-8")
        _write_csv(
            folder / "accuracy.csv",
            ("stage", "method", "setting", "unknowns", "time_s", "error", "failed"),
            [{"stage": ladder.stage, **vars(row)} for ladder in found.ladders for row in ladder.rows],
        )
        page = _render("accuracy.html.j2", found=found, figures=figures, policy=POLICY, verdict=verdict(found))
        (folder / "report.html").write_text(page, encoding="utf-8")


def write_effects(found: Switches, out: Path) -> None:
    """Write `effects.json`, `effects.csv`, `effects.svg` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    figure = plots.effects(found)
    with store.replacing(out) as folder:
        (folder / "effects.json").write_text(dumps(found.document()) + "\n", encoding="utf-8")
        (folder / "effects.svg").write_text(drawing.standalone(figure), encoding="utf-8")
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


def accuracy_text(found: Study) -> str:
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
        quantity, size = ("", wording.DASH) if top is None else (top[0], f"{100 * top[1]:.3g} %")
        on, called = ("yes" if flag else "no" for flag in (row.on, row.called_for))
        lines.append(f"{row.effect:<20} {on:<4} {called:<11} {size:>14}  {quantity:<16} {_spent(row):>24}  {row.why}")
        lines += [f"{'':<20} {remark}" for remark in (*row.remarks, *([row.failed] if row.failed else []))]
    return "\n".join(lines)


def verdict(found: Study) -> list[str]:
    """Who is cheapest for which error, in sentences."""
    return [sentence for ladder in found.ladders if (sentence := _winner(ladder, _asked(found, ladder)))]


def _asked(found: Study, ladder: Ladder) -> float:
    return found.asked["damping" if ladder.stage == "damper" or "damping" in ladder.stage else "frequency"]


def _winner(ladder: Ladder, asked: float) -> str:
    good = [row for row in ladder.rows if row.time_s is not None and row.error is not None and row.error <= asked]
    if not good or len({row.method for row in ladder.rows}) < 2:
        return ""
    best = min(good, key=lambda row: row.time_s or 0.0)
    others = {
        row.method: row for row in sorted(good, key=lambda row: -(row.time_s or 0.0)) if row.method != best.method
    }
    text = (
        f"{ladder.stage[0].upper()}{ladder.stage[1:]}: {best.method} ({best.setting}) is the cheapest that meets"
        f" {wording.significant(100 * asked)} %, in {_milliseconds(best)} ms"
    )
    if not others:
        return f"{text}; no other does."
    second = min(others.values(), key=lambda row: row.time_s or 0.0)
    times = wording.significant((second.time_s or 0.0) / (best.time_s or 1.0), 2)
    return f"{text}; next comes {second.method} ({second.setting}), {times} times as long."


def _numbers(row: Row) -> str:
    unknowns = "–" if row.unknowns is None else str(row.unknowns)
    if row.failed is not None:
        return f"{unknowns:>9}  {row.failed}"
    return f"{unknowns:>9} {_milliseconds(row):>10} {_exponent(row.error):>9}"


def _milliseconds(row: Row) -> str:
    return wording.significant(1e3 * (row.time_s or 0.0), 3)


def _exponent(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}"


def _spent(row: Switched) -> str:
    """What an effect adds to a run [ms], as a person may believe it."""
    if row.time_s is None or row.time_spread_s is None:
        return wording.DASH
    low, high = (wording.significant(1e3 * end, 2) for end in row.time_spread_s)
    middle = "within noise" if row.within_noise else wording.significant(1e3 * row.time_s, 2)
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
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "svg": Markup,
        "significant": wording.significant,
        "milliseconds": _milliseconds,
        "exponent": _exponent,
    }
    css = Markup((_TEMPLATES / "report.css").read_text(encoding="utf-8"))
    return environment.get_template(template).render(css=css, **values)
