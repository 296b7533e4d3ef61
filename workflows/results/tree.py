"""Records as plain data: every quantity of a record under its name, numbers finite, an unknown one None."""

from __future__ import annotations

import math
from typing import Any

from workflows.solve.quantity import Entry, Part, Rows, entries


def tree(record: Any) -> dict[str, Any]:
    """A record as it is published; its quantities and parts are those that its annotations say."""
    found: dict[str, Any] = {}
    kind: type = type(record)
    for entry in entries(kind):
        within = entry.what.within
        target = found if not within else found.get(within)
        if target is None:  # the part that it belongs to is not there
            continue
        value = getattr(record, entry.attribute)
        if isinstance(entry.what, Part):
            target |= _part(entry, entry.what, value)
        elif entry.what.rows is not None:
            _column(target, entry.name, entry.what.rows, value)
        elif not entry.what.inner and not (entry.what.absent and value is None):
            target[entry.name] = _plain(entry, value)
    return found


def _part(entry: Entry, part: Part, value: Any) -> dict[str, Any]:
    if entry.many:
        return {entry.name: [tree(each) for each in value]} if value or part.always else {}
    if value is None:
        return {entry.name: None} if part.always else {}
    inner = tree(value)
    return {part.prefix + name: each for name, each in inner.items()} if part.inline else {entry.name: inner}


def _column(target: dict[str, Any], name: str, rows: Rows, values: Any) -> None:
    """One more column of a list of rows."""
    found = target.setdefault(rows.name, [{} for _ in values])
    for row, value in zip(found, values, strict=True):
        row[name] = number(value)


def _plain(entry: Entry, value: Any) -> Any:
    if entry.kind is tuple:
        return [number(each) for each in value]
    return number(value) if entry.kind is float else value


def number(value: float | None) -> float | None:
    """A plain finite float, or None: JSON knows no NaN."""
    return float(value) if value is not None and math.isfinite(value) else None
