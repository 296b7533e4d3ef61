"""What is varied: a key over listed values or over a range, as ``--vary KEY=…`` or a dict of Python has it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from workflows.errors import BadInput, shown
from workflows.studies.sweep import keys
from workflows.studies.sweep.keys import CLEARANCE, SPEEDS, Key, Value

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
            found: np.ndarray = truncnorm.ppf(share, *ends, loc=self.mean, scale=self.deviation)
            return found
        return np.clip(self.low + share * (self.high - self.low), self.low, self.high)


@dataclass(frozen=True)
class Axis:
    """A key and its values in SI, ascending as they were given; `spread` where it is a range, and the `text` of it.

    A range without a count, which a sample takes, has no values.
    """

    key: Key
    values: tuple[Value, ...]
    spread: Spread | None = None
    text: str = field(default="", compare=False)

    @property
    def name(self) -> str:
        """Of the dimension or coordinate."""
        return self.key.name


def read(given: Mapping[str, object] | Iterable[str], gravity: float) -> tuple[Axis, ...]:
    """Axes from ``KEY=VALUES`` texts, or from a dict of keys and values (a text of that form, a list, an array).

    Args:
        given: what is varied.
        gravity: the unit g of accelerations [m/s²].

    Raises:
        BadInput: an unknown key or a wrong value, which the message names.
    """
    where = "vary" if isinstance(given, Mapping) else "--vary"
    pairs = list(given.items()) if isinstance(given, Mapping) else [_split(text) for text in given]
    axes = []
    for name, values in pairs:
        key = keys.find(name.strip(), where)
        try:
            axes.append(_axis(key, values, gravity))
        except ValueError as error:
            value = values if isinstance(values, str) else np.asarray(values).tolist()
            raise BadInput(str(error), key=f"{where} {key.name}", value=value) from error
    _check_apart(axes, where)
    return tuple(axes)


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
        return _listed(key, items, gravity)
    return replace(_ranged(key, values, gravity), text=values.strip())


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
    found = np.rint(values)
    if np.abs(found - values).max(initial=0.0) > 1e-9:
        raise ValueError("expected a COUNT that leads through whole numbers")
    return tuple(int(value) for value in found)


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text[:12]) <= MOST:
        raise ValueError(f"expected a whole number of values from 1 on as COUNT, not {shown(text)}")
    return int(text)


def _listed(key: Key, items: list[object], gravity: float) -> Axis:
    if not items:
        raise ValueError("expected at least one value")
    found = tuple(key.read(item, gravity) for item in items)
    if len(set(found)) < len(found):
        raise ValueError("expected every value once")
    if len({isinstance(value, str | bool) for value in found}) > 1:
        raise ValueError("expected numbers or words, not both")
    return Axis(key, found)


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


__all__ = ["CLEARANCE", "MOST", "SPEEDS", "Axis", "Spread", "read"]
