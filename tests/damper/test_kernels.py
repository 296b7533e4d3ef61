"""The kernels alone, against quadrature, finite differences and dense searches, with floating-point traps set."""

from collections.abc import Iterator

import numpy as np
import pytest

from damper import ringdown, stepped_ringdown
from damper.motion import prepare
from damper.state import HIT
from tests.damper.scenes import paper, random_scene


@pytest.fixture(autouse=True)
def _traps() -> Iterator[None]:
    """Division by zero, overflow and invalid operations raise; a number that underflows is as good as zero."""
    with np.errstate(all="raise", under="ignore"):
        yield


def test_a_flight_over_a_thousand_periods() -> None:
    """A ball afloat meets the wall after gap / speed."""
    damper = paper(centrifugal_acceleration=0.0, cavity=(3.0, 3.0))
    run = ringdown(damper, (1e-5, 0.0), 700, ball_velocity=(0.7, 0.0), keep_events=True)
    hits = run.rows["time"][run.rows["kind"] == HIT]
    assert hits[0] == pytest.approx(damper.half_gap[0] / 0.7, rel=1e-4)
    assert abs(run.energy.residual) <= 1e-12 * run.energy.initial


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("slip", [False, True])
def test_no_trap_is_sprung(seed: int, slip: bool) -> None:
    """Whole ring-downs; the traps bite where kernels run as plain Python, in the run that counts coverage."""
    damper, release = random_scene(seed, 0.05 + seed / 60 if slip else None)
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
    one = prepare(paper().parameters, start, 1.0, 1.0)
    assert one["ball"]["sticking_floor"][0] == pytest.approx(1e-9 * speed, rel=1e-4)
