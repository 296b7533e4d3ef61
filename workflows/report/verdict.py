"""The verdict in words: does it damp, how much, up to what load."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from fem.rotor import in_rpm
from workflows.formatting import significant, span, whole
from workflows.report import remarks
from workflows.report.remarks import (
    as_it_moves,
    at_load,
    at_speed,
    capital,
    carrier,
    millimetres,
    percent,
    stretch,
    tilt,
)
from workflows.solve import engine_orders, limits
from workflows.solve.excitation import HELPS
from workflows.solve.limits import AIR, FRICTION_DAMPERS, in_g
from workflows.solve.results import Figures, Reason, Results, SpeedPoint, VibrationReduction

_BELOW = 0.8
"""Part of the amplitude that sets a ball off below which it is worth a word that it goes on."""

_KNOWN, _ROUGH, _UNSURE = 0.05, 0.5, 0.1
"""Relative errors of a peak that are worth a word, beside the figure and in the headline; of a frequency there."""


def between(results: Results, points: list[SpeedPoint]) -> list[str]:
    """Between what amplitudes the ball does half of its best, at the lowest load at which it can and at the highest."""
    able = [
        (point, figures, best.useful)
        for point in points
        if (best := limits.best(results, point)) is not None and (figures := point.damping_curve) is not None
    ]
    able = [each for each in able if not math.isnan(each[2][0])]
    ends, ranges = able[:1] + able[1:][-1:], list[str]()
    limit = limits.endured(results) or math.inf
    ball, its = ("the ball gives", "its") if _balls(results) == 1 else ("the balls give", "their")
    for point, figures, (low, high) in ends:
        ends_there = f", the limit of what the {carrier(results)} endures" if high < figures.half[1] else ""
        others = [(begin, min(end, limit)) for begin, end in humps(figures) if end < low or high < begin < limit]
        every = sorted([*others, (low, high)])
        amplitudes = f"amplitudes of {listed([_in_mm_and_g(results, point, *each) for each in every])}{ends_there}"
        half = "" if ranges else f"{ball} at least half of {its} largest damping "
        ranges.append(f"{at_load(point)} {half}at {amplitudes}")
    sustained = [
        f"{at_load(p)} below {millimetres(w.cutoff)} mm{_goes_on(results, p, w.cutoff)}"
        for p, w, _ in ends
        if w.cutoff > 0
    ]
    rests = f"The load holds the {'ball' if _balls(results) == 1 else 'balls'} at rest {', '.join(sustained)}."
    return [*([f"{capital(', '.join(ranges))}."] if ranges else []), *([rests] if sustained else [])]


def _balls(results: Results) -> int:
    return 1 if results.scene.damper is None else results.scene.damper.count


def _in_mm_and_g(results: Results, point: SpeedPoint, low: float, high: float) -> str:
    """A range of amplitudes."""
    loads = [in_g(results, point.reduced, value) for value in (low, high) if point.reduced and point.load_g]
    in_loads = f" ({whole(loads[0])} to {whole(loads[1])} g)" if loads else ""
    return f"{span(1e3 * low, 1e3 * high)} mm{in_loads}"


def humps(figures: Figures) -> list[tuple[float, float]]:
    """All ranges of amplitudes over several points of the curve in which the damping is at least half its peak."""
    enough = np.concatenate([[False], figures.damping_ratio >= figures.peak / 2, [False]])
    begins, ends = np.flatnonzero(enough[1:] & ~enough[:-1]), np.flatnonzero(enough[:-1] & ~enough[1:]) - 1
    return [
        (float(figures.amplitude[b]), float(figures.amplitude[e])) for b, e in zip(begins, ends, strict=True) if b < e
    ]


def _goes_on(results: Results, point: SpeedPoint, cutoff: float) -> str:
    """Down to where a ball in motion goes on, far below what sets it off, as one in a hollow floor may."""
    if point.level is not None or point.damper is None or not point.damper.cutoff_g or point.reduced is None:
        return ""
    last = point.damper.cutoff_g / in_g(results, point.reduced, 1.0)
    return f" (a moving ball goes on down to {millimetres(last)} mm)" if last < _BELOW * cutoff else ""


def reach_of(results: Results, points: list[SpeedPoint]) -> str | None:
    """From what load on the ball is out of reach of what the plate endures."""
    limit = limits.endured(results)
    lost = [(p, w) for p in points if limits.best(results, p) is None and (w := p.damping_curve) is not None]
    lost = [(p, w) for p, w in lost if w.peak > limits.ROUNDING]
    if limit is None or not lost:
        return None
    point, figures = lost[0]
    beyond = remarks.beyond_of(results)
    if what_to_do(results, points) is not None:  # which names both amplitudes
        return f"More than {millimetres(limit)} mm would {beyond}."
    return (
        f"{capital(at_load(point))} the ball begins to roll at {millimetres(figures.cutoff)} mm, but more than"
        f" {millimetres(limit)} mm would {beyond}: the damper is out of reach there."
    )


def what_to_do(results: Results, points: Sequence[SpeedPoint]) -> str | None:
    """What would move the ball at the lowest load that holds it at all that the plate endures."""
    locked = [p for p in points if p.verdict is not None and p.verdict.reason == Reason.OUT_OF_REACH]
    limit = limits.endured(results)
    if not locked or limit is None or results.scene.damper is None:
        return None
    point = min(locked, key=lambda each: each.load_g)
    remedy = limits.what_moves(results, point)
    if remedy is None:
        return None
    steps = []
    if not math.isnan(remedy.rolling_friction):
        steps.append(f"with a rolling friction below {_rounded(1e3 * remedy.rolling_friction)} mm")
    if not math.isnan(remedy.radius):
        steps.append(f"with a ball radius above {_rounded(1e3 * remedy.radius, up=True)} mm and the same clearance")
    if not math.isnan(remedy.omega):
        load = point.load_g * (remedy.omega / point.omega) ** 2
        steps.append(f"below {whole(in_rpm(remedy.omega))} rpm ({whole(load)} g)")
    goes_on = _goes_on(results, point, remedy.amplitude)
    moves = f"{capital(at_load(point))} the ball moves above {millimetres(remedy.amplitude)} mm{goes_on}"
    if not steps and not math.isnan(remedy.without_dent) and remedy.without_dent >= limit:
        without = f"without its dent it would move above {millimetres(remedy.without_dent)} mm"
        return f"{moves}; {without}, still beyond the {millimetres(limit)} mm that the {carrier(results)} endures."
    if not steps and point.lean[0]:
        return f"{moves}: the load pulls it along the floor to a wall and holds it there."
    if not steps:
        return f"{moves}: its own dent holds it, and a harder floor or a lighter ball would reduce the dent."
    would = f"at the {millimetres(limit)} mm that the {carrier(results)} endures, it would move {listed(steps, 'or')}"
    return f"{moves}; {would}."


def _rounded(value: float, *, up: bool = False) -> str:
    """Three digits on the safe side."""
    if value == 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return significant((math.ceil if up else math.floor)(value / unit) * unit, 3)


def way_down(results: Results, points: list[SpeedPoint]) -> list[str]:
    """That a ball in motion does more than one at rest does as the vibration grows, where it does most."""
    target = results.scene.accuracy.damping
    parted = [
        (p, w)
        for p in points
        if (w := p.damping_curve) is not None and w.ways_differ and w.from_above.peak > (1 + target) * w.peak > 0
    ]
    if not parted:
        return []
    point, figures = max(parted, key=lambda pair: pair[1].from_above.peak)
    (stops, rolls), above = figures.folds, figures.from_above
    bounces = above.amplitude >= stops  # below, it rolls
    most = above.damping_ratio[bounces].max() if bounces.any() else above.peak
    return [
        "These figures are the least of the starts evaluated:"
        f" {at_load(point)} the ball may roll or rest without hitting a wall up to {millimetres(rolls)} mm.",
        f"As the vibration falls, it keeps bouncing down to {millimetres(stops)} mm and adds up to {percent(most)} %.",
    ]


def _rank(point: SpeedPoint) -> int:
    return -1 if point.verdict is None else point.verdict.rank


def _where_none(results: Results, points: Sequence[SpeedPoint]) -> tuple[list[str], str]:
    """Where there is no verdict, and why, one text for each reason; the reason alone, where there is one."""
    unknown = {reason: [p for p in points if p.verdict and p.verdict.reason == reason] for reason in _OUTSIDE}
    reasons = {reason: _OUTSIDE[reason](results, those) for reason, those in unknown.items() if those}
    texts = [f"{stretch(unknown[reason], points)}: there {why}" for reason, why in reasons.items()]
    torn = remarks.torn_from(results)
    if torn is not None:
        return [*texts, torn], ""
    return texts, next(iter(reasons.values())) if len(reasons) == 1 else ""


_OUTSIDE: dict[str, Callable[[Results, Sequence[SpeedPoint]], str]] = {
    Reason.WEIGHT: lambda *_: remarks.WEIGHT,
    Reason.SLIP: lambda results, points: (
        "the ball would slide, since rolling requires a friction coefficient of"
        f" {_frictions(results, points)} at the amplitude of largest damping"
    ),
    Reason.CONTACT: lambda results, points: remarks.flows(results, points),
}
"""Why the model does not hold at some speeds."""


def _with_limits(results: Results, points: Sequence[SpeedPoint], verdict: str) -> str:
    """A verdict with what it rests on, and with the speeds that it does not speak of."""
    return "; no verdict ".join([f"{verdict}{_rests_on(results, points)}", *_where_none(results, points)[0]])


def _rests_on(results: Results, points: Sequence[SpeedPoint]) -> str:
    """What a verdict rests on where the ball rolls only on a floor that grips better than the walls."""
    damper = results.scene.damper
    if damper is None:
        return ""
    better = [p for p in points if _rank(p) >= 0 and _friction(results, p) > damper.friction]
    if not better:
        return ""
    return (
        ", provided that the ball rolls without slip: at the amplitude of largest damping this requires a friction"
        f" coefficient of {_frictions(results, better)} {stretch(better, points)}, and the scene has"
        f" {damper.friction:g}"
    )


def _frictions(results: Results, points: Sequence[SpeedPoint]) -> str:
    """The least and the largest friction that rolling requires at the points."""
    each = [_friction(results, point) for point in points]
    return span(min(each), max(each))


def _friction(results: Results, point: SpeedPoint) -> float:
    best = limits.best(results, point)
    return 0.0 if best is None else limits.friction_demand(results, point, best.amplitude)


_STEPS_AT_MOST = 3
"""Grades that a verdict names one after the other with rising load; more are not told apart."""

_WORDS = ("locked", "not useful", "of little use", "useful")
"""By rank."""

_WORKS = 2
"""Rank from which on the damper's best comes before what would move the ball where it is locked."""


