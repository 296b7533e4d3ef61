"""Units at the boundary: text with a unit comes in, SI numbers go on; nothing else here uses pint."""

from __future__ import annotations

import difflib
import math
import re
import sys
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from workflows.errors import did_you_mean

if TYPE_CHECKING:
    import pint

STANDARD_GRAVITY = 9.80665
"""m/s², CGPM 1901; what the unit "g" means unless a scene says otherwise."""

_SPACE = "[ \\t\u00a0\u2009\u202f]"
"""What may stand between number and unit: text from a web page brings narrow spaces along; a line break is none."""

_TEXT = re.compile(rf"{_SPACE}*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?){_SPACE}*(\S.{{0,30}})?")
# Only products, quotients and one-digit powers of names: nothing in a scene is ever evaluated.
_NAME = r"[A-Za-zµμ°]+(?:(?:\^|\*\*)-?[0-9])?"
_UNIT = re.compile(rf"(?:1 */ *)?{_NAME}(?: *[*/· ] *{_NAME})*")


@dataclass(frozen=True)
class Kind:
    """A kind of quantity.

    Attributes:
        name: with its article, for messages.
        example: for messages and the JSON Schema.
        si: the unit it is stored in.
        least, most: bounds on the magnitude of what is not zero; far beyond any use, short of overflow.
        also: the same unit as others write it, with an angle in it.
    """

    name: str
    example: str
    si: str
    least: float
    most: float
    also: str = ""

    @property
    def expectation(self) -> str:
        """What an error message asks for."""
        return f"expected {self.name} such as '{self.example}'"


SPEED = Kind("an impact speed", "1 m/s", "m/s", 1e-9, 1e6)
LENGTH = Kind("a length", "20 cm", "m", 1e-12, 1e6)
MASS = Kind("a mass", "1 kg", "kg", 1e-15, 1e12)
ANGLE = Kind("an angle", "45 deg", "rad", 1e-15, 1e3)
ROTATION = Kind("a rotation speed", "3500 rpm", "rad/s", 1e-9, 1e8)
FREQUENCY = Kind("a frequency", "269.5 Hz", "Hz", 1e-9, 1e12)
PRESSURE = Kind("a modulus", "200 GPa", "Pa", 1e-3, 1e18)
FORCE = Kind("a force", "10 N", "N", 1e-15, 1e15)
SURFACE_PRESSURE = Kind("a pressure", "100 Pa", "Pa", 1e-15, 1e15)
LINE_STIFFNESS = Kind("a stiffness per length", "5e9 N/m/m", "N/m/m", 1e-9, 1e30)
ROTATIONAL_STIFFNESS = Kind("a rotational stiffness per length", "2e5 N*m/rad/m", "N*m/rad/m", 1e-9, 1e30)
DENSITY = Kind("a density", "7850 kg/m^3", "kg/m^3", 1e-6, 1e9)
ACCELERATION = Kind("an acceleration", "9.81 m/s^2", "m/s^2", 1e-12, 1e15)


def length_power(power: int) -> Kind:
    """Lengths to a power, as a polynomial's coefficients are."""
    unit = f"m^{power}"
    if power == 0:
        return Kind("a number", "0.02 mm/mm", "m/m", 1e-30, 1e30)
    return LENGTH if power == 1 else Kind(f"a coefficient in {unit}", f"0.5 {unit}", unit, 1e-30, 1e30)


SLOPE = Kind("a slope over a displacement", "6.9 1/m", "1/m", 1e-30, 1e6, also="rad/m")
LOAD = Kind("an acceleration", "6000 g", "m/s^2", 1e-12, 1e15)


_COMMON = (
    *("mm", "cm", "m", "µm", "km", "in", "inch", "ft", "kg", "g", "t", "mg", "lb", "s", "ms", "min"),
    *("Hz", "kHz", "MHz", "GPa", "MPa", "kPa", "Pa", "bar", "psi", "ksi", "N", "kN", "rpm", "rad", "deg", "rev"),
)
"""Units to suggest for a misspelt one."""


_FACTORS = {
    ("mm", "m"): 1e-3,
    ("cm", "m"): 1e-2,
    ("g", "kg"): 1e-3,
    ("deg", "rad"): 0.017453292519943295,
    ("rpm", "rad/s"): 0.10471975511965977,
    ("MPa", "Pa"): 1e6,
    ("GPa", "Pa"): 1e9,
}
"""What pint says of the commonest units: to load it takes longer than all else that reads a scene."""


