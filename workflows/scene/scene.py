"""The scene: what a user describes, as frozen, validated records in SI; the tables of the rotor stand here too."""

import math
from collections.abc import Mapping
from functools import partial
from numbers import Real
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, WithJsonSchema, model_validator

from fem.accuracy.tolerances import Budget
from fem.rotor import from_rpm, in_rpm
from workflows.errors import BadInput, did_you_mean
from workflows.formatting import significant, whole
from workflows.scene import materials
from workflows.scene import quantities as q
from workflows.scene.damper import HEAVIEST, Damper, Release, misfit, through_the_thickness
from workflows.scene.materials import LIGHTEST
from workflows.scene.plate import TABLE, VALUE, VALUE_OR_TABLE, Material, Plate
from workflows.scene.quantities import ROUNDING, Table, fault, wrong

MOST_SPEEDS = 100_000

FASTEST = 1e5
"""Largest rotation speed taken [rad/s]: above it no plate holds, and rounding would answer for physics."""


SLOWEST = 1e-4
"""Least rotation speed above rest that is taken [rad/s]: a turn in most of a day is rest."""


def omega_of(rpm: float, key: str = "--rpm") -> float:
    """The speed [rad/s] of an option, or of a key.

    Raises:
        BadInput: it is no number, or nothing turns so fast, or so slowly.
    """
    given: object = rpm
    if isinstance(given, bool) or not isinstance(given, Real):
        raise BadInput("expected a number of revolutions per minute", key=key, value=rpm)
    try:
        speed = float(given)
    except OverflowError:  # a whole number of more than 308 digits
        speed = math.inf
    omega = from_rpm(speed)
    if not (omega == 0 or SLOWEST <= omega <= FASTEST):
        low, high = significant(in_rpm(SLOWEST)), whole(in_rpm(FASTEST))
        problem = f"expected a rotation speed between 0 and {high} rpm, and no less than {low} rpm unless at rest"
        raise BadInput(problem, key=key, value=as_typed(speed))
    return omega


def as_typed(rpm: float) -> float:
    """A speed as somebody types it: 4500, where the command line has made 4500.0 of it."""
    return int(rpm) if float(rpm).is_integer() else rpm


_SPEED = q.quantity_schema(q.ROTATION)
_RANGE = {"start": _SPEED, "stop": _SPEED, "count": {"type": "integer", "minimum": 1}}
_LADDER = {"type": "object", "properties": _RANGE, "required": [*_RANGE], "additionalProperties": False}
_SPEEDS_SCHEMA = {"anyOf": [q.array_schema(_SPEED), _LADDER]}


def _speeds(value: object, info: ValidationInfo) -> tuple[float, ...]:
    if isinstance(value, dict):
        speeds = _ladder(value, info)
    elif isinstance(value, list | tuple) and value:
        speeds = [q.si(q.ROTATION, item, info) for item in value]
    else:
        raise wrong("expected a list such as ['3500 rpm'] or { start = '0 rpm', stop = '9000 rpm', count = 10 }")
    if any(speed < 0 for speed in speeds):
        raise wrong("a rotation speed must not be negative")
    if any(speed > FASTEST for speed in speeds):
        raise wrong(f"expected speeds up to {FASTEST:g} rad/s, about a million rpm")
    if slow := [speed for speed in speeds if 0 < speed < SLOWEST]:
        least = f"{SLOWEST:g} rad/s, about a thousandth of a revolution per minute"
        raise wrong(f"expected 0, or at least {least}: {slow[0]:g} rad/s is practically at rest")
    if len(speeds) > MOST_SPEEDS:
        raise wrong(f"expected at most {MOST_SPEEDS} speeds")
    if len(set(speeds)) < len(speeds):
        raise wrong("expected every speed once")
    return tuple(speeds)


