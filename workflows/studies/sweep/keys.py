"""The keys of a scene, each by its dotted path: what it accepts, in which unit, and how it is set."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, TypeAlias

from pydantic import BaseModel, TypeAdapter, ValidationError

from workflows.errors import BadInput, did_you_mean
from workflows.scene.design import FLAT
from workflows.scene.explained import worded
from workflows.scene.scene import Scene
from workflows.scene.schema import unit

Value: TypeAlias = float | int | bool | str
"""What a key holds at a point: a number in SI, a switch, or a word."""

Data: TypeAlias = dict[str, Any]
"""A scene as plain data, table by table."""

SPEEDS = "rotor.speeds"
CLEARANCE = "damper.clearance"
"""No key of a scene: a cavity's sides less the ball's diameter, along both axes or one."""

_INSTEAD = (
    ("damper", ("mass_ratio", "mass", "ball_density", "ball_material")),
    ("release", ("displacement", "acceleration", "ratio")),
    ("material", ("name", "youngs_modulus")),
    ("material", ("name", "poissons_ratio")),
    ("material", ("name", "density")),
)
"""Keys of a table of which one takes the place of the others."""

_ELEMENTS = 2


@dataclass(frozen=True)
class Key:
    """A key of a scene, or one of the two elements of a pair.

    Attributes:
        name: as users write it, such as ``damper.cavity[0]``.
        table: the tables that lead to it; field: its own name; element: which of a pair, None: the value itself.
        unit: SI; empty where it has none.
    """

    name: str
    table: tuple[str, ...]
    field: str
    element: int | None
    unit: str

    def read(self, value: object, gravity: float) -> Value:
        """A value of this key in SI.

        Raises:
            ValueError: it is none; the message says what would be right.
        """
        if self.field == "floor_radius" and value in (FLAT, math.inf):
            return math.inf
        found = _validated(self, value, gravity)
        if isinstance(found, tuple):
            if self.field != "speeds" and self.element is None and found[0] != found[-1]:
                raise ValueError(f"expected one value: vary {self.name}[0] and {self.name}[1]")
            found = found[self.element or 0]
        if self.field == "clearance" and not found > 0:
            raise ValueError("expected more than 0")
        if not isinstance(found, bool | int | float | str):
            raise ValueError("expected one value")
        return found

    @property
    def whole(self) -> bool:
        """Whether it takes whole numbers."""
        return _schema(".".join((*self.table, self.field))).get("type") == "integer"

    def instead_of(self) -> set[str]:
        """Names of the keys that say the same, so that only one of them can be varied."""
        groups = [names for table, names in _INSTEAD if self.table == (table,) and self.field in names]
        found = {f"{self.table[0]}.{other}" for names in groups for other in names}
        pair = {"clearance": "cavity", "cavity": "clearance"}.get(self.field)
        for field in [self.field, *([pair] if pair else [])]:
            path = ".".join((*self.table, field))
            ends = ["", "[0]", "[1]"] if self.element is None else ["", f"[{self.element}]"]
            found |= {f"{path}{end}" for end in ends}
        return found - {self.name}

    def displaced(self, scene: Scene) -> str | None:
        """Name of the key of a scene that it takes the place of; a material's numbers are changed one by one."""
        for table, names in _INSTEAD:
            given = getattr(scene, table)
            if self.table == (table,) and self.field in names and table != "material" and given is not None:
                there = [name for name in names if getattr(given, name) is not None]
                return f"{table}.{there[-1]}" if self.field not in there else None
        return None

    def put(self, data: Data, value: Value) -> None:
        """Set it in a scene's plain data; what it takes the place of goes."""
        place = data
        for name in self.table:
            place = place.setdefault(name, {})
        for table, names in _INSTEAD:
            if self.table == (table,) and self.field in names:
                for other in names:
                    if other != self.field:
                        place.pop(other, None)
        if self.name.startswith(CLEARANCE):
            sides = range(_ELEMENTS) if self.element is None else [self.element]
            for side in sides:
                place["cavity"][side] = 2 * place["radius"] + float(value)
        elif value == math.inf:
            place.pop(self.field, None)
        elif self.field == "speeds":
            place[self.field] = [value]
        elif self.element is None and _is_pair(".".join((*self.table, self.field))):
            place[self.field] = [value] * _ELEMENTS
        elif self.element is not None:
            place[self.field] = _with(place.get(self.field), self.element, value)
        else:
            place[self.field] = value


