"""The particle damper: its parameters in SI, validated once, and what follows from them.

`ParticleDamper`, the structural `Mode` and the exciting `Harmonic` are the inputs. Inside, dampers are rows of one
table (`PARAMETERS`), so that many are computed at once: derived quantities and checks are functions of such rows.
"""

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from numbers import Integral, Real
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int64]
Record: TypeAlias = np.record
Records: TypeAlias = npt.NDArray[np.record]


PAIRS = 16
"""Most pairs of impact speed and restitution."""

PARAMETERS = np.dtype(
    [
        ("modal_mass", "f8"),
        ("stiffness", "f8", 2),
        ("ball_mass", "f8"),
        ("ball_radius", "f8"),
        ("cavity", "f8", 2),
        ("centrifugal_acceleration", "f8"),
        ("restitution", "f8"),
        ("restitution_by_speed", "f8", (PAIRS, 2)),  # beyond the last pair: infinite speeds
        ("friction", "f8"),
        ("rolling_friction", "f8"),
        ("break_away", "f8"),
        ("damping_ratio", "f8"),
        ("sticking_ratio", "f8"),
        ("floor_friction", "f8"),  # 0: no slip
        ("floor_tilt", "f8", 2),
        ("floor_radius", "f8", 2),  # inf: flat
        ("lateral_acceleration", "f8", 2),
        ("rotation", "f8"),
        ("stagger", "f8"),
        ("printed", "?"),
    ]
)
"""One row per damper; the fields are those of `damper.ParticleDamper`, in SI."""

FIELDS = PARAMETERS.names or ()

IMPACT = ("restitution", "restitution_by_speed", "friction", "sticking_ratio")
"""Fields by which the law of impact goes (`damper.impacts`); kernels have them by the same names."""

Parameters = npt.NDArray[np.void]


def ensemble(base: Parameters, size: int, varied: dict[str, Any]) -> Parameters:
    """`size` rows that differ from the one row `base` in the varied fields, of shape (size,) or, in x and y, (size, 2).

    Raises:
        ValueError: an unknown field, a wrong shape, or a value without physical sense.
    """
    rows = np.repeat(base, size)
    if not varied:
        return rows
    for name, values in varied.items():
        if name not in FIELDS or name == "printed":
            raise ValueError(f"{name} is not a field of ParticleDamper that can be varied")
        array = table(name, values)
        if array.shape[:1] != (size,) or array.shape[1:] not in {(), rows[name].shape[1:]}:
            raise ValueError(f"{name} must have {size} values, one for each release, got shape {array.shape}")
        if name == "floor_friction":  # in the rows 0 stands for no slip, which is for the whole batch to say
            _require(array > 0, name, array, "positive")
        rows[name] = array[:, None] if array.ndim < rows[name].ndim else array
    validate(rows)
    return rows


def alike(rows: Parameters) -> bool:
    """Whether all rows are equal, bit by bit."""
    every = np.ascontiguousarray(rows).view(np.uint8).reshape(len(rows), rows.itemsize)
    return bool((every == every[:1]).all())


