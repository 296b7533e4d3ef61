"""`results.json`: the machine-readable results, as the published schema (results.schema.json) describes them."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from workflows.results import provenance, resolved
from workflows.solve.records import CavityMode, Damping, Mode, Reduced, Results, SpeedPoint, expect

if TYPE_CHECKING:
    from damper import Working

SCHEMA_VERSION = 1

REDUCED = ("f1_hz", "M1", "K1", "f2_hz", "M2", "K2", "floor_tilt")
"""Names of the reduced parameters."""

ERROR_PARTS = ("mesh", "layers", "basis", "theory", "large_deflection", "coriolis")
"""Names of the parts of a frequency's error."""


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
    if point.cavity_modes:
        entry["cavity_modes"] = [_cavity_mode(mode) for mode in point.cavity_modes]
    if point.working is not None:
        entry["working"] = _working(point)
    if point.damping is not None:
        entry["damper"] = _damper(point.damping)
    return entry


def _mode(mode: Mode) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "frequency_hz": _number(mode.frequency_hz),
        "family": mode.family,
        "error_estimate": _number(mode.error_estimate),
    }
    if mode.error_parts is not None:
        entry["error_parts"] = {name: _number(getattr(mode.error_parts, name)) for name in ERROR_PARTS}
    return entry if mode.damping_ratio is None else entry | {"damping_ratio": _number(mode.damping_ratio)}


def _reduced(reduced: Reduced) -> dict[str, Any]:
    return {name: _number(getattr(reduced, name)) for name in REDUCED}


def _cavity_mode(mode: CavityMode) -> dict[str, Any]:
    return {
        "number": mode.number,
        "stiffness": _number(mode.stiffness),
        "shape": list(map(_number, mode.shape)),
        "slope": list(map(_number, mode.slope)),
    }


def _working(point: SpeedPoint) -> dict[str, Any]:
    """The damper's own figures on a floor that tilts, and on a level one where the scene has that."""
    found = {
        **_figures(point.working),
        "error": None if point.working is None else _number(point.working.error),
        "floor_tilt_share": _number(point.tilt_share),
        "level_floor": None if point.level is None else _figures(point.level),
    }
    if point.tilted is not None:
        found["tilted_cutoff_g"] = _number(point.tilted.g)
        found["tilted_cutoff_ratio"] = _number(point.tilted.ratio)
    if point.pendulum is not None:
        found["pendulum"] = {name: list(map(_number, pair)) for name, pair in asdict(point.pendulum).items()}
    return found


def _figures(working: Working | None) -> dict[str, Any]:
    """Figures as plain data; of a ball that can never move, a damping ratio of 0 at no amplitude."""
    if working is None:
        nowhere = [None, None]
        return {
            "damping_ratio_peak": 0.0,
            "at_amplitude": None,
            "range": nowhere,
            "half_range": nowhere,
            "cutoff": None,
            "curve": [],
        }
    return {
        "damping_ratio_peak": _number(working.peak),
        "at_amplitude": _number(working.peak_amplitude),
        "range": [_number(end) for end in working.range],
        "half_range": [_number(end) for end in working.half],
        "cutoff": _number(working.cutoff),
        "curve": [
            {"amplitude": _number(a), "damping_ratio": _number(z)}
            for a, z in zip(working.amplitude, working.damping_ratio, strict=True)
        ],
    }


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
        **({"modal_energies": modal} if (modal := _modal(damping)) else {}),
    }


def _modal(damping: Damping) -> list[dict[str, Any]]:
    return [{"mode": number, "energy": _number(energy)} for number, energy in damping.modal_energies.items()]


def _number(value: float | None) -> float | None:
    """A plain finite float, or None: JSON knows no NaN."""
    return float(value) if value is not None and math.isfinite(value) else None
