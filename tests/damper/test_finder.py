"""The finder of events against brute force, and where finders miss: near tangents, zeros at the start, any scale."""

import math

import numpy as np
import pytest
from numpy.typing import ArrayLike

from damper.compiled import kernel
from damper.events import _end_of_roll, first_zero
from damper.flight import derivatives, sizes
from damper.state import AXIS, HIT, NOTHING, REVERSAL, TERMS
from tests.compiler import some

FACTORIALS = np.array([math.factorial(k) for k in range(TERMS)], float)


@kernel
def of_series(guard, end):
    return first_zero(guard, end)


def first_root(polynomial: ArrayLike, end: float = 1.0) -> float:
    """The finder's, of a polynomial: a series is kept as its derivatives."""
    guard = np.zeros(TERMS)
    guard[: len(polynomial)] = polynomial
    return of_series(guard * FACTORIALS, end)


def brute(guard: np.ndarray) -> float:
    """First sign change on a grid from 0 to 1, polished by bisection."""
    x = np.linspace(0, 1.0, 10_001)
    below = np.flatnonzero(np.polynomial.polynomial.polyval(x, guard)[1:] <= 0)
    if not len(below):
        return math.inf
    low, high = x[below[0]], x[below[0] + 1]
    for _ in range(60):
        mid = 0.5 * (low + high)
        low, high = (low, mid) if np.polynomial.polynomial.polyval(mid, guard) <= 0 else (mid, high)
    return high


def waves(rng: np.random.Generator) -> np.ndarray:
    """Series on [0, 1] of a sum of waves and a parabola, as flights make them; positive at the start."""
    k = np.arange(TERMS)
    guard = np.zeros(TERMS)
    for _ in range(rng.integers(1, 4)):
        frequency, amplitude, phase = rng.uniform(0.05, 1.2), 10 ** rng.uniform(-3, 0), rng.uniform(0, 2 * np.pi)
        guard += amplitude * frequency**k * np.cos(phase + 0.5 * np.pi * k) / FACTORIALS
    guard[:3] += rng.normal(size=3) * 10 ** rng.uniform(-3, 0, 3)
    guard[0] = abs(guard[0]) * 10 ** rng.uniform(-6, 0)
    return guard


@pytest.mark.parametrize("seed", some(40, without=2))
def test_against_brute_force(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(50):
        guard = waves(rng)
        found, expected = first_root(guard), brute(guard)
        if found == math.inf:
            assert expected == math.inf
            continue
        value = np.polynomial.polynomial.polyval(found, guard)
        assert abs(value) <= 4e-15 * np.abs(guard).sum()
        assert found <= expected * (1 + 1e-12) or abs(value) <= 1e-15 * np.abs(guard).sum()
        if expected < math.inf and abs(found - expected) > 1e-9:  # a touch between two samples of the brute force
            x = np.linspace(max(found - 1e-3, 0), found + 1e-3, 200_001)
            assert np.polynomial.polynomial.polyval(x, guard).min() <= 1e-15 * np.abs(guard).sum()


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12, -1e-12, -1e-9, -1e-6, -1e-3])
@pytest.mark.parametrize("place", [0.013, 0.31, 0.77, 0.999])
def test_near_tangent(depth: float, place: float) -> None:
    """A guard that dips to within rounding of zero, between any two samples."""
    k = np.arange(TERMS)
    guard = -np.cos(0.5 * np.pi * k - 0.9 * place) * 0.9**k / FACTORIALS
    guard[0] += 1 + depth  # 1 + depth - cos(0.9 (x - place))
    found = first_root(guard)
    if depth > 0:
        assert found == math.inf
    else:
        assert found == pytest.approx(place - math.acos(1 + depth) / 0.9 if -depth < 0.4 * place**2 else 0, abs=1e-7)


def test_triple_zero() -> None:
    """A triple zero: slope and bend vanish with the guard."""
    assert first_root([0.027, -0.27, 0.9, -1.0]) == pytest.approx(0.3, abs=2e-5)  # (0.3 - x)**3


