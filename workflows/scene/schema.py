"""The JSON Schema of a scene, for editors and other programs: ``python -m workflows.scene.schema`` publishes it.

Each key's description ends with the unit that a number without one has.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from workflows.scene.scene import Scene


def schema() -> dict[str, Any]:
    """The schema, from the same model that validates scenes."""
    found = {"$schema": "https://json-schema.org/draft/2020-12/schema", **Scene.model_json_schema()}
    for table in (found, *found["$defs"].values()):
        for key in table["properties"].values():
            if si := unit(key):
                key["description"] += f"; a number without a unit is in {si}"
    return dict(_tidied(found)) | {"title": "spindamp scene"}


def unit(node: Any) -> str | None:
    """The SI unit of a quantity, however deep in the schema of its key it stands."""
    if isinstance(node, dict) and "x-si" in node:
        return str(node["x-si"])
    inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return next((found for part in inner if (found := unit(part))), None)


_BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}


def _tidied(node: Any) -> Any:
    """Bounds under their standard names, and no titles: pydantic titles every key after itself."""
    if isinstance(node, dict):
        kept = {key: value for key, value in node.items() if key != "title" or isinstance(value, dict)}
        return {_BOUNDS.get(key, key): _tidied(value) for key, value in kept.items()}
    return [_tidied(item) for item in node] if isinstance(node, list) else node


if __name__ == "__main__":
    text = json.dumps(schema(), indent=1, ensure_ascii=False)
    Path(__file__).parents[1].joinpath("scene.schema.json").write_text(text + "\n", encoding="utf-8")
