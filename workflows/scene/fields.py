"""The kinds of value a scene holds: what is accepted, what it becomes, what its JSON Schema says."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from workflows.errors import did_you_mean
from workflows.scene import units
from workflows.scene.units import Kind, UnitError

MOST_SPEEDS = 100_000


def wrong(expectation: str) -> PydanticCustomError:
    """The error of a value that is not what it should be; the text says what would be right."""
    return PydanticCustomError("wrong", "{expectation}", {"expectation": expectation})


def _si(value: object, kind: Kind, info: ValidationInfo) -> float:
    gravity = (info.context or {}).get("gravity", units.STANDARD_GRAVITY) if kind is units.LOAD else None
    try:
        return units.to_si(value, kind, gravity)
    except UnitError as error:
        raise wrong(str(error)) from error


def length(value: object, info: ValidationInfo) -> float:
    """A length in SI, as the fields of a scene read it."""
    return _si(value, units.LENGTH, info)


def quantity_schema(kind: Kind) -> dict[str, Any]:
    """The JSON Schema of a quantity."""
    return _json(kind)


def _json(kind: Kind) -> dict[str, Any]:
    return {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": [kind.example], "x-si": kind.si}


def _quantity(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    def validate(value: object, info: ValidationInfo) -> float:
        return _si(value, kind, info)

    return BeforeValidator(validate), WithJsonSchema(_json(kind))


def _pair(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    def validate(value: object, info: ValidationInfo) -> tuple[float, float]:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise wrong(f"expected a list of two, such as ['{kind.example}', '{kind.example}']")
        return _si(value[0], kind, info), _si(value[1], kind, info)

    schema = {"type": "array", "items": _json(kind), "minItems": 2, "maxItems": 2}
    return BeforeValidator(validate), WithJsonSchema(schema)


def _one_or_two(kind: Kind, *, zero: bool) -> tuple[BeforeValidator, WithJsonSchema]:
    """One value for both of the damper's axes, or a value for each; above 0, or any where `zero`."""

    def validate(value: object, info: ValidationInfo) -> tuple[float, float]:
        both = value if isinstance(value, list | tuple) else [value, value]
        if len(both) != 2:
            raise wrong(f"expected a value such as '{kind.example}', or a list of two, one for each axis")
        x, y = (_si(item, kind, info) for item in both)
        if not zero and min(x, y) <= 0:
            raise wrong("expected more than 0")
        return x, y

    pair = {"type": "array", "items": _json(kind), "minItems": 2, "maxItems": 2}
    return BeforeValidator(validate), WithJsonSchema({"anyOf": [*_json(kind)["anyOf"], pair], "x-si": kind.si})


def _row(value: object, kind: Kind, info: ValidationInfo) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or not value:
        raise wrong(f"expected a list such as ['{kind.example}', '{kind.example}']")
    return tuple(_si(item, kind, info) for item in value)


