"""`spindamp effects`: each effect switched against the rest, what that changes and takes; as files and as text."""

from __future__ import annotations

import math
import textwrap
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows import formatting, pipeline
from workflows.effects import selection
from workflows.effects.definition import Called, Effect
from workflows.effects.selection import EFFECTS
from workflows.errors import SpindampError
from workflows.formatting import whole
from workflows.io.files import as_json, as_table, write_study
from workflows.progress import Stages
from workflows.report import plots
from workflows.report.page import from_template
from workflows.scene.load import SceneFile
from workflows.solve import structure
from workflows.solve.model_choice import choose_model
from workflows.solve.results import Mode, SpeedPoint
from workflows.studies.work_precision.timing import POLICY_OF_DIFFERENCES, compared, machine

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
    relative = {name: _largest(both) for name, both in pairs.items()}
    with_it, without = (mine, others) if own_has_it else (others, mine)
    remarks = [_diverging("with", set(without) - set(with_it)), _diverging("without", set(with_it) - set(without))]
    for name, both in pairs.items():
        remarks += _one_sided(name, both)
    return Changes(relative, tuple(remark for remark in remarks if remark))


def _values(own: SpeedPoint, other: SpeedPoint) -> dict[str, tuple[float | None, float | None]]:
    """Headline quantities of two runs at one speed."""
    partners = _partners(own.modes, other.modes)
    values: dict[str, tuple[float | None, float | None]] = {}
    for number, (mode, partner) in enumerate(zip(own.modes, partners, strict=True), 1):
        values[f"frequency_{number}"] = mode.frequency_hz, None if partner is None else partner.frequency_hz
    if own.damper is not None and other.damper is not None:
        for name in ("cutoff_g", "peak_sdc", "impacts"):
            values[name] = getattr(own.damper, name), getattr(other.damper, name)
        figures = [point.level or point.damping_curve for point in (own, other)]
        here, there = (None if known is None or not known.peak > 0 else known.peak for known in figures)
        values["ball_damping_ratio"] = here, there
        values["ball_share"] = own.damper.energy.ball_share, other.damper.energy.ball_share
    return values


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
    listed = list(speeds)
    return f"{side} it the plate diverges {_at(listed)}" if listed else ""


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
    resolved, called = settled.effects, selection.called_for(source.scene, settled.form)
    size = None if settled.form is None else structure.discretise(source, settled, quiet).choice.size
    with stages("effects", len(resolved) + 1) as step:
        own = _run(source, resolved, {}, size)
        step.advance("as the scene has it")
        rows = []
        for name in resolved:
            rows.append(_switched(source, resolved, called, name, own, size))
            step.advance(name)
    return Switches(source.scene.title, source.scene.accuracy.frequency, tuple(rows))


def _switched(
    source: SceneFile,
    resolved: dict[str, Effect],
    called: dict[str, Called],
    name: str,
    own: tuple[SpeedPoint, ...],
    size: int | None,
) -> Switched:
    called_for, why, _ = called[name]
    on = resolved[name].on
    row = Switched(name, called_for, why, on)
    belongs_to = EFFECTS[name].of
    if belongs_to == "plate" and source.scene.blade is not None:
        return replace(row, failed="solid blades are solved one way alone")
    if getattr(source.scene, belongs_to) is None:
        return replace(row, failed=f"no {belongs_to} in the scene")
    switches, together = _switches(name, resolved)
    try:
        comparison = compared(lambda: _run(source, resolved, switches, size), lambda: _run(source, resolved, {}, size))
    except (SpindampError, ValueError) as error:
        reason = str(error).removeprefix(f"{source.name}: ")
        return replace(row, remarks=together, failed=f"{'off' if on else 'on'}: {reason}")
    changed = changes(own, comparison.value, own_has_it=on)
    extra, ends = (
        (-comparison.extra, (-comparison.high, -comparison.low))
        if on
        else (comparison.extra, (comparison.low, comparison.high))
    )
    return replace(
        row,
        changes=changed.relative,
        remarks=together + changed.remarks,
        time_s=extra,
        time_spread_s=ends,
        time_share=extra / (comparison.others if on else comparison.seconds),
    )