_LEAD = 3
"""Sentences between the verdict and the first table or picture."""


@dataclass(frozen=True)
class Answer:
    """A verdict, and the sentences that carry it."""

    verdict: str
    sentences: tuple[str, ...]

    @property
    def lead(self) -> tuple[str, ...]:
        """What stands before the first table."""
        return self.sentences[:_LEAD]

    @property
    def details(self) -> tuple[str, ...]:
        """What stands below."""
        return self.sentences[_LEAD:]


def answer(results: Results) -> Answer:
    """What the run found, most important first: under the scene's engine orders, where it has some, then by itself."""
    alone, orders = _alone(results), _orders(results)
    if not orders or all(each.reason for each in results.reductions):
        return Answer(alone.verdict, (*map(" ".join, orders), *alone.sentences))
    (first, *rest), *others = orders
    unsure = _unsure(results)
    judged = f"{alone.verdict[0].lower()}{alone.verdict[1:]}".removesuffix(unsure)
    judged, none, where = judged.partition("; no verdict ")
    by_itself = f"Compared with the damping by air alone: {judged.replace(': ', ', ', 1)}{none}{where}."
    estimated = TOO_LOOSE if any(each.loose for each in results.reductions) else SHORT_WAY
    said = [" ".join(each) for each in (rest, *others) if each]
    return Answer(first.removesuffix(".") + unsure, (*said, estimated, by_itself, *alone.sentences))


