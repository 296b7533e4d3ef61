"""Damping up to its critical value, where the frequency of the vibration tends to zero and its period to infinity."""

import dataclasses
import math
from decimal import Decimal, localcontext

import numpy as np
import pytest

from damper import Formulation, ParticleDamper, capacity, ringdown, sample
from damper.state import ROLLING, START
from tests.damper.reference import Reference, agreed, events
from tests.damper.scenes import paper

ZETAS = [0.6, 0.9, 0.99, 0.999, 0.999999, 1 - 1e-9, 1 - 1e-12, 1 - 2.0**-53]


def afloat(zeta: float, ball: float = 1e-4, **changes: object) -> ParticleDamper:
    """A ball that nothing presses onto the floor: ζ is then that of the structure in flight, with nothing added."""
    return paper(centrifugal_acceleration=0.0, damping_ratio=zeta, ball_mass=ball, **changes)


def exactly(zeta: float, rate: float, u: float, v: float, tau: float) -> tuple[Decimal, Decimal]:
    """Displacement and velocity of x'' + 2 zeta rate x' + rate² x = 0 by a Taylor series in 60 digits, by halves."""
    with localcontext() as context:
        context.prec = 60
        z, w, t = Decimal(zeta), Decimal(rate), Decimal(tau)
        parts = max(1, math.ceil(4.0 * rate * tau))
        x, y = Decimal(u), Decimal(v) / w
        step = w * t / parts
        for _ in range(parts):
            terms = [(x, y)]
            for k in range(1, 60):
                a, b = terms[-1]
                terms.append((step * b / k, step * (-a - 2 * z * b) / k))
            x, y = sum(a for a, _ in terms), sum(b for _, b in terms)
        return x, y * w


@pytest.mark.parametrize("zeta", ZETAS)
@pytest.mark.parametrize("state", [(3e-3, -7.0), (3e-3, 0.0), (-1e-3, -2.0)])
def test_flight_and_loss_to_the_last_digits(zeta: float, state: tuple[float, float]) -> None:
    """Against a series in 60 digits, the ball flying; the dashpot's work is what the oscillator lost."""
    (u, v), damper = state, afloat(zeta, cavity=(1e3, 1e3))
    rate = math.sqrt(damper.stiffness[0] / damper.modal_mass)
    for angle in (0.05, 0.2, 1.0, 4.0, 15.0):
        cycles = angle / rate * damper.stuck_frequency / (2 * math.pi)
        run = ringdown(damper, (u, 0.0), cycles, velocity=(v, 0.0), ball_velocity=(90.0, 90.0), keep_events=True)
        x, y = exactly(zeta, rate, u, v, run.duration)
        there = sample(run, [run.duration])
        size = abs(u) + abs(v) / rate
        assert run.events == 0  # the ball outruns the structure
        assert abs(there.displacement[0, 0] - float(x)) <= 1e-14 * size
        assert abs(there.velocity[0, 0] - float(y)) <= 1e-14 * size * rate
        before, after = (
            Decimal(damper.stiffness[0]) * a**2 + Decimal(damper.modal_mass) * b**2
            for a, b in ((Decimal(u), Decimal(v)), (x, y))
        )
        assert run.energy.structure == pytest.approx(float((before - after) / 2), rel=2e-12)


@pytest.mark.parametrize("zeta", ZETAS)
@pytest.mark.parametrize("formulation", list(Formulation))
def test_a_ball_sets_off_at_its_threshold(zeta: float, formulation: Formulation) -> None:
    """It is let go without a drive; the lesser of two printed dashpots decides on the way out."""
    damper = paper(formulation=formulation, damping_ratio=zeta, rolling_friction=1e-5)
    dashpot = 2 * zeta * math.sqrt(damper.stiffness[0] * damper.modal_mass)
    v = 20.0 * damper.rolling_threshold / damper.stuck_frequency
    run = ringdown(damper, (-dashpot * v / damper.stiffness[0], 0.0), 1, velocity=(v, 0.0), keep_events=True)
    start = run.rows[run.rows["kind"] == START][0]
    drive = (damper.stiffness[0] * start["u"] + dashpot * start["v"]) / damper.stuck_mass
    assert drive == pytest.approx(damper.rolling_threshold, rel=1e-11)
    assert start["direction"] == 1


