"""Closed-form results of mechanics that the engine must give back."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from damper import (
    Formulation,
    Mode,
    Outcome,
    ParticleDamper,
    RingDown,
    capacity,
    damping_curve,
    intrinsic_sdc,
    ringdown,
    sample,
    work_bound,
)
from damper.state import GRIP, HIT, REVERSAL, ROLLING, STUCK
from tests.compiler import needs_compiler
from tests.damper.scenes import paper

HEAVY = 1e15  # a structure that the ball does not move


def heavy(omega: float, gap: float, **changes: object) -> ParticleDamper:
    """A free ball in a heavy structure that oscillates at `omega`."""
    stiffness, side = HEAVY * omega**2, 2 * (gap + 1e-3)
    base = ParticleDamper(HEAVY, (stiffness,) * 2, 1.0, 1e-3, (side, side), 0.0, 0.5, sticking_ratio=0.0)
    return dataclasses.replace(base, **changes)


def thrown(damper: ParticleDamper, seconds: float, *velocity: float, **start: object) -> RingDown:
    """A ball that is thrown in a structure at rest, and its events."""
    cycles = seconds * damper.stuck_frequency / (2 * math.pi)
    return ringdown(damper, (0.0, 0.0), cycles, ball_velocity=velocity, keep_events=True, **start)


def of(run: RingDown, kind: int) -> Any:
    """Its events of a kind."""
    return run.rows[run.rows["kind"] == kind]


@pytest.mark.parametrize(("e", "zeno"), [(0.5, 1.354571), (0.8, 4.063713)])
def test_zeno_time(e: float, zeno: float) -> None:
    """A ball dropped by 1 m under 9.81 m/s^2 comes to rest after sqrt(2h/g) (1+e)/(1-e).

    The structure, so slow that its acceleration is constant, is the falling frame.
    """
    omega = 3e-4
    frame = heavy(omega, 1.0, restitution=e)
    run = ringdown(frame, (-9.81 / omega**2, 0.0), cycles=10 * omega / 2 / math.pi, keep_events=True)
    hits = of(run, HIT)
    assert hits["direction"][-1] == 0, "the sequence ends in sticking"
    assert hits["time"][-1] == pytest.approx(zeno, rel=2e-5)
    assert len(hits) < 200


def test_free_rolling_stops() -> None:
    """On a structure at rest a rolling ball runs 7 v0^2 / (10 a_r)."""
    damper = heavy(1e-6, 10.0, centrifugal_acceleration=1e3, rolling_friction=1e-4)
    v0 = 3.0
    run = ringdown(damper, (0.0, 0.0), 1e-5, ball_velocity=(v0, 0.0), keep_events=True)
    stop = of(run, REVERSAL)[0]
    assert stop["s"] == pytest.approx(7 * v0**2 / (10 * damper.rolling_threshold), rel=1e-12)
    assert stop["direction"] == 0
    assert run.energy.rolling == pytest.approx(0.5 * 1.4 * v0**2, rel=1e-12), "all of the energy of rolling"


@pytest.mark.parametrize("e", [0.0, 0.3, 0.9, 1.0])
@pytest.mark.parametrize("mass_ratio", [1e-9, 1e-2, 1.0, 1e3])
def test_one_impact(e: float, mass_ratio: float) -> None:
    """Momentum is kept, the relative speed is multiplied by e, and half m (1-e^2) w^2 is lost."""
    m2, mp, w0 = 2.0, 2.0 * mass_ratio, 0.7
    damper = ParticleDamper(m2, (1e-12, 1e-12), mp, 1e-3, (0.022, 0.022), 0.0, e, sticking_ratio=0.0)
    run = thrown(damper, 0.02, w0, 0.0)
    assert run.impacts == 1
    after = sample(run, run.duration)
    v, w = after.velocity[0, 0], after.relative_velocity[0, 0]
    assert w == pytest.approx(-e * w0, abs=1e-12)
    assert m2 * v + mp * (v + w) == pytest.approx(mp * w0, rel=1e-12)
    reduced = m2 * mp / (m2 + mp)
    assert run.energy.impact == pytest.approx(0.5 * reduced * (1 - e**2) * w0**2, rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("mu", [0.05, 5.0])
@pytest.mark.parametrize("load", [0.0, 1e-6, 1e-6 + 1e-9j])
def test_oblique_impact(mu: float, load: complex) -> None:
    """A rough sphere against a wall (Keller, J. Appl. Mech. 53 (1986) 1): Newton's and Euler's laws with Coulomb's.

    Friction acts at the rim: m v' = m v - P, M V' = P, 2/5 m r² w' = r P about the vertical, until the sliding ends,
    v' - V' - r w' = 0, or up to mu times the normal impulse. The floor, tilting or not, has no time to act.
    """
    m, structure, r, e, speed, along = 1.0, 3.0, 1e-3, 0.5, 1.0, 0.5
    damper = ParticleDamper(
        structure, (1e-12,) * 2, m, r, (0.022, 0.202), load.real, e, mu, floor_tilt=(load.imag, load.imag)
    )
    run = thrown(damper, 0.015, speed, along)
    after = sample(run, run.duration)
    laws = np.array([[m, 0, 0, 1], [0, structure, 0, -1], [0, 0, 0.4 * m * r, -1], [1, -1, -r, 0]])
    ball, wall, turning, impulse = np.linalg.solve(laws, [m * along, 0, 0, 0])
    normal = (1 + e) * speed / (1 / m + 1 / structure)
    if impulse > mu * normal:
        impulse = mu * normal
        ball, wall, turning = along - impulse / m, impulse / structure, impulse / (0.4 * m * r)
    assert after.relative_velocity[0, 1] == pytest.approx(ball - wall, rel=1e-6)
    assert after.velocity[0, 1] == pytest.approx(wall, rel=1e-6)
    lost = 0.5 * (m * (along**2 - ball**2) - structure * wall**2 - 0.4 * m * (r * turning) ** 2)
    assert lost >= 0
    spun = 0.2 * m * (along**2 - (ball - wall) ** 2) if load else 0.0  # a ball on a floor rolls on at its new velocity
    booked = 0.5 * (m * (along**2 - ball**2) - structure * wall**2) + spun
    across = 0.5 * (1 - e**2) * speed**2 / (1 / m + 1 / structure) + (0.2 * m * (1 - e**2) * speed**2 if load else 0.0)
    assert run.energy.impact == pytest.approx(booked + across, rel=1e-6)


def test_a_published_oblique_impact() -> None:
    """Alumina spheres of 5 mm on glass at 3.9 m/s, e = 0.98, mu = 0.092: what is left of the velocity along the wall.

    Kharaz, Gorham and Salman, Powder Technology 120 (2001) 281, by angles from the normal. Steeper than 30 degrees the
    sphere slides throughout. Below, it leaves with about the 5/7 of rolling, up to a sixth less or a ninth more, by the
    elasticity along the surface (Maw, Barber and Fawcett 1976), which is left out.
    """
    angles = (1.84, 3.703, 9.496, 20.012, 30.127, 39.382, 49.694, 60.02)
    measured = (0.79344, 0.74533, 0.67257, 0.59691, 0.68756, 0.77148, 0.84761, 0.90142)
    for angle, ratio in zip(np.radians(angles), measured, strict=True):
        across, along = 3.9 * math.cos(angle), 3.9 * math.sin(angle)
        damper = ParticleDamper(1e6, (1e-6,) * 2, 2.6e-4, 2.5e-3, (0.025, 1.0), 0.0, 0.98, 0.092)
        run = thrown(damper, 0.015 / across, across, along)
        after = sample(run, run.duration).relative_velocity[0]
        assert after[0] == pytest.approx(-0.98 * across)
        assert after[1] / along == pytest.approx(ratio, rel=0.02 if angle > 0.6 else 0.2)


def test_the_printed_friction_stops_the_centre() -> None:
    """Eq. (11): rough enough walls leave no velocity along them."""
    damper = ParticleDamper(3.0, (1e-12,) * 2, 1.0, 1e-3, (0.022, 0.202), 1e-6, 0.5, 5.0)
    damper = dataclasses.replace(damper, formulation=Formulation.PRINTED)
    run = thrown(damper, 0.015, 1.0, 0.5)
    assert sample(run, run.duration).relative_velocity[0, 1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("e", "least"), [(0.3, 0.32427), (0.6, 0.15718), (0.8, 0.07056)])
def test_two_impacts_a_cycle(e: float, least: float) -> None:
    """A heavy host A sin(wt) carries two symmetric impacts a cycle only if A/b is large enough.

    The ball leaves the right wall at phase p so as to meet the left one half a period later; the orbit exists
    where the hit then sends it back as it came. The mismatch changes sign over the phases only above the limit.
    """

    def mismatch(amplitude: float, phase: float) -> float:
        omega, b = 1.0, 1.0
        host, rate = amplitude * math.sin(phase), amplitude * omega * math.cos(phase)
        speed = 2 * omega * (host + b) / math.pi
        start = {"velocity": (rate, 0.0), "ball_position": (b, 0.0), "ball_velocity": (-speed - rate, 0.0)}
        run = ringdown(heavy(omega, b, restitution=e), (host, 0.0), 0.5 + 1e-9, **start, keep_events=True)
        hits = of(run, HIT)
        assert len(hits) == 1
        assert hits["time"][0] == pytest.approx(math.pi, abs=1e-9)
        return float(hits["v"][0] + hits["w"][0] - speed)

    exact = (1 + (math.pi / 2 * (1 + e) / (1 - e)) ** 2) ** -0.5
    assert exact == pytest.approx(least, abs=5e-6)
    phases = np.linspace(1.65, 4.6, 60)  # the host retreats, and the ball gets away from it
    above = [mismatch(1.02 * exact, p) for p in phases]
    below = [mismatch(0.98 * exact, p) for p in phases]
    assert min(above) < 0 < max(above)
    assert min(below) > 0 or max(below) < 0


def test_structure_alone_decays_as_it_should() -> None:
    """A ball that never moves: sdc is the structure's own in every cycle, and the damping books close."""
    damper = paper(damping_ratio=0.02, centrifugal_acceleration=1e9)
    run = ringdown(damper, (1e-3, 0.0), 30)
    result = capacity(run)
    zeta = 0.02 / math.sqrt(1.006)  # the dashpot 2 zeta w2 M2 against the stuck mass
    exact = 1 - math.exp(-4 * math.pi * zeta / math.sqrt(1 - zeta**2))
    assert run.impacts == 0
    assert run.last_motion is None
    assert result.cutoff is None
    assert result.intrinsic_sdc == pytest.approx(exact, rel=1e-12)
    assert result.intrinsic_sdc == intrinsic_sdc(damper)
    np.testing.assert_allclose(result.sdc, exact, rtol=1e-10)
    assert abs(run.energy.residual) < 1e-13 * run.energy.initial


