"""`spindamp effects`: each effect switched against the rest, what that changes, and what it takes."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from workflows import effects as rules
from workflows import pipeline, plate
from workflows.costs.ladder import machine
from workflows.costs.timing import POLICY, timed
from workflows.effects import Effect
from workflows.errors import SpindampError
from workflows.records import SpeedPoint
from workflows.scene_file import SceneFile
from workflows.stages import Stages

OF_THE_PLATE = ("stress_stiffening", "spin_softening", "coriolis", "large_deflection", "rotary_inertia")


@dataclass(frozen=True)
class Switched:
    """One effect against the rest.

    Attributes:
        effect, called_for, why: its name, whether the scene calls for it, and why (not).
        on: whether it is simulated, as the scene and the rules have it.
        changes: what it does to each headline quantity, (with - without) / without; the largest over the speeds.
        time_s: what it adds to a run [s], median; time_share: that over the run with it.
        failed: why there is no change to show.
    """

    effect: str
    called_for: bool
    why: str
    on: bool
    changes: dict[str, float] = field(default_factory=dict)
    time_s: float | None = None
    time_share: float | None = None
    failed: str | None = None


@dataclass(frozen=True, eq=False)
class Switches:
    """All effects of a scene."""

    title: str
    rows: tuple[Switched, ...]

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        rows = [{k: v for k, v in asdict(row).items() if k != "failed" or v is not None} for row in self.rows]
        return {"schema_version": 1, "title": self.title, "machine": machine(), "noise": POLICY, "rows": rows}


@dataclass(frozen=True, eq=False)
class _Run:
    """Headline quantities of a run, a value for each speed, and its time [s]."""

    quantities: dict[str, list[float]]
    seconds: float


def switching(source: SceneFile, stages: Stages | None = None) -> Switches:
    """Run a scene with each effect the other way, on one mesh.

    Raises:
        BadInput, NoAnswer: see :func:`workflows.plate.solve`.
    """
    stages = stages or Stages()
    decided = rules.resolve(source.scene, source.name)
    has_plate = source.scene.plate is not None
    size = plate.discretise(source, decided, Stages(visible=False)).choice.size if has_plate else None
    with stages("effects", len(decided) + 1) as step:
        base = _run(source, decided, {}, size)
        step.advance("as the scene has it")
        rows = []
        for name in decided:
            rows.append(_switched(source, decided, name, base, size))
            step.advance(name)
    return Switches(source.scene.title, tuple(rows))


def _switched(source: SceneFile, decided: dict[str, Effect], name: str, base: _Run, size: int | None) -> Switched:
    called_for, why = rules.RULES[name](source.scene)
    on = decided[name].on
    row = Switched(name, called_for, why, on)
    absent = source.scene.plate if name in OF_THE_PLATE else source.scene.damper
    if absent is None:
        return row
    try:
        other = _run(source, decided, {name: not on}, size)
    except (SpindampError, ValueError) as error:
        return Switched(name, called_for, why, on, failed=f"{'off' if on else 'on'}: {error}")
    with_it, without = (base, other) if on else (other, base)
    changes = {
        quantity: _largest(with_it.quantities[quantity], without.quantities[quantity])
        for quantity in base.quantities
        if quantity in other.quantities
    }
    extra = with_it.seconds - without.seconds
    return Switched(name, called_for, why, on, changes, extra, extra / with_it.seconds)


def _run(source: SceneFile, decided: dict[str, Effect], changed: dict[str, bool], size: int | None) -> _Run:
    """The scene with all effects as decided but those changed, on a mesh that is given."""
    effects = source.scene.effects.model_copy(update={name: effect.on for name, effect in decided.items()} | changed)
    scene = source.changed(effects=effects)

    def work() -> tuple[SpeedPoint, ...]:
        quiet = Stages(visible=False)
        return pipeline.damped(pipeline.structure(scene, quiet, shapes=False, size=size), quiet).points

    found = timed(work)
    return _Run(_headlines(found.value), found.median)


def _headlines(points: tuple[SpeedPoint, ...]) -> dict[str, list[float]]:
    """Each quantity at every speed; NaN where it has no value."""
    quantities: dict[str, list[float]] = {}
    for number in range(min(len(point.modes) for point in points)):
        quantities[f"frequency_{number + 1}"] = [point.modes[number].frequency_hz for point in points]
    if all(point.damping is not None for point in points):
        for name in ("cutoff_g", "peak_sdc", "impacts"):
            values = [getattr(point.damping, name) for point in points]
            quantities[name] = [np.nan if value is None else float(value) for value in values]
        quantities["ball_share"] = [p.damping.energy.ball_share for p in points if p.damping is not None]
    return quantities


def _largest(with_it: list[float], without: list[float]) -> float:
    """The relative change that is largest in size over the speeds that both runs have; 0 where nothing is known."""
    pairs = zip(with_it, without, strict=False)
    changes = [(one - other) / other for one, other in pairs if np.isfinite([one, other]).all() and other != 0]
    return max(changes, key=abs, default=0.0)
