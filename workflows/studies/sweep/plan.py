"""What is varied, and the points of a study.

A key goes over listed values or over a range, as ``--vary KEY=…`` or a dict of Python has it. Points are known by their
absolute index, over a grid or a sample, and each has a scene.
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Annotated, Any, TypeAlias

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, TypeAdapter, ValidationError

from workflows.errors import BadInput, did_you_mean, shown
from workflows.scene.load import SceneFile, error_text, parse, unit
from workflows.scene.materials import KNOWN
from workflows.scene.scene import FLAT, Scene

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
        parsed = _validated(self, value, gravity)
        if isinstance(parsed, tuple):
            if self.field != "speeds" and self.element is None and parsed[0] != parsed[-1]:
                raise ValueError(f"expected one value: vary {self.name}[0] and {self.name}[1]")
            parsed = parsed[self.element or 0]
        if self.field == "clearance" and not parsed > 0:
            raise ValueError("expected more than 0")
        if not isinstance(parsed, bool | int | float | str):
            raise ValueError("expected one value")
        return parsed

    @property
    def whole(self) -> bool:
        """Whether it takes whole numbers."""
        return _schema(".".join((*self.table, self.field))).get("type") == "integer"

    @property
    def _alike(self) -> list[str]:
        """Keys of its table of which one takes the place of the others, it among them; none where there are none."""
        groups = [names for table, names in _INSTEAD if self.table == (table,) and self.field in names]
        return list(dict.fromkeys(name for names in groups for name in names))

    def instead_of(self) -> set[str]:
        """Names of the keys that say the same, so that only one of them can be varied."""
        others = {f"{self.table[0]}.{other}" for other in self._alike}
        pair = {"clearance": "cavity", "cavity": "clearance"}.get(self.field)
        for key in [self.field, *([pair] if pair else [])]:
            path = ".".join((*self.table, key))
            ends = ["", "[0]", "[1]"] if self.element is None else ["", f"[{self.element}]"]
            others |= {f"{path}{end}" for end in ends}
        return others - {self.name}

    def displaced(self, scene: Scene) -> str | None:
        """Name of the key of a scene that it takes the place of; a material's numbers are changed one by one."""
        table = getattr(scene, self.table[0])
        if table is None or self.table[0] == "material":
            return None
        there = [name for name in self._alike if getattr(table, name) is not None]
        return f"{self.table[0]}.{there[-1]}" if there and self.field not in there else None

    def put(self, data: Data, value: Value) -> None:
        """Set it in a scene's plain data; what it takes the place of goes."""
        place = data
        for name in self.table:
            place = place.setdefault(name, {})
        for other in self._alike:
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
    items = []
    for name, entry in table.model_fields.items():
        here = (*path, name)
        items.append((".".join(here), entry))
        for inner in _tables(entry.annotation):
            items += _walk(inner, here)
    return items


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
    return error_text(error.errors(include_url=False)[0], [""])


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


MOST = 10**9
"""Points of a study, and values along an axis."""

_HOW = "expected START:STOP:COUNT, log:START:STOP:COUNT or a list a,b,c"


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

    def at(self, share: np.ndarray) -> np.ndarray:
        """Its quantiles at shares from 0 to 1."""
        if self.law == "log":
            inside = np.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
            return np.clip(inside, self.low, self.high)
        if self.law == "normal":
            from scipy.stats import truncnorm

            ends = ((end - self.mean) / self.deviation for end in (self.low, self.high))
            values: np.ndarray = truncnorm.ppf(share, *ends, loc=self.mean, scale=self.deviation)
            return values
        return np.clip(self.low + share * (self.high - self.low), self.low, self.high)


@dataclass(frozen=True)
class Axis:
    """A key and its values in SI, ascending as they were given; `spread` where it is a range, and the `text` of it.

    A range without a count, which a sample takes, has no values. `bare`: its numbers have no unit.
    """

    key: Key
    values: tuple[Value, ...]
    spread: Spread | None = None
    text: str = field(default="", compare=False)
    bare: bool = field(default=False, compare=False)

    @property
    def name(self) -> str:
        """Of the dimension or coordinate."""
        return self.key.name


