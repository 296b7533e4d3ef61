"""Pictures of a study: maps over two keys, curves over one, or what a sample says of each key."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from workflows.findings.worth import AIR
from workflows.report import plots as plot
from workflows.studies.sweep import labels, map_pictures, maps, table
from workflows.studies.sweep.axes import SPEEDS
from workflows.studies.sweep.plans import SAMPLE
from workflows.studies.sweep.quantities import HEADLINE

if TYPE_CHECKING:
    import xarray as xr

_FOR_A_MAP, _CURVES = 4, 7
"""Values along both axes from which on there is a map; curves of a figure."""

NAMED = {HEADLINE: "damping ratio by the ball, %", "cutoff": "amplitude below which it rests, mm"}
_FACTORS = {HEADLINE: 100.0, "cutoff": 1e3}


@dataclass(frozen=True)
class Picture:
    """A picture as SVG, and what it shows."""

    svg: str
    caption: str


def draw(data: xr.Dataset) -> list[Picture]:
    """What a study looks like: the damping first, then the amplitude below which the ball rests."""
    if not (data[HEADLINE].values > 0).any():
        return []
    if "ST" in data:
        return [_picture(partial(_bars, data), _OF_BARS)]
    if SAMPLE in data.dims:
        return [_picture(partial(_scattered, data), "Each point of the sample, over each key that is varied.")]
    numbers = _numeric(data)
    keys = [name for name in numbers if name != SPEEDS]
    wide = [name for name in (keys if len(keys) > 1 else numbers) if data.sizes[name] >= _FOR_A_MAP]
    return _mapped(data, wide[0], wide[1]) if len(wide) > 1 else _along(data, numbers)


def _mapped(data: xr.Dataset, x: str, y: str) -> list[Picture]:
    """Maps over two keys."""
    best, used = _best(data), (x, y, map_pictures.panels(data, (x, y))[0])
    return [
        _picture(
            partial(map_pictures.draw, data, best, (name, NAMED[name], _FACTORS[name]), x, y),
            _caption(data, best, used, name) + map_pictures.in_words(data, best, x, y) * (name == HEADLINE),
        )
        for name in _shown(data, (x, y))
    ]


def _along(data: xr.Dataset, numbers: list[str]) -> list[Picture]:
    """Curves over the key with the most values, one for each value of the next."""
    best, x = _best(data), max(numbers, key=lambda name: data.sizes[name])
    series = max((str(name) for name in data.dims if name != x), key=lambda name: data.sizes[name], default=None)
    along = (x,) if series is None else (x, series)
    return [
        _picture(partial(_curves, data, best, name, x, series), _caption(data, best, along, name))
        for name in _shown(data, along)
    ]


def _shown(data: xr.Dataset, along: tuple[str, ...]) -> list[str]:
    """The headline, and what else varies along these keys."""
    return [name for name in NAMED if name == HEADLINE or map_pictures.varies(data, name, along)]


def _picture(draw: Callable[[], str], caption: str) -> Picture:
    with plot.style():
        return Picture(draw(), caption)


def _best(data: xr.Dataset) -> dict[str, int]:
    """Where the damper does most, as a place along every dimension."""
    place = np.unravel_index(int(np.nanargmax(data[HEADLINE].values)), tuple(data.sizes.values()))
    return {str(name): int(k) for name, k in zip(data.sizes, place, strict=True)}


def _numeric(data: xr.Dataset) -> list[str]:
    """Dimensions of numbers, the longest first."""
    names = [str(name) for name in data.dims if np.issubdtype(np.asarray(data[name].values).dtype, np.number)]
    return sorted(names, key=lambda name: -data.sizes[name])


def _caption(data: xr.Dataset, best: dict[str, int], used: tuple[str | None, ...], quantity: str) -> str:
    """What a picture shows, and the values of the keys that it does not show: those of the best point."""
    others = [name for name in best if name not in used and data.sizes[name] > 1]
    fixed = f" Here {', '.join(labels.titled(data, name, best[name]) for name in others)}." if others else ""
    air = f"The air gives turbine blades {100 * AIR[0]:.2f} to {100 * AIR[1]:.2f} %"
    of_maps = (
        "; dashed where the ball does as much as the least of that, and a tenth of it. Hatched: nothing at any"
        " amplitude that the plate endures, or no verdict. The cross is where it does most"
    )
    about = {
        HEADLINE: "The damping ratio that the ball alone amounts to at its best, at an amplitude that the plate"
        f" endures. {air}{of_maps * (len(used) > 2)}.",
        "cutoff": "Below this amplitude the load holds the ball at rest.",
    }
    return about[quantity] + fixed


def _curves(data: xr.Dataset, best: dict[str, int], quantity: str, x: str, series: str | None) -> str:
    """A quantity over one key, a curve for each value of another."""
    figure, (axes,) = plot.canvas(3.1)
    places = [0]
    if series is not None:
        count = data.sizes[series]
        places = sorted({round(k) for k in np.linspace(0, count - 1, min(count, _CURVES))})
    fixed = {name: k for name, k in best.items() if name not in (x, series)}
    xs = labels.along(data, x)
    for number, k in enumerate(places):
        values = _FACTORS[quantity] * data[quantity].isel(fixed | ({series: k} if series else {})).values
        label = None if series is None else labels.titled(data, series, k)
        colour = plot.CATEGORIES[number % len(plot.CATEGORIES)]
        axes.plot(xs, np.where(values > 0, values, np.nan), color=colour, marker=plot.MARKERS[number % 7], label=label)
    if quantity == HEADLINE:
        axes.axhspan(100 * AIR[0], 100 * AIR[1], color=plot.RULE, lw=0)
    positive = data[quantity].isel(fixed).values
    spread = np.nanmax(positive) > 10 * np.nanmin(np.where(positive > 0, positive, np.nan))
    axes.set(xlabel=labels.label(data, x), ylabel=NAMED[quantity], xscale=maps.scale(xs))
    axes.set_yscale("log" if spread else "linear")
    if series is not None:
        plot.legend(figure, axes)
    return plot.svg(figure, f"curves-{quantity}", f"{NAMED[quantity]} over {x}")


_OF_BARS = (
    "Which parameter is worth measuring: the share of the variance that each has together with all it acts with (total"
    " Sobol' index), with 95 % confidence, at the middle speed."
)


def _bars(data: xr.Dataset) -> str:
    """Total indices of the peak and of the cut-off, a bar for each parameter."""
    shown = (HEADLINE, "cutoff_ratio")
    k, names = (data.sizes[SPEEDS] - 1) // 2, [str(name) for name in data["parameter"].values]
    figure, panels = plot.canvas(0.9 + 0.34 * len(names), len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        found = data.sel(quantity=quantity).isel({SPEEDS: k})
        totals = 100 * np.nan_to_num(found["ST"].values)
        axes.barh(range(len(names)), totals, color=plot.CATEGORIES[0], height=0.5)
        halves = 100 * np.nan_to_num(found["ST_conf"].values)
        axes.errorbar(totals, range(len(names)), xerr=halves, fmt="none", ecolor=plot.INK, elinewidth=1.0)
        axes.set(title=_CALLED[quantity], xlabel="share of the variance, %", xlim=(0, None))
        axes.grid(visible=False, axis="y")
        axes.set_yticks(range(len(names)), [name.partition(".")[2].replace("_", " ") for name in names])
    return plot.svg(figure, "indices", "Total Sobol' indices of each parameter")


_CALLED = {HEADLINE: "largest damping ratio", "cutoff_ratio": "cut-off over the load"}

_SCATTERED = 6
_DOTS = 2000


def _scattered(data: xr.Dataset) -> str:
    """The damping of a sample over each of its keys."""
    keys = [name for name in table.keys_of(data) if data[name].dims == (SAMPLE,)]
    keys = [name for name in keys if np.issubdtype(np.asarray(data[name].values).dtype, np.number)][:_SCATTERED]
    values = 100 * data[HEADLINE]
    if SPEEDS in data.dims:
        values = values.isel({SPEEDS: (data.sizes[SPEEDS] - 1) // 2})
    some = slice(0, _DOTS)
    figure, panels = plot.canvas(2.4, max(len(keys), 1))
    for axes, name in zip(panels, keys, strict=False):
        axes.plot(labels.along(data, name)[some], values.values[some], ".", color=plot.CATEGORIES[0], ms=2)
        axes.set(xlabel=labels.label(data, name))
        known = values.values[np.isfinite(values.values) & (values.values > 0)]
        if known.size and known.max() > 10 * known.min():
            axes.set_yscale("log")
    panels[0].set_ylabel(NAMED[HEADLINE])
    return plot.svg(figure, "sample", "Damping ratio over each key of the sample")