class UnitError(ValueError):
    """A value that is not a quantity of the kind expected; the message says what would be right."""


@cache
def _registry() -> pint.UnitRegistry[float]:
    hidden = {"dask"} - sys.modules.keys()  # large, and pint loads it where it is installed; no unit here needs it
    sys.modules |= dict.fromkeys(hidden)  # type: ignore[arg-type]
    from pint import UnitRegistry

    for package in hidden:
        del sys.modules[package]
    return UnitRegistry(str(Path(__file__).parents[1] / "units.txt"), on_redefinition="raise")


@cache
def _factor(unit: str, si: str) -> float | None:
    """The number that takes `unit` to `si`; None where the dimensions differ."""
    known = 1.0 if unit == si else _FACTORS.get((unit, si))
    return _by_pint(unit, si) if known is None else known


def _by_pint(unit: str, si: str) -> float | None:
    registry = _registry()
    target = registry.parse_units(si)
    try:
        quantity = registry.Quantity(1.0, registry.parse_units(unit.replace("·", "*")))
    except Exception as error:  # pint raises AttributeError, ValueError and its parser's own kinds
        raise UnitError(f"unknown unit '{unit}'{_nearest(unit, si)}") from error
    if quantity.dimensionality != target.dimensionality:
        return None
    factor = float(quantity.to(target).magnitude)
    rounded = float(f"{factor:.12g}")  # g/cm^3 is 1000, not 999.9999999999999
    return rounded if abs(rounded - factor) <= 4 * math.ulp(factor) else factor


def _nearest(unit: str, si: str) -> str:
    """The unit probably meant by one that the registry lacks: a slip of case before a slip of letters."""
    registry = _registry()
    unknown = next((name for name in re.findall(r"[A-Za-zµμ°]+", unit) if name not in registry), None)
    if unknown is None:
        return ""
    same = [known for known in _COMMON if known.lower() == unknown.lower()]
    for known in same + difflib.get_close_matches(unknown, _COMMON, n=5, cutoff=0.5):
        meant = unit.replace(unknown, known)
        if _factor(meant, si) is not None:
            return f", did you mean '{meant}'?"
    return ""


def to_si(value: object, kind: Kind, gravity: float | None = None) -> float:
    """A number, taken as SI, or text with a unit, as a finite SI number.

    Args:
        value: what the scene holds.
        kind: what it should be.
        gravity: m/s²; what the lone unit "g" means here. None reads it as gram.

    Raises:
        UnitError: not a number, not finite, an unknown unit, or a unit of another dimension.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise UnitError(kind.expectation)
    if isinstance(value, str):
        return _from_text(value, kind, gravity)
    return _in_range(value, kind)


def unit_in_si(unit: str | None, kind: Kind) -> float:
    """What a unit of a kind is in SI; that of SI itself where none is named.

    Raises:
        UnitError: it is no such unit.
    """
    return 1.0 if unit is None else to_si(f"1 {unit}", kind)


def _from_text(text: str, kind: Kind, gravity: float | None) -> float:
    match = _TEXT.fullmatch(text)
    if match is None:
        raise UnitError(kind.expectation)
    number, unit = match[1], (match[2] or "").rstrip()
    if not unit:
        raise UnitError(f"a string carries its unit, and a bare number is SI: {kind.expectation}")
    if unit == "g" and gravity is not None:
        return _in_range(float(number) * gravity, kind)
    if re.fullmatch(r",[0-9]+( .*)?", unit):
        raise UnitError(f"a decimal comma: was '{text.replace(',', '.', 1)}' meant?")
    if _UNIT.fullmatch(unit) is None:
        raise UnitError(f"cannot read the unit '{unit}': {kind.expectation}")
    try:
        factor = _factor(unit, kind.si)
        if factor is None and kind.also:
            factor = _factor(unit, kind.also)
    except UnitError as error:
        text = str(error)
        raise UnitError(text if text.endswith("?") else f"{text}: {kind.expectation}") from error
    if factor is None:
        raise UnitError(_of_turns(float(number), unit) if kind is ROTATION else kind.expectation)
    return _in_range(float(number) * factor, kind)


def _of_turns(number: float, unit: str) -> str:
    """What is said of a rotation speed in a unit of something else; hertz are taken by some for turns a second."""
    hertz = _factor(unit, FREQUENCY.si)
    if hertz is None:
        return ROTATION.expectation
    return (
        f"{ROTATION.expectation}; '{unit}' is a unit of frequency: as revolutions, write"
        f" '{60 * hertz * number:.9g} rpm'"
    )


def halved(value: object, kind: Kind) -> str | None:
    """Half of a quantity of a kind, as a scene would have it, in its own unit; None for what is none."""
    try:
        si = to_si(value, kind)
    except UnitError:
        return None
    match = _TEXT.fullmatch(value) if isinstance(value, str) else None
    return f"{si / 2:g}" if match is None else f"'{float(match[1]) / 2:g} {match[2].rstrip()}'"


def _as_float(value: float) -> float:
    """A whole number too large for a float is infinite."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _in_range(value: float, kind: Kind) -> float:
    number = _as_float(value)
    if not math.isfinite(number):
        raise UnitError(f"must be finite: {kind.expectation}")
    if number and not kind.least <= abs(number) <= kind.most:
        raise UnitError(f"out of range: expected {kind.name} from {kind.least:g} to {kind.most:g} {kind.si}")
    return number


