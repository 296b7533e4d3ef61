"""What a run hands on: frozen records, SI inside, from the stages to the writers; and how a sweep of modes fills them.

The annotation of a field is all that is said of it: files, their schema and the columns of sweeps follow from there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
from pydantic import Field, PlainSerializer, WithJsonSchema, computed_field
from pydantic.functional_validators import BeforeValidator, PlainValidator, model_validator

import fem
from fem import modal_model
from fem.meshes.cells import edges_of
from fem.meshes.planform import clamped_length, root_facets
from fem.rotor import from_rpm
from workflows.effects.definition import Effect, LeftOut
from workflows.formatting import rounded_rpm
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    import damper
    from fem.output import Finer


T = TypeVar("T")


def quantity(unit: str, name: str | None = None, **more: Any) -> Any:
    """A number, a pair of numbers, or a text of a record, as files carry it; the docstring beneath is its meaning.

    Args:
        unit: "1" where it has none; empty for a text.
        name: under which it is published, if not that of the field.
        more: for data sets `alone`, its name beside those of other records, and `ends`, what tells a pair apart;
            `headline`: whether a sweep has a column of it.
    """
    return Field(alias=name, json_schema_extra={"unit": unit, **more})


def part(name: str | None = None, **more: Any) -> Any:
    """A record within a record, or a tuple of them; what has a default is left out of files where it has that value.

    Args:
        name: under which it is published, if not that of the field.
        more: for data sets `prefix`, of its quantities' names, and `along`, the dimension of a tuple;
            `headline`: False where sweeps have no columns of it.
    """
    return Field(alias=name, json_schema_extra=more)


KEPT = Field(exclude=True)
"""What is not published, but kept in `results.nc` for whoever opens the run again."""

COLUMN = Field(exclude=True, json_schema_extra={"column": True})
"""An array that is published as a column of a list of rows, which is a property of the record."""


def copy_fields(record: type[T], source: object, **more: object) -> T:
    """A record whose fields are those of the same names of another object, and more."""
    fields_of: Mapping[str, Any] = {
        f.name: getattr(source, f.name)
        for f in fields(record)  # type: ignore[arg-type]
        if f.name not in more and hasattr(source, f.name)
    }
    return record(**fields_of, **more)


def _array(kind: type) -> tuple[PlainValidator, PlainSerializer]:
    """How pydantic takes an array: from a list with null where there is no number, and to one."""
    read = PlainValidator(lambda value: value if isinstance(value, np.ndarray) else np.array(value, kind))
    return read, PlainSerializer(np.ndarray.tolist, when_used="json")


Floats = Annotated[npt.NDArray[np.float64], *_array(float)]
Ints = Annotated[npt.NDArray[np.int64], *_array(int)]

_NULL = WithJsonSchema({"type": ["number", "null"]})
_NULL_AS_NAN = (BeforeValidator(lambda value: math.nan if value is None else value), _NULL)

Unknown = Annotated[float, *_NULL_AS_NAN]
"""A number that may be none that is finite, which is published as null."""

Boundless = Annotated[float, BeforeValidator(lambda value: math.inf if value is None else value), _NULL]
"""A number that may be infinite, which is published as null."""

MaybeUnknown = Annotated[float | None, *_NULL_AS_NAN]
"""The same, left out of files where it is None."""

Pair = tuple[Unknown, Unknown]

_ENDS = ("low", "high")


@dataclass(frozen=True)
class CurvePoint:
    """A point of a damping curve."""

    amplitude: Annotated[float, quantity("m", alone="working_amplitude")]
    """amplitude"""
    damping_ratio: Annotated[float, quantity("1", alone="working_damping_ratio")]
    """damping ratio there"""


@dataclass(frozen=True)
class Cycle:
    """A vibration cycle of a ring-down."""

    amplitude_g: Annotated[float, quantity("g")]
    """V ω1 / g"""
    sdc: Annotated[Unknown, quantity("1")]
    """null: the ball gave the structure more energy than it had, which is no cycle"""
    peak_velocity: Annotated[float, quantity("m/s")]
    """of the structure"""


def _rows(record: type[T], owner: object) -> list[T]:
    """The arrays of an owner as rows, each a record of the fields of the same names."""
    columns = (getattr(owner, f.name).tolist() for f in fields(record))  # type: ignore[arg-type]
    return [record(*row) for row in zip(*columns, strict=True)]


def _columns(record: type, data: Any, name: str) -> Any:
    """Published data in which rows have become columns again."""
    if not isinstance(data, Mapping) or name not in data:
        return data
    return {**data, **{f.name: [row[f.name] for row in data[name]] for f in fields(record)}}


@dataclass(frozen=True, eq=False)
class Figures:
    """What a damper does to a steady vibration; amplitudes are the structure's displacements along x at the damper."""

    peak: Annotated[float, quantity("1", "damping_ratio_peak", headline=True)]
    """largest equivalent damping ratio of the ball at a prescribed amplitude"""
    peak_amplitude: Annotated[Unknown, quantity("m", "at_amplitude", headline=True)]
    """amplitude at the cavity where that is"""
    range: Annotated[Pair, quantity("m", ends=_ENDS, headline=True)]
    """of amplitudes about the peak at which the damper works, with at least half of it"""
    half: Annotated[Pair, quantity("m", "half_range", ends=_ENDS, headline=True)] = field(repr=False)
    """amplitudes about the peak between which the damping is at least half of it; others may lie apart from these"""
    cutoff: Annotated[Boundless, quantity("m", headline=True)]
    """amplitude up to which the ball stays at rest"""
    amplitude: Annotated[Floats, COLUMN]
    damping_ratio: Annotated[Floats, COLUMN]

    @computed_field(description="damping ratio over amplitude", json_schema_extra={"along": "point"})  # type: ignore[prop-decorator]
    @property
    def curve(self) -> list[CurvePoint]:
        """The curve, point by point."""
        return _rows(CurvePoint, self)

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any) -> Any:
        return _columns(CurvePoint, data, "curve")


@dataclass(frozen=True)
class Pendulum:
    """A ball in a hollow floor; 0 where it finds no way back. The order is the same at all speeds."""

    frequency_hz: Annotated[Pair, quantity("Hz")]
    """frequency along each of the damper's axes"""
    order: Annotated[Pair, quantity("1")]
    """that over the rotation's frequency"""


