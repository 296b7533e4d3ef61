"""The reference of scenes, made from the published schema when the documentation is built."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SCHEMA = HERE.parent / "workflows" / "scene.schema.json"

HEAD = """# Scenes: every table and key

Generated from the JSON Schema published with the package as `workflows/scene.schema.json`.
A bare number is in the unit given, a string includes its unit, and an unknown key is an error.

"""


def setup(app: Any) -> dict[str, bool]:
    """Write the page before anything is read."""
    app.connect("builder-inited", lambda _: (HERE / "scene.md").write_text(page(), encoding="utf-8"))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def page() -> str:
    """The page as Markdown."""
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    parts, tables = [HEAD], schema["$defs"]
    for name, key in schema["properties"].items():
        table = tables.get(_name(key), key)
        parts.append(_section(schema, f"`[{name}]`" if "properties" in table else f"`{name}`", table))
    used = {_name(key) for key in schema["properties"].values()}
    rest = {name: table for name, table in tables.items() if name not in used and "properties" in table}
    return "".join([*parts, *(_section(schema, name, table) for name, table in rest.items())])


def _name(key: dict[str, Any]) -> str | None:
    """The definition that a key refers to."""
    options = [key, *key.get("anyOf", []), *key.get("allOf", [])]
    return next((option["$ref"].rsplit("/", 1)[1] for option in options if "$ref" in option), None)


def _section(schema: dict[str, Any], title: str, table: dict[str, Any]) -> str:
    """A table, or a key outside of all tables."""
    rows = f"{_rows(schema, table)}\n" if "properties" in table else ""
    return f"## {title}\n\n{_words(table.get('description', ''))}\n\n{rows}"


def _rows(schema: dict[str, Any], table: dict[str, Any]) -> str:
    required = table.get("required", [])
    lines = ["| key | meaning | values | default |", "|---|---|---|---|"]
    for name, key in table["properties"].items():
        default = "required" if name in required else _code(key["default"]) if key.get("default") is not None else ""
        lines.append(f"| `{name}` | {_words(key.get('description', ''))} | {_takes(schema, key)} | {default} |")
    return "\n".join(lines) + "\n"


def _takes(schema: dict[str, Any], key: dict[str, Any]) -> str:
    if key.get("examples"):
        return " ".join(_code(example) for example in key["examples"][:2])
    options = key.get("anyOf", [key])
    choices = [_code(choice) for option in options for choice in _choices(schema, option)]
    bounds = [
        f"{sign} {key[name]:g}"
        for name, sign in (
            ("exclusiveMinimum", "&gt;"),
            ("minimum", "≥"),
            ("exclusiveMaximum", "&lt;"),
            ("maximum", "≤"),
        )
        if isinstance(key.get(name), int | float)
    ]
    return ", ".join([*choices, *bounds])


def _choices(schema: dict[str, Any], option: dict[str, Any]) -> list[Any]:
    if "$ref" in option:
        option = schema["$defs"][option["$ref"].rsplit("/", 1)[1]]
    if "const" in option:
        return [option["const"]]
    if option.get("type") == "boolean":
        return [True, False]
    return list(option.get("enum", []))


def _code(value: Any) -> str:
    return f"`{json.dumps(value, ensure_ascii=False)}`"


def _words(text: str) -> str:
    """Text of the schema in a cell of a table."""
    for sign in "\\|*_<[":
        text = text.replace(sign, "\\" + sign)
    return text.replace("\n", " ")
