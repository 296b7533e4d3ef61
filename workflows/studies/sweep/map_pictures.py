"""Maps of a study over two keys, a panel for each of a few values of a third."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.findings.worth import AIR
from workflows.report import plots as plot
from workflows.studies.sweep import labels, maps
from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.quantities import HEADLINE
from workflows.wording import significant

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from workflows.studies.sweep.labels import Floats

_PANELS = 3
"""Of a figure."""


def panels(data: xr.Dataset, used: tuple[str, ...]) -> tuple[str | None, list[int]]:
    """The key with a panel for each of a few values: the speeds, from the lowest to the last at which a ball works."""
    others = [str(name) for name in data.dims if name not in used and data.sizes[name] > 1]
    if not others:
        return None, [0]
    name = SPEEDS if SPEEDS in others else others[-1]
    works = np.flatnonzero(_works(data, name))
    if not works.size:
        return name, [0]
    few = np.linspace(0, works.size - 1, min(works.size, _PANELS))
    return name, sorted({int(works[round(k)]) for k in few})


def _works(data: xr.Dataset, name: str) -> Any:
    """For each value of a key, whether any ball takes anything there."""
    return (data[HEADLINE] > 0).any(dim=[dim for dim in data.dims if dim != name]).values


def in_words(data: xr.Dataset, best: dict[str, int], x: str, y: str) -> str:
    """What the maps do not show: what lies beyond, where no ball works, up to which amplitude balls rest in a panel."""
    name, places = panels(data, (x, y))
    ends = [labels.short(key) for key in (x, y) if best[key] in (0, data.sizes[key] - 1)]
    found = f" It lies at an end of {' and '.join(ends)}: beyond, there may be more." if ends else ""
    if name is not None:
        idle = np.flatnonzero(~_works(data, name))
        if idle.size and idle.size < data.sizes[name]:
            found += (
                f" Nothing to draw at {_runs(data, name, idle)}: there, no ball has a verdict, or takes anything that"
                " the plate endures."
            )
    if not varies(data, "cutoff", (x, y)):
        ends = []
        for k in places:
            there = 1e3 * data["cutoff"].isel({} if name is None else {name: k}).values
            at = f" at {labels.titled(data, name, k)}" if name is not None else ""
            ends.append(f"{significant(float(np.nanmin(there)), 2)} mm{at}")
        found += f" The load holds the ball at rest below {', '.join(ends)}."
    return found


def _runs(data: xr.Dataset, name: str, places: Any) -> str:
    """Values of a key in words, each run of neighbours by its ends."""
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    ends = [[labels.titled(data, name, int(k)) for k in sorted({run[0], run[-1]})] for run in runs]
    return ", ".join(" to ".join(each) for each in ends)


def varies(data: xr.Dataset, quantity: str, names: tuple[str, ...]) -> bool:
    """Whether a quantity changes by more than a tenth along these dimensions anywhere."""
    low, high = data[quantity].min(dim=names), data[quantity].max(dim=names)
    return bool((high > 1.1 * low).any())


def draw(data: xr.Dataset, best: dict[str, int], shown: tuple[str, str, float], x: str, y: str) -> str:
    """A map of a quantity, its name in words and its factor from SI, with the best point marked."""
    quantity, named, factor = shown
    panel, places = panels(data, (x, y))
    fixed = {name: k for name, k in best.items() if name not in (x, y, panel)}
    tables = [
        factor * data[quantity].isel(fixed | ({panel: k} if panel else {})).transpose(y, x).values for k in places
    ]
    levels = maps.levels(tables)
    figure, axes = plot.canvas(2.9, len(places))
    colours = maps.spread(len(levels) - 1)
    xs, ys = labels.along(data, x), labels.along(data, y)
    idle = False
    for number, (each, values) in enumerate(zip(axes, tables, strict=True)):
        idle = _panel(each, xs, ys, values, levels) or idle
        if quantity == HEADLINE:
            _boundaries(each, xs, ys, values)
        if panel is None or places[number] == best[panel] or len(places) == 1:
            maps.mark(each, xs[best[x]], ys[best[y]])
        scales: dict[str, Any] = {"xscale": maps.scale(xs), "yscale": maps.scale(ys)}
        each.set(xlabel=labels.label(data, x), title=labels.titled(data, panel, places[number]), **scales)
        each.set(xlim=(xs.min(), xs.max()), ylim=(ys.min(), ys.max()))
        each.grid(visible=False)
    axes[0].set_ylabel(labels.label(data, y))
    maps.colour_key(figure, levels, colours, named, idle="nothing, or no verdict" if idle else "")
    return plot.svg(figure, f"map-{quantity}", f"{named} over {x} and {y}")


def _panel(axes: Axes, xs: Floats, ys: Floats, values: Floats, levels: list[float]) -> bool:
    """Colours where there is something, hatching where there is nothing; whether there is such a place."""
    some = np.where(values > 0, values, np.nan)
    if np.isfinite(some).sum() > 1:
        colours = maps.spread(len(levels) - 1)
        axes.contourf(xs, ys, np.clip(some, levels[0], levels[-1]), levels, colors=colours)
    nothing = ~(values > 0)
    if nothing.any():
        maps.hatch(axes, xs, ys, nothing)
    return bool(nothing.any())


def _boundaries(axes: Axes, xs: Floats, ys: Floats, values: Floats) -> None:
    """Where the damper does as much as the air, and a tenth of it."""
    levels = [100 * AIR[0] / 10, 100 * AIR[0]]
    inside = [level for level in levels if np.nanmin(values) < level < np.nanmax(values)]
    if inside:
        lines = axes.contour(xs, ys, values, inside, colors=plot.INK, linewidths=1.0, linestyles="dashed")
        axes.clabel(lines, fmt=lambda level: significant(level, 2), fontsize=6.5)
