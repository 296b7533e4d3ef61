"""The tables of what spins, what is counted and how exactly: [structure], [rotor], [effects], [accuracy]."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from workflows.errors import did_you_mean
from workflows.scene import quantities
from workflows.scene.quantities import (
    ROUNDING,
    Acceleration,
    Angle,
    Frequencies,
    Length,
    Mass,
    NotNegative,
    Number,
    Positive,
    Slopes,
    Switch,
    Table,
    fault,
    quantity_schema,
    si,
    wrong,
)

MOST_SPEEDS = 100_000

FASTEST = 1e5
"""Largest rotation speed taken [rad/s]: above it no plate holds, and rounding would answer for physics."""


def typed(rpm: float) -> float:
    """A speed as somebody types it: 4500, where the command line has made 4500.0 of it."""
    return int(rpm) if float(rpm).is_integer() else rpm


def _speeds(value: object, info: ValidationInfo) -> tuple[float, ...]:
    if isinstance(value, dict):
        speeds = _ladder(value, info)
    elif isinstance(value, list | tuple) and value:
        speeds = [si(quantities.ROTATION, item, info) for item in value]
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
    _whole(value)
    start, stop = si(quantities.ROTATION, value["start"], info), si(quantities.ROTATION, value["stop"], info)
    count = value["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_SPEEDS:
        raise wrong(f"count: expected a whole number from 1 to {MOST_SPEEDS}")
    if count > 1 and not stop > start:
        raise wrong("stop: expected a speed above start")
    if count == 1 and stop != start:
        raise wrong("count: expected at least 2, or stop equal to start: a single speed leaves stop out")
    return [start + (stop - start) * i / max(count - 1, 1) for i in range(count)]


def _whole(value: dict[str, object]) -> None:
    """All three keys, and no other."""
    names = ("start", "stop", "count")
    unknown = [name for name in value if name not in names]
    if unknown:
        listed = ", ".join(f"'{name}'" for name in unknown)
        hint = did_you_mean(unknown[0], names) if len(unknown) == 1 else ""
        raise wrong(f"unknown key {listed}{hint or ': expected start, stop and count'}")
    for name in names:
        if name not in value:
            raise wrong(f"'{name}' is missing: expected start, stop and count")


_SPEEDS_SCHEMA = {
    "anyOf": [
        {"type": "array", "items": quantity_schema(quantities.ROTATION), "minItems": 1},
        {
            "type": "object",
            "properties": {
                "start": quantity_schema(quantities.ROTATION),
                "stop": quantity_schema(quantities.ROTATION),
                "count": {"type": "integer", "minimum": 1},
            },
            "required": ["start", "stop", "count"],
            "additionalProperties": False,
        },
    ]
}

Speeds = Annotated[tuple[float, ...], BeforeValidator(_speeds), WithJsonSchema(_SPEEDS_SCHEMA)]


FINEST = 1e-10
"""Least relative error of a frequency that double precision gives: its 1e-16 times a stiffness matrix's condition."""


class Structure(Table):
    """What the damper sitting on it needs to know, instead of a plate."""

    frequency: Frequencies = Field(
        description="ω1 / 2π, with the ball stuck: one for both of the damper's axes, or one along each"
    )
    mass: Annotated[Mass, Positive] = Field(description="M2: effective mass at the damper, without the ball")
    floor_tilt: Slopes = Field(
        (0.0, 0.0),
        description="slope of the cavity's floor over the displacement: one for both of the damper's axes, or one along"
        " each",
    )


_LARGEST_HUB = 20.0
"""Radius [m] at which no blade is clamped: the largest hubs, those of wind turbines, have 3 m."""


class Rotor(Table):
    """How the structure spins."""

    speeds: Speeds = Field(description="rotation speeds: a list, or count of them from start to stop")
    hub_radius: Annotated[Length, NotNegative] = Field(
        0.0, description="from the axis to the clamped root, wherever a mesh draws the root"
    )
    radius: Annotated[Length, Positive] | None = Field(
        None, description="from the axis to the damper; only with [structure]"
    )
    stagger: Angle = Field(0.0, description="spin axis tilted from the plate's normal towards y")
    precone: Angle = Field(
        0.0, description="of the plate's length out of the plane of rotation, towards the axis; after the stagger"
    )
    gravity: Annotated[Acceleration, Positive] = Field(
        quantities.STANDARD_GRAVITY, description="the unit g of loads and accelerations"
    )
    modes: Annotated[int, Field(ge=1, le=200)] = Field(6, description="number of modes at each speed")

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


class Effects(Table):
    """Which effects to simulate: "auto" (when the scene calls for it), true or false."""

    stress_stiffening: Switch = Field(default="auto", description="the centrifugal pull stiffens the plate")
    spin_softening: Switch = Field(default="auto", description="motion across the spin axis is softened")
    coriolis: Switch = Field(default="auto", description="Coriolis forces; the modes are complex")
    large_deflection: Switch = Field(default="auto", description="modes about the plate as the load bends or twists it")
    rotary_inertia: Switch = Field(default="auto", description="inertia of the turning cross-sections")
    rolling_resistance: Switch = Field(default="auto", description="the load resists the ball's rolling")
    impact_friction: Switch = Field(default="auto", description="friction where the ball hits a wall")
    ball_slip: Switch = Field(default="auto", description="slip after a wall hit, until the ball rolls again")
    floor_tilt: Switch = Field(default="auto", description="the cavity's floor tilts as the structure bends")
    structural_modes: Switch = Field(
        default="auto",
        description="the cavity moves with the plate's own modes; false: one frequency on both axes, as in the paper",
    )


class Accuracy(Table):
    """Relative errors asked for."""

    frequency: Annotated[Number, Field(gt=0, ge=FINEST, lt=1)] = Field(
        default=1e-3,
        description="relative error of the plate's frequencies, dimensionless; no less than double precision can give",
    )
    damping: Annotated[Number, Field(gt=0, lt=1)] = Field(
        default=1e-3, description="relative error of the damping, dimensionless"
    )