@dataclass(frozen=True, eq=False)
class OwnFigures(Figures):
    """The same for a vibration that grows slowly, with its error, and beside it for one that falls."""

    error: Annotated[float, quantity("1", alone="working_error", headline=True)]
    """of the peak, relative: spread of the measurement, effect of its pace, and chance in where growing vibration
    begins to bounce"""
    half_error: Annotated[float, quantity("1")] = field(repr=False)
    """of `half`, relative: the same, and how far its ends move with that; they may lie where the curve is flat"""
    from_above: Annotated[Figures, part(prefix="from_above_")] = field(repr=False)
    """the same as the vibration falls and the ball keeps bouncing; the other figures are for growing vibration, the
    least of starts rolling about the middle, or at rest there or at a wall against which rotation holds the ball"""
    slow_ramp: Annotated[Figures, part(prefix="slow_ramp_")] = field(repr=False)
    """the same on slow ramps from rest, 0.1 to 0.3 % per cycle, on which the ball drifts and bounces earlier: the mean,
    typical but not guaranteed"""
    abrupt_start: Annotated[Figures, part(prefix="abrupt_start_")] = field(repr=False)
    """the same after an abrupt start: cycles 13 to 36 at the full amplitude, from a ball at rest in the middle, or at a
    wall if it would not stay there; later it may drift to a wall and bounce"""
    folds: Annotated[Pair, quantity("m", ends=_ENDS, headline=True)]
    """amplitudes between which growing and falling vibration differ: from where bouncing ends on the way down to where
    a ball that rolls about the middle must meet the walls or has strayed to one; null where they do not differ"""
    jump: Annotated[Pair, quantity("m", ends=_ENDS)]
    """amplitudes at which the first and the last sweep up from rest begin to bounce, depending on how the vibration
    grows; null as for `folds`"""
    level: Annotated[Figures | None, part("level_floor", prefix="level_", headline=False)] = field(repr=False)
    """figures for falling vibration on a level floor, where the scene keeps the floor level; else null"""
    tilt_share: Annotated[float, quantity("1", "floor_tilt_share", headline=True)]
    """share of the ball's drive along axis 1 that the tilt of the floor takes: at 1 nothing drives it that way"""
    pendulum: Annotated[Pendulum | None, part(prefix="pendulum_")] = None
    """the ball in a hollow floor along the damper's axes: frequency, and that over the rotation's"""
    tilted_cutoff_g: Annotated[MaybeUnknown, quantity("g")] = None
    """cut-off of a ring-down with the tilt that the scene leaves out; null: the ball never moves"""
    tilted_cutoff_ratio: Annotated[MaybeUnknown, quantity("1")] = None
    """that over load_g"""
    driven_from: Annotated[MaybeUnknown, quantity("m")] = field(default=None, repr=False)
    """amplitude above which the simulated forces move a ball at rest along x, where others may move it above the
    cut-off: Coriolis forces, a sideways pull under a stagger, a varying load; else null"""

    @property
    def ways_differ(self) -> bool:
        """Whether the way down differs from the way up."""
        return self.folds[0] < self.folds[1]

    @classmethod
    def of(cls, measured: damper.DampingCurve, tilt_share: float, first: float, **more: Any) -> OwnFigures:
        """Those that were measured, with what else is known of the floor.

        `first`: amplitude above which forces that are not simulated move a ball at rest [m].
        """
        ways = {way: getattr(measured, way) or measured for way in OTHER_WAYS}
        more |= {way: copy_fields(Figures, each, cutoff=min(each.cutoff, first)) for way, each in ways.items()}
        if first < measured.cutoff:
            more |= {"driven_from": measured.cutoff, "cutoff": first}
        return copy_fields(cls, measured, tilt_share=tilt_share, **{"level": None} | more)

    @property
    def drives_from(self) -> float:
        """Amplitude above which the simulated forces move a ball at rest [m]."""
        return self.cutoff if self.driven_from is None else self.driven_from


OTHER_WAYS = ("from_above", "slow_ramp", "abrupt_start")
"""Fields of `OwnFigures` that are the same figures for other starts."""


@dataclass(frozen=True)
class ContactFigures:
    """The ball at rest on its floor, by Hertz; null where the strength is not known that decides."""

    hertz_radius: Annotated[float, quantity("m")]
    """of the contact, were it elastic"""
    peak_pressure: Annotated[float, quantity("Pa")]
    """at the middle of the contact, were it elastic"""
    yield_ratio: Annotated[Unknown, quantity("1", headline=True)]
    """load over that at which the weaker of ball and floor yields first"""
    hardness_ratio: Annotated[Unknown, quantity("1", headline=True)]
    """mean pressure over the hardness of the softer; from 1 on it flows"""
    dent_radius: Annotated[Unknown, quantity("m")]
    """at most; 0 where nothing yields"""
    dent_depth: Annotated[Unknown, quantity("m")]
    """at most"""
    dent_slope: Annotated[Unknown, quantity("1")]
    """of the dent's rim under the load; elastic recovery leaves less to climb"""


@dataclass(frozen=True)
class HitFigures:
    """Hits of a ball on a wall at the amplitude of the largest damping, where their materials are known by name."""

    duration: Annotated[float, quantity("s")]
    """how long one lasts, by Hertz"""
    flight: Annotated[float, quantity("s")]
    """time between two"""
    sliding: Annotated[MaybeUnknown, quantity("s")]
    """how long a ball slides on the floor after one until it rolls, 2/7 of its change of speed over what friction
    decelerates it by; null without friction"""
    scattered: Annotated[MaybeUnknown, quantity("1")]
    """share of a ball's kinetic energy that one feeds into modes that are not simulated, which no figure includes; null
    where the structure is known by some modes alone"""
    dissipated: Annotated[float, quantity("1")]
    """the same by restitution, 1 - e²"""


class Grade(StrEnum):
    """How much a damper does, beside what the air does: as much, a tenth of it, less, nothing."""

    YES = "yes"
    MODEST = "modest"
    NEGLIGIBLE = "negligible"
    LOCKED = "locked"
    INADMISSIBLE = "inadmissible"
    UNKNOWN = "unknown"


