"""The results as files carry them: JSON, its schema, columns for data sets and sweeps, and reading a run back.

All of it is what pydantic makes of the records' annotations (:mod:`workflows.solve.results`).
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, TypeAlias, get_type_hints

import numpy as np
import numpy.typing as npt
from pydantic import Field, TypeAdapter
from pydantic.fields import FieldInfo
from pydantic.json_schema import GenerateJsonSchema

from workflows import docstrings
from workflows.errors import BadInput
from workflows.io import provenance
from workflows.scene.load import non_file_kind, parse
from workflows.solve.results import Results, SpeedPoint, VibrationReduction, copy_fields, require_results
from workflows.versions import versions

if TYPE_CHECKING:
    import h5netcdf


SCHEMA_VERSION: Final = 1
NAME = "results.json"
DATA = "results.nc"

_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


@dataclass(frozen=True)
class Switch:
    """Whether an effect is simulated."""

    on: bool
    why: str


@dataclass(frozen=True)
class Document:
    """results.json of a run. SI units unless a name says otherwise; g is [rotor] gravity."""

    schema_version: Literal[1]
    title: str
    scene: dict[str, Any]
    """the scene with defaults filled in and choices made"""
    scene_sha256: _Hash
    """of the scene as JSON in UTF-8 with sorted keys and no spaces; the same in every file of a run"""
    versions: dict[str, str]
    timings: dict[Literal["mesh", "prestress", "modes", "reduction", "damper", "write", "report", "total"], float]
    """seconds; a stage not run is absent"""
    notes: tuple[str, ...]
    effects: dict[str, Switch]
    speeds: tuple[SpeedPoint, ...]
    reductions: tuple[VibrationReduction, ...] = ()
    """at each crossing of an engine order of [excitation] with a mode, from free vibration"""
    root_length: float | None = None
    """m, of the plate's clamped edge, or of that on springs; absent without a plate"""
    mesh_sha256: _Hash | None = None
    """of the mesh file's bytes, where the scene names one; the same in every file of a run"""


@cache
def adapter(kind: Any) -> TypeAdapter[Any]:
    """What pydantic knows of a kind of records."""
    return TypeAdapter(kind)


def _json(results: Results, indent: int | None) -> str:
    whole = copy_fields(
        Document,
        results,
        schema_version=SCHEMA_VERSION,
        title=results.scene.title,
        scene=provenance.resolved_scene(results.scene, results.effects, results.theory),
        scene_sha256=provenance.scene_sha256(results),
        versions=versions(),
        effects={name: Switch(effect.on, effect.why) for name, effect in results.effects.items()},
        root_length=None if results.diagram is None else results.diagram.root_length,
    )
    return adapter(Document).dump_json(whole, indent=indent, by_alias=True, exclude_defaults=True).decode()


def document(results: Results) -> dict[str, Any]:
    """The results as plain data: numbers are finite, an unknown one is None, SI unless a name says otherwise.

    Raises:
        TypeError: not results.
    """
    require_results(results, "document")
    values: dict[str, Any] = json.loads(_json(results, None))
    return values


def dumps(results: Results) -> str:
    """The document as JSON text that any parser reads."""
    return _json(results, 1)


class _Closed(GenerateJsonSchema):
    """Objects have no other keys; names say what titles would, and docstrings what each key means."""

    def dataclass_schema(self, schema: Any) -> dict[str, Any]:
        closed = super().dataclass_schema(schema) | {"additionalProperties": False}
        closed.pop("description", None)
        record = schema["cls"]
        for name, text in docstrings.of_fields(record).items():
            if (key := _fields(record)[name].alias or name) in closed["properties"]:
                closed["properties"][key]["description"] = text
        return closed

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def schema(kind: type = Document) -> dict[str, Any]:
    """The schema of results.json, or of a part of it."""
    return adapter(kind).json_schema(mode="serialization", schema_generator=_Closed)


