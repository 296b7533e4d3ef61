"""The records that the kernels of linear flights work on: the constants of a damper, and what moves.

They have room for so many modes, whatever a damper has: one size is compiled once, and the compiler knows it.
"""

from __future__ import annotations

from damper.records import SHARED, record

TERMS = 24
"""Of a series, in rows of eight."""

STEP = 1.25
"""Radians of the fastest motion in a step: 1.25**24 / 24! is below rounding, and so it is for second derivatives."""

MODES = 8
"""Most modes of a structure."""

_N = MODES + 2

SYSTEM = record(
    ("power", "f8", _N),  # what the harmonic force at its height puts in per velocity [N]
    ("sway", "f8", 2),  # its acceleration of a stuck ball against the cavity [m/s^2]
    ("frequency", "f8"),  # its own, 0 where there is none [rad/s]
    ("phase", "f8"),
    ("mode_shape", "f8", (2, _N)),  # u = mode_shape z
    ("pull", "f8", (2, _N)),  # acceleration of the ball in its cavity by the load is -pull z [1/s^2]
    # velocities that a unit impulse on the cavity along each axis gives the coordinates [1/kg]; those s of the ball
    # it gives by the cavity's motion alone
    ("yielding", "f8", (2, _N)),
    ("dashpot", "f8", _N),  # coefficients of the modes [N s/m]
    ("mass", "f8", (_N, _N)),  # E = z' mass z'/2 + z spring z/2, and the spin's
    ("spring", "f8", (_N, _N)),
    # amplitudes of the modes with the ball stuck, as speeds: the roots of (deflection z)^2 + (swing z')^2
    ("deflection", "f8", (_N, _N)),
    ("swing", "f8", (_N, _N)),
    ("reach", "f8", (2, _N)),  # largest drive of a stuck ball per unit of those amplitudes [1/s]
    ("bias", "f8", (2, _N)),  # drive of a stuck ball on a structure at rest = bias z [1/s^2]
    ("span", "f8", 2),  # length of the steps that a group's flights are taken in [s]
    ("coordinates", "i8"),  # N
    ("groups", "i8"),
    ("low", "i8", 2),  # each group's coordinates, from low to before high
    ("high", "i8", 2),
    ("first", "i8", 2),  # and axes
    ("last", "i8", 2),
    ("group", "i8", 2),  # of each axis
    ("place", "i8", 2),  # which coordinate is s along each axis
    ("lane", "i8", 2),  # and which series of its group
    ("flow", "i8"),  # which terms its flights have
    ("damped", "i8"),
    ("inertia", "f8", _N),  # of the modes [kg]
    ("several", "i8"),  # whether there are modes beside one along each axis, and nothing drives them
)
"""Constants of a damper on a structure of modes q, in the N = modes + 2 coordinates z = (q, s), sorted by groups."""

MOTION = record(
    ("z", "f8", _N),
    ("rate", "f8", _N),
    ("series", "f8", (2, _N + 6, TERMS)),  # of each group; `damper.flows` says in which order
    ("start", "f8", 2),  # of each group's flight
    ("at", "f8", 2),  # when its next event happens, in steps from there
    ("next", "f8", 2),  # the time then
    ("kind", "i8", 2),  # and what it is; NOTHING: the step ends
    ("axis", "i8", 2),
    ("settled", "i8", 2),  # 1: nothing will ever happen of itself
    ("source", "f8", 2 * _N + 4),  # to work on: what a group's flight begins with
    ("guard", "f8", TERMS),  # a guard's series
    ("power", "f8", 8),  # of a place in a step
    ("scaled", "f8", TERMS),  # a series times these
    ("gain", "f8", _N),  # what z gained on the last flight
)
"""What moves: z and its rate at each group's start, their series, and when each group's next event is."""

LINEAR = record(*SHARED, ("system", SYSTEM), ("motion", MOTION))
"""A run in linear flights."""
