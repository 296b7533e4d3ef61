"""A forced response as files: labelled arrays for xarray, tables for any program."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workflows.results import provenance
from workflows.studies.response.records import Response, Through

if TYPE_CHECKING:
    import xarray as xr

_OF_STATES = {
    "least": ("m", "least amplitude of a cycle"),
    "mean": ("m", "mean amplitude of the cycles"),
    "rms": ("m", "root mean square of the amplitudes of the cycles"),
    "greatest": ("m", "greatest amplitude of a cycle"),
    "error": ("m", "error of the mean amplitude"),
    "hits_per_cycle": ("1", "wall hits in a cycle"),
    "repeats": ("1", "cycles after which the motion repeats itself, 0 where it does not"),
    "power_in": ("W", "power put in by the force"),
    "power_lost": ("W", "power lost"),
    "stored": ("W", "rate at which the stored energy changes over the window"),
    "power_error": ("W", "standard error of the power put in"),
    "divergence": ("1", "exponent by which neighbouring motions part a cycle"),
    "cycles": ("1", "cycles followed"),
}


def tag(through: Through) -> str:
    """A crossing as part of a file name."""
    c = through.crossing
    return f"order_{c.order}_mode_{c.branch + 1}_{c.rpm:.0f}rpm"


def write_csv(found: Response, folder: Path) -> None:
    """A table for each crossing, with a row for each speed, force and start; and one of the damping ratios."""
    for through in found.passed:
        with (folder / f"response_{tag(through)}.csv").open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file)
            names = list(_OF_STATES)
            unit = {"N": "n", "Pa": "pa", "m/s²": "m_s2"}[found.excitation.unit]
            force = f"{found.excitation.kind}_{unit}"
            table.writerow(["rpm", force, "start", "regime", "without_m", "locked_m", *names, "shortcut_m"])
            for row in _rows(through):
                table.writerow(row)
    with (folder / "response_damping_ratio.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["order", "rpm", "amplitude_m", "damping_ratio"])
        for through in found.passed:
            c, figures = through.crossing, through.figures
            for amplitude, ratio in zip(figures.amplitude, figures.damping_ratio, strict=True):
                table.writerow([c.order, f"{c.rpm:.10g}", f"{amplitude:.10g}", f"{ratio:.10g}"])


def _rows(through: Through) -> list[list[str]]:
    states, rows = through.states, []
    without, linear = (np.abs(through.shaped(part)) for part in (states.without, states.linear))
    regimes = through.shaped(states.regime)
    values = [through.shaped(getattr(states, name)) for name in _OF_STATES]
    for n, omega in enumerate(through.omega):
        for k, force in enumerate(through.forces):
            for j, start in enumerate(states.starts):
                numbers = [without[n, k], linear[n, k], *(value[n, k, j] for value in values), through.short[n, k, j]]
                first = [f"{omega * 30 / np.pi:.10g}", f"{force:.10g}", str(start), str(regimes[n, k, j])]
                rows.append(first + ["" if np.isnan(number) else f"{number:.10g}" for number in numbers])
    return rows


def dataset(found: Response) -> xr.Dataset:
    """All steady states: dimensions crossing, speed, force and start; units in the attributes."""
    import xarray as xr

    dims = ("crossing", "speed", "force", "start")
    passed, results = found.passed, found.results
    data = xr.Dataset(
        attrs={
            "title": results.scene.title,
            "source": "spindamp",
            **provenance.hashes(results),
            "versions": ", ".join(f"{name} {number}" for name, number in provenance.versions().items()),
        }
    )
    if not passed:
        return data
    heights = {"units": found.excitation.unit.replace("²", "2"), "long_name": f"height of the {found.excitation.kind}"}
    data = data.assign_coords(
        order=("crossing", [through.crossing.order for through in passed]),
        mode=("crossing", [through.crossing.branch + 1 for through in passed]),
        force=("force", list(found.excitation.levels), heights),
        start=("start", [str(start) for start in passed[0].states.starts]),
        rpm=(dims[:2], np.array([t.omega for t in passed]) * 30 / np.pi, {"units": "rpm"}),
    )
    for name, (unit, said) in _OF_STATES.items():
        values = np.array([through.shaped(getattr(through.states, name)) for through in passed], dtype=float)
        data[name] = (dims, values, {"units": unit, "long_name": said})
    regimes = np.array([[str(r) for r in t.states.regime.ravel()] for t in passed], dtype=object)
    data["regime"] = (dims, regimes.reshape(data["mean"].shape), {"long_name": "what the steady state is"})
    for name, said in (("without", "amplitude without the ball"), ("linear", "amplitude with the ball at rest")):
        values = np.abs([through.shaped(getattr(through.states, name)) for through in passed])
        data[name] = (dims[:3], values, {"units": "m", "long_name": said})
    short = np.array([through.short for through in passed])
    data["shortcut"] = (dims, short, {"units": "m", "long_name": "amplitude by the short way"})
    return data
