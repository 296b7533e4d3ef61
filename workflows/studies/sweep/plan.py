"""What is varied, and the points of a study.

A key goes over listed values or over a range, as ``--vary KEY=…`` or a dict of Python has it. Points are known by their
absolute index, over a grid or a sample, and each has a scene.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Mapping, Sequence, Sized
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Annotated, Any, TypeAlias

import numpy as np
import numpy.typing as npt
from pydantic import TypeAdapter, ValidationError

from workflows.errors import BadInput, did_you_mean, shown
from workflows.scene.load import SceneFile, error_text, instead, keys, parse, speed_remarks, unit
from workflows.scene.materials import KNOWN, NUMBERS
from workflows.scene.scene import FLAT, Scene
from workflows.solve.results import Floats

Value: TypeAlias = float | int | bool | str
"""What a key holds at a point: a number in SI, a switch, or a word."""

Data: TypeAlias = dict[str, Any]
"""A scene as plain data, table by table."""

SPEEDS = "rotor.speeds"
CLEARANCE = "damper.clearance"
"""No key of a scene: a cavity's sides less the ball's diameter, along both axes or one."""

SAMPLE = "sample"
"""The dimension of a sample."""

MOST = 10**7
"""Points of a study, and values along an axis: 40 hours of one core with `--quick`, and 4 GB of columns."""

_ALTERNATIVES = {
    "damper": ("mass_ratio", "mass", "ball_density", "ball_material"),
    "release": ("displacement", "acceleration", "ratio"),
}
"""Keys of a table of which one takes the place of the others, beside a material's name and its numbers."""


@dataclass(frozen=True)
class Key:
    """A key of a scene, or one of the two elements of a pair.

    Attributes:
        name: as users write it, such as ``damper.cavity[0]``; path: the same without the element.
        element: which of a pair, None: the value itself.
    """

    name: str
    path: str
    element: int | None = None

    @property
    def table(self) -> str:
        """The outermost table that it stands in."""
        return self.path.partition(".")[0]

    @property
    def field(self) -> str:
        """Its name in the innermost table."""
        return self.path.rpartition(".")[2]

    @property
    def unit(self) -> str:
        """SI; empty where it has none."""
        return unit(_schema(self.path)) or ""

    @property
    def whole(self) -> bool:
        """Whether it takes whole numbers."""
        return _schema(self.path).get("type") == "integer"

    @property
    def alternatives(self) -> tuple[str, ...]:
        """Fields of its table that say the same in another way."""
        if self.table == "material":
            return NUMBERS if self.field == "name" else ("name",)
        group = _ALTERNATIVES.get(self.table, ())
        return tuple(name for name in group if name != self.field) if self.field in group else ()

    def read(self, value: object, gravity: float) -> Value:
        """A value of this key in SI.

        Raises:
            ValueError: it is none; the message says what would be right.
        """
        if self.field == "floor_radius" and value in (FLAT, math.inf):
            if self.element is not None:
                raise ValueError(f"a floor is flat along both axes: vary {self.path}")
            return math.inf
        parsed = self._validated(value, gravity)
        if isinstance(parsed, tuple):
            if self.field != "speeds" and self.element is None and parsed[0] != parsed[-1]:
                raise ValueError(f"expected one value: vary {self.name}[0] and {self.name}[1]")
            parsed = parsed[self.element or 0]
        if self.path == CLEARANCE and not parsed > 0:
            raise ValueError("expected more than 0")
        if not isinstance(parsed, bool | int | float | str):
            raise ValueError("expected one value")
        return parsed

    def _validated(self, value: object, gravity: float) -> Any:
        """The value as the scene's own field reads it, in SI."""
        given = [value, value] if _is_pair(self.path) else [value] if self.path == SPEEDS else value
        try:
            return _adapter(self.path).validate_python(given, strict=True, context={"gravity": gravity})
        except ValidationError as error:
            raise ValueError(error_text(error.errors(include_url=False)[0], [""])) from error

    def says_the_same(self, other: Key) -> bool:
        """Whether only one of the two can be varied."""
        cavity = {CLEARANCE, "damper.cavity"}
        if self.path == other.path or {self.path, other.path} == cavity:
            return self.element is None or other.element in (None, self.element)
        return self.table == other.table and other.field in self.alternatives

    def replaced(self, scene: Scene) -> str | None:
        """Name of the key of a scene that it takes the place of; a material's numbers are changed one by one."""
        table = getattr(scene, self.table)
        if table is None or self.table == "material" or not self.alternatives or getattr(table, self.field) is not None:
            return None
        present = [name for name in self.alternatives if getattr(table, name) is not None]
        return f"{self.table}.{present[-1]}" if present else None

    def put(self, data: Data, value: Value) -> None:
        """Set it in a scene's plain data, as speeds are not; what it takes the place of goes."""
        place = data
        for name in self.path.split(".")[:-1]:
            place = place.setdefault(name, {})
        for name in self.alternatives:
            place.pop(name, None)
        if self.path == CLEARANCE:
            for side in (0, 1) if self.element is None else (self.element,):
                place["cavity"][side] = 2 * place["radius"] + float(value)
        elif value == math.inf:
            place.pop(self.field, None)
        elif self.element is not None:
            before = place.get(self.field)
            if before is None and self.field == "floor_radius":
                instead = f"give the scene its radius there, or vary {self.path}"
                raise BadInput(f"the floor is flat along the other axis: {instead}", key=self.name)
            pair = list(before) if isinstance(before, list | tuple) else [0.0 if before is None else before] * 2
            pair[self.element] = value
            place[self.field] = pair
        else:
            place[self.field] = [value, value] if _is_pair(self.path) else value


