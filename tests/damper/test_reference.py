"""The engine against a dense reference that shares no code with it, and against digits computed elsewhere."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from damper import Formulation, ParticleDamper, RingDown, ringdown
from tests.compiler import some
from tests.damper.reference import Reference
from tests.damper.scenes import random_scene

KINDS = {1: "start", 2: "reversal", 3: "hit", 5: "grip"}
TIME_TOLERANCE = 1e-9  # of a period
ENERGY_TOLERANCE = 1e-7
NUDGE = 1e-12
"""By which releases are moved, relatively, to see how chaotic a motion is."""


def paper_like(formulation: Formulation) -> ParticleDamper:
    """269.5 Hz with the ball stuck, M2 = 1 kg, 21,932 g of 10 m/s^2, the parameters of Fig. 3."""
    mass, ball = 1.0, 0.006
    stiffness = (mass + ball) * (2 * math.pi * 269.5) ** 2
    return ParticleDamper(
        modal_mass=mass,
        stiffness=(stiffness, stiffness),
        ball_mass=ball,
        ball_radius=1e-3,
        cavity=(2.5e-3, 2.4e-3),
        centrifugal_acceleration=219320.0,
        restitution=0.5,
        friction=0.3,
        rolling_friction=1e-4,
        formulation=formulation,
    )


def events(run: RingDown) -> list[tuple[float, int, str]]:
    assert run.rows is not None
    period = 2 * math.pi / run.damper.stuck_frequency
    return [(r["time"] / period, int(r["axis"]), _name(r)) for r in run.rows if r["kind"] in KINDS]


def _name(row: np.record) -> str:
    pulled_from_wall = row["kind"] == 1 and row["regime"] == 2
    return "away" if pulled_from_wall else KINDS[row["kind"]]


def agreed(a: list[tuple[float, int, str]], b: list[tuple[float, int, str]]) -> int:
    """How many events of two runs are the same, from the first one on."""
    for k, (p, q) in enumerate(zip(a, b, strict=False)):
        if p[1:] != q[1:] or not abs(p[0] - q[0]) < TIME_TOLERANCE:
            return k
    return min(len(a), len(b))


def predictable(theirs: Reference) -> int:
    """Whole cycles over which what rounding does to the reference's motion stays below the tolerance.

    Rounding is made large enough to be seen: releases moved by some thousand times as much, each axis either way. What
    the reference may miss between two samples, it misses elsewhere at another sampling.
    """
    d, (x, y), cycles = theirs.damper, theirs.release, theirs.cycles
    others = [Reference(d, (x * (1 + a * NUDGE), y * (1 - b * NUDGE)), cycles, 512) for a in (-1, 1) for b in (-1, 1)]
    others.append(Reference(d, (x, y), cycles, samples=2048))
    first = min(agreed(theirs.events, other.events) for other in others)
    if first == max(len(run.events) for run in (theirs, *others)):
        return int(cycles)
    return int(min(run.events[first][0] for run in (theirs, *others) if first < len(run.events)))


@pytest.mark.parametrize(
    ("formulation", "impacts", "final", "rolling"),
    [
        # 20 cycles from 20 mm / 5 mm; an independent dense solution that agrees with itself to 1e-11
        (Formulation.CONSISTENT, 164, 0.99138562833, 0.00506813179),
        (Formulation.PRINTED, 165, 1.0680097305, None),
    ],
)
def test_known_digits(formulation: Formulation, impacts: int, final: float, rolling: float | None) -> None:
    run = ringdown(paper_like(formulation), (20e-3, 5e-3), 20)
    assert run.impacts == impacts
    assert run.energy.final / run.energy.initial == pytest.approx(final, abs=6e-11)
    if rolling is not None:
        assert run.energy.rolling / run.energy.initial == pytest.approx(rolling, abs=6e-12)


@pytest.mark.parametrize("seed", some(14, without=2))
@pytest.mark.parametrize("slips", [False, True])
def test_random_scene(seed: int, slips: bool) -> None:
    """Same events at the same times over 15 cycles; over fewer where the motion is too chaotic for as many."""
    damper, release = random_scene(seed)
    if slips:
        grip = 0.05 + 0.01 * seed
        damper = dataclasses.replace(damper, formulation=Formulation.CONSISTENT, floor_friction=grip)
    run, theirs = ringdown(damper, release, 15, keep_events=True), Reference(damper, release, 15, samples=512)
    if not agreed(events(run), theirs.events) == len(theirs.events) == len(events(run)):
        cycles = predictable(theirs)
        assert 2 <= cycles < 15
        run, theirs = ringdown(damper, release, cycles, keep_events=True), Reference(damper, release, cycles, 512)
        assert agreed(events(run), theirs.events) == len(theirs.events) == len(events(run))
    assert run.impacts == theirs.impacts
    ours = run.energy.final / run.energy.initial * theirs.initial
    assert abs(ours - theirs.final) <= ENERGY_TOLERANCE * max(theirs.final, theirs.initial)
