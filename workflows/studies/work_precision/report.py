"""What accuracy costs, as files and as text: JSON, CSV, plots, and one page for a person."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from workflows import formatting
from workflows.io.files import as_table
from workflows.report import plots
from workflows.report.templates import from_template, said, texts
from workflows.studies.work_precision.timing import ConvergenceStudy, Setting, WorkPrecision, entry, machine

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAME = "accuracy"


def document(result: WorkPrecision) -> dict[str, Any]:
    """The machine-readable result."""
    return {
        "title": result.title,
        "asked": result.targets,
        "machine": machine(),
        "noise": texts("accuracy")["policy"],
        "ladders": [asdict(study) | {"rows": list(map(entry, study.rows))} for study in result.studies],
        "chosen": {stage: asdict(chosen) for stage, chosen in result.chosen.items()},
        "left_out": result.left_out,
    }


_SMALLEST = 1e-16
"""An error of nothing is drawn here, on the axis' edge."""


@plots.style()
def study_plot(study: ConvergenceStudy, name: str, target: float) -> str:
    """Time against error, both on log axes, a line for each method; the accuracy asked for dashed."""
    figure, (axes,) = plots.canvas(3.4)
    _work_precision(axes, study, target)
    plots.legend(figure, axes, ncols=1)
    return plots.svg(figure, name, f"Time against error: {study.quantity}")


@plots.style()
def overview(studies: list[ConvergenceStudy], target: float) -> str:
    """Some studies side by side."""
    figure, panels = plots.canvas(4.0, len(studies))
    for axes, study in zip(panels, studies, strict=True):
        _work_precision(axes, study, target)
        axes.set_title(study.stage)
        axes.legend(loc="upper left", bbox_to_anchor=(-0.05, -0.2), ncols=1, fontsize=6.5)
    return plots.svg(figure, "overview", "Time against error")


def _work_precision(axes: Axes, study: ConvergenceStudy, target: float) -> None:
    methods = list(dict.fromkeys(row.method for row in study.rows))
    for number, method in enumerate(methods):
        rows = [row for row in study.rows if row.method == method and row.time_s is not None and row.error is not None]
        if rows:
            errors = [max(row.error or 0.0, _SMALLEST) for row in rows]
            times = [row.time_s or 0.0 for row in rows]
            colour, marker = (each[number % len(each)] for each in (plots.CATEGORIES, plots.MARKERS))
            style = "-" if number < len(plots.CATEGORIES) else (0, (3, 2))
            axes.plot(errors, times, color=colour, marker=marker, ls=style, lw=1.0, label=method)
    axes.axvline(target, color=plots.MUTED, lw=0.8, ls=plots.DASHED)
    axes.set(xscale="log", yscale="log", xlabel="relative error", ylabel="time, s")
    axes.invert_xaxis()


def files(work_precision: WorkPrecision) -> dict[str, str | bytes]:
    """The files beside `accuracy.json`."""
    target = work_precision.targets["frequency"]
    figures = [
        study_plot(study, f"ladder{number}", _target_of(work_precision, study))
        for number, study in enumerate(work_precision.studies)
    ]
    first = [study for study in work_precision.studies if study.stage in ("plate", "damper")]
    columns = ("stage", "method", "setting", "unknowns", "time_s", "error", "uncertainty", "failed")
    rows = [{"stage": study.stage, **vars(row)} for study in work_precision.studies for row in study.rows]
    page = from_template(
        "accuracy.html.j2",
        milliseconds=_milliseconds,
        result=work_precision,
        figures=figures,
        policy=texts("accuracy")["policy"],
        verdict=verdict(work_precision),
        not_drawn=not_drawn,
    )
    return {
        "accuracy.svg": plots.standalone(overview(first, target)),
        "accuracy.csv": as_table(columns, rows),
        "report.html": page,
    }


def text(work_precision: WorkPrecision) -> str:
    """The studies as a table."""
    lines = []
    for study in work_precision.studies:
        lines += [f"{study.stage}: {study.quantity}", f"  against {study.reference}", ""]
        wide = max(22, *(len(row.setting) for row in study.rows))
        lines.append(f"  {'method':<30} {'setting':<{wide}} {'unknowns':>9} {'time, ms':>10} {'error':>9}")
        for row in study.rows:
            unknowns = formatting.DASH if row.unknowns is None else str(row.unknowns)
            figures = f"{_milliseconds(row):>10} {formatting.significant(row.error, 2):>9}"
            figures = figures if row.failed is None else f" {row.failed}"
            lines.append(f"  {row.method:<30} {row.setting:<{wide}} {unknowns:>9} {figures}")
        lines.append("")
    lines.append("chosen by the scene's accuracy")
    for stage, chosen in work_precision.chosen.items():
        estimate, error = (formatting.significant(value, 2) for value in (chosen.error_estimate, chosen.error))
        lines.append(f"  {stage}: {chosen.method}, {chosen.setting}; estimate {estimate}, true {error}")
    return "\n".join([*lines, *([work_precision.left_out] if work_precision.left_out else [])])


def verdict(work_precision: WorkPrecision) -> list[str]:
    """The cheapest method for the accuracy asked for, in sentences, and what speaks against it."""
    return [
        sentence
        for study in work_precision.studies
        if len({row.method for row in study.rows}) > 1
        for sentence in said("accuracy/verdict", **_judged(study, _target_of(work_precision, study)))
    ]


def _judged(study: ConvergenceStudy, target: float) -> dict[str, Any]:
    """The cheapest row that meets an accuracy, the next of another method, and whether the reference can tell."""
    timed = [(row.time_s, row.error, row) for row in study.rows if row.time_s is not None and row.error is not None]
    timed.sort(key=lambda item: item[0])
    good = [row for _, error, row in timed if error <= target]
    best = good[0] if good else None
    undecided = []
    for _, error, row in timed:
        if row.uncertainty is not None and abs(error - target) < row.uncertainty:
            undecided.append(row.uncertainty)
        if row is best:
            break
    return {
        "stage": study.stage,
        "target": target,
        "best": best,
        "second": next((row for row in good if best is not None and row.method != best.method), None),
        "uncertainty": max(undecided, default=None),
    }


def not_drawn(study: ConvergenceStudy) -> list[str]:
    """The rows that have no place in the plots, and why, in a line for each method."""
    reasons: dict[str, list[str]] = {}
    for row in study.rows:
        if row.failed is not None:
            reasons.setdefault(row.method, []).append(f"{row.setting} ({row.failed})")
    return [f"{method}: {', '.join(settings)}" for method, settings in reasons.items()]


def _target_of(work_precision: WorkPrecision, study: ConvergenceStudy) -> float:
    return work_precision.targets["damping" if study.stage == "damper" or "damping" in study.stage else "frequency"]


def _milliseconds(row: Setting) -> str:
    return formatting.significant(1e3 * (row.time_s or 0.0), 3)
