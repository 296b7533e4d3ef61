"""The answer in a few words: does it damp, how much, up to what load."""

from __future__ import annotations

import math
from dataclasses import dataclass

from workflows import paper
from workflows.records import Results, SpeedPoint
from workflows.wording import significant, span

STRONG, MODEST = 1e-2, 1e-3
"""Damping ratios: what the ball adds is called strong above the one and modest above the other."""


@dataclass(frozen=True)
class Answer:
    """A verdict, and the sentences that carry it."""

    verdict: str
    sentences: tuple[str, ...]


def ball_capacity(point: SpeedPoint) -> float | None:
    """Share of the energy that the ball takes in a cycle, averaged by energy over the cycles in which it moved.

    From the energy books, so that the structure's own damping has no part in it.
    """
    damping, reduced = point.damping, point.reduced
    if damping is None or reduced is None:
        return None
    moving = damping.amplitude_g >= (damping.cutoff_g or 0.0) * (1 - 1e-12)
    energy = 0.5 * reduced.M1 * float((damping.peak_velocity[moving] ** 2).sum())
    taken = damping.energy.rolling + damping.energy.impact + damping.energy.slip
    return taken / energy if energy > 0 else None


def equivalent_ratio(capacity: float) -> float:
    """Damping ratio of an oscillator that loses the share `capacity` of its energy in a cycle."""
    return -math.log1p(-min(capacity, 1 - 1e-12)) / (4 * math.pi)


def first_frequency(point: SpeedPoint) -> float | None:
    """The first bending frequency [Hz]: of the plate without the ball, or else the one given, with the ball stuck."""
    if point.modes:
        bending = [mode.frequency_hz for mode in point.modes if mode.family == "flap"]
        return bending[0] if bending else None
    return point.reduced.f1_hz if point.reduced is not None else None


def answer(results: Results) -> Answer:
    """What the run found, most important first."""
    points = [p for p in results.speeds if p.damping is not None]
    if not points:
        return _plate_only(results)
    capacities = [c for p in points if (c := ball_capacity(p)) is not None]
    if not any(p.damping and p.damping.events > 1 and p.damping.impacts for p in points) or not capacities:
        return Answer("No: the ball never moves", (_never_moves(points),))
    ratio = equivalent_ratio(max(capacities))
    zeta = results.scene.damper.damping_ratio if results.scene.damper else 0.0
    if ratio >= STRONG or (zeta > 0 and ratio > zeta):
        verdict = "Yes"
    elif ratio >= MODEST:
        verdict = "Modestly"
    else:
        verdict = "Hardly"
    return Answer(verdict, (_how_much(capacities, zeta), *_beside_the_paper(results), *_up_to(points)))


def _how_much(capacities: list[float], zeta: float) -> str:
    low, high = min(capacities), max(capacities)
    ratio = equivalent_ratio(high)
    text = (
        f"While it moves, the ball takes {span(100 * low, 100 * high)} % of the vibration's energy in a cycle,"
        f" as a damping ratio of {span(equivalent_ratio(low), ratio, 1)} would."
    )
    if zeta > 0 and ratio < zeta / 10:
        text += (
            f" The structure's own ζ = {significant(zeta)} does {significant(zeta / ratio, 2)} times as much or more:"
            " nearly all the damping below is the structure's, not the ball's."
        )
    elif zeta > 0:
        text += f" The structure's own damping ratio is {significant(zeta)}."
    return text


def _up_to(points: list[SpeedPoint]) -> list[str]:
    loaded = [p for p in points if p.damping and p.damping.cutoff_ratio is not None]
    if not loaded:
        return ["The run ended before the ball came to rest, so that there is no cut-off to report."]
    ratios = [p.damping.cutoff_ratio for p in loaded if p.damping and p.damping.cutoff_ratio is not None]
    text = (
        f"It works while the plate's acceleration is above {span(min(ratios), max(ratios))} times the centrifugal"
        " load; below that the ball rests."
    )
    top = max(loaded, key=lambda p: p.load_g)
    start, cutoff = release_g(top), top.damping.cutoff_g if top.damping else None
    if start is None or not cutoff:
        return [text]
    here = f"At the highest load examined, {top.load_g:.0f} g, the release gives {start:.0f} g"
    if start > cutoff:
        return [text, f"{here}, {significant(start / cutoff, 2)} times the cut-off: the ball still moves there."]
    return [text, f"{here}, which does not reach the cut-off."]


def _beside_the_paper(results: Results) -> list[str]:
    rows = [(row, p) for p in results.speeds if (row := paper.row(results.scene, p.load_g)) is not None]
    if not rows:
        return []
    low, high = (round(100 * value) for value in paper.SDC_RANGE)
    text = f"The paper reports {low} to {high} % for this plate. "
    if results.scene.damper is not None and results.scene.damper.formulation == "consistent":
        text += "The ball cannot do that: a bound on its work in this cavity rules it out."
    else:
        text += "The ball does not do that, even by the equations as printed."
    near = [p.load_g for row, p in rows if p.damping and _near(p.damping.cutoff_ratio, row.ratio)]
    if near:
        text += (
            f" The paper's cut-off is reproduced, within the resolution of a cycle, at {len(near)} of {len(rows)} loads"
        )
        text += "." if len(near) == len(rows) else f" ({span(min(near), max(near), 5)} g)."
    return [text]


def _near(ours: float | None, theirs: float) -> bool:
    """Whether two cut-off ratios agree as far as a cycle resolves them and two decimals print them."""
    return ours is not None and abs(ours - theirs) <= 0.0125


def release_g(point: SpeedPoint) -> float | None:
    """Acceleration amplitude of the release over g."""
    damping, reduced = point.damping, point.reduced
    if damping is None or reduced is None or not len(damping.amplitude_g) or not point.load_g:
        return None
    gravity = point.omega**2 * point.radius / point.load_g
    return (2 * math.pi * reduced.f1_hz) ** 2 * math.hypot(*damping.release) / gravity


def _never_moves(points: list[SpeedPoint]) -> str:
    top = max(points, key=lambda p: p.load_g)
    start = release_g(top)
    shake = "" if start is None else f" At {top.load_g:.0f} g the release shakes the plate at {start:.0f} g."
    return "The load holds the ball to the floor: the release does not overcome its rolling resistance." + shake


def _plate_only(results: Results) -> Answer:
    first = [p.modes[0].frequency_hz for p in results.speeds if p.modes]
    if not first:
        return Answer("Nothing was solved", ())
    rpm = [p.rpm for p in results.speeds]
    text = f"The first frequency is {span(min(first), max(first), 5)} Hz between {min(rpm):.0f} and {max(rpm):.0f} rpm."
    return Answer("The plate alone", (text,))