def slippery(e: float = 0.5, **changes: object) -> ParticleDamper:
    """A ball that slips, in a structure so heavy and slow that it is a floor at rest."""
    return heavy(1e-6, 10.0, **{"centrifugal_acceleration": 2e3, "restitution": e, "floor_friction": 0.3} | changes)


def at_the_wall(damper: ParticleDamper, cycles: float = 1.0) -> RingDown:
    """The slippery ball rolls at 3 m/s, 1 mm before a wall."""
    start = {"ball_position": (9.999, 0.0), "ball_velocity": (3.0, 0.0)}
    return ringdown(damper, (0.0, 0.0), cycles, keep_events=True, **start)


def test_slip_to_roll() -> None:
    """A ball that slides without spin rolls with 5/7 of its speed after 2 u0 / (7 mu g)."""
    damper, u0 = slippery(), 3.0
    run = ringdown(damper, (0.0, 0.0), 1e-8, ball_velocity=(u0, 0.0), ball_spin=(0.0, 0.0), keep_events=True)
    grip = of(run, GRIP)[0]
    assert grip["time"] == pytest.approx(2 * u0 / (7 * 0.3 * 2e3), rel=1e-9)
    assert grip["w"] == pytest.approx(5 / 7 * u0, rel=1e-9)
    assert run.energy.slip == pytest.approx(0.5 * 2 / 7 * u0**2, rel=1e-9)