ROUNDING = 1e-9
"""Relative slack of comparisons between values, which come from decimal text."""


def fault(key: str, problem: str) -> PydanticCustomError:
    """An error at `key` (relative to the table, or ``table.key`` for the whole scene)."""
    return PydanticCustomError("together", "{problem}", {"problem": problem, "key": key})


@cache
def hints() -> dict[str, dict[str, str]]:
    """What people write that a scene does not have, and what is said of it."""
    return tomllib.loads((Path(__file__).parents[1] / "templates" / "hints.toml").read_text(encoding="utf-8"))


def check_one(table: BaseModel, keys: Sequence[str], expectation: str, *, blamed: int = -1) -> None:
    """See that a table has exactly one of some keys; one of several is at fault: which of those it has."""
    present = [key for key in keys if getattr(table, key) is not None]
    if len(present) != 1:
        leave = ": leave one out" if present else ""
        raise fault(present[blamed] if present else keys[0], f"expected one of {expectation}{leave}")


def wrong(expectation: str) -> PydanticCustomError:
    """The error of a value that is not what it should be; the text says what would be right."""
    return PydanticCustomError("wrong", "{expectation}", {"expectation": expectation})


def si(kind: Kind, value: object, info: ValidationInfo) -> float:
    """A quantity in SI, as the keys of a scene read it."""
    gravity = (info.context or {}).get("gravity", STANDARD_GRAVITY) if kind is LOAD else None
    try:
        return to_si(value, kind, gravity)
    except UnitError as error:
        raise wrong(str(error)) from error


