"""The kinds of value a scene holds: what is accepted, what it becomes, what its JSON Schema says."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from workflows.errors import did_you_mean
from workflows.scene import units
from workflows.scene.units import Kind, UnitError


def wrong(expectation: str) -> PydanticCustomError:
    """The error of a value that is not what it should be; the text says what would be right."""
    return PydanticCustomError("wrong", "{expectation}", {"expectation": expectation})


def si(value: object, kind: Kind, info: ValidationInfo) -> float:
    """A quantity in SI, as the keys of a scene read it."""
    gravity = (info.context or {}).get("gravity", units.STANDARD_GRAVITY) if kind is units.LOAD else None
    try:
        return units.to_si(value, kind, gravity)
    except UnitError as error:
        raise wrong(str(error)) from error


def quantity_schema(kind: Kind) -> dict[str, Any]:
    """The JSON Schema of a quantity."""
    return {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": [kind.example], "x-si": kind.si}


def _quantity(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    def validate(value: object, info: ValidationInfo) -> float:
        return si(value, kind, info)

    return BeforeValidator(validate), WithJsonSchema(quantity_schema(kind))


def _pair(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    def validate(value: object, info: ValidationInfo) -> tuple[float, float]:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise wrong(f"expected a list of two, such as ['{kind.example}', '{kind.example}']")
        return si(value[0], kind, info), si(value[1], kind, info)

    schema = {"type": "array", "items": quantity_schema(kind), "minItems": 2, "maxItems": 2}
    return BeforeValidator(validate), WithJsonSchema(schema)


def _one_or_two(kind: Kind, *, zero: bool) -> tuple[BeforeValidator, WithJsonSchema]:
    """One value for both of the damper's axes, or a value for each; above 0, or any where `zero`."""

    def validate(value: object, info: ValidationInfo) -> tuple[float, float]:
        both = value if isinstance(value, list | tuple) else [value, value]
        if len(both) != 2:
            raise wrong(f"expected a value such as '{kind.example}', or a list of two, one for each axis")
        x, y = (si(item, kind, info) for item in both)
        if not zero and min(x, y) <= 0:
            raise wrong("expected more than 0")
        return x, y

    pair = {"type": "array", "items": quantity_schema(kind), "minItems": 2, "maxItems": 2}
    return BeforeValidator(validate), WithJsonSchema(
        {"anyOf": [*quantity_schema(kind)["anyOf"], pair], "x-si": kind.si}
    )


def quantities(value: object, kind: Kind, info: ValidationInfo) -> tuple[float, ...]:
    """A list of quantities in SI."""
    if not isinstance(value, list | tuple) or not value:
        raise wrong(f"expected a list such as ['{kind.example}', '{kind.example}']")
    return tuple(si(item, kind, info) for item in value)


def _lengths(value: object, info: ValidationInfo) -> tuple[float, ...]:
    return quantities(value, units.LENGTH, info)


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
LengthPair = Annotated[tuple[float, float], *_pair(units.LENGTH)]
Lengths = Annotated[
    tuple[float, ...],
    BeforeValidator(_lengths),
    WithJsonSchema({"type": "array", "items": quantity_schema(units.LENGTH), "minItems": 1}),
]
LoadPair = Annotated[tuple[float, float], *_pair(units.LOAD)]
Cycles = Annotated[float | str, BeforeValidator(_cycles), WithJsonSchema(_CYCLES_SCHEMA)]
Switch = Annotated[
    bool | str, BeforeValidator(_switch), WithJsonSchema({"enum": ["auto", True, False], "default": "auto"})
]
Line = Annotated[str, AfterValidator(_line)]
Positive = Field(gt=0)
NotNegative = Field(ge=0)
