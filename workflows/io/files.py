"""The files beside `results.json`: netCDF for xarray, CSV for any program, VTU for ParaView; of studies; of modes."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fem import modal_files
from fem.modal_model import ModalModel
from workflows import formatting, versions
from workflows.errors import BadInput
from workflows.io import provenance
from workflows.io.folder import put, replacing, writable
from workflows.io.serialise import Variable, variables, write_unpublished
from workflows.solve.engine_orders import branches
from workflows.solve.results import OTHER_WAYS, Figures, Floats, Results, SpeedPoint, Surface, require_results

if TYPE_CHECKING:
    import xarray as xr


TABLE = "speeds"
"""The file of everything that is one number a speed, for spreadsheets."""

_OF_A_SPEED = rf"((velocity|ball|displacement)_[xy]|sdc|damping_ratio(_{'|_'.join(OTHER_WAYS)})?)_[\d.e+]+rpm"

FILES = rf"({TABLE}|campbell_\w+_\d+|{_OF_A_SPEED})\.csv"
"""What the files of curves are called, as a regular expression: which there are is known at the end of a run only."""


STUDIES = ("accuracy", "compare", "design", "effects", "reproduce", "response", "sweep")
"""Names of the JSON files that only folders of studies have."""

FILES_OF_STUDIES = rf"({'|'.join(STUDIES)}|campbell|closure|response_\w+)\.(json|csv|svg|nc)|best\.toml"
"""What studies write besides a page, as a regular expression."""

_STILL = 1e-9
"""Part of the largest motion along either axis that counts as none."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve: `name` is its file, `label` what a legend says; columns carry name and unit."""

    name: str
    label: str
    x_column: str
    y_column: str
    x: Floats
    y: Floats


def campbell(results: Results) -> list[Curve]:
    """Frequency over speed, one curve for each branch."""
    curves = []
    for branch in branches(results):
        points = [(results.speeds[at].rpm, results.speeds[at].modes[place].frequency_hz) for at, place in branch.places]
        rpm, frequency = np.array(points).T
        name = f"campbell_{''.join(c if c.isalnum() else '_' for c in branch.label)}"
        curves.append(Curve(name, branch.label, "speed_rpm", "frequency_hz", rpm, frequency))
    return curves


def velocity(point: SpeedPoint) -> list[Curve]:
    """The structure's velocity over time along axis 1, and along axis 2 if it moves that way (the paper's Fig. 2)."""
    history = None if point.damper is None else point.damper.history
    if history is None:
        return []
    moving = [i for i in range(2) if history.velocity[:, i].any()]
    return _over_time(point, "velocity", "velocity_m_s", history.t, history.velocity, moving)


def ball_path(point: SpeedPoint) -> list[Curve]:
    """The ball in its cavity, and the structure, over the stretch of time kept, along the axes that either moves on."""
    path = None if point.damper is None else point.damper.path
    if path is None:
        return []
    ball, displacement = path.ball, path.structure
    return [
        *_over_time(point, "ball", "position_m", path.t, ball, moving_axes(ball)),
        *_over_time(point, "displacement", "displacement_m", path.t, displacement, moving_axes(displacement)),
    ]


def _over_time(
    point: SpeedPoint, name: str, column: str, t: Floats, motion: Floats, axes: Sequence[int]
) -> list[Curve]:
    """A motion (n, 2) at times (n,) along some axes, from 0, a curve each."""
    tag = speed_tag(point)
    return [Curve(f"{name}_{'xy'[i]}_{tag}", f"axis {i + 1}", "time_s", column, t, motion[:, i]) for i in axes]


def moving_axes(motion: Floats) -> list[int]:
    """The axes, from 0, along which something (n, 2) moves."""
    reach = np.abs(motion).max(axis=0)
    return [i for i in range(2) if reach[i] > _STILL * reach.max()]


