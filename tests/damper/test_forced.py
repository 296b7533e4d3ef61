"""Steady states under a harmonic force: the textbook's oscillator, published orbits, a dense integration, the books."""

import math
from dataclasses import replace

import numpy as np
import pytest

from damper import Formulation, Harmonic, Mode, ParticleDamper, Regime, Start, forced, moves_from, ringdown, sample
from tests.compiler import needs_compiler, some
from tests.damper.reference import Reference
from tests.damper.scenes import paper
from tests.damper.test_floor import absorber, steady
from tests.damper.test_linear import scene

ZETA = 1e-3


def textbook(damper: ParticleDamper, nu: float, mass: float | None = None) -> complex:
    """Complex displacement along x per unit force, the ball at rest in its cavity (or a mass of one's own)."""
    m, k = damper.stuck_mass if mass is None else mass, damper.stiffness[0]
    c = 2 * damper.damping_ratio * math.sqrt(k * damper.modal_mass)
    return 1 / (k - m * nu**2 + 1j * c * nu)


@pytest.mark.parametrize("zeta", [ZETA, 0.05])
def test_a_locked_ball_is_the_textbook_s_oscillator(zeta: float) -> None:
    """Through resonance: displacement, velocity, phase and power, at once and held by the motion itself."""
    damper = paper(damping_ratio=zeta, rolling_friction=1e-3)
    omega, size, phase = damper.stuck_frequency, 3.0, 0.7
    ratios = np.unique([*np.linspace(0.3, 2, 18), *(1 + zeta * np.linspace(-3, 3, 13)), 1.0])
    harmonics = [Harmonic(omega * r, (size, 0.0), phase=phase) for r in ratios]
    found = forced(damper, harmonics, [Start.UP])
    assert (found.regime == Regime.LOCKED).all()
    assert (found.cycles == 0).all()
    for k, harmonic in enumerate(harmonics):
        z = size * textbook(damper, harmonic.frequency) * np.exp(1j * phase)
        assert abs(found.linear[k] / z - 1) <= 1e-10  # amplitude and phase
        alone = size * textbook(damper, harmonic.frequency, damper.modal_mass) * np.exp(1j * phase)
        assert abs(found.without[k] / alone - 1) <= 1e-10
        power = 0.5 * 2 * zeta * math.sqrt(damper.stiffness[0]) * abs(harmonic.frequency * z) ** 2
        assert found.power_in[k, 0] == pytest.approx(power, rel=1e-10)
        assert found.power_lost[k, 0] == pytest.approx(power, rel=1e-10)
        for figure in (found.least, found.mean, found.rms, found.greatest):
            assert figure[k, 0] == pytest.approx(abs(z), rel=1e-10)
        if k % 6:
            continue
        v = 1j * harmonic.frequency * z
        run = ringdown(damper, (z.real, 0.0), 20, velocity=(v.real, 0.0), harmonic=harmonic, keep_events=True)
        t = np.linspace(0, run.duration * (1 - 1e-12), 200)
        history, turn = sample(run, t), np.exp(1j * harmonic.frequency * t)
        np.testing.assert_allclose(history.displacement[:, 0], (z * turn).real, atol=1e-10 * abs(z))
        np.testing.assert_allclose(history.velocity[:, 0], (v * turn).real, atol=1e-10 * abs(v))


@needs_compiler
def test_a_locked_ball_from_anywhere() -> None:
    """Thrown or laid aside, a ball that comes to rest for good leaves the same linear answer."""
    damper = paper(damping_ratio=ZETA)
    force = 0.5 * damper.rolling_threshold / damper.stuck_frequency**2 * 2 * ZETA * damper.stiffness[0]
    found = forced(damper, [Harmonic(damper.stuck_frequency, (force, 0.0))])
    assert (found.regime == Regime.LOCKED).all()
    assert (found.mean == found.mean[0, 0]).all()
    assert found.cycles[0, 2] > 0


