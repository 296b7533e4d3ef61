"""The files beside `results.json`: netCDF for xarray, CSV for any program, VTU for ParaView."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.results import curves, provenance
from workflows.results.columns import Column, columns
from workflows.solve.records import Mode, Results, SpeedPoint, Surface, expect

if TYPE_CHECKING:
    import xarray as xr

_SPEED = "rpm"
"""The dimension of speeds."""

_ERRORS = ("frequency", "error")
"""How the names of frequencies and their errors begin."""


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
    numbered = [(point.rpm, number, mode) for point in results.speeds for number, mode in enumerate(point.modes, 1)]
    table: dict[str, Any] = {"speed_rpm": [rpm for rpm, *_ in numbered], "mode": [number for _, number, _ in numbered]}
    for each in columns(Mode, [mode for *_, mode in numbered], "mode"):
        if each.name.startswith(_ERRORS):
            left_out = each.name.removeprefix("error_") in results.effects
            table[each.name] = np.nan_to_num(each.values) if left_out else each.values
    rows = np.column_stack(list(table.values()))
    np.savetxt(folder / f"{curves.ERRORS}.csv", rows, "%.10g", ",", header=",".join(table), comments="")
    return tuple(table)


def write_netcdf(results: Results, path: Path) -> None:
    """All numbers of the run as one labelled data set, that of :func:`dataset`; h5netcdf writes it in half the time.

    Raises:
        OSError: the file system refuses, also where HDF5 says so in words of its own.
    """
    import h5netcdf
    import h5py

    variables = _variables(results)
    try:
        with h5netcdf.File(path, "w") as file:
            file.dimensions = _sizes(variables)
            for name, (dims, values, attributes) in variables.items():
                missing = np.nan if values.dtype.kind == "f" else None
                kind = h5py.string_dtype() if values.dtype.kind == "O" else values.dtype
                file.create_variable(name, dims, kind, data=values, fillvalue=missing).attrs.update(attributes)
            file.attrs.update(_about(results))
    except RuntimeError as error:
        found = re.search(r"errno = (\d+)", str(error))
        if found is None:
            raise
        raise OSError(int(found[1]), os.strerror(int(found[1]))) from error


def dataset(results: Results) -> xr.Dataset:
    """The run as an xarray data set: every quantity of `results.json` by its name, over speed; units in the attributes.

    Further dimensions are mode, cycle of the ring-down, point of the damper's curve. Where one speed has fewer of them
    than another, or no damper in motion, the rest is NaN.

    Raises:
        TypeError: not results.
    """
    expect(results, "dataset")
    import xarray as xr

    variables = _variables(results)
    coordinates = {_SPEED: variables.pop(_SPEED)}
    return xr.Dataset(variables, coords=coordinates, attrs=_about(results))


_Variable = tuple[tuple[str, ...], Any, dict[str, str]]
"""Dimensions, values, attributes."""


def _variables(results: Results) -> dict[str, _Variable]:
    """Every quantity over speed by its name, all filled up to the same sizes."""
    found = list(columns(SpeedPoint, results.speeds, _SPEED))
    sizes: dict[str, int] = {}
    for each in found:
        sizes |= {d: max(n, sizes.get(d, 0)) for d, n in zip(each.dims, each.values.shape, strict=True)}
    return {each.name: _variable(each, sizes) for each in found}


def _sizes(variables: dict[str, _Variable]) -> dict[str, int]:
    return {name: size for dims, values, _ in variables.values() for name, size in zip(dims, values.shape, strict=True)}


def _about(results: Results) -> dict[str, str]:
    """The attributes of the data set."""
    return {
        "title": results.scene.title,
        "source": "spindamp",
        **provenance.hashes(results),
        "versions": ", ".join(f"{name} {number}" for name, number in provenance.versions().items()),
    }


def _variable(column: Column, sizes: dict[str, int]) -> _Variable:
    """A column as xarray takes it, filled up to the sizes of the dimensions."""
    missing = [(0, sizes[name] - length) for name, length in zip(column.dims, column.values.shape, strict=True)]
    nothing = np.nan if column.unit else ""
    units = {"units": column.unit} if column.unit else {}
    values = np.pad(column.values, missing, constant_values=nothing) if np.any(missing) else column.values
    return column.dims, values, {**units, "long_name": column.meaning}


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
