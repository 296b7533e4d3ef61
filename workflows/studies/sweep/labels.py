"""How a study's keys and values are named for people."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.scene.design import FLAT
from workflows.studies.sweep.axes import SPEEDS
from workflows.wording import significant, whole

if TYPE_CHECKING:
    import xarray as xr

    Floats = np.ndarray[Any, np.dtype[np.float64]]

_SHOWN = {
    "m": (1e3, "mm"),
    "kg": (1e3, "g"),
    "rad/s": (30 / math.pi, "rpm"),
    "rad": (180 / math.pi, "deg"),
    "1": (1.0, ""),
}
"""How units of coordinates are shown: a factor, and the unit's name."""


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


def said(data: xr.Dataset, name: str, value: Any) -> str:
    """A value of a key in words."""
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        return FLAT
    factor, unit = shown_unit(data, name)
    return f"{significant(factor * float(value), 4)} {unit}".rstrip()


def shown_unit(data: xr.Dataset, name: str) -> tuple[float, str]:
    """The unit that people have for a key: its factor from SI, and its name."""
    unit = str(data[name].attrs.get("units", "1"))
    return _SHOWN.get(unit, (1.0, unit))