def _alone(results: Results) -> Answer:
    """The damper's own figures, which no release and no damping of the structure has a part in."""
    points = sorted((p for p in results.speeds if p.damping_curve is not None), key=lambda p: p.load_g)
    if not points:
        return _plate_only(results)
    loaded = [p for p in points if p.load_g > 0] or points
    judged = [p for p in loaded if _rank(p) >= 0]
    dense = remarks.too_dense(results)
    refused = remarks.PRINTED if limits.is_printed(results) else None if dense is None else dense[0]
    if not judged and refused is None:
        texts, alone = _where_none(results, loaded)
        return Answer(f"No verdict: {alone}" if alone else f"No verdict {'; none '.join(texts)}", ())
    speaking = judged or loaded
    if refused is None and all(_rank(p) == 0 for p in judged):
        verdict, sentences = _why_not(results, speaking)
        return Answer(_with_limits(results, loaded, verdict), sentences)
    way_out, works = what_to_do(results, speaking), max(map(_rank, speaking)) >= _WORKS
    parts = (
        None if dense is None else dense[1],
        None if works else way_out,
        _fed(points),
        *_how_much(results, speaking, turning=len(loaded) < len(points)),
        *between(results, speaking),
        *way_down(results, speaking),
        remarks.unknown_floor(results),
        way_out if works else None,
        reach_of(results, speaking),
        tilt(results, speaking),
        None if remarks.met(results) else remarks.sentence(results),
    )
    verdict = _with_limits(results, loaded, _verdict(results, loaded)) if refused is None else f"No verdict: {refused}"
    errors = [(0.0 if p.damping_curve is None else p.damping_curve.error, p) for p in judged]
    error, worst = max(errors, key=lambda pair: pair[0], default=(0.0, None))
    if refused is None and worst is not None and error > _ROUGH:
        verdict += f"; at {at_speed(worst)} the damping is known only roughly"
    if refused is None:
        verdict += _unsure(results)
    return Answer(verdict, tuple(part for part in parts if part))