def _switches(name: str, resolved: dict[str, Effect]) -> tuple[dict[str, bool], tuple[str, ...]]:
    """An effect the other way, with those that must go with it, and these in words."""
    switches, together = {name: not resolved[name].on}, []
    for part, parent in ((part, kind.part_of) for part, kind in EFFECTS.items() if kind.part_of):
        if name == parent and resolved[parent].on and resolved[part].on:
            switches[part] = False
            together.append(f"together with {part}, which needs it")
        if name == part and not resolved[part].on and not resolved[parent].on:
            switches[parent] = True
            together.append(f"together with {parent}, which it needs")
    return switches, tuple(together)


def _run(
    source: SceneFile, resolved: dict[str, Effect], switches: dict[str, bool], size: int | None
) -> tuple[SpeedPoint, ...]:
    """The scene with all effects as decided but those switched, on a mesh that is given."""
    effects = source.scene.effects.model_copy(update={name: effect.on for name, effect in resolved.items()} | switches)
    scene, quiet = source.changed(effects=effects), Stages(visible=False)
    return pipeline.damped(pipeline.structure(scene, quiet, shapes=False, size=size), quiet).points


def _entry(row: Switched) -> dict[str, Any]:
    entry = asdict(row) | {"within_noise": row.within_noise}
    if row.failed is None:
        del entry["failed"]
    return entry


_ROUNDING = 1e-12
"""Changes below this are none at all."""


_UNSEEN = 1e-2
"""Changes below this part of the accuracy asked for are said to be none, so that the others can be told apart."""


_LONGEST = 50
"""Characters of a line of a reason beside an effect's name; the whole of a longer one is its title."""


_SAID: dict[str, Any] = {
    "textcoords": "offset points",
    "va": "center",
    "color": plots.MUTED,
    "fontsize": 7,
    "bbox": {"facecolor": plots.PAPER, "edgecolor": "none", "pad": 1.0},
}
"""How words instead of a bar are set."""


@plots.style()
def draw(switches: Switches) -> str:
    """The largest change that each effect makes to any quantity, and to which, beside the time it takes."""
    figure, (left, right) = plots.canvas(0.9 + 0.34 * len(switches.rows), 2)
    rows, least = switches.rows[::-1], _least(switches)
    for place, row in enumerate(rows):
        colour = plots.CATEGORIES[0] if row.on else plots.CATEGORIES[6]
        _change(left, place, row, colour, least)
        _time(right, place, row, colour)
    labels = [label for place, row in enumerate(rows) for label in _labels(place, row, least)]
    left.set_yticks([place for place, _ in labels], [label for _, label in labels])
    right.set_yticks(range(len(rows)), [_name(row) for row in rows])
    for axes in (left, right):
        axes.set_ylim(-0.6, len(rows) - 0.4)
        axes.tick_params(axis="y", length=0.0)
        axes.grid(visible=False, axis="y")
    sizes = [abs(row.largest[1]) for row in rows if row.largest is not None]
    left.set(
        xscale="log",
        xlim=(least, 10 * max(1.0, switches.asked, *sizes)),
        title="largest relative change of any quantity",
        xlabel=f"dashed: the scene's own accuracy, {switches.asked:g}",
    )
    left.axvline(switches.asked, color=plots.MUTED, lw=0.8, ls=plots.DASHED)
    right.set(title="share of the run's time with it, %")
    unseen = [(place, _unseen(row, least)) for place, row in enumerate(rows) if not _is_seen(row, least)]
    whole = [plots.Value(left, 1.1 * least, place, reason) for place, reason in unseen if len(reason) > _LONGEST]
    return plots.svg(figure, "effects", "What each effect changes and costs", whole)


def _least(switches: Switches) -> float:
    """Where the axis of changes begins."""
    return float(10.0 ** math.floor(math.log10(_UNSEEN * switches.asked)))


def _is_seen(row: Switched, least: float) -> bool:
    return row.largest is not None and abs(row.largest[1]) > least


