"""The files beside `results.json`: netCDF for xarray, CSV for any program, VTU for ParaView."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workflows.results import curves, provenance
from workflows.results.document import ERROR_PARTS
from workflows.solve.records import Floats, Results, Surface, expect

if TYPE_CHECKING:
    import xarray as xr


def write_csv(results: Results, folder: Path) -> None:
    """One file per plotted curve, with a header that names column and unit.

    A remark in a CSV file trips its readers, so that hash and versions stand in `csv-metadata.json`, the place that
    the W3C's "CSV on the Web" has for them.
    """
    tables = []
    for curve in curves.every(results):
        rows = np.column_stack([curve.x, curve.y])
        columns = (curve.x_column, curve.y_column)
        np.savetxt(folder / f"{curve.name}.csv", rows, "%.10g", ",", header=",".join(columns), comments="")
        described = [{"name": name, "datatype": "double"} for name in columns]
        tables.append({"url": f"{curve.name}.csv", "tableSchema": {"columns": described}})
    if any(point.modes for point in results.speeds):
        described = [{"name": name, "datatype": "double"} for name in _write_errors(results, folder)]
        tables.append({"url": f"{curves.ERRORS}.csv", "tableSchema": {"columns": described}})
    metadata = {
        "@context": "http://www.w3.org/ns/csvw",
        "dc:title": results.scene.title,
        "dc:source": provenance.line(results),
        "tables": tables,
    }
    text = json.dumps(metadata, indent=1, ensure_ascii=False)
    (folder / "csv-metadata.json").write_text(text + "\n", encoding="utf-8")


def _write_errors(results: Results, folder: Path) -> tuple[str, ...]:
    """Every frequency with its relative error and its parts, 0 for effects not left out. Returns the columns."""
    columns = ("speed_rpm", "mode", "frequency_hz", "error_estimate", *(f"error_{name}" for name in ERROR_PARTS))
    rows = [
        [point.rpm, number, mode.frequency_hz, _known(mode, "error_estimate")]
        + [_known(mode.error_parts, name) for name in ERROR_PARTS[:4]]
        + [0.0 if np.isnan(part := _known(mode.error_parts, name)) else part for name in ERROR_PARTS[4:]]
        for point in results.speeds
        for number, mode in enumerate(point.modes, 1)
    ]
    np.savetxt(folder / f"{curves.ERRORS}.csv", rows, "%.10g", ",", header=",".join(columns), comments="")
    return columns


def write_netcdf(results: Results, path: Path) -> None:
    """All numbers of the run as one labelled data set.

    Raises:
        OSError: the file system refuses, also where HDF5 says so in words of its own.
    """
    try:
        dataset(results).to_netcdf(path, engine="h5netcdf")
    except RuntimeError as error:
        found = re.search(r"errno = (\d+)", str(error))
        if found is None:
            raise
        raise OSError(int(found[1]), os.strerror(int(found[1]))) from error


def dataset(results: Results) -> xr.Dataset:
    """The run as an xarray data set: dimensions rpm, mode and cycle; units in the attributes.

    Names are those of `results.json`. Where one speed has fewer modes or cycles than another, or no damper in
    motion, the rest is NaN.

    Raises:
        TypeError: not results.
    """
    expect(results, "dataset")
    import xarray as xr

    points = results.speeds
    data = xr.Dataset(
        coords={"rpm": ("rpm", np.array([p.rpm for p in points]), {"units": "rpm", "long_name": "rotation speed"})},
        attrs={
            "title": results.scene.title,
            "source": "spindamp",
            **provenance.hashes(results),
            "versions": ", ".join(f"{name} {number}" for name, number in provenance.versions().items()),
        },
    )
    _put(data, "load_g", ("rpm",), [p.load_g for p in points], "1", "centrifugal acceleration at the damper over g")
    if any(p.modes for p in points):
        _modes(data, results)
    if any(p.reduced is not None for p in points):
        for name, unit in (("f1_hz", "Hz"), ("f2_hz", "Hz"), ("M1", "kg"), ("M2", "kg"), ("K1", "N/m"), ("K2", "N/m")):
            state = "with the ball stuck" if "1" in name else "without the ball"
            _put(data, name, ("rpm",), [_known(p.reduced, name) for p in points], unit, f"{name[0]} {state}")
        said = "slope over displacement of the cavity's floor"
        _put(data, "floor_tilt", ("rpm",), [_known(p.reduced, "floor_tilt") for p in points], "1/m", said)
    if any(p.damping is not None for p in points):
        _dampings(data, results)
    if any(p.working is not None for p in points):
        _workings(data, results)
    return data


def _modes(data: xr.Dataset, results: Results) -> None:
    for name, unit, said in (
        ("frequency_hz", "Hz", "frequency"),
        ("error_estimate", "1", "relative error of the frequency as a whole"),
        ("damping_ratio", "1", "damping ratio of a complex mode"),
    ):
        rows = [[_known(mode, name) for mode in point.modes] for point in results.speeds]
        if name != "damping_ratio" or np.isfinite(_ragged(rows)).any():
            _put(data, name, ("rpm", "mode"), _ragged(rows), unit, said)
    for name in ERROR_PARTS:
        rows = [[_known(mode.error_parts, name) for mode in point.modes] for point in results.speeds]
        _put(data, f"error_{name}", ("rpm", "mode"), _ragged(rows), "1", f"its part {name.replace('_', ' ')}")
    families = [[mode.family for mode in point.modes] for point in results.speeds]
    width = max(map(len, families))
    padded = np.array([row + [""] * (width - len(row)) for row in families], dtype=object)
    data["family"] = (("rpm", "mode"), padded, {"long_name": "what the mode does"})


def _dampings(data: xr.Dataset, results: Results) -> None:
    dampings = [point.damping for point in results.speeds]
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
        _put(data, name, ("rpm",), [_known(d, name) for d in dampings], unit, name.replace("_", " "))
    for name, unit in (("amplitude_g", "g"), ("sdc", "1"), ("peak_velocity", "m/s")):
        rows = [[] if d is None else list(getattr(d, name)) for d in dampings]
        _put(data, name, ("rpm", "cycle"), _ragged(rows), unit, name.replace("_", " "))
    for name in ("initial", "final", "structure", "rolling", "impact", "slip", "residual"):
        values = [np.nan if d is None else getattr(d.energy, name) for d in dampings]
        _put(data, f"energy_{name}", ("rpm",), values, "J", f"{name} energy")


def _workings(data: xr.Dataset, results: Results) -> None:
    """The damper's own figures, the tilt of its floor counted in."""
    felt = [point.working for point in results.speeds]
    for name, field, unit, said in (
        ("damping_ratio_peak", "peak", "1", "largest damping ratio that the ball's losses amount to"),
        ("at_amplitude", "peak_amplitude", "m", "amplitude there"),
        ("cutoff", "cutoff", "m", "amplitude up to which the ball stays at rest"),
        ("working_error", "error", "1", "relative error of the largest damping ratio"),
    ):
        _put(data, name, ("rpm",), [_known(w, field) for w in felt], unit, said)
    if any(point.tilted is not None for point in results.speeds):
        for name, field, unit in (("tilted_cutoff_g", "g", "g"), ("tilted_cutoff_ratio", "ratio", "1")):
            values = [_known(point.tilted, field) for point in results.speeds]
            _put(data, name, ("rpm",), values, unit, "cut-off with the tilt of the floor that the scene leaves out")
    for end, side in enumerate(("low", "high")):
        ends = [np.nan if w is None else w.range[end] for w in felt]
        _put(data, f"range_{side}", ("rpm",), ends, "m", f"{side} end of the amplitudes at which the damper works")
    for name, field, unit in (("working_amplitude", "amplitude", "m"), ("working_damping_ratio", "damping_ratio", "1")):
        rows = [[] if w is None else list(getattr(w, field)) for w in felt]
        _put(data, name, ("rpm", "point"), _ragged(rows), unit, f"{field.replace('_', ' ')} along the damper's curve")


