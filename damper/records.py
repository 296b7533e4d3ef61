"""The few flat records that the compiled engine works on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from damper.parameters import inertia_ratio, rolling_threshold, spin_mass, stuck_frequency

if TYPE_CHECKING:
    from damper.arrays import Floats, Records
    from damper.parameters import Parameters


def record(*fields: tuple[Any, ...]) -> np.dtype[np.record]:
    """A dtype whose elements also have their fields as attributes, with and without the compiler."""
    return cast("np.dtype[np.record]", np.dtype((np.record, list(fields))))


STUCK, ROLLING, SLIPPING = 0, 1, 2
"""Regimes of an axis, and rows of the law table."""

NOTHING, RELEASE, START, REVERSAL, HIT, RUB, GRIP = -1, 0, 1, 2, 3, 4, 5
"""Kinds of event: none; the release at time 0; the end of sticking; a zero of the relative velocity; a wall; the
tangential side of a wall hit; the end of slip."""

PIECES = 32
"""Half periods of a flight that are looked through at a time: nearly every flight is shorter."""

LAW = record(
    ("mass", "f8"), ("stiffness", "f8"), ("square", "f8"), ("damping", "f8"), ("decay", "f8"), ("frequency", "f8")
)
"""A damped oscillator: mass [kg], stiffness [N/m], their ratio [1/s^2], damping [N s/m], decay rate [1/s], damped
frequency [rad/s], which is next to nothing where the damping is nearly critical."""

BALL = record(
    ("host_mass", "f8"),  # M2
    ("mass", "f8"),  # m_p
    ("spin_mass", "f8"),  # 2/5 m_p where spin counts
    ("inertia_ratio", "f8"),  # beta
    ("threshold", "f8"),  # a_r
    ("push", "f8"),  # force of rolling on the structure, along the relative motion
    ("relative_push", "f8"),  # beta a_r: relative deceleration by rolling resistance
    ("grip", "f8"),  # deceleration by sliding on the floor; 0: the spin follows the rolling velocity at once
    ("restitution", "f8"),
    ("friction", "f8"),
    ("sticking_ratio", "f8"),
    ("sticking_floor", "f8"),  # relative speed below which a hit always sticks
)

AXIS = record(
    ("start", "f8"),  # time at which this flight began
    ("u", "f8"),  # structure: displacement and velocity then
    ("v", "f8"),
    ("s", "f8"),  # ball relative to the structure: position and velocity then
    ("w", "f8"),
    ("spin", "f8"),  # surface speed of the ball, equal to w while it rolls
    ("regime", "i8"),
    ("direction", "i8"),  # of the relative motion, or of the sliding of the contact: -1, 0 (stuck), 1
    ("beta", "f8"),  # s = s0 + w0 t - beta (u - u0 - v0 t) + f t**2 / 2
    ("f", "f8"),
    ("offset", "f8"),  # u = offset + exp(-decay t) (a cos + b sin / frequency)
    ("a", "f8"),
    ("b", "f8"),
    ("crest", "f8"),  # flight time at which the structure's acceleration is extreme first
    ("looked", "f8"),  # flight time up to which no event was found yet, and the end of the piece after it
    ("ahead", "f8"),
    ("half_gap", "f8"),
    ("next", "f8"),  # when the next event of this axis happens, inf if never; of kind NOTHING: when to look again
    ("due", "f8"),  # the flight time until then, free of the rounding of the clock
    ("kind", "i8"),  # and what it is
    ("heading", "i8"),  # direction in which a stuck ball will set off, or side of the wall that will be hit
    ("demand", "f8"),  # largest rolling force on the ball so far, per unit of its mass
    ("excursion", "f8"),  # largest distance of the ball from the cavity's middle at an event so far
)

BOOKS = record(("structure", "f8"), ("rolling", "f8"), ("impact", "f8"), ("slip", "f8"), ("work", "f8"))
"""Energy lost since the start, by cause, and work put in by a harmonic force [J]."""

CYCLE = record(
    ("period", "f8"),
    ("wait", "f8"),  # from a velocity maximum until the next is sought
    ("opens", "f8"),  # window in which the next velocity maximum is sought
    ("closes", "f8"),
    ("time", "f8"),  # of the largest speed in it so far
    ("speed", "f8"),
    ("square", "f8"),  # of the cavity's speed then, where several modes move it
    ("last_time", "f8"),  # of the velocity maximum before, 0 for the first
    ("last_speed", "f8"),  # negative before the first
    ("peak_sdc", "f8"),  # largest specific damping capacity of a cycle so far
    ("peak_sdc_speed", "f8"),  # and the velocity maximum at which that cycle began
    ("moving_speed", "f8"),  # that of the last cycle begun before the ball's last motion, negative if none
    ("waiting_speed", "f8"),  # that of the last cycle begun after it, negative if none
    ("waiting_since", "f8"),  # the ball's last motion when that was written
)
"""Velocity maxima, one per vibration cycle, and what is kept of the cycles where their table is not."""

CLOCK = record(
    ("time", "f8"),
    ("end", "f8"),
    ("watched", "f8"),  # until when peaks were sought
    ("rest", "f8"),  # when the ball came to rest for good, inf until then
    ("tail", "f8"),  # how long to go on after that
    ("last_motion", "f8"),  # last time at which the ball moved relative to the structure
    ("trembles", "i8"),  # 1: that rest is a tremor at the threshold; 2: the vibration died out
    ("first_speed", "f8"),  # first velocity maximum
    ("last_rolling", "f8"),  # rolling loss booked at the last velocity maximum
    ("last_impacts", "i8"),  # and hits counted
    ("impacts", "i8"),
    ("events", "i8"),
    ("peaks", "i8"),
    ("rows", "i8"),
)
"""Where a run is, and how much it has put into its tables."""

SHARED = (("clock", CLOCK), ("axes", AXIS, 2), ("ball", BALL), ("books", BOOKS), ("cycle", CYCLE))
"""What every run has."""

LEVEL = record(*SHARED, ("laws", LAW, (2, 3)))
"""A run in closed form: on a level floor under one mode along x and one along y; laws by axis and regime."""

EVENT = record(
    ("time", "f8"),
    ("axis", "i8"),
    ("kind", "i8"),
    ("u", "f8"),
    ("v", "f8"),
    ("s", "f8"),
    ("w", "f8"),
    ("spin", "f8"),
    ("regime", "i8"),
    ("direction", "i8"),
    ("w_before", "f8"),
)
"""A row is an event and the state of its axis just after it."""


def laws_of(rows: Parameters) -> Records:
    """Oscillators that govern the structures, shape (n, 2 axes, 3 regimes)."""
    m2, ball, printed = rows["modal_mass"], rows["ball_mass"], rows["printed"]
    mass = np.empty((len(rows), 1, 3))
    mass[:, 0, STUCK] = m2 + ball
    mass[:, 0, ROLLING] = np.where(printed, m2, m2 + (1 - inertia_ratio(rows)) * ball)
    mass[:, 0, SLIPPING] = m2
    sprung = np.repeat(m2[:, None, None], 3, axis=2)  # the mass that zeta refers to
    sprung[printed, :, STUCK] += ball[printed, None]
    stiffness = rows["stiffness"][:, :, None]
    laws = np.empty((len(rows), 2, 3), LAW)
    zeta = rows["damping_ratio"][:, None, None]
    laws["mass"], laws["stiffness"], laws["square"] = mass, stiffness, stiffness / mass
    laws["damping"] = damping = 2 * zeta * np.sqrt(stiffness * sprung)
    laws["decay"] = damping / (2 * mass)
    # 1 - zeta^2 sprung / mass, which must not cancel where zeta nears 1
    laws["frequency"] = np.sqrt(laws["square"] * ((1 - zeta) * (1 + zeta) + zeta**2 * (mass - sprung) / mass))
    return laws


def balls_of(rows: Parameters, reach: Floats) -> Records:
    """Constants of the balls, shape (n,); `reach` [m], shape (n,), the largest release, sets the sticking floor."""
    beta, threshold = inertia_ratio(rows), rolling_threshold(rows)
    balls = np.zeros(len(rows), BALL)
    balls["host_mass"], balls["mass"] = rows["modal_mass"], rows["ball_mass"]
    balls["spin_mass"], balls["inertia_ratio"], balls["threshold"] = spin_mass(rows), beta, threshold
    balls["push"] = np.where(rows["printed"], 1.0, beta) * rows["ball_mass"] * threshold
    balls["relative_push"] = beta * threshold
    balls["grip"] = rows["floor_friction"] * rows["centrifugal_acceleration"]
    for name in ("restitution", "friction", "sticking_ratio"):
        balls[name] = rows[name]
    balls["sticking_floor"] = 1e-9 * stuck_frequency(rows) * reach
    return balls
