"""The kernels alone, against quadrature, finite differences and dense searches, with floating-point traps set."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.integrate import quad

from damper import Formulation, ringdown, stepped_ringdown
from damper.events import look, schedule
from damper.flight import begin, first_extremum, increments, relative, structure, velocity, viscous_loss, wave
from damper.motion import prepare
from damper.slip import drive, first_exceed
from damper.state import HIT, LAW, NOTHING, PIECES, ROLLING, SLIPPING, STUCK
from tests.damper.scenes import random_scene
from tests.damper.test_reference import paper_like


@pytest.fixture(autouse=True)
def _traps() -> Iterator[None]:
    """Division by zero, overflow and invalid operations raise; a number that underflows is as good as zero."""
    with np.errstate(all="raise", under="ignore"):
        yield


def flight(regime: int, zeta: float, **state: float):
    """An axis of the paper-like damper in a regime, its laws, its ball."""
    damper = dataclasses.replace(paper_like(Formulation.CONSISTENT), damping_ratio=zeta, floor_friction=0.2)
    one = prepare(damper.parameters, np.zeros((1, 5, 2)), 1.0, 1.0)
    axis, laws, ball = one.axes[0, 0], one.laws[0, 0], one.balls[0]
    for name, value in {"u": 3e-3, "v": -7.0, "s": 1e-4, "w": 2.0, "spin": 1.0, **state}.items():
        axis[name] = value
    axis["regime"], axis["direction"] = regime, 1
    begin(axis, laws, ball, 0.0)
    return axis, laws[regime], ball


@pytest.mark.parametrize("offset", [0.0, 1e12])
def test_velocity_begins_where_the_flight_does(offset: float) -> None:
    """However far the offset lies: v = v0 + a0 tau - … to the rounding of v0 and of what it changes by."""
    axis, law, _ = flight(SLIPPING, 0.7)
    axis["offset"], axis["a"] = offset, axis["u"] - offset
    axis["b"] = axis["v"] + law["decay"] * axis["a"]
    rate = law["stiffness"] / law["mass"] * (offset - axis["u"]) - 2 * law["decay"] * axis["v"]
    for tau in (0.0, 1e-30, 1e-20, 1e-14):
        change = rate * tau
        assert velocity(axis, law, tau)[0] - axis["v"] == pytest.approx(change, rel=1e-9, abs=1e-14)


REGIMES = [STUCK, ROLLING, SLIPPING]
ZETAS = [0.0, 0.03, 0.7, 0.999]
TIMES = [1e-9, 1e-5, 3e-4, 2e-3]


@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("zeta", ZETAS)
def test_flight_obeys_its_equation_of_motion(regime: int, zeta: float) -> None:
    """M u'' + c u' + K (u - offset) = 0, with u' and u'' the rates of u and u'; the ball feels -beta u'' + f."""
    axis, law, _ = flight(regime, zeta)
    for tau in TIMES[1:]:
        u, v, a = structure(axis, law, tau)
        force = law.mass * a + law.damping * v + law.stiffness * (u - axis.offset)
        assert abs(force) <= 1e-9 * law.stiffness * 3e-3
        step = 1e-3 * math.sqrt(law.mass / law.stiffness)
        ahead, behind = structure(axis, law, tau + step), structure(axis, law, tau - step)
        assert (ahead[0] - behind[0]) / (2 * step) == pytest.approx(v, rel=1e-4, abs=1e-4 * 7)
        assert (ahead[1] - behind[1]) / (2 * step) == pytest.approx(a, rel=1e-4, abs=1e-4 * 1e4)
        s, w, acceleration, jerk = relative(axis, law, tau)
        fore, aft = relative(axis, law, tau + step), relative(axis, law, tau - step)
        assert (fore[0] - aft[0]) / (2 * step) == pytest.approx(w, rel=1e-4, abs=1e-4 * 7)
        assert (fore[1] - aft[1]) / (2 * step) == pytest.approx(acceleration, rel=1e-4, abs=1e-4 * 1e4)
        assert (fore[2] - aft[2]) / (2 * step) == pytest.approx(jerk, rel=1e-4, abs=1e-4 * 1e7)
        assert acceleration == pytest.approx(axis.f - axis.beta * a, abs=1e-9 * 1e4)
        assert s - axis.s == pytest.approx(quad(lambda t: relative(axis, law, t)[1], 0, tau)[0], abs=1e-12)


