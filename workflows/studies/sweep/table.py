"""A study as one labelled data set: every key that is varied a dimension, or a coordinate along the sample."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.keys import Value
from workflows.studies.sweep.quantities import QUANTITIES

if TYPE_CHECKING:
    import xarray as xr

    from workflows.studies.sweep.plans import Plan
    from workflows.studies.sweep.quantities import Block

Along: TypeAlias = dict[str, tuple[str, list[Value]]]
"""The values of every axis, and the dimension that they lie along."""

_SLAB = 16384
"""Points that are held at a time while a data set is written, and of its chunks."""


def write(plan: Plan, rows: Callable[[int, int], Block], attributes: dict[str, str], path: Path) -> None:
    """Write the data set of a whole study as Zarr, slab by slab along its first dimension.

    Args:
        plan: the study's points.
        rows: gives the rows of the points from one to before another, and their reasons.
        attributes: of the data set.
        path: where to.
    """
    first = next(iter(plan.dimensions))
    length, along_axes = plan.dimensions[first], plan.coordinates()
    for begin, end in slabs(plan):
        data = _slab(plan, along_axes, rows, begin, end).assign_attrs(attributes)
        if begin == 0:
            chunks = (min(length, _step(plan)), *list(plan.dimensions.values())[1:])
            encoding = {name: {"chunks": chunks} for name in data.data_vars}
            data.to_zarr(path, mode="w", encoding=encoding, consolidated=False, zarr_format=3)
        else:
            along = data.drop_vars([name for name in data.variables if first not in data[name].dims])
            along.to_zarr(path, append_dim=first, consolidated=False, zarr_format=3)


def slabs(plan: Plan) -> Iterator[tuple[int, int]]:
    """Stretches of the first dimension that are written at a time."""
    length, step = next(iter(plan.dimensions.values())), _step(plan)
    for begin in range(0, length, step):
        yield begin, min(begin + step, length)


def _step(plan: Plan) -> int:
    return max(1, _SLAB // math.prod(list(plan.dimensions.values())[1:]))


def _slab(plan: Plan, along_axes: Along, rows: Callable[[int, int], Block], begin: int, end: int) -> xr.Dataset:
    import xarray as xr

    names = tuple(plan.dimensions)
    shape = (end - begin, *list(plan.dimensions.values())[1:])
    each = math.prod(shape[1:])
    block = rows(begin * each, end * each)
    data: dict[str, Any] = {}
    for quantity in QUANTITIES:
        attributes = {"long_name": quantity.meaning, "units": quantity.unit}
        data[quantity.name] = (names, block.rows[quantity.name].reshape(shape), attributes)
    texts = np.array([*block.reasons, ""], dtype=object)[block.rows["reason"]]
    data["reason"] = (names, texts.reshape(shape), {"long_name": "why there is no answer; empty where there is one"})
    return xr.Dataset(data, coords=_coordinates(plan, along_axes, names[0], begin, end))


def _coordinates(plan: Plan, along_axes: Along, first: str, begin: int, end: int) -> dict[str, Any]:
    """Values of the keys along their dimensions, and the speeds in rpm beside them."""
    units = {axis.name: axis.key.unit for axis in plan.axes}
    found: dict[str, Any] = {}
    for name, (along, values) in along_axes.items():
        mine = values[begin:end] if along == first else values
        found[name] = (along, _array(mine), {"units": units[name]} if units[name] else {})
        if name == SPEEDS:
            from workflows.solve.records import rpm

            found["rpm"] = (along, np.array([rpm(float(value)) for value in mine]), {"units": "rpm"})
    return found


def _array(values: list[Value]) -> Any:
    """Numbers as numbers; words and truth values as words."""
    if any(isinstance(value, bool | str) for value in values):
        return np.array([value if isinstance(value, str) else str(value).lower() for value in values], dtype=object)
    return np.array(values)


def opened(path: Path) -> xr.Dataset:
    """A data set that was written, read as it is asked for."""
    import xarray as xr

    found = xr.open_dataset(path, engine="zarr", consolidated=False)
    # Zarr lists its arrays in any order.
    data = {name: found[name].variable for name in (*(quantity.name for quantity in QUANTITIES), "reason")}
    coordinates = {name: found[name].variable for name in (*keys_of(found), "rpm")}
    return xr.Dataset(data, coords=coordinates, attrs=found.attrs)


def keys_of(data: xr.Dataset) -> list[str]:
    """The keys that are varied, in the order of the plan."""
    found: list[str] = json.loads(data.attrs["keys"])
    return found


def attributes(title: str, plan: Plan, identity: dict[str, Any], key: str) -> dict[str, str]:
    """What a data set says of its origin."""
    return {
        "title": title,
        "keys": json.dumps([axis.name for axis in plan.axes]),
        "study": key,
        "scene": json.dumps(identity["scene"], ensure_ascii=False, sort_keys=True),
        "code": json.dumps(identity["code"], sort_keys=True),
    }
