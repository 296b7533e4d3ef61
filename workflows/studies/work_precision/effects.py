"""`spindamp effects`: each effect switched against the rest, what that changes and takes; as files and as text."""

import math
import textwrap
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, TypeAlias

from fem.rotor import from_rpm
from workflows import formatting, pipeline
from workflows.effects.selection import EFFECTS, called_for
from workflows.errors import SpindampError
from workflows.formatting import whole
from workflows.io.files import StudyResult, as_table
from workflows.progress import Stages
from workflows.report import plots
from workflows.report.templates import from_template, texts
from workflows.scene.load import SceneFile
from workflows.solve import blade, limits, structure
from workflows.solve.model_choice import choose_model
from workflows.solve.results import Figures, Mode, Pair, SpeedPoint
from workflows.studies.work_precision.timing import compared, entry, machine


@dataclass(frozen=True)
class Changes:
    """Relative changes (with - without) / without, the largest over the speeds, and what no number can say.

    Attributes:
        changes: by quantity; None where no speed has a value on both sides. A value that is rounding beside the
            quantity's largest is none.
        rpm, error: the speed of each that is known, and by how much its two values may err, as far as they say.
        remarks: quantities that are there on one side only, speeds at which the plate diverges on one side only.
        one_sided: of the former, on which side, in words.
    """

    changes: dict[str, float | None]
    rpm: dict[str, float]
    error: dict[str, float]
    remarks: tuple[str, ...]
    one_sided: dict[str, str]


def changes(
    own: tuple[SpeedPoint, ...], other: tuple[SpeedPoint, ...], *, own_has_it: bool, judged: Mapping[float, int]
) -> Changes:
    """What an effect changes, between a scene's own run and the other; frequencies are numbered as in the own run.

    Speeds [rev/min] other than those judged, with the rank of their verdicts, are left out, unless there is none of
    these; and for the ball's damping those at which it does nothing within what the structure endures.
    """
    mine, others = ({point.rpm: point for point in points} for points in (own, other))
    with_it, without = (mine, others) if own_has_it else (others, mine)
    pairs: dict[str, list[_Pair]] = defaultdict(list)
    common = [rpm for rpm in mine if rpm in others]
    for rpm in [rpm for rpm in common if rpm in judged] or common:
        for name, values in _values(mine[rpm], others[rpm]).items():
            if name != "ball_damping_ratio" or judged.get(rpm) != 0 or not any(judged.values()):
                pairs[name].append((rpm, *(values if own_has_it else values[::-1])))
    pairs = {name: _without_rounding(both) for name, both in pairs.items()}
    relative: dict[str, float | None] = dict.fromkeys(pairs)
    at, error = {}, {}
    for name, both in pairs.items():
        known = [(change, rpm) for rpm, *values in both if (change := _change(*values)) is not None]
        found = [(change, rpm, _error(name, change, with_it[rpm], without[rpm])) for change, rpm in known]
        if found:  # one beyond its error goes before a larger one that is not
            most = max(found, key=lambda each: (abs(each[0]) > each[2], abs(each[0])))
            relative[name], at[name], error[name] = most
    diverging = {"with": set(without) - set(with_it), "without": set(with_it) - set(without)}
    remarks = [f"{side} it the plate diverges {_at(speeds)}" for side, speeds in diverging.items() if speeds]
    odd = {name: _one_sided(name, both) for name, both in pairs.items()}
    remarks += [remark for each in odd.values() for remark in each.values()]
    if _FALLING in pairs:
        remarks.append(
            f"ball_damping_ratio is the verdict's, with the tilt either way; {_FALLING} is with the tilt and without it"
        )
    one_sided = {name: next(iter(each)) for name, each in odd.items() if each}
    return Changes(relative, at, error, tuple(remarks), one_sided)


_Pair: TypeAlias = tuple[float, float | None, float | None]
"""A speed [rev/min], and a quantity there with an effect and without it."""


_ROUNDING, _NOTHING = 1e-12, 1e-9
"""Changes below this are none at all; and values of a quantity are, below this part of its largest at any speed."""