def capacity(results: Results) -> list[Curve]:
    """Specific damping capacity over the amplitude of the acceleration, a curve per load (Fig. 3)."""
    curves = []
    for point in results.speeds:
        damping = point.damper
        if damping is not None and (known := np.isfinite(damping.sdc)).any():
            label = f"{formatting.amount(point.load_g)} g"
            name = f"sdc_{speed_tag(point)}"
            curves.append(Curve(name, label, "amplitude_g", "sdc", damping.amplitude_g[known], damping.sdc[known]))
    return curves


def damping_ratio(results: Results, way: str = "") -> list[Curve]:
    """The ball's equivalent damping ratio over the amplitude, tilt of the floor counted in, a curve per speed.

    `way`: from another start, where the way down differs.
    """
    curves = []
    for point in results.speeds:
        own = point.damping_curve
        if own is not None and own.amplitude.size and (own.ways_differ or not way):
            figures: Figures = getattr(own, way) if way else own
            name = "_".join(filter(None, ("damping_ratio", way, speed_tag(point))))
            label, axes = f"{formatting.amount(point.rpm)} rpm", ("amplitude_m", "damping_ratio")
            curves.append(Curve(name, label, *axes, figures.amplitude, figures.damping_ratio))
    return curves


def speed_tag(point: SpeedPoint) -> str:
    """A rotation speed as part of a file name: 10000rpm, 12.5rpm."""
    return f"{point.rpm:.13g}rpm"


_SPEED = "rpm"
"""The dimension of speeds."""


def write_data(results: Results, folder: Path) -> None:
    """Every quantity as netCDF and, what is one number a speed, as a table; a CSV file per plotted curve.

    A remark in a CSV file trips its readers, so that hash and versions stand in the other files.
    """
    known = variables(SpeedPoint, results.speeds, _SPEED)
    _write_netcdf(results, known, folder / "results.nc")
    (folder / f"{TABLE}.csv").write_text(_table(known), encoding="utf-8")
    curves = [curve for point in results.speeds for curve in velocity(point) + ball_path(point)]
    curves += campbell(results) + capacity(results)
    curves += [curve for way in ("", *OTHER_WAYS) for curve in damping_ratio(results, way)]
    for curve in curves:
        rows = np.column_stack([curve.x, curve.y]) + 0.0  # no -0
        header = f"{curve.x_column},{curve.y_column}"
        np.savetxt(folder / f"{curve.name}.csv", rows, "%.10g", ",", header=header, comments="")


def _table(variables: Mapping[str, Variable]) -> str:
    """What is one number, or word, a speed, or a mode and speed, each a column under its name in the data set.

    Unknown numbers are empty cells; the parts of the errors stand in `results.json` and `results.nc`.
    """
    table: dict[str, list[Any]] = {}
    for name, (dims, values, attributes) in variables.items():
        unit = attributes.get("units", "")
        head = name if unit in ("", "1", name) else f"{name} [{unit}]"
        known = np.where(values == values, values.astype(object), "")  # nan differs from itself
        if dims == (_SPEED,):
            table[head] = known.tolist()
        elif dims == (_SPEED, "mode") and (name == "error_estimate" or not name.startswith("error_")):
            table |= {f"{head} {number}": column.tolist() for number, column in enumerate(known.T, 1)}
    return as_table(table, (dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)))


def _write_netcdf(results: Results, variables: Mapping[str, Variable], path: Path) -> None:
    """All numbers of the run as one labelled data set, that of :func:`dataset`; h5netcdf writes it in half the time.

    It is made in memory: HDF5 may end the process where a disk is full.
    """
    import h5netcdf
    import h5py

    content = io.BytesIO()
    with h5netcdf.File(content, "w") as file:
        file.dimensions = dict(
            pair for dims, each, _ in variables.values() for pair in zip(dims, each.shape, strict=True)
        )
        for name, (dims, values, attributes) in variables.items():
            missing = np.nan if values.dtype.kind == "f" else None
            kind = h5py.string_dtype() if values.dtype.kind == "O" else values.dtype
            file.create_variable(name, dims, kind, data=values, fillvalue=missing).attrs.update(attributes)
        file.attrs.update(global_attributes(results))
        write_unpublished(results, file)
    path.write_bytes(content.getvalue())