@pytest.mark.parametrize("zeta", ZETAS)
@pytest.mark.parametrize("ball", [1e-9, 1e-4, 0.3])
@pytest.mark.parametrize("pressed", [False, True])
@pytest.mark.parametrize("slips", [False, True])
def test_books_close(zeta: float, ball: float, pressed: bool, slips: bool) -> None:
    """The frequency of the flight tends to zero: sine over frequency, and constants as large as its inverse."""
    damper = afloat(zeta, ball, cavity=(2.06e-3, 2.2e-3))
    if pressed:
        damper = dataclasses.replace(damper, centrifugal_acceleration=2e3)
    if slips:
        damper = dataclasses.replace(damper, floor_friction=0.3)
    for cycles in (3, 30):
        run = ringdown(damper, (5e-3, 2e-3), cycles)
        assert abs(run.energy.residual) <= 1e-12 * run.energy.initial
        assert run.energy.final < run.energy.initial
        assert run.impacts > 0


@pytest.mark.parametrize("zeta", [0.9, 0.999, 0.999999])
@pytest.mark.parametrize("formulation", list(Formulation))
@pytest.mark.parametrize("load", [0.0, 2e3])
def test_events_are_those_of_the_dense_reference(zeta: float, formulation: Formulation, load: float) -> None:
    """The same events at the same times over two periods, by matrix exponentials."""
    damper = paper(formulation=formulation, damping_ratio=zeta, centrifugal_acceleration=load)
    one = dataclasses.replace(damper, cavity=(2.1e-3, 2.4e-3))
    run, dense = ringdown(one, (5e-3, 2e-3), 2, keep_events=True), Reference(one, (5e-3, 2e-3), 2, samples=512)
    assert agreed(events(run), dense.events) == len(dense.events) == len(events(run))
    assert run.energy.final / run.energy.initial == pytest.approx(dense.final / dense.initial, abs=1e-10)


def test_a_reversal_in_a_dying_vibration_is_seen() -> None:
    """Once the structure rests, its acceleration is exactly zero, and no longer of either sign."""
    damper = afloat(1 - 5.2e-13, 1.7e-4, cavity=(2.0615e-3, 3.353e-3), restitution=1.0)
    run = ringdown(damper, (7.87e-4, 2.36e-4), 200, keep_events=True)
    moving = run.rows[(run.rows["regime"] == ROLLING) & (run.rows["w"] != 0.0)]
    assert (np.sign(moving["w"]) == moving["direction"]).all()
    assert abs(run.energy.residual) <= 1e-12 * run.energy.initial


@pytest.mark.parametrize("zeta", [0.2, 0.5, 0.7, 0.9])
def test_a_cycle_is_a_period_of_the_damped_vibration(zeta: float) -> None:
    """A ball that never moves: velocity maxima lie a damped period apart, whatever the damping."""
    damper = paper(damping_ratio=zeta, centrifugal_acceleration=1e12, ball_mass=1e-9)
    run = ringdown(damper, (1e-3, 0.0), 12)
    found = capacity(run)
    damped = 2 * math.pi / damper.stuck_frequency / math.sqrt(1 - zeta**2)
    # to the square root of rounding, as any maximum
    np.testing.assert_allclose(np.diff(run.peak_times), damped, rtol=1e-6)
    np.testing.assert_allclose(found.sdc, found.intrinsic_sdc, rtol=1e-6)


@pytest.mark.parametrize("zeta", [0.95, 0.999, 1 - 1e-12])
def test_nearly_critical_a_cycle_takes_everything(zeta: float) -> None:
    found = capacity(ringdown(paper(damping_ratio=zeta), (20e-3, 5e-3)))
    assert len(found.sdc) >= 1
    np.testing.assert_allclose(found.sdc, 1.0, rtol=1e-8)


@pytest.mark.parametrize("zeta", [0.1, 0.5, 0.98, 1 - 1e-6])
def test_what_the_ball_starts_anew_is_no_cycle(zeta: float) -> None:
    """A ball afloat that bounces on in a structure at rest kicks it: no capacity, instead of one of -1e5."""
    damper = afloat(zeta, 1e-3, restitution=0.9, friction=0.0, cavity=(4e-3, 4e-3))
    run = ringdown(damper, (2e-3, 0.0), 200)
    found = capacity(run)
    before, after = run.peak_velocities[:-1], run.peak_velocities[1:]
    assert (after > 10.0 * before).any(), "the scene has no such cycle"
    np.testing.assert_array_equal(np.isnan(found.sdc), after > math.sqrt(2.0) * before)
    assert np.nanmin(found.sdc) >= -1.0
    assert np.nanmax(found.sdc) <= 1.0
