"""`results.json`: the machine-readable results, as the published schema (results.schema.json) describes them."""

from __future__ import annotations

import json
from typing import Any

from workflows.results import provenance, resolved
from workflows.results.tree import numbers, trees
from workflows.solve.records import Results, SpeedPoint, expect

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
        "scene": resolved.scene(results.scene, results.effects, results.theory),
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