class Reason(StrEnum):
    """What limits a damper, or a verdict on it."""

    NONE = ""
    ENDURANCE = "endurance"
    OUT_OF_REACH = "out_of_reach"
    FILLED = "filled_cavity"
    TILT = "floor_tilt"
    LOSSLESS = "no_loss"
    NOT_FOUND = "not_found"
    WEIGHT = "ball_weight"
    SIDEWAYS = "sideways"
    SLIP = "slip"
    PRINTED = "printed_equations"
    DENSITY = "ball_density"
    ROOT_STRESS = "root_stress"
    CONTACT = "contact"
    NOT_DRIVEN = "not_driven"
    OTHER_MODE = "other_mode"
    SWINGS = "ball_swings"
    OUTSIDE = "outside_speeds"


@dataclass(frozen=True)
class Verdict:
    """What a damper is good for at a speed."""

    grade: Annotated[str, quantity("")]
    """yes: at least what air gives blades; modest: at least a tenth of that; negligible: less; locked: the ball never
    moves within what the structure endures; inadmissible: no such ball, plate or law, or a contact that flows; unknown:
    outside the model"""
    damping_ratio: Annotated[float | None, quantity("1")]
    """largest damping ratio within what the structure endures; null: no verdict"""
    amplitude: Annotated[float | None, quantity("m")]
    """amplitude at the cavity where that is"""
    useful: Annotated[Pair, quantity("m", "useful_range", ends=_ENDS, headline=True)]
    """amplitudes about the peak between which the damping is at least half of it, as far as the structure endures them;
    there may be others apart from these"""
    reason: Annotated[str, quantity("")]
    """what limits the damper or the verdict, empty where nothing does: endurance (more beyond what the structure
    endures), out_of_reach (the ball moves only beyond that), filled_cavity, floor_tilt (it cancels the drive), no_loss,
    not_found, ball_weight, sideways (forces that are not counted move it first, see driven_from), slip,
    printed_equations, ball_density, root_stress, contact (ball or floor yields fully under the load)"""

    @classmethod
    def without_figures(cls, grade: Grade, reason: Reason, damping_ratio: float | None = None) -> Verdict:
        """One that names no amplitude."""
        return cls(grade, damping_ratio, None, (math.nan, math.nan), reason)

    @property
    def rank(self) -> int:
        """The grade as a number: 3 yes, 2 modest, 1 negligible, 0 nothing, -1 without a verdict."""
        if self.damping_ratio is None:
            return -1
        return {Grade.YES: 3, Grade.MODEST: 2}.get(Grade(self.grade), 1) if self.damping_ratio else 0


@dataclass(frozen=True)
class ForceLevel:
    """What the ball does at resonance under one level of the excitation."""

    level: Annotated[float, quantity("1")]
    """height of the excitation, in its unit"""
    ratio: Annotated[float, quantity("1")]
    """largest amplitude with the ball over the one without"""
    amplitude: Annotated[float, quantity("m")]
    """at the cavity, with the ball"""
    endured: Annotated[bool, quantity("1")]
    """whether the structure endures that amplitude, as far as it is known"""


@dataclass(frozen=True)
class VibrationReduction:
    """How much less a mode vibrates with the ball where an engine order meets it, by the balance of free vibration."""

    order: Annotated[int, quantity("1")]
    """engine order"""
    mode: Annotated[int, quantity("1")]
    """number of the mode at the lowest speed, from 1"""
    family: Annotated[str, quantity("")]
    """what the mode does"""
    rpm: Annotated[float, quantity("rpm")]
    """speed of the crossing without the ball, at which order and mode differ by no more than 1e-5 of the frequency"""
    frequency_hz: Annotated[float, quantity("Hz")]
    """of the order there"""
    ratio: Annotated[Unknown, quantity("1")] = math.nan
    """least amplitude with the ball over the one without, of all levels endured; null: none"""
    level: Annotated[Unknown, quantity("1")] = math.nan
    """height of the excitation at which that is, in its unit"""
    range: Annotated[Pair, quantity("1")] = (math.nan, math.nan)
    """levels between which it does at least half of that, as far as endured; null: nowhere 1 %"""
    endured_level: Annotated[Unknown, quantity("1")] = math.nan
    """level up to which the structure endures the amplitude; null: no limit is known"""
    moves_from: Annotated[Unknown, quantity("1")] = math.nan
    """level up to which the load holds the ball at rest; null: at any"""
    levels: Annotated[tuple[ForceLevel, ...], part()] = ()
    """the levels of [excitation]"""
    loose: Annotated[bool, quantity("1")] = False
    """whether the ball is too heavy, or held too loosely by the load, for more than a rough estimate"""
    reason: Annotated[str, quantity("")] = Reason.NONE
    """why there is no estimate, empty where there is one: as of a verdict, or not_driven, other_mode (another moves the
    cavity more), ball_swings (in its hollow floor), outside_speeds (there the order meets the mode with the ball at
    rest)"""
    detail: Annotated[str, quantity("")] = ""
    """the same in words, where they say more"""
    driven_from: Annotated[Unknown, quantity("1")] = math.nan
    """level from which the simulated forces move the ball; null: none"""
    friction_needed: Annotated[Unknown, quantity("1")] = math.nan
    """friction coefficient that rolling without slip requires at `level`; null: that of the scene is enough"""

    @property
    def omega(self) -> float:
        """The speed [rad/s]."""
        return from_rpm(self.rpm)


@dataclass(frozen=True)
class Energy:
    """Where the energy went [J]; `residual` is what the books do not explain."""

    initial: Annotated[float, quantity("J")]
    """at the release"""
    final: Annotated[float, quantity("J")]
    """left at the end"""
    structure: Annotated[float, quantity("J")]
    """lost to the structure's own damping"""
    rolling: Annotated[float, quantity("J")]
    """lost to rolling resistance"""
    impact: Annotated[float, quantity("J")]
    """lost in hits of the walls"""
    slip: Annotated[float, quantity("J")]
    """lost to slip on the floor"""
    residual: Annotated[float, quantity("J")]
    """not explained by the energy balance"""

    @property
    def ball_share(self) -> float:
        """Share of the energy lost that the ball took, by rolling, impact and slip."""
        ball = self.rolling + self.impact + self.slip
        lost = ball + self.structure
        return ball / lost if lost > 0 else 0.0