def text() -> str:
    """The schema as the file has it."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "description": Document.__doc__}
    return json.dumps(head | schema(), indent=1, ensure_ascii=False) + "\n"


@dataclass(frozen=True)
class Quantity:
    """A quantity of records by the name that a data set has for it, beside those of all other records.

    Attributes:
        kind: `number`, `integer` or `string`; or, of columns of a sweep, a data type.
        path: keys that lead to it in published data; where one leads to a list, the next is that list's dimension.
        end: which number of a pair it is.
        headline: whether sweeps have a column of it.
    """

    name: str
    unit: str
    meaning: str
    kind: str = "number"
    path: tuple[str, ...] = ()
    dims: tuple[str, ...] = ()
    end: int | None = None
    headline: bool = False

    @property
    def dtype(self) -> str:
        """Its data type."""
        return {"number": "f8", "integer": "i8"}.get(self.kind, self.kind)

    @property
    def attributes(self) -> dict[str, str]:
        """What a data set says of it."""
        return ({"units": self.unit} if self.unit else {}) | {"long_name": self.meaning}

    def of(self, published: Mapping[str, Any]) -> Any:
        """Its value in a record that has one; None where a record on the way is not there."""
        value: Any = published
        for key in self.path:
            value = None if value is None else value.get(key)
        return value if value is None or self.end is None else value[self.end]

    def table(self, shape: tuple[int, ...], values: Mapping[_Place, Any]) -> npt.NDArray[Any]:
        """Values in an array, each in its place, with NaN, or no text, where there is none."""
        table: npt.NDArray[Any] = np.full(shape, "", object) if self.kind == "string" else np.full(shape, np.nan)
        for place, value in values.items():
            if value is not None:
                table[place] = value if self.end is None else value[self.end]
        return table


@cache
def quantities(kind: type) -> tuple[Quantity, ...]:
    """Every quantity of records of a kind, those of their parts last."""
    whole = schema(kind)
    return tuple(_quantities(whole, whole.get("$defs", {}), (), (), "", True))


def _quantities(
    record: Mapping[str, Any],
    known: Mapping[str, Any],
    path: tuple[str, ...],
    dims: tuple[str, ...],
    prefix: str,
    headline: bool,
) -> Iterator[Quantity]:
    parts = []
    for key, annotation in record["properties"].items():
        inner = next((each for each in annotation.get("anyOf", ()) if each.get("type") != "null"), annotation)
        row = inner.get("items", {}) if "prefixItems" not in inner else {}
        if (reference := inner.get("$ref") or row.get("$ref")) is not None:
            parts.append((key, annotation, known[reference.rpartition("/")[2]]))
            continue
        name = prefix + key if prefix else annotation.get("alone", key)
        kind = inner["type"]
        for end, suffix in enumerate(annotation.get("ends", ("x", "y"))) if kind == "array" else ((None, ""),):
            meaning = annotation["description"]
            yield Quantity(
                name=f"{name}_{suffix}" if suffix else name,
                unit=annotation["unit"],
                meaning=f"{meaning}: {suffix}" if suffix else meaning,
                kind=kind if isinstance(kind, str) and kind != "array" else "number",
                path=(*path, key),
                dims=dims,
                end=end,
                headline=headline and annotation.get("headline", False),
            )
    for key, annotation, inner in parts:
        along = (annotation["along"],) if "along" in annotation else ()
        mine = headline and not along and annotation.get("headline", True)
        yield from _quantities(inner, known, (*path, key), (*dims, *along), prefix + annotation.get("prefix", ""), mine)


def headlines(point: SpeedPoint) -> Iterator[tuple[str, Any]]:
    """The quantities of a speed that sweeps have, each by its name with its value, where it has one."""
    values = adapter(SpeedPoint).dump_python(point, by_alias=True, exclude_defaults=True)
    for each in quantities(SpeedPoint):
        if each.headline and (value := each.of(values)) is not None:
            yield each.name, value


Variable = tuple[tuple[str, ...], Any, dict[str, str]]
"""Dimensions, values, attributes, as xarray takes them."""


def variables(kind: type, records: Sequence[Any], along: str) -> dict[str, Variable]:
    """Every quantity of records of a kind by its name; none of a part that no record has.

    Args:
        kind: the class of the records.
        records: in their order.
        along: the name of that dimension; where a record has fewer of something than others, NaN fills it up.
    """
    rows = [adapter(kind).dump_python(record, by_alias=True, exclude_defaults=True) for record in records]
    sizes, known = {along: len(rows)}, list[tuple[Quantity, tuple[str, ...], dict[_Place, Any]]]()
    for path, members in groupby(quantities(kind), key=lambda each: each.path[:-1]):
        owners = dict(_owners(rows, path))
        lasts = [max(places) for places in zip(*owners, strict=True)]
        for quantity in members:
            key, dims = quantity.path[-1], (along, *quantity.dims)
            if values := {place: owner[key] for place, owner in owners.items() if key in owner}:
                sizes |= {name: max(sizes.get(name, 0), last + 1) for name, last in zip(dims, lasts, strict=True)}
                known.append((quantity, dims, values))
    return {
        each.name: (dims, each.table(tuple(sizes[name] for name in dims), values), each.attributes)
        for each, dims, values in known
    }


_Place: TypeAlias = tuple[int, ...]
"""In the lists on the way to a published record, the outermost first."""


def _owners(published: Any, path: tuple[str, ...], place: _Place = ()) -> Iterator[tuple[_Place, dict[str, Any]]]:
    """The records that a path leads to, each with its place."""
    if isinstance(published, list | tuple):
        for k, each in enumerate(published):
            yield from _owners(each, path, (*place, k))
    elif published is not None:
        yield from _owners(published.get(path[0]), path[1:], place) if path else [(place, published)]


_FORMAT = 3
"""Version of what `results.nc` keeps beside the data set; before the third it kept nothing."""

_GROUP = "run"
"""The group that holds it."""


def write_unpublished(results: Results, file: h5netcdf.File) -> None:
    """Keep what JSON leaves out of a run in a group of its data set, from which :func:`read` has it back.

    Two variables: the records as JSON text, and the bytes of all their arrays, since each variable costs a millisecond.
    """
    arrays: list[bytes] = []

    def plain(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            begin = sum(map(len, arrays))
            arrays.append(value.tobytes())
            return {"begin": begin, "dtype": value.dtype.str, "shape": value.shape}
        return {f.name: getattr(value, f.name) for f in fields(value)}

    text = json.dumps(_unpublished(results) | {"scene": results.scene.as_written()}, default=plain)
    group = file.create_group(_GROUP)
    group.attrs["format"] = _FORMAT
    for name, content in (
        ("records", np.frombuffer(text.encode(), np.uint8)),
        ("arrays", np.frombuffer(b"".join(arrays), np.uint8)),
    ):
        if content.size:
            group.dimensions[name] = content.size
            group.create_variable(name, (name,), content.dtype, data=content, compression="gzip")


def _unpublished(record: Any) -> dict[str, Any]:
    """The fields of a record, and of those within it, that JSON leaves out and no column has, as JSON is nested."""
    alone, parts = dict[str, Any](), dict[str, Any]()
    for name, info in _fields(record.__class__).items():
        value = getattr(record, name)
        if info.exclude and not info.json_schema_extra:  # which a column has
            alone[name] = value
        elif is_dataclass(value):
            parts[info.alias or name] = _unpublished(value)
        elif isinstance(value, tuple) and value and is_dataclass(value[0]):
            parts[info.alias or name] = [_unpublished(each) for each in value]
    return alone | parts


@cache
def _fields(record: type) -> dict[str, FieldInfo]:
    hints = get_type_hints(record, include_extras=True)
    return {field.name: FieldInfo.from_annotation(hints[field.name]) for field in fields(record)}


def read(folder: str | os.PathLike[str]) -> Results:
    """What a run left in a folder.

    Raises:
        BadInput: the folder has no run, or one of another version.
        TypeError: not the name of a folder.
    """
    if not isinstance(folder, str | os.PathLike):
        raise TypeError(f"load_results takes the name of a folder that a run has written, got {type(folder).__name__}")
    path, name = Path(folder), NAME
    try:
        for name in (NAME, DATA):
            if problem := non_file_kind(path / name):
                raise _unreadable(path, f"expected a file {name}, found {problem}: run it again")
        name = NAME
        published = json.loads((path / NAME).read_text(encoding="utf-8"))
        if (version := published["schema_version"]) != SCHEMA_VERSION:
            raise _unreadable(path, f"has version {version} of {NAME}: expected {SCHEMA_VERSION}; run it again")
        name = DATA
        stored = _read_unpublished(path)
        results: Results = adapter(Results).validate_python(
            _merged(published, stored) | {"scene": parse(stored["scene"])}
        )
    except (FileNotFoundError, NotADirectoryError):
        problem = f"holds no run: expected a folder with {NAME} and {DATA}, as `spindamp run --out` writes"
        raise _unreadable(path, problem) from None
    except BadInput:
        raise
    except Exception as error:  # what JSON, HDF5 and pydantic stumble over in a file with a few wrong bytes
        reason = getattr(error, "strerror", None) or type(error).__name__
        raise _unreadable(path, f"{name} is damaged, or not from spindamp ({reason}): run it again") from error
    return results


def _read_unpublished(folder: Path) -> dict[str, Any]:
    """What JSON leaves out, arrays in their places.

    Raises:
        BadInput: the folder is an older one.
    """
    import h5py

    with (folder / DATA).open("rb"), h5py.File(folder / DATA, "r") as file:  # h5netcdf writes to stderr where it fails
        group = file.get(_GROUP)
        version = 2 if group is None else int(np.ravel(group.attrs["format"])[0])
        if group is None or version != _FORMAT:
            raise _unreadable(folder, f"has version {version} of a run's stored data: expected {_FORMAT}; run it again")

        arrays = group["arrays"][...].tobytes() if "arrays" in group else b""

        def placed(value: dict[str, Any]) -> Any:
            if value.keys() != {"begin", "dtype", "shape"}:
                return value
            count = math.prod(value["shape"])
            return np.frombuffer(arrays, value["dtype"], count, value["begin"]).reshape(value["shape"])

        records: dict[str, Any] = json.loads(group["records"][...].tobytes(), object_hook=placed)
    return records


def _merged(published: Any, stored: Any) -> Any:
    if isinstance(published, dict) and isinstance(stored, dict):
        return published | {name: _merged(published.get(name), value) for name, value in stored.items()}
    if isinstance(published, list) and isinstance(stored, list):
        return [_merged(*pair) for pair in zip(published, stored, strict=True)]
    return stored


def _unreadable(path: Path, problem: str) -> BadInput:
    return BadInput(problem, key="folder", value=str(path))


if __name__ == "__main__":
    Path(__file__).parents[1].joinpath("results.schema.json").write_text(text(), encoding="utf-8")
