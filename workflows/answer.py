"""The answer in a few words: does it damp, how much, up to what load."""

from __future__ import annotations

import math
from dataclasses import dataclass

from workflows import paper
from workflows.records import Results, SpeedPoint
from workflows.wording import significant, span

STRONG, MODEST = 1e-2, 1e-3
"""Damping ratios: what the ball adds is called strong above the one and modest above the other."""


_NEAR = 0.1
"""Relative difference of cut-offs that are called reproduced; a cycle at ζ = 0.01 resolves 6 %."""


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
    if damping is None or reduced is None or not moves(point):
        return None
    moving = damping.amplitude_g >= (damping.cutoff_g or 0.0) * (1 - 1e-12)
    energy = 0.5 * reduced.M1 * float((damping.peak_velocity[moving] ** 2).sum())
    taken = damping.energy.rolling + damping.energy.impact + damping.energy.slip
    return taken / energy if energy > 0 else None


def moves(point: SpeedPoint) -> bool:
    """Whether the ball moved at all: any event but the release."""
    return point.damping is not None and point.damping.events > 0


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
    if not any(moves(p) for p in points):
        return Answer("No: the ball never moves", (_never_moves(results, points),))
    if not capacities:
        return Answer("No: the ball takes nothing", tuple(_up_to(results, points)))
    ratio = equivalent_ratio(max(capacities))
    zeta = results.scene.damper.damping_ratio if results.scene.damper else 0.0
    if ratio >= STRONG or (zeta > 0 and ratio > zeta):
        verdict = "Yes"
    elif ratio >= MODEST:
        verdict = "Modestly"
    else:
        verdict = "Hardly"
    return Answer(verdict, (_how_much(capacities, zeta), *_beside_the_paper(results), *_up_to(results, points)))


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


def _up_to(results: Results, points: list[SpeedPoint]) -> list[str]:
    """From what amplitude on the ball works, and up to what load."""
    ratios = [p.damping.cutoff_ratio for p in points if p.damping and p.damping.cutoff_ratio is not None]
    sentences = []
    if ratios:
        what = "plate" if results.scene.plate is not None else "structure"
        sentences.append(
            f"It works while the {what}'s acceleration, both axes taken together, is above"
            f" {span(min(ratios), max(ratios))} times the centrifugal load; below that the ball rests."
        )
    else:
        sentences.append("The run ended before the ball came to rest, so that there is no cut-off to report.")
    moving = max((p for p in points if moves(p)), key=lambda p: p.load_g)
    held = [p for p in points if p.load_g > moving.load_g]
    if held:
        first = min(held, key=lambda p: p.load_g)
        sentences.append(
            f"After this release the ball moves up to a load of {moving.load_g:.0f} g; at {first.load_g:.0f} g, the"
            " next one examined, and above, the load holds it."
        )
    else:
        sentences += _at_the_top(moving)
    return sentences


def _at_the_top(point: SpeedPoint) -> list[str]:
    start, cutoff = release_g(point), point.damping.cutoff_g if point.damping else None
    if start is None or not cutoff:
        return []
    return [
        f"At the highest load examined, {point.load_g:.0f} g, the release gives {start:.0f} g,"
        f" {significant(start / cutoff, 2)} times the cut-off: the ball still moves there."
    ]


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
    off = [(abs(p.damping.cutoff_g / row.cutoff - 1), p.load_g) for row, p in rows if p.damping and p.damping.cutoff_g]
    near = [pair for pair in off if pair[0] <= _NEAR]
    if near:
        loads = [load for _, load in near]
        text += f" The paper's cut-off is reproduced to {100 * max(near)[0]:.0f} % at {len(near)} of {len(rows)} loads"
        text += "." if len(near) == len(rows) else f" ({span(min(loads), max(loads), 5)} g)."
    return [text]


def release_g(point: SpeedPoint) -> float | None:
    """Acceleration amplitude of the release over g."""
    damping, reduced = point.damping, point.reduced
    if damping is None or reduced is None or not len(damping.amplitude_g) or not point.load_g:
        return None
    gravity = point.omega**2 * point.radius / point.load_g
    return (2 * math.pi * reduced.f1_hz) ** 2 * math.hypot(*damping.release) / gravity


def _never_moves(results: Results, points: list[SpeedPoint]) -> str:
    damper = results.scene.damper
    if damper is not None and all(side <= 2 * damper.radius for side in damper.cavity):
        return "The ball fills its cavity."
    release = results.scene.release
    if release is not None and release.ratio is not None:
        points = [p for p in points if p.load_g > 0]
        if not points:
            return "There is no load, and a release that is a ratio of it sets nothing in motion."
    top = min(points, key=lambda p: p.load_g)
    start = release_g(top)
    shake = "" if start is None else f" At {top.load_g:.0f} g, the lowest load, the release gives {start:.0f} g."
    return "The load holds the ball to the floor: the release does not overcome its rolling resistance." + shake


def _plate_only(results: Results) -> Answer:
    first = [p.modes[0].frequency_hz for p in results.speeds if p.modes]
    if not first:
        return Answer("Nothing was solved", ())
    rpm = [p.rpm for p in results.speeds]
    text = f"The first frequency is {span(min(first), max(first), 5)} Hz between {min(rpm):.0f} and {max(rpm):.0f} rpm."
    return Answer("The plate alone", (text,))
