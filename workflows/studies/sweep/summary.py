"""What a study found, in brief: how many points have an answer, where the damper does most, what keeps the others."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.studies.sweep import plans, quantities, uncertain
from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.labels import said
from workflows.studies.sweep.quantities import HEADLINE
from workflows.wording import significant

if TYPE_CHECKING:
    import xarray as xr

_HEADLINE = uncertain.QUANTITIES.index(HEADLINE)


def document(data: xr.Dataset) -> dict[str, Any]:
    """The machine-readable result: ``sweep.json``, and what ``--json`` prints."""
    flat = np.asarray(data[HEADLINE].values, dtype=float).ravel()
    reasons = Counter(str(text) for text in data["reason"].values.ravel() if text)
    found: dict[str, Any] = {
        "schema_version": 1,
        "title": data.attrs["title"],
        "study": data.attrs["study"],
        "dimensions": {str(name): int(data.sizes[name]) for name in data[HEADLINE].dims},
        "points": int(flat.size),
        "without_answer": sum(reasons.values()),
        "without_verdict": int(((data["grade"] == quantities.UNGRADED) & (data["reason"] == "")).sum()),
        "reasons": [{"reason": text, "points": count} for text, count in reasons.most_common(20)],
        "best": None,
    }
    if (flat > 0).any():
        found["best"] = at(data, int(np.nanargmax(flat)))
    if "ST" in data:
        found["uncertain"] = uncertain.document(data)
    return found


def at(data: xr.Dataset, number: int) -> dict[str, Any]:
    """A point by its absolute index: the keys that are varied, and what was found there."""
    points = data[[*quantities.NUMBERS]]
    place = np.unravel_index(number, tuple(points.sizes[name] for name in points[HEADLINE].dims))
    point = points.isel({name: int(k) for name, k in zip(points[HEADLINE].dims, place, strict=True)})
    keys = {str(name): plans.said([point.coords[name].item()])[0] for name in point.coords}
    values = {str(name): point[name].item() for name in point.data_vars}
    return {"keys": keys, "values": {name: value if math.isfinite(value) else None for name, value in values.items()}}


def text(data: xr.Dataset) -> str:
    """The same in a few lines."""
    found = document(data)
    sizes = " × ".join(f"{size} {name}" for name, size in found["dimensions"].items())
    lines = [f"{found['title']}: {found['points']} point{'s' * (found['points'] != 1)} ({sizes})"]
    if found["best"] is not None:
        keys, values = found["best"]["keys"], found["best"]["values"]
        where = ", ".join(f"{name} = {said(data, name, value)}" for name, value in keys.items() if name != SPEEDS)
        lines.append(f"The ball does most at {where}:")
        amplitude = values["best_amplitude"]
        there = "" if amplitude is None else f" at an amplitude of {significant(1e3 * amplitude)} mm"
        lines.append(f"  a damping ratio of {significant(100 * values[HEADLINE])} %{there}")
    elif headline(data, found):
        lines.append(headline(data, found))
    if "ST" in data and _is_spread(data):
        lines += _uncertain(data)
    if found["without_verdict"]:
        have = "point has" if found["without_verdict"] == 1 else "points have"
        lines.append(f"{found['without_verdict']} {have} no verdict: `spindamp run` of one says why")
    if found["without_answer"]:
        have = "point has" if found["without_answer"] == 1 else "points have"
        lines.append(f"{found['without_answer']} {have} no answer:")
        lines += [f"  {entry['points']} × {entry['reason']}" for entry in found["reasons"][:3]]
    return "\n".join(lines)


def headline(data: xr.Dataset, found: dict[str, Any]) -> str:
    """The answer of a study that is not that of its best point; empty where it is."""
    if found["best"] is not None:
        return spread(data) if "ST" in data and _is_spread(data) else ""
    if found["without_answer"] + found["without_verdict"] < found["points"]:
        return "No ball takes anything at an amplitude that the plate endures"
    return "No point has a verdict" if found["without_verdict"] else "No point has an answer"


def _is_spread(data: xr.Dataset) -> bool:
    """Whether the middle speed has a damping ratio to speak of."""
    return bool((data["percentiles"].values[_HEADLINE, :, (data.sizes[SPEEDS] - 1) // 2] > 0).any())


def spread(data: xr.Dataset) -> str:
    """How far the largest damping ratio spreads at the middle speed."""
    k = (data.sizes[SPEEDS] - 1) // 2
    low, _, middle, _, high = (100 * float(value) for value in data["percentiles"].values[_HEADLINE, :, k])
    return (
        f"At {float(data['rpm'].values[k]):.6g} rpm the largest damping ratio is {significant(low)} to"
        f" {significant(high)} % (90 %), in the median {significant(middle)} %"
    )


def _uncertain(data: xr.Dataset) -> list[str]:
    """The spread, and what it is worth measuring for it."""
    ranked = uncertain.worth_measuring(data, HEADLINE, (data.sizes[SPEEDS] - 1) // 2)
    shares = [f"{name} {significant(100 * total, 2)} ± {significant(100 * half, 2)} %" for name, total, half in ranked]
    if not shares:
        return [spread(data)]
    return [f"{spread(data)}; of its variance each has, with all it acts together with:", f"  {', '.join(shares)}"]