@pytest.mark.parametrize("e", [0.41, 0.5, 0.8, 1.0])
def test_effective_restitution_of_a_rolling_ball(e: float) -> None:
    """It leaves a wall with its old spin and rolls at (2 - 5e)/7 of its speed, momentum about the contact kept."""
    run = at_the_wall(slippery(e))
    hits, grips = of(run, HIT), of(run, GRIP)
    assert grips["w"][0] == pytest.approx((2 - 5 * e) / 7 * 3.0, rel=1e-6)
    assert grips["time"][0] > hits["time"][0]


@pytest.mark.parametrize("tilt", [0.0, 1e-13])
@pytest.mark.parametrize(("friction", "spin"), [(0.3, 2 / 7), (0.05, 1 - 2.5 * 0.05 * 1.5)])
def test_the_wall_takes_spin(friction: float, spin: float, tilt: float) -> None:
    """A vertical impulse at the wall, at most mu J or what ends the sliding there; at mu = 0.3, e = 0.5 the effective
    restitution is 0.276 instead of 0.071, on either way through the engine."""
    damper = slippery(0.5, friction=friction, floor_tilt=(tilt, tilt))
    run = at_the_wall(damper)
    hit, grip = (of(run, kind)[0] for kind in (HIT, GRIP))
    assert hit["spin"] == pytest.approx(3.0 * spin, rel=1e-6)
    assert grip["w"] == pytest.approx(-3.0 * (5 * 0.5 - 2 * spin) / 7, rel=1e-6)
    if friction == 0.3:
        assert -grip["w"] / 3.0 == pytest.approx(0.276, abs=5e-4)
    books = at_the_wall(damper, 1.001 * grip["time"] * damper.stuck_frequency / (2 * math.pi)).energy
    assert books.impact + books.slip == pytest.approx(0.7 * (9.0 - grip["w"] ** 2), rel=1e-6)


