"""Runs side by side: where their scenes differ, verdicts and figures at each speed; as text, JSON, CSV, chart, page."""

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from workflows.errors import BadInput
from workflows.formatting import DASH, aligned, readable, whole
from workflows.io import provenance, serialise
from workflows.io.files import StudyResult, as_table, campbell
from workflows.progress import Stages
from workflows.report import plots, remarks, verdict
from workflows.report.templates import from_template
from workflows.report.text import COLUMNS, wrapped
from workflows.report.text import run as solved
from workflows.scene.load import SceneFile, SceneLike, as_scene_file, keys
from workflows.solve.results import Results, SpeedPoint
from workflows.studies.sweep import plan


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(StudyResult):
    """Runs side by side.

    Attributes:
        names: of each, all different.
        results: of each.
    """

    REPORT = __name__
    names: tuple[str, ...]
    results: tuple[Results, ...]

    @property
    def differences(self) -> dict[str, tuple[Any, ...]]:
        """Keys of the resolved scenes that are not the same in all, with the value in each, None where it has none."""
        scenes = [_keys(each) for each in self.results]
        every = dict.fromkeys(key for scene in scenes for key in scene)
        values = {key: tuple(scene.get(key) for scene in scenes) for key in every if key != "title"}
        if len({*values.get(_MATERIAL, ())} - {None}) == 1:  # where it is none, the material is its density
            del values[_MATERIAL]
        return {key: each for key, each in values.items() if any(value != each[0] for value in each[1:])}

    @property
    def title(self) -> str:
        """The titles of the scenes, each once."""
        return " · ".join(dict.fromkeys(each.scene.title for each in self.results))

    @property
    def points(self) -> list[tuple[str, Results, SpeedPoint]]:
        """Every speed of each run, after its name and results, in the order of the speeds."""
        runs = zip(self.names, self.results, strict=True)
        return sorted(((name, of, point) for name, of in runs for point in of.speeds), key=lambda each: each[2].rpm)


def compare(runs: Sequence[SceneLike | Results], stages: Stages | None = None) -> Comparison:
    """Put runs side by side.

    Args:
        runs: two or more: folders that `spindamp run` has written, scenes, which are run, or results.
        stages: the clock of what is run.

    Raises:
        BadInput: fewer than two, or one that is neither a folder of a run nor a scene.
        NoAnswer: a scene has none.
    """
    if len(runs) < 2:
        raise BadInput("expected at least two runs: folders of results, or scenes", key="compare")
    read = [_read(each) for each in runs]  # a mistake in a later one is found before the first is run
    results = tuple(each if isinstance(each, Results) else solved(each, stages) for each in read)
    titles = [_title(*both) for both in zip(runs, results, strict=True)]
    names = list[str]()
    for title in titles:
        numbered = (f"{title} ({k})" for k in itertools.count(1))
        names.append(title if titles.count(title) == 1 else next(n for n in numbered if n not in {*names, *titles}))
    return Comparison(tuple(names), results)


def _read(run: SceneLike | Results) -> SceneFile | Results:
    """Results, those of a folder too, or the scene that is to be run."""
    if isinstance(run, str | PathLike) and Path(run).is_dir():
        return serialise.read(run)
    return run if isinstance(run, Results) else as_scene_file(run)


def _title(run: SceneLike | Results, results: Results) -> str:
    """The name of a folder or file; of anything else the title."""
    file = run.name if isinstance(run, SceneFile) else run
    return Path(file).stem if isinstance(file, str | PathLike) else results.scene.title


_MATERIAL, _DENSITY = "damper.ball_material", "damper.ball_density"


def _keys(results: Results) -> dict[str, Any]:
    """The resolved scene by dotted names, the ball's density among them, which follows from a material or a mass."""
    values = dict(_flat(provenance.resolved_scene(results.scene, results.effects, results.theory)))
    damper = results.scene.damper
    if damper is None or damper.balls is None:
        return values
    return values | {_DENSITY: damper.ball_density or float(f"{damper.density(damper.balls):.3g}")}


