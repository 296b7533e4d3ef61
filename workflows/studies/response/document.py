"""`response.json`: the machine-readable result of a forced response."""

from __future__ import annotations

from typing import Any

import numpy as np

from workflows.findings import worth
from workflows.results import provenance, resolved
from workflows.studies.response.peaks import Row, endured, rows
from workflows.studies.response.records import Response, Through
from workflows.studies.response.told import sentences


def document(found: Response) -> dict[str, Any]:
    """The machine-readable result: numbers are finite, an unknown one is None, SI unless a name says otherwise."""
    results = found.results
    return {
        "schema_version": 1,
        "title": results.scene.title,
        "scene": resolved.scene(results.scene, results.effects, results.theory),
        **provenance.hashes(results),
        "versions": provenance.versions(),
        "timings": results.timings,
        "notes": list(results.notes),
        "headline": sentences(found),
        "excitation": {"kind": found.excitation.kind, "unit": found.excitation.unit},
        "aerodynamic_damping_ratio": list(worth.AIR),
        "crossings": entries(found),
        "dampers": [_damper(found, through) for through in found.passed],
        "not_followed": [
            {"order": c.order, "mode": c.branch + 1, "family": c.family, "rpm": c.rpm, "frequency_hz": c.frequency_hz}
            | {"why": why}
            for c, why in found.idle
        ],
    }


def entries(found: Response) -> list[dict[str, Any]]:
    """The crossings, each under every force."""
    return [_entry(found, row) for row in rows(found)]


def _entry(found: Response, row: Row) -> dict[str, Any]:
    c = row.through.crossing
    asked = found.results.scene.accuracy.damping
    short = None
    if row.short is not None and row.difference is not None:
        short = {"amplitude": row.short, "difference": row.difference, "suffices": abs(row.difference) <= asked}
    return {
        "order": c.order,
        "mode": c.branch + 1,
        "family": c.family,
        "rpm": c.rpm,
        "frequency_hz": c.frequency_hz,
        "frequency_error": _known(c.error),
        "basis_error": c.basis,
        "force": row.force,
        "peak_rpm": row.rpm,
        "peak_frequency_hz": row.frequency,
        "amplitude_without": row.without,
        "amplitude": {"least": row.least, "mean": row.mean, "rms": row.rms, "greatest": row.greatest},
        "amplitude_error": row.error,
        "smallest_answer": row.smallest,
        "ratio": row.ratio,
        "stress_without": row.stress_without,
        "stress_with": row.stress_with,
        "regime": row.regime,
        "hits_per_cycle": row.hits_per_cycle,
        "power_in": _known(row.power_in),
        "power_lost": _known(row.power_lost),
        "shortcut": short,
    }


def _damper(found: Response, through: Through) -> dict[str, Any]:
    """The damper's own figures at a crossing, and the force from which it moves."""
    c, figures = through.crossing, through.figures
    return {
        "order": c.order,
        "mode": c.branch + 1,
        "least_force": _known(through.least_force),
        "structure_damping_ratio": found.results.scene.damper.damping_ratio if found.results.scene.damper else None,
        "damping_ratio_peak": figures.peak,
        "at_amplitude": _known(figures.peak_amplitude),
        "range": [_known(end) for end in figures.range],
        "cutoff": _known(figures.cutoff),
        "endured_amplitude": endured(found, through),
        "curve": {"amplitude": figures.amplitude.tolist(), "damping_ratio": figures.damping_ratio.tolist()},
    }


def _known(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(value)