def quantity_schema(kind: Kind) -> dict[str, Any]:
    """The JSON Schema of a quantity."""
    return {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": [kind.example], "x-si": kind.si}


def array_schema(items: dict[str, Any], least: int = 1, most: int | None = None) -> dict[str, Any]:
    """The JSON Schema of a list of so many items."""
    return {"type": "array", "items": items, "minItems": least} | ({} if most is None else {"maxItems": most})


def _quantity(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    return BeforeValidator(partial(si, kind)), WithJsonSchema(quantity_schema(kind))


def above_zero(kind: Kind, value: object, info: ValidationInfo) -> float:
    """A quantity above 0 in SI."""
    number = si(kind, value, info)
    if number <= 0:
        raise wrong("expected more than 0")
    return number


def several(
    one: Callable[[object, ValidationInfo], Any],
    schema: dict[str, Any],
    expectation: str,
    least: int = 1,
    most: int | None = None,
    *,
    single: bool = False,
    once: str = "",
) -> tuple[BeforeValidator, WithJsonSchema]:
    """What annotates a list.

    Args:
        one: reads an item.
        schema: of an item.
        expectation: the message where it is no list of so many items.
        least: how many items it has at least.
        most: how many it has at most.
        single: whether an item alone stands for a list of `least` such items.
        once: the message where an item stands there twice, if that is wrong.
    """

    def validate(value: object, info: ValidationInfo) -> tuple[Any, ...]:
        items = value if isinstance(value, list | tuple) else [value] * least if single else []
        if isinstance(value, str) and not items and least == most == 2:
            one(value, info)  # what is wrong with the value itself comes first
            raise wrong(f"expected a list of two, such as ['{value}', '{value}']")
        if not least <= len(items) <= (most or len(items)):
            raise wrong(expectation)
        read = tuple(one(item, info) for item in items)
        if once and len(set(read)) < len(read):
            raise wrong(once)
        return read

    array = array_schema(schema, least, most)
    if not single:
        return BeforeValidator(validate), WithJsonSchema(array)
    unit = {"x-si": schema["x-si"]} if "x-si" in schema else {}
    return BeforeValidator(validate), WithJsonSchema({"anyOf": [*schema.get("anyOf", [schema]), array]} | unit)


def _list(kind: Kind, count: int | None = None, *, positive: bool = False) -> tuple[BeforeValidator, WithJsonSchema]:
    """What annotates a list of quantities: of so many, or of any number; above 0 where `positive`."""
    number = {None: "", 2: " of two,", 3: " of three,"}[count]
    expectation = f"expected a list{number} such as [{', '.join([repr(kind.example)] * (count or 2))}]"
    return several(partial(above_zero if positive else si, kind), quantity_schema(kind), expectation, count or 1, count)


def _direction(value: object) -> tuple[float, ...]:
    items = value if isinstance(value, list | tuple) else []
    if len(items) != 3 or not all(isinstance(item, int | float) and not isinstance(item, bool) for item in items):
        raise wrong("expected a direction of three numbers such as [0, 0, 1]")
    numbers = tuple(map(plain_number, items))
    if not any(numbers):
        raise wrong("expected a direction such as [0, 0, 1]: all three are 0")
    if not 1e-100 <= max(map(abs, numbers)) <= 1e100:
        raise wrong("expected a direction such as [0, 0, 1]: its largest number lies beyond 1e-100 and 1e100")
    return numbers


def _place(value: object, info: ValidationInfo) -> tuple[float, ...] | str | int:
    """Two or three lengths, the name of a set of nodes, or the number of a node."""
    if isinstance(value, str) and value.strip():
        return _line(value)
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return value
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= 3:
        others = "three lengths in space, the name of a set of nodes or the number of a node"
        raise wrong(f"expected a place such as ['{LENGTH.example}', '{LENGTH.example}'] on a plate, {others}")
    return tuple(si(LENGTH, item, info) for item in value)


def _one_or_two(kind: Kind, *, zero: bool) -> tuple[BeforeValidator, WithJsonSchema]:
    """One value for both of the damper's axes, or a value for each; above 0, or any where `zero`."""
    expectation = f"expected a value such as '{kind.example}', or a list of two, one for each axis"
    return several(partial(si if zero else above_zero, kind), quantity_schema(kind), expectation, 2, 2, single=True)


_TRADE_NAMES = {"titanium": "Ti-6Al-4V", "ti64": "Ti-6Al-4V", "inconel": "Inconel 718", "aluminum": "aluminium"}
"""What people call materials that have an exact name here."""


def one_of(names: tuple[str, ...], value: object, _: ValidationInfo) -> str:
    """Text that is one of these names."""
    if isinstance(value, str) and value in names:
        return value
    meant = _TRADE_NAMES.get(value.lower()) if isinstance(value, str) else None
    hint = did_you_mean(value, names) if isinstance(value, str) else ""
    hint = f": did you mean '{meant}'?" if meant in names else hint
    raise wrong(f"expected one of {', '.join(names)}{hint}")


def name_of(names: tuple[str, ...]) -> tuple[BeforeValidator, WithJsonSchema]:
    """What annotates text that is one of these names."""
    return BeforeValidator(partial(one_of, names)), WithJsonSchema({"enum": list(names)})


def _unit(kind: Kind, what: str, example: str) -> tuple[BeforeValidator, WithJsonSchema]:
    """What annotates the name of a unit."""

    def validate(value: object) -> str:
        text, hint = value if isinstance(value, str) else "", ""
        try:
            if text.strip():
                to_si(f"1 {text}", kind)
                return text
        except UnitError as error:
            _, meant, unit = str(error).partition(", did you mean")
            hint = meant + unit
        raise wrong(f"expected a unit of {what}{hint}")

    return BeforeValidator(validate), WithJsonSchema({"type": "string", "examples": [example]})


def plain_number(value: object) -> float:
    """A finite number without a unit."""
    if isinstance(value, str) and (share := re.fullmatch(r"([0-9.]+) ?%", value)) is not None:
        raise wrong(f"expected a number: {value} is {float(share[1]) / 100:g}")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise wrong("expected a number")
    number = _as_float(value)
    if not math.isfinite(number):
        raise wrong("expected a finite number")
    return number


def _cycles(value: object) -> float | str:
    if value == "auto":
        return "auto"
    if isinstance(value, str):
        raise wrong(f"expected 'auto' or a number of vibration cycles{did_you_mean(value, ['auto'])}")
    number = plain_number(value)
    if not 0 < number <= 1e9:
        raise wrong("expected 'auto' or a number of vibration cycles above 0 and at most 1e9")
    return number


def _auto_length(value: object, info: ValidationInfo) -> float | str:
    return "auto" if value == "auto" else si(LENGTH, value, info)


def _line(value: str) -> str:
    """Text that stays on its line wherever it is printed, and that every file format takes."""
    if not value.isprintable():
        raise wrong("expected one line of text, without control characters")
    return value


def _mesh_file(value: str) -> str:
    if not value.strip():
        raise wrong("expected the name of a mesh file")
    return value


def _switch(value: object) -> bool | str:
    if isinstance(value, bool) or value == "auto":
        return value
    hint = did_you_mean(value, ["auto"]) if isinstance(value, str) else ""
    raise wrong(f"expected 'auto', true or false{hint}")


_CYCLES_SCHEMA = {"anyOf": [{"const": "auto"}, {"type": "number", "exclusiveMinimum": 0}]}

_AUTO_LENGTH_SCHEMA = quantity_schema(LENGTH) | {"examples": ["auto", LENGTH.example]}

AutoLength = Annotated[float | str, BeforeValidator(_auto_length), WithJsonSchema(_AUTO_LENGTH_SCHEMA)]
Number = Annotated[float, BeforeValidator(plain_number)]
Length = Annotated[float, *_quantity(LENGTH)]
Mass = Annotated[float, *_quantity(MASS)]
Angle = Annotated[float, *_quantity(ANGLE)]
Pressure = Annotated[float, *_quantity(PRESSURE)]
LineStiffness = Annotated[float, *_quantity(LINE_STIFFNESS)]
RotationalStiffness = Annotated[float, *_quantity(ROTATIONAL_STIFFNESS)]
Density = Annotated[float, *_quantity(DENSITY)]
LengthUnit = Annotated[str, *_unit(LENGTH, "length such as 'mm'", "mm")]
MassUnit = Annotated[str, *_unit(MASS, "mass such as 'kg' or 't'", "t")]
Acceleration = Annotated[float, *_quantity(ACCELERATION)]
Radii = Annotated[tuple[float, float], *_one_or_two(LENGTH, zero=False)]
Frequencies = Annotated[tuple[float, float], *_one_or_two(FREQUENCY, zero=False)]
Slopes = Annotated[tuple[float, float], *_one_or_two(SLOPE, zero=True)]
LengthPair = Annotated[tuple[float, float], *_list(LENGTH, 2)]
Sides = Annotated[tuple[float, float], *_list(LENGTH, 2, positive=True)]
LengthTriple = Annotated[tuple[float, float, float], *_list(LENGTH, 3)]
Lengths = Annotated[tuple[float, ...], *_list(LENGTH)]
Direction = Annotated[
    tuple[float, float, float], BeforeValidator(_direction), WithJsonSchema(array_schema({"type": "number"}, 3, 3))
]
_LENGTHS = [array_schema(quantity_schema(LENGTH), count, count) for count in (2, 3)]
_NODES = [{"type": "string"}, {"type": "integer", "minimum": 0}]
Place = Annotated[
    tuple[float, ...] | str | int,
    BeforeValidator(_place),
    WithJsonSchema({"anyOf": [*_LENGTHS, *_NODES], "x-si": "m"}),
]
LoadPair = Annotated[tuple[float, float], *_list(LOAD, 2)]
Cycles = Annotated[float | str, BeforeValidator(_cycles), WithJsonSchema(_CYCLES_SCHEMA)]
Switch = Annotated[
    bool | str, BeforeValidator(_switch), WithJsonSchema({"enum": ["auto", True, False], "default": "auto"})
]
Line = Annotated[str, AfterValidator(_line)]
MeshFile = Annotated[Line, AfterValidator(_mesh_file)]
Positive = Field(gt=0)
NotNegative = Field(ge=0)


class Table(BaseModel):
    """A table of the scene: frozen, strict, no unknown keys."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", validate_default=False)