def number(name: str, value: object) -> float:
    """The value as a float.

    Raises:
        ValueError: it is text, a truth value or anything else; named.
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError(f"{name} must be a number, got {value!r}")
    try:
        return float(value)
    except OverflowError as error:  # a whole number of more than 308 digits
        raise ValueError(f"{name} must be finite") from error


def whole(name: str, value: object) -> int:
    """The value as a whole number from 1 on.

    Raises:
        ValueError: it is anything else; named.
    """
    if isinstance(value, bool) or not isinstance(value, Integral) or value < 1:
        raise ValueError(f"{name} must be a whole number of at least 1, got {value!r}")
    return int(value)


def table(name: str, values: npt.ArrayLike) -> Floats:
    """The values as an array.

    Raises:
        ValueError: they are not numbers, or too large for one; named.
    """
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} must be numbers: {error}") from error


def pair(name: str, value: object) -> tuple[float, float]:
    """The value as two floats.

    Raises:
        ValueError: it is not two numbers; named.
    """
    if not isinstance(value, tuple | list | np.ndarray) or len(value) != 2:
        raise ValueError(f"{name} must be two numbers, along x and y, got {value!r}")
    return number(name, value[0]), number(name, value[1])


def validate(rows: Parameters) -> None:
    """Look whether every quantity makes physical sense.

    Raises:
        ValueError: one does not; field and value are named.
    """
    for name in ("modal_mass", "stiffness", "ball_mass", "ball_radius"):
        _require(rows[name] > 0, name, rows[name], "positive")
    for name in (
        "centrifugal_acceleration",
        "friction",
        "rolling_friction",
        "break_away",
        "damping_ratio",
        "sticking_ratio",
        "floor_friction",
    ):
        _require(rows[name] >= 0, name, rows[name], "≥ 0")
    for name in ("floor_tilt", "lateral_acceleration", "rotation", "stagger"):
        _require(np.isfinite(rows[name]), name, rows[name], "finite")
    steep = np.abs(rows["floor_tilt"]) * rows["ball_radius"][:, None]
    _require(steep <= 1.0, "floor_tilt", rows["floor_tilt"], "at most 1 / ball_radius")
    turn = np.stack([np.sin(rows["stagger"]), np.cos(rows["stagger"])], axis=-1) * rows["rotation"][:, None]
    slope = rows["centrifugal_acceleration"][:, None] * rows["floor_tilt"]
    pull = rows["ball_mass"][:, None] * np.minimum(np.abs(slope), np.abs(slope - turn**2))  # central in the plane
    stable = pull <= rows["stiffness"] * (1 + 1e-9)  # a hinged blade far lighter than its ball is at the limit
    bound = (
        "at most stiffness / (ball_mass * centrifugal_acceleration), beyond which the structure is statically unstable"
    )
    _require(stable, "floor_tilt", rows["floor_tilt"], bound)
    fits = rows["floor_radius"] > rows["ball_radius"][:, None]
    _require(fits, "floor_radius", np.minimum(rows["floor_radius"], 1e300), "more than the ball's radius")
    for name in ("friction", "floor_friction"):
        _require(rows[name] <= 1e6, name, rows[name], "at most 1e6")
    e, zeta = rows["restitution"], rows["damping_ratio"]
    _require((e >= 0) & (e <= 1), "restitution", e, "between 0 and 1")
    speeds, ratios = np.moveaxis(rows["restitution_by_speed"], 2, 0)
    finite = speeds < np.inf
    rises = np.diff(np.where(finite, speeds, 0.0), axis=1, prepend=0.0) > 0
    for holds, values, rule in (
        (rises, speeds, "in ascending order of positive, finite speeds"),
        ((ratios >= 0) & (ratios <= 1), ratios, "restitutions between 0 and 1"),
        (ratios[:, :1] == e[:, None], ratios[:, :1], "restitution up to its first speed"),
    ):
        here = finite[:, : values.shape[1]]
        _require(holds | ~here, "restitution_by_speed", np.where(here, values, 0.0), rule)
    _require(zeta < 1, "damping_ratio", zeta, "at least 0 and below 1")
    fits = rows["cavity"] >= 2 * rows["ball_radius"][:, None] * (1 - 1e-12)
    _require(fits, "cavity", rows["cavity"], "at least the ball's diameter")
    if (rows["printed"] & (rows["floor_friction"] > 0)).any():
        raise ValueError("floor_friction: the printed equations have no slip; use the consistent formulation")
    if (rows["printed"] & ~level(rows)).any():
        raise ValueError("the printed equations support a level floor only; use the consistent formulation")


def stuck_frequency(rows: Parameters) -> Floats:
    """omega_1 along x, the ball stuck, shape (n,) [rad/s]."""
    return np.asarray(np.sqrt(rows["stiffness"][:, 0] / (rows["modal_mass"] + rows["ball_mass"])))


def stuck_decay(rows: Parameters) -> tuple[Floats, Floats]:
    """Decay rate and damped frequency along x, the ball stuck, shape (n,) [1/s, rad/s].

    The frequency is next to nothing where the damping is nearly critical; zeta refers to the structure alone, but in
    the printed equations.
    """
    zeta, mass = rows["damping_ratio"], rows["modal_mass"] + rows["ball_mass"]
    share = np.where(rows["printed"], 0.0, rows["ball_mass"]) / mass
    omega = stuck_frequency(rows)
    # 1 - zeta^2 (1 - share), which must not cancel where zeta nears 1
    return zeta * omega * np.sqrt(1 - share), omega * np.sqrt((1 - zeta) * (1 + zeta) + zeta**2 * share)


def half_gap(rows: Parameters) -> Floats:
    """How far the ball's centre can go from the cavity's centre along x and y, shape (n, 2) [m]."""
    return np.asarray(np.maximum(0.5 * rows["cavity"] - rows["ball_radius"][:, None], 0.0))


def rolling_threshold(rows: Parameters) -> Floats:
    """a_r = mu_r N / (r m_p), shape (n,) [m/s^2]."""
    return np.asarray(rows["rolling_friction"] / rows["ball_radius"] * rows["centrifugal_acceleration"])


def inertia_ratio(rows: Parameters) -> Floats:
    """Beta in  s'' = -beta (u'' - a_r sigma), shape (n,) [-]; see `ParticleDamper.inertia_ratio`."""
    return np.where(rows["centrifugal_acceleration"] == 0, 1.0, np.where(rows["printed"], 5 / 2, 5 / 7))


def spin_mass(rows: Parameters) -> Floats:
    """Mass-equivalent of the rolling ball's spin, shape (n,) [kg]; see `ParticleDamper.spin_mass`."""
    return np.where(rows["printed"] | (rows["centrifugal_acceleration"] == 0), 0.0, 0.4 * rows["ball_mass"])


