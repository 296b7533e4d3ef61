"""Linear flights - tilting and curved floors, several modes, harmonic forces - against a dense integration."""

import math
from dataclasses import replace

import numpy as np
import pytest

from damper import Harmonic, Mode, ParticleDamper, ringdown
from damper.state import HIT
from tests.compiler import needs_compiler, some
from tests.damper.reference import Reference, agreed, events
from tests.damper.scenes import let_go, simple

PERIODS = 1.0


def scene(seed: int) -> tuple[ParticleDamper, tuple[float, ...], Harmonic | None]:
    """A damper, amplitudes of its modes at release, and a harmonic; about unit size."""
    rng = np.random.default_rng(seed)
    ball, load = 10 ** rng.uniform(-3, -0.3), 10 ** rng.uniform(0, 2)
    share = rng.choice([0.0, rng.uniform(-1.0, 1.6)], p=[0.2, 0.8], size=2)
    bowl = 10 ** rng.uniform(-1, 1.3, 2)  # square of the pendulum's frequency, over 5/7
    modes = None
    if rng.random() < 0.5:
        modes = tuple(
            Mode(
                mass=10 ** rng.uniform(-0.3, 0.7),
                stiffness=10 ** rng.uniform(-0.3, 1.3),
                shape=(rng.normal(), rng.normal() * rng.choice([0.0, 1.0])),
                slope=tuple(rng.normal(size=2) / load),
                damping_ratio=rng.choice([None, rng.uniform(0, 0.1)]),
                drawn=tuple(rng.normal(size=2)),
            )
            for _ in range(rng.integers(2, 4))
        )
    damper = ParticleDamper(
        modal_mass=1.0,
        stiffness=(1 + ball, (1 + ball) * rng.choice([1.0, rng.uniform(0.5, 4)])),
        ball_mass=ball,
        ball_radius=1.0,
        cavity=tuple(2 + 2 * 10 ** rng.uniform(-1.3, 0.3, 2)),
        centrifugal_acceleration=load,
        restitution=rng.uniform(0.2, 1),
        friction=rng.choice([0.0, rng.uniform(0, 0.6)]),
        rolling_friction=rng.choice([0.0, rng.uniform(0, 0.5)], p=[0.1, 0.9]) / load,
        damping_ratio=rng.choice([0.0, 10 ** rng.uniform(-3, -0.7)]),
        floor_friction=rng.choice([None, None, rng.uniform(0.05, 1.0) / load * 3]),
        floor_tilt=(0.0, 0.0) if modes else tuple(np.minimum(share / load, 1.0)),
        floor_radius=tuple(1 + load / bowl) if rng.random() < 0.5 else None,
        rotation=rng.choice([0.0, rng.uniform(0.1, 0.7)]),
        stagger=rng.choice([0.0, rng.uniform(-1.6, 1.6)]),
        modes=modes,
    )
    size = len(modes) if modes else 2
    harmonic = None
    if rng.random() < 0.4:
        harmonic = Harmonic(
            rng.uniform(0.3, 3), tuple(rng.normal(size=2)), tuple(rng.normal(size=size)), tuple(rng.normal(size=2)), 1.0
        )
    return damper, tuple(rng.normal(size=size)), harmonic


@needs_compiler
@pytest.mark.parametrize("seed", some(80, without=0))
def test_against_the_reference(seed: int) -> None:
    agrees(*scene(seed))


@needs_compiler
@pytest.mark.parametrize("seed", some(20, without=0))
def test_a_lateral_pull_against_the_reference(seed: int) -> None:
    """From a tenth of what holds the ball to ten times that, along x and y."""
    damper, amplitudes, harmonic = scene(seed + 500)
    pull = np.random.default_rng(seed).normal(size=2) * 10 ** np.linspace(-1, 1, 20)[seed]
    agrees(replace(damper, lateral_acceleration=tuple(pull * (damper.rolling_threshold + 0.1))), amplitudes, harmonic)


def agrees(damper: ParticleDamper, amplitudes: tuple[float, ...], harmonic: Harmonic | None) -> None:
    """Events, energies and work agree with the reference as far as it knows them itself."""
    motion = let_go(damper, amplitudes, PERIODS, harmonic=harmonic, max_events=10_000)
    books = motion.energy
    assert abs(books.residual) <= 1e-12 * (books.initial + abs(books.work) + abs(books.final))
    one = Reference(damper, amplitudes, PERIODS, 512, harmonic, most=25)
    ours = events(motion)
    same = agreed(ours, one.events)
    whole = len(one.events) < 25
    if same < len(one.events) or (whole and len(ours) != same):  # how far does the reference know?
        other = Reference(damper, amplitudes, PERIODS, 2048, harmonic, most=25)
        known = agreed(one.events, other.events, 1e-10)
        assert same >= known
        assert known < len(one.events) or len(one.events) == len(other.events) == len(ours)
        return
    assert books.initial == pytest.approx(one.initial, rel=1e-12, abs=1e-12)
    if whole:
        scale = abs(books.initial) + abs(books.work)
        assert books.final == pytest.approx(one.final, abs=1e-9 * scale)
        assert books.work == pytest.approx(one.work, abs=1e-9 * scale)


@pytest.mark.parametrize("of_the_load", [False, True])
def test_a_constant_force_on_the_ball(of_the_load: bool) -> None:
    """A load at a slope to the floor, or a mode too heavy to move: the ball falls by 5/7 of G θ and bounces by e."""
    load, slope, half, e = 2.2e5, 1e-4, 0.049, 0.5
    along = [Mode(mass=1e9, stiffness=1e11, shape=shape) for shape in ((1.0, 0.0), (0.0, 1.0))]
    leans = Mode(mass=1e12, stiffness=1e-12, shape=(0.0, 0.0), slope=(slope, 0.0))
    damper = ParticleDamper(1e9, (1e11, 1e11), 1e-3, 1e-3, (2 * half + 2e-3, 0.1), load, e, modes=(*along, leans))
    run = ringdown(damper, (0.0, 0.0), 0.5, amplitudes=(0.0, 0.0, 1.0), keep_events=True)
    if of_the_load:
        damper = replace(damper, modes=None, lateral_acceleration=(-load * slope, 0.0))
        run = ringdown(damper, (0.0, 0.0), 0.5, keep_events=True)
    hits = run.rows["time"][run.rows["kind"] == HIT]
    fall = math.sqrt(2 * half / (5 / 7 * load * slope))
    expected = fall + np.cumsum([0.0, *(2 * fall * e**k for k in range(1, 5))])
    np.testing.assert_allclose(hits[:5], expected, rtol=1e-9)
    assert run.energy.initial - run.energy.final == pytest.approx(1e-3 * load * slope * half, rel=1e-9)
    assert abs(run.energy.residual) < 1e-12 * run.energy.impact


def test_a_force_slower_than_the_run_has_no_peaks_yet() -> None:
    """Velocity maxima are counted by the force's cycles: the first stands within the first half of one."""
    damper = simple(ball_mass=1e-3, centrifugal_acceleration=1.0)
    for share, peaks in ((0.45, 0), (0.55, 1)):
        force = Harmonic(frequency=share * damper.stuck_frequency / 10, force=(1.0, 0.0))
        assert len(ringdown(damper, (0.0, 0.0), 10, harmonic=force).peak_times) == peaks
