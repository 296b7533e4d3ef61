"""`results.json`: the machine-readable results, as the published schema (results.schema.json) describes them."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import chain, islice
from operator import attrgetter, itemgetter
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from workflows.effects.definition import Effect, LeftOut
from workflows.errors import BadInput
from workflows.progress import NAMES
from workflows.results import provenance
from workflows.scene.load import parse
from workflows.scene.scene import Scene
from workflows.solve import results as records
from workflows.solve.results import Entry, Part, Quantity, Results, Rows, SpeedPoint, Theory, entries, expect


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


NAME = "run.npz"
VERSION = 3

Arrays = list[npt.NDArray[Any]]

_OURS = (Effect, LeftOut, Theory, *(kind for kind in vars(records).values() if is_dataclass(kind)))
_KINDS: dict[str, Any] = {kind.__name__: kind for kind in _OURS if isinstance(kind, type)}
"""Records that a file may hold, by name."""


def write(results: records.Results, path: Path) -> None:
    """Keep a run but for its times, which stand in `results.json`: the same scene keeps the same bits.

    Raises:
        OSError: the file system refuses.
    """
    arrays: Arrays = []
    tree = _packed(replace(results, timings={}), arrays)
    text = json.dumps({"version": VERSION, "run": tree}, ensure_ascii=False)
    named = {f"array_{number}": array for number, array in enumerate(arrays)}
    np.savez_compressed(path, tree=np.frombuffer(text.encode(), np.uint8), **named)  # type: ignore[arg-type]


def read(folder: str | os.PathLike[str]) -> records.Results:
    """What a run left in a folder, or in its file `run.npz`.

    Raises:
        BadInput: there is no run of ours, or one of another version.
        TypeError: not the name of a folder.
    """
    if not isinstance(folder, str | os.PathLike):
        raise TypeError(f"load_results takes the name of a folder that a run has written, got {type(folder).__name__}")
    given = Path(folder)
    path = given / NAME if given.is_dir() else given
    try:
        with path.open("rb") as file, np.load(file) as kept:
            document = json.loads(kept["tree"].tobytes())
            arrays = [kept[f"array_{number}"] for number in range(len(kept.files) - 1)]
        if document["version"] != VERSION:
            raise _unreadable(given, f"has version {document['version']} of what a run keeps: expected {VERSION}")
        found = _unpacked(document["run"], arrays)
    except FileNotFoundError:
        raise _unreadable(
            given, f"holds no run: expected a folder with {NAME}, as `spindamp run --out` writes"
        ) from None
    except OSError as error:
        raise _unreadable(given, f"cannot be read: {error.strerror or error}") from error
    except (BadZipFile, ValueError, KeyError, IndexError, TypeError, EOFError) as error:
        raise _unreadable(given, f"is not what a run of ours keeps: {error}") from error
    if not isinstance(found, records.Results):
        raise _unreadable(given, "is not what a run of ours keeps")
    return replace(found, timings=_timings(path))


def _timings(path: Path) -> dict[str, float]:
    """What the stages took, from the file beside; nothing where that is gone."""
    try:
        return dict(json.loads(path.with_name("results.json").read_text(encoding="utf-8"))["timings"])
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _unreadable(path: Path, problem: str) -> BadInput:
    return BadInput(problem, key="folder", value=str(path))


def _packed(value: Any, arrays: Arrays) -> Any:
    if value is None or isinstance(value, bool | int | float | str):
        return value.item() if isinstance(value, np.generic) else value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {"array": len(arrays) - 1}
    if isinstance(value, tuple | list):
        return {type(value).__name__: [_packed(item, arrays) for item in value]}
    if isinstance(value, dict):
        return {"dict": [[_packed(key, arrays), _packed(item, arrays)] for key, item in value.items()]}
    if isinstance(value, Scene):
        return {"scene": _scene(value)}
    kind = next(known.__name__ for known in type(value).__mro__ if _KINDS.get(known.__name__) is known)
    return {"record": kind, "fields": {f.name: _packed(getattr(value, f.name), arrays) for f in fields(value)}}


def _scene(scene: Scene) -> dict[str, Any]:
    """The scene as one that can be read again: a material by its name has no numbers beside it."""
    data = scene.model_dump(mode="json", exclude_none=True)
    for table, name, numbers in (
        ("material", "name", ("youngs_modulus", "poissons_ratio", "density")),
        ("damper", "ball_material", ("ball_density",)),
    ):
        if name in data.get(table, {}):
            data[table] = {key: item for key, item in data[table].items() if key not in numbers}
    return data


def _unpacked(tree: Any, arrays: Arrays) -> Any:
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        return arrays[tree["array"]]
    if "scene" in tree:
        return parse(tree["scene"])
    if "dict" in tree:
        return {_unpacked(key, arrays): _unpacked(item, arrays) for key, item in tree["dict"]}
    if "record" in tree:
        return _KINDS[tree["record"]](**{name: _unpacked(item, arrays) for name, item in tree["fields"].items()})
    ((name, items),) = tree.items()
    made = [_unpacked(item, arrays) for item in items]
    return tuple(made) if name == "tuple" else made


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
            (_many if entry.many else _tree_part)(targets, entry, entry.what, values)
        elif entry.what.rows is not None:
            _tree_column(targets, entry.name, entry.what.rows, values)
        elif not entry.what.inner:
            _quantity_of_tree(targets, entry, entry.what, values)
    return found


def _quantity_of_tree(targets: list[Published], entry: Entry, quantity: Quantity, values: list[Any]) -> None:
    plain, name = numbers(values) if entry.kind in (float, tuple) else values, entry.name
    for target, value in zip(targets, plain, strict=True):
        if value is not None or not quantity.absent:
            target[name] = value


def _tree_column(targets: list[Published], name: str, rows: Rows, values: list[Any]) -> None:
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


def _tree_part(targets: list[Published], entry: Entry, part: Part, values: list[Any]) -> None:
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


SCHEMA_VERSION = 1


def document(results: Results) -> dict[str, Any]:
    """The results as plain data: numbers are finite, an unknown one is None, SI unless a name says otherwise.

    Raises:
        TypeError: not results.
    """
    expect(results, "document")
    return {
        "schema_version": SCHEMA_VERSION,
        "title": results.scene.title,
        "scene": provenance.resolved_scene(results.scene, results.effects, results.theory),
        **provenance.hashes(results),
        "versions": provenance.versions(),
        "timings": dict(zip(results.timings, numbers(list(results.timings.values())), strict=True)),
        "notes": list(results.notes),
        "effects": {name: {"on": effect.on, "why": effect.why} for name, effect in results.effects.items()},
        "speeds": trees(SpeedPoint, results.speeds),
    }


def dumps(results: Results) -> str:
    """The document as JSON text that any parser reads."""
    return json.dumps(document(results), indent=1, ensure_ascii=False, allow_nan=False)


_HASH = {"type": "string", "pattern": "^[0-9a-f]{64}$"}


def schema() -> dict[str, Any]:
    """The schema: what every run has, and what a speed has."""
    effect = closed({"on": {"type": "boolean"}, "why": {"type": "string"}}, ["on", "why"])
    stages = closed({name: {"type": "number", "minimum": 0} for name in NAMES}, ["total"])
    hashes = {
        "scene_sha256": "of the scene as JSON in UTF-8 with sorted keys and no spaces; the same in every file of a run",
        "mesh_sha256": "of the mesh file's bytes, where the scene names one; the same in every file of a run",
    }
    whole = {
        "schema_version": {"const": SCHEMA_VERSION},
        "title": {"type": "string"},
        "scene": {"type": "object", "description": "the scene with defaults filled in and choices made"},
        **{name: {**_HASH, "description": said} for name, said in hashes.items()},
        "versions": {"type": "object", "additionalProperties": {"type": "string"}},
        "timings": {**stages, "description": "seconds; a stage not run is absent"},
        "notes": {"type": "array", "items": {"type": "string"}},
        "effects": {"type": "object", "additionalProperties": effect},
        "speeds": {"type": "array", "items": of(SpeedPoint)},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "spindamp results",
        "description": "results.json of a run. SI units unless a name says otherwise; g is [rotor] gravity.",
        **closed(whole, [name for name in whole if name != "mesh_sha256"]),
    }


def closed(properties: dict[str, Any], required: list[str]) -> dict[str, Any]:
    """An object without other keys."""
    return {"type": "object", "additionalProperties": False, "required": required, "properties": properties}


def of(record: type) -> dict[str, Any]:
    """The schema of a record: its quantities and parts, and those that stand within its parts."""
    found = closed({}, [])
    for entry in entries(record):
        target = found["properties"][entry.what.within] if entry.what.within else found
        if isinstance(entry.what, Part):
            _part(target, entry, entry.what)
        elif entry.what.rows is not None:
            _column(target, entry, entry.what)
        elif not entry.what.inner:
            _add(target, entry.name, _quantity_schema(entry, entry.what), required=not entry.what.absent)
    return found


def _part(target: dict[str, Any], entry: Entry, part: Part) -> None:
    inner = of(entry.kind)
    if part.inline:
        for name, each in inner["properties"].items():
            _add(target, part.prefix + name, each, required=False)
        return
    if entry.many:
        inner = {"type": "array", "items": inner}
    elif part.always:
        inner["type"] = ["object", "null"]
    required = part.always or not (entry.optional or entry.many)
    _add(target, entry.name, _said(inner, part.meaning), required=required)


def _column(target: dict[str, Any], entry: Entry, quantity: Quantity) -> None:
    rows = quantity.rows
    if rows is None:
        raise ValueError(f"{entry.attribute} is no column")
    if rows.name not in target["properties"]:
        _add(target, rows.name, _said({"type": "array", "items": closed({}, [])}, rows.meaning), required=True)
    _add(target["properties"][rows.name]["items"], entry.name, _quantity_schema(entry, quantity), required=True)


def _add(target: dict[str, Any], name: str, inner: dict[str, Any], *, required: bool) -> None:
    target["properties"][name] = inner
    if required:
        target["required"].append(name)


def _quantity_schema(entry: Entry, quantity: Quantity) -> dict[str, Any]:
    unit = f", {quantity.unit}" if quantity.unit not in ("", "1") else ""
    return _said(_type(entry, quantity), f"{quantity.meaning}{unit}".removeprefix(", "))


def _type(entry: Entry, quantity: Quantity) -> dict[str, Any]:
    if entry.kind is str:
        return {"type": "string"}
    if entry.kind is int:
        return {"type": "integer", "minimum": quantity.least}
    if entry.kind is tuple:
        return {"type": "array", "items": {"type": ["number", "null"]}, "minItems": 2, "maxItems": 2}
    perhaps = (entry.optional and not quantity.absent) or quantity.unknown
    return {"type": ["number", "null"] if perhaps else "number"}


def _said(inner: dict[str, Any], meaning: str) -> dict[str, Any]:
    return {**inner, "description": meaning} if meaning else inner


def text() -> str:
    """The schema as the file has it."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    Path(__file__).parents[1].joinpath("results.schema.json").write_text(text(), encoding="utf-8")