def read(vary: Mapping[str, object] | Iterable[str], gravity: float) -> tuple[Axis, ...]:
    """Axes from ``KEY=VALUES`` texts, or from a dict of keys and values (a text of that form, a list, an array).

    Args:
        vary: what is varied.
        gravity: the unit g of accelerations [m/s²].

    Raises:
        BadInput: an unknown key or a wrong value, which the message names.
    """
    where = "vary" if isinstance(vary, Mapping) else "--vary"
    pairs = list(vary.items()) if isinstance(vary, Mapping) else [_split(text) for text in vary]
    axes = []
    for name, values in pairs:
        key = find(name.strip(), where)
        try:
            axes.append(_axis(key, values, gravity))
        except ValueError as error:
            value = values if isinstance(values, str) else np.asarray(values).tolist()
            raise BadInput(str(error), key=f"{where} {key.name}", value=value) from error
    _check_apart(axes, where)
    return tuple(axes)


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
        if axis.bare and own is not None and values and min(values) > _MILLIMETRES * own:
            problem = (
                f"a length without a unit is in m, and the scene has {1e3 * own:g} mm here: was '{min(values):g} mm'"
                f" meant? Give the unit, mm or m"
            )
            raise BadInput(problem, key=f"--vary {axis.name}", value=axis.text or values)


def _own_length(key: Key, data: Data) -> float | None:
    """The length [m], above 0, that a scene has at a key."""
    place: Any = data
    for name in (*key.table, "cavity" if key.field == "clearance" else key.field):
        place = place.get(name) if isinstance(place, Mapping) else None
    if isinstance(place, list | tuple):
        place = place[key.element or 0]
    if key.field == "clearance":
        place -= 2 * data["damper"]["radius"]
    return float(place) if key.unit == "m" and isinstance(place, int | float) and place > 0 else None


def _split(text: str) -> tuple[str, str]:
    name, equals, values = text.partition("=")
    if not equals or not values.strip():
        raise BadInput(f"{_HOW} after KEY=", key="--vary", value=text)
    return name, values


def _check_apart(axes: list[Axis], where: str) -> None:
    """No key twice, and none beside another that says the same."""
    names = [axis.name for axis in axes]
    for number, axis in enumerate(axes):
        if axis.name in names[:number]:
            raise BadInput("is varied already: expected each key once", key=f"{where} {axis.name}")
        for other in axes[:number]:
            if other.name in axis.key.instead_of():
                raise BadInput(f"says the same as {other.name}: vary one of them", key=f"{where} {axis.name}")


def _axis(key: Key, values: object, gravity: float) -> Axis:
    if not isinstance(values, str):
        listed = values.tolist() if isinstance(values, np.ndarray) else values
        items = list(listed) if isinstance(listed, Iterable) and not isinstance(listed, Mapping) else [listed]
        return replace(_listed(key, items, gravity), bare=not any(isinstance(item, str) for item in items))
    numbers = re.split("[:,]", values.strip().removeprefix("log:").removeprefix("normal:"))
    return replace(_ranged(key, values, gravity), text=values.strip(), bare=all(map(_bare, numbers)))


def _ranged(key: Key, values: str, gravity: float) -> Axis:
    parts = [part.strip() for part in values.split(":")]
    if len(parts) == 1:
        return _listed(key, [_plain(item.strip()) for item in values.split(",")], gravity)
    law = "even"
    if parts[0] in ("log", "normal"):
        law, parts = parts[0], parts[1:]
    if len(parts) not in (2, 3):
        raise ValueError(_HOW)
    first, second = (_end(key, part, gravity) for part in parts[:2])
    if _bare(parts[0]) != _bare(parts[1]) and key.unit and first and second:
        raise ValueError("a number without a unit is in SI: give both the unit, or none")
    count = _count(parts[2]) if len(parts) == 3 else None
    return _normal(key, first, second, count) if law == "normal" else _range(key, Spread(first, second, law), count)


