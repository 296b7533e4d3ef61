"""The answer in a few words: does it damp, how much, up to what load."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby

from workflows.findings import amplitudes, doubt, missing, possible, trust, worth
from workflows.findings.of_the_floor import as_it_moves, tilt
from workflows.findings.said import at_load, at_speed, capital, millimetres, percent
from workflows.findings.worth import AIR, Grade
from workflows.scene import paper
from workflows.solve.records import Results, SpeedPoint
from workflows.wording import span, whole

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
    refused = possible.refused(results)
    grades = [(p, worth.grade(results, p)) for p in loaded]
    held = doubt.held(grades)
    if not held and refused is None:
        return Answer(doubt.none(results, grades), ())
    speaking = held or loaded
    if refused is None and all(grade in (Grade.NO, Grade.UNKNOWN) for _, grade in grades):
        verdict, sentences = _why_not(results, speaking)
        return Answer(doubt.beside(results, grades, verdict), sentences)
    dense = possible.too_dense(results)
    parts = (
        None if dense is None else dense[1],
        _fed(points),
        _how_much(results, speaking, "turning, " if len(loaded) < len(points) else ""),
        amplitudes.between(results, speaking),
        amplitudes.reach(results, speaking),
        tilt(results, speaking),
        _beside_the_paper(results),
        None if trust.met(results) and missing.sentence(results) is None else trust.sentence(results),
    )
    verdict = doubt.beside(results, grades, _verdict(grades)) if refused is None else f"No verdict: {refused}"
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
    found = [(b, p) for p in points if (b := worth.best(results, p)) is not None]
    if not found:
        return None
    top, at = max(found, key=lambda pair: pair[0].damping_ratio)
    share = -math.expm1(-4 * math.pi * top.damping_ratio)
    text = (
        f"At its best, {turning}at {at_speed(at)} and an amplitude of {millimetres(top.amplitude)} mm, the ball damps"
        f" like a damping ratio of {percent(top.damping_ratio)} %{amplitudes.known_within(at)}: it takes"
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
    if figures.peak > 0 and (reach := amplitudes.reach(results, points)) is not None:
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
    said = trust.sentence(results)
    verdict = "The plate alone" if trust.met(results) else "The plate alone, less exact than asked for"
    if (torn := possible.torn_from(results)) is not None:
        verdict += f"; it cannot turn {torn}"
    return Answer(verdict, (text,) if said is None else (text, said))
