"""Results as text: what a run prints, and what a notebook or an interactive Python shows."""

from __future__ import annotations

import re
import shutil
import textwrap
from dataclasses import fields
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from workflows import pipeline
from workflows.errors import one_line
from workflows.formatting import aligned, amount, fixed, plain, prose, revolutions, share, significant
from workflows.laws import lawful
from workflows.progress import Stages
from workflows.report import remarks, verdict
from workflows.scene.load import DEFAULT, SceneLike
from workflows.solve import limits
from workflows.solve.results import Results, SpeedPoint

if TYPE_CHECKING:
    from workflows.report.figures import Plots


_MODES_AT_MOST = 8
_ROWS_AT_MOST = 12


def text(results: Results, out: Path | None, on_scene: tuple[str, ...] = ()) -> str:
    """The summary, ready to print; remarks on how the scene is written come first wherever the notes are."""
    answer = verdict.answer(results)
    parts = [f"{one_line(results.scene.title)}: {revolutions(results.scene.rotor.speeds)}"]
    parts += [*(line for remark in on_scene for line in _wrapped(remark)), ""]
    parts += _wrapped(" ".join((f"{answer.verdict}.", *answer.lead)))
    parts += ["", *aligned(rows(results))]
    parts += [line for each in remarks.legend(results) for line in _wrapped(each)]
    if answer.details:
        parts += ["", *_wrapped(" ".join(answer.details))]
    if results.notes and out is None:
        parts.append("")
        notes = answer.besides([note for note in results.notes if note not in on_scene])
        parts += [line for note in notes[: remarks.FIRST] for line in _wrapped(note, "- ")]
        if (more := len(notes) - remarks.FIRST) > 0:
            parts.append(f"- {more} more: in the report, and in `results.notes`")
    seconds = f"{results.timings['total']:.1f} s"
    if out is None:
        parts += ["", f"{seconds}; nothing written (--out DIR writes results and a report)"]
    else:
        count = len(results.notes)
        counted = f", {count} remark{'s' if count > 1 else ''}" if count else ""
        parts += ["", f"{seconds}{counted}; open {out / 'report.html'}"]
    return "\n".join(parts)


def _wrapped(paragraph: str, mark: str = "") -> list[str]:
    width = min(shutil.get_terminal_size((100, 24)).columns, 100)
    whole = re.sub(r"(?<=\d) (?=%|(?:mm|g|rpm|Hz|N)\b)", "\xa0", paragraph)  # a number and its unit on one line
    lines = textwrap.wrap(whole, width, initial_indent=mark, subsequent_indent=" " * len(mark))
    return [line.replace("\xa0", " ") for line in lines]


def rows(results: Results) -> list[tuple[str, ...]]:
    """The table, its heads first: a row a speed."""
    if any(point.damper is not None for point in results.speeds):
        is_first = all(point.followed == 0 or not point.modes for point in results.speeds)
        hertz = "first Hz" if is_first else f"{verdict.followed_mode(results)} Hz"
        heads: tuple[str, ...] = ("rpm", "load g", hertz, "cut-off g", "/ load", "SDC %")
        heads += ("ball ζ %", "at mm", "hits")
        return [heads, *(_damped(results, point) for point in results.speeds)]
    count = min(max((len(point.modes) for point in results.speeds), default=0), _MODES_AT_MOST)
    heads = ("rpm", "load g", *(f"mode {i + 1} Hz" for i in range(count)))
    table = [
        (amount(p.rpm), amount(p.load_g), *(f"{m.frequency_hz:.2f} {m.family:<5}" for m in p.modes[:count]))
        for p in results.speeds
    ]
    return [heads, *table]


def _damped(results: Results, point: SpeedPoint) -> tuple[str, ...]:
    damping, figures = point.damper, point.damping_curve
    if damping is None:
        return (amount(point.rpm), amount(point.load_g))
    cutoff = limits.cutoff(results, point)
    at_rest = remarks.cutoff_mark(results, point)
    return (
        amount(point.rpm),
        amount(point.load_g),
        fixed(verdict.first_frequency(point), 2),
        amount(cutoff.g) + at_rest,
        significant(cutoff.ratio) + at_rest,
        share(remarks.lost_at_most(damping)),
        significant(100 * figures.peak if figures else 0.0) + remarks.mark(results, point),
        significant(1e3 * figures.peak_amplitude if figures else None),
        fixed(damping.impacts),
    )


class Shown(Results):
    """Results that show themselves in brief."""

    def __repr__(self) -> str:
        return brief(self)

    def _repr_html_(self) -> str:
        return brief_html(self)

    @property
    def plot(self) -> Plots:
        """The pictures of the run: `results.plot.campbell()` and so on."""
        from workflows.report.figures import Plots

        return Plots(self)


def shown(results: Results) -> Shown:
    """The same results, which show themselves."""
    return Shown(**{each.name: getattr(results, each.name) for each in fields(Results)})


def brief(results: Results) -> str:
    """Title, speeds, what was found, and how far the frequencies can be trusted, a line each."""
    answer = verdict.answer(results)
    accuracy = remarks.sentence(results)
    more = () if results.reductions else answer.sentences[:1]  # a crossing's next sentences are on single levels
    lines = [_head(results), " ".join((f"{answer.verdict}.", *more)), *([] if accuracy is None else [accuracy])]
    return plain("\n".join(lines))


def brief_html(results: Results) -> str:
    """The same with a table; everything that comes from a scene is escaped."""
    answer, accuracy = verdict.answer(results), remarks.sentence(results)
    sentences = " ".join((*answer.sentences, *answer.besides([accuracy or ""])))
    heads, *lines = rows(results)
    left_out = len(lines) - _ROWS_AT_MOST
    more = f"<p>… {left_out} more speeds</p>" if left_out > 0 else ""
    table = _row("th", heads) + "".join(_row("td", row) for row in lines[:_ROWS_AT_MOST])
    return (
        f"<p>{escape(_head(results))}</p><p><b>{prose(answer.verdict)}.</b> {prose(sentences)}</p>"
        f"<table>{table}</table>{more}{''.join(f'<p>{escape(each)}</p>' for each in remarks.legend(results))}"
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


@lawful()
def run(scene: SceneLike = DEFAULT, stages: Stages | None = None) -> Shown:
    """The whole of a run with its remarks, nothing written.

    Args:
        scene: the name of a shipped scene, the path of a file, a dict, a Scene or what `load` returns.
        stages: the clock to go by, if not one of its own.

    Raises:
        ImpossibleResult: a figure violates a law of physics.
        BadInput, NoAnswer, TypeError: see :func:`workflows.pipeline.run`.
    """
    return shown(remarks.remarked(pipeline.run(scene, stages)))