def _range(key: Key, spread: Spread, count: int | None) -> Axis:
    """Values from the lower end to the higher; without a count, the range alone."""
    first, second = spread.low, spread.high
    if second != first and count == 1:
        raise ValueError("a single value leaves STOP out: expected a COUNT from 2 on, or the value alone")
    if not second > first and not (second == first and count == 1):
        raise ValueError("expected a STOP above START")
    if spread.law == "log" and first <= 0:
        raise ValueError("expected a START above 0 on a logarithmic range")
    at = np.linspace(0.0, 1.0, count) if count is not None else np.zeros(0)
    return Axis(key, _numbers(key, spread.at(at)), spread)


def _normal(key: Key, mean: float, deviation: float, count: int | None) -> Axis:
    if count is not None or deviation <= 0:
        raise ValueError("expected normal:MEAN:DEVIATION with a deviation above 0")
    low, high = mean - 3 * deviation, mean + 3 * deviation
    return Axis(key, (), Spread(low, high, "normal", mean, deviation))


def _end(key: Key, text: str, gravity: float) -> float:
    value = key.read(_plain(text), gravity)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("has no numbers to range over: expected a list a,b,c")
    return float(value)


def _numbers(key: Key, values: np.ndarray) -> tuple[Value, ...]:
    if not key.whole:
        return tuple(map(float, values))
    rounded = np.rint(values)
    if np.abs(rounded - values).max(initial=0.0) > 1e-9:
        raise ValueError("expected a COUNT that leads through whole numbers")
    return tuple(int(value) for value in rounded)


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text[:12]) <= MOST:
        raise ValueError(f"expected a whole number of values from 1 on as COUNT, not {shown(text)}")
    return int(text)


def _listed(key: Key, items: list[object], gravity: float) -> Axis:
    if not items:
        raise ValueError("expected at least one value")
    values = tuple(key.read(item, gravity) for item in items)
    if len(set(values)) < len(values):
        raise ValueError("expected every value once")
    if len({isinstance(value, str | bool) for value in values}) > 1:
        raise ValueError("expected numbers or words, not both")
    return Axis(key, values)


def _plain(text: str) -> object:
    """Text as a scene would have it: numbers, truth values and words."""
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _bare(text: str) -> bool:
    return not isinstance(_plain(text), str)


def plain(scene: Scene) -> Data:
    """A scene as plain data that keys can be put into: a material by its name or by its numbers, not by both."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"design"})
    if "name" in data.get("material", {}):
        data["material"] = {"name": data["material"]["name"]}
    if "ball_material" in data.get("damper", {}):
        data["damper"].pop("ball_density", None)
    return data


def written_out(data: Data, keys: Sequence[Key]) -> Data:
    """The data with a plate's material in numbers where one of these is varied."""
    name = data.get("material", {}).get("name")
    numbers = {key.field for key in keys if key.table == ("material",)} - {"name"}
    if name is None or not numbers:
        return data
    names = ("youngs_modulus", "poissons_ratio", "density")
    return data | {"material": {number: getattr(KNOWN[name], number) for number in names}}


_OF_THE_MASS = {"mass_ratio", "mass", "ball_density", "ball_material", "count", "radius"}


def of_the_plate(key: Key) -> bool:
    """Whether a plate must be solved anew where this key differs."""
    if key.table[0] in ("damper", "release"):
        return key.table[0] == "damper" and key.field in ("at", "housing")
    return key.name != SPEEDS


def of_the_cavity(key: Key) -> bool:
    """Whether the metal that the cavities take out of the plate may differ where this key does."""
    return key.table == ("damper",) and key.field in ("count", "radius", "cavity", "clearance")


def of_the_mass(key: Key) -> bool:
    """Whether the ball's mass may differ where this key does."""
    return key.table == ("damper",) and key.field in _OF_THE_MASS


SAMPLE = "sample"
"""The dimension of a sample."""


