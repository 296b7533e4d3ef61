"""The table of what shakes the structure: [excitation]."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from workflows.scene import units
from workflows.scene.faults import fault
from workflows.scene.fields import quantity_schema, si, wrong
from workflows.scene.table import Table
from workflows.scene.units import Kind

MOST_LEVELS = 20
"""Heights of a force that are looked at: each is a picture of its own."""


def _levels(kind: Kind) -> tuple[BeforeValidator, WithJsonSchema]:
    """One height above 0, or a list of different ones."""

    def validate(value: object, info: ValidationInfo) -> tuple[float, ...]:
        listed = value if isinstance(value, list | tuple) else [value]
        if not 0 < len(listed) <= MOST_LEVELS:
            raise wrong(f"expected a value such as '{kind.example}', or a list of at most {MOST_LEVELS}")
        found = tuple(si(item, kind, info) for item in listed)
        if min(found) <= 0:
            raise wrong("expected more than 0")
        if len(set(found)) < len(found):
            raise wrong("expected every level once")
        return found

    listed = {"type": "array", "items": quantity_schema(kind), "minItems": 1, "maxItems": MOST_LEVELS}
    return BeforeValidator(validate), WithJsonSchema(
        {"anyOf": [*quantity_schema(kind)["anyOf"], listed], "x-si": kind.si}
    )


def _orders(value: object) -> tuple[int, ...]:
    listed = value if isinstance(value, list | tuple) else [value]
    whole = [item for item in listed if isinstance(item, int) and not isinstance(item, bool) and 1 <= item <= 1000]
    if not whole or len(whole) < len(listed):
        raise wrong("expected a list of whole numbers from 1 to 1000, such as [2, 3]")
    if len(set(whole)) < len(whole):
        raise wrong("expected every order once")
    return tuple(whole)


Forces = Annotated[tuple[float, ...], *_levels(units.FORCE)]
Pressures = Annotated[tuple[float, ...], *_levels(units.SURFACE_PRESSURE)]
Loads = Annotated[tuple[float, ...], *_levels(units.LOAD)]
_ORDER = {"type": "integer", "minimum": 1, "maximum": 1000}
Orders = Annotated[
    tuple[int, ...],
    BeforeValidator(_orders),
    WithJsonSchema({"anyOf": [_ORDER, {"type": "array", "items": _ORDER, "minItems": 1}]}),
]


class Excitation(Table):
    """Harmonic forces whose frequency is a multiple of the rotation's, at one level or several."""

    orders: Orders = Field(
        description="engine orders, frequency over that of the rotation: whole numbers, dimensionless"
    )
    force: Forces | None = Field(
        None,
        description="height of a force at the damper's place along the damper's axis 1: a level, or a list of them",
    )
    pressure: Pressures | None = Field(
        None, description="height of a pressure all over the plate, along its z: a level, or a list of them"
    )
    base: Loads | None = Field(
        None,
        description="height of the root's acceleration along the damper's axis 1: a level, or a list of them;"
        " amplitudes are then relative to the root",
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        """One way of giving the force."""
        given = [key for key in ("force", "pressure", "base") if getattr(self, key) is not None]
        if len(given) != 1:
            found = f"expected one of force, pressure and base{': leave one out' * bool(given)}"
            raise fault(given[-1] if given else "force", found)
        return self

    @property
    def kind(self) -> str:
        """Which of force, pressure and base it is."""
        return next(name for name in ("force", "pressure", "base") if getattr(self, name) is not None)

    @property
    def levels(self) -> tuple[float, ...]:
        """Heights, ascending [N, Pa or m/s²]."""
        found: tuple[float, ...] = getattr(self, self.kind)
        return tuple(sorted(found))

    @property
    def unit(self) -> str:
        """Of the levels."""
        return {"force": "N", "pressure": "Pa", "base": "m/s²"}[self.kind]