@dataclass(frozen=True)
class ModalEnergy:
    """Energy that is left at the end in a mode of the plate."""

    mode: Annotated[int, quantity("1"), Field(ge=1)]
    """its number"""
    energy: Annotated[float, quantity("J")]
    """modal energy"""


@dataclass(frozen=True, eq=False)
class History:
    """The structure's motion, sampled: t (n,) [s], velocity (n, 2) [m/s]."""

    t: Floats = field(repr=False)
    velocity: Floats = field(repr=False)


@dataclass(frozen=True, eq=False)
class BallPath:
    """The ball's way through its cavity over a stretch of a ring-down; straight lines between the times are close.

    Attributes:
        t: (n,) [s], ascending; the time of every event is among them.
        ball: its centre from the cavity's, (n, 2) [m].
        structure: displacement of the cavity, (n, 2) [m].
        regime: from each time on, along each axis, (n, 2): 0 at rest in the cavity, 1 rolling, 2 slipping.
        at: which of the times have an event, (k,); kind: what it is: `release`, `start` (it sets off), `reversal`,
            `hit`, `rub` (along the wall that is hit), `grip` (slip ends); axis: 0 or 1.
    """

    t: Floats = field(repr=False)
    ball: Floats = field(repr=False)
    structure: Floats = field(repr=False)
    regime: Ints = field(repr=False)
    at: Ints = field(repr=False)
    kind: tuple[str, ...] = field(repr=False)
    axis: Ints = field(repr=False)


@dataclass(frozen=True, eq=False)
class Damping:
    """One ring-down. Arrays hold a value per vibration cycle.

    What is not published serves pictures and remarks: `stopped` is when the ball came to rest
    for good [s], None where it did not (yet); `ball_mass` that of all balls [kg]; `release` the displacement at the
    release along the damper's axes [m]. `history` and `path` are kept at the speed that the pictures show; there is no
    path of a ball that never moves.
    """

    outcome: Annotated[str, KEPT]
    impacts: Annotated[int, quantity("1", headline=True), Field(ge=0)]
    """hits of the walls"""
    events: Annotated[int, quantity("1", headline=True), Field(ge=0)]
    """events of any kind"""
    duration: Annotated[float, quantity("s")]
    """time simulated"""
    stopped: Annotated[float | None, KEPT]
    ball_mass: Annotated[float, KEPT]
    release: Annotated[Pair, KEPT]
    intrinsic_sdc: Annotated[float, quantity("1")]
    """lost to the structure's own damping in a cycle"""
    peak_sdc: Annotated[float | None, quantity("1", headline=True)]
    """everything lost in a cycle over its energy, at most"""
    peak_sdc_at_g: Annotated[float | None, quantity("g")]
    """amplitude where that is"""
    cutoff_g: Annotated[float | None, quantity("g")]
    """amplitude of the last cycle in which the ball moved"""
    cutoff_ratio: Annotated[float | None, quantity("1", headline=True)]
    """cutoff_g over load_g"""
    largest_rolling_demand: Annotated[float | None, quantity("1")]
    """friction that pure rolling needs, over the normal load"""
    amplitude_g: Annotated[Floats, COLUMN] = field(repr=False)
    sdc: Annotated[Floats, COLUMN] = field(repr=False)
    peak_velocity: Annotated[Floats, COLUMN] = field(repr=False)
    energy: Annotated[Energy, part(prefix="energy_")]
    """joules; residual: not explained by the energy balance"""
    modal_energies: Annotated[tuple[ModalEnergy, ...], part(prefix="modal_", along="modal")] = field(
        default_factory=tuple
    )
    """remaining in the structure's modes at the end, joules"""
    history: Annotated[History | None, KEPT] = None
    path: Annotated[BallPath | None, KEPT] = None

    @computed_field(description="one for each vibration cycle", json_schema_extra={"along": "cycle"})  # type: ignore[prop-decorator]
    @property
    def cycles(self) -> list[Cycle]:
        """The ring-down, cycle by cycle."""
        return _rows(Cycle, self)

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any) -> Any:
        return _columns(Cycle, data, "cycles")


@dataclass(frozen=True)
class ErrorParts:
    """What the relative error of a frequency is estimated to consist of, each without sign.

    None where a part is not known, or an effect is not left out.
    """

    mesh: Annotated[float | None, quantity("1")]
    """left by the mesh; of known modes, what their file states in all"""
    layers: Annotated[float, quantity("1")]
    """left by the layers of a solid"""
    basis: Annotated[Unknown, quantity("1")]
    """added by the reduced basis that answers many speeds, at most"""
    theory: Annotated[float, quantity("1")]
    """of the plate theory, against a solid"""
    large_deflection: Annotated[float | None, quantity("1")]
    """what large deflection would move, left out"""
    coriolis: Annotated[float | None, quantity("1")]
    """what Coriolis forces would move, left out"""
    cavity_mass: Annotated[float | None, quantity("1")] = None
    """by cavities: of their stiffness and extent, and of their mass where left out"""

    @property
    def whole(self) -> float | None:
        """The sum; None where the mesh's part is not known."""
        return None if self.mesh is None else self.at_least

    @property
    def at_least(self) -> float:
        """The sum of what is known."""
        left_out = (self.large_deflection or 0.0) + (self.coriolis or 0.0) + (self.cavity_mass or 0.0)
        return (self.mesh or 0.0) + self.layers + self.basis + self.theory + left_out