def lateral_pull(rows: Parameters) -> Floats:
    """Constant acceleration of the ball along the floor, as of a load not square to it, shape (n, 2) [m/s^2]."""
    return np.asarray(rows["lateral_acceleration"])


def resting_place(rows: Parameters, *, undented: bool = False) -> Floats:
    """Where a ball lies in its dent, shape (n, 2) [m]: in the middle, or at the wall that the load draws it to.

    As the speed rises the load draws it there before it is pressed in; a hollow floor may hold it on the way.
    `undented`: also one without a dent, which ring-downs let go in the middle.
    """
    beyond, steep = np.abs(lateral_pull(rows)) - rolling_threshold(rows)[:, None], bowl(rows)
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(beyond > 0, np.minimum(half_gap(rows), np.where(steep > 0, beyond / steep, np.inf)), 0.0)
    lies = undented | (rows["break_away"][:, None] > 0)
    return np.asarray(np.where(lies, np.sign(lateral_pull(rows)) * far, 0.0))


def break_away_threshold(rows: Parameters, *, undented: bool = False) -> Floats:
    """Drive along x and y above which a ball leaves where it rests at first, its dent, shape (n, 2) [m/s^2].

    The load's pull along the floor helps it out of the middle, and holds it at a wall. Below 0 the ball is off at once.
    """
    place = resting_place(rows, undented=undented)
    pull = np.abs(lateral_pull(rows)) - bowl(rows) * np.abs(place)
    at_wall = (place != 0) & (np.abs(place) >= half_gap(rows))
    return np.asarray(rim_threshold(rows)[:, None] + np.where(at_wall, pull, -pull))


def rim_threshold(rows: Parameters) -> Floats:
    """Drive above which a ball climbs the rim of its dent, less the load's pull along the floor, shape (n,) [m/s^2]."""
    return np.asarray(rolling_threshold(rows) + rows["break_away"] * rows["centrifugal_acceleration"])


def bowl(rows: Parameters) -> Floats:
    """How a hollow floor draws the ball back along x and y, over its distance from the middle, shape (n, 2) [1/s^2].

    Omega² R / rho, with the radius rho of the path of the ball's centre.
    """
    curvature = 1.0 / (rows["floor_radius"] - rows["ball_radius"][:, None])
    return np.asarray(rows["centrifugal_acceleration"][:, None] * curvature)


def restoring(rows: Parameters) -> Floats:
    """D: the load accelerates a ball at a place s in its cavity by -D s, shape (n, 2, 2) [1/s^2]."""
    return np.asarray(bowl(rows)[:, :, None] * np.eye(2) - in_plane(rows))


def in_plane(rows: Parameters) -> Floats:
    """Omega² P, shape (n, 2, 2) [1/s²]: how the spin draws a ball outwards along x (flap) and y (chord)."""
    sine, cosine = np.sin(rows["stagger"]), np.cos(rows["stagger"])
    projection = np.array([[sine * sine, -sine * cosine], [-sine * cosine, cosine * cosine]])
    return np.asarray(np.moveaxis(projection * rows["rotation"] ** 2, -1, 0))


