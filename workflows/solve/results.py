"""What a run hands on: frozen records, SI inside, from the stages to the writers.

Each number has its unit and meaning in its annotation, which JSON, netCDF, schema and sweeps follow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from functools import cache
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
import numpy.typing as npt

from workflows.effects.definition import Effect, LeftOut
from workflows.effects.selection import NAMES
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    import fem


T = TypeVar("T")


class Rows(NamedTuple):
    """A list whose rows have arrays as their columns: its name, the dimension along it, and its meaning."""

    name: str
    along: str
    meaning: str = ""


@dataclass(frozen=True)
class Quantity:
    """A number, a pair of numbers, or a text.

    Attributes:
        unit: of a number, "1" where it has none; empty for a text.
        meaning: in words; empty where the name says it.
        name: under which it is published, if not that of the field.
        short: what the key of a picture calls it; empty where none does.
        alone: its name where it stands beside those of other records, if not that of the field.
        ends: what tells the two of a pair apart.
        rows: the list that an array is a column of.
        least: of a whole number.
        unknown: whether a number may be none that is finite, which is published as null.
        absent: whether it is left out where there is none, and not null.
        inner: whether it is left out of JSON.
        within: the part of the outer record in which it is published.
        headline: whether a sweep has a column of it.
    """

    unit: str
    meaning: str = ""
    name: str = ""
    short: str = ""
    alone: str = ""
    ends: tuple[str, str] = ("x", "y")
    rows: Rows | None = None
    least: int = 0
    unknown: bool = False
    absent: bool = False
    inner: bool = False
    within: str = ""
    headline: bool = False

    def said(self, name: str, end: int | None = None) -> str:
        """The meaning, or else a name in words; `end`: of which of a pair."""
        meaning = self.meaning or name.replace("_", " ")
        return meaning if end is None else f"{meaning}: {self.ends[end]}"


@dataclass(frozen=True)
class Part:
    """A record within a record, or a tuple of them; left out where there is none.

    Attributes:
        meaning: in words.
        name: under which it is published, if not that of the field.
        prefix: of its quantities' names where they stand beside those of other records.
        along: the dimension of a tuple.
        always: whether it is published where there is none, as null or as an empty list.
        inline: whether its quantities stand in the outer record, with the prefix.
        within: as of a quantity.
        headline: whether a sweep has columns of it.
    """

    meaning: str = ""
    name: str = ""
    prefix: str = ""
    along: str = ""
    always: bool = False
    inline: bool = False
    within: str = ""
    headline: bool = True


@dataclass(frozen=True)
class Entry:
    """A quantity or a part of a record.

    Attributes:
        attribute: of the record; name: under which it is published.
        what: quantity or part.
        kind: `float`, `int`, `str`, `tuple` for a pair, `list` for an array, or the class of a record.
        optional: whether None is among its values; many: whether it is a tuple of records.
    """

    attribute: str
    name: str
    what: Quantity | Part
    kind: type
    optional: bool
    many: bool


@cache
def entries(record: type) -> tuple[Entry, ...]:
    """The quantities and parts of a record, its fields first, in their order."""
    hints = get_type_hints(record, include_extras=True)
    found = [_entry(field.name, hints[field.name]) for field in fields(record)]
    for kind in reversed(record.__mro__):
        properties = {name: each.fget for name, each in vars(kind).items() if isinstance(each, property)}
        found += [
            _entry(name, get_type_hints(get, include_extras=True).get("return")) for name, get in properties.items()
        ]
    return tuple(entry for entry in found if entry is not None)


def _entry(attribute: str, hint: Any) -> Entry | None:
    if get_origin(hint) is not Annotated:
        return None
    inner, *said = get_args(hint)
    what = next((each for each in said if isinstance(each, Quantity | Part)), None)
    if what is None:
        return None
    kinds = get_args(inner) if get_origin(inner) is UnionType else (inner,)
    (kind,) = (each for each in kinds if each is not NoneType)
    many = isinstance(what, Part) and get_origin(kind) is tuple
    if many:
        kind = get_args(kind)[0]
    elif get_origin(kind) is tuple:
        kind = tuple
    elif isinstance(what, Quantity) and what.rows is not None:
        kind = list
    return Entry(attribute, what.name or attribute, what, kind, NoneType in kinds, many)


def taken_over(record: type[T], found: object, **more: object) -> T:
    """A record whose fields are those of the same names of another object, and more."""
    given: Mapping[str, Any] = {f.name: getattr(found, f.name) for f in fields(record) if f.name not in more}  # type: ignore[arg-type]
    return record(**given, **more)


Floats = npt.NDArray[np.float64]
Pair = tuple[float, float]

_ENDS = ("low", "high")
_CURVE = Rows("curve", "point", "damping ratio over amplitude")
_CYCLES = Rows("cycles", "cycle", "one for each vibration cycle")


@dataclass(frozen=True, eq=False)
class Figures:
    """What a damper does to a steady vibration; amplitudes are the structure's displacements along x at the damper."""

    peak: Annotated[
        float,
        Quantity("1", "largest damping ratio that the ball's losses amount to", "damping_ratio_peak", headline=True),
    ]
    peak_amplitude: Annotated[
        float, Quantity("m", "amplitude at the cavity where that is", "at_amplitude", unknown=True, headline=True)
    ]
    range: Annotated[
        Pair,
        Quantity(
            "m",
            "from where the ball begins to move (or half of the peak is reached) to where half is left",
            ends=_ENDS,
            headline=True,
        ),
    ]
    half: Annotated[
        Pair,
        Quantity("m", "between which the damping is at least half its peak", "half_range", ends=_ENDS, headline=True),
    ]
    cutoff: Annotated[float, Quantity("m", "amplitude up to which the ball stays at rest", unknown=True, headline=True)]
    amplitude: Annotated[Floats, Quantity("m", "amplitude", alone="working_amplitude", rows=_CURVE)]
    damping_ratio: Annotated[Floats, Quantity("1", "damping ratio there", alone="working_damping_ratio", rows=_CURVE)]


