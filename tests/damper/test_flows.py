"""The terms of flights against the matrix exponential; eight numbers at a time against arrays."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from damper import Harmonic, flight
from damper.compiled import fused
from damper.equations import members_of, structures_by
from damper.flight import lobatto
from damper.setup import flows_of, systems_of
from damper.state import STEP, TERMS
from tests.damper.test_linear import scene


@fused
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


@pytest.mark.parametrize("seed", range(12))
def test_series_are_the_matrix_exponential(seed: int) -> None:
    """State, constant and harmonic as one linear system, at ends and inside of a step."""
    damper, _, _ = scene(seed)
    harmonic = Harmonic(1.3 * damper.stuck_frequency, force=(2.0, 1.0), base=(0.5, -0.3), phase=0.4)
    rows = damper.parameters
    structures = structures_by(damper, rows)
    systems = systems_of(rows, structures, harmonic)
    of, members = systems.equations, members_of(rows, structures)
    flows = flows_of(of, members, systems.constants["span"][:, : len(members)])[0]
    rng, size = np.random.default_rng(seed), of.stiffness.shape[-1]
    for g, group in enumerate(members):
        n, axes, span = len(group), [z - size + 2 for z in group if z >= size - 2], systems.constants["span"][0, g]
        for number, pair in enumerate(range(9) if len(members) == 1 else (range(0, 9, 3), range(3))[g]):
            z, rate = rng.normal(size=(2, n))
            pushed = rng.normal(size=len(axes))
            begun = np.concatenate([z, rate * span, pushed, [math.cos(0.4), math.sin(0.4)]])
            series = np.einsum("ljk,j->lk", flows[3 * g + number][:, : len(begun)], begun)
            here = np.ix_(group, group)
            full = np.zeros((2 * n + 3, 2 * n + 3))  # z, z', 1, cos, sin
            full[:n, n : 2 * n] = np.eye(n)
            full[n : 2 * n, :n], full[n : 2 * n, n : 2 * n] = -of.stiffness[0, pair][here], -of.damping[0, pair][here]
            full[n : 2 * n, 2 * n] = pushed @ of.resistance[0, pair][np.ix_(axes, group)]
            full[n : 2 * n, 2 * n + 1] = of.force[0, pair][group]
            full[-2, -1], full[-1, -2] = -harmonic.frequency, harmonic.frequency
            start = np.concatenate([z, rate, [1.0, math.cos(0.4), math.sin(0.4)]])
            for x in (0.1, 0.6, 1.0):
                exact = expm(full * (x * span)) @ start
                found = series[:n] @ x ** np.arange(TERMS)
                assert found == pytest.approx(exact[:n], rel=1e-12, abs=1e-12 * np.abs(exact[:n]).max())


def test_terms_left_out_are_rounding() -> None:
    """Of the fastest motion over a step, and of its second derivative."""
    assert STEP**TERMS / math.factorial(TERMS) < 1e-17
    assert STEP ** (TERMS - 2) / math.factorial(TERMS - 2) < 1e-17


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