@needs_compiler
@pytest.mark.parametrize("excess", [1e-9, 1e-3])
def test_a_ball_that_only_creeps_is_periodic(excess: float) -> None:
    """Just above the force that moves it: the textbook's amplitude, cycle by cycle, without a hit."""
    damper = paper(damping_ratio=2e-3, floor_tilt=(6.8, 6.8))
    nu = 0.97 * damper.stuck_frequency
    force = (1 + excess) * forced(damper, [Harmonic(nu, (1.0, 0.0))], [Start.UP]).moves_from[0]
    found = forced(damper, [Harmonic(nu, (force, 0.0))])
    assert (found.hits_per_cycle == 0).all()
    assert (found.regime == Regime.PERIODIC).all()
    assert (found.repeats == 1).all()
    assert found.mean[0] == pytest.approx(force * abs(textbook(damper, nu)), rel=1e-3)
    assert (found.error < 1e-5 * found.mean).all()


def test_a_harmonic_keeps_its_numbers() -> None:
    """Arrays that change later do not change it."""
    force, modal = np.array([200.0, 0.0]), np.array([1.0, 2.0])
    harmonic = Harmonic(1.0, force, modal)  # type: ignore[arg-type]
    force *= 0.5
    modal *= 0.5
    assert (harmonic.force, harmonic.modal) == ((200.0, 0.0), (1.0, 2.0))


def test_one_harmonic_is_asked_for_in_a_list() -> None:
    with pytest.raises(TypeError, match="put this one into a list"):
        forced(paper(), Harmonic(1.0, (1.0, 0.0)))  # type: ignore[arg-type]


def test_harmonics_may_come_from_a_generator() -> None:
    damper = paper(damping_ratio=1e-3)
    driven = [Harmonic(0.9 * damper.stuck_frequency, (force, 0.0)) for force in (1e-3, 2e-3)]
    assert np.array_equal(forced(damper, driven).mean, forced(damper, (each for each in driven)).mean)


def test_motions_are_compared_by_identity() -> None:
    """Numbers of events alone, which they share with others, would not tell them apart."""
    one, other = (ringdown(paper(), (1e-3, 0.0), 3) for _ in range(2))
    assert one in [other, one]
    assert one not in [other]


@pytest.mark.parametrize(("left", "factor"), [(1e-3, 1e3), (0.0, math.inf)])
def test_a_tilt_that_cancels_the_drive_lets_no_force_move_the_ball(left: float, factor: float) -> None:
    """At the stuck structure's resonance all of the drive is in that ratio; what rounding leaves of it moved balls."""
    flat = paper(damping_ratio=1e-3)
    slope = flat.stuck_frequency**2 / flat.centrifugal_acceleration
    push = [Harmonic(flat.stuck_frequency, (1.0, 0.0))]
    tilted = replace(flat, floor_tilt=((1.0 - left) * slope, 0.0))
    assert moves_from(tilted, push) == pytest.approx(factor * moves_from(flat, push), rel=1e-3)
    slight = [Harmonic(0.1 * flat.stuck_frequency, (size, 0.0)) for size in (1.0, 1e-12)]
    assert moves_from(flat, slight[1:]) == pytest.approx(1e12 * moves_from(flat, slight[:1]), rel=1e-9)