def find(name: str, where: str) -> Key:
    """The key of a dotted name, such as ``damper.radius``.

    Args:
        name: as a user wrote it.
        where: what the message calls it by, such as ``--vary``.

    Raises:
        BadInput: there is none; with the one that was probably meant.
    """
    path, bracket, rest = name.partition("[")
    if bracket and rest not in ("0]", "1]"):
        raise BadInput("expected an element [0] or [1], along the damper's axes 1 and 2", key=f"{where} {name}")
    if path not in (CLEARANCE, *every()):
        raise BadInput(f"unknown key{_meant(path)}", key=f"{where} {name}")
    if bracket and not _is_pair(path):
        raise BadInput(f"has no elements: expected {path}", key=f"{where} {name}")
    return Key(name, path, int(rest[0]) if bracket else None)


@cache
def every() -> tuple[str, ...]:
    """All keys of a scene's tables by dotted path."""
    return tuple(name for name in keys() if "." in name and not name.startswith("design."))


@cache
def _adapter(path: str) -> TypeAdapter[Any]:
    _, field = keys()["damper.cavity" if path == CLEARANCE else path]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    return TypeAdapter(kind)


@cache
def _schema(path: str) -> dict[str, Any]:
    return _adapter(path).json_schema()


@cache
def _is_pair(path: str) -> bool:
    return "'maxItems': 2" in str(_schema(path))


def _meant(path: str) -> str:
    """What was probably meant by an unknown key: the same name in another table before a like name."""
    field = path.rpartition(".")[2]
    homes = [name for name in every() if name.rpartition(".")[2] == field]
    if homes:
        return did_you_mean(path, homes) or f": did you mean '{homes[0]}'?"
    if field in ("diameter", "ball_diameter"):
        return ": a ball is given by its radius: did you mean 'damper.radius'?"
    meant = instead(path.split(".")) or did_you_mean(path, (*every(), CLEARANCE))
    return meant or f": expected a key of a table, such as {SPEEDS}"


@dataclass(frozen=True)
class Spread:
    """How a number is spread between two ends, in SI: evenly, evenly in its logarithm, or as a normal distribution.

    A normal one ends three standard deviations from its mean, or where the ends cut it off before.
    """

    low: float
    high: float
    law: str = "even"
    mean: float = 0.0
    deviation: float = 0.0

    def at(self, share: Floats) -> Floats:
        """Its quantiles at shares from 0 to 1."""
        if self.law == "log":
            inside = np.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
            return np.clip(inside, self.low, self.high)
        if self.law == "normal":
            from scipy.stats import truncnorm

            ends = ((end - self.mean) / self.deviation for end in (self.low, self.high))
            values: Floats = truncnorm.ppf(share, *ends, loc=self.mean, scale=self.deviation)
            return values
        return np.clip(self.low + share * (self.high - self.low), self.low, self.high)


