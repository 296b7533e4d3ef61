"""Records side by side: quantities of many speeds as labelled columns, for data sets, tables and sweeps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
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


@dataclass(frozen=True, eq=False)
class _Listed:
    """Records of a kind, or values, from anywhere in lists of lists, and where each stood.

    Attributes:
        each: those that there are.
        at: their places, an array for each dimension.
        shape: of a table that holds all.
    """

    each: Sequence[Any]
    at: tuple[npt.NDArray[np.int64], ...]
    shape: tuple[int, ...]

    def known(self, what: Callable[[Any], Any]) -> _Listed:
        """Something of each, where that is not None."""
        values = list(map(what, self.each))
        kept = [place for place, value in enumerate(values) if value is not None]
        if len(kept) == len(values):
            return _Listed(values, self.at, self.shape)
        return _Listed([values[place] for place in kept], tuple(places[kept] for places in self.at), self.shape)

    def within(self) -> _Listed:
        """What stands in each, one dimension more."""
        lengths = np.fromiter(map(len, self.each), np.int64, len(self.each))
        inner = np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        outer = (np.repeat(places, lengths) for places in self.at)
        longest = int(lengths.max(initial=0))
        return _Listed(list(chain.from_iterable(self.each)), (*outer, inner), (*self.shape, longest))

    def table(self, nothing: float | str) -> npt.NDArray[Any]:
        """The values as one array, filled up with what stands for nothing."""
        table = np.full(self.shape, nothing, float if isinstance(nothing, float) else object)
        table[self.at] = self.each
        return table


def columns(kind: type, records: Sequence[Any], along: str) -> Iterator[Column]:
    """Every quantity of records of a kind, those of their parts last; nothing where there is no record.

    Args:
        kind: the class of the records.
        records: in their order.
        along: the name of that dimension.
    """
    yield from _columns(kind, _Listed(records, (np.arange(len(records)),), (len(records),)), (along,), "")


def _columns(kind: type, records: _Listed, dims: tuple[str, ...], prefix: str) -> Iterator[Column]:
    if not records.each:
        return
    for entry in sorted(entries(kind), key=lambda entry: isinstance(entry.what, Part)):
        values = records.known(attrgetter(entry.attribute))
        if isinstance(entry.what, Part):
            inner, along = (values.within(), (entry.what.along,)) if entry.many else (values, ())
            yield from _columns(entry.kind, inner, (*dims, *along), prefix + entry.what.prefix)
        elif entry.what.rows is not None:
            yield from _quantity(entry, entry.what, values.within(), (*dims, entry.what.rows.along), prefix)
        else:
            yield from _quantity(entry, entry.what, values, dims, prefix)


def _quantity(
    entry: Entry, quantity: Quantity, values: _Listed, dims: tuple[str, ...], prefix: str
) -> Iterator[Column]:
    nothing = "" if entry.kind is str else math.nan
    for name, end in _names(entry, quantity, prefix):
        each = values if end is None else values.known(itemgetter(end))
        if not quantity.absent or each.each:
            yield Column(name, quantity.unit, quantity.said(name, end), dims, each.table(nothing))


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
