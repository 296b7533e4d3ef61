"""Cases in which an event-driven damper is known to stall, lose events or make energy."""

import dataclasses
import math

import numpy as np
import pytest

from damper import Formulation, Outcome, ParticleDamper, RingDown, capacity, ringdown, ringdowns, sample
from damper.state import HIT
from tests.compiler import needs_compiler
from tests.damper.scenes import paper

BASE = paper()
RELEASE = (20e-3, 5e-3)


def run(release: tuple[float, float] = RELEASE, cycles: float | None = 20, **changes: object) -> RingDown:
    if "ball_mass" in changes:  # keep the frequency of the paper-like scene
        stiffness = (1.0 + changes["ball_mass"]) * (2 * math.pi * 269.5) ** 2
        changes["stiffness"] = (stiffness, stiffness)
    return ringdown(dataclasses.replace(BASE, **changes), release, cycles, keep_events=True)


def sound(result: RingDown) -> None:
    """Finite, books closed, ball inside."""
    energy = result.energy
    assert math.isfinite(energy.final)
    assert energy.final <= energy.initial * (1 + 1e-12)
    assert abs(energy.residual) <= 1e-10 * energy.initial
    position = sample(result, np.linspace(0, result.duration, 500)).relative_position
    assert (np.abs(position) <= np.array(result.damper.half_gap) * (1 + 1e-12)).all()


def test_dead_ball() -> None:
    """e = 0: every hit sticks, there is no rebound to resolve."""
    result = run(restitution=0.0)
    sound(result)
    hits = result.rows[result.rows["kind"] == HIT]
    assert len(hits) > 0
    assert (hits["direction"] == 0).all()


@needs_compiler
def test_perfect_ball() -> None:
    """e = 1 and nothing else that takes energy: none may be lost over 1e5 impacts."""
    result = run(restitution=1.0, friction=0.0, rolling_friction=0.0, sticking_ratio=0.0, ball_mass=0.1, cycles=12_000)
    assert result.impacts > 1e5
    assert abs(result.energy.final / result.energy.initial - 1) < 1e-12


@pytest.mark.parametrize("e", [0.9, 0.999, pytest.param(1 - 1e-9, marks=needs_compiler)])
def test_nearly_perfect_ball(e: float) -> None:
    """e → 1: sequences of bounces of which each is hardly lower than the one before."""
    result = run(restitution=e)
    sound(result)
    assert result.outcome is Outcome.CYCLES_DONE


def test_no_clearance() -> None:
    """A ball that fills its cavity touches both walls for ever and must do nothing."""
    result = run(cavity=(2e-3, 2e-3))
    sound(result)
    assert result.impacts == 0
    assert result.last_motion is None
    assert result.energy.final == pytest.approx(result.energy.initial, rel=1e-13)


@pytest.mark.parametrize("clearance", [1e-6, 1e-9, 1e-12])
def test_hardly_any_clearance(clearance: float) -> None:
    """The time between hits tends to zero."""
    sound(run(cavity=(2e-3 + clearance, 2e-3 + clearance)))


def test_vast_cavity() -> None:
    """Clearance ≫ amplitude: walls that are never met."""
    result = run(cavity=(10.0, 10.0))
    sound(result)
    assert result.impacts == 0


def test_corner() -> None:
    """Both walls in the same instant, by symmetry: two hits at one time, in a decided order."""
    result = run(release=(10e-3, 10e-3), cavity=(2.4e-3, 2.4e-3))
    sound(result)
    hits = result.rows[result.rows["kind"] == HIT]
    assert list(hits["axis"][:2]) == [0, 1]
    assert hits["time"][1] - hits["time"][0] < 1e-15