def _unsure(results: Results) -> str:
    """That the first mode's frequency, and with it the speeds of crossings, is known only within an error worth it."""
    errors = [mode.error_estimate or 0.0 for point in results.speeds for mode in point.modes[:1]]
    error = max(errors, default=0.0)
    return f"; the first frequency is known only to {percent(error)} %" if error > _UNSURE else ""


def first_frequency(point: SpeedPoint) -> float | None:
    """The first bending frequency [Hz]: of the plate without the ball, or else the one given, with the ball stuck."""
    if point.modes:
        bending = [mode.frequency_hz for mode in point.modes if mode.family == "flap"]
        return bending[0] if bending else None
    return point.reduced.f1_hz if point.reduced is not None else None


def _verdict(results: Results, points: list[SpeedPoint]) -> str:
    """How useful the damper is over the loads, by stretches of them; where it is of no use, how little it adds."""
    stretches = [(rank, list(run)) for rank, run in groupby(points, key=_rank)]
    known = [k for k, (rank, _) in enumerate(stretches) if rank >= 0]
    if 1 <= (most := max(map(_rank, points))) <= 2:
        return f"{capital(_WORDS[most])}: {_how_little(results, points)}"
    if len(stretches) == 1:
        return capital(_WORDS[stretches[0][0]])
    if len(known) > _STEPS_AT_MOST:
        return f"{capital(_WORDS[max(map(_rank, points))])} at some speeds"
    words = []
    for k in known:
        rank, run = stretches[k]
        first, last = at_speed(run[0]), at_speed(run[-1])
        if k == 0:
            where = f"up to {last}"
        elif k == len(stretches) - 1:
            where = f"from {first} on"
        else:
            alone = f"at {last}" if len(run) == 1 else f"from {first} to {last}"
            where = f"up to {last}" if k - 1 in known else alone
        words.append(f"{_WORDS[rank]} {where}")
    return capital(", ".join(words))


