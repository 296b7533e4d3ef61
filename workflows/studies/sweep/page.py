"""A study as files for people: `sweep.json` and one page."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows import wording
from workflows.report import plots as plot
from workflows.report import templating
from workflows.studies.sweep import folder, labels, maps, pictures, summary, uncertain
from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.quantities import HEADLINE

if TYPE_CHECKING:
    import xarray as xr

_FIGURES = (
    ("best_damping_ratio", "damping ratio, %", 100.0),
    ("best_amplitude", "at an amplitude of, mm", 1e3),
    ("cutoff", "at rest below, mm", 1e3),
    ("range_high", "half is left up to, mm", 1e3),
    ("cutoff_ratio", "cut-off of the ring-down over the load", 1.0),
    ("ball_mass", "mass of the balls, g", 1e3),
    ("working_error", "error of the damping ratio, %", 100.0),
)
"""What the page says of the best point."""


def write(data: xr.Dataset, out: Path) -> None:
    """Write `sweep.json` and `report.html` into a study's folder.

    Raises:
        BadInput: they cannot be written.
    """
    page = render(data)
    with folder.writing(out):
        folder.write_whole(out / "sweep.json", f"{dumps(data)}\n".encode())
        folder.write_whole(out / "report.html", page.encode())


def dumps(data: xr.Dataset) -> str:
    """The machine-readable result."""
    return json.dumps(summary.document(data), indent=1, ensure_ascii=False, allow_nan=False)


def render(data: xr.Dataset) -> str:
    """The page."""
    from markupsafe import Markup

    found = summary.document(data)
    return templating.page(
        "sweep.html.j2",
        {"significant": wording.significant, "fixed": wording.fixed},
        plot.shades_css(maps.SHADES),
        found=found,
        best=_best(data, found),
        headline=summary.headline(data, found),
        doubts=_doubts(data) if "ST" in data and found["best"] is not None else [],
        spreads=_spreads(data) if "ST" in data else {},
        figures=[(Markup(picture.svg), picture.caption) for picture in pictures.draw(data)],
        code=json.loads(data.attrs["code"]),
    )


def _doubts(data: xr.Dataset) -> list[dict[str, Any]]:
    """Percentiles of the damping in % and of the cut-off at every speed, and the parameters that matter."""
    rows = []
    for quantity, factor, called in (
        (HEADLINE, 100.0, "damping ratio, %"),
        ("cutoff", 1e3, "at rest below, mm"),
    ):
        q = uncertain.QUANTITIES.index(quantity)
        for k, rpm in enumerate(data["rpm"].values):
            ranked = uncertain.worth_measuring(data, quantity, k)[:2]
            worth = ", ".join(
                f"{n.partition('.')[2].replace('_', ' ')} {100 * t:.0f} %" for n, t, _ in ranked if t > 0.05
            )
            values = [factor * float(value) for value in data["percentiles"].values[q, :, k]]
            if math.isfinite(values[0]):
                rows.append({"what": f"{called}, {rpm:.6g} rpm", "values": values, "worth": worth or "none"})
    return rows


def _spreads(data: xr.Dataset) -> dict[str, str]:
    """The ranges that were drawn from, in words."""
    names = [str(name) for name in data["parameter"].values]
    ends = {name: (data[name].values.min(), data[name].values.max()) for name in names}
    return {
        name: f"{labels.said(data, name, low)} to {labels.said(data, name, high)}" for name, (low, high) in ends.items()
    }


def _best(data: xr.Dataset, found: dict[str, Any]) -> dict[str, str] | None:
    """The best point in words, name by name."""
    if found["best"] is None:
        return None
    keys, values = found["best"]["keys"], found["best"]["values"]
    words = {name: labels.said(data, name, value) for name, value in keys.items() if name != SPEEDS}
    numbers = {
        title: wording.significant(factor * values[name])
        for name, title, factor in _FIGURES
        if values[name] is not None
    }
    return words | numbers