@pytest.mark.parametrize("load", [0.003, 6.0, 250.0])
@pytest.mark.parametrize("ratio", [0.006, 1.0, 9.0])
def test_corner_with_slip(load: float, ratio: float) -> None:
    """A hit of one wall makes the ball slide along while it touches the other: that touch must not be missed."""
    amplitude, square = 1e-2, BASE.stuck_frequency**2
    changes = {"floor_friction": 0.3, "cavity": (2e-3 + 2 * amplitude,) * 2, "rolling_friction": 1e-7}
    result = run(
        (-amplitude, amplitude), 10, centrifugal_acceleration=load * square * amplitude, ball_mass=ratio, **changes
    )
    sound(result)
    assert result.impacts > 2


@pytest.mark.parametrize("clearance", [1e-10, 1e-5, pytest.param(1e-3, marks=needs_compiler)])
def test_flights_far_shorter_than_a_cycle(clearance: float) -> None:
    """A strong grip on the floor ends slip after a billionth of a cycle: the clock's rounding must not make energy."""
    changes = {"friction": 20.0, "floor_friction": 20.0, "restitution": 0.999, "damping_ratio": 0.8}
    load = 200 * BASE.stuck_frequency**2 * RELEASE[0]
    cavity = (2e-3 + clearance, 2e-3)
    result = run(
        cycles=3, ball_mass=700.0, centrifugal_acceleration=load, cavity=cavity, rolling_friction=1e-7, **changes
    )
    assert result.impacts > 10
    assert abs(result.energy.residual) <= 2e-13 * result.energy.initial


def test_grazing() -> None:
    """The ball reaches the wall with no speed left: a touch is a hit, takes nothing, and must not stall."""
    far = 1.0
    free = ParticleDamper(1e9, (1e-9, 1e-9), 1.0, 1e-3, (far, far), 1e4, 0.5, rolling_friction=1e-4, friction=0.3)
    reach = free.half_gap[0]
    v0 = math.sqrt(2 * 5 / 7 * free.rolling_threshold * reach)
    for speed in (v0 * (1 - 1e-15), v0, v0 * (1 + 1e-15), v0 * (1 + 1e-12)):
        result = ringdown(free, (0.0, 0.0), 1e-6, ball_velocity=(speed, 0.0), keep_events=True)
        assert result.impacts <= 2
        assert sample(result, result.duration).relative_position[0, 0] == pytest.approx(reach, rel=1e-9)