@dataclass(frozen=True)
class Mode:
    """A mode of the plate at one speed.

    The branch is the number of the mode at the lowest speed that this one continues.
    """

    frequency_hz: Annotated[float, quantity("Hz")]
    """natural frequency"""
    family: Annotated[str, quantity("")]
    """what the mode does"""
    error_parts: Annotated[ErrorParts | None, part(prefix="error_")] = None
    """of the relative error, each without sign; null where unknown, or where an effect is not left out"""
    damping_ratio: Annotated[float | None, quantity("1")] = None
    """of a complex mode"""
    branch: Annotated[int, KEPT] = 0

    @computed_field(  # type: ignore[prop-decorator]
        description="relative error of the frequency as a whole, the sum of its parts", json_schema_extra={"unit": "1"}
    )
    @property
    def error_estimate(self) -> float | None:
        """Relative error of the frequency, all parts together; None where unknown."""
        return None if self.error_parts is None else self.error_parts.whole


@dataclass(frozen=True)
class Reduced:
    """The structure as the damper feels it, at its place: 1 with the ball stuck, 2 without it.

    `pull`: what the load of 1 kg there adds to its stiffness, over Ω².
    """

    f1_hz: Annotated[float, quantity("Hz", headline=True)]
    """frequency with the ball stuck"""
    M1: Annotated[float, quantity("kg")]
    """mass with the ball stuck"""
    K1: Annotated[float, quantity("N/m")]
    """stiffness with the ball stuck"""
    f2_hz: Annotated[float, quantity("Hz")]
    """frequency without the ball"""
    M2: Annotated[float, quantity("kg", headline=True)]
    """mass without the ball"""
    K2: Annotated[float, quantity("N/m")]
    """stiffness without the ball"""
    floor_tilt: Annotated[float, quantity("1/m")]
    """slope of the cavity's floor over its displacement"""
    pull: Annotated[float, KEPT] = field(default=0.0, repr=False)


@dataclass(frozen=True)
class CavityMode:
    """A mode of the plate as the cavity feels it, its modal mass 1 kg; pairs are along the damper's axes.

    Attributes:
        drawn: force by a unit acceleration of the root along the axes, but for its sign [kg].
        pressed: force by a unit pressure all over the plate [m²].
        pushed: force by a unit force at the excitation's place, where that is not the damper's [1].
    """

    number: Annotated[int, quantity("1"), Field(ge=1)]
    """of the mode"""
    stiffness: Annotated[float, quantity("N/m")]
    """modal, under the ball's pull but without its inertia"""
    shape: Annotated[Pair, quantity("1")]
    """displacement of the cavity"""
    slope: Annotated[Pair, quantity("1/m")]
    """of its floor"""
    drawn: Annotated[Pair, KEPT] = (0.0, 0.0)
    pressed: Annotated[float, KEPT] = 0.0
    pushed: Annotated[float, KEPT] = 0.0

    def square(self, ball: float, axis: int) -> float:
        """Squared circular frequency with a ball at rest [kg] that follows along an axis alone [1/s²]."""
        return self.stiffness / (1 + ball * self.shape[axis] ** 2)


def leading_mode(modes: Sequence[CavityMode], axis: int) -> CavityMode | None:
    """The mode that yields most to a force at the cavity along an axis; None where none moves it that way."""
    leader = max(modes, key=lambda mode: mode.shape[axis] ** 2 / mode.stiffness, default=None)
    if leader is None or abs(leader.shape[axis]) <= STILL * max(math.hypot(*mode.shape) for mode in modes):
        return None
    return leader


STILL = 1e-6
"""Relative displacement of a cavity that counts as none: a mesh's rounding, by symmetry zero."""


@dataclass(frozen=True)
class ModeAtSeat:
    """What a mode does at the damper's place; pairs are along the axes of the cavity.

    Attributes:
        mass: effective mass [kg]; stiffness: that times omega² [N/m].
        floor_tilt: the floor's slope over the displacement [1/m]; all three None where the place does not move so.
    """

    number: int
    family: str
    frequency_hz: float
    mass: tuple[float | None, ...]
    stiffness: tuple[float | None, ...]
    floor_tilt: tuple[float | None, ...]

    def along(self, axis: int) -> tuple[float | None, ...]:
        """The three along an axis of the cavity."""
        return self.mass[axis], self.stiffness[axis], self.floor_tilt[axis]


@dataclass(frozen=True)
class SeatDescription:
    """How a cavity lies at a speed: place [m], unit vectors of load, floor and axes, and what the modes do there."""

    place: tuple[float, ...]
    how: str
    load: tuple[float, ...]
    normal: tuple[float, ...]
    axes: tuple[tuple[float, ...], ...]
    modes: tuple[ModeAtSeat, ...]


@dataclass(frozen=True)
class Theory:
    """The plate theory used, why, and an estimate of its own relative error in frequency against a solid.

    The estimate is the largest of the modes asked for, on a coarse mesh, None where nothing was to be chosen; modes
    have their own.
    """

    name: str
    why: str
    model_error: float | None = None


_SAME_MODE = 1.05
"""Ratio of frequencies up to which Coriolis forces may tell a mode from itself."""


SHAPES_AT_MOST = 20
"""Speeds whose mode shapes are kept for pictures and files."""