def _levels(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    """One height above 0, or a list of different ones."""

    def validate(value: object, info: ValidationInfo) -> tuple[float, ...]:
        listed = value if isinstance(value, list | tuple) else [value]
        if not 0 < len(listed) <= MOST_LEVELS:
            raise wrong(f"expected a value such as '{kind.example}', or a list of at most {MOST_LEVELS}")
        found = tuple(_si(item, kind, info) for item in listed)
        if min(found) <= 0:
            raise wrong("expected more than 0")
        if len(set(found)) < len(found):
            raise wrong("expected every level once")
        return found

    listed = {"type": "array", "items": _json(kind), "minItems": 1, "maxItems": MOST_LEVELS}
    return BeforeValidator(validate), WithJsonSchema({"anyOf": [*_json(kind)["anyOf"], listed], "x-si": kind.si})


MOST_LEVELS = 20
"""Heights of a force that are looked at: each is a picture of its own."""


def _orders(value: object) -> tuple[int, ...]:
    listed = value if isinstance(value, list | tuple) else [value]
    whole = [item for item in listed if isinstance(item, int) and not isinstance(item, bool) and 1 <= item <= 1000]
    if not whole or len(whole) < len(listed):
        raise wrong("expected a list of whole numbers from 1 to 1000, such as [2, 3]")
    if len(set(whole)) < len(whole):
        raise wrong("expected every order once")
    return tuple(whole)


def _lengths(value: object, info: ValidationInfo) -> tuple[float, ...]:
    return _row(value, units.LENGTH, info)


def _length_rows(value: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Rows of lengths; of a plain list each is a row of its own."""
    if not isinstance(value, list | tuple) or not value:
        raise wrong("expected a list of lists of lengths, one list for each x")
    return tuple(_row(row if isinstance(row, list | tuple) else [row], units.LENGTH, info) for row in value)


MOST_COEFFICIENTS = 12
"""Of a polynomial, along x and along y: in powers of metres higher ones drown in rounding."""


def _coefficients(value: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Rows i of coefficients j of x^i y^j, each a length to the power 1 - i - j."""
    if not isinstance(value, list | tuple) or not value or not all(isinstance(r, list | tuple) and r for r in value):
        raise wrong("expected a list of lists, of x^i y^j the coefficient j in list i: [['5 mm'], ['-0.01 mm/mm']]")
    if max(len(value), *map(len, value)) > MOST_COEFFICIENTS:
        raise wrong(f"expected at most {MOST_COEFFICIENTS} lists of at most {MOST_COEFFICIENTS} coefficients")
    return tuple(
        tuple(_si(item, units.length_power(1 - i - j), info) for j, item in enumerate(row))
        for i, row in enumerate(value)
    )


FASTEST = 1e5
"""Largest rotation speed taken [rad/s]: above it no plate holds, and rounding would answer for physics."""


def name_of(names: tuple[str, ...]) -> tuple[BeforeValidator, WithJsonSchema]:
    """What annotates text that is one of these names."""

    def validate(value: object) -> str:
        if isinstance(value, str) and value in names:
            return value
        hint = did_you_mean(value, names) if isinstance(value, str) else ""
        raise wrong(f"expected one of {', '.join(names)}{hint}")

    return BeforeValidator(validate), WithJsonSchema({"enum": list(names)})


def _length_unit(value: object) -> str:
    text, hint = value if isinstance(value, str) else "", ""
    try:
        if text.strip():
            units.to_si(f"1 {text}", units.LENGTH)
            return text
    except UnitError as error:
        found = str(error)
        hint = found[found.rindex(", did") :] if "did you mean" in found else ""
    raise wrong(f"expected a unit of length such as 'mm'{hint}")


def _speeds(value: object, info: ValidationInfo) -> tuple[float, ...]:
    if isinstance(value, dict):
        speeds = _ladder(value, info)
    elif isinstance(value, list | tuple) and value:
        speeds = [_si(item, units.ROTATION, info) for item in value]
    else:
        raise wrong("expected a list such as ['3500 rpm'] or { start = '0 rpm', stop = '9000 rpm', count = 10 }")
    if any(speed < 0 for speed in speeds):
        raise wrong("a rotation speed must not be negative")
    if any(speed > FASTEST for speed in speeds):
        raise wrong(f"expected speeds up to {FASTEST:g} rad/s, about a million rpm")
    if len(speeds) > MOST_SPEEDS:
        raise wrong(f"expected at most {MOST_SPEEDS} speeds")
    if len(set(speeds)) < len(speeds):
        raise wrong("expected every speed once")
    return tuple(speeds)


def _ladder(value: dict[str, object], info: ValidationInfo) -> list[float]:
    names = ("start", "stop", "count")
    unknown = [name for name in value if name not in names]
    if unknown:
        listed = ", ".join(f"'{name}'" for name in unknown)
        hint = did_you_mean(unknown[0], names) if len(unknown) == 1 else ""
        raise wrong(f"unknown key {listed}{hint or ': expected start, stop and count'}")
    for name in names:
        if name not in value:
            raise wrong(f"'{name}' is missing: expected start, stop and count")
    start, stop = _si(value["start"], units.ROTATION, info), _si(value["stop"], units.ROTATION, info)
    count = value["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_SPEEDS:
        raise wrong(f"count: expected a whole number from 1 to {MOST_SPEEDS}")
    if count > 1 and not stop > start:
        raise wrong("stop: expected a speed above start")
    if count == 1 and stop != start:
        raise wrong("count: expected at least 2, or stop equal to start: a single speed leaves stop out")
    return [start + (stop - start) * i / max(count - 1, 1) for i in range(count)]


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise wrong("expected a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise wrong("expected a finite number")
    return number


def _cycles(value: object) -> float | str:
    if value == "auto":
        return "auto"
    if isinstance(value, str):
        raise wrong(f"expected 'auto' or a number of vibration cycles{did_you_mean(value, ['auto'])}")
    number = _number(value)
    if not 0 < number <= 1e9:
        raise wrong("expected 'auto' or a number of vibration cycles above 0 and at most 1e9")
    return number


def _line(value: str) -> str:
    """Text that stays on its line wherever it is printed, and that every file format takes."""
    if not value.isprintable():
        raise wrong("expected one line of text, without control characters")
    return value


def _switch(value: object) -> bool | str:
    if isinstance(value, bool) or value == "auto":
        return value
    hint = did_you_mean(value, ["auto"]) if isinstance(value, str) else ""
    raise wrong(f"expected 'auto', true or false{hint}")


_SPEEDS_SCHEMA = {
    "anyOf": [
        {"type": "array", "items": _json(units.ROTATION), "minItems": 1},
        {
            "type": "object",
            "properties": {
                "start": _json(units.ROTATION),
                "stop": _json(units.ROTATION),
                "count": {"type": "integer", "minimum": 1},
            },
            "required": ["start", "stop", "count"],
            "additionalProperties": False,
        },
    ]
}
_CYCLES_SCHEMA = {"anyOf": [{"const": "auto"}, {"type": "number", "exclusiveMinimum": 0}]}

Number = Annotated[float, BeforeValidator(_number)]
Length = Annotated[float, *_quantity(units.LENGTH)]
Mass = Annotated[float, *_quantity(units.MASS)]
Angle = Annotated[float, *_quantity(units.ANGLE)]
Frequency = Annotated[float, *_quantity(units.FREQUENCY)]
Pressure = Annotated[float, *_quantity(units.PRESSURE)]
LineStiffness = Annotated[float, *_quantity(units.LINE_STIFFNESS)]
RotationalStiffness = Annotated[float, *_quantity(units.ROTATIONAL_STIFFNESS)]
Density = Annotated[float, *_quantity(units.DENSITY)]
LengthUnit = Annotated[str, BeforeValidator(_length_unit), WithJsonSchema({"type": "string", "examples": ["mm"]})]
Acceleration = Annotated[float, *_quantity(units.ACCELERATION)]
Radii = Annotated[tuple[float, float], *_one_or_two(units.LENGTH, zero=False)]
Frequencies = Annotated[tuple[float, float], *_one_or_two(units.FREQUENCY, zero=False)]
Slopes = Annotated[tuple[float, float], *_one_or_two(units.SLOPE, zero=True)]
Forces = Annotated[tuple[float, ...], *_levels(units.FORCE)]
Pressures = Annotated[tuple[float, ...], *_levels(units.SURFACE_PRESSURE)]
Loads = Annotated[tuple[float, ...], *_levels(units.LOAD)]
_ORDER = {"type": "integer", "minimum": 1, "maximum": 1000}
Orders = Annotated[
    tuple[int, ...],
    BeforeValidator(_orders),
    WithJsonSchema({"anyOf": [_ORDER, {"type": "array", "items": _ORDER, "minItems": 1}]}),
]
LengthPair = Annotated[tuple[float, float], *_pair(units.LENGTH)]
Lengths = Annotated[
    tuple[float, ...],
    BeforeValidator(_lengths),
    WithJsonSchema({"type": "array", "items": _json(units.LENGTH), "minItems": 1}),
]
_ROWS = {"type": "array", "items": _json(units.LENGTH), "minItems": 1}
LengthRows = Annotated[
    tuple[tuple[float, ...], ...],
    BeforeValidator(_length_rows),
    WithJsonSchema({"type": "array", "items": {"anyOf": [_json(units.LENGTH), _ROWS]}, "minItems": 1}),
]
_COEFFICIENT = {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": ["5 mm", "-0.01 mm/mm"]}
Coefficients = Annotated[
    tuple[tuple[float, ...], ...],
    BeforeValidator(_coefficients),
    WithJsonSchema(
        {
            "type": "array",
            "items": {"type": "array", "items": _COEFFICIENT, "minItems": 1, "maxItems": MOST_COEFFICIENTS},
            "minItems": 1,
            "maxItems": MOST_COEFFICIENTS,
        }
    ),
]
LoadPair = Annotated[tuple[float, float], *_pair(units.LOAD)]
Speeds = Annotated[tuple[float, ...], BeforeValidator(_speeds), WithJsonSchema(_SPEEDS_SCHEMA)]
Cycles = Annotated[float | str, BeforeValidator(_cycles), WithJsonSchema(_CYCLES_SCHEMA)]
Switch = Annotated[
    bool | str, BeforeValidator(_switch), WithJsonSchema({"enum": ["auto", True, False], "default": "auto"})
]
Line = Annotated[str, AfterValidator(_line)]
Positive = Field(gt=0)
NotNegative = Field(ge=0)
