"""The verdict: does it damp, how much, up to what load; its sentences are texts of `templates/answer.toml`."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from workflows.formatting import apart, revolutions, turning
from workflows.report import remarks
from workflows.report.remarks import as_it_moves, phrase, said, tilt
from workflows.report.templates import capital, in_percent, stretch
from workflows.solve import engine_orders, limits, remedies
from workflows.solve.excitation import HELPS, refused
from workflows.solve.results import Figures, Grade, OwnFigures, Reason, Results, SpeedPoint, VibrationReduction

_BELOW = 0.8
"""Part of the amplitude that sets a ball off below which it is worth a word that it goes on."""

_UNSURE = 0.1
"""Relative error of the first frequency that is worth a word in the headline."""

_HEAVY = 0.1
"""Weight of a ball over what drives it at the amplitude of largest damping that is worth one."""


def between(results: Results, points: list[SpeedPoint]) -> list[str]:
    """Between what amplitudes the ball does half of its best, at the lowest load at which it can and at the highest."""
    able = [
        (point, figures, best.useful)
        for point in points
        if (best := limits.best(results, point)) is not None and (figures := point.damping_curve) is not None
    ]
    able = [each for each in able if not math.isnan(each[2][0])]
    ranges, held = dict[str, list[SpeedPoint]](), dict[str, list[SpeedPoint]]()
    for point, figures, (low, high) in able[:1] + able[1:][-1:]:
        limit = limits.endured(results, point.omega)
        limited, error = high < figures.half[1], figures.half_error
        around = low / (1 + error), high * (1 + error)  # within the error of this range
        apart = [each for each in humps(figures) if each[1] < around[0] or around[1] < each[0] < limit]
        others = [(begin, min(end, limit)) for begin, end in apart]
        g = limits.in_g(results, point, 1.0) if point.reduced and point.load_g else None
        of = {"of": sorted([*others, (low, high)]), "g": g, "limited": limited, "error": error}
        of["by_deflection"] = limits.deflection_governs(results, point.omega)
        ranges.setdefault(phrase("answer/range", results, **of), []).append(point)
        if figures.cutoff > 0:
            last = goes_on(results, point, figures.cutoff)
            of = {"cutoff": figures.cutoff, "last": last, "sooner": figures.driven_from is not None}
            held.setdefault(phrase("answer/held", results, **of), []).append(point)
    return said("answer/between", results, ranges=ranges, held=held)


def humps(figures: Figures) -> list[tuple[float, float]]:
    """All ranges of amplitudes over several points of the curve in which the damping is at least half its peak."""
    enough = np.concatenate([[False], figures.damping_ratio >= figures.peak / 2, [False]])
    begins, ends = np.flatnonzero(enough[1:] & ~enough[:-1]), np.flatnonzero(enough[:-1] & ~enough[1:]) - 1
    return [
        (float(figures.amplitude[b]), float(figures.amplitude[e])) for b, e in zip(begins, ends, strict=True) if b < e
    ]


def goes_on(results: Results, point: SpeedPoint, cutoff: float) -> float | None:
    """Down to where a ball in motion goes on [m], far below what sets it off, as one in a hollow floor may.

    By the ring-down: only where the ball still moves after a cycle below what sets it off. Near critical damping the
    structure comes to rest within the cycle in which a ball that it has thrown rolls on.
    """
    if point.level is not None or point.damper is None or not point.damper.cutoff_g or point.reduced is None:
        return None
    last = point.damper.cutoff_g / limits.in_g(results, point, 1.0)
    kept = math.sqrt(1 - point.damper.intrinsic_sdc)  # of the amplitude, from cycle to cycle, by the structure alone
    return last if last < min(_BELOW, kept) * cutoff else None


def reach_of(results: Results, points: list[SpeedPoint]) -> str | None:
    """From what load on the ball is out of reach of what the plate endures."""
    known = [(p, w) for p in points if limits.best(results, p) is None and (w := p.damping_curve) is not None]
    lost = [
        (p, w.cutoff, limit) for p, w in known if w.cutoff >= (limit := limits.endured(results, p.omega)) < math.inf
    ]
    if not lost:
        return None
    named = what_to_do(results, points) is not None  # which names both amplitudes
    point, cutoff, limit = lost[0]
    beyond = remarks.beyond_of(results, point.omega)
    return phrase("answer/reach_of", results, point=point, cutoff=cutoff, beyond=beyond, named=named, limit=limit)


def what_to_do(results: Results, points: Sequence[SpeedPoint]) -> str | None:
    """What would move the ball at the lowest load that holds it at all that the plate endures."""
    locked = [p for p in points if p.verdict is not None and p.verdict.reason == Reason.OUT_OF_REACH]
    if not locked or limits.endured(results) == math.inf or results.scene.damper is None:
        return None
    point = min(locked, key=lambda each: each.load_g)
    remedy = remedies.what_moves(results, point)
    if remedy is None:
        return None
    known = {name: value for name, value in remedy._asdict().items() if not math.isnan(value)}
    last, own = goes_on(results, point, remedy.amplitude), point.damping_curve
    others = own.cutoff if own is not None and own.driven_from is not None else None
    limit = limits.endured(results, point.omega)
    return phrase("answer/what_to_do", results, point=point, remedy=known, last=last, others=others, limit=limit)


def way_down(results: Results, points: list[SpeedPoint]) -> list[str]:
    """That a ball in motion does more than one at rest does as the vibration grows, where it does most."""
    target = results.scene.accuracy.damping
    parted = [
        (most, p, w.folds)
        for p in points
        if (w := p.damping_curve) is not None
        and _rank(p) != 0
        and w.ways_differ
        and (most := _most_bouncing(w)) > (1 + target) * w.peak > 0
    ]
    if not parted:
        return []
    most, point, (stops, rolls) = max(parted, key=lambda each: each[0])
    return said("answer/way_down", results, point=point, rolls=rolls, stops=stops, most=most)


def _most_bouncing(figures: OwnFigures) -> float:
    """The largest damping ratio of a falling vibration while the ball bounces; below, it rolls."""
    above = figures.from_above
    bounces = above.amplitude >= figures.folds[0]
    return float(above.damping_ratio[bounces].max()) if bounces.any() else above.peak


def _rank(point: SpeedPoint) -> int:
    return -1 if point.verdict is None else point.verdict.rank


def _unjudged(results: Results, points: Sequence[SpeedPoint]) -> list[str]:
    """Where there is no verdict, and why, a clause for each reason."""
    clauses = []
    for reason in (Reason.WEIGHT, Reason.SLIP, Reason.CONTACT, Reason.SIDEWAYS):
        those = [p for p in points if p.verdict and p.verdict.reason == reason]
        if those:
            where = "" if len(those) == len(points) else f" {stretch(those, points)}"
            of = {"reason": reason, "those": those, "frictions": [_friction(results, point) for point in those]}
            flows = reason == Reason.CONTACT
            why = remarks.flows(results, those) if flows else phrase("answer/outside", results, **of)
            clauses.append(f"no verdict{where}: {'there ' if where else ''}{why}")
    torn = remarks.torn_from(results)
    return clauses if torn is None else [*clauses, f"no verdict {torn}"]


def _rests_on(results: Results, points: Sequence[SpeedPoint]) -> str:
    """What a verdict rests on where the ball rolls only on a floor that grips better than the walls."""
    damper = results.scene.damper
    better = [p for p in points if damper and _rank(p) >= 0 and _friction(results, p) > damper.friction]
    frictions = [_friction(results, point) for point in better]
    return phrase("answer/rests_on", results, frictions=frictions, better=better, points=points) if better else ""


def _friction(results: Results, point: SpeedPoint) -> float:
    best = limits.best(results, point)
    return 0.0 if best is None else limits.friction_demand(results, point, best.amplitude)


_STEPS_AT_MOST = 3
"""Grades that a verdict names one after the other with rising load; more are not told apart."""

_WORDS = ("", "not useful", "of little use", "useful")
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
    leading: int = 0

    @property
    def lead(self) -> tuple[str, ...]:
        """What stands before the first table: all on engine orders."""
        return self.sentences[: max(self.leading, _LEAD)]

    @property
    def details(self) -> tuple[str, ...]:
        """What stands below."""
        return self.sentences[max(self.leading, _LEAD) :]

    def besides(self, notes: Sequence[str]) -> list[str]:
        """Remarks without the sentences that the answer has already."""
        for sentence in self.sentences:
            notes = [note.replace(sentence, "").strip() for note in notes]
        return [note for note in notes if note]


def answer(results: Results) -> Answer:
    """What the run found, most important first: under the scene's engine orders, where it has some, then by itself."""
    (main, *clauses), sentences = _alone(results)
    orders, unsure = _orders(results), _unsure(results)
    if not orders or all(each.reason for each in results.reductions):
        return Answer("; ".join([main, *clauses, *unsure]), (*map(" ".join, orders), *sentences), len(orders))
    (first, *rest), *others = orders
    alike = "; ".join([f"{main[0].lower()}{main[1:]}".replace(": ", ", ", 1), *clauses])
    told = [each for each in results.reductions if not each.reason]
    rough = [f"{each.order} ({turning(each.omega)})" for each in told if each.loose]
    heavy = any(map(limits.is_heavy, results.speeds))
    estimated = phrase("answer/estimated", results, rough=rough, all=len(rough) == len(told), heavy=heavy)
    crossings = [" ".join(each) for each in (rest, *others) if each]
    speeds = revolutions([p.omega for p in results.speeds if p.load_g > 0] or [p.omega for p in results.speeds])
    by_itself = f"Compared with the damping by air alone, at {speeds}: {alike}."
    leading = (*crossings, estimated)
    return Answer("; ".join([first.removesuffix("."), *unsure]), (*leading, by_itself, *sentences), len(leading))