@dataclass(frozen=True)
class Axis:
    """A key and its values in SI, ascending as they were given; `spread` where it is a range.

    A range without a count, which a sample takes, has no values. `written`: the values as a user wrote them, of a range
    its ends: those with a unit are text; `given`: all that was written, a text or a list.
    """

    key: Key
    values: tuple[Value, ...]
    spread: Spread | None = None
    written: tuple[object, ...] = field(default=(), compare=False)
    given: Any = field(default=None, compare=False)

    @property
    def name(self) -> str:
        """Of the dimension or coordinate."""
        return self.key.name

    @property
    def is_continuous(self) -> bool:
        """Whether it is a range of numbers that need not be whole."""
        return self.spread is not None and not self.key.whole

    @property
    def choices(self) -> Sequence[Value]:
        """All values of a list, or of a range of whole numbers."""
        spread = self.spread
        return self.values if spread is None else range(math.ceil(spread.low), math.floor(spread.high) + 1)

    def at(self, shares: Floats) -> list[Value]:
        """Its values at shares from 0 to 1: of its spread, or one of its choices each."""
        spread, choices = self.spread, self.choices
        if spread is not None and not self.key.whole:
            return [float(value) for value in spread.at(shares)]
        if spread is not None and spread.law != "even":  # the nearest
            return [int(value) for value in np.clip(np.rint(spread.at(shares)), choices[0], choices[-1])]
        return [choices[k] for k in np.minimum((shares * len(choices)).astype(int), len(choices) - 1)]


_FORMS = "expected START:STOP:COUNT, log:START:STOP:COUNT or a list a,b,c"


def read(vary: Mapping[str, object] | Iterable[str], gravity: float) -> tuple[Axis, ...]:
    """Axes from ``KEY=VALUES`` texts, or from a dict of keys and values (a text of that form, a list, an array).

    Args:
        vary: what is varied.
        gravity: the unit g of accelerations [m/s²].

    Raises:
        BadInput: an unknown key or a wrong value, which the message names.
    """
    where = "vary" if isinstance(vary, Mapping) else "--vary"
    axes = list[Axis]()
    for name, values in _items(vary):
        key = find(name.strip(), where)
        require_possible(_count(values), f"{where} {key.name}")
        given = values.strip() if isinstance(values, str) else np.asarray(values).tolist()
        try:
            axis = _ranged(key, values, gravity) if isinstance(values, str) else _listed(key, values, gravity)
        except ValueError as error:
            raise BadInput(str(error), key=f"{where} {key.name}", value=given) from error
        for other in axes:
            if other.name == key.name:
                raise BadInput("is already varied: expected each key once", key=f"{where} {key.name}")
            if key.says_the_same(other.key):
                raise BadInput(f"sets the same quantity as {other.name}: vary one of them", key=f"{where} {key.name}")
        axes.append(replace(axis, given=given))
    return tuple(axes)


def check_size(vary: Mapping[str, object] | Iterable[str], speeds: int) -> None:
    """See that a grid over what is varied is not too large, before its values are computed.

    Args:
        vary: what is varied, as in :func:`read`.
        speeds: number of speeds of the scene, which count unless they are varied.

    Raises:
        BadInput: it has more than `MOST` points; or text that is no ``KEY=VALUES``.
    """
    counts = {name.strip(): _count(values) for name, values in _items(vary)}
    require_possible(math.prod(({SPEEDS: speeds} | counts).values()), "vary" if isinstance(vary, Mapping) else "--vary")


def require_possible(points: float, key: str, value: object = None) -> None:
    """Raise BadInput where a study would have more than `MOST` points, those at all speeds counted."""
    if points > MOST:
        raise BadInput(f"expected at most {MOST} points, all speeds counted, not {points:.10g}", key=key, value=value)


def _items(vary: Mapping[str, object] | Iterable[str]) -> Iterable[tuple[str, object]]:
    return vary.items() if isinstance(vary, Mapping) else map(_split, vary)


def _count(values: object) -> float:
    """How many values are given, as far as that is plain to see: the COUNT of a range, the length of a list; or 1."""
    if not isinstance(values, str):
        return values.size if isinstance(values, np.ndarray) else len(values) if isinstance(values, Sized) else 1
    law, parts = _parts(values)
    if not law:
        return len(parts)
    return float(parts[2]) if len(parts) == 3 and parts[2].isdecimal() else 1


