"""What must hold in every ring-down, over random scenes."""

import dataclasses
import math

import numpy as np
import pytest

from damper import Formulation, ParticleDamper, RingDown, ringdown, sample
from tests.compiler import COMPILED, needs_compiler, some
from tests.damper.scenes import paper, random_scene

SEEDS = some(60, without=5)


def sampled_energy(run: RingDown, times: np.ndarray) -> np.ndarray:
    """Sum over the axes of K u² / 2 + M2 v² / 2 + m (v + w)² / 2 and, for a rolling ball, 2/5 m spin² / 2 [J]."""
    one, at = run.damper, sample(run, times)
    u, v, w, spin = at.displacement, at.velocity, at.relative_velocity, at.spin
    twice = np.array(one.stiffness) * u**2 + one.modal_mass * v**2 + one.ball_mass * (v + w) ** 2
    return 0.5 * (twice + one.spin_mass * spin**2).sum(axis=1)


@pytest.mark.parametrize("slip", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_books_close_and_energy_never_rises(seed: int, slip: bool) -> None:
    damper, release = random_scene(seed, 0.05 + seed / 100 if slip else None)
    run = ringdown(dataclasses.replace(damper, formulation=Formulation.CONSISTENT), release, 10, keep_events=True)
    assert abs(run.energy.residual) <= 1e-10 * run.energy.initial
    assert min(run.energy.structure, run.energy.rolling, run.energy.impact, run.energy.slip) >= 0
    after = sampled_energy(run, np.linspace(0, run.duration, 200))
    assert (np.diff(after) <= 1e-12 * run.energy.initial).all()


HEAVY = {"modal_mass": 0.2298, "ball_mass": 2.298e5, "ball_radius": 7e-3, "sticking_ratio": 0.5}
VIOLENT = {
    "a resistance that stops the ball at once": (
        {**HEAVY, "stiffness": (952.557, 952.557), "cavity": (0.0143, 2.014), "centrifugal_acceleration": 1e7}
        | {"restitution": 0.5, "friction": 10.0, "rolling_friction": 0.7, "damping_ratio": 0.999},
        (1e-6, 0.0),
    ),
    "a wall that sends a ball far heavier than the structure sliding": (
        {"modal_mass": 239.0, "stiffness": (1537.0, 230516.0), "ball_mass": 2.39e8, "ball_radius": 1e-5}
        | {"cavity": (0.02002, 2.00002), "centrifugal_acceleration": 1e5, "restitution": 1.0, "friction": 0.3}
        | {"rolling_friction": 1e-5, "damping_ratio": 0.01, "floor_friction": 1e-9},
        (1e-3, 0.0),
    ),
}
"""Flights so short that the structure's offset is a million times what happens in them."""


@pytest.mark.parametrize("name", VIOLENT)
def test_sampled_energy_never_rises_in_the_shortest_flights(name: str) -> None:
    fields, release = VIOLENT[name]
    run = ringdown(ParticleDamper(**fields), release, 0.2, ball_velocity=(-1e-9, 0.0), keep_events=True)
    assert len(run.rows) == 3
    assert 0 < run.rows["time"][-1] < 1e-14
    start = sample(run, [0.0, 1e-25])
    np.testing.assert_allclose(start.displacement, [release] * 2, rtol=1e-15)
    assert abs(run.energy.residual) <= 1e-10 * run.energy.initial
    times = np.unique(np.r_[np.linspace(0, run.duration, 400), run.rows["time"], 0.5 * run.rows["time"]])
    after = sampled_energy(run, times)
    assert (np.diff(after) <= 1e-11 * run.energy.initial).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_events_are_ordered_and_continuous(seed: int) -> None:
    """Times do not fall; positions and the structure's displacement are continuous across every event."""
    run = ringdown(*random_scene(seed), 10, keep_events=True)
    times = run.rows["time"]
    assert (np.diff(times) >= 0).all()
    assert (np.diff(run.peak_times) > 0).all()
    inside = times[(times > 0) & (times < run.duration)]
    before = sample(run, np.nextafter(inside, 0))
    after = sample(run, inside)
    scale = np.abs(run.rows["u"]).max()
    np.testing.assert_allclose(after.displacement, before.displacement, atol=1e-9 * scale)
    np.testing.assert_allclose(after.relative_position, before.relative_position, atol=1e-9 * scale)


def digest(run):
    times = run.rows["time"] * run.damper.stuck_frequency
    return times, run.rows["kind"], run.energy.final / run.energy.initial


@pytest.mark.parametrize("seed", SEEDS)
def test_mirror(seed: int) -> None:
    damper, (x, y) = random_scene(seed)
    one = ringdown(damper, (x, y), 3, keep_events=True)
    two = ringdown(damper, (-x, -y), 3, keep_events=True)
    assert digest(one)[2] == pytest.approx(digest(two)[2], rel=1e-9)
    np.testing.assert_array_equal(one.rows["kind"], two.rows["kind"])
    np.testing.assert_allclose(one.rows["s"], -two.rows["s"], atol=1e-9 * max(damper.half_gap))


@pytest.mark.parametrize("scale", [{"length": 7.0}, {"length": 2.0**-20}, {"time": 0.3}, {"mass": 11.0}])
@pytest.mark.parametrize("seed", some(30, without=3))
def test_rescaling(seed: int, scale: dict[str, float]) -> None:
    """Units do not matter: dimensionless results are those of the scaled scene."""
    damper, release = random_scene(seed)
    length, time, mass = scale.get("length", 1.0), scale.get("time", 1.0), scale.get("mass", 1.0)
    scaled = dataclasses.replace(
        damper,
        modal_mass=damper.modal_mass * mass,
        stiffness=tuple(k * mass / time**2 for k in damper.stiffness),
        ball_mass=damper.ball_mass * mass,
        ball_radius=damper.ball_radius * length,
        cavity=tuple(c * length for c in damper.cavity),
        centrifugal_acceleration=damper.centrifugal_acceleration * length / time**2,
        rolling_friction=damper.rolling_friction * length,
    )
    one = ringdown(damper, release, 5, keep_events=True)
    two = ringdown(scaled, tuple(x * length for x in release), 5, keep_events=True)
    assert one.impacts == two.impacts
    assert digest(one)[2] == pytest.approx(digest(two)[2], rel=1e-8)
    assert one.peak_velocities * length / time == pytest.approx(two.peak_velocities, rel=1e-8)


def test_sampling_at_events_gives_the_state_after_them() -> None:
    run = ringdown(paper(), (20e-3, 5e-3), 3, keep_events=True)
    for row in run.rows[::7]:
        at = sample(run, row["time"])
        same_time = run.rows[(run.rows["time"] == row["time"]) & (run.rows["axis"] == row["axis"])][-1]
        assert at.velocity[0, row["axis"]] == pytest.approx(same_time["v"], rel=1e-13)
        assert at.relative_velocity[0, row["axis"]] == same_time["w"]


def test_peaks_are_the_maxima_of_the_sampled_speed() -> None:
    run = ringdown(paper(), (20e-3, 5e-3), 10 if COMPILED else 3, keep_events=True)
    samples = 20_001 if COMPILED else 2_001
    period = 2 * math.pi / run.damper.stuck_frequency
    for time, peak in zip(run.peak_times, run.peak_velocities, strict=True):
        near = sample(run, np.linspace(max(time - period / 5, 0), min(time + period / 5, run.duration), samples))
        speed = np.hypot(*near.velocity.T).max()
        assert peak == pytest.approx(speed, rel=1e-6)
        assert peak >= speed * (1 - 1e-9)


@needs_compiler
def test_long_run_is_the_short_one_continued() -> None:
    """Pausing for progress, and growing tables, change nothing."""
    damper = paper()
    calls: list[float] = []
    long = ringdown(damper, (20e-3, 5e-3), 2500, keep_events=True, progress=calls.append)
    short = ringdown(damper, (20e-3, 5e-3), 100, keep_events=True)
    assert calls
    np.testing.assert_array_equal(long.rows[: len(short.rows)], short.rows)