def _alone(results: Results) -> tuple[list[str], tuple[str, ...]]:
    """The damper's own figures, in which release and damping of the structure have no part: clauses and sentences."""
    points = sorted((p for p in results.speeds if p.damping_curve is not None), key=lambda p: p.load_g)
    if not points:
        return _plate_only(results)
    loaded = [p for p in points if p.load_g > 0] or points
    judged, unjudged = [p for p in loaded if _rank(p) >= 0], _unjudged(results, loaded)
    dense = remarks.too_dense(results)
    refused = phrase("answer/printed", results) if results.scene.is_printed else None if dense is None else dense[0]
    if not judged and refused is None:
        return [capital(unjudged[0]), *unjudged[1:]], ()
    speaking = judged or loaded
    if refused is None and all(_rank(p) == 0 for p in judged):
        verdict, *sentences = _why_not(results, speaking)
        return [verdict, *unjudged], tuple(sentences)
    way_out, works = what_to_do(results, speaking), max(map(_rank, speaking)) >= _WORKS
    parts = (
        None if dense is None else dense[1],
        None if works else way_out,
        _fed(results, points),
        *_how_much(results, speaking, turning=len(loaded) < len(points)),
        *between(results, speaking),
        *way_down(results, speaking),
        remarks.unknown_floor(results),
        way_out if works else None,
        reach_of(results, speaking),
        tilt(results, speaking),
        None if remarks.met(results) else remarks.sentence(results),
    )
    clauses = [f"No verdict: {refused}"] if refused is not None else [*_verdict(results, loaded), *unjudged]
    rough = [p for p in judged if p.damping_curve is not None and p.damping_curve.error > remarks.ROUGH]
    if refused is None and rough:
        where = "" if len(rough) == len(judged) > 1 else f"{stretch(rough, judged)} "
        clauses.append(f"{where}the damping is known only roughly")
    return clauses, tuple(part for part in parts if part)