def level(rows: Parameters) -> npt.NDArray[np.bool_]:
    """Whether the load pulls the ball to no side, wherever structure and ball are, shape (n,)."""
    bent = (rows["floor_tilt"] != 0).any(axis=1) | np.isfinite(rows["floor_radius"]).any(axis=1)
    bent &= rows["centrifugal_acceleration"] != 0
    return np.asarray((rows["rotation"] == 0) & (lateral_pull(rows) == 0).all(axis=1) & ~bent)


def _require(holds: npt.NDArray[np.bool_], name: str, values: npt.NDArray[Any], rule: str) -> None:
    bad = ~(holds & np.isfinite(values))
    if bad.any():
        raise ValueError(f"{name} must be {rule}, got {values[bad][0]:g}")


@dataclass(frozen=True)
class Mode:
    """A mode of the structure, without the ball, as the cavity feels it; any scale of its coordinate will do.

    Attributes:
        mass: modal mass [kg].
        stiffness: modal stiffness, with what the load does to a ball that stays in its place [N/m].
        shape: displacement of the cavity along x and y for a unit of the mode [-].
        slope: of the cavity's floor along x and y for a unit of the mode [1/m].
        damping_ratio: of the mode [-]; None: the damper's.
        drawn: participation, the mode's force by a unit acceleration of the base along x and y, but for its sign [kg];
            None: as of a structure lumped at the cavity, mass times shape.
    """

    mass: float
    stiffness: float
    shape: tuple[float, float]
    slope: tuple[float, float] = (0.0, 0.0)
    damping_ratio: float | None = None
    drawn: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        for name in ("mass", "stiffness"):
            value = number(name, getattr(self, name))
            if not 0 < value < math.inf:
                raise ValueError(f"a mode's {name} must be positive, got {value:g}")
        for name in ("shape", "slope", "participation"):
            if not all(map(math.isfinite, pair(name, getattr(self, name)))):
                raise ValueError(f"a mode's {name} must be finite, got {getattr(self, name)}")
        if self.damping_ratio is not None and not 0 <= number("damping_ratio", self.damping_ratio) < 1:
            raise ValueError(f"a mode's damping_ratio must be at least 0 and below 1, got {self.damping_ratio:g}")
        for name in ("shape", "slope", "drawn"):  # lists and arrays have no hash
            if getattr(self, name) is not None:
                object.__setattr__(self, name, pair(name, getattr(self, name)))

    @property
    def participation(self) -> tuple[float, float]:
        """`drawn`, or what a structure lumped at the cavity has [kg]."""
        return (self.mass * self.shape[0], self.mass * self.shape[1]) if self.drawn is None else self.drawn


@dataclass(frozen=True)
class Harmonic:
    """A force that goes as cos(frequency t + phase), and a base that moves so.

    Attributes:
        frequency: [rad/s].
        force: at the cavity along x and y [N].
        modal: on each mode, beside that [N]; as many as the damper has modes (without any: one along x, one along y).
        base: acceleration of the structure's root along x and y [m/s^2]; displacements are then relative to the root.
        phase: [rad].
    """

    frequency: float
    force: tuple[float, float] = (0.0, 0.0)
    modal: tuple[float, ...] | None = None
    base: tuple[float, float] = (0.0, 0.0)
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        if not 0 < number("frequency", self.frequency) < math.inf:
            raise ValueError(f"the harmonic's frequency must be positive, got {self.frequency:g}")
        if not (self.modal is None or isinstance(self.modal, tuple | list | np.ndarray)):
            raise ValueError(f"modal must be one number for each mode, or None, got {self.modal!r}")
        if self.modal is not None:  # arrays may change
            object.__setattr__(self, "modal", tuple(number("modal", value) for value in self.modal))
        for name in ("force", "base"):
            object.__setattr__(self, name, pair(name, getattr(self, name)))
        values = [*self.force, *self.base, *(self.modal or ()), number("phase", self.phase)]
        if not all(map(math.isfinite, values)):
            raise ValueError("the harmonic's force, base and phase must be finite")


class Formulation(StrEnum):
    """Which equations govern a rolling ball.

    ``CONSISTENT``: Newton's third law and a solid sphere that rolls on a floor; energy is conserved up to the
    work of impacts, rolling resistance and the structure's own damping. ``PRINTED``: eqs. (1)-(4) of the paper
    as they stand (moment of inertia about the centre, no reaction of the ball's inertia); energy is not conserved.
    """

    CONSISTENT = "consistent"
    PRINTED = "printed"


_ABSENT = {"floor_friction": 0.0, "floor_radius": np.inf}
"""Rows' values for what a damper has not."""