@dataclass(frozen=True, eq=False)
class OwnFigures(Figures):
    """The same, with the error of its measurement."""

    error: Annotated[
        float,
        Quantity(
            "1",
            "of the peak and of `half`, relative: spread of the measurement, and what its pace moved",
            alone="working_error",
            headline=True,
        ),
    ]


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
    SLIP = "slip"
    PRINTED = "printed_equations"
    DENSITY = "ball_density"
    ROOT_STRESS = "root_stress"


@dataclass(frozen=True)
class Verdict:
    """What a damper is good for at a speed."""

    grade: Annotated[
        str,
        Quantity(
            "",
            "yes: as much as the air gives blades; modest: a tenth of that; negligible: less; locked: the ball never"
            " moves at what the plate endures; inadmissible: no such ball, plate or law; unknown: outside the model",
        ),
    ]
    damping_ratio: Annotated[
        float | None, Quantity("1", "largest damping ratio within what the plate endures; null: no verdict")
    ] = None
    amplitude: Annotated[float | None, Quantity("m", "amplitude at the cavity where that is")] = None
    useful: Annotated[
        Pair,
        Quantity(
            "m",
            "amplitudes between which the damping is at least half its peak, as far as the plate endures them",
            "useful_range",
            ends=_ENDS,
            unknown=True,
        ),
    ] = (math.nan, math.nan)
    reason: Annotated[
        str,
        Quantity(
            "",
            "what limits the damper or the verdict, empty where nothing does: endurance (more beyond what the plate"
            " endures), out_of_reach (the ball moves only beyond that), filled_cavity, floor_tilt (it cancels the"
            " drive), no_loss, not_found, ball_weight, slip, printed_equations, ball_density, root_stress",
        ),
    ] = Reason.NONE

    @property
    def rank(self) -> int:
        """The grade as a number: 3 yes, 2 modest, 1 negligible, 0 nothing, -1 without a verdict."""
        if self.damping_ratio is None:
            return -1
        return {Grade.YES: 3, Grade.MODEST: 2}.get(Grade(self.grade), 1) if self.damping_ratio else 0


@dataclass(frozen=True)
class CutOff:
    """That of a ring-down; None where the ball never moves."""

    g: Annotated[
        float | None,
        Quantity("g", "cut-off of a ring-down with the tilt that the scene leaves out; null: the ball never moves"),
    ]
    ratio: Annotated[float | None, Quantity("1", "that over load_g")]