def _change(axes: Axes, place: int, row: Switched, colour: str, least: float) -> None:
    if row.largest is not None and _is_seen(row, least):
        size = abs(row.largest[1])
        axes.plot([least, size], [place, place], color=colour, lw=1.2)
        axes.plot([size], [place], "o", color=colour, ms=4)
        return
    text = textwrap.fill(_unseen(row, least), _LONGEST, max_lines=2, placeholder=" …")
    axes.annotate(text, (0.0, place), (4.0, 0.0), xycoords=("axes fraction", "data"), **_SAID)


def _unseen(row: Switched, least: float) -> str:
    """Why an effect has no bar."""
    if row.failed is not None:
        return row.failed
    top = row.largest
    none = "none" if top is None or abs(top[1]) <= _ROUNDING else f"none above {formatting.significant(100 * least)} %"
    return "; ".join((f"{none} in numbers" if row.remarks else none, *row.remarks))


def _time(axes: Axes, place: int, row: Switched, colour: str) -> None:
    if row.within_noise:
        axes.annotate("within noise", (0.0, place), (4.0, 0.0), **_SAID)
    elif row.time_share is not None:
        axes.barh(place, 100 * row.time_share, color=colour, height=0.5)


def _labels(place: int, row: Switched, least: float) -> list[tuple[float, str]]:
    """An effect and what it changes most, at heights of their own: lines of one text come out ragged in a browser."""
    top = row.largest
    if top is None or not _is_seen(row, least):
        return [(place, _name(row))]
    changed = f"{top[0].replace('_', ' ')}, {formatting.significant(100 * top[1], 2)} %"
    return [(place + 0.2, _name(row)), (place - 0.2, changed)]


def _name(row: Switched) -> str:
    return row.effect.replace("_", " ")


def write(switches: Switches, out: Path) -> None:
    """Write `effects.json`, `effects.csv`, `effects.svg` and `report.html` into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    figure = draw(switches)
    times = ("time_s", "time_least_s", "time_most_s", "within_noise", "time_share")
    quantities = dict.fromkeys(name for row in switches.rows for name in row.changes)
    columns = ("effect", "on", "called_for", *times, *quantities, "remarks", "failed")
    constant: dict[str, Any] = {"policy": POLICY_OF_DIFFERENCES, "spent": _spent}
    contents = {
        "effects.json": dumps(switches) + "\n",
        "effects.svg": plots.standalone(figure),
        "effects.csv": as_table(columns, map(_flat, switches.rows)),
        "report.html": from_template("effects.html.j2", result=switches, figure=figure, **constant),
    }
    write_study(out, contents)


def text(switches: Switches) -> str:
    """The effects as a table; what has no place in it is below its row."""
    lines = [f"{'effect':<20} {'on':<4} {'called for':<11} {'largest change':>14}  {'of':<16} {'time, ms':>24}  why"]
    for row in switches.rows:
        top = row.largest
        quantity, size = ("", formatting.DASH) if top is None else (top[0], f"{100 * top[1]:.3g} %")
        on, called = ("yes" if flag else "no" for flag in (row.on, row.called_for))
        lines.append(f"{row.effect:<20} {on:<4} {called:<11} {size:>14}  {quantity:<16} {_spent(row):>24}  {row.why}")
        lines += [f"{'':<20} {remark}" for remark in row.remarks]
        if row.failed is not None and row.failed != row.why:
            lines.append(f"{'':<20} no numbers: {row.failed}")
    return "\n".join(lines)


def _spent(row: Switched) -> str:
    """What an effect adds to a run [ms], as a person may believe it."""
    if row.time_s is None or row.time_spread_s is None:
        return formatting.DASH
    low, high = (formatting.significant(1e3 * end, 2) for end in row.time_spread_s)
    middle = "within noise" if row.within_noise else formatting.significant(1e3 * row.time_s, 2)
    return f"{middle} ({low} to {high})"


def _flat(row: Switched) -> dict[str, Any]:
    low, high = row.time_spread_s or (None, None)
    times = {"time_least_s": low, "time_most_s": high, "within_noise": row.within_noise}
    return vars(row) | times | row.changes | {"remarks": "; ".join(row.remarks)}


def dumps(switches: Switches) -> str:
    """The machine-readable result."""
    return as_json(switches.document())