@pytest.mark.parametrize(("frequency", "first"), [(1.3, 0), (2.3, 1)])
def test_locked_on_several_modes_and_a_moving_base(frequency: float, first: int) -> None:
    """Against a solution of the matrices M + m Phi'Phi, C, K, assembled here; either axis moves the ball first."""
    modes = (
        Mode(0.8, 1.1, (1.0, 0.3), damping_ratio=0.01, drawn=(0.7, -0.2)),
        Mode(1.7, 9.0, (-0.6, 1.2), damping_ratio=0.02, drawn=(0.1, 0.4)),
        Mode(0.5, 20.0, (0.9, 0.4), damping_ratio=0.03, drawn=(0.3, 0.6)),
    )
    damper = ParticleDamper(0.8, (1.1, 1.1), 0.1, 1.0, (2.4, 2.4), 10.0, 0.5, rolling_friction=10.0, modes=modes)
    harmonic = Harmonic(frequency, (0.4, -0.1), (0.2, 0.0, 0.3), (0.05, 0.2), 0.4)
    weights = (0.2, -1.0, 3.0)
    found = forced(damper, [harmonic], [Start.UP], probe=weights)
    shape, drawn = (np.array([getattr(m, name) for m in modes]).T for name in ("shape", "participation"))
    mass = np.diag([m.mass for m in modes])
    stiffness = np.diag([m.stiffness for m in modes])
    dashpot = np.diag([2 * m.damping_ratio * math.sqrt(m.mass * m.stiffness) for m in modes])
    base, nu = np.array(harmonic.base), harmonic.frequency
    push = np.array(harmonic.force) @ shape + np.array(harmonic.modal) - base @ drawn
    for ball, answer in ((0.1, found.linear), (0.0, found.without)):
        q = np.linalg.solve(
            stiffness - nu**2 * (mass + ball * shape.T @ shape) + 1j * nu * dashpot, push - ball * base @ shape
        )
        assert abs(answer[0] - np.array(weights) @ q * np.exp(0.4j)) <= 1e-12 * abs(answer[0])
        if ball:
            shaken = np.abs(base - nu**2 * shape @ q)
    assert np.argmax(shaken) == first
    assert moves_from(damper, [harmonic]) == pytest.approx(damper.rolling_threshold / shaken.max(), rel=1e-9)
    assert found.moves_from == moves_from(damper, [harmonic])


@needs_compiler
def test_the_force_from_which_the_ball_moves() -> None:
    """a_r over the largest acceleration per force, less what the tilt of the floor takes of it."""
    for tilt in (0.0, 6.8):
        damper = replace(paper(damping_ratio=ZETA), floor_tilt=(tilt, 0.0))
        nu = 1.0005 * damper.stuck_frequency
        drive = abs(textbook(damper, nu)) * abs(nu**2 - damper.centrifugal_acceleration * tilt)
        least = damper.rolling_threshold / drive
        found = forced(damper, [Harmonic(nu, (least * f, 0.0)) for f in (0.999, 1.001)], [Start.UP])
        assert found.moves_from * [0.999, 1.001] == pytest.approx(1.0, rel=1e-9)
        assert list(found.regime[:, 0]) == [Regime.LOCKED, Regime.PERIODIC]
        assert found.mean[1, 0] < abs(found.linear[1])


def free_ball(mass: float, restitution: float, zeta: float) -> ParticleDamper:
    """A ball that nothing holds, half gap 1, on a structure of unit frequency with the ball stuck."""
    return ParticleDamper(1.0, (1 + mass,) * 2, mass, 1.0, (4.0, 4.0), 0.0, restitution, damping_ratio=zeta)


def manifold(damper: ParticleDamper, amplitude: float, nu: float) -> float:
    """Force that keeps up two symmetric hits a cycle of a free ball, on the structure's first harmonic.

    The ball goes from wall to wall at the speed V; hits at times 0 and pi/nu ask for (1 - e) V = (1 + e) A nu sin p and
    pi V / nu = 2 (h + A cos p): Theta of Weidemann, Bergman, Vakakis and Krack 2025. Its impulses 2 m V have the first
    harmonic 4 m V nu / pi, in phase with the hits.
    """
    e, rho = damper.restitution, 2 / math.pi * (1 - damper.restitution) / (1 + damper.restitution)
    theta = (1 + math.sqrt((1 + rho**2) * amplitude**2 - rho**2)) / (1 + rho**2)
    cosine, sine = (theta - 1) / amplitude, rho * theta / amplitude
    assert abs(cosine**2 + sine**2 - 1) < 1e-12
    assert e < 1
    structure = amplitude * (cosine + 1j * sine) / textbook(damper, nu, damper.modal_mass)
    return abs(structure - 4 * damper.ball_mass * nu / math.pi * (2 * nu / math.pi * theta))