def _how_little(results: Results, points: list[SpeedPoint]) -> str:
    """How little the damper adds at its best, and where it is locked."""
    ratios = [(best.damping_ratio, p) for p in points if (best := limits.best(results, p)) is not None and _rank(p) > 0]
    most, at = max(ratios, key=lambda pair: pair[0])
    locked = [point for point in points if _rank(point) == 0]
    where = f"; the ball is locked {stretch(locked, points)}" if locked else ""
    return f"at most {percent(most)} % equivalent damping ratio ({at_load(at)}){where}"


def _how_much(results: Results, points: list[SpeedPoint], *, turning: bool) -> list[str]:
    """The best and the least; `turning`: there is a speed without a load, which is not among the points."""
    ratios = [(b, p) for p in points if (b := limits.best(results, p)) is not None]
    if not ratios:
        return []
    top, at = max(ratios, key=lambda pair: pair[0].damping_ratio)
    error = 0.0 if at.damping_curve is None else at.damping_curve.error
    rough = f" (±{percent(error)} %)" if error < 1 else f" (known only within a factor of {1 + error:.0f})"
    within = rough if error > _KNOWN else ""
    count = _balls(results)
    ball, it = ("the ball adds", "it adds") if count == 1 else (f"the {count} balls together add", "they add")
    text = (
        f"{'While the rotor turns,' if turning else 'In a slowly growing vibration'} {ball} an equivalent damping"
        f" ratio of up to {percent(top.damping_ratio)} %{within},"
        f" at {at_speed(at)} and an amplitude of {millimetres(top.amplitude)} mm; this is"
        f" {percent(limits.energy_loss(top.damping_ratio))} % of the vibration energy per cycle"
    )
    least, there = min(ratios, key=lambda pair: pair[0].damping_ratio)
    if there is not at and least.damping_ratio < 0.9 * top.damping_ratio:
        within = f", within what the {carrier(results)} endures," if least.limited else ""
        text += f". {capital(at_load(there))}{within} {it} up to {percent(least.damping_ratio)} %"
    air, friction = (f"{percent(low)} to {percent(high)} %" for low, high in (AIR, FRICTION_DAMPERS))
    return [f"{text}.", f"For comparison, air alone gives turbine blades {air}, and friction dampers add {friction}."]


def _fed(points: list[SpeedPoint]) -> str | None:
    """Equations that do not conserve energy may drive the vibration instead of damping it."""
    fed = [
        (w.amplitude[w.damping_ratio < -1e-3 * w.peak].min(), p)
        for p in points
        if (w := p.damping_curve) is not None and (w.damping_ratio < -1e-3 * w.peak).any()
    ]
    if not fed:
        return None
    amplitude, point = min(fed, key=lambda pair: pair[1].load_g)
    load_text = at_load(point)
    return (
        f"{capital(load_text)} and above {millimetres(amplitude)} mm they drive the vibration instead of"
        " damping it, which is impossible for a ball."
    )


def _why_not(results: Results, points: list[SpeedPoint]) -> tuple[str, tuple[str, ...]]:
    """Why the damper does nothing at any speed, by what limits it at the lowest load."""
    damper, low = results.scene.damper, points[0]
    reasons = [point.verdict.reason for point in points if point.verdict is not None]
    slope = tilt(results, points)
    if reasons[0] == Reason.FILLED:
        return "No: the ball never moves", ("The ball fills its cavity along the bending direction.",)
    if reasons[0] == Reason.TILT:
        return "No: the ball never moves", (
            f"{as_it_moves(results)}, the cavity's floor tilts, and {at_load(low)} the load pulls the ball"
            " down the slope by as much as the vibration drives it up.",
        )
    if reasons[0] == Reason.OUT_OF_REACH:
        parts = (what_to_do(results, points), reach_of(results, points), slope)
        return "No: the ball never moves", tuple(part for part in parts if part)
    if all(reason == Reason.LOSSLESS for reason in reasons):
        along = "Along the bending direction it" if damper is not None and damper.friction else "It"
        return "No: the ball dissipates nothing", (
            f"{along} neither meets rolling resistance nor loses speed at the walls.",
        )
    cutoff = 0.0 if low.damping_curve is None else low.damping_curve.cutoff
    known = f", from {millimetres(cutoff)} mm on," if cutoff > 0 else ","
    text = (
        f"{capital(at_load(low))} no damping by the ball was found at any of the amplitudes searched{known}"
        " which does not prove that there is none."
    )
    return "Undecided: no damping by the ball was found", tuple(part for part in (text, slope) if part)


