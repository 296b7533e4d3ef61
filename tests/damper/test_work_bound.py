"""The work bound against ring-downs that were not made to obey it, and against a motion that attains it."""

import dataclasses
import math

import numpy as np
import pytest

from damper import ParticleDamper, ringdown, work_bound
from tests.compiler import needs_compiler
from tests.damper.scenes import paper

BASE = paper()
LIGHT = 1e-4
"""m_p / M2: the bound holds to leading order in it."""


def random_case(seed: int) -> tuple[ParticleDamper, tuple[float, float]]:
    """A light ball in any cavity, and a release in any direction that sets it in motion."""
    draw = np.random.default_rng(seed)
    load = 10 ** draw.uniform(3, 6) if draw.random() < 0.8 else 0.0
    damper = dataclasses.replace(
        BASE,
        ball_mass=LIGHT * BASE.modal_mass,
        cavity=tuple(2e-3 + 10 ** draw.uniform(-5, -2, 2)),
        centrifugal_acceleration=load,
        restitution=draw.choice([0.0, 0.3, 0.5, 0.8, 0.95]),
        friction=draw.choice([0.0, 0.3, 2.0]),
        rolling_friction=draw.choice([0.0, 1e-5, 1e-4]),
        floor_friction=draw.choice([0.05, 0.5]) if load and draw.random() < 0.3 else None,
    )
    threshold = max(damper.rolling_threshold, 1e3) / damper.stuck_frequency**2
    amplitude, angle = threshold * 10 ** draw.uniform(0.05, 1.5), draw.uniform(0, math.pi / 2)
    return damper, (amplitude * math.cos(angle), amplitude * math.sin(angle))


@needs_compiler
@pytest.mark.parametrize("first", range(0, 300, 50))
def test_no_ring_down_takes_more(first: int) -> None:
    """What the ball has taken by the end is within the sum of what it may take in each cycle, both axes together."""
    shares = []
    for seed in range(first, first + 50):
        damper, release = random_case(seed)
        run = ringdown(damper, release, 30)
        taken = run.energy.rolling + run.energy.impact + run.energy.slip
        speeds = [*run.peak_velocities, run.peak_velocities[-1]]  # the run may end in the middle of a cycle
        energies = [0.5 * damper.stuck_mass * v**2 for v in speeds]
        bounds = [work_bound(damper, v / damper.stuck_frequency) for v in speeds]
        shares.append(taken / float(np.dot(bounds, energies)))
    assert max(shares) < 1 + 10 * LIGHT
    assert max(shares) > 0.3, "bounds that nothing comes near would show nothing"


@pytest.mark.parametrize("cavity", [(1.0, 1.0), (1.0, 3.0), (3.0, 1.0)])
@pytest.mark.parametrize("release", [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
def test_attained(release: tuple[float, float], cavity: tuple[float, float]) -> None:
    """A ball that rolls only while the acceleration is near its peak crosses its narrow cavity just then.

    It takes the work 2 m_p a_r d in a cycle on each axis that moves: the bound, but for the factor a_r / u''.
    """
    near, narrow, amplitude = 0.98, 1e-8, 1e-3
    clearance = narrow * np.array(cavity)
    damper = dataclasses.replace(BASE, ball_mass=1e-9 * BASE.modal_mass, cavity=tuple(2 * BASE.ball_radius + clearance))
    at = (release[0] * amplitude, release[1] * amplitude)
    threshold = near * amplitude * damper.stuck_frequency**2
    damper = dataclasses.replace(
        damper, rolling_friction=threshold * damper.ball_radius / damper.centrifugal_acceleration
    )
    cycles = 40
    run = ringdown(damper, at, cycles)
    taken = (run.energy.rolling + run.energy.impact) / cycles / run.energy.initial
    assert near * 0.97 < taken / work_bound(damper, at) < 1
    assert taken < work_bound(damper, math.hypot(*at))


def largest_bound(damper: ParticleDamper, amplitude: float) -> float:
    """Of all directions with the energy of that amplitude along x."""
    along_y = amplitude * math.sqrt(damper.stiffness[0] / damper.stiffness[1])
    angles = np.linspace(0, math.pi / 2, 2001)
    return max(work_bound(damper, (amplitude * math.cos(a), along_y * math.sin(a))) for a in angles)


def test_one_axis_both_axes_and_no_known_direction() -> None:
    clearance, amplitude = (0.5e-3, 0.4e-3), 7.6e-3
    damper = dataclasses.replace(BASE, cavity=(2.5e-3, 2.4e-3))
    share = 4 * damper.ball_mass / damper.modal_mass
    assert work_bound(damper, (amplitude, 0.0)) == pytest.approx(share * clearance[0] / amplitude, rel=1e-12)
    assert work_bound(damper, (0.0, -amplitude)) == pytest.approx(share * clearance[1] / amplitude, rel=1e-12)
    assert work_bound(damper, amplitude) == pytest.approx(largest_bound(damper, amplitude), rel=1e-6)
    assert work_bound(damper, amplitude) == pytest.approx(share * math.hypot(*clearance) / amplitude, rel=1e-12)


def test_axes_of_two_stiffnesses() -> None:
    """Without a direction the amplitude is that along x which has the energy."""
    stiffness = (BASE.stiffness[0], 3 * BASE.stiffness[1])
    damper = dataclasses.replace(BASE, stiffness=stiffness, cavity=(2.5e-3, 2.9e-3))
    assert work_bound(damper, 1e-2) == pytest.approx(largest_bound(damper, 1e-2), rel=1e-6)


@pytest.mark.parametrize("amplitude", [0.0, -1.0, math.nan, math.inf, (0.0, 0.0), (math.nan, 1.0), (1.0, math.inf)])
def test_no_amplitude(amplitude: float | tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="amplitude must be"):
        work_bound(BASE, amplitude)
