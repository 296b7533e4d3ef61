"""The answer in a few words: does it damp, how much, up to what load."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from workflows.findings import limits, remarks
from workflows.findings.limits import AIR, Grade, in_g
from workflows.findings.remarks import as_it_moves, at_load, at_speed, capital, millimetres, percent, stretch, tilt
from workflows.formatting import span, whole
from workflows.scene import paper
from workflows.solve.results import Results, SpeedPoint

if TYPE_CHECKING:
    from workflows.solve.results import OwnFigures


_BELOW = 0.8
"""Part of the amplitude that sets a ball off below which it is worth a word that it goes on."""

_ROLLS = 5 / 7
"""Displacement of a free rolling ball in its cavity over that of the floor."""

_KNOWN = 0.05
"""Relative error of a peak that is worth a word."""


def known_within(point: SpeedPoint) -> str:
    """How well a best figure is known, where it is not known well."""
    error = 0.0 if point.working is None else point.working.error
    return f" (known within {percent(min(error, 1.0))} %)" if error > _KNOWN else ""


def between(results: Results, points: list[SpeedPoint]) -> str | None:
    """Between what amplitudes the ball does half of its best, at the lowest load at which it can and at the highest."""
    limit = limits.endured(results) or math.inf
    known = [(p, w) for p in points if limits.best(results, p) is not None and (w := p.working) is not None]
    working = [(p, w) for p, w in known if w.half[0] < limit]
    if not working:
        return None
    ends = [working[0]] if len(working) == 1 else [working[0], working[-1]]
    ranges = []
    for point, figures in ends:
        low, high = figures.half[0], min(figures.half[1], limit)
        loads = [in_g(results, point.reduced, value) for value in (low, high) if point.reduced and point.load_g]
        said = f" ({whole(loads[0])} to {whole(loads[1])} g)" if loads else ""
        ends_there = ", all that the plate endures" if high < figures.half[1] else ""
        ranges.append(f"{at_load(point)} at amplitudes of {span(1e3 * low, 1e3 * high)} mm{said}{ends_there}")
    held = [
        f"{at_load(p)} below {millimetres(w.cutoff)} mm{_goes_on(results, p, w.cutoff)}"
        for p, w in ends
        if w.cutoff > 0
    ]
    rests = f" The load holds it at rest {', '.join(held)}." if held else ""
    return f"At least half of its best is left {', '.join(ranges)}.{_at_rest(results, ends)}{rests}"


def _goes_on(results: Results, point: SpeedPoint, cutoff: float) -> str:
    """Down to where a ball in motion goes on, far below what sets it off, as one in a hollow floor may."""
    if point.level is not None or point.damping is None or not point.damping.cutoff_g or point.reduced is None:
        return ""
    last = point.damping.cutoff_g / in_g(results, point.reduced, 1.0)
    return f" (one in motion goes on down to {millimetres(last)} mm)" if last < _BELOW * cutoff else ""


def reach_of(results: Results, points: list[SpeedPoint]) -> str | None:
    """From what load on the ball is out of reach of what the plate endures."""
    limit = limits.endured(results)
    lost = [(p, w) for p in points if limits.best(results, p) is None and (w := p.working) is not None]
    lost = [(p, w) for p, w in lost if w.peak > 0]
    if limit is None or not lost:
        return None
    point, figures = lost[0]
    said = at_load(point)
    return (
        f"{capital(said)} it takes {millimetres(figures.cutoff)} mm to set the ball rolling, but more than"
        f" {millimetres(limit)} mm would {limits.beyond(results)}: there the damper is out of reach."
    )


def _at_rest(results: Results, ends: list[tuple[SpeedPoint, OwnFigures]]) -> str:
    """Up to where a ball at rest in the middle meets no wall, where one that bounces goes on doing so below that.

    As the vibration grows, a ball that rolls freely goes by 5/7 of the floor's way.
    """
    damper = results.scene.damper
    if damper is None or damper.floor_radius is not None:
        return ""
    gap = damper.cavity[0] / 2 - damper.radius
    wakes = [(p, w, gap / (_ROLLS * abs(1 - p.tilt_share))) for p, w in ends if p.tilt_share != 1]
    said = [f"{at_load(p)} below {millimetres(a)} mm" for p, w, a in wakes if w.half[0] < _BELOW * a]
    if not said:
        return ""
    walls = f"as the vibration grows, one at rest meets no wall {', '.join(said)}"
    return f" That is a ball that bounces: {walls}, and takes less."


Graded = tuple[SpeedPoint, Grade]

WEIGHT = "the ball's weight, which is left out, is more than the load"


def held_back(grades: Sequence[Graded]) -> list[SpeedPoint]:
    """The points that a verdict can be given on."""
    return [point for point, grade in grades if grade is not Grade.UNKNOWN]


def none(results: Results, grades: Sequence[Graded]) -> str:
    """The verdict where there is none at any of the points: why; and where, if there are several reasons."""
    reasons, torn = _reasons(results, grades), limits.torn_from(results)
    if torn is None and len(reasons) == 1:
        return f"No verdict: {reasons[0][1]}"
    return f"No verdict {'; none '.join(_placed(reasons, grades, torn))}"


def beside(results: Results, grades: Sequence[Graded], verdict: str) -> str:
    """A verdict with what it rests on, and with the speeds that it does not speak of."""
    unsaid = _placed(_reasons(results, grades), grades, limits.torn_from(results))
    return "; no verdict ".join([f"{verdict}{_gripped(results, grades)}", *unsaid])


def _placed(reasons: list[tuple[list[SpeedPoint], str]], grades: Sequence[Graded], torn: str | None) -> list[str]:
    points = [point for point, _ in grades]
    placed = [f"{stretch(those, points)}: there {why}" for those, why in reasons]
    return placed if torn is None else [*placed, torn]


def _reasons(results: Results, grades: Sequence[Graded]) -> list[tuple[list[SpeedPoint], str]]:
    """Which of the points have no verdict and why, but for those at which the plate would tear."""
    found = [p for p, grade in grades if grade is Grade.UNKNOWN and not limits.torn(results, p)]
    light, sliding = [p for p in found if limits.weighs(p)], [p for p in found if not limits.weighs(p)]
    reasons = [(light, WEIGHT)] if light else []
    if sliding:
        takes = f"a friction of {_grips(results, sliding)} at the amplitude of its best"
        reasons.append((sliding, f"the ball would slide, for to roll takes {takes}"))
    return reasons


def _gripped(results: Results, grades: Sequence[Graded]) -> str:
    """What a verdict rests on where the ball rolls only on a floor that grips better than the walls."""
    damper = results.scene.damper
    if damper is None:
        return ""
    better = [p for p in held_back(grades) if _grip(results, p) > damper.friction]
    if not better:
        return ""
    return (
        ", if the ball rolls without slip, which at the amplitude of its best takes a friction of"
        f" {_grips(results, better)} {stretch(better, [p for p, _ in grades])}: {damper.friction:g} is given for the"
        " walls"
    )


def _grips(results: Results, points: Sequence[SpeedPoint]) -> str:
    """The least and the most friction that rolling takes at the points."""
    each = [_grip(results, point) for point in points]
    return span(min(each), max(each))


def _grip(results: Results, point: SpeedPoint) -> float:
    found = limits.best(results, point)
    return 0.0 if found is None else limits.grip(results, point, found.amplitude)


_NEAR = 0.1
"""Relative difference of cut-offs that are called reproduced; a cycle at ζ = 0.01 resolves 6 %."""

_STEPS_AT_MOST = 3
"""Grades that a verdict names one after the other with rising load; more are not told apart."""

_WORDS = {Grade.YES: "yes", Grade.MODESTLY: "modestly", Grade.HARDLY: "hardly", Grade.NO: "not"}


@dataclass(frozen=True)
class Answer:
    """A verdict, and the sentences that carry it."""

    verdict: str
    sentences: tuple[str, ...]


def answer(results: Results) -> Answer:
    """What the run found, most important first.

    It speaks of the damper's own figures, which no release and no damping of the structure has a part in.
    """
    points = sorted((p for p in results.speeds if p.working is not None), key=lambda p: p.load_g)
    if not points:
        return _plate_only(results)
    loaded = [p for p in points if p.load_g > 0] or points
    refused = limits.refused(results)
    grades = [(p, limits.grade(results, p)) for p in loaded]
    held = held_back(grades)
    if not held and refused is None:
        return Answer(none(results, grades), ())
    speaking = held or loaded
    if refused is None and all(grade in (Grade.NO, Grade.UNKNOWN) for _, grade in grades):
        verdict, sentences = _why_not(results, speaking)
        return Answer(beside(results, grades, verdict), sentences)
    dense = limits.too_dense(results)
    parts = (
        None if dense is None else dense[1],
        _fed(points),
        _how_much(results, speaking, "turning, " if len(loaded) < len(points) else ""),
        between(results, speaking),
        reach_of(results, speaking),
        tilt(results, speaking),
        _beside_the_paper(results),
        None if remarks.met(results) and limits.sentence(results) is None else remarks.sentence(results),
    )
    verdict = beside(results, grades, _verdict(grades)) if refused is None else f"No verdict: {refused}"
    return Answer(verdict, tuple(part for part in parts if part))


def first_frequency(point: SpeedPoint) -> float | None:
    """The first bending frequency [Hz]: of the plate without the ball, or else the one given, with the ball stuck."""
    if point.modes:
        bending = [mode.frequency_hz for mode in point.modes if mode.family == "flap"]
        return bending[0] if bending else None
    return point.reduced.f1_hz if point.reduced is not None else None


def _verdict(grades: list[tuple[SpeedPoint, Grade]]) -> str:
    """One word for all loads, or a word for each stretch of them: yes up to these, hardly from those on."""
    stretches = [(grade, [p for p, _ in run]) for grade, run in groupby(grades, key=lambda pair: pair[1])]
    known = [k for k, (grade, _) in enumerate(stretches) if grade is not Grade.UNKNOWN]
    if len(stretches) == 1:
        return _WORDS[stretches[0][0]].capitalize()
    if len(known) > _STEPS_AT_MOST:
        return f"{_WORDS[max(grade for _, grade in grades)].capitalize()} at best"
    words = []
    for k in known:
        grade, run = stretches[k]
        first, last = at_speed(run[0]), at_speed(run[-1])
        if k == 0:
            where = f"up to {last}"
        elif k == known[-1]:
            where = f"from {first} on"
        else:
            where = f"up to {last}" if k - 1 in known else f"from {first} to {last}"
        words.append(f"{_WORDS[grade]} {where}")
    return capital(", ".join(words))


def _how_much(results: Results, points: list[SpeedPoint], turning: str) -> str | None:
    """The best and the least; `turning` where there is a speed without a load, which is not among the points."""
    found = [(b, p) for p in points if (b := limits.best(results, p)) is not None]
    if not found:
        return None
    top, at = max(found, key=lambda pair: pair[0].damping_ratio)
    share = -math.expm1(-4 * math.pi * top.damping_ratio)
    text = (
        f"At its best, {turning}at {at_speed(at)} and an amplitude of {millimetres(top.amplitude)} mm, the ball damps"
        f" like a damping ratio of {percent(top.damping_ratio)} %{known_within(at)}: it takes"
        f" {percent(share)} % of the vibration's energy in a cycle."
    )
    least, there = min(found, key=lambda pair: pair[0].damping_ratio)
    if there is not at and least.damping_ratio < 0.9 * top.damping_ratio:
        within = ", within what the plate endures," if least.limited else ""
        said = f"{at_load(there)}{within} it comes to {percent(least.damping_ratio)} % at best."
        text += f" {capital(said)}"
    return f"{text} The air alone gives turbine blades {percent(AIR[0])} to {percent(AIR[1])} %."


def _fed(points: list[SpeedPoint]) -> str | None:
    """Equations that do not conserve energy may drive the vibration instead of damping it."""
    fed = [
        (w.amplitude[w.damping_ratio < -1e-3 * w.peak].min(), p)
        for p in points
        if (w := p.working) is not None and (w.damping_ratio < -1e-3 * w.peak).any()
    ]
    if not fed:
        return None
    amplitude, point = min(fed, key=lambda pair: pair[1].load_g)
    said = at_load(point)
    return (
        f"{capital(said)} and above {millimetres(amplitude)} mm they drive the vibration instead of"
        " damping it, which no ball can do."
    )


def _why_not(results: Results, points: list[SpeedPoint]) -> tuple[str, tuple[str, ...]]:
    """Why the damper does nothing at any speed."""
    damper = results.scene.damper
    if damper is not None and damper.cavity[0] <= 2 * damper.radius * (1 + 1e-9):
        return "No: the ball never moves", ("The ball fills its cavity along the bending direction.",)
    low = points[0]
    figures = low.working
    if figures is None or math.isinf(figures.cutoff):
        return "No: the ball never moves", (
            f"{as_it_moves(results)}, the cavity's floor tilts, and {at_load(low)} the load pulls the ball"
            " down the slope by as much as the vibration drives it up.",
        )
    if figures.peak > 0 and (reach := reach_of(results, points)) is not None:
        return "No: the ball never moves", tuple(part for part in (reach, tilt(results, points)) if part)
    if damper is not None and damper.restitution == 1 and all(p.working and p.working.cutoff == 0 for p in points):
        along = "Along the bending direction it" if damper.friction else "It"
        return "No: the ball takes nothing", (
            f"{along} neither rolls against a resistance nor loses speed at the walls.",
        )
    known = f", from {millimetres(figures.cutoff)} mm on," if figures.cutoff > 0 else ","
    said = (
        f"{at_load(low).capitalize()} no damping by the ball was found at any of the amplitudes searched{known}"
        " which does not tell that there is none."
    )
    return "Not found: whether the ball damps", tuple(part for part in (said, tilt(results, points)) if part)


def _beside_the_paper(results: Results) -> str | None:
    rows = [(row, p) for p in results.speeds if (row := paper.row(results.scene, p.load_g)) is not None]
    if not rows:
        return None
    low, high = (round(100 * value) for value in paper.SDC_RANGE)
    text = f"The paper reports losses of {low} to {high} % in a cycle for this plate. "
    if results.scene.damper is not None and results.scene.damper.formulation == "consistent":
        text += "The ball cannot do that: a bound on its work in this cavity rules it out."
    else:
        text += "The ball does not do that, even by the equations as printed."
    tilts = results.effects["floor_tilt"].on
    off = [(abs(p.damping.cutoff_g / row.cutoff - 1), p.load_g) for row, p in rows if p.damping and p.damping.cutoff_g]
    near = [pair for pair in off if pair[0] <= _NEAR]
    if near and not tilts:
        loads = [load for _, load in near]
        text += (
            f" Its cut-offs, for a floor that does not tilt, are reproduced to {100 * max(near)[0]:.0f} % at"
            f" {len(near)} of {len(rows)} loads"
        )
        text += "." if len(near) == len(rows) else f" ({span(min(loads), max(loads), 5)} g)."
    return text


def _plate_only(results: Results) -> Answer:
    first = [p.modes[0].frequency_hz for p in results.speeds if p.modes]
    if not first:
        return Answer("Nothing was solved", ())
    rpm = [p.rpm for p in results.speeds]
    speeds = f"{whole(min(rpm))} and {whole(max(rpm))} rpm"
    text = f"The first frequency is {span(min(first), max(first), 5)} Hz between {speeds}."
    said = remarks.sentence(results)
    verdict = "The plate alone" if remarks.met(results) else "The plate alone, less exact than asked for"
    if (torn := limits.torn_from(results)) is not None:
        verdict += f"; it cannot turn {torn}"
    return Answer(verdict, (text,) if said is None else (text, said))
