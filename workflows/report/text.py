"""Results as text: what a run prints, and what a notebook or an interactive Python shows."""

from __future__ import annotations

import re
import shutil
import textwrap
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fem.modal_model import ModalModel, families
from workflows import pipeline
from workflows.errors import one_line
from workflows.formatting import aligned, amount, fixed, plain, revolutions, rounded_rpm, share, significant
from workflows.io.files import finite
from workflows.laws import lawful
from workflows.progress import Stages
from workflows.report import remarks, verdict
from workflows.report.templates import from_template
from workflows.scene.load import DEFAULT, SceneLike
from workflows.solve import limits
from workflows.solve.results import Results, SpeedPoint, copy_fields

if TYPE_CHECKING:
    from workflows.report.figures import Plots


_MODES_AT_MOST = 8


def text(results: Results, out: Path | None, on_scene: tuple[str, ...] = ()) -> str:
    """The summary, ready to print; remarks on how the scene is written come first wherever the notes are."""
    answer = verdict.answer(results)
    parts = [_head(results)]
    parts += [*(line for remark in on_scene for line in wrapped(remark)), ""]
    parts += wrapped(" ".join((f"{answer.verdict}.", *answer.lead)))
    parts += ["", *aligned(rows(results))]
    parts += [line for each in remarks.legend(results) for line in wrapped(each)]
    if answer.details:
        parts += ["", *wrapped(" ".join(answer.details))]
    if results.notes and out is None:
        parts.append("")
        notes = answer.besides([note for note in results.notes if note not in on_scene])
        parts += [line for note in notes[: remarks.FIRST] for line in wrapped(note, "- ")]
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


def wrapped(paragraph: str, mark: str = "") -> list[str]:
    """A paragraph in lines as wide as the terminal, 100 letters at most; `mark` stands before the first."""
    width = min(shutil.get_terminal_size((100, 24)).columns, 100)
    whole = re.sub(r"(?<=\d) (?=%|(?:mm|g|rpm|Hz|N)\b)", "\xa0", paragraph)  # a number and its unit on one line
    lines = textwrap.wrap(whole, width, initial_indent=mark, subsequent_indent=" " * len(mark))
    return [line.replace("\xa0", " ") for line in lines]


class Column(NamedTuple):
    """A column of the tables over speeds: its key in files, its head, a value, how that is written, and its mark."""

    key: str
    head: str
    value: Callable[[Results, SpeedPoint], float | None]
    written: Callable[[float | None], str]
    mark: Callable[[Results, SpeedPoint], str] = lambda results, point: ""

    def cell(self, results: Results, point: SpeedPoint) -> str:
        """Of a speed."""
        return self.written(self.value(results, point)) + self.mark(results, point)


COLUMNS = (
    Column("load_g", "load g", lambda _, p: p.load_g, amount),
    Column("first_frequency_hz", "first Hz", lambda _, p: verdict.first_frequency(p), partial(fixed, places=2)),
    Column("first_frequency_error", "± %", lambda _, p: _frequency_error(p), partial(share, digits=2)),
    Column("cutoff_g", "cut-off g", lambda of, p: limits.cutoff(of, p).g, amount, remarks.cutoff_mark),
    Column("cutoff_ratio", "/ load", lambda of, p: limits.cutoff(of, p).ratio, significant, remarks.cutoff_mark),
    Column("sdc", "SDC %", lambda _, p: None if p.damper is None else remarks.lost_at_most(p.damper), share),
    Column("damping_ratio_percent", "ball ζ %", lambda _, p: _figure(p, "peak", 100), significant, remarks.mark),
    Column("damping_ratio_error", "± %", lambda _, p: _figure(p, "error", 1), partial(share, digits=2)),
    Column("at_amplitude_mm", "at mm", lambda _, p: _figure(p, "peak_amplitude", 1e3), significant),
    Column("hits", "hits", lambda _, p: None if p.damper is None else p.damper.impacts, fixed),
)
"""Of a damper, beside the speed; a run's own table has no errors."""


def _frequency_error(point: SpeedPoint) -> float | None:
    return None if (followed := point.followed) is None else finite(point.modes[followed].error_estimate)


def _figure(point: SpeedPoint, name: str, factor: float) -> float | None:
    """One of the damper's own figures; None where there is none that is finite."""
    return None if point.damping_curve is None else finite(factor * getattr(point.damping_curve, name))


def rows(results: Results) -> list[tuple[str, ...]]:
    """The table, its heads first: a row a speed."""
    if any(point.damper is not None for point in results.speeds):
        is_first = all(point.followed == 0 or not point.modes for point in results.speeds)
        named = {} if is_first else {"first Hz": f"{verdict.followed_mode(results)} Hz"}
        columns = [each for each in COLUMNS if not each.key.endswith("_error")]
        table = [("rpm", *(named.get(each.head, each.head) for each in columns))]
        for point in results.speeds:
            known = columns if point.damper is not None else columns[:1]
            table.append((amount(point.rpm), *(each.cell(results, point) for each in known)))
        return table
    count = min(max((len(point.modes) for point in results.speeds), default=0), _MODES_AT_MOST)
    heads = ("rpm", "load g", *(f"mode {i + 1} Hz" for i in range(count)))
    modes = ([f"{mode.frequency_hz:.2f} {mode.family:<5}" for mode in p.modes[:count]] for p in results.speeds)
    return [heads, *((amount(p.rpm), amount(p.load_g), *cells) for p, cells in zip(results.speeds, modes, strict=True))]


def of_modes(model: ModalModel, file: Path | None) -> str:
    """Frequencies and families at each speed of the modes that a neutral file has."""
    table: list[tuple[str, ...]] = [("rpm", "mode", "Hz", "family")]
    for modes in model.speeds:
        table += [
            (fixed(rounded_rpm(modes.omega)) if k == 0 else "", str(k + 1), amount(float(hz)), name)
            for k, (hz, name) in enumerate(zip(modes.frequencies_hz, families(model, modes), strict=True))
        ]
    lines = [f"Real modes, without Coriolis forces, at {len(model.points)} nodes", "", *aligned(table)]
    return "\n".join([*lines, *(["", f'name it in a scene: [structure] modes = "{file}"'] if file is not None else [])])


class Shown(Results):
    """Results that show themselves in brief."""

    def __repr__(self) -> str:
        """Title, speeds, what was found, and how far the frequencies can be trusted, a line each."""
        answer = verdict.answer(self)
        accuracy = remarks.sentence(self)
        more = () if self.reductions else answer.sentences[:1]  # a crossing's next sentences are on single levels
        lines = [_head(self), " ".join((f"{answer.verdict}.", *more)), *([] if accuracy is None else [accuracy])]
        return plain("\n".join(lines))

    def _repr_html_(self) -> str:
        """The same with a table; everything that comes from a scene is escaped."""
        answer, accuracy = verdict.answer(self), remarks.sentence(self)
        heads, *lines = rows(self)
        return from_template(
            "notebook.html.j2",
            head=_head(self),
            answer=answer,
            sentences=(*answer.sentences, *answer.besides([accuracy or ""])),
            heads=heads,
            lines=lines,
            legend=remarks.legend(self),
        )

    @property
    def plot(self) -> Plots:
        """The pictures of the run: `results.plot.campbell()` and so on."""
        from workflows.report.figures import Plots

        return Plots(self)


def shown(results: Results) -> Shown:
    """The same results, which show themselves."""
    return copy_fields(Shown, results)


def _head(results: Results) -> str:
    return f"{one_line(results.scene.title)}: {revolutions(results.scene.rotor.speeds)}"


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