@pytest.mark.parametrize("begun", [0, 1], ids=["above zero", "at zero"])
@pytest.mark.parametrize("left", [1e-6, 1e-12, 1e-15, 1e-16, 1e-18, 1e-24, 1e-40, 1e-300])
def test_rises_from_next_to_nothing(left: float, begun: int) -> None:
    """A guard that rises from next to zero, as rounding leaves it, and falls again: the terms of its zero cancel."""
    for place in (0.05, 0.31, 0.54, 0.77, 0.999):
        for others in ([], [1.4], [1.4, -0.8], [-3.0, 2.0, 2.5, -1.1]):
            guard = np.polynomial.polynomial.polyfromroots([-left, place, *others])
            guard = np.concatenate([np.zeros(begun), guard * np.sign(guard[1])])
            assert first_root(guard) == pytest.approx(place, rel=1e-14)


def test_a_guard_that_begins_at_zero() -> None:
    """It has just been there: its next zero counts, however flat it begins, unless it falls."""
    assert first_root([0.0, 1.0, -2.0]) == pytest.approx(0.5, rel=1e-15)
    assert first_root([0.0, 0.0, 1.0, -4.0]) == pytest.approx(0.25, rel=1e-15)
    assert first_root([0.0, 0.0, -1.0, 4.0]) == 0.0
    assert first_root([0.0]) == math.inf


def test_nothing_beyond_the_end() -> None:
    assert first_root([0.5, -1.0], 0.5 * (1 - 1e-12)) == math.inf
    assert first_root([0.5, -1.0], 0.5) == 0.5


@pytest.mark.parametrize("scale", [1e-140, 1e-30, 1e30, 1e140])
def test_scale_has_no_part_in_it(scale: float) -> None:
    guard = waves(np.random.default_rng(3))
    assert first_root(scale * guard) == pytest.approx(first_root(guard), rel=1e-12)


@kernel
def end_of_roll(s, guard, axis):
    """The end of a flight within its step, and what it is."""
    return _end_of_roll(s, guard, axis, 1.0)


@kernel
def missed(flights, axis, guard, samples, kinds):
    """How far beyond a wall or back a ball is before the event that ends its flight, at worst; or off it then."""
    worst = 0.0
    for n in range(len(flights)):
        s = flights[n]
        end, kind = end_of_roll(s, guard, axis)
        d, end = axis.direction, min(end, 1.0)
        kinds[n], scale = (kind if end < 1.0 else NOTHING), sizes(s, 0, 0, 1.0)
        for k in range(1, samples):
            gain, speed, _, _ = derivatives(s, end * k / samples)
            worst = max(worst, (d * (s[0] + gain) - axis.half_gap) / scale, -d * speed / scale)
        gain, speed, _, _ = derivatives(s, end)
        left = axis.half_gap - d * (s[0] + gain) if kind == HIT else speed
        if kinds[n] != NOTHING:
            worst = max(worst, abs(left) / scale)
    return worst


def test_no_flight_misses_its_end() -> None:
    """Against dense sampling: rolls of a ball in waves, from any place and speed, just set off or just turned.

    What a flight may overstep is rounding. A million flights with 500 samples each overstepped none either.
    """
    count = some(20_000, without=20).stop
    rng, axis = np.random.default_rng(11), np.zeros(1, AXIS)[0]
    axis["half_gap"], axis["direction"] = 1.0, 1
    flights, kinds = np.array([waves(rng) for _ in range(count)]), np.zeros(count, np.int64)
    flights[:, 0] = 1.0 - rng.choice([2.0, 1.0], count) * 10 ** rng.uniform(-9, 0, count)
    flights[:, 1] = np.abs(flights[:, 1]) * rng.choice([0.0, 1.0], count, p=[0.3, 0.7])
    flights[:, 2] = np.where(flights[:, 1] == 0, np.abs(flights[:, 2]), flights[:, 2])
    flights *= FACTORIALS
    assert missed(flights, axis, np.zeros(TERMS), 300, kinds) < 1e-14
    assert {HIT, REVERSAL, NOTHING} <= set(kinds)


@pytest.mark.parametrize("side", [-1, 1])
def test_a_flight_that_begins_at_its_turning_point_reverses_at_once(side: int) -> None:
    """A flight broken off in the very instant of a reversal, as at the end of a cycle of a force, goes on backwards."""
    axis, k = np.zeros(1, AXIS)[0], np.arange(TERMS)
    axis["half_gap"], axis["direction"] = 1.0, side
    swing = 0.3 * side * 1.5**k * np.cos(0.5 * np.pi * k)  # cos(1.5 x): at its extreme, speed zero to the last bit
    swing[1::2] = 0.0
    assert end_of_roll(swing, np.zeros(TERMS), axis) == (0.0, REVERSAL)