@needs_compiler
@pytest.mark.parametrize("amplitude", [0.2, 0.3, 0.42, 0.55])
def test_two_hits_a_cycle_of_a_free_ball(amplitude: float) -> None:
    """Near resonance the motion goes onto the manifold, wherever it begins but at rest; at rest no wall is reached."""
    damper = free_ball(1e-3, 0.8, ZETA)
    harmonics = [Harmonic(nu, (manifold(damper, amplitude, nu), 0.0)) for nu in (0.998, 1.0, 1.002)]
    found = forced(damper, harmonics, [Start.DOWN, Start.RANDOM])
    assert (found.regime == Regime.PERIODIC).all()
    assert (found.hits_per_cycle == 2).all()
    assert (found.repeats == 1).all()
    assert found.mean == pytest.approx(amplitude, rel=5e-3)


@needs_compiler
def test_answers_side_by_side() -> None:
    damper = free_ball(1e-3, 0.8, ZETA)
    found = forced(damper, [Harmonic(1.0, (manifold(damper, 0.3, 1.0), 0.0))], [Start.UP, Start.DOWN])
    assert list(found.hits_per_cycle[0]) == [0, 2]
    c = 2 * ZETA * math.sqrt(damper.stiffness[0])
    alone = manifold(damper, 0.3, 1.0) / abs(damper.stiffness[0] - 1 + 1j * c)  # the ball stays where it is in space
    assert found.mean[0, 0] == pytest.approx(alone, rel=1e-6)
    assert found.mean[0, 1] < 0.6 * found.mean[0, 0]


@needs_compiler
@pytest.mark.parametrize(("force", "nu"), [(0.08, 1.01), (0.01, 1.0)])
def test_chaotic_motion_beside_a_dense_integration(force: float, nu: float) -> None:
    damper = free_ball(0.05, 0.7, 0.01)
    harmonic = Harmonic(nu, (force, 0.0))
    found = forced(damper, [harmonic], [Start.DOWN])
    assert found.regime[0, 0] is Regime.CHAOTIC
    assert found.least[0, 0] < found.mean[0, 0] < found.rms[0, 0] < found.greatest[0, 0]
    run = Reference(damper, (0.0, 0.0), 0.0, 128, harmonic, place=(0.3, 0.0))
    run.x[run.w[0]] = 1.0
    run.roll(0, 1)
    work, period = [], damper.stuck_frequency / nu
    for cycles in 60 + 20 * np.arange(17):
        run.cycles = cycles * period
        run.go_on()
        work.append(run.work)
    powers = np.diff(work) / (20 * 2 * math.pi / nu)
    error = math.hypot(powers.std(ddof=1) / 4, found.power_error[0, 0])
    assert error < 0.1 * found.power_in[0, 0]
    assert powers.mean() == pytest.approx(found.power_in[0, 0], abs=5 * error)


@needs_compiler
@pytest.mark.parametrize("zeta", [1e-3, 2e-2])
def test_the_linear_absorber(zeta: float) -> None:
    """A ball in a bowl that nothing resists and that hits nothing: the linear absorber's response."""
    damper = replace(absorber(), damping_ratio=zeta)
    frequencies = 2 * math.pi * np.array([200.0, 235.0, 250.0, 262.0, 280.0, 320.0])
    u, s = steady(damper, frequencies)
    amplitude = 1e-3 / np.maximum(1, np.abs(s / u))
    harmonics = [Harmonic(nu, (f, 0.0)) for nu, f in zip(frequencies, amplitude / np.abs(u), strict=True)]
    found = forced(damper, harmonics, [Start.UP, Start.DOWN])
    assert (found.regime == Regime.PERIODIC).all()
    assert (found.hits_per_cycle == 0).all()
    np.testing.assert_allclose(found.mean, amplitude[:, None] * [1, 1], rtol=1e-6)