def _parts(text: str) -> tuple[str, list[str]]:
    """The law of a range, and what stands between its colons; of a list no law, and its items."""
    law, *parts = (part.strip() for part in text.split(":"))
    if not parts:
        return "", [item.strip() for item in law.split(",")]
    return (law, parts) if law in ("log", "normal") else ("even", [law, *parts])


def _split(text: str) -> tuple[str, str]:
    name, equals, values = text.partition("=")
    if not equals or not values.strip():
        raise BadInput(f"{_FORMS} after KEY=", key="--vary", value=text)
    return name, values


def _listed(key: Key, values: object, gravity: float) -> Axis:
    items = values.tolist() if isinstance(values, np.ndarray) else values
    items = list(items) if isinstance(items, Iterable) and not isinstance(items, Mapping) else [items]
    if not items:
        raise ValueError("expected at least one value")
    numbers = tuple(key.read(item, gravity) for item in items)
    if len(set(numbers)) < len(numbers):
        raise ValueError("expected every value once")
    if len({isinstance(value, str | bool) for value in numbers}) > 1:
        raise ValueError("expected numbers or words, not both")
    return Axis(key, numbers, written=tuple(items))


def _ranged(key: Key, text: str, gravity: float) -> Axis:
    """An axis from a range, with or without a count, or from a list."""
    law, parts = _parts(text)
    if not law:
        return _listed(key, [_parsed(item) for item in parts], gravity)
    if len(parts) not in (2, 3):
        raise ValueError(_FORMS)
    written = tuple(_parsed(part) for part in parts[:2])
    first, second = (_end(key, value, gravity) for value in written)
    if len({isinstance(value, str) for value in written}) > 1 and key.unit and first and second:
        raise ValueError("a number without a unit is in SI: give both the unit, or none")
    if len(parts) == 3 and not (parts[2].isdecimal() and int(parts[2][:12])):
        raise ValueError(f"expected a whole number of values from 1 on as COUNT, not {shown(parts[2])}")
    count = int(parts[2]) if len(parts) == 3 else None
    if law == "normal":
        if count is not None or second <= 0:
            raise ValueError("expected normal:MEAN:DEVIATION with a deviation above 0")
        return Axis(key, (), Spread(first - 3 * second, first + 3 * second, law, first, second), written)
    if second != first and count == 1:
        raise ValueError("a single value has no STOP: expected a COUNT from 2 on, or the value alone")
    if not second > first and not (second == first and count == 1):
        raise ValueError("expected a STOP above START")
    if law == "log" and first <= 0:
        raise ValueError("expected a START above 0 on a logarithmic range")
    spread = Spread(first, second, law)
    return Axis(key, _numbers(key, spread.at(np.linspace(0.0, 1.0, count or 0))), spread, written)


def _end(key: Key, written: object, gravity: float) -> float:
    value = key.read(written, gravity)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("has no numbers for a range: expected a list a,b,c")
    return float(value)


def _numbers(key: Key, values: Floats) -> tuple[Value, ...]:
    if not key.whole:
        return tuple(map(float, values))
    rounded = np.rint(values)
    if np.abs(rounded - values).max(initial=0.0) > 1e-9:
        raise ValueError("expected a COUNT that gives whole numbers")
    return tuple(int(value) for value in rounded)


def _parsed(text: str) -> object:
    """Text as a scene would have it: numbers, truth values and words."""
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def with_remarks(source: SceneFile, axes: Iterable[Axis], *, grid: bool) -> SceneFile:
    """The scene with remarks on what is varied: speeds without a unit, not its own ones; counts that a sample ignores.

    A scene that is read has no other remark.
    """
    for axis in axes:
        if axis.name == SPEEDS:
            source = replace(source, remarks=speed_remarks(axis.written))
    counted = [axis for axis in axes if axis.spread is not None and len(axis.values) > 1 and not grid]
    said = [
        f"--vary {axis.name}={axis.given}: a sample covers the whole range and ignores the COUNT" for axis in counted
    ]
    return replace(source, remarks=(*source.remarks, *said))


_MILLIMETRES = 30.0
"""Ratio to the scene's own length from which on a number without a unit is nearer to it in mm than in m."""


