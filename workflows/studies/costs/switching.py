"""`spindamp effects`: each effect switched against the rest, what that changes, and what it takes."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from typing import Any

from workflows import pipeline
from workflows.effects import rules
from workflows.effects.effect import Effect
from workflows.effects.left_out import Called
from workflows.effects.table import EFFECTS
from workflows.errors import SpindampError
from workflows.progress import Stages
from workflows.scene.source import SceneFile
from workflows.solve import plate_stage as plate
from workflows.solve.decided import decide
from workflows.solve.records import SpeedPoint
from workflows.studies.costs.changes import changes
from workflows.studies.costs.ladder import machine
from workflows.studies.costs.timing import POLICY_OF_DIFFERENCES, compared


@dataclass(frozen=True)
class Switched:
    """One effect against the rest.

    Attributes:
        effect, called_for, why: its name, whether the scene calls for it, and why (not).
        on: whether it is simulated, as the scene and the rules have it.
        changes: what it does to each headline quantity, (with - without) / without; the largest over the speeds, None
            where no speed has a value both with and without it.
        remarks: what the changes do not say: divergence, quantities that appear or vanish, effects switched together.
        time_s: what it adds to a run [s], median; time_spread_s: least and most; time_share: over the run with it.
        failed: why there is no change to show.
    """

    effect: str
    called_for: bool
    why: str
    on: bool
    changes: dict[str, float | None] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    time_s: float | None = None
    time_spread_s: tuple[float, float] | None = None
    time_share: float | None = None
    failed: str | None = None

    @property
    def largest(self) -> tuple[str, float] | None:
        """The quantity that changes most, and by how much."""
        known = [(name, change) for name, change in self.changes.items() if change is not None]
        return max(known, key=lambda item: abs(item[1]), default=None)

    @property
    def within_noise(self) -> bool | None:
        """Whether runs do not agree on the time's sign; None without a time."""
        if self.time_s is None or self.time_spread_s is None:
            return None
        low, high = self.time_spread_s
        return low <= 0.0 <= high


@dataclass(frozen=True, eq=False)
class Switches:
    """All effects of a scene, and the relative error in frequency that the scene asks for."""

    title: str
    asked: float
    rows: tuple[Switched, ...]

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        return {
            "schema_version": 1,
            "title": self.title,
            "asked": self.asked,
            "machine": machine(),
            "noise": POLICY_OF_DIFFERENCES,
            "rows": [_entry(row) for row in self.rows],
        }


def switching(source: SceneFile, stages: Stages | None = None) -> Switches:
    """Run a scene with each effect the other way, on one mesh.

    Raises:
        BadInput, NoAnswer: see :func:`workflows.solve.plate_stage.solve`.
    """
    stages = stages or Stages()
    quiet = Stages(visible=False)
    settled = decide(source, quiet)
    decided, called = settled.effects, rules.called_for(source.scene, settled.form)
    size = None if settled.form is None else plate.discretise(source, settled, quiet).choice.size
    with stages("effects", len(decided) + 1) as step:
        own = _run(source, decided, {}, size)
        step.advance("as the scene has it")
        rows = []
        for name in decided:
            rows.append(_switched(source, decided, called, name, own, size))
            step.advance(name)
    return Switches(source.scene.title, source.scene.accuracy.frequency, tuple(rows))


def _switched(
    source: SceneFile,
    decided: dict[str, Effect],
    called: dict[str, Called],
    name: str,
    own: tuple[SpeedPoint, ...],
    size: int | None,
) -> Switched:
    called_for, why, _ = called[name]
    on = decided[name].on
    row = Switched(name, called_for, why, on)
    belongs_to = EFFECTS[name].of
    if getattr(source.scene, belongs_to) is None:
        return replace(row, failed=f"no {belongs_to} in the scene")
    switches, together = _switches(name, decided)
    try:
        found = compared(lambda: _run(source, decided, switches, size), lambda: _run(source, decided, {}, size))
    except (SpindampError, ValueError) as error:
        reason = str(error).removeprefix(f"{source.name}: ")
        return replace(row, remarks=together, failed=f"{'off' if on else 'on'}: {reason}")
    changed = changes(own, found.value, own_has_it=on)
    extra, ends = (-found.extra, (-found.high, -found.low)) if on else (found.extra, (found.low, found.high))
    return replace(
        row,
        changes=changed.relative,
        remarks=together + changed.remarks,
        time_s=extra,
        time_spread_s=ends,
        time_share=extra / (found.others if on else found.seconds),
    )


def _switches(name: str, decided: dict[str, Effect]) -> tuple[dict[str, bool], tuple[str, ...]]:
    """An effect the other way, with those that must go with it, and these in words."""
    switches, together = {name: not decided[name].on}, []
    for part, whole in ((part, kind.part_of) for part, kind in EFFECTS.items() if kind.part_of):
        if name == whole and decided[whole].on and decided[part].on:
            switches[part] = False
            together.append(f"together with {part}, which needs it")
        if name == part and not decided[part].on and not decided[whole].on:
            switches[whole] = True
            together.append(f"together with {whole}, which it needs")
    return switches, tuple(together)


def _run(
    source: SceneFile, decided: dict[str, Effect], switches: dict[str, bool], size: int | None
) -> tuple[SpeedPoint, ...]:
    """The scene with all effects as decided but those switched, on a mesh that is given."""
    effects = source.scene.effects.model_copy(update={name: effect.on for name, effect in decided.items()} | switches)
    scene, quiet = source.changed(effects=effects), Stages(visible=False)
    return pipeline.damped(pipeline.structure(scene, quiet, shapes=False, size=size), quiet).points


def _entry(row: Switched) -> dict[str, Any]:
    entry = asdict(row) | {"within_noise": row.within_noise}
    if row.failed is None:
        del entry["failed"]
    return entry
