"""What maps have in common: levels, colours, axes, and the key to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.report import plots as plot
from workflows.wording import significant

if TYPE_CHECKING:
    Floats = np.ndarray[Any, np.dtype[np.float64]]

_STEPS = (1.0, 2.0, 5.0)

_HATCH = "////"

SHADES = 12
"""Colours of a map, at most."""


def scale(values: Floats) -> str:
    """The axis of values: logarithmic where they are spread more evenly in their logarithm."""
    if len(values) < 3 or values.min() <= 0:
        return "linear"
    steps, ratios = np.diff(values), np.diff(np.log(values))
    return "log" if ratios.std() / abs(ratios.mean()) < steps.std() / abs(steps.mean()) else "linear"


def levels(tables: list[Floats], least: float = 0.02) -> list[float]:
    """Round numbers, 1, 2, 5 and so on, over what there is; at most as many as there are colours.

    `least`: quantile of the values from which on they are told apart.
    """
    known = np.concatenate([values[np.isfinite(values) & (values > 0)] for values in tables])
    if not known.size:
        return [0.0, 1.0]
    low, high = float(np.quantile(known, least)), float(known.max())
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    every = [step * 10.0**power for power in powers for step in _STEPS]
    levels = [level for level in every if level < high]
    first = max((k for k, level in enumerate(levels) if level <= low), default=0)
    levels = [*levels[first:], next(level for level in every if level >= high)]
    if len(levels) < 5:
        return [float(level) for level in np.linspace(low, high, 9)] if high > low else [0.9 * low, 1.1 * low]
    return levels[-SHADES - 1 :]


def spread(count: int) -> list[str]:
    """So many of the shades, from the first to the last."""
    every = plot.shades(SHADES)
    return [every[round(k * (SHADES - 1) / max(count - 1, 1))] for k in range(count)]


def hatch(axes: Any, xs: Floats, ys: Floats, where: Any) -> None:
    """Hatch the part of a map that has no figures."""
    axes.contourf(xs, ys, where.astype(float), [0.5, 1.5], colors="none", hatches=[_HATCH])


def mark(axes: Any, x: float, y: float) -> None:
    """Mark the best point, also at the edge of a map."""
    axes.plot(x, y, "o", color=plot.PAPER, ms=8, mec=plot.INK, mew=1.2, clip_on=False, zorder=5)
    axes.plot(x, y, "x", color=plot.INK, ms=5, mew=1.4, clip_on=False, zorder=6)


def colour_key(figure: Any, levels: list[float], colours: list[str], title: str, *, idle: str = "") -> None:
    """Say below a map which colour is which level, and what is hatched."""
    from matplotlib.patches import Patch

    named = [
        Patch(color=colour, label=f"{significant(low, 2)} to {significant(high, 2)}")
        for low, high, colour in zip(levels, levels[1:], colours, strict=False)
    ]
    if idle:
        named.insert(0, Patch(facecolor="none", edgecolor=plot.MUTED, lw=0.4, hatch=_HATCH, label=idle))
    figure.legend(handles=named[::-1], title=title, loc="outside lower left", ncols=3, alignment="left")
