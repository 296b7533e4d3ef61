"""Ladder of the whole pipeline: the scene for one accuracy after the other, against the finest."""

from __future__ import annotations

from dataclasses import dataclass, replace

from workflows import pipeline
from workflows.progress import Stages, Step
from workflows.scene.rotor import Accuracy
from workflows.scene.source import SceneFile
from workflows.solve import records
from workflows.solve.decided import decide
from workflows.solve.records import Results
from workflows.studies.costs.ladder import Ladder, Picked, Rung, measure
from workflows.wording import significant, whole

ASKED = (1e-1, 1e-2, 1e-3, 1e-4)
FINEST = 1e-5


@dataclass(frozen=True)
class _Quantity:
    """A headline number of a run, at the speed that the report shows."""

    name: str
    at: int

    def __call__(self, results: Results) -> float | None:
        point = results.speeds[self.at]
        if self.name == "first frequency":
            return point.reduced.f2_hz if point.reduced is not None else point.modes[0].frequency_hz
        if point.damping is None:
            return None
        return point.damping.cutoff_g if self.name == "cut-off" else point.damping.peak_sdc


QUANTITIES = ("first frequency", "cut-off", "peak specific damping capacity")


def ladders(source: SceneFile, step: Step) -> tuple[list[Ladder], dict[str, Picked]]:
    """A ladder for each headline number that the scene has; none without a plate, where there is nothing to choose."""
    if source.scene.plate is None:
        return [], {}
    known = decide(source, Stages(visible=False)).theory
    theory = None if known is None else known.name
    step.advance("reference")
    finest = pipeline.run(_asking(source, FINEST, theory), Stages(visible=False))
    shown = records.shown(finest.speeds)
    runs: dict[float, tuple[Rung, Results | None]] = {}
    for asked in ASKED:
        step.advance(f"accuracy {asked:g}")
        runs[asked] = _run(_asking(source, asked, theory), asked)
    own = pipeline.run(_asking(source, None, theory), Stages(visible=False))
    found, chosen = [], {}
    for quantity in (_Quantity(name, shown) for name in QUANTITIES):
        if not quantity(finest):
            continue
        rows = [_judged(row, results, quantity, finest) for row, results in runs.values()]
        rpm = finest.speeds[shown].rpm
        found.append(
            Ladder(
                f"whole pipeline: {quantity.name}",
                f"relative error of the {quantity.name} at {whole(rpm)} rpm",
                f"the same scene and theory with an accuracy of {FINEST:g}{_trust(finest, shown)}",
                tuple(rows),
            )
        )
        chosen[f"pipeline: {quantity.name}"] = _chosen(own, quantity, finest)
    return found, chosen


def _run(source: SceneFile, asked: float) -> tuple[Rung, Results | None]:
    kept: list[Results] = []

    def judge(results: Results) -> tuple[int | None, float]:
        kept.append(results)
        return None, 0.0

    row = measure("pipeline", f"accuracy {asked:g}", lambda: pipeline.run(source, Stages(visible=False)), judge)
    return row, kept[0] if kept else None


def _trust(finest: Results, shown: int) -> str:
    """What the reference was solved on, and how far its first frequency can be trusted."""
    modes = finest.speeds[shown].modes
    if finest.diagram is None or not modes:
        return ""
    estimate = modes[0].error_estimate
    good = "" if estimate is None else f", its first frequency good to about {significant(estimate, 1)}"
    return f" ({finest.diagram.mesh}{good})"


def _judged(row: Rung, results: Results | None, quantity: _Quantity, finest: Results) -> Rung:
    if results is None:
        return row
    if quantity(results) is None:
        return Rung(row.method, row.setting, failed=f"no {quantity.name} came out")
    row = replace(row, setting=_setting(row, results), unknowns=None, error=_error(results, finest, quantity))
    return row if row.error is not None else replace(row, failed="the reference's own mesh")


def _error(results: Results, finest: Results, quantity: _Quantity) -> float | None:
    """Relative error against the finest run; None on its own mesh, whose error it shares."""
    value, reference = quantity(results), quantity(finest)
    if value is None or reference is None or _same_mesh(results, finest):
        return None
    return abs(value / reference - 1.0)


def _same_mesh(results: Results, finest: Results) -> bool:
    if results.diagram is None or finest.diagram is None:
        return False
    return results.diagram.mesh == finest.diagram.mesh


def _setting(row: Rung, results: Results) -> str:
    return row.setting if results.diagram is None else f"{row.setting}: {results.diagram.mesh}"


def _chosen(results: Results, quantity: _Quantity, finest: Results) -> Picked:
    """What the scene's own accuracy chose, and its error."""
    estimate = None
    if quantity.name == "first frequency" and results.speeds[quantity.at].modes:
        estimate = results.speeds[quantity.at].modes[0].error_estimate
    setting = "" if results.diagram is None else results.diagram.mesh
    return Picked("pipeline", setting, estimate, _error(results, finest, quantity))


def _asking(source: SceneFile, accuracy: float | None, theory: str | None) -> SceneFile:
    """The scene with another accuracy, its theory held: the error of a theory is not one of accuracy."""
    changed = source
    if accuracy is not None:
        changed = changed.changed(accuracy=Accuracy(frequency=accuracy, damping=accuracy))
    if theory is not None and source.scene.plate is not None:
        changed = changed.changed(plate=source.scene.plate.model_copy(update={"theory": theory}))
    return changed