def _without_rounding(pairs: list[_Pair]) -> list[_Pair]:
    """The values of a quantity, 0 where they are rounding: the cycles of a ball that loses nothing scatter about 0."""
    least = max(_ROUNDING, _NOTHING * max((abs(value) for _, *both in pairs for value in both if value), default=0.0))

    def seen(value: float | None) -> float | None:
        return 0.0 if value is not None and abs(value) < least else value

    return [(rpm, seen(with_it), seen(without)) for rpm, with_it, without in pairs]


def _change(with_it: float | None, without: float | None) -> float | None:
    """Relative; None where there is none."""
    if with_it is None or without is None:
        return None
    return 0.0 if with_it == without else None if without == 0 else (with_it - without) / without


def _error(name: str, change: float, with_it: SpeedPoint, without: SpeedPoint) -> float:
    """By how much a relative change of a damping ratio may err, as both runs estimate theirs; 0 of other quantities."""
    if not name.endswith("damping_ratio") or with_it.damping_curve is None or without.damping_curve is None:
        return 0.0
    return with_it.damping_curve.error * (1.0 + change) + without.damping_curve.error


def _values(own: SpeedPoint, other: SpeedPoint) -> dict[str, tuple[float | None, float | None]]:
    """Headline quantities of two runs at one speed."""
    partners = _partners(own.modes, other.modes)
    values: dict[str, tuple[float | None, float | None]] = {}
    for number, (mode, partner) in enumerate(zip(own.modes, partners, strict=True), 1):
        values[f"frequency_{number}"] = mode.frequency_hz, None if partner is None else partner.frequency_hz
    if own.damper is not None and other.damper is not None:
        for name in ("cutoff_g", "peak_sdc", "impacts"):
            values[name] = getattr(own.damper, name), getattr(other.damper, name)
        values["rest_amplitude"] = _rest(own.damping_curve), _rest(other.damping_curve)
        values["ball_damping_ratio"] = _peak(own.damping_curve), _peak(other.damping_curve)
        if (own.level is None) != (other.level is None):
            falling = [
                point.level or (point.damping_curve and point.damping_curve.from_above) for point in (own, other)
            ]
            values[_FALLING] = _peak(falling[0]), _peak(falling[1])
        values["ball_share"] = own.damper.energy.ball_share, other.damper.energy.ball_share
    return values


_FALLING = "falling_damping_ratio"


def _peak(figures: Figures | None) -> float | None:
    return None if figures is None or not figures.peak > 0 else figures.peak


def _rest(figures: Figures | None) -> float | None:
    """Amplitude up to which a ball stays at rest [m]."""
    return figures.cutoff if figures is not None and figures.cutoff < math.inf else None


def _partners(own: tuple[Mode, ...], other: tuple[Mode, ...]) -> list[Mode | None]:
    """For each mode the other run's of the same family and the same number within it, if that was solved for."""
    families: dict[str, list[Mode]] = defaultdict(list)
    for mode in other:
        families[mode.family].append(mode)
    waiting = {family: iter(modes) for family, modes in families.items()}
    return [next(waiting.get(mode.family, iter(())), None) for mode in own]


def _one_sided(name: str, pairs: list[_Pair]) -> dict[str, str]:
    """Where a quantity is there on one side only, so that its change has no number: by side, with the speeds."""
    odd = [pair for pair in pairs if _change(*pair[1:]) is None and pair[1:] != (None, None)]
    if name.startswith("frequency"):
        return {"no partner": f"{name} has no partner of its family {_at(rpm for rpm, *_ in odd)}"} if odd else {}
    sides = {"with": [each[0] for each in odd if not each[2]], "without": [each[0] for each in odd if each[2]]}
    other = {"with": "without", "without": "with"}
    return {f"only {side} it": f"no {name} {other[side]} it, {_at(rpm)}" for side, rpm in sides.items() if rpm}


def _at(speeds: Iterable[float]) -> str:
    return f"at {formatting.revolutions([from_rpm(rpm) for rpm in sorted(speeds)])}"


