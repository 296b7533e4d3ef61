"""Eight numbers at a time against arrays; the work of a force against the energy."""

import numpy as np
import pytest

from damper import Harmonic, flight, ringdown
from damper.compiled import kernel
from tests.damper.scenes import simple


@kernel
def worked(a, b, x, out):
    one, two = flight.load(a, 1), flight.load(b, 0)
    flight.store(out, 2, flight.add_times(flight.times(one, two), one, flight.fill(x)))
    return flight.total(one)


def test_eight_numbers() -> None:
    a, b, out = np.arange(1.0, 12.0), np.linspace(-1, 1, 9), np.zeros(12)
    total = worked(a, b, 3.0, out)
    assert total == a[1:9].sum()
    assert out[2:10] == pytest.approx(a[1:9] * b[:8] + 3.0 * a[1:9], rel=1e-15)
    assert not np.concatenate([out[:2], out[10:]]).any()


@pytest.mark.parametrize("detuning", [0.97, 1.03])
def test_work_of_a_force_that_gives_and_takes(detuning: float) -> None:
    """Near resonance many times the energy goes to and fro: what the rule of integration misses adds up."""
    damper = simple(restitution=0.0, cavity=(2.2, 2.2))
    force = Harmonic(detuning * damper.stuck_frequency, (0.03, 0.0))
    energy = ringdown(damper, (0.3, 0.0), 600, harmonic=force).energy
    assert abs(energy.residual) <= 5e-14 * (energy.initial + max(energy.work, 0.0))
