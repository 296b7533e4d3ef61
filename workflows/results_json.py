"""`results.json`: the machine-readable results, as the published schema (results.schema.json) describes them."""

from __future__ import annotations

import json
import math
from typing import Any

from workflows import provenance, resolved
from workflows.records import Damping, Mode, Reduced, Results, SpeedPoint, expect

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
        "timings": {name: _number(seconds) for name, seconds in results.timings.items()},
        "notes": list(results.notes),
        "effects": {name: {"on": effect.on, "why": effect.why} for name, effect in results.effects.items()},
        "speeds": [_speed(point) for point in results.speeds],
    }


def dumps(results: Results) -> str:
    """The document as JSON text that any parser reads."""
    return json.dumps(document(results), indent=1, ensure_ascii=False, allow_nan=False)


def _speed(point: SpeedPoint) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "rpm": _number(point.rpm),
        "load_g": _number(point.load_g),
        "modes": [_mode(mode) for mode in point.modes],
    }
    if point.reduced is not None:
        entry["reduced"] = _reduced(point.reduced)
    if point.damping is not None:
        entry["damper"] = _damper(point.damping)
    return entry


def _mode(mode: Mode) -> dict[str, Any]:
    entry = {
        "frequency_hz": _number(mode.frequency_hz),
        "family": mode.family,
        "error_estimate": _number(mode.error_estimate),
    }
    return entry if mode.damping_ratio is None else entry | {"damping_ratio": _number(mode.damping_ratio)}


def _reduced(reduced: Reduced) -> dict[str, Any]:
    return {name: _number(getattr(reduced, name)) for name in ("f1_hz", "M1", "K1", "f2_hz", "M2", "K2")}


def _damper(damping: Damping) -> dict[str, Any]:
    cycles = zip(damping.amplitude_g, damping.sdc, damping.peak_velocity, strict=True)
    energy = damping.energy
    return {
        "impacts": damping.impacts,
        "events": damping.events,
        **{
            name: _number(getattr(damping, name))
            for name in (
                "intrinsic_sdc",
                "peak_sdc",
                "peak_sdc_at_g",
                "cutoff_g",
                "cutoff_ratio",
                "largest_rolling_demand",
            )
        },
        "cycles": [{"amplitude_g": _number(a), "sdc": _number(s), "peak_velocity": _number(v)} for a, s, v in cycles],
        "energy": {
            name: _number(getattr(energy, name))
            for name in ("initial", "final", "structure", "rolling", "impact", "slip", "residual")
        },
    }


def _number(value: float | None) -> float | None:
    """A plain finite float, or None: JSON knows no NaN."""
    return float(value) if value is not None and math.isfinite(value) else None
