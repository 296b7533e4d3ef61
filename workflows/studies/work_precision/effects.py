"""`spindamp effects`: each effect switched against the rest, what that changes, and what it takes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from workflows import pipeline
from workflows.effects import selection
from workflows.effects.definition import Called, Effect
from workflows.effects.selection import EFFECTS
from workflows.errors import SpindampError
from workflows.formatting import whole
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.solve import structure
from workflows.solve.model_choice import choose_model
from workflows.solve.results import Mode, SpeedPoint
from workflows.studies.work_precision.timing import POLICY_OF_DIFFERENCES, compared, machine

_NAMED = 3
"""Speeds that are named one by one; of more, the range is given."""


@dataclass(frozen=True)
class Changes:
    """Relative changes (with - without) / without, the largest over the speeds, and what no number can say.

    Attributes:
        relative: by quantity; None where no speed has a value on both sides.
        remarks: quantities that are there on one side only, speeds at which the plate diverges on one side only.
    """

    relative: dict[str, float | None]
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class _Pair:
    """A quantity with an effect and without it, at one speed."""

    rpm: float
    with_it: float | None
    without: float | None

    @property
    def change(self) -> float | None:
        if self.with_it is None or self.without is None:
            return None
        if self.with_it == self.without:
            return 0.0
        return None if self.without == 0 else (self.with_it - self.without) / self.without


def changes(own: tuple[SpeedPoint, ...], other: tuple[SpeedPoint, ...], *, own_has_it: bool) -> Changes:
    """What an effect changes, between a scene's own run and the other; frequencies are numbered as in the own run."""
    mine, others = ({point.rpm: point for point in points} for points in (own, other))
    pairs: dict[str, list[_Pair]] = {}
    for rpm in mine:
        if rpm not in others:
            continue
        for name, (here, there) in _values(mine[rpm], others[rpm]).items():
            pair = _Pair(rpm, here, there) if own_has_it else _Pair(rpm, there, here)
            pairs.setdefault(name, []).append(pair)
    relative = {name: _largest(found) for name, found in pairs.items()}
    with_it, without = (mine, others) if own_has_it else (others, mine)
    remarks = [_diverging("with", set(without) - set(with_it)), _diverging("without", set(with_it) - set(without))]
    for name, found in pairs.items():
        remarks += _one_sided(name, found)
    return Changes(relative, tuple(remark for remark in remarks if remark))


def _values(own: SpeedPoint, other: SpeedPoint) -> dict[str, tuple[float | None, float | None]]:
    """Headline quantities of two runs at one speed."""
    partners = _partners(own.modes, other.modes)
    found: dict[str, tuple[float | None, float | None]] = {}
    for number, (mode, partner) in enumerate(zip(own.modes, partners, strict=True), 1):
        found[f"frequency_{number}"] = mode.frequency_hz, None if partner is None else partner.frequency_hz
    if own.damper is not None and other.damper is not None:
        for name in ("cutoff_g", "peak_sdc", "impacts"):
            found[name] = getattr(own.damper, name), getattr(other.damper, name)
        figures = [point.level or point.working for point in (own, other)]
        here, there = (None if known is None or not known.peak > 0 else known.peak for known in figures)
        found["ball_damping_ratio"] = here, there
        found["ball_share"] = own.damper.energy.ball_share, other.damper.energy.ball_share
    return found


def _partners(own: tuple[Mode, ...], other: tuple[Mode, ...]) -> list[Mode | None]:
    """For each mode the other run's of the same family and the same number within it, if that was solved for."""
    families: dict[str, list[Mode]] = defaultdict(list)
    for mode in other:
        families[mode.family].append(mode)
    waiting = {family: iter(modes) for family, modes in families.items()}
    return [next(waiting.get(mode.family, iter(())), None) for mode in own]


def _largest(pairs: list[_Pair]) -> float | None:
    known = [pair.change for pair in pairs if pair.change is not None]
    return max(known, key=abs, default=None)


def _one_sided(name: str, pairs: list[_Pair]) -> list[str]:
    """Where a quantity is there on one side only, so that its change has no number."""
    odd = [pair for pair in pairs if pair.change is None and (pair.with_it, pair.without) != (None, None)]
    only_with = [pair.rpm for pair in odd if not pair.without]
    only_without = [pair.rpm for pair in odd if pair.without]
    if name.startswith("frequency"):
        return [f"{name} has no partner of its family {_at(only_with + only_without)}"] if odd else []
    return [
        f"{name} is there only {side} it, {_at(speeds)}"
        for side, speeds in (("with", only_with), ("without", only_without))
        if speeds
    ]


def _diverging(side: str, speeds: Iterable[float]) -> str:
    found = list(speeds)
    return f"{side} it the plate diverges {_at(found)}" if found else ""


def _at(speeds: list[float]) -> str:
    ordered = sorted(speeds)
    if len(ordered) <= _NAMED:
        return f"at {', '.join(f'{whole(rpm)}' for rpm in ordered)} rpm"
    return f"at {len(ordered)} speeds from {whole(ordered[0])} to {whole(ordered[-1])} rpm"


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
        BadInput, NoAnswer: see :class:`workflows.solve.structure.StructureSolver`.
    """
    stages = stages or Stages()
    quiet = Stages(visible=False)
    settled = choose_model(source, quiet)
    decided, called = settled.effects, selection.called_for(source.scene, settled.form)
    size = None if settled.form is None else structure.discretise(source, settled, quiet).choice.size
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
    for part, parent in ((part, kind.part_of) for part, kind in EFFECTS.items() if kind.part_of):
        if name == parent and decided[parent].on and decided[part].on:
            switches[part] = False
            together.append(f"together with {part}, which needs it")
        if name == part and not decided[part].on and not decided[parent].on:
            switches[parent] = True
            together.append(f"together with {parent}, which it needs")
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
