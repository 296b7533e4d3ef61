"""The table of what a designer is free to choose, and of what is given: [design]."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from workflows.errors import did_you_mean
from workflows.scene import materials
from workflows.scene.faults import fault
from workflows.scene.fields import (
    Length,
    LengthPair,
    Lengths,
    Mass,
    NotNegative,
    Positive,
    quantity_schema,
    si,
    wrong,
)
from workflows.scene.table import Table
from workflows.scene.units import LENGTH

FLAT = "flat"
"""A floor without a radius."""


def _floors(value: object, info: ValidationInfo) -> tuple[float | str, ...]:
    if not isinstance(value, list | tuple) or not value:
        raise wrong(f"expected a list such as ['{FLAT}', '8 mm', '64 mm']")
    return tuple(_floor(item, info) for item in value)


def _floor(value: object, info: ValidationInfo) -> float | str:
    if value == FLAT:
        return FLAT
    if isinstance(value, str) and (hint := did_you_mean(value, [FLAT])):
        raise wrong(f"expected '{FLAT}' or a length such as '8 mm'{hint}")
    return si(value, LENGTH, info)


def _materials(value: object) -> tuple[str, ...]:
    if not isinstance(value, list | tuple) or not value:
        raise wrong("expected a list such as ['steel', 'lead']")
    for item in value:
        if item not in materials.BALLS:
            hint = did_you_mean(item, materials.BALLS) if isinstance(item, str) else ""
            raise wrong(f"expected names out of {', '.join(materials.BALLS)}{hint}")
    return tuple(value)


def _counts(value: object) -> tuple[int, ...]:
    items = list(value) if isinstance(value, list | tuple) else []
    if not items or any(isinstance(item, bool) or not isinstance(item, int) or item < 1 for item in items):
        raise wrong("expected a list of whole numbers from 1 on")
    return tuple(items)


_FLOOR = {"anyOf": [{"const": FLAT}, *quantity_schema(LENGTH)["anyOf"]], "x-si": "m"}

Floors = Annotated[
    tuple[float | str, ...],
    BeforeValidator(_floors),
    WithJsonSchema({"type": "array", "items": _FLOOR, "minItems": 1}),
]
Materials = Annotated[
    tuple[str, ...],
    BeforeValidator(_materials),
    WithJsonSchema({"type": "array", "items": {"enum": list(materials.BALLS)}, "minItems": 1}),
]
Counts = Annotated[
    tuple[int, ...],
    BeforeValidator(_counts),
    WithJsonSchema({"type": "array", "items": {"type": "integer", "minimum": 1}, "minItems": 1}),
]


class Design(Table):
    """What `spindamp design` may choose, and what limits it: a pair is a range, any other list a choice."""

    ball_material: Materials | None = Field(None, description="names of materials to choose from")
    ball_diameter: Lengths | None = Field(None, description="of a ball")
    clearance: Lengths | None = Field(None, description="of the cavity beyond the ball's diameter, along both axes")
    floor_radius: Floors | None = Field(None, description="of the cavity's floor; with 'flat' in it a choice")
    count: Counts | None = Field(None, description="of balls, each in a cavity of its own")
    place: Lengths | None = Field(None, description="of the damper along the plate: x of damper.at")
    mass: Annotated[Mass, Positive] | None = Field(None, description="of all balls together, at most")
    wall: Annotated[Length, NotNegative] = Field(
        0.0, description="left of the plate on either side of the cavity, through the thickness, at least"
    )
    amplitude: LengthPair | None = Field(
        None,
        description="range of amplitudes at the cavity over which the least damping counts; default: with [excitation],"
        " the greatest amplitude at the crossings counts",
    )

    @model_validator(mode="after")
    def _sense(self) -> Self:
        if self.amplitude is not None and not 0 < self.amplitude[0] < self.amplitude[1]:
            raise fault("amplitude", "expected a range of amplitudes above 0, ascending")
        free = ("ball_material", "ball_diameter", "clearance", "floor_radius", "count", "place")
        if not any(getattr(self, name) is not None for name in free):
            raise fault("ball_diameter", f"nothing is free: expected one of {', '.join(free)}")
        for name in ("ball_diameter", "clearance", "place"):
            given = getattr(self, name)
            if given is not None and (min(given) <= 0 or (len(given) == 2 and not given[0] < given[1])):
                raise fault(name, "expected lengths above 0, of a range ascending")
        return self
