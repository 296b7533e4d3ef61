"""Rotation speeds, as a list or as a count of them from start to stop."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from workflows.errors import did_you_mean
from workflows.scene import units
from workflows.scene.fields import quantity_schema, si, wrong

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
        speeds = [si(item, units.ROTATION, info) for item in value]
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
    start, stop = si(value["start"], units.ROTATION, info), si(value["stop"], units.ROTATION, info)
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
        {"type": "array", "items": quantity_schema(units.ROTATION), "minItems": 1},
        {
            "type": "object",
            "properties": {
                "start": quantity_schema(units.ROTATION),
                "stop": quantity_schema(units.ROTATION),
                "count": {"type": "integer", "minimum": 1},
            },
            "required": ["start", "stop", "count"],
            "additionalProperties": False,
        },
    ]
}

Speeds = Annotated[tuple[float, ...], BeforeValidator(_speeds), WithJsonSchema(_SPEEDS_SCHEMA)]