def dataset(results: Results) -> xr.Dataset:
    """The run as an xarray data set: every quantity of `results.json` by its name, over speed; units in the attributes.

    Speeds stand in the order of the scene; `.sortby("rpm")` sorts them. Further dimensions are mode, cycle of the
    ring-down, point of the damper's curve. Where one speed has fewer of them than another, or no damper in motion, the
    rest is NaN.

    Raises:
        TypeError: not results.
    """
    require_results(results, "dataset")
    import xarray as xr

    known = variables(SpeedPoint, results.speeds, _SPEED)
    coordinates = {_SPEED: known.pop(_SPEED)}
    return xr.Dataset(known, coords=coordinates, attrs=global_attributes(results))


def global_attributes(results: Results) -> dict[str, str]:
    """What a data set says of itself: title, hashes, versions."""
    return {
        "title": results.scene.title,
        "source": "spindamp",
        **provenance.hashes(results),
        "versions": versions.line(),
    }


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


def modes_file(file: str | os.PathLike[str], key: str = "file") -> Path:
    """The path of a neutral file.

    Raises:
        BadInput: its name does not end in .npz or .json, or it is a folder.
    """
    path = Path(file)
    if path.suffix.lower() not in (".npz", ".json"):
        raise BadInput("expected a name that ends in .npz or .json", key=key, value=str(file))
    if not path.absolute().parent.is_dir():
        raise BadInput("expected a file in an existing folder", key=key, value=str(file))
    return writable(path, key)


def save_modes(model: ModalModel, file: str | os.PathLike[str], key: str = "file") -> Path:
    """Write the neutral file, whole or not at all; what was there is replaced.

    Raises:
        BadInput: it cannot be written.
    """
    return put(modes_file(file, key), partial(modal_files.write, model), key)


def dump_modes(model: ModalModel) -> str:
    """The neutral file as JSON."""
    return json.dumps(modal_files.document(model), default=np.ndarray.tolist, allow_nan=False)


def as_json(document: Mapping[str, Any]) -> str:
    """The machine-readable result."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


def as_table(columns: Iterable[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """A table as CSV: without -0, nor what a row has beyond the columns; a list has spaces between its items."""
    text = io.StringIO(newline="")
    table = csv.DictWriter(text, list(columns), extrasaction="ignore")
    table.writeheader()
    for row in rows:
        cells = {k: v + 0.0 if isinstance(v, float) else v for k, v in row.items()}
        table.writerow({k: " ".join(map(str, v)) if isinstance(v, list) else v for k, v in cells.items()})
    return text.getvalue()


class StudyResult:
    """What a study came to; it prints as its command does, by the text of its report.

    Attributes:
        REPORT: the module of the report, which imports the study. It has `NAME`, that of the command, and three
            functions of a result: `document`, the machine-readable one; `text`, what a person reads on the terminal;
            `files`, those beside the document, by their names, the page among them.
    """

    REPORT: ClassVar[str]

    @property
    def report(self) -> Any:
        """The module of the report."""
        return import_module(self.REPORT)

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        return {"schema_version": 1, **self.report.document(self)}

    def __repr__(self) -> str:
        return formatting.plain(self.report.text(self))


def write_study(result: StudyResult, out: Path) -> None:
    """Write `<name>.json` and the other files of a study into `out`, or nothing.

    Raises:
        BadInput: `out` cannot be written.
    """
    contents = {f"{result.report.NAME}.json": as_json(result.document()) + "\n", **result.report.files(result)}
    with replacing(out) as folder:
        for name, content in contents.items():
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def finite(value: float | None) -> float | None:
    """A number for JSON, which has neither infinity nor nan: None in their place."""
    return None if value is None or not np.isfinite(value) else float(value)
