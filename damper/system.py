"""The records that the kernels of linear flights work on: the constants of a damper, and what moves.

Their size is fixed by the number of modes that they have room for, so that the compiler knows it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.records import record

if TYPE_CHECKING:
    import numpy as np

TERMS = 21
"""Of a series over a step of a radian: 1/21! is below rounding, and so is 1/19! for its second derivative."""

ROOM = (2, 8)
"""Modes that records have room for: every other number would be compiled anew."""


def room_for(modes: int) -> int:
    """Modes that the records have to have room for."""
    for room in ROOM:
        if modes <= room:
            return room
    raise ValueError(f"modes must be at most {ROOM[-1]}, got {modes}")


def system_type(modes: int) -> np.dtype[np.record]:
    """Constants of a damper on a structure of modes q, in the N = modes + 2 coordinates z = (q, s), sorted by groups.

    Accelerations are per step: those of a group are multiplied by the square of its `span`, as velocities by its span.
    """
    n = modes + 2
    return record(
        ("stiffness", "f8", (9, n, n)),  # for every pair of regimes, 3 (x) + (y)
        ("damping", "f8", (9, n, n)),
        ("resistance", "f8", (9, 2, n)),  # what a unit of resisting acceleration does along each axis
        ("force", "f8", (9, n)),  # what the harmonic force does at its height
        ("power", "f8", n),  # that it then puts in per velocity [N]
        ("sway", "f8", 2),  # its acceleration of a stuck ball against the cavity [m/s^2]
        ("frequency", "f8"),  # its own, 0 where there is none [rad/s]
        ("phase", "f8"),
        ("shape", "f8", (2, n)),  # u = shape z
        ("pull", "f8", (2, n)),  # acceleration of the ball in its cavity by the load is -pull z [1/s^2]
        # velocities that a unit impulse on the cavity along each axis gives the coordinates [1/kg]; those s of the ball
        # it gives by the cavity's motion alone
        ("yielding", "f8", (2, n)),
        ("dashpot", "f8", n),  # coefficients of the modes [N s/m]
        ("mass", "f8", (n, n)),  # E = z' mass z'/2 + z spring z/2, and the spin's
        ("spring", "f8", (n, n)),
        # amplitudes of the modes with the ball stuck, as speeds: the roots of (deflection z)^2 + (swing z')^2
        ("deflection", "f8", (n, n)),
        ("swing", "f8", (n, n)),
        ("reach", "f8", (2, n)),  # largest drive of a stuck ball per unit of those amplitudes [1/s]
        ("bias", "f8", (2, n)),  # drive of a stuck ball on a structure at rest = bias z [1/s^2]
        ("span", "f8", 2),  # length of the steps that a group's flights are taken in [s]
        ("groups", "i8"),
        ("low", "i8", 2),  # each group's coordinates, from low to before high
        ("high", "i8", 2),
        ("first", "i8", 2),  # and axes
        ("last", "i8", 2),
        ("group", "i8", 2),  # of each axis
        ("place", "i8", 2),  # which coordinate is s along each axis
        ("damped", "i8"),
    )


def motion_type(modes: int) -> np.dtype[np.record]:
    """What moves: z and its rate at each group's start, their series, and when each group's next event is."""
    n = modes + 2
    return record(
        ("z", "f8", n),
        ("rate", "f8", n),
        ("series", "f8", (n, TERMS)),
        ("cavity", "f8", (2, TERMS)),  # series of u
        ("wave", "f8", (2, TERMS)),  # of the harmonic, for each group
        ("start", "f8", 2),  # of each group's flight
        ("at", "f8", 2),  # when its next event happens, in steps from there
        ("next", "f8", 2),  # the time then
        ("kind", "i8", 2),  # and what it is; NOTHING: the step ends
        ("axis", "i8", 2),
        ("settled", "i8", 2),  # 1: nothing will ever happen of itself
        ("guard", "f8", TERMS),  # to work on: a guard's series
        ("gain", "f8", n),  # what z gained on the last flight
    )
