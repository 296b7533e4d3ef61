"""Records side by side: quantities of many speeds as labelled columns, for data sets, tables and sweeps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter, itemgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from workflows.solve.quantity import Entry, Part, Quantity, entries


@dataclass(frozen=True, eq=False)
class Column:
    """A quantity over records: its name beside all others, unit, meaning, dimensions, and values.

    Where a record has no value, or fewer than others, there is NaN, or no text.
    """

    name: str
    unit: str
    meaning: str
    dims: tuple[str, ...]
    values: npt.NDArray[Any]


def columns(kind: type, records: Sequence[Any], dims: tuple[str, ...], prefix: str = "") -> Iterator[Column]:
    """Every quantity of records of a kind, those of its parts last; nothing where there is no record.

    Args:
        kind: the class of the records.
        records: lists of records, of lists of them, and so on, one level for each dimension; None where there is none.
        dims: their dimensions.
        prefix: of the names.
    """
    if not any(True for _ in _known(records, len(dims))):
        return
    for entry in sorted(entries(kind), key=lambda entry: isinstance(entry.what, Part)):
        values = _each(records, len(dims), attrgetter(entry.attribute))
        if isinstance(entry.what, Part):
            inner = (*dims, entry.what.along) if entry.many else dims
            yield from columns(entry.kind, values, inner, prefix + entry.what.prefix)
        else:
            yield from _columns(entry, entry.what, values, dims, prefix)


def _columns(
    entry: Entry, quantity: Quantity, values: list[Any], dims: tuple[str, ...], prefix: str
) -> Iterator[Column]:
    dims = (*dims, quantity.rows.along) if quantity.rows is not None else dims
    nothing = np.array("", object) if entry.kind is str else np.array(np.nan)
    for name, end in _names(entry, quantity, prefix):
        each = values if end is None else _each(values, len(dims), itemgetter(end))
        if not quantity.absent or any(True for _ in _known(each, len(dims))):
            said = quantity.said(name, end)
            yield Column(name, quantity.unit, said, dims, _table(each, len(dims), nothing))


def _names(entry: Entry, quantity: Quantity, prefix: str) -> list[tuple[str, int | None]]:
    """What a quantity is called beside those of other records: one name, or one for each of a pair with its number."""
    name = prefix + entry.name if prefix else quantity.alone or entry.name
    if entry.kind is not tuple:
        return [(name, None)]
    return [(f"{name}_{end}", number) for number, end in enumerate(quantity.ends)]


@dataclass(frozen=True)
class Headline:
    """A quantity that a sweep has a column of, by the name that a data set has for it.

    `path`: attributes that lead to it from the record, and the number of one of a pair.
    """

    name: str
    unit: str
    meaning: str
    kind: type
    path: tuple[str | int, ...]

    def of(self, record: object) -> Any:
        """Its value; None where a record on the way is not there."""
        found: Any = record
        for step in self.path:
            if found is not None:
                found = found[step] if isinstance(step, int) else getattr(found, step)
        return found


def headlines(kind: type, path: tuple[str, ...] = (), prefix: str = "") -> Iterator[Headline]:
    """Those of a record and its parts."""
    for entry in entries(kind):
        here, what = (*path, entry.attribute), entry.what
        if isinstance(what, Part):
            if not entry.many and what.headline:
                yield from headlines(entry.kind, here, prefix + what.prefix)
        elif what.headline:
            for name, end in _names(entry, what, prefix):
                value = float if entry.kind is tuple else entry.kind
                yield Headline(name, what.unit, what.said(name, end), value, here if end is None else (*here, end))


def _each(records: Any, depth: int, what: Callable[[Any], Any]) -> Any:
    """Something of every record in lists of lists; None where there is no record."""
    if records is None:
        return None
    return [_each(each, depth - 1, what) for each in records] if depth else what(records)


def _known(records: Any, depth: int) -> Iterator[Any]:
    """Every record, or value, that there is."""
    if records is None:
        return
    if depth == 0:
        yield records
        return
    for each in records:
        yield from _known(each, depth - 1)


def _table(values: list[Any], depth: int, nothing: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Lists of lists as one array, filled up with what stands for nothing."""
    table = np.full(_shape(values, depth), nothing, nothing.dtype)
    _fill(table, values)
    return table


def _shape(values: Any, depth: int) -> tuple[int, ...]:
    """The least shape that holds lists of lists."""
    if depth == 0:
        return ()
    found = values if values is not None else []
    inner = [_shape(each, depth - 1) for each in found] or [(0,) * (depth - 1)]
    return (len(found), *map(max, zip(*inner, strict=True)))


def _fill(table: npt.NDArray[Any], values: Any) -> None:
    """Write lists of lists into the corner of an array."""
    for place, each in enumerate(values if values is not None else ()):
        if table.ndim > 1:
            _fill(table[place], each)
        elif each is not None:
            table[place] = each
