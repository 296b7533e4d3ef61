"""What a damper is made of: what is refused and how, and the derived quantities of the paper."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from damper import (
    Formulation,
    Mode,
    ParticleDamper,
    ball_density,
    capacity,
    ringdown,
    ringdowns,
    sample,
    stepped_ringdown,
)
from tests.damper.scenes import paper

BASE = paper()
OUTSIDE = {
    "modal_mass": [0.0, -1.0, math.nan, math.inf],
    "stiffness": [(0.0, 1.0), (1.0, -1.0), (1.0, math.nan)],
    "ball_mass": [0.0, math.inf],
    "ball_radius": [0.0],
    "cavity": [(2e-3 * (1 - 1e-9), 3e-3), (3e-3, 1e-3), (math.inf, 3e-3)],
    "centrifugal_acceleration": [-1.0, math.inf],
    "restitution": [-1e-9, 1 + 1e-9, math.nan],
    "friction": [-0.1, 1e7],
    "rolling_friction": [-1e-4],
    "break_away": [-1e-4, math.inf],
    "damping_ratio": [-0.1, 1.0],
    "sticking_ratio": [-1e-2],
    "floor_friction": [0.0, -0.1, 1e7],
}
INSIDE = {
    "cavity": (2e-3, 2e-3),
    "centrifugal_acceleration": 0.0,
    "restitution": 1.0,
    "friction": 1e6,
    "rolling_friction": 0.0,
    "damping_ratio": 0.0,
    "sticking_ratio": 0.0,
    "floor_friction": 1e6,
}
NO_NUMBERS = {
    "modal_mass": ["1", None, True, (1.0,)],
    "floor_friction": ["0.3", True],
    "stiffness": [3.0, "33", (1.0,), (1.0, 2.0, 3.0), (1.0, "2"), None],
    "cavity": [3e-3, [3e-3]],
}


def cases(table: dict[str, list[Any]]) -> list[tuple[str, Any]]:
    return [(name, value) for name, values in table.items() for value in values]


@pytest.mark.parametrize(("name", "value"), cases(OUTSIDE))
def test_outside_its_range(name: str, value: Any) -> None:
    """Refused by name, alike for one damper and in a batch."""
    with pytest.raises(ValueError, match=f"^{name} must be"):
        dataclasses.replace(BASE, **{name: value})
    with pytest.raises(ValueError, match=f"^{name} must be"):
        ringdowns(BASE, [(1e-3, 0.0)], 1, **{name: [value]})


@pytest.mark.parametrize(("name", "value"), INSIDE.items())
def test_edge_of_its_range(name: str, value: Any) -> None:
    assert getattr(dataclasses.replace(BASE, **{name: value}), name) == value


@pytest.mark.parametrize(("name", "value"), cases(NO_NUMBERS))
def test_not_a_number(name: str, value: Any) -> None:
    what = "two numbers, along x and y" if name in ("stiffness", "cavity") else "a number"
    with pytest.raises(ValueError, match=rf"^{name} must be ({what}|a number), got"):
        dataclasses.replace(BASE, **{name: value})


@pytest.mark.parametrize("value", [(1e-3,), 1e-3, (1e-3, 0.0, 0.0), "ab", (None, 0.0)])
def test_a_release_has_two_numbers(value: Any) -> None:
    with pytest.raises(ValueError, match=r"release must be (two numbers|a number)"):
        ringdown(BASE, value, 1)
    with pytest.raises(ValueError, match=r"release must be (two numbers|a number)"):
        stepped_ringdown(BASE, value, 1)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"cycles": 0.0}, "cycles must be positive, got 0"),
        ({"cycles": math.inf}, "cycles must be positive"),
        ({"max_cycles": 0.0}, "max_cycles must be positive"),
        ({"max_cycles": math.inf}, "max_cycles must be positive and finite"),
        ({"cycles": "3"}, "cycles must be a number, got '3'"),
        ({"cycles": True}, "cycles must be a number"),
        ({"cycles": 10**400}, "cycles must be finite"),
        ({"max_cycles": None}, "max_cycles must be a number"),
        ({"max_cycles": math.nan}, "max_cycles must be positive and finite"),
        *(
            ({"max_events": bad}, "max_events must be a whole number")
            for bad in (0, 1.5, math.nan, math.inf, "9", True)
        ),
        ({"velocity": (1e151, 0.0)}, "the release, or what moves from it, is too large"),
        ({"ball_velocity": (0.0, -1e308)}, "the release, or what moves from it, is too large"),
        ({"velocity": (10**400, 0.0)}, "velocity must be finite"),
        ({"ball_spin": (1.0,)}, "ball_spin must be two numbers"),
        ({"ball_position": (0.3e-3, 0.0)}, "ball_position 0.0003 m lies outside the cavity"),
        ({"velocity": (math.nan, 0.0)}, "the release must be finite, got nan"),
    ],
)
def test_what_cannot_be_run(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ringdown(BASE, (1e-3, 0.0), **keys)


@pytest.mark.parametrize("size", [1e308, 1e150, -1e144])
def test_a_release_whose_squares_overflow(size: float) -> None:
    """At 269.5 Hz the acceleration is 2.9e6 times the displacement."""
    for run in (ringdown, stepped_ringdown, lambda damper, release, cycles: ringdowns(damper, [release], cycles)):
        with pytest.raises(ValueError, match="too large: expected less than 1e\\+150 in SI units"):
            run(BASE, (0.0, size), 1)


def test_the_largest_release_is_followed() -> None:
    run = ringdown(BASE, (1e143, 1e143), 1)
    assert abs(run.energy.residual) < 1e-12 * run.energy.initial
    assert np.isfinite(run.peak_velocities).all()


@pytest.mark.parametrize("bad", [0, -1, 1.5, math.nan, "2", None, True])
def test_what_is_counted(bad: Any) -> None:
    with pytest.raises(ValueError, match="count must be a whole number of at least 1"):
        ball_density(BASE, bad)
    with pytest.raises(ValueError, match="cycles must be a whole number"):
        stepped_ringdown(BASE, (1e-3, 0.0), bad)
    with pytest.raises(ValueError, match="max_events must be a whole number"):
        ringdowns(BASE, [(1e-3, 0.0)], 1, max_events=bad)
    if bad is not None:
        with pytest.raises(ValueError, match="threads must be a whole number"):
            ringdowns(BASE, [(1e-3, 0.0)], 1, threads=bad)


def test_a_capacity_is_that_of_a_ring_down() -> None:
    with pytest.raises(TypeError, match="capacity takes what ringdown returns, got NoneType"):
        capacity(None)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("release", "keys", "message"),
    [
        ([(10**400, 0.0)], {}, "release must be numbers"),
        ([("a", 0.0)], {}, "release must be numbers"),
        ([(1e-3, 0.0)], {"friction": [10**400]}, "friction must be numbers"),
        *((bad, {}, r"release must have shape \(n, 2\)") for bad in ((1e-3, 0.0), [(1e-3,)], 1e-3)),
    ],
)
def test_no_batch(release: Any, keys: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ringdowns(BASE, release, 1, **keys)


def test_the_printed_equations_and_fixed_steps_know_no_slip() -> None:
    with pytest.raises(ValueError, match="have no slip"):
        dataclasses.replace(BASE, formulation=Formulation.PRINTED, floor_friction=0.3)
    with pytest.raises(ValueError, match="has no slip"):
        stepped_ringdown(dataclasses.replace(BASE, floor_friction=0.3), (1e-3, 0.0), 1)
    with pytest.raises(ValueError, match="at least 1"):
        stepped_ringdown(BASE, (1e-3, 0.0), 1, 0)


def test_derived_quantities() -> None:
    """Eqs. (1) to (5) and section 3 of the paper, by hand for M2 = 1 kg, 0.6 %, 219,320 m/s^2."""
    assert BASE.stuck_mass == 1.006
    assert BASE.stuck_frequency == pytest.approx(2 * math.pi * 269.5, rel=1e-15)
    assert BASE.half_gap == pytest.approx((0.25e-3, 0.2e-3), rel=1e-12)
    assert BASE.rolling_threshold == pytest.approx(21932.0, rel=1e-15)
    assert (BASE.inertia_ratio, BASE.spin_mass) == (5 / 7, pytest.approx(0.0024, rel=1e-15))
    printed = paper(formulation=Formulation.PRINTED)
    assert (printed.inertia_ratio, printed.spin_mass) == (5 / 2, 0.0)
    afloat = dataclasses.replace(BASE, centrifugal_acceleration=0.0)
    assert (afloat.inertia_ratio, afloat.spin_mass, afloat.rolling_threshold) == (1.0, 0.0, 0.0)


def test_density_in_digits() -> None:
    """Osmium has 22,600 kg/m^3."""
    assert ball_density(BASE, 10) == pytest.approx(0.0006 / (4.18879020479e-9), rel=1e-9)


def test_what_cannot_be_sampled() -> None:
    with pytest.raises(ValueError, match="kept no events"):
        sample(ringdown(BASE, (1e-3, 0.0), 1), 0.0)
    run = ringdown(BASE, (20e-3, 0.0), 1, keep_events=True)
    for times in (-1e-9, run.duration * 1.001, math.nan):
        with pytest.raises(ValueError, match="times must lie between 0 and the ring-down's end"):
            sample(run, times)
    with pytest.raises(ValueError, match="times must have shape"):
        sample(run, np.zeros((2, 2)))
    assert sample(run, []).time.shape == (0,)


def test_a_tilt_by_which_the_load_outweighs_the_spring_is_refused() -> None:
    """The ball's pull m a tilt on the structure, per displacement, against the spring's own: equal is the limit."""
    limit = BASE.stiffness[0] / (BASE.ball_mass * BASE.centrifugal_acceleration)
    small = dataclasses.replace(BASE, ball_radius=0.5 / limit, cavity=(2 / limit, 2 / limit))
    for tilt in ((0.99 * limit, 0.0), (0.0, -0.99 * limit)):
        dataclasses.replace(small, floor_tilt=tilt)
    for tilt in ((1.01 * limit, 0.0), (-1.01 * limit, 0.0)):
        with pytest.raises(ValueError, match="floor_tilt must be at most stiffness"):
            dataclasses.replace(small, floor_tilt=tilt)


def test_a_hollow_floor_holds_a_ball_off_the_wall() -> None:
    """A pull g moves its place of rest by g rho / a_c; only what would carry it beyond the wall holds it there."""
    path, gap, load = 0.05 - BASE.ball_radius, BASE.half_gap[0], BASE.centrifugal_acceleration
    for share in (0.5, 1.5):
        pull = share * load * gap / path
        hollow = dataclasses.replace(BASE, floor_radius=(0.05, 0.05), lateral_acceleration=(pull, 0.0))
        held = max(share - 1.0, 0.0) * load * gap / path
        assert hollow.leaving_threshold == pytest.approx(hollow.rolling_threshold + held, rel=1e-12)


@pytest.mark.parametrize(
    ("shape", "slope"),
    [
        ((2.0, 2.0), (0.0, 0.0)),
        ((1.0, 0.5), (6.0, -3.0)),
        ((1.0, -0.7), (80.0, 1.0)),
        ((1.0, 1.7), (30.0, 1.0)),
        ((1.0, 0.3), (195.0, 1.0)),
    ],
)
def test_a_mode_along_both_axes_moves_a_ball_where_one_of_them_does(shape, slope):
    """A percent below that amplitude the ball rests in the ring-down, a percent above it rolls."""
    stiffness = (4e6 / shape[0] ** 2,) * 2
    ball = ParticleDamper(shape[0] ** -2, stiffness, 0.01, 1e-3, (3e-3, 3e-3), 2e4, 0.5, 0.3, 1e-5)
    damper = dataclasses.replace(ball, modes=(Mode(1.0, 4e6, shape, slope),))
    amplitude = damper.amplitude_of(damper.break_away_threshold)
    below, above = (
        ringdown(damper, (share * amplitude, 0.0), 0.6, amplitudes=(share * amplitude / shape[0],))
        for share in (0.99, 1.01)
    )
    assert below.energy.rolling == 0.0 < above.energy.rolling