@dataclass(frozen=True)
class Grid:
    """Every value of each axis with every one of the others.

    Points lie in an order of their own, speeds last, so that those of one plate and of one ball lie together.

    Attributes:
        axes: what is varied, the speeds last.
    """

    axes: tuple[Axis, ...]

    @property
    def dimensions(self) -> dict[str, int]:
        """Names and lengths, slowest first, one for each axis; their product is the number of points."""
        return {axis.name: len(axis.values) for axis in self.axes}

    def columns(self, begin: int, end: int) -> dict[str, list[Value]]:
        """The values of every axis at the points from `begin` to before `end`."""
        places = np.unravel_index(np.arange(begin, end), tuple(self.dimensions.values()))
        return {axis.name: [axis.values[k] for k in at] for axis, at in zip(self.axes, places, strict=True)}

    def coordinates(self) -> dict[str, tuple[str, list[Value]]]:
        """The values of every axis along its dimension, which is its own."""
        return {axis.name: (axis.name, list(axis.values)) for axis in self.axes}

    def speeds(self, begin: int, end: int) -> tuple[float, ...]:
        """All speeds at which plates are solved, ascending [rad/s]: those of the whole grid, for any points."""
        return tuple(sorted(float(value) for value in self.axes[-1].values))

    def identity(self) -> dict[str, Any]:
        """What makes the plan this one, as plain data: keys and values."""
        return {"grid": {axis.name: said(axis.values) for axis in self.axes}}