@pytest.mark.parametrize(("e", "presses"), [(0.11, True), (0.12, False)])
def test_below_which_restitution_the_ball_comes_back_to_the_wall(e: float, presses: bool) -> None:
    """0.114 with the wall's friction, where it was 0.4 without."""
    run = at_the_wall(slippery(e, friction=0.6), 1e-3)
    assert (of(run, GRIP)["w"][0] > 0) == presses


@pytest.mark.parametrize("e", [0.0, 0.2, 0.39])
def test_a_dull_rolling_ball_keeps_pressing_the_wall(e: float) -> None:
    """Below e = 0.4 the ball bounces on the wall, friction pressing it there, until its spin is spent."""
    damper = slippery(e, rolling_friction=1e-9)
    run = at_the_wall(damper)
    last = run.rows[run.rows["axis"] == 0][-1]
    assert (last["kind"], last["regime"], last["spin"]) == (GRIP, STUCK, 0.0)
    assert last["s"] == damper.half_gap[0]
    assert run.energy.impact + run.energy.slip == pytest.approx(0.5 * 1.4 * 9.0, rel=1e-6)


@pytest.mark.parametrize("zeta", [pytest.param(0.0, marks=needs_compiler), 0.01])
def test_cutoff_is_the_rolling_threshold(zeta: float) -> None:
    """The last moving cycle's amplitude is mu_r / r of the load, within one cycle's decay."""
    damper = paper(damping_ratio=zeta)
    result = capacity(ringdown(damper, (20e-3, 0.0)))
    ratio = result.cutoff / damper.centrifugal_acceleration
    decay = math.sqrt(1 - float(result.sdc[-1]))
    assert 0.1 <= ratio <= 0.1 / decay**1.3 * (1 + 2e-3)  # 2e-3: where an undamped tremor is called rest


