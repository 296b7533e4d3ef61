"""Results in brief, as a notebook or an interactive Python shows them."""

from __future__ import annotations

from dataclasses import fields
from html import escape
from typing import TYPE_CHECKING

from workflows.errors import one_line
from workflows.findings import answer, trust
from workflows.report import text as summary
from workflows.solve.records import Results
from workflows.wording import amount

if TYPE_CHECKING:
    from workflows.report.plots import Plots

_ROWS_AT_MOST = 12


class Shown(Results):
    """Results that show themselves in brief."""

    def __repr__(self) -> str:
        return text(self)

    def _repr_html_(self) -> str:
        return html(self)

    @property
    def plot(self) -> Plots:
        """The pictures of the run: `results.plot.campbell()` and so on."""
        from workflows.report.plots import Plots

        return Plots(self)


def shown(results: Results) -> Shown:
    """The same results, which show themselves."""
    return Shown(**{each.name: getattr(results, each.name) for each in fields(Results)})


def text(results: Results) -> str:
    """Title, speeds, what was found, and how far the frequencies can be trusted, a line each."""
    found = answer.answer(results)
    said = trust.errors(results)
    lines = [_head(results), " ".join((f"{found.verdict}.", *found.sentences[:1])), *([] if said is None else [said])]
    return "\n".join(lines)


def html(results: Results) -> str:
    """The same with a table; everything that comes from a scene is escaped."""
    found, said = answer.answer(results), trust.sentence(results)
    sentences = " ".join(found.sentences if said is None or said in found.sentences else (*found.sentences, said))
    heads, *rows = summary.rows(results)
    left_out = len(rows) - _ROWS_AT_MOST
    more = f"<p>… {left_out} more speeds</p>" if left_out > 0 else ""
    table = _row("th", heads) + "".join(_row("td", row) for row in rows[:_ROWS_AT_MOST])
    return (
        f"<p>{escape(_head(results))}</p><p><b>{escape(found.verdict)}.</b> {escape(sentences)}</p>"
        f"<table>{table}</table>{more}"
    )


def _head(results: Results) -> str:
    speeds = [point.rpm for point in results.speeds]
    title = one_line(results.scene.title)
    if not speeds:
        return f"{title}: 0 speeds"
    if len(speeds) == 1:
        return f"{title}: 1 speed, {amount(speeds[0])} rpm"
    return f"{title}: {len(speeds)} speeds, {amount(min(speeds))} to {amount(max(speeds))} rpm"


def _row(kind: str, cells: tuple[str, ...]) -> str:
    return f"<tr>{''.join(f'<{kind}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"