@needs_compiler
@pytest.mark.parametrize(
    ("lever", "load", "left"),
    [(0.01, 0.05, 0.30), (0.01, 0.15, 0.10), (0.01, 0.30, 0.05), (0.1, 0.15, 0.90), (0.1, 0.30, 0.50)],
)
def test_a_bowl_tuned_to_an_engine_order(lever: float, load: float, left: float) -> None:
    """Amplitude at resonance over that without a ball, by a direct integration: order 3 of 4261 rpm, two digits."""
    speed, mass = 4261 * math.pi / 30, 0.006
    omega, pull = 3 * speed, 0.2 * speed**2
    damper = paper(stiffness=((1 + mass) * omega**2,) * 2, cavity=(10e-3, 10e-3), damping_ratio=ZETA)
    damper = replace(damper, centrifugal_acceleration=pull, rolling_friction=lever * 1e-3)
    damper = replace(damper, floor_tilt=(6.8, 6.8), floor_radius=(16.9e-3, 16.9e-3))
    amplitude = load * pull / omega**2
    force = amplitude * 2 * ZETA * math.sqrt(damper.stiffness[0]) * omega
    found = forced(damper, [Harmonic(omega, (force, 0.0))], [Start.UP])
    assert found.rms[0, 0] / amplitude == pytest.approx(left, rel=0.03, abs=0.005)


def random_force(seed: int) -> tuple[ParticleDamper, Harmonic]:
    """A damper of any kind (floors, modes, slip) with damping, under a force, blows on modes and a moving base."""
    damper, amplitudes, _ = scene(seed)
    rng = np.random.default_rng([seed, 7])
    drawn = (tuple(rng.normal(size=n)) for n in (2, len(amplitudes), 2))
    harmonic = Harmonic(rng.uniform(0.3, 3), *drawn, rng.uniform(0, 6))
    return replace(damper, damping_ratio=max(damper.damping_ratio, 5e-3)), harmonic


@needs_compiler
def test_power_of_random_motions() -> None:
    for seed in some(24, without=0):
        damper, harmonic = random_force(seed)
        found = forced(damper, [harmonic], max_cycles=8000)
        assert np.isfinite(found.mean).all()
        assert (np.abs(found.residual) <= 1e-9 * np.abs(found.power_in)).all(), seed
        settled = found.regime != Regime.UNSETTLED
        assert (np.abs(found.stored) <= 1e-2 * np.abs(found.power_in))[settled].all()
        assert (found.least <= found.mean).all()
        assert (found.mean <= found.rms * (1 + 1e-12)).all()
        assert (found.rms <= found.greatest * (1 + 1e-12)).all()


@needs_compiler
def test_the_same_bits_on_any_number_of_threads() -> None:
    """Also of dampers one by one, and of points by themselves; random starts go by the number of the point."""
    damper = free_ball(0.05, 0.7, 0.01)
    harmonics = [Harmonic(nu, (f, 0.0)) for nu in (0.99, 1.0) for f in (0.005, 0.08)]
    one = forced(damper, harmonics, threads=1, accuracy=0.05)
    for given, threads in ((damper, 3), ([replace(damper) for _ in harmonics], 2)):
        np.testing.assert_equal(vars(forced(given, harmonics, threads=threads, accuracy=0.05)), vars(one))
    alone = forced(damper, harmonics[2:3], [Start.DOWN], accuracy=0.05)
    assert alone.mean[0, 0] == one.mean[2, 1]