@needs_compiler
def test_bounds_hold() -> None:
    """No cycle loses more than the work bound, nor than two hits of a free ball could take."""
    for e in (0.0, 0.3, 0.5, 0.8, 0.99):
        damper = paper(restitution=e)
        result = capacity(ringdown(damper, (20e-3, 0.0), 300))
        bounds = [work_bound(damper, (v / damper.stuck_frequency, 0.0)) for v in result.peak_velocity]
        assert (result.sdc < np.array(bounds) * (1 + 0.02)).all()
        assert result.sdc.max() < 8 * damper.ball_mass / damper.modal_mass * (1 + e) / (1 - e)


@pytest.mark.parametrize("zeta", [0.0, 0.2])
@pytest.mark.parametrize("formulation", list(Formulation))
def test_rolling_demand_is_what_accelerates_the_ball(zeta: float, formulation: Formulation) -> None:
    """Between hits only the floor pushes the ball: m q'' over its load, by differences of the sampled velocity."""
    damper = paper(formulation=formulation, damping_ratio=zeta, ball_mass=0.05, restitution=0.9)
    run = ringdown(damper, (20e-3, 7e-3), 1, keep_events=True)
    assert run.impacts > 2
    found = 0.0
    times = np.unique(run.rows["time"])
    for begin, end in zip(times, [*times[1:], run.duration], strict=True):
        inside = begin + (end - begin) * np.linspace(1e-6, 1 - 1e-6, 60)
        at = sample(run, inside)
        rate = np.diff(at.velocity + at.relative_velocity, axis=0) / np.diff(inside)[:, None]
        rolls = (at.regime[:-1] == ROLLING) & (end - begin > 1e-9)
        found = max(found, np.abs(rate[rolls]).max(initial=0.0))
    assert run.largest_rolling_demand == pytest.approx(found / damper.centrifugal_acceleration, rel=2e-2)


@pytest.mark.parametrize("mass", [0.2, 7.0])
def test_dashpot_of_a_structure_of_any_mass(mass: float) -> None:
    """c = 2 zeta sqrt(K M2): with a ball of no weight the ratio is zeta itself."""
    damper = paper(modal_mass=mass, ball_mass=1e-12, damping_ratio=0.03)
    exact = 1 - math.exp(-4 * math.pi * 0.03 / math.sqrt(1 - 0.03**2))
    assert intrinsic_sdc(damper) == pytest.approx(exact, rel=1e-9)


def test_a_tremor_is_rest() -> None:
    """Without damping a ball a hair above the threshold nears it for ever: the run ends soon, and it counts as rest."""
    base = paper()
    amplitude = base.rolling_threshold / base.stuck_frequency**2
    run = ringdown(base, (amplitude * 1.0005, 0.0))
    assert run.outcome is Outcome.TREMBLES
    assert run.rested
    assert run.duration * base.stuck_frequency < 2 * math.pi * 20
    assert capacity(run).cutoff == pytest.approx(base.rolling_threshold, rel=2e-3)
    assert ringdown(base, (amplitude * 1.0005, 0.0), 30).outcome is Outcome.CYCLES_DONE


def test_a_vibration_dies_out() -> None:
    """A ball afloat never rests; once the structure does, the run ends, without a cut-off."""
    damper = paper(centrifugal_acceleration=0.0, damping_ratio=0.2)
    run = ringdown(damper, (2e-3, 0.0))
    assert run.outcome is Outcome.DIED_OUT
    assert not run.rested
    assert capacity(run).cutoff is None
    assert run.peak_velocities[-1] < 1e-5 * run.peak_velocities[0]


def test_a_sliding_ball_goes_from_wall_to_wall() -> None:
    """On a floor too slippery to turn it, it hits the walls in turn, after the time that its speed asks for."""
    gap, speed = 1e-2, 3.0
    damper = slippery(1.0, floor_friction=1e-9, cavity=(2 * (gap + 1e-3),) * 2)
    run = thrown(damper, 0.035, speed, 0.0, ball_spin=(0.0, 0.0))
    hits = of(run, HIT)
    assert hits["s"] == pytest.approx([gap, -gap, gap, -gap, gap], rel=1e-12)
    assert hits["time"] == pytest.approx([(2 * k + 1) * gap / speed for k in range(5)], rel=1e-6)


