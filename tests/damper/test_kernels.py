"""The kernels alone, against quadrature, finite differences and dense searches, with floating-point traps set."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np
import pytest

from damper import Formulation, ringdown, stepped_ringdown
from damper.events import look, schedule
from damper.flight import begin
from damper.motion import prepare
from damper.state import HIT, NOTHING, PIECES, ROLLING, SLIPPING
from tests.damper.scenes import paper_like, random_scene


@pytest.fixture(autouse=True)
def _traps() -> Iterator[None]:
    """Division by zero, overflow and invalid operations raise; a number that underflows is as good as zero."""
    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.mark.parametrize("slips", [False, True])
def test_a_flight_is_looked_through_a_while_at_a_time(slips: bool) -> None:
    """A ball afloat meets the wall after gap / speed; what a hit may cut short any time is not searched to its end."""
    damper = dataclasses.replace(paper_like(Formulation.CONSISTENT), centrifugal_acceleration=0.0, cavity=(3.0, 3.0))
    speed, period = 0.7, 2 * math.pi / damper.stuck_frequency
    start = np.zeros((1, 5, 2))
    start[:, 0], start[:, 3:] = 1e-5, speed
    one = prepare(damper.parameters, start, 1.0, 1.0)
    axis, laws, ball = one.axes[0, 0], one.laws[0, 0], one.balls[0]
    if slips:
        ball["grip"], axis["spin"] = 1e-30, 1e9  # a friction too weak to matter
    axis["regime"], axis["direction"] = SLIPPING if slips else ROLLING, 1
    begin(axis, laws, ball, 0.0)
    schedule(axis, laws, ball, math.inf)
    looks = 0
    while axis["kind"] == NOTHING:
        looks += 1
        assert axis["next"] <= looks * (PIECES + 1) * period / 2
        look(axis, laws, ball, math.inf)
    assert looks >= 1000 / PIECES
    assert axis["kind"] == HIT
    assert axis["next"] == pytest.approx(damper.half_gap[0] / speed, rel=1e-4)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("slip", [False, True])
def test_no_trap_is_sprung(seed: int, slip: bool) -> None:
    """Whole ring-downs; the traps bite where kernels run as plain Python, in the run that counts coverage."""
    damper, release = random_scene(seed)
    if slip:
        damper = dataclasses.replace(damper, formulation=Formulation.CONSISTENT, floor_friction=0.05 + seed / 60)
    run = ringdown(damper, release, 2, keep_events=True)
    assert np.isfinite([run.energy.final, run.energy.residual, *run.peak_velocities]).all()
    if not slip:
        assert np.isfinite(stepped_ringdown(damper, release, 2).velocity).all()


@pytest.mark.parametrize(
    ("row", "axis", "speed"), [(0, 0, 2e-3 * 1693.3), (0, 1, 2e-3 * 1693.3), (1, 1, 2e-3), (2, 0, 0.0), (3, 0, 2e-3)]
)
def test_floor_of_sticking_goes_by_the_release(row: int, axis: int, speed: float) -> None:
    """A billionth of the fastest that the release can make anything move; the place of the ball has no say."""
    start = np.zeros((1, 5, 2))
    start[0, row, axis] = 2e-3 if row != 2 else 1e-4
    one = prepare(paper_like(Formulation.CONSISTENT).parameters, start, 1.0, 1.0)
    assert one.balls["sticking_floor"][0] == pytest.approx(1e-9 * speed, rel=1e-4)