@dataclass(frozen=True)
class EffectChange:
    """One effect against the rest.

    Attributes:
        effect, called_for, why: its name, whether the scene calls for it, and why (not).
        on: whether it is simulated, as the scene and the rules have it.
        changes: what it does to each headline quantity, (with - without) / without; the largest over the speeds with a
            verdict, None where no speed has a value both with and without it; rpm: the speed of each.
        error: by how much the changes of damping ratios may err, as `run` estimates those of both sides.
        scatter: by how much each of these quantities changes as the clearance changes by a billionth, with or without
            the effect, where motion is chaotic; a change that is no larger is none of the effect's.
        remarks: what the changes do not say: divergence, quantities that appear or vanish, effects switched together.
        one_sided: quantities that appear or vanish, with the side on which they are.
        time_s: what it adds to a run [s], median; time_spread_s: least and most; time_share: over the run with it.
        failed: why there is no change to show.
    """

    effect: str
    called_for: bool
    why: str
    on: bool
    changes: dict[str, float | None] = field(default_factory=dict)
    rpm: dict[str, float] = field(default_factory=dict)
    error: dict[str, float] = field(default_factory=dict)
    scatter: dict[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    one_sided: dict[str, str] = field(default_factory=dict)
    time_s: float | None = None
    time_spread_s: tuple[float, float] | None = None
    time_share: float | None = None
    failed: str | None = None

    @property
    def largest(self) -> tuple[str, float] | None:
        """The quantity that changes most beyond its scatter and its error, and by how much."""
        known = [(name, each) for name, each in self.changes.items() if each is not None and not self.within(name)]
        return max((item for item in known if abs(item[1]) > _ROUNDING), key=lambda item: abs(item[1]), default=None)

    def within(self, quantity: str) -> str | None:
        """Within what a quantity's change is none of the effect's; None where it is beyond all of that."""
        size = abs(self.changes[quantity] or 0.0)
        if size <= _WITHIN * self.scatter.get(quantity, 0.0):
            return "the scatter of chaotic motion"
        return "the error that run estimates" if size <= self.error.get(quantity, 0.0) else None

    @property
    def within_noise(self) -> bool | None:
        """Whether runs do not agree on the time's sign; None without a time."""
        if self.time_s is None or self.time_spread_s is None:
            return None
        low, high = self.time_spread_s
        return low <= 0.0 <= high


@dataclass(frozen=True, eq=False, repr=False)
class EffectStudy(StudyResult):
    """All effects of a scene, and the relative error in frequency that the scene asks for."""

    REPORT = __name__
    title: str
    target: float
    rows: tuple[EffectChange, ...]


NAME = "effects"


def document(result: EffectStudy) -> dict[str, Any]:
    """The machine-readable result."""
    return {
        "title": result.title,
        "asked": result.target,
        "machine": machine(),
        "noise": texts("accuracy")["policy_of_differences"],
        "rows": [entry(row) | {"within_noise": row.within_noise} for row in result.rows],
    }


def effect_study(source: SceneFile, stages: Stages | None = None) -> EffectStudy:
    """Run a scene with each effect the other way, on one mesh.

    Raises:
        BadInput, NoAnswer: see :class:`workflows.solve.structure.StructureSolver`.
    """
    stages, quiet = stages or Stages(), Stages(visible=False)
    choice = choose_model(source, quiet)
    effects = {name: effect.on for name, effect in choice.effects.items()}
    size = None if choice.form is None else structure.discretise(source, choice, quiet).choice.size

    releases: dict[float, Pair] = {}  # of the scene's own run, since an automatic one would differ with an effect

    def run(clearance: float = 1.0, anew: bool = False, **switches: bool) -> structure.StructureState:
        """The scene, its effects as decided but those switched, on the mesh of its own run; a factor of clearance."""
        if anew:
            blade.forget()
        tables: dict[str, Any] = {"effects": effects | switches}
        if source.scene.damper is not None and clearance != 1.0:
            ball, cavity = 2 * source.scene.damper.radius, source.scene.damper.cavity
            tables["damper"] = {"cavity": tuple(ball + clearance * (side - ball) for side in cavity)}
        state = pipeline.structure(source.changed(**tables), quiet, shapes=False, size=size)
        points: list[SpeedPoint] = []
        for point in state.points:  # one by one, since each has a release of its own
            known = point.rpm in releases
            let_go = state.source.changed(release={"displacement": releases[point.rpm]}) if known else state.source
            points += pipeline.damped(replace(state, source=let_go, points=(point,)), quiet).points
        return replace(state, points=tuple(points))

    def filled_in(row: EffectChange) -> EffectChange:
        """A row, filled in by a run with its effect the other way."""
        belongs_to, on = EFFECTS[row.effect].of, row.on
        solid = belongs_to == "plate" and source.scene.blade is not None
        if solid and row.effect != "large_deflection":
            return replace(row, failed="solid blades are solved one way alone")
        if not solid and getattr(source.scene, belongs_to) is None:
            return replace(row, failed=f"no {belongs_to} in the scene")
        switches, together = _switches(row.effect, effects)
        try:
            time, *medians = compared(partial(run, anew=solid, **switches), partial(run, anew=solid))
        except (SpindampError, ValueError) as error:
            reason = str(error).removeprefix(f"{source.name}: ")
            return replace(row, remarks=together, failed=f"{'off' if on else 'on'}: {reason}")
        changed = changes(own, time.value.points, own_has_it=on, judged=judged)
        extra, ends = (-time.median, (-time.high, -time.low)) if on else (time.median, (time.low, time.high))
        row = replace(row, **vars(changed) | {"remarks": together + changed.remarks})
        if any(change and name in row.scatter and not row.within(name) for name, change in row.changes.items()):
            theirs = scatter_of(time.value.points, partial(run, **switches), judged)
            both = {name: max(row.scatter.get(name, 0.0), theirs.get(name, 0.0)) for name in row.scatter | theirs}
            row = replace(row, scatter=both)
        return replace(row, time_s=extra, time_spread_s=ends, time_share=extra / medians[on])

    called = called_for(source.scene, choice.form)
    with stages("effects", len(effects) + 1) as step:
        state = run()
        own, judged = state.points, _judged(state)
        releases |= {point.rpm: point.damper.release for point in own if point.damper is not None}
        scatter = scatter_of(own, run, judged) if source.scene.damper else {}
        step.advance("as the scene has it")
        rows = []
        for name, on in effects.items():
            row = EffectChange(name, *called[name][:2], on, scatter=scatter)
            rows.append(filled_in(row))
            step.advance(name)
    return EffectStudy(source.scene.title, source.scene.accuracy.frequency, tuple(rows))


_PERTURBED, _WITHIN = 1e-9, 2.0
"""Relative change of the clearance that measures the scatter, and how many times the scatter an effect exceeds."""


def _judged(state: structure.StructureState) -> dict[float, int]:
    """The speeds [rev/min] at which the damper has a verdict, and its rank."""
    judged = limits.with_verdicts(state.results())
    ranks = {point.rpm: point.verdict.rank for point in judged.speeds if point.verdict}
    return {rpm: rank for rpm, rank in ranks.items() if rank >= 0}


def scatter_of(
    points: tuple[SpeedPoint, ...], run: Callable[..., structure.StructureState], judged: Mapping[float, int]
) -> dict[str, float]:
    """The largest change of each quantity of the ball by a change that is none, at all speeds judged."""
    scatter: dict[str, float] = {}
    for each in (run(clearance=1 + k * _PERTURBED).points for k in (-1, 1, 2)):
        for name, change in changes(points, each, own_has_it=True, judged=judged).changes.items():
            if change is not None and not name.startswith("frequency"):
                scatter[name] = max(scatter.get(name, 0.0), abs(change))
    return scatter


def _switches(name: str, effects: dict[str, bool]) -> tuple[dict[str, bool], tuple[str, ...]]:
    """An effect the other way, with those that must go with it, and these in words."""
    switches, together = {name: not effects[name]}, []
    for part, parent in ((part, kind.part_of) for part, kind in EFFECTS.items() if kind.part_of):
        if name == parent and effects[parent] and effects[part]:
            switches[part] = False
            together.append(f"together with {part}, which needs it")
        if name == part and not effects[part] and not effects[parent]:
            switches[parent] = True
            together.append(f"together with {parent}, which it needs")
    return switches, tuple(together)


_UNSEEN = 1e-2
"""Changes below this part of the accuracy asked for are said to be none, so that the others can be told apart."""


_LONGEST = 50
"""Characters of a line of a reason beside an effect's name; the whole of a longer one is its title."""


_NOTE: dict[str, Any] = {
    "xytext": (4.0, 0.0),
    "xycoords": ("axes fraction", "data"),
    "textcoords": "offset points",
    "va": "center",
    "color": plots.MUTED,
    "fontsize": 7,
    "bbox": {"facecolor": plots.PAPER, "edgecolor": "none", "pad": 1.0},
}
"""How words instead of a bar are set."""


@plots.style()
def draw(switches: EffectStudy) -> str:
    """The largest change that each effect makes to any quantity, and to which, beside the time it takes."""
    figure, (left, right) = plots.canvas(0.9 + 0.34 * len(switches.rows), 2)
    rows, least = switches.rows[::-1], float(10.0 ** math.floor(math.log10(_UNSEEN * switches.target)))
    labels, whole, sizes = [], [], [1.0, switches.target]
    for place, row in enumerate(rows):
        colour = plots.CATEGORIES[0] if row.on else plots.CATEGORIES[6]
        name, (quantity, change) = row.effect.replace("_", " "), row.largest or ("", 0.0)
        sizes.append(abs(change))
        if abs(change) > least:
            left.plot([least, abs(change)], [place, place], color=colour, lw=1.2)
            left.plot([abs(change)], [place], "o", color=colour, ms=4)
            # Heights of their own, since lines of one text come out ragged in a browser.
            labels += [(place + 0.2, name)]
            size = f"{_size(change)} {_at([row.rpm[quantity]])}"
            labels += [(place - 0.2, f"{quantity.replace('_', ' ')}, {size}")]
        else:
            labels.append((place, name))
            reason = _unseen(row, least)
            left.annotate(textwrap.fill(reason, _LONGEST, max_lines=2, placeholder=" …"), (0.0, place), **_NOTE)
            if len(reason) > _LONGEST:
                whole.append(plots.Value(1.1 * least, place, reason))
        if row.within_noise:
            right.annotate("within noise", (0.0, place), **_NOTE)
        elif row.time_share is not None:
            right.barh(place, 100 * row.time_share, color=colour, height=0.5)
    left.set_yticks([place for place, _ in labels], [label for _, label in labels])
    right.set_yticks(range(len(rows)), [row.effect.replace("_", " ") for row in rows])
    for axes in (left, right):
        axes.set_ylim(-0.6, len(rows) - 0.4)
        axes.tick_params(axis="y", length=0.0)
        axes.grid(visible=False, axis="y")
    left.set(
        xscale="log",
        xlim=(least, 10 * max(sizes)),
        title="largest relative change of any quantity",
        xlabel=f"dashed: the scene's own accuracy, {switches.target:g}",
    )
    left.axvline(switches.target, color=plots.MUTED, lw=0.8, ls=plots.DASHED)
    right.set(title="time that it adds, % of a run with it")
    return plots.svg(figure, "effects", "What each effect changes and costs", whole)


def _unseen(row: EffectChange, least: float) -> str:
    """Why an effect has no bar."""
    if row.failed is not None:
        return row.failed
    none = "none" if row.largest is None else f"none above {formatting.significant(100 * least)} %"
    if _scattered(row):
        none += " beyond scatter and error"
    return "; ".join((f"{none} in numbers" if row.remarks else none, *row.remarks))


def files(switches: EffectStudy) -> dict[str, str | bytes]:
    """The files beside `effects.json`."""
    figure = draw(switches)
    times = ("time_s", "time_least_s", "time_most_s", "within_noise", "time_share")
    quantities = dict.fromkeys(name for row in switches.rows for name in row.changes)
    more = dict.fromkeys(name for row in switches.rows for name in _more(row))
    columns = ("effect", "on", "called_for", *times, *quantities, *more, "remarks", "failed")
    constant: dict[str, Any] = {"policy": texts("accuracy")["policy_of_differences"], "spent": _spent}
    constant |= {"scattered": _scattered, "largest": _largest, "whole": whole, "size": _size}
    return {
        "effects.svg": plots.standalone(figure),
        "effects.csv": as_table(columns, map(_flat, switches.rows)),
        "report.html": from_template("effects.html.j2", result=switches, figure=figure, **constant),
    }


def text(switches: EffectStudy) -> str:
    """The effects as a table; what has no place in it is below its row."""
    lines = [f"{'effect':<20} {'on':<4} {'called for':<11} {'largest change':>15}  {'of':<38} {'time, ms':>24}  why"]
    for row in switches.rows:
        size, quantity = _largest(row)
        on, called = ("yes" if flag else "no" for flag in (row.on, row.called_for))
        lines.append(f"{row.effect:<20} {on:<4} {called:<11} {size:>15}  {quantity:<38} {_spent(row):>24}  {row.why}")
        lines += [f"{'':<20} {remark}" for remark in (*row.remarks, *_scattered(row))]
        if row.failed is not None and row.failed != row.why:
            lines.append(f"{'':<20} no numbers: {row.failed}")
    return "\n".join(lines)


def _largest(row: EffectChange) -> tuple[str, str]:
    """The largest change of a row, and of what and at which speed it is; or why there is none."""
    if row.largest is not None:
        quantity, change = row.largest
        return _size(change, 3), f"{quantity} {_at([row.rpm[quantity]])}"
    if row.failed is not None or not row.changes:
        return "no numbers", ""
    if lost := _scattered(row):
        return "within scatter" if "scatter" in lost[0] else "within error", ""
    return next(((side, name) for name, side in row.one_sided.items()), ("none", ""))


_MANIFOLD = 10.0
"""Relative change from which on it is shown as a factor."""


def _size(change: float, digits: int = 2) -> str:
    """A relative change in percent; one beyond tenfold as a factor."""
    if change < _MANIFOLD:
        return f"{formatting.significant(100 * change, digits)} %"
    return f"× {formatting.significant(1 + change, digits)}"


def _scattered(row: EffectChange) -> list[str]:
    """Quantities whose change is no more than the scatter of chaotic motion, or their own error."""
    each: dict[str, list[str]] = defaultdict(list)
    for name, change in row.changes.items():
        if change and abs(change) > _ROUNDING and (bound := row.within(name)):
            each[bound].append(f"{name} {_size(change)}")
    return [f"within {bound}: {', '.join(names)}" for bound, names in each.items()]


def _spent(row: EffectChange) -> str:
    """What an effect adds to a run [ms], as a person may believe it."""
    if row.time_s is None or row.time_spread_s is None:
        return formatting.DASH
    low, high = (formatting.significant(1e3 * end, 2) for end in row.time_spread_s)
    middle = "within noise" if row.within_noise else formatting.significant(1e3 * row.time_s, 2)
    return f"{middle} ({formatting.interval(low, high)})"


def _flat(row: EffectChange) -> dict[str, Any]:
    low, high = row.time_spread_s or (None, None)
    times = {"time_least_s": low, "time_most_s": high, "within_noise": row.within_noise}
    return vars(row) | times | row.changes | _more(row) | {"remarks": "; ".join(row.remarks)}


def _more(row: EffectChange) -> dict[str, float]:
    """What is known of the changes, by quantity."""
    tables = {"rpm": row.rpm, "error": row.error, "scatter": row.scatter}
    return {f"{name}_{what}": value for what, table in tables.items() for name, value in table.items()}