@needs_compiler
@pytest.mark.parametrize("seed", some(3, without=0))
def test_any_window_within_its_error(seed: int) -> None:
    """Longer windows of chaotic motion find the same mean, as far as either says that it knows it."""
    rng = np.random.default_rng(seed)
    damper = free_ball(10 ** rng.uniform(-2, -1), rng.uniform(0.5, 0.8), 0.01)
    harmonics = [Harmonic(rng.uniform(0.98, 1.02), (rng.uniform(0.02, 0.1), 0.0)) for _ in range(6)]
    short, long = (forced(damper, harmonics, [Start.DOWN], accuracy=a) for a in (1e-2, 4e-3))
    compared = 0
    for k in range(6):
        regimes = [one.regime[k, 0] for one in (short, long)]
        periodic = [regime is Regime.PERIODIC for regime in regimes]
        if Regime.UNSETTLED in regimes:  # neither knows it: bursts once in ten thousand cycles are rare in any window
            continue
        if all(periodic):
            assert short.mean[k, 0] == pytest.approx(long.mean[k, 0], rel=1e-6)
        elif not any(periodic):  # chaos may last, on one processor or another, and then end in an orbit
            error = math.hypot(short.error[k, 0], long.error[k, 0])
            assert abs(short.mean[k, 0] - long.mean[k, 0]) <= 5 * error
        compared += all(periodic) or not any(periodic)
    assert compared >= 3


def test_what_does_not_settle_is_said() -> None:
    damper = free_ball(0.02, 0.8, 5e-3)
    found = forced(damper, [Harmonic(1.0, (0.01, 0.0))], [Start.DOWN], max_cycles=128)
    assert found.regime[0, 0] is Regime.UNSETTLED
    assert found.cycles[0, 0] <= 128
    assert found.error[0, 0] > 1e-2 * found.mean[0, 0] or abs(found.stored[0, 0]) > 1e-2 * found.power_in[0, 0]


@needs_compiler
def test_a_ball_with_no_end_of_hits_is_left_at_that() -> None:
    damper = replace(free_ball(1e-4, 1.0, 1e-2), cavity=(2 + 2e-4, 2 + 2e-4))
    found = forced(damper, [Harmonic(1.0, (0.02, 0.0))], [Start.DOWN])
    assert found.regime[0, 0] is Regime.UNSETTLED
    assert np.isnan(found.power_in[0, 0])


@needs_compiler
def test_without_damping_a_locked_ball_has_no_steady_state() -> None:
    damper = paper()
    harmonic = Harmonic(1.01 * damper.stuck_frequency, (1.0, 0.0))
    found = forced(damper, [harmonic], [Start.UP], max_cycles=2000)
    assert found.regime[0, 0] is not Regime.LOCKED
    assert abs(found.linear[0]) == pytest.approx(abs(textbook(damper, harmonic.frequency)), rel=1e-9)


def test_bad_forces() -> None:
    damper = paper(damping_ratio=ZETA)
    good = Harmonic(100.0, (1.0, 0.0))
    for arguments, message in (
        ((damper, []), "at least one"),
        (([damper], [good, good]), "as many as harmonics"),
        ((damper, [Harmonic(100.0)]), "no force"),
        ((replace(damper, formulation=Formulation.PRINTED), [good]), "printed equations"),
    ):
        with pytest.raises(ValueError, match=message):
            forced(*arguments)
    for more, message in (
        ({"probe": (1.0,)}, "probe must be 2 weights"),
        ({"probe": 2}, "probe must be 0"),
        ({"accuracy": 0.0}, "accuracy"),
        ({"starts": []}, "starts"),
        ({"max_cycles": 0}, "max_cycles"),
        ({"threads": 0}, "threads"),
    ):
        with pytest.raises(ValueError, match=message):
            forced(damper, [good], **more)


def hollow(rpm: float) -> ParticleDamper:
    """Twenty steel balls of 4 mm on 0.5 kg at 300 Hz, in hollow floors that are tuned to the third order."""
    ball, load = 20 * 7850 * 4 / 3 * math.pi * 2e-3**3, 0.25 * (rpm * math.pi / 30) ** 2
    stiffness = (0.5 + ball) * (2 * math.pi * 300) ** 2
    floor = (21.84e-3, 21.84e-3)
    return ParticleDamper(
        0.5, (stiffness,) * 2, ball, 2e-3, (14e-3,) * 2, load, 0.6, 0.2, 5e-7, 2e-3, floor_radius=floor
    )


