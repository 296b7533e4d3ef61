"""The terms of flights against the matrix exponential; eight numbers at a time against arrays."""

import math

import numpy as np
import pytest

from damper import flight
from damper.compiled import kernel
from damper.flight import lobatto


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


def test_lobattos_rule() -> None:
    """Real numbers on every version of numpy, symmetric, with the ends, and exact up to the degree 2 n - 3."""
    places, weights = lobatto()
    n = len(places)
    assert places.dtype == weights.dtype == np.float64
    assert places.shape == weights.shape == (n,)
    assert (places[0], places[-1]) == (0.0, 1.0)
    assert (np.diff(places) > 0.0).all()
    assert places + places[::-1] == pytest.approx(1.0, rel=1e-15)
    assert weights == pytest.approx(weights[::-1], rel=1e-15)
    assert weights[0] == pytest.approx(1.0 / (n * (n - 1)), rel=1e-15)
    for degree in range(2 * n - 2):
        assert weights @ places**degree == pytest.approx(1.0 / (degree + 1), rel=1e-15)
    # The next one is missed by what theory says: Abramowitz & Stegun, 25.4.32, on [0, 1].
    factorial = math.factorial
    missed = n * (n - 1) ** 3 * factorial(n - 2) ** 4 / ((2 * n - 1) * factorial(2 * n - 2) ** 2)
    assert weights @ places ** (2 * n - 2) - 1.0 / (2 * n - 1) == pytest.approx(missed, rel=1e-5)