@dataclass(frozen=True)
class Sample:
    """So many points, spread evenly over all axes at once; every one at all speeds, unless these are sampled as well.

    Attributes:
        axes: what is sampled, and last the speeds.
        count: points of the sample.
        seed: of the scrambling.
        tiles: rows of shares from 0 to 1, in place of a Sobol' sequence: shape (count, axes but the speeds').
    """

    axes: tuple[Axis, ...]
    count: int
    seed: int
    sampled_speeds: bool = False
    tiles: npt.NDArray[np.float64] | None = field(default=None, repr=False, compare=False)

    @property
    def drawn(self) -> tuple[Axis, ...]:
        """The axes that are sampled."""
        return self.axes if self.sampled_speeds else self.axes[:-1]

    @property
    def dimensions(self) -> dict[str, int]:
        """The sample, and the speeds where they are not sampled."""
        sizes = {SAMPLE: self.count}
        return sizes if self.sampled_speeds else sizes | {SPEEDS: len(self.axes[-1].values)}

    @property
    def _each(self) -> int:
        return 1 if self.sampled_speeds else len(self.axes[-1].values)

    def columns(self, begin: int, end: int) -> dict[str, list[Value]]:
        """The values of every axis at the points from `begin` to before `end`."""
        first, last = begin // self._each, -(-end // self._each)
        rows = np.arange(begin, end)
        shares = self._shares(first, last)[rows // self._each - first]
        columns = {axis.name: drawn(axis, shares[:, k]) for k, axis in enumerate(self.drawn)}
        if not self.sampled_speeds:
            columns[SPEEDS] = [self.axes[-1].values[k] for k in rows % self._each]
        return columns

    def _shares(self, begin: int, end: int) -> npt.NDArray[np.float64]:
        if self.tiles is not None:
            return self.tiles[begin:end]
        from scipy.stats import qmc

        sequence = qmc.Sobol(len(self.drawn), scramble=True, rng=self.seed)
        if begin:
            sequence.fast_forward(begin)
        count = end - begin
        power = 1 << (count - 1).bit_length()  # scipy warns of a first draw that is no power of two
        shares: npt.NDArray[np.float64] = sequence.random(power)[:count]
        return shares

    def coordinates(self) -> dict[str, tuple[str, list[Value]]]:
        """Each sampled axis along the sample."""
        every = self.columns(0, self.count * self._each)
        coordinates = {axis.name: (SAMPLE, every[axis.name][:: self._each]) for axis in self.drawn}
        return coordinates if self.sampled_speeds else coordinates | {SPEEDS: (SPEEDS, list(self.axes[-1].values))}

    def speeds(self, begin: int, end: int) -> tuple[float, ...]:
        """All that are given; of sampled ones those of these points, and the ends of their range."""
        if not self.sampled_speeds:
            return tuple(sorted(float(value) for value in self.axes[-1].values))
        return tuple(sorted({float(value) for value in self.columns(begin, end)[SPEEDS]}))

    def identity(self) -> dict[str, Any]:
        """Keys, spreads and the seed."""
        axes = {axis.name: vars(axis.spread) if axis.spread else said(axis.values) for axis in self.axes}
        return {"sample": axes, "count": self.count, "seed": self.seed, "tiled": self.tiles is not None}


Plan: TypeAlias = Grid | Sample
"""The points of a study."""


def size(plan: Plan) -> int:
    """The number of points."""
    return math.prod(plan.dimensions.values())


def said(values: Sequence[Value]) -> list[Value]:
    """Values as JSON has them, in which nothing is infinite."""
    return [FLAT if value == math.inf else value for value in values]


def drawn(axis: Axis, shares: npt.NDArray[np.float64]) -> list[Value]:
    """The values of an axis at shares from 0 to 1: of its spread, or one of its values each."""
    if axis.spread is None:
        places = np.minimum((shares * len(axis.values)).astype(int), len(axis.values) - 1)
        return [axis.values[k] for k in places]
    values = axis.spread.at(shares)
    if axis.key.whole:
        low, high = math.ceil(axis.spread.low), math.floor(axis.spread.high)
        return [int(value) for value in np.clip(np.floor(low + shares * (high - low + 1)), low, high)]
    return [float(value) for value in values]


def grid(axes: Sequence[Axis], speeds: Sequence[float]) -> Grid:
    """All axes against each other: first those that change the plate, then cavities, then masses; speeds last."""
    for axis in axes:
        if not axis.values:
            _refuse(axis, "a range over a grid needs its COUNT: START:STOP:COUNT")
    whole = Grid(_in_order(axes, speeds))
    if size(whole) > MOST:
        raise BadInput(f"expected at most {MOST:.0e} points, not {size(whole):.3g}", key="--vary")
    return whole


def sample(axes: Sequence[Axis], speeds: Sequence[float], count: int, seed: int) -> Sample:
    """So many points over all axes."""
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST:
        raise BadInput(f"expected a whole number of points from 1 to {MOST:.0e}", key="--sample", value=count)
    return Sample(_in_order(axes, speeds), count, seed, any(axis.name == SPEEDS and axis.spread for axis in axes))


def _in_order(axes: Sequence[Axis], speeds: Sequence[float]) -> tuple[Axis, ...]:
    def rank(axis: Axis) -> int:
        if axis.name == SPEEDS:
            return 4
        if of_the_plate(axis.key):
            return 0
        return 1 if of_the_cavity(axis.key) else 2 if of_the_mass(axis.key) else 3

    listed = list(axes)
    if not any(axis.name == SPEEDS for axis in listed):
        listed.append(Axis(find(SPEEDS, "--vary"), tuple(speeds)))
    return tuple(sorted(listed, key=rank))


def _refuse(axis: Axis, problem: str) -> None:
    raise BadInput(problem, key=f"--vary {axis.name}", value=axis.text)


def base(source: SceneFile, varied: Sequence[Key]) -> Data:
    """The study's scene as plain data, ready for these keys.

    Raises:
        BadInput: it lacks a table that a key belongs to.
    """
    data = written_out(plain(source.scene), varied)
    for key in varied:
        table = key.table[0]
        if table not in data:
            raise BadInput(f"the scene {source.name} has no [{table}]", key=f"--vary {key.name}")
    return data


def with_values(data: Data, values: Mapping[Key, Value]) -> Data:
    """A copy of plain data with values put in; clearances last, which add to the ball's diameter."""
    changed = copy.deepcopy(data)
    for key in sorted(values, key=lambda key: key.name.startswith(CLEARANCE)):
        key.put(changed, values[key])
    return changed


def of_a_point(source: SceneFile, data: Data, speeds: Sequence[float]) -> SceneFile:
    """The scene of plain data at these speeds.

    Raises:
        BadInput: its values are wrong together.
    """
    table, name = SPEEDS.split(".")
    whole = data | {table: data[table] | {name: list(speeds)}}
    return replace(source, scene=parse(whole, source.name), remarks=())