@dataclass(frozen=True, eq=False)
class SpeedPoint:
    """Everything found at one speed. `radius` is the damper's (or the tip's) distance from the axis.

    Attributes:
        cavity_modes: the plate's modes as the cavity feels them, where they are simulated.
        damper: what the scene's release leads to, with its effects.
        damping_curve: the damper's own figures, on a floor that tilts as the structure bends; verdict: on them.
        stagger: angle from the damper's axis 1 to the spin axis [rad]; None of a structure given by its frequency.
        lean: parts of the radius along the damper's axes [m], on a floor that does not face the load.
        sticks_out: how far a cavity does, out of a structure in space [m].
        root_stress: of a solid blade the mean stress over its root's section by the centrifugal pull [Pa].
        tip_motion: of a plate the largest displacement over that of the cavity, in the same mode [-].
        root_strain: the largest strain, at the root or elsewhere, over the displacement of the cavity [1/m]: of a plate
            by bending in its flap mode, of a structure in space in the mode that moves the cavity most; None where that
            is not known.
    """

    omega: Annotated[float, KEPT]
    rpm: Annotated[float, quantity("rpm")]
    """rotation speed"""
    radius: Annotated[float, KEPT]
    load_g: Annotated[float, quantity("g", headline=True)]
    """centrifugal acceleration at the damper"""
    modes: Annotated[tuple[Mode, ...], part(along="mode")]
    reduced: Annotated[Reduced | None, part()] = None
    """the structure at the damper: 1 with the ball stuck, 2 without it"""
    cavity_modes: Annotated[tuple[CavityMode, ...], part(prefix="cavity_", along="cavity_mode")] = ()
    """a mode of the structure at the cavity, of modal mass 1 kg; pairs are along the damper's axes"""
    damper: Annotated[Damping | None, part()] = None
    """the ring-down of the scene's release"""
    damping_curve: Annotated[OwnFigures | None, part("working")] = None
    """figures of the damper itself, independent of the release and of the structure's damping; the tilt of the cavity's
    floor is included. Amplitudes are the structure's displacements along axis 1 at the damper, m"""
    contact: Annotated[ContactFigures | None, part(prefix="contact_")] = None
    """of the ball at rest on its floor, where their materials are known by name"""
    hits: Annotated[HitFigures | None, part(prefix="hit_")] = None
    """on a wall, at the amplitude of the largest damping"""
    verdict: Annotated[Verdict | None, part(prefix="verdict_")] = None
    """on the damper at this speed, from its own figures"""
    static_displacement: Annotated[float | None, quantity("m")] = field(default=None, repr=False)
    """the largest by which the centrifugal load displaces a solid blade"""
    tip_rotation: Annotated[float | None, quantity("rad")] = field(default=None, repr=False)
    """of a solid blade by the load, about the direction from the spin axis to its tip: its untwist"""
    stagger: Annotated[float | None, KEPT] = None
    lean: Annotated[tuple[float, float], KEPT] = (0.0, 0.0)
    sticks_out: Annotated[float, KEPT] = field(default=0.0, repr=False)
    root_stress: Annotated[float | None, KEPT] = None
    root_strain: Annotated[float | None, KEPT] = None
    tip_motion: Annotated[float | None, KEPT] = field(default=None, repr=False)

    @classmethod
    def at(cls, omega: float, radius: float, gravity: float, modes: tuple[Mode, ...] = (), **more: Any) -> SpeedPoint:
        """That of a speed [rad/s] and the damper's radius [m], with its load over g [m/s²]."""
        return cls(omega, rounded_rpm(omega), radius, omega**2 * radius / gravity, modes, **more)

    def excited_by(self, order: int) -> float:
        """Frequency of an engine order at this speed [Hz]."""
        return order * self.rpm / 60

    @property
    def followed(self) -> int | None:
        """Which of the modes, from 0, the damper follows, whatever its family; None where it is above those asked for.

        That whose frequency is the one without the ball, but for Coriolis forces; without a damper the first.
        """
        if self.reduced is None or not self.modes:
            return 0 if self.modes else None
        hertz = self.reduced.f2_hz
        if hertz > _SAME_MODE * self.modes[-1].frequency_hz:
            return None
        return min(range(len(self.modes)), key=lambda k: abs(self.modes[k].frequency_hz - hertz))

    @property
    def pressing(self) -> float:
        """Part of the radius along the normal of the cavity's floor [m]: times Ω² what presses the ball onto it."""
        return math.sqrt(self.radius**2 - self.lean[0] ** 2 - self.lean[1] ** 2) if any(self.lean) else self.radius

    @property
    def across(self) -> float:
        """Motion of the place along axis 2, over that along axis 1, in the mode that leads there."""
        leading = leading_mode(self.cavity_modes, 0)
        return 0.0 if leading is None else leading.shape[1] / leading.shape[0]

    @property
    def outwards(self) -> float:
        """Motion of the place in the plane of rotation, over that along axis 1."""
        stagger = self.stagger or 0.0
        return math.sin(stagger) - math.cos(stagger) * self.across

    @property
    def tilt_share(self) -> float:
        """Share of the ball's drive along axis 1 that the tilt of the floor takes, less what it gains in the plane.

        Ω²(R slope - sin(stagger) outwards) / ω1²: a place that moves in the plane of rotation takes the ball farther
        from the axis.
        """
        if self.reduced is None:
            return 0.0
        pull = self.pressing * self.reduced.floor_tilt - math.sin(self.stagger or 0.0) * self.outwards
        return self.omega**2 * pull / (2 * math.pi * self.reduced.f1_hz) ** 2

    @property
    def drive_left(self) -> float:
        """What tilt and load leave of a ball's drive along the floor, both axes together, over the one along axis 1."""
        left, mode = 1 - self.tilt_share, leading_mode(self.cavity_modes, 0)
        if self.reduced is None or mode is None or self.across == 0:
            return abs(left)
        pull = self.pressing * mode.slope[1] / mode.shape[0] + math.cos(self.stagger or 0.0) * self.outwards
        return math.hypot(left, self.across - self.omega**2 * pull / (2 * math.pi * self.reduced.f1_hz) ** 2)

    @property
    def level(self) -> Figures | None:
        """The damper's figures on a level floor, where the scene keeps it so."""
        return None if self.damping_curve is None else self.damping_curve.level


@dataclass(frozen=True, eq=False)
class Surface:
    """The plate's mid-surface with its mode shapes.

    Attributes:
        points: (n, 3) [m].
        cells: kind of cell as meshio calls it, and connectivity (m, 3 or 4).
        outline: the points at the ends of each edge of one cell only, (edges, 2); root: of those that are held.
        shapes: (speeds, modes, n, 3), mass-normalised.
        at: which of the run's speeds the first axis of `shapes` holds.
        thickness: at the points, (n,) [m], where it varies.
        behind: what of complex modes lags a quarter of a period behind `shapes`, like these; None where nothing does.
        finer: the same with points between the mesh's, where these are too few for a smooth picture.
        lines: the edges of the mesh's cells or of their faces, (k, 2), where `cells` are parts of these.
        frame: of a surface in space the axes by which it is drawn, (3, 3): outwards, across, along the damper's axis 1;
            None of a plate, which is drawn by its own.
        mark: the damper's place in space, (3,) [m].
        axis: direction of the spin axis, (3,); origin: a point on it, (3,) [m]; None of a mesh alone, and of a plate.
    """

    points: Floats = field(repr=False)
    cells: tuple[str, Ints] = field(repr=False)
    outline: Ints = field(repr=False)
    root: Ints = field(repr=False)
    shapes: Floats = field(repr=False)
    at: tuple[int, ...]
    thickness: Floats | None = field(default=None, repr=False)
    behind: Floats | None = field(default=None, repr=False)
    finer: Surface | None = field(default=None, repr=False)
    lines: Ints | None = field(default=None, repr=False)
    frame: Floats | None = field(default=None, repr=False)
    mark: Floats | None = field(default=None, repr=False)
    axis: Floats | None = field(default=None, repr=False)
    origin: Floats | None = field(default=None, repr=False)

    @property
    def triangles(self) -> Ints:
        """The cells, (k, 3), those of four corners cut in two from their first."""
        cells = self.cells[1]
        return np.vstack([cells[:, [0, k, k + 1]] for k in range(1, cells.shape[1] - 1)])

    def row(self, number: int) -> int:
        """Which of the speeds with shapes is nearest to number `number` of the run."""
        return int(np.argmin(np.abs(np.asarray(self.at) - number)))

    def drawn(self, vectors: Floats) -> Floats:
        """Vectors (..., 3) in the axes by which the surface is drawn."""
        return vectors if self.frame is None else np.asarray(vectors @ self.frame.T)


