"""The records that the compiled kernels work on, and the physical constants in them.

Regimes and kinds of event; ball (`BALL`, `balls_of`), axes, energy books, cycles and clock of a run (`RUN`); with the
constants of its flights and what moves (`FLYING`), and under a harmonic force (`DRIVEN`); the tables that a run may
fill.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar, cast

import numpy as np
import numpy.typing as npt

from damper.model import IMPACT, PARAMETERS, inertia_ratio, rim_threshold, rolling_threshold, spin_mass, stuck_frequency

if TYPE_CHECKING:
    from damper.model import Floats, Parameters, Records


def record(*fields: tuple[Any, ...]) -> np.dtype[np.record]:
    """A dtype whose elements also have their fields as attributes, with and without the compiler."""
    return cast("np.dtype[np.record]", np.dtype((np.record, list(fields))))


LINE = 64
"""Bytes of a cache line: a row of eight numbers that lies across two is loaded and stored at half the speed."""


def lines(*fields: tuple[Any, ...]) -> np.dtype[np.record]:
    """The same, each element whole cache lines long."""
    plain = np.dtype(list(fields))
    names = list(plain.names or ())
    ends = np.cumsum([0, *(plain[name].itemsize for name in names)]).tolist()
    layout = {"names": names, "formats": [plain[name] for name in names], "offsets": ends[:-1]}
    layout["itemsize"] = -(-ends[-1] // LINE) * LINE
    return cast("np.dtype[np.record]", np.dtype((np.record, layout)))


def zeros(shape: int | tuple[int, ...], kind: npt.DTypeLike = float) -> npt.NDArray[Any]:
    """Zeros that begin with a cache line."""
    dtype = np.dtype(kind)
    size = int(np.prod(shape)) * dtype.itemsize
    room = np.zeros(size + LINE, np.uint8)
    first = -room.ctypes.data % LINE
    return room[first : first + size].view(dtype).reshape(shape)


STUCK, ROLLING, SLIPPING = 0, 1, 2
"""Regimes of an axis."""

NOTHING, RELEASE, START, REVERSAL, HIT, RUB, GRIP = -1, 0, 1, 2, 3, 4, 5
"""Kinds of event: none; the release at time 0; the end of sticking; a zero of the relative velocity; a wall; the
tangential side of a wall hit; the end of slip."""

MARGIN = 1.0 + 1e-12
"""By which a threshold has to be exceeded: less is rounding, and a ball set off by it would turn back at once."""

SPIN_UP = 2.5
"""A force on the rim of a solid sphere changes its surface speed 5/2 times as fast as its velocity."""

BALL = record(
    ("host_mass", "f8"),  # M2
    ("mass", "f8"),  # m_p
    ("spin_mass", "f8"),  # 2/5 m_p where spin counts
    ("inertia_ratio", "f8"),  # beta
    ("threshold", "f8"),  # a_r
    ("hold", "f8"),  # drive above which a ball at rest sets off: more than a_r while it lies in its dent
    ("grip", "f8"),  # deceleration by sliding on the floor; 0: the spin follows the rolling velocity at once
    *((name, PARAMETERS[name]) for name in IMPACT),
    ("wall_spin", "f8"),  # 5/2: what an impulse at the rim gives the surface by spin over what it gives; 0 as printed
    ("sticking_floor", "f8"),  # relative speed below which a hit always sticks
)

AXIS = record(
    ("u", "f8"),  # structure: displacement and velocity at its last event
    ("v", "f8"),
    ("s", "f8"),  # ball relative to the structure: position and velocity then
    ("w", "f8"),
    ("spin", "f8"),  # surface speed of the ball, equal to w while it rolls
    ("regime", "i8"),
    ("direction", "i8"),  # of the relative motion, or of the sliding of the contact: -1, 0 (stuck), 1
    ("half_gap", "f8"),
    ("heading", "i8"),  # direction in which a stuck ball will set off, or side of the wall that will be hit
    ("demand", "f8"),  # largest rolling force on the ball so far, per unit of its mass
    ("excursion", "f8"),  # largest distance of the ball from the cavity's middle at an event so far
)

BOOKS = record(*((name, "f8") for name in ("initial", "final", "structure", "rolling", "impact", "slip", "work")))
"""Energy at the start and at the end, lost since the start, by cause, and put in by a harmonic force [J]."""

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

Count = TypeVar("Count")


@dataclass(frozen=True, eq=False)
class Counts(Generic[Count]):
    """What a run counts at its events (`damper.engine.count`): in its clock, of one ring-down, of each of many.

    Attributes:
        impacts: number of wall hits.
        events: number of events of any kind.
    """

    impacts: Count
    events: Count


COUNTED = tuple(f.name for f in fields(Counts))
"""Names of these counters."""

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
    *((name, "i8") for name in COUNTED),
    ("peaks", "i8"),
    ("rows", "i8"),
)
"""Where a run is, and how much it has put into its tables."""

_SHARED = (("clock", CLOCK), ("axes", AXIS, 2), ("ball", BALL), ("books", BOOKS), ("cycle", CYCLE))

RUN = record(*_SHARED)
"""What a run begins with and leaves."""

SHARED = list(RUN.names or ())
"""That, as fields of a run on its way."""

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


def balls_of(rows: Parameters, reach: Floats) -> Records:
    """Constants of the balls, shape (n,); `reach` [m], shape (n,), the largest release, sets the sticking floor."""
    balls = np.zeros(len(rows), BALL)
    balls["host_mass"], balls["mass"] = rows["modal_mass"], rows["ball_mass"]
    balls["spin_mass"], balls["inertia_ratio"] = spin_mass(rows), inertia_ratio(rows)
    balls["threshold"] = rolling_threshold(rows)
    balls["hold"] = rim_threshold(rows)
    balls["grip"] = rows["floor_friction"] * rows["centrifugal_acceleration"]
    for name in IMPACT:
        balls[name] = rows[name]
    balls["wall_spin"] = np.where(rows["printed"], 0.0, 5 / 2)
    balls["sticking_floor"] = 1e-9 * stuck_frequency(rows) * reach
    return balls


class Equations(NamedTuple):
    """Of the flights of n dampers in the N coordinates (q, s), in every pair of regimes of x and y.

    These are p = 9, or the 3 regimes where nothing couples the axes.

    Attributes:
        stiffness, damping: shape (n, p, N, N).
        resistance: what a unit of resisting acceleration does along each axis, shape (n, p, 2, N).
        force: what a harmonic does at its height, shape (n, p, N).
        shape: u = shape z, shape (n, 2, N).
        pull: the load accelerates the ball in its cavity by -pull z, shape (n, 2, N).
        sway: the harmonic accelerates a stuck ball against its cavity, shape (n, 2).
        excess: see `SYSTEM`, shape (n, 2).
        power: that it puts in per velocity, shape (n, N).
        frequency, phase: of the harmonic, 0 where there is none, shape (n,).
    """

    stiffness: Floats
    damping: Floats
    resistance: Floats
    force: Floats
    shape: Floats
    pull: Floats
    sway: Floats
    excess: Floats
    power: Floats
    frequency: Floats
    phase: Floats


TERMS = 24
"""Of a series, in rows of eight."""

INVERSE = np.array([1.0 / math.factorial(k) for k in range(TERMS)])
"""Of factorials: what a derivative becomes as a coefficient."""

STEP = 1.5
"""Radians of the fastest motion in a step: 1.5**24 / 24! is below rounding, and so it is for second derivatives."""

MODES = 8
"""Most modes of a structure."""

_N = MODES + 2

SYSTEM = record(
    ("power", "f8", _N),  # what the harmonic force at its height puts in per velocity [N]
    ("lateral", "f8", 2),  # acceleration of the ball by the load along the floor [m/s^2]
    ("sway", "f8", 2),  # its acceleration of a stuck ball against the cavity [m/s^2]
    ("frequency", "f8"),  # its own, 0 where there is none [rad/s]
    ("phase", "f8"),
    ("mode_shape", "f8", (2, _N)),  # u = mode_shape z
    ("pull", "f8", (2, _N)),  # acceleration of the ball in its cavity by the load is -pull z [1/s^2]
    # velocities that a unit impulse on the cavity along each axis gives the coordinates [1/kg]; those s of the ball
    # it gives by the cavity's motion alone
    ("yielding", "f8", (2, _N)),
    ("reduced", "f8", 2),  # mass that an impulse between ball and cavity along an axis moves [kg]
    ("dashpot", "f8", (2, _N)),  # coefficients of the modes while the ball is stuck, and else [N s/m]
    ("excess", "f8", 2),  # of the former over the latter, per mass [1/s]
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
    ("cavity", "i8", 2),  # and which is that of the cavity's displacement along it
    ("flow", "i8"),  # which terms its flights have
    ("damped", "i8"),
    ("several", "i8"),  # whether modes beside one along each axis alone move the cavity, and nothing drives them
)
"""Constants of a damper on a structure of modes q, in the N = modes + 2 coordinates z = (q, s), sorted by groups."""

MOTION = lines(
    ("series", "f8", (2, _N + 6, TERMS)),  # of each group; `damper.equations` says in which order
    ("guard", "f8", TERMS),  # a guard's series
    ("scaled", "f8", TERMS),  # the terms of a series
    ("z", "f8", _N),
    ("rate", "f8", _N),
    ("start", "f8", 2),  # of each group's flight
    ("at", "f8", 2),  # when its next event happens, in steps from there
    ("next", "f8", 2),  # the time then
    ("kind", "i8", 2),  # and what it is; NOTHING: the step ends
    ("axis", "i8", 2),
    ("settled", "i8", 2),  # 1: nothing will ever happen of itself
    ("source", "f8", 2 * _N + 4),  # to work on: what a group's flight begins with
    ("gain", "f8", _N),  # what z gained on the last flight
    ("seen", "f8", (2, 3)),  # a time, and the first two derivatives of the cavity's series along each axis then
)
"""What moves: z and its rate at each group's start, their series, and when each group's next event is."""

FLYING = lines(("motion", MOTION), *_SHARED, ("system", SYSTEM))
"""A run on its way."""


class Tables(NamedTuple):
    """Times and speeds of velocity maxima (n, 2); events (m,); z and its rate there (m, 2, N), N = 0: as in events.

    `Tables()` are those of a run that leaves nothing.
    """

    peaks: Floats = np.zeros((0, 2))
    rows: Records = np.zeros(0, EVENT)
    states: Floats = np.zeros((0, 2, 0))


BATCHES = 32
"""Parts of a window whose means tell the statistical error."""

GOES_ON, LOCKED, PERIODIC, APERIODIC, UNSETTLED, TIRED = 0, 1, 2, 3, 4, 5
"""Verdicts: none yet; three kinds of steady states; not settled within the cycles or the events allowed."""


TALLY = record(
    ("cycles", "f8"),
    ("least", "f8"),
    ("greatest", "f8"),
    ("total", "f8"),  # of the amplitudes of cycles
    ("squares", "f8"),
    ("work", "f8"),  # put in since the start, at the beginning of the tally [J]
    ("lost", "f8"),
    ("stored", "f8"),  # energy of structure and ball then [J]
    ("impacts", "f8"),
)
"""Sums over cycles; after its end `work`, `lost`, `stored` and `impacts` are what was gained in it."""

TRACE = record(
    ("probe", "f8", _N),  # displacement = probe z
    ("still", "f8", (2, _N)),  # z and its rate at the start of a cycle if the ball is never to move
    ("drive", "f8", 2),  # largest drive of a stuck ball then [m/s^2]
    ("scale", "f8", _N),  # by which differences of z are measured; rates by that times the frequency
    ("period", "f8"),  # of the force
    ("cycles", "i8"),  # so far
    ("patience", "i8"),  # cycles that the structure's own motion takes to be forgotten
    ("high", "f8"),  # extremes of the probe in this cycle
    ("low", "f8"),
    ("away", "f8", (2, _N)),  # to work on: z and its rate less those of `still`
    ("reference", "f8", (2, _N)),  # z and its rate at the start of a batch
    ("spin", "f8", 2),
    ("near", "f8", 2),  # least distance from there at later cycles, in the middle and in the last batch of a window
    ("repeats", "i8"),  # after how many cycles, in the last
    ("left", "f8"),  # distance that is left to the orbit which the motion comes to
    ("means", "f8", (3, BATCHES)),  # of amplitude, of power put in and of amplitude squared, batch by batch
    ("error", "f8", 2),  # standard errors of these means over the window
    ("drift", "f8"),  # mean amplitude of the window's second half less that of its first
    ("verdict", "i8"),
)
"""A driven motion on its way to its steady state."""

DRIVEN = lines(("run", FLYING), ("envelope", TRACE), ("window", TALLY), ("last", TALLY))
"""A run under a harmonic force: tallies of the window, and of its last batch."""