@pytest.mark.parametrize("e", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_infinite_bounces_at_a_turning_point(e: float, zeta: float) -> None:
    """Where the structure stands still, no hit is slow enough to stick by the ratio of speeds alone."""
    stiffness = 1.006 * (2 * math.pi * 88.0) ** 2
    result = run(restitution=e, damping_ratio=zeta, stiffness=(stiffness, stiffness), sticking_ratio=0.0, cycles=50)
    sound(result)
    assert result.impacts < 100_000


@pytest.mark.parametrize("ratio", [1e-9, 1e-6, 1e-3, 1.0, 1e3])
def test_mass_ratios(ratio: float) -> None:
    """From a grain of dust to a ball that carries the structure: u and s differ by 1e9."""
    sound(run(ball_mass=ratio))


def test_light_ball_leaves_the_structure_alone() -> None:
    """m_p → 0: the limit is the structure without a ball, at first order in the mass ratio."""
    lost = [1 - (r := run(ball_mass=m)).energy.final / r.energy.initial for m in (1e-6, 1e-7)]
    assert lost[0] < 1e-5
    assert lost[0] / lost[1] == pytest.approx(10, rel=0.1)


def test_ball_that_never_moves() -> None:
    """a_r >> |u''|: a threshold that is never met."""
    result = run(centrifugal_acceleration=1e9, cycles=None)
    assert result.events == 0
    assert result.outcome is Outcome.AT_REST


def test_floating_ball() -> None:
    """No rotation: no floor, the ball floats; momentum of ball and structure against the spring alone."""
    result = run(centrifugal_acceleration=0.0)
    sound(result)
    assert result.energy.rolling == 0
    assert result.largest_rolling_demand is None


def test_vanishing_rolling_resistance() -> None:
    """a_r → 0 is the limit a_r = 0 of a ball that still rolls."""
    limit = run(rolling_friction=0.0, friction=0.0, cycles=2).energy.final
    for lever in (1e-12, 1e-10):
        assert run(rolling_friction=lever, friction=0.0, cycles=2).energy.final == pytest.approx(limit, rel=1e-6)


def test_release_at_the_threshold() -> None:
    """Released with exactly a_r the ball stays, and goes on staying; a hair above, it trembles and rests."""
    omega = BASE.stuck_frequency
    amplitude = BASE.rolling_threshold / omega**2
    assert ringdown(BASE, (amplitude, 0.0), 50).events == 0
    above = ringdown(BASE, (amplitude * (1 + 1e-6), 0.0), 50)
    assert 0 < above.events < 500
    assert above.impacts == 0


@pytest.mark.parametrize("formulation", list(Formulation))
def test_release_by_rounding_above_the_threshold(formulation: Formulation) -> None:
    """A drive that exceeds the threshold by rounding sets nothing off: the ball would turn back in the same instant."""
    rng, base = np.random.default_rng(0), dataclasses.replace(BASE, formulation=formulation)
    drawn = {
        "stiffness": np.repeat(10 ** rng.uniform(2, 8, (300, 1)), 2, axis=1),
        "ball_mass": 10 ** rng.uniform(-9, 1, 300),
        "centrifugal_acceleration": 10 ** rng.uniform(2, 6, 300),
        "damping_ratio": rng.choice([0.0, 1e-3], 300),
    }
    threshold = BASE.rolling_friction / BASE.ball_radius * drawn["centrifugal_acceleration"]
    frequency = np.sqrt(drawn["stiffness"][:, 0] / (BASE.modal_mass + drawn["ball_mass"]))
    release = np.column_stack([threshold / frequency**2, np.zeros(300)])
    found = ringdowns(base, release, 3, max_events=1000, **drawn)
    assert (found.outcome == Outcome.CYCLES_DONE).all()
    assert (found.events < 20).all()


def test_sliding_ends_exactly_at_the_cap() -> None:
    """mu at its cap: sliding along the wall has ended, by impulse and spin, where friction would do so exactly."""
    base = ParticleDamper(3.0, (1e-12, 1e-12), 1.0, 1e-3, (0.022, 0.202), 0.0, 0.5)
    wx, wy = 1.0, 0.3
    give = 4 / 3  # 1/M2 + 1/m
    cap = wy / (give + 5 / 2) / (wx * 1.5 / give)
    for mu in (cap * (1 - 1e-15), cap, cap * (1 + 1e-15)):
        period = 2 * math.pi / base.stuck_frequency
        damper = dataclasses.replace(base, friction=mu)
        result = ringdown(damper, (0.0, 0.0), 0.015 / period, ball_velocity=(wx, wy), keep_events=True)
        left = sample(result, result.duration).relative_velocity[0, 1]
        assert abs(left - 5 / 2 * (wy - left) / give) < 1e-12


def test_chatter_of_the_printed_equations() -> None:
    """With two dashpots, stuck and rolling accelerations differ at the threshold: the ball must not chatter."""
    result = run(formulation=Formulation.PRINTED, damping_ratio=0.2, cycles=None)
    assert result.rested
    assert result.events < 1000


@needs_compiler
def test_a_million_cycles() -> None:
    """Time grows, the resolution of the clock does not: the books still close."""
    result = ringdown(dataclasses.replace(BASE, restitution=1.0, rolling_friction=0.0, ball_mass=1e-3), (2e-4, 0), 1e6)
    assert result.outcome is Outcome.CYCLES_DONE
    assert abs(result.energy.residual) <= 1e-9 * result.energy.initial
    assert len(capacity(result).sdc) > 9e5


def test_event_cap_ends_a_run() -> None:
    """A run that would go on is ended by a typed outcome, with everything it has so far."""
    result = ringdown(BASE, RELEASE, 1000, max_events=100)
    assert result.outcome is Outcome.EVENT_CAP
    assert 100 <= result.events <= 101
    assert result.energy.residual == pytest.approx(0, abs=1e-12 * result.energy.initial)