SHORT_WAY = "Estimated from free vibration; `spindamp response` computes the forced motion."

TOO_LOOSE = (
    "A rough estimate from free vibration, since the load holds this ball loosely: rely on `spindamp response`, which"
    " computes the forced motion."
)

_NO_ESTIMATE: dict[str, str] = {
    Reason.WEIGHT: remarks.WEIGHT,
    Reason.SLIP: "the ball would slide at the amplitude of largest damping",
    Reason.DENSITY: "no solid is as dense as this ball",
    Reason.ROOT_STRESS: "the centrifugal stress at the root exceeds what any blade metal endures",
    Reason.CONTACT: "ball or floor yields fully under the load",
    Reason.OTHER_MODE: "another mode moves the cavity more; `spindamp response` computes the motion",
    Reason.SWINGS: "the ball swings freely in its hollow floor; `spindamp response` computes the motion",
}
"""Why free vibration does not tell what happens at a crossing."""


def of_orders(results: Results) -> list[str]:
    """What the ball does at each order of [excitation] and mode that it meets, where it does most first."""
    return [" ".join(sentences) for sentences in _orders(results)]


def _orders(results: Results) -> list[list[str]]:
    """The same, sentence by sentence."""
    excitation = results.scene.excitation
    if excitation is None or results.scene.damper is None or not results.speeds:
        return []
    every = sorted(results.reductions, key=lambda each: (not math.isfinite(each.range[0]), each.ratio, each.order))
    bends = limits.deflection_governs(results)
    overload = "plate would bend beyond small deflections" if bends else "root would be overstressed"
    met = [_of_order(results, each, excitation.unit, overload) for each in every]
    low, high = (whole(end(point.rpm for point in results.speeds)) for end in (min, max))
    unmet = sorted(set(excitation.orders) - {each.order for each in every})
    if unmet and len(results.speeds) == 1:
        return [
            *met,
            ["Engine orders need at least two speeds: crossings are sought between the lowest and the highest."],
        ]
    for order in unmet:
        rpm = engine_orders.crossing_beyond(results.speeds, order)
        where = "" if rpm is None else f"; it would meet the first near {whole(rpm)} rpm"
        error = 0.0 if rpm is None else _doubt(results, rpm)
        if error > 0:
            where += f", and may within them, since frequencies are accurate to {percent(error)} %"
        met.append([f"Engine order {order} meets no mode between {low} and {high} rpm{where}."])
    return met


def _doubt(results: Results, rpm: float) -> float:
    """The first mode's error at the end of the speeds nearest to another speed, where that lies within it; else 0."""
    end = min(results.speeds, key=lambda point: abs(point.rpm - rpm))
    error = end.modes[0].error_estimate if end.modes else None
    return error if error is not None and abs(rpm / end.rpm - 1) <= error else 0.0