def find(name: str, where: str) -> Key:
    """The key of a dotted name, such as ``damper.radius``.

    Args:
        name: as a user wrote it.
        where: what the message calls it by, such as ``--vary``.

    Raises:
        BadInput: there is none; with the one that was probably meant.
    """
    path, _, rest = name.partition("[")
    parts = path.split(".")
    element = None
    if rest:
        if rest not in ("0]", "1]"):
            raise BadInput("expected an element [0] or [1], along the damper's axes 1 and 2", key=f"{where} {name}")
        element = int(rest[0])
    if path == CLEARANCE:
        return Key(name, ("damper",), "clearance", element, "m")
    if path not in every():
        raise BadInput(f"unknown key{_meant(path)}", key=f"{where} {name}")
    key = Key(name, tuple(parts[:-1]), parts[-1], element, unit(_schema(path)) or "")
    if element is not None and not _is_pair(path):
        raise BadInput(f"has no elements: expected {path}", key=f"{where} {name}")
    return key


@cache
def every() -> tuple[str, ...]:
    """All keys of a scene's tables by dotted path."""
    return tuple(name for name, _ in _walk(Scene, ()) if "." in name and not name.startswith("design."))


def _walk(table: type[BaseModel], path: tuple[str, ...]) -> list[tuple[str, Any]]:
    found = []
    for name, field in table.model_fields.items():
        here = (*path, name)
        found.append((".".join(here), field))
        for inner in _tables(field.annotation):
            found += _walk(inner, here)
    return found


def _tables(kind: Any) -> list[type[BaseModel]]:
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind]
    return [table for part in getattr(kind, "__args__", ()) for table in _tables(part)]


@cache
def _adapter(path: str) -> TypeAdapter[Any]:
    if path == CLEARANCE:
        path = "damper.cavity"
    field = dict(_walk(Scene, ()))[path]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    return TypeAdapter(kind)


@cache
def _schema(path: str) -> dict[str, Any]:
    return _adapter(path).json_schema()


@cache
def _is_pair(path: str) -> bool:
    return "'maxItems': 2" in str(_schema(path))


def _validated(key: Key, value: object, gravity: float) -> Any:
    """The value as the scene's own field reads it, in SI."""
    path = ".".join((*key.table, key.field))
    tries: list[object] = [[value], value] if key.field == "speeds" else [value]
    if path == CLEARANCE or _is_pair(path):
        tries = [[value, value]]
    first: ValidationError | None = None
    for attempt in tries:
        try:
            return _adapter(path).validate_python(attempt, strict=True, context={"gravity": gravity})
        except ValidationError as error:
            first = first or error
    if first is None:
        raise ValueError("expected a value")
    raise ValueError(_problem(first)) from first


def _problem(error: ValidationError) -> str:
    return worded(error.errors(include_url=False)[0], [""])


def _meant(path: str) -> str:
    """What was probably meant by an unknown key: the same name in another table before a like name."""
    table, _, field = path.rpartition(".")
    homes = [name for name in every() if name.rpartition(".")[2] == field]
    if homes and table not in {name.rpartition(".")[0] for name in every()}:
        return did_you_mean(path, homes) or f": did you mean '{homes[0]}'?"
    if homes:
        return f": did you mean '{homes[0]}'?"
    if field in ("speed", "rpm"):
        return f": did you mean '{SPEEDS}'?"
    if field in ("diameter", "ball_diameter"):
        return ": a ball is given by its radius: did you mean 'damper.radius'?"
    return did_you_mean(path, (*every(), CLEARANCE)) or f": expected a key of a table, such as {SPEEDS}"


def _with(pair: Any, element: int, value: Value) -> list[Any]:
    both = list(pair) if isinstance(pair, list | tuple) else [0.0 if pair is None else pair] * _ELEMENTS
    both[element] = value
    return both