def test_a_large_motion_in_a_hollow_floor_is_found_from_resonance() -> None:
    """Beside that of a tuned pendulum, 8.8 um: a ball that hits both walls keeps up 1.63 mm, by the reference too."""
    damper, nu = hollow(5900.0), 5900 * math.pi / 10
    found = forced(damper, [Harmonic(nu, (20.0, 0.0))])
    assert found.starts == tuple(Start)
    assert found.mean[0, :3] == pytest.approx(8.845e-6, rel=1e-3)
    assert found.hits_per_cycle[0, 3] == pytest.approx(2.0)
    ahead = Harmonic(nu, (20.0, 0.0), phase=math.pi / 2)  # the release is a quarter of a period behind the force
    run, places = Reference(damper, (2.8e-3, 0.0), 0.0, 128, ahead), list[float]()
    for cycles in 400 + np.arange(41) / 40:
        run.cycles = cycles * damper.stuck_frequency / nu
        run.go_on()
        places.append(float(run.x[0]))
    assert found.mean[0, 3] == pytest.approx(0.5 * (max(places) - min(places)), rel=5e-3)


def test_motions_go_on_from_those_of_dampers_alike() -> None:
    """From speed to speed up to where the motion ends; at the same one it stays."""
    state, means = forced(hollow(5900.0), [Harmonic(590 * math.pi, (20.0, 0.0))]).state[:, 3], []
    for rpm in (5900.0, 5910.0, 5920.0, 5930.0):
        harmonic = Harmonic(rpm * math.pi / 10, (20.0, 0.0))
        found = forced(hollow(rpm), [harmonic], [Start.RESONANT], states=state)
        state = found.state[:, 0]
        means.append(float(found.mean[0, 0]))
    assert means == sorted(means)
    assert means[0] == pytest.approx(1.6292e-3, rel=1e-3)
    assert means[-1] > 2.0e-3
    with pytest.raises(ValueError, match=r"states must be two rows for each harmonic, from one start, got shape \(2"):
        forced(hollow(rpm), [harmonic], [Start.UP], states=np.zeros((2, 2, 10)))
    with pytest.raises(ValueError, match="states must be finite"):
        forced(hollow(rpm), [harmonic], [Start.UP], states=np.full((1, 2, 10), np.nan))


@pytest.mark.parametrize(("pull", "hold"), [((4500.0, 0.0), 90.0 + 4500.0), ((0.0, 4500.0), 90.0)])
def test_a_ball_that_the_load_draws_to_a_wall_is_held_there(pull: tuple[float, float], hold: float) -> None:
    """Along the pull by that and rolling resistance, along the wall by the latter alone."""
    nu, mass, ball = 1700.0, 0.5, 1e-4
    damper = ParticleDamper(
        mass, (1.8e6, 1.8e6), ball, 2e-3, (6e-3, 6e-3), 9e4, 0.6, 0.2, 2e-6, 2e-3, lateral_acceleration=pull
    )
    answer = abs(1 / complex(1.8e6 - (mass + ball) * nu**2, 2 * 2e-3 * math.sqrt(1.8e6 * mass) * nu))
    least = moves_from(damper, [Harmonic(nu, (1.0, 0.0))])[0]
    assert least == pytest.approx(hold / (nu**2 * answer), rel=1e-3)
    found = forced(damper, [Harmonic(nu, (least * part, 0.0)) for part in (0.99, 1.1)], probe=np.int64(0))
    assert (found.regime[0] == Regime.LOCKED).all()
    for each in found.state[0]:
        size = np.hypot(each[0], each[1] / nu)
        assert np.abs(size / abs(found.linear[0]) - 1).min() < 1e-6
    assert (found.regime[1] != Regime.LOCKED).all()
    with pytest.raises(ValueError, match="harmonics must be at least one"):
        moves_from(damper, [])