@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("zeta", ZETAS)
def test_increments_are_differences(regime: int, zeta: float) -> None:
    """The series for short flights meets the closed form where both are good, and does not cancel where it is not."""
    axis, law, _ = flight(regime, zeta)
    for angle in (0.0999, 0.1001):
        tau = angle / law.frequency
        u, v, a = structure(axis, law, tau)
        du, dv, acceleration = increments(axis, law, tau)
        assert du == pytest.approx(u - axis.u - axis.v * tau, rel=1e-11)
        assert (dv, acceleration) == (pytest.approx(v - axis.v, rel=1e-12), pytest.approx(a, rel=1e-12))
    start = structure(axis, law, 0.0)[2]
    tau = 1e-9 / law.frequency
    assert increments(axis, law, tau)[0] == pytest.approx(0.5 * start * tau**2, rel=1e-8)


@pytest.mark.parametrize("zeta", [0.01, 0.3, 0.95])
@pytest.mark.parametrize("tau", TIMES)
def test_viscous_loss_is_an_integral(zeta: float, tau: float) -> None:
    axis, law, _ = flight(ROLLING, zeta)
    integral = quad(lambda t: law.damping * structure(axis, law, t)[1] ** 2, 0, tau, epsrel=1e-12)[0]
    assert viscous_loss(axis, law, tau) == pytest.approx(integral, rel=1e-11 if tau < 1e-4 else 1e-9)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("zeta", [0.0, 0.2, 0.9])
def test_first_extremum(order: int, zeta: float) -> None:
    """Where u, u' or u'' is extreme for the first time, by a dense search."""
    for u, v in ((3e-3, -7.0), (-1e-3, -2.0), (1e-3, 3.0)):
        axis, law, _ = flight(ROLLING, zeta, u=u, v=v)
        times = np.linspace(0.0, 1.01 * math.pi / law.frequency, 801)
        values = np.array([structure(axis, law, t)[order] for t in times])
        slopes = np.sign(np.diff(values))
        turn = times[1 + np.flatnonzero(slopes[1:] != slopes[:-1])[0]]
        assert first_extremum(axis, law, order) == pytest.approx(turn, abs=2 * times[1])


def oscillator(decay: float, frequency: float) -> np.record:
    """The law of a structure of unit mass."""
    law = np.zeros(1, LAW)[0]
    law["mass"], law["decay"], law["frequency"] = 1.0, decay, frequency
    law["damping"], law["stiffness"] = 2.0 * decay, decay**2 + frequency**2
    law["square"] = law["stiffness"]
    return law


@pytest.mark.parametrize("decay", [0.0, 0.02, 0.5, 3.0])
@pytest.mark.parametrize("phase", np.linspace(-3.1, 3.1, 12))
@pytest.mark.parametrize("threshold", [0.0, 0.3, 0.9])
def test_first_exceed(decay: float, phase: float, threshold: float) -> None:
    """First time at which exp(-decay t) (p cos w t + q sin w t) is above a threshold, by a dense search for w = 1."""
    p, q = math.cos(phase), math.sin(phase)
    times = np.linspace(0.0, 2 * math.pi, 20001)
    above = np.exp(-decay * times) * (p * np.cos(times) + q * np.sin(times)) > threshold
    found = first_exceed(p, q, oscillator(decay, 1.0), threshold)
    if not above.any():
        assert found == math.inf
    else:
        assert found == pytest.approx(times[above.argmax()], abs=times[1])
    assert first_exceed(p, 7.0 * q, oscillator(decay, 7.0), threshold) <= found or found == math.inf


def test_drive_is_the_inertia_of_a_stuck_ball() -> None:
    """d (K u + c v) / M1 along a stuck flight is -d u''."""
    for zeta in ZETAS:
        axis, law, _ = flight(STUCK, zeta)
        for d in (-1, 1):
            p, q = drive(axis, law, law.damping, d)
            for tau in (0.0, 1e-4, 7e-4):
                c, s = wave(law, tau)
                value = math.exp(-law.decay * tau) * (p * c + q * s)
                assert value == pytest.approx(-d * structure(axis, law, tau)[2], rel=1e-9)


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
