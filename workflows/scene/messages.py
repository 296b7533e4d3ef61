"""What pydantic finds wrong with a scene, as one message in our words: file, key, value and what would be right."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from workflows.errors import BadInput, did_you_mean
from workflows.scene import quantities
from workflows.scene.materials import PLATES
from workflows.scene.scene import Scene

_LISTED = 20
"""Unknown keys that are named in one message."""

_NOT_FLAT = {
    "pretwist": "a plate is flat: give [rotor] stagger the angle of the section that counts, compare runs with the"
    " angles at root and tip, or take a finite-element program for solids",
    "camber": "a plate is flat: leave out a camber up to a tenth of the thickness, which raises frequencies by about"
    " 0.5 % at most; beyond, take a finite-element program for solids",
}
"""What blades have and plates have not, and what to do instead. A parabolic camber of height d raises the bending
stiffness by (16/15)(d/h)²."""

_ALSO_CALLED = {"pre_twist": "pretwist", "twist": "pretwist", "twist_angle": "pretwist", "curvature": "camber"}

_DIAMETERS = ("diameter", "ball_diameter")


def explained(error: ValidationError, data: Mapping[str, Any], name: str) -> BadInput:
    """The most telling of pydantic's errors, with every unknown key."""
    # A misspelt key makes the right one missing as well: the misspelling is the cause.
    order = {"extra_forbidden": 0, "missing": 2}
    errors = sorted(error.errors(include_url=False), key=lambda e: order.get(e["type"], 1))
    first = errors[0]
    loc = _keys(first)
    context = first.get("ctx", {})
    if first["type"] == "together":
        loc += str(context["key"]).split(".")
    problem, value = worded(first, loc), _lookup(data, loc)
    unknown = [found for found in errors[1:] if found["type"] == "extra_forbidden"]
    rest = [found for found in errors[1:] if found["type"] == first["type"] or found["type"] not in order]
    if unknown:
        problem += f"; also unknown: {', '.join(map(_in_a_list, unknown[:_LISTED]))}"
        problem += f" and {len(unknown) - _LISTED} more" if len(unknown) > _LISTED else ""
    elif rest:
        problem += "".join(f"; also {_named(found)}" for found in rest[:_LISTED])
        problem += f"; and {len(rest) - _LISTED} more" if len(rest) > _LISTED else ""
    if first["type"] == "extra_forbidden" and len(loc) == 1 and isinstance(first["input"], Mapping):
        return BadInput(problem, file=name, key=f"[{loc[0]}]")
    return BadInput(problem, file=name, key=key_name(loc), value=value)


def _keys(error: Any) -> list[str]:
    """The keys that lead to an error; marks of alternatives are in brackets, which no key is."""
    return [part for part in map(str, error["loc"]) if not part.startswith("[")]


def _named(error: Any) -> str:
    """A further error with its key."""
    loc = _keys(error)
    if error["type"] == "together":
        loc += str(error["ctx"]["key"]).split(".")
    return f"{key_name(loc)}: {worded(error, loc)}"


def _in_a_list(error: Any) -> str:
    loc = [part[:80] for part in _keys(error)]
    key = f"[{loc[0]}]" if len(loc) == 1 and isinstance(error["input"], Mapping) else key_name(loc)
    hint = _unknown(error, loc)
    return f"{key} ({hint.removeprefix(': ')})" if hint else key


def worded(error: Any, loc: list[str]) -> str:
    """One of pydantic's errors in our words; `loc`: the keys that lead to it."""
    context = error.get("ctx", {})
    match error["type"]:
        case "extra_forbidden":
            what = "table" if len(loc) == 1 and isinstance(error["input"], Mapping) else "key"
            return f"unknown {what}{_unknown(error, loc)}"
        case "missing":
            named = loc[0] == "material" and len(loc) == 2
            return f"missing (or give the material's name: {', '.join(PLATES)})" if named else "missing"
        case "greater_than":
            return f"expected a value above {context['gt']:g}"
        case "greater_than_equal":
            return f"expected at least {context['ge']:g}"
        case "less_than":
            return f"expected a value below {context['lt']:g}"
        case "less_than_equal":
            return f"expected at most {context['le']:g}"
        case "literal_error":
            given, expected = error["input"], context["expected"]
            return f"expected {expected}{did_you_mean(given, _quoted(expected)) if isinstance(given, str) else ''}"
        case "int_type" | "int_from_float" | "int_parsing":
            return "expected a whole number"
        case "too_long" | "string_too_long":
            return f"expected at most {context['max_length']} letters"
        case "string_type":
            return "expected text in quotes"
        case "model_type" | "model_attributes_type" | "dict_type":
            return "expected a table"
        case _:
            text = str(error["msg"])
            return text[:1].lower() + text[1:]


def _unknown(error: Any, loc: list[str]) -> str:
    """What was probably meant by an unknown key."""
    if loc[0] in ("plate", "rotor") and (shape := _ALSO_CALLED.get(loc[-1], loc[-1])) in _NOT_FLAT:
        return f": {_NOT_FLAT[shape]}"
    if loc[0] == "damper" and loc[-1] in _DIAMETERS:
        half = quantities.halved(error["input"], quantities.LENGTH)
        return f": a ball is given by its radius{f', here radius = {half}' if half else ', half its diameter'}"
    return did_you_mean(loc[-1], _fields(loc[:-1])) or _belongs(loc[-1])


def key_name(loc: list[str]) -> str:
    """``[plate] length`` from ("plate", "length")."""
    if len(loc) == 1 and loc[0] in Scene.model_fields and loc[0] != "title":
        return f"[{loc[0]}]"
    return loc[0] if len(loc) == 1 else f"[{loc[0]}] {'.'.join(loc[1:])}"


def _quoted(text: str) -> list[str]:
    return text.split("'")[1::2]


def _lookup(data: Any, loc: list[str]) -> object:
    for part in loc:
        if not isinstance(data, Mapping) or part not in data:
            return None
        data = data[part]
    return None if isinstance(data, Mapping) and len(loc) == 1 else data


def _tables() -> dict[str, type[BaseModel]]:
    return {name: kind for name, field in Scene.model_fields.items() for kind in _models(field)}


def _models(field: Any) -> list[type[BaseModel]]:
    """The tables that a key may hold."""
    found, kinds = [], [field.annotation]
    while kinds:
        kind = kinds.pop()
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            found.append(kind)
        kinds += getattr(kind, "__args__", ())
    return found


def _fields(loc: list[str]) -> list[str]:
    if not loc:
        return list(Scene.model_fields)
    table = _tables().get(loc[0])
    for key in loc[1:]:
        table = next(iter(_models(table.model_fields[key])), None) if table and key in table.model_fields else None
    return list(table.model_fields) if table else []


def _belongs(key: str) -> str:
    homes = [f"[{name}]" for name, table in _tables().items() if key in table.model_fields]
    return f": it belongs in {' or '.join(homes)}" if homes else ""
