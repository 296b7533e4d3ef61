"""How pictures of a study name its keys and values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.summary import said, shown_unit
from workflows.wording import whole

if TYPE_CHECKING:
    import xarray as xr

    Floats = np.ndarray[Any, np.dtype[np.float64]]


def value(data: xr.Dataset, name: str, k: int) -> str:
    """The kth value of a key in words."""
    found = data[name].values[k]
    return said(data, name, found.item() if hasattr(found, "item") else found)


def label(data: xr.Dataset, name: str) -> str:
    """A key with its unit."""
    unit = shown_unit(data, name)[1]
    return f"{short(name)}, {unit}" if unit else short(name)


def along(data: xr.Dataset, name: str) -> Floats:
    """The values of a key in the unit that people have for it."""
    found: Floats = shown_unit(data, name)[0] * np.asarray(data[name].values, dtype=float)
    return found


def titled(data: xr.Dataset, key: str | None, k: int) -> str:
    """A key with its kth value; nothing without a key."""
    if key is None:
        return ""
    if key == SPEEDS:
        return f"{whole(float(data['rpm'].values[k]))} rpm"
    return f"{short(key)} {value(data, key, k)}"


def short(name: str) -> str:
    """A key without its table."""
    return name.partition(".")[2].replace("_", " ")
