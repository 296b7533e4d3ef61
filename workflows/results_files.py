"""The files beside `results.json`: netCDF for xarray, CSV for any program, VTU for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workflows import curves
from workflows.records import Floats, Results, Surface

if TYPE_CHECKING:
    import xarray as xr


def write_csv(results: Results, folder: Path) -> None:
    """One file per plotted curve, with a header that names column and unit."""
    for curve in curves.every(results):
        rows = np.column_stack([curve.x, curve.y])
        header = f"{curve.x_column},{curve.y_column}"
        np.savetxt(folder / f"{curve.name}.csv", rows, "%.10g", ",", header=header, comments="")


def write_netcdf(results: Results, path: Path) -> None:
    """All numbers of the run as one labelled data set."""
    dataset(results).to_netcdf(path, engine="h5netcdf")


def dataset(results: Results) -> xr.Dataset:
    """The run as an xarray data set: dimensions speed, mode and cycle; units in the attributes.

    Where one speed has fewer modes or cycles than another, the rest is NaN.
    """
    import xarray as xr

    points = results.speeds
    data = xr.Dataset(
        coords={"speed": ("speed", np.array([p.rpm for p in points]), {"units": "rpm", "long_name": "rotation speed"})},
        attrs={"title": results.scene.title, "source": "spindamp"},
    )
    _put(data, "load", ("speed",), [p.load_g for p in points], "1", "centrifugal acceleration at the tip over g")
    if any(p.modes for p in points):
        rows = [[m.frequency_hz for m in p.modes] for p in points]
        errors = [[np.nan if m.error_estimate is None else m.error_estimate for m in p.modes] for p in points]
        families = [[m.family for m in p.modes] for p in points]
        _put(data, "frequency", ("speed", "mode"), _ragged(rows), "Hz", "frequency")
        _put(data, "frequency_error", ("speed", "mode"), _ragged(errors), "1", "relative error of the mesh")
        width = max(map(len, families))
        data["family"] = (("speed", "mode"), np.array([f + [""] * (width - len(f)) for f in families], dtype=object))
    if all(p.reduced is not None for p in points):
        for name, unit in (("f1_hz", "Hz"), ("f2_hz", "Hz"), ("M1", "kg"), ("M2", "kg"), ("K1", "N/m"), ("K2", "N/m")):
            state = "with the ball stuck" if "1" in name else "without the ball"
            _put(data, name, ("speed",), [getattr(p.reduced, name) for p in points], unit, f"{name[0]} {state}")
    dampings = [p.damping for p in points if p.damping is not None]
    if dampings and len(dampings) == len(points):
        for name, unit in (
            ("impacts", "1"),
            ("events", "1"),
            ("intrinsic_sdc", "1"),
            ("peak_sdc", "1"),
            ("peak_sdc_at_g", "g"),
            ("cutoff_g", "g"),
            ("cutoff_ratio", "1"),
            ("largest_rolling_demand", "1"),
            ("duration", "s"),
        ):
            values = [np.nan if (v := getattr(d, name)) is None else v for d in dampings]
            _put(data, name, ("speed",), values, unit, name.replace("_", " "))
        for name, unit in (("amplitude_g", "g"), ("sdc", "1"), ("peak_velocity", "m/s")):
            rows = [list(getattr(d, name)) for d in dampings]
            _put(data, name, ("speed", "cycle"), _ragged(rows), unit, name.replace("_", " "))
        for name in ("initial", "final", "structure", "rolling", "impact", "slip", "residual"):
            _put(data, f"energy_{name}", ("speed",), [getattr(d.energy, name) for d in dampings], "J", f"{name} energy")
    return data


def write_vtu(surface: Surface, results: Results, path: Path) -> None:
    """The plate with a vector field per speed and mode, largest displacement 1; ParaView warps by it."""
    import meshio

    fields = {}
    for row, at in enumerate(surface.at):
        point = results.speeds[at]
        for number, mode in enumerate(point.modes):
            shape = surface.shapes[row, number]
            label = f"{curves.speed_tag(point)} mode {number + 1} {mode.family} {mode.frequency_hz:.1f} Hz"
            fields[label] = shape / max(float(np.linalg.norm(shape, axis=1).max()), 1e-300)
    mesh = meshio.Mesh(surface.points, [surface.cells], point_data=fields)
    mesh.write(path, file_format="vtu")


def _put(data: xr.Dataset, name: str, dims: tuple[str, ...], values: object, unit: str, long_name: str) -> None:
    data[name] = (dims, np.asarray(values, dtype=float), {"units": unit, "long_name": long_name})


def _ragged(rows: list[list[float]]) -> Floats:
    table = np.full((len(rows), max(map(len, rows), default=0)), np.nan)
    for line, row in zip(table, rows, strict=True):
        line[: len(row)] = row
    return table
