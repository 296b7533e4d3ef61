"""The JSON Schema of `results.json`, from the records of a run: ``python -m workflows.results.schema`` publishes it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from workflows.progress import NAMES
from workflows.results.document import SCHEMA_VERSION
from workflows.solve.quantity import Entry, Part, Quantity, entries
from workflows.solve.records import SpeedPoint

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
            _add(target, entry.name, _quantity(entry, entry.what), required=not entry.what.absent)
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
    _add(target["properties"][rows.name]["items"], entry.name, _quantity(entry, quantity), required=True)


def _add(target: dict[str, Any], name: str, inner: dict[str, Any], *, required: bool) -> None:
    target["properties"][name] = inner
    if required:
        target["required"].append(name)


def _quantity(entry: Entry, quantity: Quantity) -> dict[str, Any]:
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