@dataclass(frozen=True)
class Pendulum:
    """A ball in a hollow floor; 0 where it finds no way back. The order is the same at all speeds."""

    frequency_hz: Annotated[Pair, Quantity("Hz", "frequency along each of the damper's axes")]
    order: Annotated[Pair, Quantity("1", "that over the rotation's frequency")]


@dataclass(frozen=True)
class Energy:
    """Where the energy went [J]; `residual` is what the books do not explain."""

    initial: Annotated[float, Quantity("J", "at the release")]
    final: Annotated[float, Quantity("J", "left at the end", short="left")]
    structure: Annotated[float, Quantity("J", "lost to the structure's own damping", short="structure")]
    rolling: Annotated[float, Quantity("J", "lost to rolling resistance", short="rolling")]
    impact: Annotated[float, Quantity("J", "lost in hits of the walls", short="wall hits")]
    slip: Annotated[float, Quantity("J", "lost to slip on the floor", short="slip")]
    residual: Annotated[float, Quantity("J", "not explained by the books")]

    @property
    def ball_share(self) -> float:
        """Share of the energy lost that the ball took, by rolling, impact and slip."""
        ball = self.rolling + self.impact + self.slip
        lost = ball + self.structure
        return ball / lost if lost > 0 else 0.0


@dataclass(frozen=True)
class ModalEnergy:
    """Energy that is left at the end in a mode of the plate."""

    mode: Annotated[int, Quantity("1", "its number", least=1)]
    energy: Annotated[float, Quantity("J")]


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
    regime: npt.NDArray[np.int64] = field(repr=False)
    at: npt.NDArray[np.int64] = field(repr=False)
    kind: tuple[str, ...] = field(repr=False)
    axis: npt.NDArray[np.int64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Damping:
    """One ring-down. Arrays hold a value per vibration cycle.

    What has no annotation is not published, but serves pictures and findings: `stopped` is when the ball came to rest
    for good [s], None where it did not (yet); `ball_mass` that of all balls [kg]; `release` the displacement at the
    release along the damper's axes [m]. `modal_energies` [J] are those left at the end in the plate's modes, by number,
    where they are simulated. `history` and `path` are kept at the speed that the pictures show; there is no path of a
    ball that never moves.
    """

    outcome: str
    impacts: Annotated[int, Quantity("1", "hits of the walls", headline=True)]
    events: Annotated[int, Quantity("1", "events of any kind", headline=True)]
    duration: Annotated[float, Quantity("s", "time simulated", inner=True)]
    stopped: float | None
    ball_mass: float
    release: Pair
    intrinsic_sdc: Annotated[float, Quantity("1", "what the structure's own damping loses in a cycle")]
    peak_sdc: Annotated[
        float | None, Quantity("1", "everything lost in a cycle over its energy, at most", headline=True)
    ]
    peak_sdc_at_g: Annotated[float | None, Quantity("g", "amplitude where that is")]
    cutoff_g: Annotated[float | None, Quantity("g", "amplitude of the last cycle in which the ball moved")]
    cutoff_ratio: Annotated[float | None, Quantity("1", "cutoff_g over load_g", headline=True)]
    largest_rolling_demand: Annotated[
        float | None, Quantity("1", "friction that pure rolling needs, over the normal load")
    ]
    amplitude_g: Annotated[Floats, Quantity("g", "V ω1 / g", rows=_CYCLES)] = field(repr=False)
    sdc: Annotated[
        Floats,
        Quantity(
            "1",
            "null: the ball gave the structure more energy than it had, which is no cycle",
            rows=_CYCLES,
            unknown=True,
        ),
    ] = field(repr=False)
    peak_velocity: Annotated[Floats, Quantity("m/s", "of the structure", rows=_CYCLES)] = field(repr=False)
    energy: Annotated[Energy, Part("joules; residual is what the books do not explain", prefix="energy_")]
    modal_energies: dict[int, float] = field(default_factory=dict)
    history: History | None = None
    path: BallPath | None = None

    @property
    def modal(
        self,
    ) -> Annotated[
        tuple[ModalEnergy, ...],
        Part("left at the end in the plate's modes, joules", "modal_energies", prefix="modal_", along="modal"),
    ]:
        """The modal energies as records."""
        return tuple(ModalEnergy(number, energy) for number, energy in self.modal_energies.items())


@dataclass(frozen=True)
class ErrorParts:
    """What the relative error of a frequency is estimated to consist of, each without sign.

    None where a part is not known, or an effect is not left out.
    """

    mesh: Annotated[float | None, Quantity("1", "left by the mesh")]
    layers: Annotated[float, Quantity("1", "left by the layers of a solid")]
    basis: Annotated[float, Quantity("1", "added by the reduced basis that answers many speeds, at most", unknown=True)]
    theory: Annotated[float, Quantity("1", "of the plate theory, against a solid")]
    large_deflection: Annotated[float | None, Quantity("1", "what large deflection would move, left out")]
    coriolis: Annotated[float | None, Quantity("1", "what Coriolis forces would move, left out")]

    @property
    def whole(self) -> float | None:
        """The sum; None where the mesh's part is not known."""
        if self.mesh is None:
            return None
        left_out = (self.large_deflection or 0.0) + (self.coriolis or 0.0)
        return self.mesh + self.layers + self.basis + self.theory + left_out


@dataclass(frozen=True)
class Mode:
    """A mode of the plate at one speed.

    The branch is the number of the mode at the lowest speed that this one continues.
    """

    frequency_hz: Annotated[float, Quantity("Hz", "natural frequency")]
    family: Annotated[str, Quantity("", "what the mode does")]
    error_parts: Annotated[
        ErrorParts | None,
        Part(
            "of the relative error, each without sign; null where unknown, or where an effect is not left out",
            prefix="error_",
        ),
    ] = None
    damping_ratio: Annotated[float | None, Quantity("1", "of a complex mode", absent=True)] = None
    branch: int = 0

    @property
    def error_estimate(
        self,
    ) -> Annotated[float | None, Quantity("1", "relative error of the frequency as a whole, the sum of its parts")]:
        """Relative error of the frequency, all parts together; None where unknown."""
        return None if self.error_parts is None else self.error_parts.whole


@dataclass(frozen=True)
class Reduced:
    """The structure as the damper feels it, at its place: 1 with the ball stuck, 2 without it."""

    f1_hz: Annotated[float, Quantity("Hz", "frequency with the ball stuck", headline=True)]
    M1: Annotated[float, Quantity("kg", "mass with the ball stuck")]
    K1: Annotated[float, Quantity("N/m", "stiffness with the ball stuck")]
    f2_hz: Annotated[float, Quantity("Hz", "frequency without the ball")]
    M2: Annotated[float, Quantity("kg", "mass without the ball", headline=True)]
    K2: Annotated[float, Quantity("N/m", "stiffness without the ball")]
    floor_tilt: Annotated[float, Quantity("1/m", "slope of the cavity's floor over its displacement")] = 0.0


@dataclass(frozen=True)
class CavityMode:
    """A mode of the plate as the cavity feels it, its modal mass 1 kg; pairs are along the damper's axes.

    Attributes:
        drawn: force by a unit acceleration of the root along the axes, but for its sign [kg].
        pressed: force by a unit pressure all over the plate [m²].
    """

    number: Annotated[int, Quantity("1", "of the mode", least=1)]
    stiffness: Annotated[float, Quantity("N/m", "modal, under the ball's pull but without its inertia")]
    shape: Annotated[Pair, Quantity("1", "displacement of the cavity")]
    slope: Annotated[Pair, Quantity("1/m", "of its floor")]
    drawn: Pair = (0.0, 0.0)
    pressed: float = 0.0


@dataclass(frozen=True)
class Theory:
    """The plate theory used, why, and an estimate of its own relative error in frequency against a solid.

    The estimate is the largest of the modes asked for, on a coarse mesh, None where nothing was to be chosen; modes
    have their own.
    """

    name: str
    why: str
    model_error: float | None = None


__all__ = [
    "SHAPES_AT_MOST",
    "BallPath",
    "CavityMode",
    "CutOff",
    "Damping",
    "Diagram",
    "Energy",
    "ErrorParts",
    "Figures",
    "Floats",
    "Grade",
    "History",
    "Mode",
    "OwnFigures",
    "Pendulum",
    "Reason",
    "Reduced",
    "Results",
    "SpeedPoint",
    "Surface",
    "Verdict",
    "expect",
    "rpm",
    "shown",
]

_OWN = "working"

SHAPES_AT_MOST = 20
"""Speeds whose mode shapes are kept for pictures and files."""


@dataclass(frozen=True, eq=False)
class SpeedPoint:
    """Everything found at one speed. `radius` is the damper's (or the tip's) distance from the axis.

    Attributes:
        cavity_modes: the plate's modes as the cavity feels them, where they are simulated.
        damping: what the scene's release leads to, with its effects.
        working: the damper's own figures, on a floor that tilts as the structure bends; verdict: on them.
        level: the same on a level floor, where the scene keeps it level; None where the two do not differ.
        tilted: cut-off with the tilt that the scene leaves out.
        pendulum: of a ball in a hollow floor.
    """

    omega: float
    rpm: Annotated[float, Quantity("rpm", "rotation speed")]
    radius: float
    load_g: Annotated[float, Quantity("g", "centrifugal acceleration at the damper", headline=True)]
    modes: Annotated[tuple[Mode, ...], Part(along="mode", always=True)] = ()
    reduced: Annotated[Reduced | None, Part("the structure at the damper: 1 with the ball stuck, 2 without it")] = None
    cavity_modes: Annotated[
        tuple[CavityMode, ...],
        Part(
            "a mode of the plate as the cavity feels it, its modal mass 1 kg; pairs are along the damper's axes",
            prefix="cavity_",
            along="cavity_mode",
        ),
    ] = ()
    damping: Annotated[Damping | None, Part("the ring-down of the scene's release", "damper")] = None
    working: Annotated[
        OwnFigures | None,
        Part(
            "the damper's own figures, which neither release nor damping of the structure has a part in; the tilt of"
            " the cavity's floor is counted in. Amplitudes are the structure's displacements along x at the damper, m"
        ),
    ] = None
    verdict: Annotated[
        Verdict | None,
        Part("on the damper at this speed, from its own figures", prefix="verdict_", headline=False),
    ] = None
    level: Annotated[
        Figures | None,
        Part(
            "the same figures on a floor that stays level, where the scene keeps it so; else null",
            "level_floor",
            prefix="level_",
            always=True,
            within=_OWN,
            headline=False,
        ),
    ] = None
    tilted: Annotated[CutOff | None, Part(prefix="tilted_cutoff_", inline=True, within=_OWN)] = None
    pendulum: Annotated[
        Pendulum | None,
        Part(
            "the ball in a hollow floor along the damper's axes: frequency, and that over the rotation's",
            prefix="pendulum_",
            within=_OWN,
        ),
    ] = None

    @property
    def tilt_share(
        self,
    ) -> Annotated[
        float,
        Quantity(
            "1",
            "share of the ball's drive that the tilt of the floor takes: at 1 nothing drives it",
            "floor_tilt_share",
            within=_OWN,
            headline=True,
        ),
    ]:
        """Share of the ball's drive that the tilt of the cavity's floor takes, Ω²R slope/ω1² [-]."""
        if self.reduced is None:
            return 0.0
        return self.omega**2 * self.radius * self.reduced.floor_tilt / (2 * math.pi * self.reduced.f1_hz) ** 2


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
        finer: the same with points between the mesh's, where these are too few for a smooth picture; its `lines` are
            the edges of the mesh's cells, (k, 2).
    """

    points: Floats = field(repr=False)
    cells: tuple[str, npt.NDArray[np.int64]] = field(repr=False)
    outline: npt.NDArray[np.int64] = field(repr=False)
    root: npt.NDArray[np.int64] = field(repr=False)
    shapes: Floats = field(repr=False)
    at: tuple[int, ...]
    thickness: Floats | None = field(default=None, repr=False)
    behind: Floats | None = field(default=None, repr=False)
    finer: Surface | None = field(default=None, repr=False)
    lines: npt.NDArray[np.int64] | None = field(default=None, repr=False)


@dataclass(frozen=True)
class Diagram:
    """What the modes over speed have beyond the modes themselves.

    Attributes:
        mesh: in words.
        bound: largest relative error of a frequency against the full model at its speed.
        bases: vectors of each reduced basis; none where every speed was solved in full.
        veerings: between which two speeds [rpm] modes of which families cannot be told apart.
        lost: speeds [rpm] asked for at which the plate diverges; critical: where it begins to, if known.
    """

    mesh: str
    bound: float
    bases: tuple[int, ...]
    veerings: tuple[tuple[float, float, tuple[str, ...]], ...]
    lost: tuple[float, ...]
    critical: float | None


@dataclass(frozen=True, eq=False, repr=False)
class Results:
    """A finished run, before anything is written. mesh_sha256: of the mesh file, if the scene names one.

    `workflows.save` and `workflows.save_report` write it out.
    """

    scene: Scene
    effects: dict[str, Effect]
    speeds: tuple[SpeedPoint, ...]
    surface: Surface | None = None
    theory: Theory | None = None
    diagram: Diagram | None = None
    mesh_sha256: str | None = None
    notes: tuple[str, ...] = ()
    timings: dict[str, float] = field(default_factory=dict)


def rpm(omega: float) -> float:
    """Revolutions per minute, without the last digits that the conversion leaves behind."""
    return float(f"{omega * 30 / math.pi:.13g}")


def shown(points: tuple[SpeedPoint, ...]) -> int:
    """Which speed the pictures show: the middle one."""
    return sorted(range(len(points)), key=lambda i: points[i].rpm)[(len(points) - 1) // 2]


def expect(results: object, who: str) -> None:
    """Raise TypeError unless results are what `who` was given."""
    if not isinstance(results, Results):
        raise TypeError(f"{who} takes what run returns, got {type(results).__name__}")


_EFFECTS = tuple(name for name in NAMES if name in ErrorParts.__annotations__)
"""Parts of an error that are what an effect left out would move."""

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
    """

    choice: fem.Choice
    theory: Theory
    mesh: str
    layers: float
    left_out: dict[str, LeftOut] = field(default_factory=dict)


def points(
    source: SceneFile,
    discrete: Discrete,
    diagram: fem.Campbell,
    numbers: Sequence[int],
) -> tuple[SpeedPoint, ...]:
    """Modes at the speeds of these numbers in the sweep."""
    from fem.accuracy.theory_selection import over_speeds

    rotor, operators = source.scene.rotor, discrete.choice.operators
    radius = operators.radius(*plate_mesh.place(source, operators.plate.mesh))
    families, theory = diagram.families, over_speeds(operators, diagram)
    found = []
    for number in numbers:
        omega = float(diagram.omega[number])
        found.append(
            SpeedPoint(
                omega=omega,
                rpm=rpm(omega),
                radius=radius,
                load_g=omega**2 * radius / rotor.gravity,
                modes=_modes(discrete, diagram, number, families[number][: rotor.modes], theory[number]),
            )
        )
    return tuple(found)


def _modes(
    discrete: Discrete, diagram: fem.Campbell, number: int, families: list[str], theory: Floats
) -> tuple[Mode, ...]:
    omega, count = float(diagram.omega[number]), len(families)
    turning = discrete.choice.operators.gyroscopic is not None and omega > 0
    errors = _errors(discrete, omega, diagram.bounds[number, :count], theory[:count])
    return tuple(
        Mode(
            frequency_hz=float(diagram.frequencies_hz[number, k]),
            family=family,
            error_parts=errors[k],
            damping_ratio=float(diagram.damping_ratios[number, k]) if turning else None,
            branch=int(diagram.branches[number, k]),
        )
        for k, family in enumerate(families)
    )


def _errors(discrete: Discrete, omega: float, bounds: Floats, theory: Floats) -> list[ErrorParts]:
    """The parts of each mode's error at a speed [rad/s]."""
    mesh = discrete.choice.errors_at(omega)
    left_out = {name: found.at(omega, bounds.size) for name, found in discrete.left_out.items()}
    return [
        ErrorParts(
            mesh=float(mesh[k]) if np.isfinite(mesh[k]) else None,
            layers=discrete.layers,
            basis=float(bounds[k]),
            theory=float(theory[k]),
            **{name: _share(left_out.get(name), k) for name in _EFFECTS},
        )
        for k in range(bounds.size)
    ]


def _share(shifts: Floats | None, k: int) -> float | None:
    return None if shifts is None or not np.isfinite(shifts[k]) else float(shifts[k])


def surface(operators: fem.Operators, diagram: fem.Campbell, numbers: Sequence[int], count: int) -> Surface:
    """The mid-surface with the shapes of some of the speeds of these numbers."""
    from fem import displacement

    kept = _kept(len(numbers))
    unknowns = np.hstack([_upright(diagram.shapes(numbers[k])[:, :count]) for k in kept])
    shapes = np.array(displacement(operators, unknowns))
    shapes[np.abs(shapes) < _NOTHING * np.abs(shapes).max(axis=(1, 2), keepdims=True)] = 0.0
    found = _shaped(operators, operators.plate.mesh, shapes, kept)
    return replace(found, finer=_finer(operators, unknowns, kept))


def _shaped(operators: fem.Operators, mesh: Any, shapes: Any, kept: tuple[int, ...]) -> Surface:
    """A mesh with displacements (shapes, n, 3), as many at each of the speeds kept."""
    by_speed = shapes.reshape(len(kept), -1, *shapes.shape[1:])
    behind = -by_speed.imag if np.iscomplexobj(by_speed) else None
    thickness = _thickness(operators.plate, mesh)
    return replace(bare(mesh), shapes=by_speed.real, at=kept, thickness=thickness, behind=behind)


def _finer(operators: fem.Operators, unknowns: Floats, kept: tuple[int, ...]) -> Surface | None:
    """The surface with each side of a cell in as many parts as `SMOOTH` points allow; None where that is one.

    For pictures: no more digits than these show.
    """
    from fem.output import between

    mesh = operators.model.mesh
    points = mesh.t.shape[1] if mesh.t.shape[0] == 4 else mesh.t.shape[1] / 2
    parts = min(int(np.sqrt(SMOOTH / points)), _PARTS)
    if parts < 2:
        return None
    found = between(operators, unknowns, parts)
    largest = np.abs(found.displacement).max(axis=(1, 2), keepdims=True)
    step = np.ldexp(1.0, np.frexp(largest)[1] - _BITS)
    shapes = np.round(found.displacement / step) * step + 0.0  # which has no -0
    small = shapes.astype(np.complex64 if np.iscomplexobj(shapes) else np.float32)
    return replace(_shaped(operators, found.mesh, small, kept), lines=found.lines)


def bare(mesh: Any) -> Surface:
    """A mesh's mid-surface, without shapes."""
    from fem.meshes.planform import root_facets

    points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
    kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
    outline, root = (np.asarray(mesh.facets[:, found].T) for found in (mesh.boundary_facets(), root_facets(mesh)))
    return Surface(points, (kind, np.asarray(mesh.t.T)), outline, root, np.zeros((0, 0, len(points), 3)), ())


def _thickness(plate: fem.Plate, mesh: Any) -> Floats | None:
    """The thickness [m] at a mesh's points, (n,), where it varies."""
    if isinstance(plate.thickness, float | int):
        return None
    found = np.zeros(mesh.p.shape[1])
    found[mesh.t.T] = plate.thickness.at(mesh.p[:, mesh.t.T])
    return found


def diagram_of(discrete: Discrete, diagram: fem.Campbell, count: int, asked: tuple[float, ...]) -> Diagram:
    """What else the sweep found: its bound, veerings among the modes shown, speeds lost to divergence."""
    from fem import critical_speed

    operators, families = discrete.choice.operators, diagram.families
    known = set(diagram.omega.tolist())
    lost = tuple(sorted(rpm(omega) for omega in asked if omega not in known))
    linear = not operators.effects.large_deflection
    veerings = []
    for veering in diagram.veerings:
        low, high = (rpm(float(omega)) for omega in diagram.omega[veering.step : veering.step + 2])
        names = [families[veering.step][k] for k in veering.modes if k < count]
        veerings.append((low, high, tuple(names)))
    return Diagram(
        mesh=discrete.mesh,
        bound=float(diagram.bounds[:, :count].max()),
        bases=diagram.sizes,
        veerings=tuple(veering for veering in veerings if veering[2]),
        lost=lost,
        critical=rpm(critical_speed(operators)) if lost and linear else None,
    )


def _upright(shapes: Floats) -> Floats:
    """Complex shapes turned to the phase at which their largest unknown peaks; real ones as they are."""
    if not np.iscomplexobj(shapes):
        return shapes
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    return np.asarray(shapes * (np.abs(largest) / largest))


def _kept(count: int) -> tuple[int, ...]:
    """Which speeds keep their shapes: all, or evenly chosen ones with both ends."""
    if count <= SHAPES_AT_MOST:
        return tuple(range(count))
    return tuple(np.unique(np.linspace(0, count - 1, SHAPES_AT_MOST).round().astype(int)).tolist())