@dataclass(frozen=True)
class ParticleDamper:
    """A ball in a cavity on a vibrating structure, pressed onto the cavity's floor by a centrifugal load.

    Attributes:
        modal_mass: M2, effective mass of the structure without the ball [kg].
        stiffness: K, effective stiffness of the structure along x and y [N/m].
        ball_mass: m_p, mass of all balls together [kg]; they move in step.
        ball_radius: r [m].
        cavity: l1 and l2, the cavity's length along x and width along y [m].
        centrifugal_acceleration: Omega**2 R, which presses the ball onto the floor [m/s^2].
        restitution: e, ratio of the normal relative speeds after and before a wall hit [-].
        restitution_by_speed: pairs of impact speed [m/s] and e, speeds ascending, the first with `restitution`, which
            holds up to that speed. Between two pairs e is linear in the logarithm of the speed; above the last it falls
            as (speed / v)^(1/4), as hits do that leave a dent (K. L. Johnson, Contact Mechanics, 1985, section 11.5).
            A single pair is thus a yield speed; without pairs e is constant.
        break_away: slope of the rim of the dent in which a ball lies that begins at rest [-]. It is held until its
            drive exceeds `break_away_threshold`. Once it has moved, it rolls in the groove that its load presses into
            the floor: this has no rim across the path, and only `leaving_threshold` holds the ball.
        lateral_acceleration: component of the load along x and y that always pulls the ball along the floor, as on a
            floor that is not perpendicular to the load [m/s^2]. Above the rolling threshold the ball leans on a wall.
            Displacements are relative to the equilibrium with the ball in the middle of its cavity.
        friction: mu, cap on the ratio of tangential to normal impulse in a wall hit [-].
        rolling_friction: mu_r, lever arm of the rolling resistance [m].
        damping_ratio: zeta, the structure's own damping without the ball [-].
        sticking_ratio: epsilon, relative to structural speed below which a hit ends in sticking [-].
        formulation: which equations of rolling are used.
        floor_friction: coefficient of sliding friction on the floor [-]. If given, the ball keeps its spin in a
            wall hit except for the change by wall friction, since the floor's finite force has no time to act, and
            slips until it rolls again. None: the spin follows the new rolling velocity at once, as in the paper.
        floor_tilt: kappa, slope of the cavity's floor along x and y over the structure's displacement [1/m]; the load
            then pulls the ball down the slope, by Omega**2 R kappa u.
        floor_radius: of the cavity's floor along x and y [m], more than the ball's; None: flat. A bowl of radius rho_c
            draws the ball back to its middle by Omega**2 R s / (rho_c - r).
        rotation: Omega [rad/s], which pulls a ball outwards in the plane of rotation by Omega**2 times its offset
            in it; 0: neglected.
        stagger: angle by which the axis of rotation is tilted from x towards y [rad]; at 0 the plane of rotation
            holds y, at pi/2 it holds x. It only affects the pull by `rotation`.
        modes: structural modes that move the cavity, in place of one along x and one along y; `modal_mass` and
            `stiffness` then only define the reference of amplitudes, cycles and bounds: the mode that moves the cavity
            most along x (and y), scaled to 1 there. None: these two and `floor_tilt` define the structure.

    Raises:
        ValueError: a quantity has no physical sense; the message names it.
    """

    modal_mass: float
    stiffness: tuple[float, float]
    ball_mass: float
    ball_radius: float
    cavity: tuple[float, float]
    centrifugal_acceleration: float
    restitution: float
    friction: float = 0.0
    rolling_friction: float = 0.0
    damping_ratio: float = 0.0
    sticking_ratio: float = 1e-2
    formulation: Formulation = Formulation.CONSISTENT
    floor_friction: float | None = None
    floor_tilt: tuple[float, float] = (0.0, 0.0)
    floor_radius: tuple[float, float] | None = None
    rotation: float = 0.0
    stagger: float = 0.0
    modes: tuple[Mode, ...] | None = None
    restitution_by_speed: tuple[tuple[float, float], ...] = ()
    break_away: float = 0.0
    lateral_acceleration: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        object.__setattr__(self, "restitution_by_speed", _speed_pairs(self.restitution_by_speed))
        Formulation(self.formulation)
        if self.floor_friction is not None and not number("floor_friction", self.floor_friction) > 0:
            raise ValueError(f"floor_friction must be positive or None, got {self.floor_friction:g}")
        if self.modes is not None:
            listed = isinstance(self.modes, tuple | list) and len(self.modes) > 0
            if not (listed and all(isinstance(mode, Mode) for mode in self.modes)):
                raise ValueError(f"modes must be a tuple of at least one Mode, or None, got {self.modes!r}")
            if not any(any(mode.shape) for mode in self.modes):
                raise ValueError("modes: none of them moves the cavity")
            if pair("floor_tilt", self.floor_tilt) != (0.0, 0.0):
                raise ValueError("floor_tilt belongs to a structure without modes; modes have slopes of their own")
            object.__setattr__(self, "modes", tuple(self.modes))
        validate(_row(self))
        pairs = "stiffness", "cavity", "floor_tilt", "floor_radius", "lateral_acceleration"
        for name in pairs:  # lists and arrays have no hash
            if getattr(self, name) is not None:
                object.__setattr__(self, name, pair(name, getattr(self, name)))

    @property
    def parameters(self) -> Parameters:
        """The fields as one row, shape (1,), for what works on many dampers alike; not to be written to."""
        return _known_row(self)

    @property
    def level(self) -> bool:
        """Whether the load pulls the ball to no side, as in the paper: on a floor square to it, always."""
        return bool(level(self.parameters)[0])

    @property
    def stuck_mass(self) -> float:
        """M1 = M2 + m_p [kg]."""
        return self.modal_mass + self.ball_mass

    @property
    def stuck_frequency(self) -> float:
        """omega_1 along x, the ball stuck [rad/s]."""
        return float(stuck_frequency(self.parameters)[0])

    @property
    def swing_frequency(self) -> float:
        """The same of the mode that leads along x, which may move the cavity along y too [rad/s]."""
        return math.sqrt(self._swing(0)[1])

    @property
    def half_gap(self) -> tuple[float, float]:
        """How far the ball's centre can go from the cavity's centre along x and y [m]."""
        return pair("half_gap", half_gap(self.parameters)[0])

    @property
    def tilt_share(self) -> tuple[float, float]:
        """Share tau of the ball's drive that the load's pull takes away along x and y [-].

        The load accelerates a ball in the middle of its cavity by -E u; where u swings with the frequency omega of an
        axis, its drive is u'' + E u = (1 - tau) u'', tau = E / omega**2. On a floor that tilts E = Omega**2 R kappa.
        """
        x, y = (float(pull[axis] / square) for axis, (_, square, pull) in enumerate(map(self._swing, range(2))))
        return x, y

    def _swing(self, axis: int) -> tuple[Floats, float, Floats]:
        """The swing that leads along an axis, the ball stuck, over its part along it.

        Returns:
            Displacement (2,); omega**2 [1/s^2]; what the load takes of the drive along x and y, (2,) [1/s^2].
        """
        mode = None if self.modes is None else self.modes[self.leading(axis)]
        if mode is None or mode.shape[axis] == 0:
            along = np.eye(2)[axis]
            return along, self.stiffness[axis] / self.stuck_mass, self.pull @ along
        shape = np.array(mode.shape)
        square = mode.stiffness / (mode.mass + self.ball_mass * float(shape @ shape))
        load = float(self.parameters["centrifugal_acceleration"][0])
        drawn = in_plane(self.parameters)[0] @ shape
        return shape / shape[axis], square, (load * np.array(mode.slope) - drawn) / shape[axis]

    @property
    def restoring(self) -> Floats:
        """D: the load accelerates a ball at a place s in its cavity by -D s, shape (2, 2) [1/s^2]."""
        return np.asarray(restoring(self.parameters)[0])

    @property
    def pull(self) -> Floats:
        """E: the load accelerates a ball in the middle of its cavity by -E u, shape (2, 2) [1/s^2].

        In a structure of several modes, that of those that yield most to a force at the cavity along x and along y.
        """
        load = self.parameters["centrifugal_acceleration"][0] * np.diag(self._tilt)
        return np.asarray(load - in_plane(self.parameters)[0])

    def leading(self, axis: int) -> int:
        """Which of the modes yields most to a force at the cavity along an axis."""
        modes = self.modes or ()
        return max(range(len(modes)), key=lambda k: modes[k].shape[axis] ** 2 / modes[k].stiffness)

    @property
    def _tilt(self) -> tuple[float, float]:
        """Slope over displacement along x and y [1/m]."""
        if self.modes is None:
            return self.floor_tilt
        x, y = (self.modes[self.leading(i)] for i in range(2))
        return x.slope[0] / (x.shape[0] or math.inf), y.slope[1] / (y.shape[1] or math.inf)

    @property
    def rolling_threshold(self) -> float:
        """a_r = mu_r N / (r m_p): the structure's acceleration above which a stuck ball rolls [m/s^2]."""
        return float(rolling_threshold(self.parameters)[0])

    @property
    def lateral_pull(self) -> tuple[float, float]:
        """Constant acceleration of the ball along the floor [m/s^2]."""
        return pair("lateral_pull", lateral_pull(self.parameters)[0])

    @property
    def largest_restitution(self) -> float:
        """Coefficient of restitution of the softest hits [-]."""
        return max([self.restitution, *(ratio for _, ratio in self.restitution_by_speed)])

    @property
    def loses_nothing_in_hits(self) -> bool:
        """Whether every hit is elastic; friction at the wall counts apart."""
        return min([self.restitution, *(ratio for _, ratio in self.restitution_by_speed)]) == 1

    @property
    def leaving_threshold(self) -> float:
        """Drive along x above which a ball leaves where it rests for good [m/s^2].

        With a lateral pull that is at a wall, on a hollow floor only if it pulls the ball that far up.
        """
        drawn_back = float(bowl(self.parameters)[0, 0]) * self.half_gap[0]
        return self.rolling_threshold + max(abs(self.lateral_pull[0]) - drawn_back, 0.0)

    @property
    def break_away_threshold(self) -> float:
        """The same for a ball that begins in its dent, whose rim adds Omega**2 R times its slope [m/s^2]."""
        return max(self.leaving_threshold, float(break_away_threshold(self.parameters)[0, 0]))

    def amplitude_of(self, drive: float) -> float:
        """Amplitude along x of a vibration, the ball stuck, that drives the ball by so much [m]; inf: none does.

        Args:
            drive: acceleration of the structure, less what the tilt of the floor takes of it [m/s^2].
        """
        (swing, square, pull), left = self._swing(0), abs(1 - self.tilt_share[0])
        if self.formulation != "printed" and not any(self.lateral_pull):  # a ball at rest is held along each axis
            left = max(left, abs(float(swing[1] - pull[1] / square)))
        return math.inf if left == 0 else drive / square / left

    @property
    def cross_drive(self) -> float:
        """Drive along y per amplitude along x of the mode that leads along x, the ball stuck [1/s^2]."""
        swing, square, pull = self._swing(0)
        return abs(float(square * swing[1] - pull[1]))

    @property
    def inertia_ratio(self) -> float:
        """Beta in  s'' = -beta (u'' - a_r sigma)  [-].

        5/7 for a solid sphere on a floor (moments about the contact); 5/2 as the paper prints it (moment of
        inertia about the centre in an equation of moments about the contact); 1 for a ball that nothing presses
        onto the floor, which floats.
        """
        return float(inertia_ratio(self.parameters)[0])

    @property
    def spin_mass(self) -> float:
        """Mass-equivalent of the rolling ball's spin, 2/5 m_p [kg]; none in the printed equations or afloat."""
        return float(spin_mass(self.parameters)[0])


def _speed_pairs(pairs: object) -> tuple[tuple[float, float], ...]:
    """Pairs of impact speed and restitution."""
    name = "restitution_by_speed"
    if not isinstance(pairs, tuple | list | np.ndarray) or len(pairs) > PAIRS:
        raise ValueError(f"{name} must be at most {PAIRS} pairs of an impact speed and a restitution, got {pairs!r}")
    return tuple(pair(name, each) for each in pairs)


def _row(damper: ParticleDamper) -> Parameters:
    rows = np.zeros(1, PARAMETERS)
    rows["printed"] = damper.formulation == Formulation.PRINTED
    rows["restitution_by_speed"] = (math.inf, 0.0)
    for k, each in enumerate(damper.restitution_by_speed):
        rows["restitution_by_speed"][0, k] = each
    for name in (name for name in FIELDS if name not in {"printed", "restitution_by_speed"}):
        value = getattr(damper, name)
        absent = value is None and name in _ABSENT
        rows[name] = _ABSENT[name] if absent else (pair if rows[name].ndim == 2 else number)(name, value)
    rows.flags.writeable = False
    return rows


_known_row = lru_cache(maxsize=256)(_row)
