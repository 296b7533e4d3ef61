"""Pictures of a study: maps over two keys, curves over one, or what a sample says of each key."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.findings.worth import AIR
from workflows.report import drawing
from workflows.report.drawing import Sheet
from workflows.studies.sweep import maps, table
from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.plans import SAMPLE
from workflows.studies.sweep.summary import HEADLINE, said, shown_unit
from workflows.wording import whole

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    Floats = np.ndarray[Any, np.dtype[np.float64]]

_FOR_A_MAP, _CURVES, _PANELS = 4, 7, 3
"""Values along both axes from which on there is a map; curves of a figure; panels of one."""

NAMED = {HEADLINE: "damping ratio by the ball, %", "cutoff": "amplitude below which it rests, mm"}
_FACTORS = {HEADLINE: 100.0, "cutoff": 1e3}


@dataclass(frozen=True)
class Picture:
    """A picture as SVG, and what it shows."""

    svg: str
    caption: str


def draw(data: xr.Dataset) -> list[Picture]:
    """What a study looks like: the damping first, then the amplitude below which the ball rests."""
    if not np.isfinite(data[HEADLINE].values).any():
        return []
    if "ST" in data:
        return [_picture(partial(_bars, data), _OF_BARS)]
    if SAMPLE in data.dims:
        return [_picture(partial(_scattered, data), "Each point of the sample, over each key that is varied.")]
    best = _best(data)
    numbers = _numeric(data)
    keys = [name for name in numbers if name != SPEEDS]
    wide = [name for name in (keys if len(keys) > 1 else numbers) if data.sizes[name] >= _FOR_A_MAP]
    if len(wide) > 1:
        x, y = wide[:2]
        used = (x, y, _panels(data, (x, y), best)[0])
        shown = [name for name in NAMED if name == HEADLINE or _varies(data, name, (x, y))]
        return [_picture(partial(_maps, data, best, name, x, y), _caption(data, best, used, name)) for name in shown]
    x = max(numbers, key=lambda name: data.sizes[name])
    series = max((str(name) for name in data.dims if name != x), key=lambda name: data.sizes[name], default=None)
    along = (x,) if series is None else (x, series)
    shown = [name for name in NAMED if name == HEADLINE or _varies(data, name, along)]
    return [
        _picture(partial(_curves, data, best, name, x, series), _caption(data, best, along, name)) for name in shown
    ]


def _picture(draw: Callable[[Sheet], str], caption: str) -> Picture:
    with drawing.style():
        return Picture(drawing.both(draw), caption)


def _best(data: xr.Dataset) -> dict[str, int]:
    """Where the damper does most, as a place along every dimension."""
    place = np.unravel_index(int(np.nanargmax(data[HEADLINE].values)), tuple(data.sizes.values()))
    return {str(name): int(k) for name, k in zip(data.sizes, place, strict=True)}


def _numeric(data: xr.Dataset) -> list[str]:
    """Dimensions of numbers, the longest first."""
    names = [str(name) for name in data.dims if np.issubdtype(np.asarray(data[name].values).dtype, np.number)]
    return sorted(names, key=lambda name: -data.sizes[name])


def _varies(data: xr.Dataset, quantity: str, names: tuple[str, ...]) -> bool:
    """Whether a quantity changes by a percent along these dimensions anywhere."""
    low, high = data[quantity].min(dim=names), data[quantity].max(dim=names)
    return bool((high > 1.01 * low).any())


def _caption(data: xr.Dataset, best: dict[str, int], used: tuple[str | None, ...], quantity: str) -> str:
    """What a picture shows, and the values of the keys that it does not show: those of the best point."""
    others = [name for name in best if name not in used and data.sizes[name] > 1]
    fixed = f" Here {', '.join(_panel_title(data, name, best[name]) for name in others)}." if others else ""
    air = f"The air gives turbine blades {100 * AIR[0]:.2f} to {100 * AIR[1]:.2f} %"
    of_maps = "; dashed where the ball does as much, and a tenth of it. The cross is where it does most"
    about = {
        HEADLINE: "The damping ratio that the ball alone amounts to at its best, at an amplitude that the plate"
        f" endures. {air}{of_maps * (len(used) > 2)}.",
        "cutoff": "Below this amplitude the load holds the ball at rest.",
    }
    return about[quantity] + fixed


def _value(data: xr.Dataset, name: str, k: int) -> str:
    return said(
        data, name, data[name].values[k].item() if hasattr(data[name].values[k], "item") else data[name].values[k]
    )


def _label(data: xr.Dataset, name: str) -> str:
    unit = shown_unit(data, name)[1]
    short = name.partition(".")[2].replace("_", " ")
    return f"{short}, {unit}" if unit else short


def _along(data: xr.Dataset, name: str) -> Floats:
    found: Floats = shown_unit(data, name)[0] * np.asarray(data[name].values, dtype=float)
    return found


def _panels(data: xr.Dataset, used: tuple[str, ...], best: dict[str, int]) -> tuple[str | None, list[int]]:
    """The dimension that has a panel for each of a few values: the speeds, the lowest, the middle and the highest."""
    others = [str(name) for name in data.dims if name not in used and data.sizes[name] > 1]
    if not others:
        return None, [0]
    name = SPEEDS if SPEEDS in others else others[-1]
    count = data.sizes[name]
    return name, sorted({round(k) for k in np.linspace(0, count - 1, min(count, _PANELS))})


def _maps(data: xr.Dataset, best: dict[str, int], quantity: str, x: str, y: str, sheet: Sheet) -> str:
    """A map of a quantity over two keys, a panel for each of a few speeds."""
    panel, places = _panels(data, (x, y), best)
    fixed = {name: k for name, k in best.items() if name not in (x, y, panel)}
    tables = [
        _FACTORS[quantity] * data[quantity].isel(fixed | ({panel: k} if panel else {})).transpose(y, x).values
        for k in places
    ]
    levels = maps.levels(tables)
    figure, axes = drawing.canvas(sheet, 2.9, len(places))
    colours = maps.spread(len(levels) - 1)
    for number, (each, values) in enumerate(zip(axes, tables, strict=True)):
        xs, ys = _along(data, x), _along(data, y)
        if np.isfinite(values).sum() > 1:
            each.contourf(xs, ys, np.clip(values, levels[0], levels[-1]), levels, colors=colours)
        if quantity == HEADLINE:
            _boundaries(each, xs, ys, values)
        if panel is None or places[number] == best[panel] or len(places) == 1:
            each.plot(xs[best[x]], ys[best[y]], "x", color=drawing.INK, ms=7, mew=1.6, clip_on=False)
        scales: dict[str, Any] = {
            "xscale": maps.scale(xs),
            "yscale": maps.scale(ys),
        }
        each.set(xlabel=_label(data, x), title=_panel_title(data, panel, places[number]), **scales)
        each.grid(visible=False)
    axes[0].set_ylabel(_label(data, y))
    maps.colour_key(figure, sheet, levels, colours, NAMED[quantity])
    return drawing.svg(figure, sheet, f"map-{quantity}", f"{NAMED[quantity]} over {x} and {y}")


def _boundaries(axes: Axes, xs: Floats, ys: Floats, values: Floats) -> None:
    """Where the damper does as much as the air, and a tenth of it."""
    levels = [100 * AIR[0] / 10, 100 * AIR[0]]
    inside = [level for level in levels if np.nanmin(values) < level < np.nanmax(values)]
    if inside:
        axes.contour(xs, ys, values, inside, colors=drawing.INK, linewidths=1.0, linestyles="dashed")


def _panel_title(data: xr.Dataset, panel: str | None, k: int) -> str:
    if panel is None:
        return ""
    if panel == SPEEDS:
        return f"{whole(float(data['rpm'].values[k]))} rpm"
    return f"{panel.partition('.')[2].replace('_', ' ')} {_value(data, panel, k)}"


def _curves(data: xr.Dataset, best: dict[str, int], quantity: str, x: str, series: str | None, sheet: Sheet) -> str:
    """A quantity over one key, a curve for each value of another."""
    figure, (axes,) = drawing.canvas(sheet, 3.1)
    places = [0]
    if series is not None:
        count = data.sizes[series]
        places = sorted({round(k) for k in np.linspace(0, count - 1, min(count, _CURVES))})
    fixed = {name: k for name, k in best.items() if name not in (x, series)}
    xs = _along(data, x)
    for number, k in enumerate(places):
        values = _FACTORS[quantity] * data[quantity].isel(fixed | ({series: k} if series else {})).values
        label = None if series is None else _panel_title(data, series, k)
        colour = drawing.CATEGORIES[number % len(drawing.CATEGORIES)]
        axes.plot(
            xs, np.where(values > 0, values, np.nan), color=colour, marker=drawing.MARKERS[number % 7], label=label
        )
    if quantity == HEADLINE:
        axes.axhspan(100 * AIR[0], 100 * AIR[1], color=drawing.RULE, lw=0)
    positive = data[quantity].isel(fixed).values
    spread = np.nanmax(positive) > 10 * np.nanmin(np.where(positive > 0, positive, np.nan))
    axes.set(xlabel=_label(data, x), ylabel=NAMED[quantity], xscale=maps.scale(xs))
    axes.set_yscale("log" if spread else "linear")
    if series is not None:
        drawing.key(figure, axes, sheet)
    return drawing.svg(figure, sheet, f"curves-{quantity}", f"{NAMED[quantity]} over {x}")


_OF_BARS = (
    "Which parameter is worth measuring: the share of the variance that each has together with all it acts with (total"
    " Sobol' index), with 95 % confidence, at the middle speed."
)


def _bars(data: xr.Dataset, sheet: Sheet) -> str:
    """Total indices of the peak and of the cut-off, a bar for each parameter."""
    shown = ("damping_ratio_peak", "cutoff_ratio")
    k, names = (data.sizes[SPEEDS] - 1) // 2, [str(name) for name in data["parameter"].values]
    figure, panels = drawing.canvas(sheet, 0.9 + 0.34 * len(names), len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        found = data.sel(quantity=quantity).isel({SPEEDS: k})
        totals = 100 * np.nan_to_num(found["ST"].values)
        axes.barh(range(len(names)), totals, color=drawing.CATEGORIES[0], height=0.5)
        halves = 100 * np.nan_to_num(found["ST_conf"].values)
        axes.errorbar(totals, range(len(names)), xerr=halves, fmt="none", ecolor=drawing.INK, elinewidth=1.0)
        axes.set(title=_CALLED[quantity], xlabel="share of the variance, %", xlim=(0, None))
        axes.grid(visible=False, axis="y")
        axes.set_yticks(range(len(names)), [name.partition(".")[2].replace("_", " ") for name in names])
    return drawing.svg(figure, sheet, "indices", "Total Sobol' indices of each parameter")


_CALLED = {"damping_ratio_peak": "largest damping ratio", "cutoff_ratio": "cut-off over the load"}

_SCATTERED = 6
_DOTS = 2000


def _scattered(data: xr.Dataset, sheet: Sheet) -> str:
    """The damping of a sample over each of its keys."""
    keys = [name for name in table.keys_of(data) if data[name].dims == (SAMPLE,)]
    keys = [name for name in keys if np.issubdtype(np.asarray(data[name].values).dtype, np.number)][:_SCATTERED]
    values = 100 * data[HEADLINE]
    if SPEEDS in data.dims:
        values = values.isel({SPEEDS: (data.sizes[SPEEDS] - 1) // 2})
    some = slice(0, _DOTS)
    figure, panels = drawing.canvas(sheet, 2.4, max(len(keys), 1))
    for axes, name in zip(panels, keys, strict=False):
        axes.plot(_along(data, name)[some], values.values[some], ".", color=drawing.CATEGORIES[0], ms=2)
        axes.set(xlabel=_label(data, name))
        known = values.values[np.isfinite(values.values) & (values.values > 0)]
        if known.size and known.max() > 10 * known.min():
            axes.set_yscale("log")
    panels[0].set_ylabel(NAMED[HEADLINE])
    return drawing.svg(figure, sheet, "sample", "Damping ratio over each key of the sample")