def _ladder(value: dict[str, object], info: ValidationInfo) -> list[float]:
    _whole(value)
    start, stop = q.si(q.ROTATION, value["start"], info), q.si(q.ROTATION, value["stop"], info)
    count = value["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_SPEEDS:
        raise wrong(f"count: expected a whole number from 1 to {MOST_SPEEDS}")
    if count > 1 and not stop > start:
        raise wrong("stop: expected a speed above start")
    if count == 1 and stop != start:
        raise wrong("count: expected at least 2; for one speed give a list such as ['3500 rpm']")
    return [start + (stop - start) * i / max(count - 1, 1) for i in range(count)]


def _whole(value: dict[str, object]) -> None:
    """All three keys, and no other."""
    unknown = [name for name in value if name not in _RANGE]
    if unknown:
        listed = ", ".join(f"'{name}'" for name in unknown)
        hint = did_you_mean(unknown[0], _RANGE) if len(unknown) == 1 and unknown != ["step"] else ""
        raise wrong(f"unknown key {listed}{hint or ': expected start, stop and count'}")
    for name in _RANGE:
        if name not in value:
            raise wrong(f"'{name}' is missing: expected start, stop and count")


Speeds = Annotated[tuple[float, ...], BeforeValidator(_speeds), WithJsonSchema(_SPEEDS_SCHEMA)]


FINEST = 1e-10
"""Least relative error of a frequency that double precision gives: its 1e-16 times a stiffness matrix's condition."""


_LOWEST, _HIGHEST = 1e-3, 1e6
"""Frequencies [Hz]: a cycle takes a quarter of an hour, and a wave of steel is 5 mm long."""


class Structure(Table):
    """A structure given by its frequency and mass at the damper, instead of a plate."""

    frequency: q.Frequencies
    """ω1 / 2π, with the ball stuck: one for both of the damper's axes, or one along each"""
    mass: Annotated[q.Mass, q.Positive]
    """M2: effective mass at the damper, without the ball"""

    @model_validator(mode="after")
    def _sense(self) -> Self:
        """A frequency at which something as large as a cavity with a ball in it can vibrate."""
        if not all(_LOWEST <= each <= _HIGHEST for each in self.frequency):
            problem = f"expected from {_LOWEST:g} Hz to {_HIGHEST:.0f} Hz, the range of structures that carry a damper"
            raise fault("frequency", problem)
        return self

    floor_tilt: q.Slopes = (0.0, 0.0)
    """slope of the cavity's floor over the displacement: one for both of the damper's axes, or one along each"""

    @property
    def level(self) -> bool:
        """Whether the cavity's floor stays level as the structure moves."""
        return not any(self.floor_tilt)


def _modes(value: object, info: ValidationInfo) -> str | dict[str, str]:
    expectation = "expected a file such as 'blade.frd', or { '0 rpm' = 'rest.frd', '9000 rpm' = 'fast.frd' }"
    if isinstance(value, str):
        value = {"": value}
    if not isinstance(value, Mapping) or not value or not all(isinstance(name, str) for name in value.values()):
        raise wrong(expectation)
    for name in value.values():
        if not name.strip() or not name.isprintable():
            raise wrong(expectation)
    if set(value) == {""}:
        return str(value[""])
    known = [q.si(q.ROTATION, speed, info) for speed in value]
    if min(known) < 0 or max(known) > FASTEST or len(set(known)) < len(known):
        raise wrong(f"expected different speeds from 0 to {FASTEST:g} rad/s as keys")
    return {str(speed): str(name) for speed, name in value.items()}


_FILES = {"type": "object", "additionalProperties": {"type": "string"}, "minProperties": 1}
Modes = Annotated[
    str | dict[str, str], BeforeValidator(_modes), WithJsonSchema({"anyOf": [{"type": "string"}, _FILES]})
]


class KnownModes(Table):
    """A structure of known modes, from another program or a test, instead of a plate."""

    modes: Modes
    """file of modes (.frd of CalculiX in ASCII, or the neutral .npz or .json); or a file for each speed"""
    unit: q.LengthUnit | None = None
    """unit of the file's coordinates; default: that stated in the file, otherwise m"""
    mass_unit: q.MassUnit | None = None
    """unit of the file's modal masses; default: that stated in the file, otherwise kg"""

    @property
    def files(self) -> dict[float | None, str]:
        """Names of files by the speed of their modes [rad/s]; None where the speed is not given."""
        if isinstance(self.modes, str):
            return {None: self.modes}
        return {q.to_si(speed, q.ROTATION): name for speed, name in self.modes.items()}

    def scale(self, unit: str | None, mass_unit: str | None) -> tuple[float, float]:
        """Metres and kilograms to the units of a file that says these of itself."""
        return q.unit_in_si(self.unit or unit, q.LENGTH), q.unit_in_si(self.mass_unit or mass_unit, q.MASS)


class RootRadius(Table):
    """A root of all nodes up to a distance from the spin axis."""

    radius: Annotated[q.Length, q.Positive]
    """from the spin axis, up to which all nodes are clamped"""


class Blade(Table):
    """A solid blade from a mesh of its volume, instead of a plate: twisted, cambered, of any shape."""

    mesh: q.MeshFile
    """file of a mesh (tetrahedra, hexahedra or wedges, best of second order) or of geometry (.step)"""
    unit: q.LengthUnit | None = None
    """of the coordinates in the mesh file; default: m"""
    root: Annotated[Annotated[q.Line, VALUE] | Annotated[RootRadius, TABLE], VALUE_OR_TABLE] | None = None
    """the clamped part: a set of nodes or faces in the file, the radius of its nodes, such as '100 mm', or
    { radius = '100 mm' }, all nodes up to there; default: the innermost face"""
    size: Annotated[q.Length, q.Positive] | None = None
    """cell size for meshing geometry (.step, .iges, .brep); needs gmsh (spindamp[step])"""

    @property
    def root_radius(self) -> float | None:
        """Where the root lies at a radius, that [m]."""
        try:
            return q.to_si(self.root, q.LENGTH) if isinstance(self.root, str) else None
        except q.UnitError:
            return None


_GIVEN, _KNOWN = "[given]", "[known]"
"""Mark the two kinds of [structure], as `VALUE` and `TABLE` do."""


def _kind_of_structure(value: Any) -> str:
    known = isinstance(value, KnownModes) or (isinstance(value, Mapping) and "modes" in value)
    return _KNOWN if known else _GIVEN


AnyStructure = Annotated[
    Annotated[Structure, Tag(_GIVEN)] | Annotated[KnownModes, Tag(_KNOWN)], Discriminator(_kind_of_structure)
]


NO_ORIGIN = (
    "missing: a point on the spin axis in the {}'s coordinates, such as ['0 m', '0 m', '0 m'] (or hub_radius, from the"
    " axis to the smallest x)"
)
"""What is said of a structure in space whose spin axis is not known."""

_LARGEST_HUB = 20.0
"""Radius [m] at which no blade is clamped: the largest hubs, those of wind turbines, have 3 m."""


class Rotor(Table):
    """How the structure spins."""

    speeds: Speeds
    """rotation speeds: a list, or a range with start, stop and count"""
    hub_radius: Annotated[q.Length, q.NotNegative] = 0.0
    """distance from the axis to the clamped root, whatever the coordinates of a mesh"""
    radius: Annotated[q.Length, q.Positive] | None = None
    """distance from the axis to the damper; only with [structure]"""
    stagger: q.Angle = 0.0
    """tilt of the spin axis from the plate's normal towards y"""
    precone: q.Angle = 0.0
    """angle of the plate's length out of the plane of rotation, towards the axis; after the stagger"""
    axis: q.Direction | None = None
    """direction of the spin axis of a structure in space; default: as for a plate, by stagger and precone"""
    origin: q.LengthTriple | None = None
    """a point on the spin axis of a structure in space; default: at the distance hub_radius below its smallest x"""
    gravity: Annotated[q.Acceleration, q.Positive] = q.STANDARD_GRAVITY
    """the unit g of loads and accelerations"""
    modes: Annotated[int, Field(ge=1, le=200)] = 6
    """number of modes at each speed"""

    @model_validator(mode="after")
    def _sense(self) -> Self:
        """A stagger within half a turn: beyond, it is more likely a number of degrees without its unit."""
        if self.hub_radius >= _LARGEST_HUB:
            raise fault("hub_radius", f"{self.hub_radius:g} is in m: was '{self.hub_radius:g} mm' meant?")
        if abs(self.stagger) > math.pi * (1 + ROUNDING):
            raise fault("stagger", "expected an angle within ±180 deg (a bare number is in radians)")
        if abs(self.precone) > math.pi / 2 * (1 + ROUNDING):
            raise fault("precone", "expected an angle within ±90 deg (a bare number is in radians)")
        return self

    @property
    def has_origin(self) -> bool:
        """Whether the scene says where the spin axis of a structure in space is."""
        return self.origin is not None or "hub_radius" in self.model_fields_set


class Effects(Table):
    """Which effects to simulate: "auto" (when the scene calls for it), true or false."""

    stress_stiffening: q.Switch = "auto"
    """the centrifugal load stiffens the plate"""
    spin_softening: q.Switch = "auto"
    """spin softens motion perpendicular to the spin axis"""
    coriolis: q.Switch = "auto"
    """Coriolis forces; the modes are complex"""
    large_deflection: q.Switch = "auto"
    """modes about the plate or blade as the load bends or twists it"""
    rotary_inertia: q.Switch = "auto"
    """inertia of the rotating cross-sections"""
    rolling_resistance: q.Switch = "auto"
    """the load resists the ball's rolling"""
    impact_friction: q.Switch = "auto"
    """friction where the ball hits a wall"""
    ball_slip: q.Switch = "auto"
    """slip after a wall hit, until the ball rolls again"""
    floor_tilt: q.Switch = "auto"
    """the cavity's floor tilts as the structure bends"""
    indentation: q.Switch = "auto"
    """the dent under a resting ball holds it"""
    structural_modes: q.Switch = "auto"
    """the cavity moves in the plate's own modes; false: one frequency on both axes, as in the paper"""
    cavity_mass: q.Switch = "auto"
    """the cavities remove metal from the plate"""


class Accuracy(Table):
    """Requested relative errors."""

    frequency: Annotated[q.Number, Field(gt=0, ge=FINEST, lt=1)] = 1e-3
    """relative error of the plate's frequencies, dimensionless; not below what double precision allows"""
    damping: Annotated[q.Number, Field(gt=0, lt=1)] = 1e-3
    """relative error of the damping, dimensionless"""


FLAT = "flat"
"""A floor without a radius."""


def _floor(value: object, info: ValidationInfo) -> float | str:
    if value == FLAT:
        return FLAT
    if isinstance(value, str) and (hint := did_you_mean(value, [FLAT])):
        raise wrong(f"expected '{FLAT}' or a length such as '8 mm'{hint}")
    return q.si(q.LENGTH, value, info)


def _whole_numbers(expectation: str, most: int | None = None, once: str = "") -> tuple[BeforeValidator, WithJsonSchema]:
    """A list of whole numbers from 1 on; up to `most`, one alone will do."""

    def whole(value: object, _: ValidationInfo) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= (most or value):
            raise wrong(expectation)
        return value

    schema = {"type": "integer", "minimum": 1} | ({} if most is None else {"maximum": most})
    return q.several(whole, schema, expectation, single=most is not None, once=once)


_FLOOR = {"anyOf": [{"const": FLAT}, *q.quantity_schema(q.LENGTH)["anyOf"]], "x-si": "m"}
_A_FLOOR = f"expected a list such as ['{FLAT}', '8 mm', '64 mm']"
_BALL, _BALLS = partial(q.one_of, materials.BALLS), {"enum": list(materials.BALLS)}

Floors = Annotated[tuple[float | str, ...], *q.several(_floor, _FLOOR, _A_FLOOR)]
Materials = Annotated[tuple[str, ...], *q.several(_BALL, _BALLS, "expected a list such as ['steel', 'lead']")]
Counts = Annotated[tuple[int, ...], *_whole_numbers("expected a list of whole numbers from 1 on")]


class Design(Table):
    """Free quantities and limits of `spindamp design`: a pair of numbers is a range, any other list a choice."""

    ball_material: Materials | None = None
    """names of materials to choose from"""
    ball_diameter: q.Lengths | None = None
    """diameter of a ball"""
    clearance: q.Lengths | None = None
    """size of the cavity minus the ball's diameter, along both axes"""
    floor_radius: Floors | None = None
    """radius of the cavity's floor; a list with 'flat' is a choice"""
    count: Counts | None = None
    """number of balls, each in a cavity of its own"""
    place: q.Lengths | None = None
    """place of the damper along the plate: x of damper.at"""
    mass: Annotated[q.Mass, q.Positive] | None = None
    """mass of all balls together, at most"""
    wall: Annotated[q.Length, q.NotNegative] = 0.0
    """least thickness left on either side of the cavity"""
    hardness_ratio: Annotated[q.Number, q.Positive, Field(le=1)] = 1.0
    """mean pressure of the resting ball over the hardness of the softer of ball and floor, at most,
    dimensionless; at 1 the contact yields fully. Requires named materials"""
    yield_ratio: Annotated[q.Number, q.Positive] | None = None
    """load of the resting ball over that of first yield, at most, dimensionless; at 1 no dent forms; default: none"""
    amplitude: q.LengthPair | None = None
    """range of amplitudes at the cavity over which the least damping counts; default: with [excitation], the greatest
    amplitude at the crossings counts"""

    @model_validator(mode="after")
    def _sense(self) -> Self:
        if self.amplitude is not None and not 0 < self.amplitude[0] < self.amplitude[1]:
            raise fault("amplitude", "expected a range of amplitudes above 0, in ascending order")
        free = ("ball_material", "ball_diameter", "clearance", "floor_radius", "count", "place")
        if not any(getattr(self, name) is not None for name in free):
            raise fault("ball_diameter", f"nothing to vary: expected one of {', '.join(free)}")
        for name in ("ball_diameter", "clearance", "place"):
            value = getattr(self, name)
            if value is not None and (min(value) <= 0 or (len(value) == 2 and not value[0] < value[1])):
                raise fault(name, "expected lengths above 0, a range in ascending order")
        return self


MOST_LEVELS = 20
"""Heights of a force that are looked at: each is a picture of its own."""


def _levels(kind: q.Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    """One height above 0, or a list of different ones."""
    expectation = f"expected a value such as '{kind.example}', or a list of at most {MOST_LEVELS}"
    once = "expected every level once"
    read = partial(q.above_zero, kind)
    return q.several(read, q.quantity_schema(kind), expectation, 1, MOST_LEVELS, single=True, once=once)


_IN_SPACE = "expected three lengths, (x, y, z) in the structure's coordinates"
"""Of a place that has two."""

_ORDERS = "expected a list of whole numbers from 1 to 1000, such as [2, 3]"

Forces = Annotated[tuple[float, ...], *_levels(q.FORCE)]
Pressures = Annotated[tuple[float, ...], *_levels(q.SURFACE_PRESSURE)]
Loads = Annotated[tuple[float, ...], *_levels(q.LOAD)]
Orders = Annotated[tuple[int, ...], *_whole_numbers(_ORDERS, 1000, "expected every order once")]


class Excitation(Table):
    """Harmonic forces at multiples of the rotation frequency, at one level or several."""

    orders: Orders
    """engine orders, frequency over rotation frequency: whole numbers, dimensionless"""
    force: Forces | None = None
    """amplitude of a force at the damper's place along the damper's axis 1: a level, or a list of them"""
    at: q.Place | None = None
    """where the force acts on a structure in space: a place (x, y, z), a set of its nodes or a node's number; default:
    the damper's place, along its axis 1"""
    direction: q.Direction | None = None
    """direction of the force at `at`, in the structure's coordinates"""
    pressure: Pressures | None = None
    """amplitude of a pressure over the whole plate, along its z: a level, or a list of them"""
    base: Loads | None = None
    """amplitude of the root's acceleration along the damper's axis 1: a level, or a list of them; amplitudes are then
    relative to the root"""

    @model_validator(mode="after")
    def _one(self) -> Self:
        """One way of giving the force."""
        q.check_one(self, ("force", "pressure", "base"), "force, pressure and base")
        if self.at is not None and self.force is None:
            raise fault("at", "a place belongs to a force: leave this out")
        return self

    def check_place(self) -> None:
        """Place and direction of the force on a structure in space: both or neither."""
        if isinstance(self.at, tuple) and len(self.at) != 3:
            raise fault("excitation.at", _IN_SPACE)
        if (self.at is None) != (self.direction is None):
            missing, other = ("direction", "at") if self.direction is None else ("at", "direction")
            raise fault(f"excitation.{missing}", f"missing: a force away from the damper needs it beside {other}")

    @property
    def kind(self) -> str:
        """Which of force, pressure and base it is."""
        return next(name for name in ("force", "pressure", "base") if getattr(self, name) is not None)

    @property
    def levels(self) -> tuple[float, ...]:
        """Heights, ascending [N, Pa or m/s²]."""
        values: tuple[float, ...] = getattr(self, self.kind)
        return tuple(sorted(values))

    @property
    def unit(self) -> str:
        """Of the levels."""
        return {"force": "N", "pressure": "Pa", "base": "m/s²"}[self.kind]


def check_on_plate(plate: Plate, damper: Damper | None, release: Release | None) -> None:
    """Damper, tip mass and release are where the plate is. Where a mesh gives the planform, `plate_mesh` looks on."""
    if damper is not None and plate.tip_mass_at is not None:
        raise fault("plate.tip_mass_at", "the tip mass is at the damper's place: leave this out")
    if plate.length is not None and plate.width is not None:
        _check_rectangle(plate, (plate.length, plate.width), damper)
    elif damper is not None and isinstance(plate.thickness, float):
        _raise_misfit(through_the_thickness(damper, plate.thickness))
    if damper is not None:
        _check_count(damper, damper.balls)
    if release is not None and plate.length is not None:
        _check_displacement(release, plate.length, "the plate's length")


def _check_rectangle(plate: Plate, sides: tuple[float, float], damper: Damper | None) -> None:
    length, width = sides
    key, at = ("plate.tip_mass_at", plate.tip_mass_at) if damper is None else ("damper.at", damper.on_plate)
    x, y = (length, 0.0) if at is None else at
    if not 0 < x <= length * (1 + ROUNDING) or abs(y) > width / 2 * (1 + ROUNDING):
        raise fault(key, f"outside the plate: expected x above 0 and at most {length:g} m, y within ±{width / 2:g} m")
    if damper is not None:
        _raise_misfit(misfit(damper, plate.thickness_at((x, y)), width, x, width - 2 * abs(y)))


def _raise_misfit(odd: tuple[str, str] | None) -> None:
    """Raise what is odd about a damper, as key and problem."""
    if odd is not None:
        raise fault(f"damper.{odd[0]}", odd[1])


def _check_displacement(release: Release, most: float, what: str, slack: float = 0.0) -> None:
    if max(map(abs, release.displacement or (0.0,))) > most * (1 + slack):
        raise fault("release.displacement", f"expected at most {what}, {most:g} m")


def check_reach(radius: float, damper: Damper, release: Release | None) -> None:
    """Ball, cavity and release that do not reach beyond the axis about which they turn, `radius` away."""
    most, distance = radius * (1 + ROUNDING), f"its distance from the axis, {radius:g} m"
    if damper.radius > most:
        raise fault("damper.radius", f"the ball is larger than {distance}")
    if max(damper.cavity) > most:
        raise fault("damper.cavity", f"the cavity is larger than {distance}")
    if release is not None:
        _check_displacement(release, radius, "the damper's distance from the axis", ROUNDING)


def check_weight(damper: Damper, structure: float) -> None:
    """Balls that the structure [kg] carries, not the other way round; of a plate that is known once it is solved."""
    if damper.balls is not None and damper.balls > HEAVIEST * structure:
        key = next(key for key in ("mass", "ball_material", "ball_density") if getattr(damper, key) is not None)
        problem = f"expected balls of at most {HEAVIEST:g} times the structure's mass, {structure:g} kg"
        raise fault(f"damper.{key}", f"{problem}; these weigh {damper.balls:g} kg")
    _check_count(damper, damper.balls if damper.mass_ratio is None else damper.mass_ratio * structure)


def _check_count(damper: Damper, mass: float | None) -> None:
    """No more balls than share their mass [kg], where it is known, and are each as heavy as foam at least."""
    if mass is None or damper.count == 1:
        return
    most = max(int(mass / (4 / 3 * math.pi * damper.radius**3 * LIGHTEST)), 1)
    if damper.count > most:
        problem = f"expected at most {most} of radius {damper.radius:g} m that weigh {mass:g} kg together"
        raise fault("damper.count", f"{problem}: more would be lighter than {LIGHTEST:g} kg/m^3, the lightest foam")


class Scene(Table):
    """A whole scene: a plate or a structure, a rotor, and perhaps a damper."""

    title: Annotated[q.Line, Field(max_length=200)] = "untitled"
    """one line of text"""
    plate: Plate | None = None
    """the plate"""
    blade: Blade | None = None
    """a solid blade from a mesh of its volume, instead of a plate"""
    material: Material | None = None
    """what the plate or the blade is made of"""
    structure: AnyStructure | None = None
    """the structure that carries the damper, instead of a plate"""
    rotor: Rotor
    """how it spins"""
    effects: Effects = Effects()
    """which effects are simulated"""
    damper: Damper | None = None
    """balls in cavities; left out, with [release], for the plate alone"""
    release: Release | None = None
    """how a ring-down begins; left out beside a damper: by default"""
    excitation: Excitation | None = None
    """excitation, for `run`, `response` and `design`"""
    accuracy: Accuracy = Accuracy()
    """tolerances"""
    design: Design | None = None
    """design space of `spindamp design`; other commands ignore it"""

    @model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, data: Any) -> Any:
        """A plate or a structure, before either is looked at: what one lacks is not asked for because of the other.

        A damper without a [release] has the default one.
        """
        if not isinstance(data, Mapping):
            return data
        present = {table for table, value in data.items() if value is not None}
        for table in ("plate", "structure") if "blade" in present else ():
            if table in present:
                raise fault(table, "expected a [blade] or this: leave one out")
        given = data.get("structure")
        if "plate" in present and isinstance(given, Mapping) and set(given) == {"floor_tilt"}:
            raise fault("structure.floor_tilt", "on a plate the floor's tilt follows from the bending: leave this out")
        for table in ("plate", "material") if "structure" in present else ():
            if table in present:
                raise fault(table, "expected a plate with its material or a [structure]: leave one out")
        return {**data, "release": {}} if "damper" in present and "release" not in present else data

    @model_validator(mode="after")
    def _check_tables(self) -> Self:
        """Which tables belong together, which exclude each other, and whether what they describe fits together."""
        if self.given is not None:
            self._check_given(self.given)
        elif self.in_space:
            self._check_space()
        else:
            self._check_plate()
        self._check_damper()
        if self.design is not None and self.design.amplitude is None and self.excitation is None:
            problem = "missing: the range over which the least damping counts (or give [excitation] instead)"
            raise fault("design.amplitude", problem)
        if self.excitation is not None and self.damper is not None and self.damper.damping_ratio == 0:
            problem = "without damping the amplitude at resonance is unbounded"
            raise fault("damper.damping_ratio", f"{problem}: give the damping ratio by air and clamp, such as 0.001")
        if self.plate is not None:
            check_on_plate(self.plate, self.damper, self.release)
        if self.damper is not None and (radius := self._damper_radius) is not None:
            check_reach(radius, self.damper, None if self.plate is not None else self.release)
        if self.release is not None and self.release.ratio is not None and not any(self.rotor.speeds):
            raise fault("release.ratio", "at rest there is no load, so a release as a ratio of it is zero")
        return self

    def changed(self, **tables: Table | Mapping[str, Any] | None) -> Self:
        """The same with other tables, or with other keys in a table, whose values are in SI and not looked at again."""
        new = {
            name: getattr(self, name).model_copy(update=dict(table)) if isinstance(table, Mapping) else table
            for name, table in tables.items()
        }
        return self.model_copy(update=new)

    def as_written(self) -> dict[str, Any]:
        """Plain data that can be read again: a material by its name or by its numbers, not by both."""
        data = self.model_dump(mode="json", exclude_none=True)
        for table, name, numbers in (
            ("material", "name", materials.NUMBERS),
            ("damper", "ball_material", ("ball_density",)),
        ):
            if name in data.get(table, {}):
                data[table] = {key: item for key, item in data[table].items() if key not in numbers}
        return data

    @property
    def given(self) -> Structure | None:
        """The structure of which frequency and mass are given."""
        return self.structure if isinstance(self.structure, Structure) else None

    @property
    def known(self) -> KnownModes | None:
        """The structure of which the modes are known."""
        return self.structure if isinstance(self.structure, KnownModes) else None

    @property
    def in_space(self) -> bool:
        """Whether the structure lies in space, its floor across the load wherever the damper is."""
        return self.known is not None or self.blade is not None

    def _check_space(self) -> None:
        """What a blade or a structure of known modes takes, and what it leaves out."""
        if self.blade is not None and self.material is None:
            raise fault("material", "the table is missing")
        if self.blade is not None and not self.rotor.has_origin:
            raise fault("rotor.origin", NO_ORIGIN.format("mesh"))
        if self.rotor.origin is not None and self.rotor.hub_radius:
            raise fault("rotor.hub_radius", "origin gives the position of the spin axis: leave hub_radius out")
        for name in ("stagger", "precone") if self.rotor.axis is not None else ():
            if getattr(self.rotor, name):
                raise fault(f"rotor.{name}", f"axis gives the direction of the spin axis: leave {name} out")
        self._require_defaults("not_known")
        if self.excitation is not None:
            self.excitation.check_place()
        if self.damper is not None and isinstance(self.damper.at, tuple) and len(self.damper.at) != 3:
            raise fault("damper.at", _IN_SPACE)
        if self.damper is not None and self.damper.at is None:
            place = "a place (x, y, z) in the structure's coordinates such as ['330 mm', '0 mm', '0 mm']"
            raise fault("damper.at", f"missing: {place}, a set of its nodes or a node's number")

    def _check_plate(self) -> None:
        for table in ("plate", "material"):
            if getattr(self, table) is None:
                raise fault(table, "the table is missing (or give [blade] or [structure] instead of a plate)")
        self._require_defaults("not_plate")
        self._require_defaults("only_in_space")
        at = None if self.damper is None else self.damper.at
        if at is not None and (not isinstance(at, tuple) or len(at) != 2):
            raise fault("damper.at", "expected a list of two lengths, the place (x, y) on the plate")

    def _check_damper(self) -> None:
        if self.damper is None and self.release is not None:
            raise fault("damper", "the table is missing: [release] needs it")
        if self.damper is not None and self.rotor.precone and not self.in_space:
            problem = (
                "the load then has a component along the cavity's floor: expected 0, or a [blade] with [damper] normal"
            )
            alone = "the plate alone, without [damper] and [release] (tip_mass and tip_mass_at stay)"
            raise fault("rotor.precone", f"{problem}, or {alone}")

    def _check_given(self, structure: Structure) -> None:
        if self.damper is None:
            raise fault("damper", "the table is missing: a [structure] alone has nothing to solve")
        if self.rotor.radius is None:
            raise fault("rotor.radius", "missing: a [structure] needs the radius at which the damper turns")
        self._require_defaults("only_in_space")
        self._check_tilt(self.damper, structure)
        check_weight(self.damper, structure.mass)
        self._require_defaults("not_given")

    def _require_defaults(self, keys: str) -> None:
        """See that keys, a table of `hints.toml`, which the structure does not take have their defaults."""
        for key, why in q.hints()[keys].items():
            table, name = key.split(".")
            value = getattr(self, table)
            if value is not None and getattr(value, name) != type(value).model_fields[name].default:
                raise fault(key, why)

    def _check_tilt(self, damper: Damper, structure: Structure) -> None:
        if max(map(abs, structure.floor_tilt)) * damper.radius >= 1:
            raise fault("structure.floor_tilt", f"expected less than 1 / radius of the ball, {1 / damper.radius:g} 1/m")
        if not structure.level and damper.formulation == "printed":
            raise fault("structure.floor_tilt", "the printed equations support a level floor only: leave this out")
        if structure.level and self.effects.floor_tilt is True:
            raise fault("effects.floor_tilt", "structure.floor_tilt is 0: give the slope, or leave this out")

    @property
    def _damper_radius(self) -> float | None:
        """The damper's distance from the axis [m]; None where it is known only once a mesh is read."""
        if self.in_space:
            return None
        if self.plate is None:
            return self.rotor.radius
        at = self.damper.on_plate if self.damper is not None else None
        x = self.plate.length if at is None else at[0]
        return None if self.plate.length is None or x is None else self.rotor.hub_radius + x

    @property
    def contact_materials(self) -> tuple[str | None, str | None]:
        """Names of the materials of ball and floor, as far as they have one; the floor is the plate's by default."""
        own = None if self.material is None else self.material.name
        return (None, own) if self.damper is None else (self.damper.ball_material, self.damper.floor_material or own)

    @property
    def is_printed(self) -> bool:
        """Whether the damper follows the equations as printed, which do not conserve energy."""
        return self.damper is not None and self.damper.formulation == "printed"

    @property
    def ball_count(self) -> int:
        """Balls of the damper; 1 without one."""
        return 1 if self.damper is None else self.damper.count

    @property
    def stop_cycles(self) -> float | None:
        """Cycles after which a ring-down ends; None: it goes on until the ball is at rest."""
        cycles = "auto" if self.release is None else self.release.cycles
        return None if isinstance(cycles, str) else cycles

    @property
    def budget(self) -> Budget:
        """What each cause may add to the errors allowed."""
        return Budget(self.accuracy.frequency, self.accuracy.damping)

    @property
    def point_mass(self) -> float:
        """What the plate carries at the damper's place [kg], the balls aside: tip mass and housing."""
        tip = 0.0 if self.plate is None else self.plate.tip_mass
        return tip + (0.0 if self.damper is None else self.damper.housing or 0.0)
