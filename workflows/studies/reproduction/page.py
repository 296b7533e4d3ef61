"""The reproduction as files: JSON, CSV and one page for a person."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from workflows import wording
from workflows.output import store
from workflows.report import plots as plot
from workflows.report import templating
from workflows.studies.reproduction import pictures
from workflows.studies.reproduction.claim import Value
from workflows.studies.reproduction.reproduce import ASSUMPTIONS, Reproduction


def write(found: Reproduction, out: Path) -> None:
    """Write `reproduce.json`, `reproduce.csv`, `closure.csv` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    with store.replacing(out) as folder:
        document = found.document()
        (folder / "reproduce.json").write_text(dumps(found) + "\n", encoding="utf-8")
        _write_csv(folder / "reproduce.csv", document["claims"])
        _write_csv(
            folder / "closure.csv",
            [line | {"assumptions": _names(line["assumptions"])} for line in document["closure"]],
        )
        (folder / "report.html").write_text(render(found), encoding="utf-8")


def dumps(found: Reproduction) -> str:
    """The machine-readable result."""
    return json.dumps(found.document(), indent=1, ensure_ascii=False, allow_nan=False)


def render(found: Reproduction) -> str:
    """The page."""
    from markupsafe import Markup

    return templating.page(
        "reproduce.html.j2",
        {"value": value, "fixed": wording.fixed, "significant": wording.significant},
        plot.shades_css(7),
        found=found,
        figures=[(figure, Markup(figure.svg)) for figure in pictures.draw(found)],
        closure=[(_names([vars(a) for a in line.assumptions], "text"), line) for line in found.closure],
        assumptions=ASSUMPTIONS,
        low=14.0,
    )


def value(number: Value) -> str:
    """A claim's value in words."""
    if number is None:
        return "–"
    if isinstance(number, str):
        return number
    if isinstance(number, list):
        return ", ".join(value(item) for item in number)
    size = abs(number)
    if size >= 1000:
        return _unbroken(wording.fixed(number))
    if size >= 100:
        return wording.fixed(number, 1)
    return f"{number:.1e}" if 0 < size < 1e-3 else wording.significant(number)


def _unbroken(text: str) -> str:
    """Keep the groups of a number on one line."""
    return text.replace(" ", "\N{NARROW NO-BREAK SPACE}").replace("\N{THIN SPACE}", "\N{NARROW NO-BREAK SPACE}")


def _names(assumptions: list[dict[str, Any]], key: str = "name") -> str:
    return " + ".join(str(item[key]) for item in assumptions) or "none"


def _write_csv(path: Path, rows: list[dict[str, Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, rows[0])
        table.writeheader()
        for row in rows:
            table.writerow({k: " ".join(map(str, v)) if isinstance(v, list) else v for k, v in row.items()})