def check_units(axes: Iterable[Axis], scene: Scene) -> None:
    """See that lengths without a unit, which are in m, are not those of millimetres.

    Raises:
        BadInput: they are all more than 30 times the scene's own; with a unit they are taken as they are.
    """
    data = plain(scene)
    for axis in axes:
        own = _own_length(axis.key, data)
        numbers = axis.values or ((axis.spread.low,) if axis.spread is not None else ())
        values = [float(value) for value in numbers if not isinstance(value, str)]
        bare = not any(isinstance(value, str) for value in axis.written)
        if bare and own is not None and values and min(values) > _MILLIMETRES * own:
            problem = f"a length without a unit is in m, and the scene has {1e3 * own:g} mm here"
            meant = f"was '{min(values):g} mm' meant? Give the unit, mm or m"
            raise BadInput(f"{problem}: {meant}", key=f"--vary {axis.name}", value=axis.given)


def _own_length(key: Key, data: Data) -> float | None:
    """The length [m], above 0, that a scene has at a key."""
    place: Any = data
    for name in ("damper.cavity" if key.path == CLEARANCE else key.path).split("."):
        place = place.get(name) if isinstance(place, Mapping) else None
    if isinstance(place, list | tuple):
        place = place[key.element or 0]
    if key.path == CLEARANCE:
        place -= 2 * data["damper"]["radius"]
    return float(place) if key.unit == "m" and isinstance(place, int | float) and place > 0 else None


@dataclass(frozen=True, eq=False)
class Plan:
    """The points of a study, numbered along its dimensions.

    Over a grid each key is a dimension of its own, the speeds the last, so that the points of one plate and of one ball
    lie together. Over a sample all keys lie along one dimension, and each of its points has all speeds, unless these
    are sampled as well.

    Attributes:
        axes: what is varied, the speeds last.
        dimensions: names and lengths, slowest first; their product is the number of points.
        coordinates: of every key its dimension, and its values along it.
        identity: what makes the plan this one, as plain data.
    """

    axes: tuple[Axis, ...]
    dimensions: dict[str, int]
    coordinates: dict[str, tuple[str, npt.NDArray[Any]]]
    identity: dict[str, Any]

    @property
    def size(self) -> int:
        """The number of points."""
        return math.prod(self.dimensions.values())

    def columns(self, begin: int, end: int) -> dict[str, list[Value]]:
        """The values of every key at the points from `begin` to before `end`."""
        places = np.unravel_index(np.arange(begin, end), tuple(self.dimensions.values()))
        at = dict(zip(self.dimensions, places, strict=True))
        return {name: values[at[along]].tolist() for name, (along, values) in self.coordinates.items()}

    def speeds(self, begin: int, end: int) -> tuple[float, ...]:
        """Speeds at which plates are solved, ascending [rad/s]: all that are given, of sampled ones those of points."""
        along, values = self.coordinates[SPEEDS]
        return tuple(sorted(set(values.tolist() if along == SPEEDS else self.columns(begin, end)[SPEEDS])))


def grid(axes: Sequence[Axis], speeds: Sequence[float]) -> Plan:
    """All axes against each other: first those that change the plate, then cavities, then masses; speeds last."""
    for axis in axes:
        if not axis.values:
            problem = "a range over a grid needs its COUNT: START:STOP:COUNT"
            raise BadInput(problem, key=f"--vary {axis.name}", value=axis.given)
    ordered = in_order(axes, speeds)
    return Plan(
        ordered,
        {axis.name: len(axis.values) for axis in ordered},
        {axis.name: (axis.name, _array(axis.values)) for axis in ordered},
        {"grid": {axis.name: as_plain(axis.values) for axis in ordered}},
    )


def sample(axes: Sequence[Axis], speeds: Sequence[float], count: int, seed: int) -> Plan:
    """So many points over all axes, by a scrambled Sobol' sequence."""
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
        raise BadInput("expected a whole number of points from 1 on", key="--sample", value=count)
    count = int(count)
    ordered = in_order(axes, speeds)
    require_possible(float(count) * speeds_of_a_point(ordered), "--sample", count)
    free = len(ordered) if _samples_speeds(ordered) else len(ordered) - 1
    return at_shares(ordered, sobol(free, 1 << (count - 1).bit_length(), seed)[:count], {"seed": seed})