@pytest.mark.parametrize("tilt", [0.0, 1e-9])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_start_on_a_wall_with_spin_into_it(side: int, tilt: float) -> None:
    """Sliding friction presses the ball onto the wall until its spin is spent, after |spin| / (5/2 mu G)."""
    rolls = ParticleDamper(1.0, (1e6, 1e6), 0.01, 1e-3, (4e-3, 4e-3), 1e4, 0.5, 0.3, 1e-5)
    damper = dataclasses.replace(rolls, floor_friction=0.1, floor_tilt=(tilt, tilt))
    place, spin = (side * 1e-3, 0.0), (side * 0.3, 0.0)
    run = ringdown(damper, (1e-4, 0.0), 5, ball_position=place, ball_spin=spin, keep_events=True)
    grip = of(run, GRIP)[0]
    assert grip["time"] == pytest.approx(0.3 / (2.5 * 0.1 * 1e4), rel=1e-12)
    assert grip["s"] == place[0]
    assert abs(run.rows["s"]).max() <= 1e-3
    assert run.energy.slip == pytest.approx(0.5 * 0.4 * 0.01 * 0.3**2, rel=1e-12)
    assert abs(run.energy.residual) <= 1e-13 * run.energy.initial


@pytest.mark.parametrize("series", [False, True])
def test_restitution_by_impact_speed(series: bool) -> None:
    """A free ball between heavy walls: each hit takes from its speed what the pairs say, whatever flights are.

    Between the pairs e is linear in the logarithm of the speed, above the last it falls as v^(-1/4).
    """
    pairs, first = ((0.5, 0.9), (1.0, 0.7), (4.0, 0.6)), 9.0
    damper = heavy(1e-4, 1.0, restitution=0.9, restitution_by_speed=pairs)
    modes = tuple(Mode(HEAVY, damper.stiffness[0], shape) for shape in ((1.0, 0.0), (0.0, 1.0)))
    damper = dataclasses.replace(damper, modes=modes) if series else damper
    run = ringdown(damper, (0.0, 0.0), 1e-3, ball_velocity=(first, 0.0), keep_events=True)
    hits, speed = of(run, HIT), first
    assert hits["w_before"][-1] ** 2 < 0.5**2 < 4.0**2 < first**2
    for k, hit in enumerate(hits):
        if speed > 4.0:
            e = 0.6 * (4.0 / speed) ** 0.25
        elif speed > 1.0:
            e = 0.7 - 0.1 * math.log(speed) / math.log(4.0)
        else:
            e = 0.9 - 0.2 * math.log2(speed / 0.5) if speed > 0.5 else 0.9
        speed *= e
        assert hit["w"] == pytest.approx(-speed if k % 2 == 0 else speed, rel=1e-9)
    assert run.energy.impact == pytest.approx(0.5 * (first**2 - speed**2), rel=1e-8)


def test_hits_that_lose_nothing_only_when_slow_still_damp() -> None:
    """Without rolling friction: at the peak hits are faster than those that are elastic."""
    free = ParticleDamper(1.0, (2.87e6, 2.87e6), 6e-3, 1e-3, (2.5e-3, 2.4e-3), 2e5, 1.0)
    assert damping_curve(free).peak == 0.0
    assert damping_curve(dataclasses.replace(free, restitution_by_speed=((1e-3, 1.0), (1e-2, 0.5)))).peak > 1e-3


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        (((2.0, 0.5), (1.0, 0.4)), "in ascending order"),
        (((0.0, 0.5),), "in ascending order"),
        (((1.0, 0.5), (2.0, 1.1)), "between 0 and 1"),
        (((1.0, 0.4),), "up to its first speed"),
        (((1.0,),), "two numbers"),
        (0.5, "at most 16 pairs"),
    ],
)
def test_pairs_that_make_no_sense(pairs: object, message: str) -> None:
    with pytest.raises(ValueError, match=f"restitution_by_speed must be .*{message}"):
        heavy(1.0, 1.0, restitution_by_speed=pairs)