def _unsure(results: Results) -> list[str]:
    """That the cavity has to fit, that the ball's weight is not small, that frequencies are known only roughly."""
    known = any(_rank(point) >= 0 for point in results.speeds) or any(not each.reason for each in results.reductions)
    fit = remarks.misfit(results.scene, results.speeds) if known else []
    share = max((limits.weight_share(results, p) for p in results.speeds if _rank(p) > 0), default=0.0)
    fit += [phrase("answer/weighs", results, share=share)] if share > _HEAVY else []
    parts = [mode.error_parts for point in results.speeds for mode in point.modes[:1]]
    error = max((each.at_least for each in parts if each is not None), default=0.0)
    return [*fit, f"the first frequency is known only to {in_percent(error)} %"] if error > _UNSURE else fit


def first_frequency(point: SpeedPoint) -> float | None:
    """Of the mode the damper follows [Hz]: without the ball, or where it is given, with the ball stuck."""
    if (followed := point.followed) is not None:
        return point.modes[followed].frequency_hz
    if point.reduced is None:
        return None
    return point.reduced.f2_hz if point.modes else point.reduced.f1_hz


def followed_mode(results: Results) -> str:
    """What a legend calls the mode the damper follows; "mode followed" where that is another with the speed."""
    names = engine_orders.labels(results.speeds)
    every = {None if (k := p.followed) is None else names[p.modes[k].branch] for p in results.speeds}
    return next((name for name in every if name is not None and len(every) == 1), "mode followed")