def _flat(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Keys of nested tables by their dotted names."""
    entries = []
    for key, value in table.items():
        entries += _flat(value, f"{prefix}{key}.") if isinstance(value, Mapping) else [(prefix + key, value)]
    return entries


_LEFT_OUT = ("cutoff_ratio", "sdc", "hits")
"""Of the columns of a run's table; the others are put side by side at each speed."""

_COLUMNS = [column for column in COLUMNS if column.key not in _LEFT_OUT]
_ERROR_MEANS = "± %: estimated relative error of the figure to its left."
_HEADS = ("rpm", "run", *(column.head for column in _COLUMNS), "useful")


def rows(comparison: Comparison) -> list[dict[str, Any]]:
    """A row for each speed of each run, with what its marks stand for; None where a run has no figure."""
    table = []
    for name, results, point in comparison.points:
        row = {"rpm": point.rpm, "run": name, "verdict": point.verdict and str(point.verdict.grade)}
        row |= {each.key: each.value(results, point) for each in _COLUMNS}
        mark = remarks.mark(results, point)
        row |= {"cutoff_at_rest": bool(remarks.cutoff_mark(results, point)), "no_verdict": mark == remarks.NO_VERDICT}
        table.append(row | {"beyond_endured": mark == remarks.BEYOND})
    return table


def headline(results: Results) -> str:
    """The verdict of a run, with all that it says of engine orders, as in its report."""
    found = verdict.answer(results)
    return " ".join([f"{found.verdict}.", *found.sentences[: found.leading]])


def text(comparison: Comparison) -> str:
    """What a person reads on the terminal."""
    lines = [line for run in _runs(comparison) for line in (*wrapped(f"{run['name']}: {run['headline']}"), "")]
    differences = [(key, *values) for key, values in _differences(comparison)]
    lines += aligned([("scene", *comparison.names), *differences]) if differences else ["The scenes are the same."]
    legend = [part for line in _legend(comparison) for part in wrapped(line)]
    return "\n".join([*lines, "", *aligned([_HEADS, *_cells(comparison)]), *legend])


def _legend(comparison: Comparison) -> list[str]:
    """What the marks in the table stand for; what it leaves open of a run, after the name of that."""
    runs = zip(comparison.names, comparison.results, strict=True)
    lines = [(name, line) for name, results in runs for line in remarks.legend(results)]
    lines.sort(key=lambda each: each[1][0] not in remarks.MARKS)
    marks = [line if line[0] in remarks.MARKS else f"{name}: {line}" for name, line in lines]
    return list(dict.fromkeys([_ERROR_MEANS, *marks]))


def _cells(comparison: Comparison) -> list[tuple[str, ...]]:
    """The same rows as a person reads them."""
    table = []
    for name, results, point in comparison.points:
        cells = (each.cell(results, point) for each in _COLUMNS)
        grade = DASH if point.verdict is None else str(point.verdict.grade)
        table.append((whole(point.rpm), name, *cells, grade))
    return table


_ITEMS = 6
"""Of a list that are shown; of a longer one, the first and the last."""


def _differences(comparison: Comparison) -> list[tuple[str, list[str]]]:
    """Keys of the scenes that are not the same in all, with their units, and the value in each."""
    table = []
    for key, values in comparison.differences.items():
        factor, unit = readable(plan.Key(key, key).unit if key in keys() else "")
        table.append((f"{key}, {unit}" if unit else key, [_value(value, factor) for value in values]))
    return table


def _value(value: Any, factor: float) -> str:
    """A value of a scene's key in its unit."""
    if isinstance(value, list):
        items = [_value(item, factor) for item in value]
        return f"[{', '.join(items if len(items) <= _ITEMS else [items[0], '…', items[-1]])}]"
    if value is None or isinstance(value, bool):
        return DASH if value is None else json.dumps(value)
    return f"{factor * value + 0.0:.6g}" if isinstance(value, float) else str(value)


NAME = "compare"


def _runs(comparison: Comparison) -> list[dict[str, str]]:
    """What each run is called, and its verdict."""
    return [
        {"name": name, "title": results.scene.title, "headline": headline(results)}
        for name, results in zip(comparison.names, comparison.results, strict=True)
    ]


def document(comparison: Comparison) -> dict[str, Any]:
    """The machine-readable result."""
    return {
        "runs": _runs(comparison),
        "differences": {key: list(values) for key, values in comparison.differences.items()},
        "rows": rows(comparison),
    }


@plots.style()
def draw(comparison: Comparison) -> str:
    """First frequencies and damping ratios over speed, a colour for each run."""
    figure, (left, right) = plots.canvas(3.0, 2)
    for number, (name, results) in enumerate(zip(comparison.names, comparison.results, strict=True)):
        colour = plots.CATEGORIES[number % len(plots.CATEGORIES)]
        for track in campbell(results):
            left.plot(track.x, track.y, color=colour, lw=0.9)
        points = sorted((p for p in results.speeds if p.damping_curve is not None), key=lambda point: point.rpm)
        peaks = [100 * p.damping_curve.peak or math.nan for p in points if p.damping_curve is not None]
        rpm, marked = [p.rpm for p in points], [bool(remarks.mark(results, p)) for p in points]
        look: dict[str, Any] = {"color": colour, "ms": 3.5}
        right.plot(rpm, peaks, "o-", label=name, markevery=[not each for each in marked], **look)
        right.plot(rpm, peaks, "o", mfc="none", markevery=marked, **look)
    plots.air(right)
    right.set(xlabel="rotation speed, rpm", title="largest damping ratio by the ball, %", yscale="log")
    left.set(xlabel="rotation speed, rpm", title="natural frequencies, Hz", ylim=(0, None))
    plots.legend(figure, right)
    return plots.svg(figure, "compare", "Natural frequencies and damping ratios of the runs over speed")


def files(comparison: Comparison) -> dict[str, str | bytes]:
    """The files beside `compare.json`."""
    figure, table = draw(comparison), rows(comparison)
    page = from_template(
        "compare.html.j2",
        result=comparison,
        runs=_runs(comparison),
        differences=_differences(comparison),
        heads=_HEADS,
        rows=_cells(comparison),
        marks=_legend(comparison),
        hollow=any(remarks.mark(results, point) for _, results, point in comparison.points),
        figure=figure,
    )
    return {
        "compare.csv": as_table(dict.fromkeys(key for row in table for key in row), table),
        "compare.svg": plots.standalone(figure),
        "report.html": page,
    }