@dataclass(frozen=True)
class Diagram:
    """What the modes over speed have beyond the modes themselves.

    Attributes:
        mesh: in words.
        bound: largest relative error of a frequency against the full model at its speed.
        bases: vectors of each reduced basis; none where every speed was solved in full.
        veerings: between which two speeds [rpm] modes of which families cannot be told apart.
        lost: speeds [rpm] asked for at which the plate diverges; critical: where it begins to, if known.
        root_length: of the edge that is clamped, or held by springs [m].
    """

    mesh: str
    bound: float = 0.0
    bases: tuple[int, ...] = ()
    veerings: tuple[tuple[float, float, tuple[str, ...]], ...] = ()
    lost: tuple[float, ...] = ()
    critical: float | None = None
    root_length: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Results:
    """A finished run, before anything is written. mesh_sha256: of the mesh file, if the scene names one.

    `workflows.save` and `workflows.save_report` write it out.
    """

    scene: Scene
    effects: dict[str, Effect]
    speeds: tuple[SpeedPoint, ...]
    reductions: Annotated[tuple[VibrationReduction, ...], part()] = ()
    """under the orders of [excitation]"""
    surface: Annotated[Surface | None, KEPT] = None
    theory: Annotated[Theory | None, KEPT] = None
    diagram: Annotated[Diagram | None, KEPT] = None
    mesh_sha256: str | None = None
    notes: tuple[str, ...] = ()
    timings: dict[str, float] = field(default_factory=dict)


