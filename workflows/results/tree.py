"""Records as plain data: every quantity of a record under its name, numbers finite, an unknown one None.

All records of a kind are published together, one quantity after the other: a run at many speeds holds a hundred
thousand numbers, and what a quantity is need not be asked for each of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, islice
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from workflows.solve.quantity import Entry, Part, Quantity, Rows, entries

Published = dict[str, Any]


def trees(kind: type, records: Sequence[Any]) -> list[Published]:
    """Records of a kind as they are published; their quantities and parts are those that its annotations say."""
    found: list[Published] = [{} for _ in records]
    for entry in entries(kind) if records else ():
        targets, owners = found, records
        if within := entry.what.within:  # where the part that it belongs to is there
            targets = [each[within] for each in found if each.get(within)]
            owners = [owner for owner, each in zip(records, found, strict=True) if each.get(within)] if targets else []
        values = list(map(attrgetter(entry.attribute), owners))
        if isinstance(entry.what, Part):
            (_many if entry.many else _part)(targets, entry, entry.what, values)
        elif entry.what.rows is not None:
            _column(targets, entry.name, entry.what.rows, values)
        elif not entry.what.inner:
            _quantity(targets, entry, entry.what, values)
    return found


def _quantity(targets: list[Published], entry: Entry, quantity: Quantity, values: list[Any]) -> None:
    plain, name = numbers(values) if entry.kind in (float, tuple) else values, entry.name
    for target, value in zip(targets, plain, strict=True):
        if value is not None or not quantity.absent:
            target[name] = value


def _column(targets: list[Published], name: str, rows: Rows, values: list[Any]) -> None:
    """One more column of a list of rows."""
    lists = [target.setdefault(rows.name, [{} for _ in each]) for target, each in zip(targets, values, strict=True)]
    columns = numbers(np.concatenate(values)) if values else []
    for row, value in zip(chain.from_iterable(lists), columns, strict=True):
        row[name] = value


def _many(targets: list[Published], entry: Entry, part: Part, values: list[Any]) -> None:
    published = iter(trees(entry.kind, list(chain.from_iterable(values))))
    for target, mine in zip(targets, values, strict=True):
        if mine or part.always:
            target[entry.name] = list(islice(published, len(mine)))


def _part(targets: list[Published], entry: Entry, part: Part, values: list[Any]) -> None:
    known = [each for each in values if each is not None]
    published = iter(trees(entry.kind, known))
    for target, value in zip(targets, values, strict=True) if known or part.always else ():
        inner = None if value is None else next(published)
        if inner is not None and part.inline:
            target |= {part.prefix + name: each for name, each in inner.items()}
        elif inner is not None or part.always:
            target[entry.name] = inner


def numbers(values: npt.ArrayLike) -> list[Any]:
    """Numbers, or pairs of them, as plain finite floats, or None: JSON knows no NaN."""
    array = np.array(values, float)  # None becomes NaN
    finite = np.isfinite(array)
    if finite.all():
        return list(array.tolist())
    found = array.astype(object)
    found[~finite] = None
    return list(found.tolist())
