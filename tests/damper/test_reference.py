"""The engine against a dense reference that shares no code with it, and against digits computed elsewhere."""

import pytest

from damper import Formulation, ringdown
from tests.compiler import some
from tests.damper.reference import Reference, agreed, events
from tests.damper.scenes import paper, random_scene

ENERGY_TOLERANCE = 1e-7
NUDGE = 1e-12
"""By which releases are moved, relatively, to see how chaotic a motion is."""


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
    run = ringdown(paper(formulation=formulation), (20e-3, 5e-3), 20)
    assert run.impacts == impacts
    assert run.energy.final / run.energy.initial == pytest.approx(final, abs=6e-11)
    if rolling is not None:
        assert run.energy.rolling / run.energy.initial == pytest.approx(rolling, abs=6e-12)


@pytest.mark.parametrize("seed", some(26, without=2))
@pytest.mark.parametrize("slips", [False, True])
def test_random_scene(seed: int, slips: bool) -> None:
    """Same events at the same times over 15 cycles; over fewer where the motion is too chaotic for as many."""
    damper, release = random_scene(seed, 0.05 + 0.01 * seed if slips else None)
    run, theirs = ringdown(damper, release, 15, keep_events=True), Reference(damper, release, 15, samples=512)
    if not agreed(events(run), theirs.events) == len(theirs.events) == len(events(run)):
        cycles = predictable(theirs)
        assert 2 <= cycles < 15
        run, theirs = ringdown(damper, release, cycles, keep_events=True), Reference(damper, release, cycles, 512)
        assert agreed(events(run), theirs.events) == len(theirs.events) == len(events(run))
    assert run.impacts == theirs.impacts
    ours = run.energy.final / run.energy.initial * theirs.initial
    assert abs(ours - theirs.final) <= ENERGY_TOLERANCE * max(theirs.final, theirs.initial)