def _verdict(results: Results, points: list[SpeedPoint]) -> list[str]:
    """How useful the damper is over the loads, by stretches of them, and on what that rests; where it is locked."""
    stretches = [(rank, list(run)) for rank, run in groupby(points, key=_rank)]
    known = [(rank, run) for rank, run in stretches if rank > 0]
    most = max(map(_rank, points))
    if most < len(_WORDS) - 1:
        best, at = max(_bests(results, [p for p in points if _rank(p) > 0]), key=lambda pair: pair[0].damping_ratio)
        main = f"{_WORDS[most]}: {phrase('answer/how_little', results, most=best.damping_ratio, at=at)}"
    elif len(stretches) == 1:
        main = _WORDS[most]
    elif len(known) > _STEPS_AT_MOST:
        main = f"{_WORDS[most]} at some speeds"
    else:
        main = ", ".join(f"{_WORDS[rank]} {stretch(run, points)}" for rank, run in known)
    nothing = [point for point in points if _rank(point) == 0]
    locked = [point for point in nothing if point.verdict and point.verdict.grade == Grade.LOCKED]
    idle = [point for point in nothing if point not in locked]
    alone = [phrase("answer/locked", results, locked=locked, points=points)] if locked else []
    found = [phrase("answer/idle", results, idle=idle, points=points)] if idle else []
    return [capital(main) + _rests_on(results, points), *alone, *found]


def _bests(results: Results, points: Sequence[SpeedPoint]) -> list[tuple[limits.Best, SpeedPoint]]:
    """The most that the damper does at the points at which it does anything."""
    return [(best, p) for p in points if (best := limits.best(results, p)) is not None]


def _how_much(results: Results, points: list[SpeedPoint], *, turning: bool) -> list[str]:
    """The best and the least; `turning`: there is a speed without a load, which is not among the points."""
    ratios = _bests(results, points)
    if not ratios:
        return []
    top, at = max(ratios, key=lambda pair: pair[0].damping_ratio)
    least, there = min(ratios, key=lambda pair: pair[0].damping_ratio)
    error = 0.0 if at.damping_curve is None else at.damping_curve.error
    less = there is not at and least.damping_ratio < 0.9 * top.damping_ratio
    more = {"least": least if less else None, "there": there, "error": error, "turning": turning}
    more["by_deflection"] = limits.deflection_governs(results, there.omega)
    return said("answer/how_much", results, top=top, at=at, **more)


def _fed(results: Results, points: list[SpeedPoint]) -> str | None:
    """Equations that do not conserve energy may drive the vibration instead of damping it."""
    fed = [
        (w.amplitude[w.damping_ratio < -1e-3 * w.peak].min(), p)
        for p in points
        if (w := p.damping_curve) is not None and (w.damping_ratio < -1e-3 * w.peak).any()
    ]
    if not fed:
        return None
    amplitude, point = min(fed, key=lambda pair: pair[1].load_g)
    return phrase("answer/fed", results, amplitude=float(amplitude), point=point)


def _why_not(results: Results, points: list[SpeedPoint]) -> list[str]:
    """That the damper does nothing at any speed, and why, by what limits it at the lowest load."""
    low, slope = points[0], tilt(results, points)
    reasons = [point.verdict.reason for point in points if point.verdict is not None]
    reason = str(reasons[0])
    if reason == Reason.LOSSLESS and any(each != reason for each in reasons):
        reason = str(Reason.NOT_FOUND)
    cutoff = 0.0 if low.damping_curve is None else low.damping_curve.cutoff
    known = {"cutoff": cutoff, "limit": limits.endured(results, low.omega), "begin": as_it_moves(results)}
    parts = said("answer/why_not", results, reason=reason, low=low, **known)
    more = (what_to_do(results, points), reach_of(results, points)) if reason == Reason.OUT_OF_REACH else ()
    slope = slope if reason in (Reason.OUT_OF_REACH, Reason.NOT_FOUND) else None
    return [*parts, *(part for part in (*more, slope) if part)]


