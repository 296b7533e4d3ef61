"""What a quantity of the results is: said once, in the annotation of the record's field that holds it.

Whatever writes results walks these annotations: JSON and its schema, netCDF, CSV, the columns of a sweep. A quantity
may also be a property, whose annotation is that of what it returns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

T = TypeVar("T")


class Rows(NamedTuple):
    """A list whose rows have arrays as their columns: its name, the dimension along it, and its meaning."""

    name: str
    along: str
    meaning: str = ""


@dataclass(frozen=True)
class Quantity:
    """A number, a pair of numbers, or a text.

    Attributes:
        unit: of a number, "1" where it has none; empty for a text.
        meaning: in words; empty where the name says it.
        name: under which it is published, if not that of the field.
        short: what the key of a picture calls it; empty where none does.
        alone: its name where it stands beside those of other records, if not that of the field.
        ends: what tells the two of a pair apart.
        rows: the list that an array is a column of.
        least: of a whole number.
        unknown: whether a number may be none that is finite, which is published as null.
        absent: whether it is left out where there is none, and not null.
        inner: whether it is left out of JSON.
        within: the part of the outer record in which it is published.
        headline: whether a sweep has a column of it.
    """

    unit: str
    meaning: str = ""
    name: str = ""
    short: str = ""
    alone: str = ""
    ends: tuple[str, str] = ("x", "y")
    rows: Rows | None = None
    least: int = 0
    unknown: bool = False
    absent: bool = False
    inner: bool = False
    within: str = ""
    headline: bool = False

    def said(self, name: str, end: int | None = None) -> str:
        """The meaning, or else a name in words; `end`: of which of a pair."""
        meaning = self.meaning or name.replace("_", " ")
        return meaning if end is None else f"{meaning}: {self.ends[end]}"


@dataclass(frozen=True)
class Part:
    """A record within a record, or a tuple of them; left out where there is none.

    Attributes:
        meaning: in words.
        name: under which it is published, if not that of the field.
        prefix: of its quantities' names where they stand beside those of other records.
        along: the dimension of a tuple.
        always: whether it is published where there is none, as null or as an empty list.
        inline: whether its quantities stand in the outer record, with the prefix.
        within: as of a quantity.
        headline: whether a sweep has columns of it.
    """

    meaning: str = ""
    name: str = ""
    prefix: str = ""
    along: str = ""
    always: bool = False
    inline: bool = False
    within: str = ""
    headline: bool = True


@dataclass(frozen=True)
class Entry:
    """A quantity or a part of a record.

    Attributes:
        attribute: of the record; name: under which it is published.
        what: quantity or part.
        kind: `float`, `int`, `str`, `tuple` for a pair, `list` for an array, or the class of a record.
        optional: whether None is among its values; many: whether it is a tuple of records.
    """

    attribute: str
    name: str
    what: Quantity | Part
    kind: type
    optional: bool
    many: bool


@cache
def entries(record: type) -> tuple[Entry, ...]:
    """The quantities and parts of a record, its fields first, in their order."""
    hints = get_type_hints(record, include_extras=True)
    found = [_entry(field.name, hints[field.name]) for field in fields(record)]
    for kind in reversed(record.__mro__):
        properties = {name: each.fget for name, each in vars(kind).items() if isinstance(each, property)}
        found += [
            _entry(name, get_type_hints(get, include_extras=True).get("return")) for name, get in properties.items()
        ]
    return tuple(entry for entry in found if entry is not None)


def _entry(attribute: str, hint: Any) -> Entry | None:
    if get_origin(hint) is not Annotated:
        return None
    inner, *said = get_args(hint)
    what = next((each for each in said if isinstance(each, Quantity | Part)), None)
    if what is None:
        return None
    kinds = get_args(inner) if get_origin(inner) is UnionType else (inner,)
    (kind,) = (each for each in kinds if each is not NoneType)
    many = isinstance(what, Part) and get_origin(kind) is tuple
    if many:
        kind = get_args(kind)[0]
    elif get_origin(kind) is tuple:
        kind = tuple
    elif isinstance(what, Quantity) and what.rows is not None:
        kind = list
    return Entry(attribute, what.name or attribute, what, kind, NoneType in kinds, many)


def taken_over(record: type[T], found: object, **more: object) -> T:
    """A record whose fields are those of the same names of another object, and more."""
    given: Mapping[str, Any] = {f.name: getattr(found, f.name) for f in fields(record) if f.name not in more}  # type: ignore[arg-type]
    return record(**given, **more)