def check_seed(seed: object) -> int:
    """A seed as a number; raise BadInput unless it is a whole one from 0 on."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise BadInput("expected a whole number from 0 on", key="--seed", value=seed)
    return int(seed)


def sobol(dimensions: int, count: int, seed: int) -> Floats:
    """So many points, a power of two, spread over the unit cube."""
    from scipy.stats import qmc

    return np.asarray(qmc.Sobol(dimensions, scramble=True, rng=seed).random(count))


def at_shares(axes: Sequence[Axis], shares: Floats, identity: Mapping[str, Any]) -> Plan:
    """Points at rows of shares from 0 to 1, one for each axis; each at all speeds where these have no share."""
    coordinates = {axis.name: (SAMPLE, _array(axis.at(column))) for axis, column in zip(axes, shares.T, strict=False)}
    dimensions = {SAMPLE: len(shares)}
    if not _samples_speeds(axes):
        dimensions[SPEEDS] = len(axes[-1].values)
        coordinates[SPEEDS] = (SPEEDS, _array(axes[-1].values))
    spreads = {axis.name: vars(axis.spread) if axis.spread else as_plain(axis.values) for axis in axes}
    return Plan(tuple(axes), dimensions, coordinates, {"sample": spreads, "count": len(shares), **identity})


def speeds_of_a_point(axes: Sequence[Axis]) -> int:
    """At how many speeds each point of a sample is solved, with the speeds the last of the axes."""
    return 1 if _samples_speeds(axes) else len(axes[-1].values)


def _samples_speeds(axes: Sequence[Axis]) -> bool:
    return axes[-1].spread is not None


def _array(values: Sequence[Value]) -> npt.NDArray[Any]:
    """Numbers as numbers, words and truth values as they are."""
    return np.array(values, dtype=object if any(isinstance(value, bool | str) for value in values) else None)


def as_plain(values: Sequence[Value]) -> list[Value]:
    """Values as JSON has them, in which nothing is infinite."""
    return [FLAT if value == math.inf else value for value in values]


def in_order(axes: Sequence[Axis], speeds: Sequence[float]) -> tuple[Axis, ...]:
    """Axes by what differs along them: the plate, the cavities in it, the ball's mass, the speed."""

    def rank(axis: Axis) -> int:
        key = axis.key
        if key.name == SPEEDS:
            return 4
        if key.table not in ("damper", "release") or key.path in ("damper.at", "damper.housing"):
            return 0
        if key.path in ("damper.count", "damper.radius", "damper.cavity", CLEARANCE):
            return 1
        return 2 if key.table == "damper" and key.alternatives else 3

    if not any(axis.name == SPEEDS for axis in axes):
        axes = (*axes, Axis(find(SPEEDS, "--vary"), tuple(speeds)))
    return tuple(sorted(axes, key=rank))


def plain(scene: Scene) -> Data:
    """A scene as plain data that keys can be put into."""
    data = scene.as_written()
    data.pop("design", None)
    return data


def base(source: SceneFile, varied: Sequence[Key]) -> Data:
    """The study's scene as plain data, ready for these keys: a material in numbers where one of these is varied.

    Raises:
        BadInput: it lacks a table that a key belongs to.
    """
    data = plain(source.scene)
    name = data.get("material", {}).get("name")
    if name is not None and any(key.table == "material" and key.field in NUMBERS for key in varied):
        data["material"] = {number: getattr(KNOWN[name], number) for number in NUMBERS}
    for key in varied:
        if key.table not in data:
            raise BadInput(f"the scene {source.name} has no [{key.table}]", key=f"--vary {key.name}")
    return data


def with_values(data: Data, values: Mapping[Key, Value]) -> Data:
    """A copy of plain data with values put in; clearances last, which add to the ball's diameter."""
    changed = copy.deepcopy(data)
    for key in sorted(values, key=lambda key: key.path == CLEARANCE):
        key.put(changed, values[key])
    return changed


def of_a_point(source: SceneFile, data: Data, speeds: Sequence[float]) -> SceneFile:
    """The scene of plain data at these speeds.

    Raises:
        BadInput: its values are wrong together.
    """
    whole = data | {"rotor": data["rotor"] | {"speeds": list(speeds)}}
    return replace(source, scene=parse(whole, source.name), remarks=())