def of_orders(results: Results) -> list[str]:
    """What the ball does at each order of [excitation] and mode that it meets, where it does most first."""
    return [" ".join(sentences) for sentences in _orders(results)]


def _orders(results: Results) -> list[list[str]]:
    """The same, sentence by sentence."""
    excitation = results.scene.excitation
    if excitation is None or results.scene.damper is None or not results.speeds:
        return []
    if not results.reductions and (reason := refused(results)) is not None:
        return [said("answer/refused_orders", results, orders=excitation.orders, reason=reason)]
    every = sorted(results.reductions, key=_usefulness)
    met = [_of_order(results, each, excitation.unit) for each in every]
    unmet = sorted(set(excitation.orders) - {each.order for each in every})
    if unmet and len(results.speeds) == 1:
        return [*met, said("answer/one_speed", results)]
    for order in unmet:
        first = engine_orders.crossing_beyond(results.speeds, order)
        error = 0.0 if first is None else engine_orders.reached_within_error(results.speeds, first)
        met.append(said("answer/unmet", results, order=order, points=results.speeds, first=first, error=error))
    return met


def _usefulness(reduction: VibrationReduction) -> tuple[bool, bool, float, int]:
    """What crossings are sorted by, the most useful first."""
    return not math.isfinite(reduction.range[0]), bool(reduction.reason), reduction.ratio, reduction.order


def _of_order(results: Results, reduction: VibrationReduction, unit: str) -> list[str]:
    """What the ball does at a crossing: by how much, at which levels, and why not at the others; by sentences."""
    borne = [each for each in reduction.levels if each.endured]
    overload = [each.level for each in reduction.levels if not each.endured]
    known = {
        "it": reduction,
        "unit": unit,
        "overload": overload,
        "deflection": limits.deflection_governs(results, reduction.omega),
    }
    if reduction.reason or not math.isfinite(reduction.range[0]):
        held = not reduction.reason and reduction.moves_from >= reduction.endured_level
        friction = remedies.friction_that_moves(results, reduction) if held else math.nan
        held |= bool(reduction.detail and borne) and reduction.moves_from > max(each.level for each in borne)
        return said("answer/no_order", results, held=held, friction=friction, **known)
    low, high = reduction.range
    most = 1 - reduction.ratio
    outside = [each for each in borne if each.level >= reduction.moves_from and not low <= each.level <= high]
    few = 2 if reduction.loose and not reduction.detail else 3
    digits = [max((apart(end, each.level, few) for each in outside), default=few) for end in reduction.range]
    # a rough estimate does not tell levels of little use apart
    told = [each for each in borne if not reduction.loose or 1 - each.ratio >= most / 4]
    helped = any(each.level >= reduction.moves_from and each.ratio <= HELPS for each in borne)
    return said(
        "answer/order",
        results,
        most=most,
        idle=[] if helped else [each.level for each in reduction.levels],
        leans=any(any(point.lean) for point in results.speeds),
        at_rest=[each.level for each in borne if each.level < reduction.moves_from],
        useless=[each.level for each in outside if each.ratio >= 1 and not reduction.loose],
        others=[
            e for e in told if helped and e.level >= reduction.moves_from and e.level != reduction.level and e.ratio < 1
        ],
        digits=digits,
        **known,
    )


def _plate_only(results: Results) -> tuple[list[str], tuple[str, ...]]:
    known = {"met": remarks.met(results), "torn": remarks.torn_from(results), "points": results.speeds}
    first = [p.modes[0].frequency_hz for p in results.speeds if p.modes]
    verdict, *sentences = said("answer/plate_only", results, first=first, **known)
    accuracy = remarks.sentence(results)
    return [verdict], (*sentences, *([] if accuracy is None else [accuracy]))