def middle_speed(points: tuple[SpeedPoint, ...]) -> int:
    """Which speed the pictures show: the middle one."""
    return sorted(range(len(points)), key=lambda i: points[i].rpm)[(len(points) - 1) // 2]


def require_results(results: object, who: str) -> None:
    """Raise TypeError unless results are what `who` was given."""
    if not isinstance(results, Results):
        raise TypeError(f"{who} takes what run returns, got {type(results).__name__}")


SMOOTH, _PARTS = 900, 4
"""Points up to which pictures look between those of a coarse mesh, and parts of a side of its cells at most."""

_NOTHING = 1e-7
"""Part of a shape's largest displacement below which there is rounding alone."""

_BITS = 15
"""Of a shape's largest displacement in pictures, which have 16 with its sign."""


@dataclass(frozen=True, eq=False)
class Discrete:
    """Matrices on the mesh chosen, and how it was chosen.

    `layers`: the error that the layers of a solid leave. `left_out`: what effects left out would move, by name.
    `cavity`: what is cut into the plate; None: nothing, or the scene leaves it out.
    """

    choice: fem.Choice
    theory: Theory
    mesh: str
    layers: float
    left_out: dict[str, LeftOut] = field(default_factory=dict)
    cavity: Cavity | None = None


class Cavity(NamedTuple):
    """All cavities of a damper in a plate, at a place: their volume [m³] and depth [m].

    `weakens`: stiffness that they take over the volume, at most. `single`: whether there is one, whose extent is known.
    `counted`: whether their mass is taken out.
    """

    at: tuple[float, float]
    volume: float
    depth: float
    weakens: float
    single: bool
    counted: bool


def points(
    source: SceneFile, discrete: Discrete, diagram: fem.Campbell, numbers: Sequence[int]
) -> tuple[SpeedPoint, ...]:
    """Modes at the speeds of these numbers in the sweep."""
    from fem.accuracy.neglected_effects import cut
    from fem.accuracy.theory_selection import over_speeds

    rotor, operators = source.scene.rotor, discrete.choice.operators
    at = plate_mesh.place(source, operators.plate.mesh)
    radius, stagger = operators.radius(*at), rotor.stagger
    if source.scene.damper is not None and at[1]:  # with precone there is none
        first, across = operators.at_place(at).axes[:2] @ operators.rotor.axis
        stagger = math.atan2(across, first)
    rows = list(numbers)
    omega, bounds = diagram.omega[rows], diagram.bounds[rows, : rotor.modes]
    count = bounds.shape[1]
    shares = {name: effect.at(omega, count) for name, effect in discrete.left_out.items()}
    if discrete.cavity is not None:
        cavity = discrete.cavity
        shifts = cut(operators, diagram, numbers, cavity.at, cavity.volume, cavity.depth)
        left = (0.5 if cavity.single else 1.0) * shifts.extent if cavity.counted else shifts.mass
        shares["cavity_mass"] = np.asarray(left + cavity.weakens * shifts.stiffness)[:, :count]
    shares["mesh"], shares["layers"] = discrete.choice.errors_at(omega), np.full(bounds.shape, discrete.layers)
    shares["basis"], shares["theory"] = bounds, over_speeds(operators, diagram)[rows, :count]
    nothing = np.full(bounds.shape, np.nan)
    errors = map(ErrorParts, *(known(shares.get(part.name, nothing)[:, :count]) for part in fields(ErrorParts)))
    turning = operators.gyroscopic is not None
    damping = np.where(turning & (omega[:, None] > 0.0), diagram.damping_ratios[rows, :count], np.nan)
    families = [family for names in map(diagram.families.__getitem__, rows) for family in names[:count]]
    branches: list[int] = diagram.branches[rows, :count].ravel().tolist()
    frequencies = diagram.frequencies_hz[rows, :count].ravel().tolist()
    modes = tuple(map(Mode, frequencies, families, errors, known(damping), branches))
    return tuple(
        SpeedPoint.at(speed, radius, rotor.gravity, modes[n * count : (n + 1) * count], stagger=stagger)
        for n, speed in enumerate(omega.tolist())
    )


def known(values: Floats) -> list[Any]:
    """Numbers in one list, None where they are not known."""
    return [each if math.isfinite(each) else None for each in values.ravel().tolist()]


def surface(operators: fem.Operators, diagram: fem.Campbell, numbers: Sequence[int], count: int) -> Surface:
    """The mid-surface with the shapes of some of the speeds of these numbers."""
    from fem.output import between

    shown = speeds_with_shapes(len(numbers))
    unknowns = np.hstack([_in_phase(diagram.shapes(numbers[k])[:, :count]) for k in shown])
    mesh = operators.model.mesh
    points = mesh.t.shape[1] if mesh.t.shape[0] == 4 else mesh.t.shape[1] / 2
    parts = max(1, min(int(np.sqrt(SMOOTH / points)), _PARTS))
    refined = between(operators, unknowns, parts)
    shapes = refined.displacement[:, : operators.plate.mesh.p.shape[1]].copy()
    shapes[np.abs(shapes) < _NOTHING * np.abs(shapes).max(axis=(1, 2), keepdims=True)] = 0.0
    coarse = _shaped(operators, operators.plate.mesh, shapes, shown)
    return coarse if parts == 1 else replace(coarse, finer=_finer(operators, refined, shown))


def _shaped(operators: fem.Operators, mesh: Any, shapes: Any, shown: tuple[int, ...]) -> Surface:
    """A mesh with displacements (shapes, n, 3), as many at each of the speeds kept."""
    by_speed = shapes.reshape(len(shown), -1, *shapes.shape[1:])
    behind = -by_speed.imag if np.iscomplexobj(by_speed) else None
    thickness, axis = _thickness(operators.plate, mesh), operators.rotor.axis
    return replace(bare_surface(mesh), shapes=by_speed.real, at=shown, thickness=thickness, behind=behind, axis=axis)


def _finer(operators: fem.Operators, refined: Finer, shown: tuple[int, ...]) -> Surface:
    """The surface with the sides of its cells in parts, for pictures: no more digits than these show."""
    largest = np.abs(refined.displacement).max(axis=(1, 2), keepdims=True)
    step = np.ldexp(1.0, np.frexp(largest)[1] - _BITS)
    shapes = np.round(refined.displacement / step) * step + 0.0  # which has no -0
    small = shapes.astype(np.complex64 if np.iscomplexobj(shapes) else np.float32)
    return replace(_shaped(operators, refined.mesh, small, shown), lines=refined.lines)


def skin(points: Floats, cells: Sequence[tuple[str, Ints]]) -> tuple[Surface, Ints]:
    """The outer surface of cells in space, without shapes and root, and which of the points (n, 3) lie on it."""
    triangles = modal_model.faces(cells)
    used = np.unique(triangles)
    points, triangles = points[used], np.searchsorted(used, triangles)
    outline, lines, shapes = np.zeros((0, 2), np.int64), None, np.zeros((0, 0, len(points), 3))
    if used.size:
        outline, lines = modal_model.edges(points, triangles), np.searchsorted(used, edges_of(cells))
    return Surface(points, ("triangle", triangles), outline, outline[:0], shapes, (), lines=lines), used


def bare_surface(mesh: Any) -> Surface:
    """A mesh's mid-surface, without shapes."""
    points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
    kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
    outline, root = (np.asarray(mesh.facets[:, facets].T) for facets in (mesh.boundary_facets(), root_facets(mesh)))
    return Surface(points, (kind, np.asarray(mesh.t.T)), outline, root, np.zeros((0, 0, len(points), 3)), ())


def _thickness(plate: fem.Plate, mesh: Any) -> Floats | None:
    """The thickness [m] at a mesh's points, (n,), where it varies."""
    if isinstance(plate.thickness, float | int):
        return None
    thickness = np.zeros(mesh.p.shape[1])
    thickness[mesh.t.T] = plate.thickness.at(mesh.p[:, mesh.t.T])
    return thickness


def diagram_of(discrete: Discrete, diagram: fem.Campbell, count: int, requested: tuple[float, ...]) -> Diagram:
    """What else the sweep found: its bound, veerings among the modes shown, speeds lost to divergence."""
    operators, families = discrete.choice.operators, diagram.families
    known = set(diagram.omega.tolist())
    lost = tuple(sorted(rounded_rpm(omega) for omega in requested if omega not in known))
    linear = not operators.effects.large_deflection
    veerings = []
    for veering in diagram.veerings:
        low, high = (rounded_rpm(float(omega)) for omega in diagram.omega[veering.step : veering.step + 2])
        if names := tuple(families[veering.step][k] for k in veering.modes if k < count):
            veerings.append((low, high, names))
    bound, root_length = float(diagram.bounds[:, :count].max()), clamped_length(operators.plate.mesh)
    critical = rounded_rpm(fem.critical_speed(operators)) if lost and linear else None
    return Diagram(discrete.mesh, bound, diagram.sizes, tuple(veerings), lost, critical, root_length)


def _in_phase(shapes: Floats) -> Floats:
    """Complex shapes turned to the phase at which their largest unknown peaks; real ones as they are."""
    if not np.iscomplexobj(shapes):
        return shapes
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    return np.asarray(shapes * (np.abs(largest) / largest))


def speeds_with_shapes(count: int) -> tuple[int, ...]:
    """Which speeds keep their shapes: all, or evenly chosen ones with both ends."""
    if count <= SHAPES_AT_MOST:
        return tuple(range(count))
    return tuple(np.unique(np.linspace(0, count - 1, SHAPES_AT_MOST).round().astype(int)).tolist())