def _of_order(results: Results, reduction: VibrationReduction, unit: str, overload: str) -> list[str]:
    """What the ball does at a crossing: by how much, at which levels, and why not at the others; by sentences."""
    where = f"At engine order {reduction.order} ({whole(reduction.rpm)} rpm, {reduction.family} mode)"
    if reduction.reason:
        return [f"{where}: no estimate: {reduction.detail or _NO_ESTIMATE[reduction.reason]}."]
    if not math.isfinite(reduction.range[0]):
        return [f"{where}: not useful {_at_no_level(results, reduction, unit)}."]
    low, high = reduction.range
    at = f"at {significant(reduction.level)} {unit}"
    between = f", at least half of that between {significant(low)} and {significant(high)} {unit}" * (low < high)
    rough = "roughly " if reduction.loose else ""
    text = (
        f"{where}: {_idle(reduction, unit)}{rough}up to {percent(1 - reduction.ratio)} % less vibration {at}{between}."
    )
    borne = [each for each in reduction.levels if each.endured]
    moves_from = f"{significant(reduction.moves_from)} {unit}"
    to_a_wall = ", first to a wall," if any(any(point.lean) for point in results.speeds) else ""
    outside = [each for each in borne if each.level >= reduction.moves_from and not low <= each.level <= high]
    outside = [] if reduction.loose else outside  # a rough estimate does not tell levels apart
    idle = {
        f"At {{}} {unit} the {overload}.": [each for each in reduction.levels if not each.endured],
        f"At {{}} {unit} the load holds the ball at rest; it moves{to_a_wall} from {moves_from} on.": [
            each for each in borne if each.level < reduction.moves_from
        ],
        f"At {{}} {unit} the reduction is less than half of {percent(1 - reduction.ratio)} %.": [
            each for each in outside if 1 - each.ratio < (1 - reduction.ratio) / 2
        ],
    }
    parts = [parts.format(listed([each.level for each in levels])) for parts, levels in idle.items() if levels]
    aside = [each for each in outside if 1 - each.ratio >= (1 - reduction.ratio) / 2]
    parts += [f"At {significant(e.level)} {unit} the reduction is {percent(1 - e.ratio)} %." for e in aside]
    return [text, *parts]


def _idle(reduction: VibrationReduction, unit: str) -> str:
    """That the ball is of no use at the levels of the scene, where that is so, before what it does at others."""
    levels = reduction.levels
    if not levels or any(e.endured and e.level >= reduction.moves_from and e.ratio <= HELPS for e in levels):
        return ""
    return f"not useful at {listed([each.level for each in levels])} {unit}, but "


_NOTICED = 1e-3
"""Reduction of the amplitude below which it has no number."""


def _at_no_level(results: Results, reduction: VibrationReduction, unit: str) -> str:
    """That the ball is of no use at any level that was evaluated, and why."""
    evaluated = "at any level"
    if reduction.detail:
        evaluated = f"at {reduction.detail}"
    elif math.isfinite(reduction.endured_level):
        evaluated += f" that the {carrier(results)} endures (up to {significant(reduction.endured_level)} {unit})"
    if not math.isfinite(reduction.moves_from) or not reduction.levels:
        return f"{evaluated}: the ball never moves"
    if reduction.moves_from >= reduction.endured_level:
        at_rest = f"{evaluated}: the load holds the ball at rest up to {significant(reduction.moves_from)} {unit}"
        friction = limits.friction_that_moves(results, reduction)
        if math.isnan(friction):
            return f"{at_rest}, in its own dent"
        return f"{at_rest}; it would move with a rolling friction below {_rounded(1e3 * friction)} mm"
    if not reduction.ratio <= 1 - _NOTICED:  # nan where there is none
        return f"{evaluated}: the ball does not reduce the amplitude by as much as {percent(_NOTICED)} %"
    return f"{evaluated}: the ball reduces the amplitude by {percent(1 - reduction.ratio)} % at most"


def listed(items: Sequence[float | str], joint: str = "and") -> str:
    """A few levels, or texts, in words."""
    texts = [each if isinstance(each, str) else significant(each) for each in items]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} {joint} {texts[-1]}"


def _plate_only(results: Results) -> Answer:
    first = [p.modes[0].frequency_hz for p in results.speeds if p.modes]
    if not first:
        return Answer("Nothing was solved", ())
    rpm = [p.rpm for p in results.speeds]
    speeds = f"between {whole(min(rpm))} and {whole(max(rpm))} rpm" if len(rpm) > 1 else f"at {whole(rpm[0])} rpm"
    text = f"The first frequency is {span(min(first), max(first), 5)} Hz {speeds}."
    accuracy = remarks.sentence(results)
    alone = f"The {remarks.carrier(results)} alone"
    verdict = alone if remarks.met(results) else f"{alone}, less accurate than requested"
    if (torn := remarks.torn_from(results)) is not None:
        verdict += f"; it cannot turn {torn}"
    return Answer(verdict, (text,) if accuracy is None else (text, accuracy))