def write_vtu(surface: Surface, results: Results, path: Path) -> None:
    """The plate with a vector field per speed and mode, largest displacement 1; ParaView warps by it.

    A field's name does not change with what was computed: frequencies and families stand in the other files.
    """
    import meshio

    fields = {} if surface.thickness is None else {"thickness": surface.thickness}
    for row, at in enumerate(surface.at):
        point = results.speeds[at]
        for number in range(len(point.modes)):
            shape = surface.shapes[row, number]
            largest = max(float(np.linalg.norm(shape, axis=1).max()), 1e-300)
            fields[f"mode_{number + 1}_at_{point.rpm:.13g}_rpm"] = shape / largest
    mesh = meshio.Mesh(surface.points, [surface.cells], point_data=fields)
    mesh.write(path, file_format="vtu")
    declaration, rest = path.read_text(encoding="utf-8").split("\n", 1)
    remark = provenance.line(results).replace("--", "- -")  # which may not stand in a remark
    path.write_text(f"{declaration}\n<!-- {remark} -->\n{rest}", encoding="utf-8")


def _known(record: object, name: str) -> float:
    """A number of a record, NaN where either is missing."""
    value = None if record is None else getattr(record, name)
    return np.nan if value is None else float(value)


def _put(data: xr.Dataset, name: str, dims: tuple[str, ...], values: object, unit: str, long_name: str) -> None:
    data[name] = (dims, np.asarray(values, dtype=float), {"units": unit, "long_name": long_name})


def _ragged(rows: list[list[float]]) -> Floats:
    table = np.full((len(rows), max(map(len, rows), default=0)), np.nan)
    for line, row in zip(table, rows, strict=True):
        line[: len(row)] = row
    return table
