"""A study as files for people: `sweep.json` and one page."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.rotor import in_rpm
from workflows.formatting import significant, whole
from workflows.io.files import as_json
from workflows.io.folder import replacing_file
from workflows.report import plots
from workflows.report.page import from_template
from workflows.scene.scene import FLAT
from workflows.solve.limits import AIR
from workflows.studies.sweep import evaluate, plan, sensitivity, store
from workflows.studies.sweep.evaluate import HEADLINE
from workflows.studies.sweep.plan import SAMPLE, SPEEDS

if TYPE_CHECKING:
    import xarray as xr

    Floats = np.ndarray[Any, np.dtype[np.float64]]
    from matplotlib.axes import Axes


_SHOWN = {
    "m": (1e3, "mm"),
    "kg": (1e3, "g"),
    "rad/s": (in_rpm(1.0), "rpm"),
    "rad": (180 / math.pi, "deg"),
    "1": (1.0, ""),
}
"""How units of coordinates are shown: a factor, and the unit's name."""


def axis_label(data: xr.Dataset, name: str) -> str:
    """A key with its unit."""
    unit = shown_unit(data, name)[1]
    return f"{short(name)}, {unit}" if unit else short(name)


def along(data: xr.Dataset, name: str) -> Floats:
    """The values of a key in the unit that people have for it."""
    values: Floats = shown_unit(data, name)[0] * np.asarray(data[name].values, dtype=float)
    return values


def titled(data: xr.Dataset, key: str | None, k: int) -> str:
    """A key with its kth value; nothing without a key."""
    if key is None:
        return ""
    if key == SPEEDS:
        return f"{whole(float(data['rpm'].values[k]))} rpm"
    value = data[key].values[k]
    return f"{short(key)} {said(data, key, value.item() if hasattr(value, 'item') else value)}"


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


def contour_levels(tables: list[Floats], least: float = 0.02) -> list[float]:
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


def map_spread(count: int) -> list[str]:
    """So many of the shades, from the first to the last."""
    every = plots.shades(SHADES)
    return [every[round(k * (SHADES - 1) / max(count - 1, 1))] for k in range(count)]


def hatch(axes: Any, xs: Floats, ys: Floats, where: Any) -> None:
    """Hatch the part of a map that has no figures."""
    axes.contourf(xs, ys, where.astype(float), [0.5, 1.5], colors="none", hatches=[_HATCH])


def mark(axes: Any, x: float, y: float) -> None:
    """Mark the best point, also at the edge of a map."""
    axes.plot(x, y, "o", color=plots.PAPER, ms=8, mec=plots.INK, mew=1.2, clip_on=False, zorder=5)
    axes.plot(x, y, "x", color=plots.INK, ms=5, mew=1.4, clip_on=False, zorder=6)


def colour_key(figure: Any, levels: list[float], colours: list[str], title: str, *, idle: str = "") -> None:
    """Say below a map which colour is which level, and what is hatched."""
    from matplotlib.patches import Patch

    named = [
        Patch(color=colour, label=f"{significant(low, 2)} to {significant(high, 2)}")
        for low, high, colour in zip(levels, levels[1:], colours, strict=False)
    ]
    if idle:
        named.insert(0, Patch(facecolor="none", edgecolor=plots.MUTED, lw=0.4, hatch=_HATCH, label=idle))
    figure.legend(handles=named[::-1], title=title, loc="outside lower left", ncols=3, alignment="left")


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
    ends = [short(key) for key in (x, y) if best[key] in (0, data.sizes[key] - 1)]
    sentence = f" It lies at an end of {' and '.join(ends)}: the optimum may lie beyond." if ends else ""
    if name is not None:
        idle = np.flatnonzero(~_works(data, name))
        if idle.size and idle.size < data.sizes[name]:
            sentence += (
                f" Not drawn: {_runs(data, name, idle)}, where no ball has a verdict or adds damping within what the"
                " structure endures."
            )
    if not varies(data, "cutoff", (x, y)):
        ends = []
        for k in places:
            there = 1e3 * data["cutoff"].isel({} if name is None else {name: k}).values
            at = f" at {titled(data, name, k)}" if name is not None else ""
            ends.append(f"{significant(float(np.nanmin(there)), 2)} mm{at}")
        sentence += f" The load holds the ball at rest below {', '.join(ends)}."
    return sentence


def _runs(data: xr.Dataset, name: str, places: Any) -> str:
    """Values of a key in words, each run of neighbours by its ends."""
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    ends = [[titled(data, name, int(k)) for k in sorted({run[0], run[-1]})] for run in runs]
    return ", ".join(" to ".join(each) for each in ends)


def varies(data: xr.Dataset, quantity: str, names: tuple[str, ...]) -> bool:
    """Whether a quantity changes by more than a tenth along these dimensions anywhere."""
    low, high = data[quantity].min(dim=names), data[quantity].max(dim=names)
    return bool((high > 1.1 * low).any())


def draw_map(data: xr.Dataset, best: dict[str, int], quantity: str, x: str, y: str) -> str:
    """A map of a quantity with the best point marked."""
    named, factor = NAMED[quantity], _FACTORS[quantity]
    panel, places = panels(data, (x, y))
    fixed = {name: k for name, k in best.items() if name not in (x, y, panel)}
    tables = [
        factor * data[quantity].isel(fixed | ({panel: k} if panel else {})).transpose(y, x).values for k in places
    ]
    levels = contour_levels(tables)
    figure, axes = plots.canvas(2.9, len(places))
    colours = map_spread(len(levels) - 1)
    xs, ys = along(data, x), along(data, y)
    idle = False
    for number, (each, values) in enumerate(zip(axes, tables, strict=True)):
        idle = _panel(each, xs, ys, values, levels) or idle
        if quantity == HEADLINE:
            _boundaries(each, xs, ys, values)
        if panel is None or places[number] == best[panel] or len(places) == 1:
            mark(each, xs[best[x]], ys[best[y]])
        scales: dict[str, Any] = {"xscale": scale(xs), "yscale": scale(ys)}
        each.set(xlabel=axis_label(data, x), title=titled(data, panel, places[number]), **scales)
        each.set(xlim=(xs.min(), xs.max()), ylim=(ys.min(), ys.max()))
        each.grid(visible=False)
    axes[0].set_ylabel(axis_label(data, y))
    colour_key(figure, levels, colours, named, idle="no damping, or no verdict" if idle else "")
    return plots.svg(figure, f"map-{quantity}", f"{named} over {x} and {y}")


def _panel(axes: Axes, xs: Floats, ys: Floats, values: Floats, levels: list[float]) -> bool:
    """Colours where there is something, hatching where there is nothing; whether there is such a place."""
    some = np.where(values > 0, values, np.nan)
    if np.isfinite(some).sum() > 1:
        colours = map_spread(len(levels) - 1)
        axes.contourf(xs, ys, np.clip(some, levels[0], levels[-1]), levels, colors=colours)
    nothing = ~(values > 0)
    if nothing.any():
        hatch(axes, xs, ys, nothing)
    return bool(nothing.any())


def _boundaries(axes: Axes, xs: Floats, ys: Floats, values: Floats) -> None:
    """Where the damper does as much as the air, and a tenth of it."""
    levels = [100 * AIR[0] / 10, 100 * AIR[0]]
    inside = [level for level in levels if np.nanmin(values) < level < np.nanmax(values)]
    if inside:
        lines = axes.contour(xs, ys, values, inside, colors=plots.INK, linewidths=1.0, linestyles="dashed")
        axes.clabel(lines, fmt=lambda level: significant(level, 2), fontsize=6.5)


_FOR_A_MAP, _CURVES = 4, 7
"""Values along both axes from which on there is a map; curves of a figure."""

NAMED = {HEADLINE: "damping ratio by the ball, %", "cutoff": "amplitude below which it rests, mm"}
_FACTORS = {HEADLINE: 100.0, "cutoff": 1e3}


@dataclass(frozen=True)
class Picture:
    """A picture as SVG, and what it shows."""

    svg: str
    caption: str


@plots.style()
def draw(data: xr.Dataset) -> list[Picture]:
    """What a study looks like: the damping first, then the amplitude below which the ball rests."""
    if not (data[HEADLINE].values > 0).any():
        return []
    if "ST" in data:
        return [Picture(_bars(data), _OF_BARS)]
    if SAMPLE in data.dims:
        return [Picture(_scattered(data), "Each point of the sample, over each key that is varied.")]
    numbers = _numeric(data)
    keys = [name for name in numbers if name != SPEEDS]
    wide = [name for name in (keys if len(keys) > 1 else numbers) if data.sizes[name] >= _FOR_A_MAP]
    return _mapped(data, wide[0], wide[1]) if len(wide) > 1 else _along(data, numbers)


def _mapped(data: xr.Dataset, x: str, y: str) -> list[Picture]:
    """Maps over two keys."""
    best, used = _best(data), (x, y, panels(data, (x, y))[0])
    return [
        Picture(
            draw_map(data, best, name, x, y),
            _caption(data, best, used, name) + in_words(data, best, x, y) * (name == HEADLINE),
        )
        for name in _shown(data, (x, y))
    ]


def _along(data: xr.Dataset, numbers: list[str]) -> list[Picture]:
    """Curves over the key with the most values, one for each value of the next."""
    best, x = _best(data), max(numbers, key=lambda name: data.sizes[name])
    series = max((str(name) for name in data.dims if name != x), key=lambda name: data.sizes[name], default=None)
    along = (x,) if series is None else (x, series)
    return [
        Picture(_curves(data, best, name, x, series), _caption(data, best, along, name)) for name in _shown(data, along)
    ]


def _shown(data: xr.Dataset, along: tuple[str, ...]) -> list[str]:
    """The headline, and what else varies along these keys."""
    return [name for name in NAMED if name == HEADLINE or varies(data, name, along)]


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
    fixed = f" Here {', '.join(titled(data, name, best[name]) for name in others)}." if others else ""
    air = f"Air alone gives turbine blades {100 * AIR[0]:.2f} to {100 * AIR[1]:.2f} %"
    of_maps = (
        "; dashed lines: the lowest of that, and a tenth of it. Hatched: no damping at any amplitude that the structure"
        " endures, or no verdict. Cross: the best point"
    )
    about = {
        HEADLINE: "The largest damping ratio of the ball alone at amplitudes that the structure endures."
        f" {air}{of_maps * (len(used) > 2)}.",
        "cutoff": "Below this amplitude the load holds the ball at rest.",
    }
    return about[quantity] + fixed


def _curves(data: xr.Dataset, best: dict[str, int], quantity: str, x: str, series: str | None) -> str:
    """A quantity over one key, a curve for each value of another."""
    figure, (axes,) = plots.canvas(3.1)
    places = [0]
    if series is not None:
        count = data.sizes[series]
        places = sorted({round(k) for k in np.linspace(0, count - 1, min(count, _CURVES))})
    fixed = {name: k for name, k in best.items() if name not in (x, series)}
    xs = along(data, x)
    for number, k in enumerate(places):
        values = _FACTORS[quantity] * data[quantity].isel(fixed | ({series: k} if series else {})).values
        label = None if series is None else titled(data, series, k)
        colour = plots.CATEGORIES[number % len(plots.CATEGORIES)]
        axes.plot(xs, np.where(values > 0, values, np.nan), color=colour, marker=plots.MARKERS[number % 7], label=label)
    if quantity == HEADLINE:
        axes.axhspan(100 * AIR[0], 100 * AIR[1], color=plots.RULE, lw=0)
    positive = data[quantity].isel(fixed).values
    spread = np.nanmax(positive) > 10 * np.nanmin(np.where(positive > 0, positive, np.nan))
    axes.set(xlabel=axis_label(data, x), ylabel=NAMED[quantity], xscale=scale(xs))
    axes.set_yscale("log" if spread else "linear")
    if series is not None:
        plots.legend(figure, axes)
    return plots.svg(figure, f"curves-{quantity}", f"{NAMED[quantity]} over {x}")


_OF_BARS = (
    "Which parameter is worth measuring: the share of the variance due to each, interactions included (total Sobol'"
    " index), with 95 % confidence, at the middle speed."
)


def _bars(data: xr.Dataset) -> str:
    """Total indices of the peak and of the cut-off, a bar for each parameter."""
    shown = (HEADLINE, "cutoff_ratio")
    k, names = (data.sizes[SPEEDS] - 1) // 2, [str(name) for name in data["parameter"].values]
    figure, panels = plots.canvas(0.9 + 0.34 * len(names), len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        point = data.sel(quantity=quantity).isel({SPEEDS: k})
        totals = 100 * np.nan_to_num(point["ST"].values)
        axes.barh(range(len(names)), totals, color=plots.CATEGORIES[0], height=0.5)
        halves = 100 * np.nan_to_num(point["ST_conf"].values)
        axes.errorbar(totals, range(len(names)), xerr=halves, fmt="none", ecolor=plots.INK, elinewidth=1.0)
        axes.set(title=_CALLED[quantity], xlabel="share of the variance, %", xlim=(0, None))
        axes.grid(visible=False, axis="y")
        axes.set_yticks(range(len(names)), [short(name) for name in names])
    return plots.svg(figure, "indices", "Total Sobol' indices of each parameter")


_CALLED = {HEADLINE: "largest damping ratio", "cutoff_ratio": "cut-off over the load"}

_SCATTERED = 6
_DOTS = 2000


def _scattered(data: xr.Dataset) -> str:
    """The damping of a sample over each of its keys."""
    keys = [name for name in store.keys_of(data) if data[name].dims == (SAMPLE,)]
    keys = [name for name in keys if np.issubdtype(np.asarray(data[name].values).dtype, np.number)][:_SCATTERED]
    values = 100 * data[HEADLINE]
    if SPEEDS in data.dims:
        values = values.isel({SPEEDS: (data.sizes[SPEEDS] - 1) // 2})
    some = slice(0, _DOTS)
    figure, panels = plots.canvas(2.4, max(len(keys), 1))
    for axes, name in zip(panels, keys, strict=False):
        axes.plot(along(data, name)[some], values.values[some], ".", color=plots.CATEGORIES[0], ms=2)
        axes.set(xlabel=axis_label(data, name))
        known = values.values[np.isfinite(values.values) & (values.values > 0)]
        if known.size and known.max() > 10 * known.min():
            axes.set_yscale("log")
    panels[0].set_ylabel(NAMED[HEADLINE])
    return plots.svg(figure, "sample", "Damping ratio over each key of the sample")


_HEADLINE = sensitivity.QUANTITIES.index(HEADLINE)


def document(data: xr.Dataset) -> dict[str, Any]:
    """The machine-readable result: ``sweep.json``, and what ``--json`` prints."""
    flat = np.asarray(data[HEADLINE].values, dtype=float).ravel()
    reasons = causes(data)
    entries: dict[str, Any] = {
        "schema_version": 1,
        "title": data.attrs["title"],
        "study": data.attrs["study"],
        "dimensions": {str(name): int(data.sizes[name]) for name in data[HEADLINE].dims},
        "points": int(flat.size),
        "without_answer": sum(reasons.values()),
        "without_verdict": int(((data["grade"] == evaluate.UNGRADED) & (data["reason"] == "")).sum()),
        "reasons": [{"reason": text, "points": count} for text, count in reasons.most_common(20)],
        "best": None,
    }
    if (flat > 0).any():
        entries["best"] = at(data, int(np.nanargmax(flat)))
    if "ST" in data:
        entries["uncertain"] = sensitivity.document(data)
    return entries


_NUMBER = r"[-+]?\d[\d.]*(e[-+]?\d+)?"


def causes(data: xr.Dataset) -> Counter[str]:
    """How many points each cause leaves without an answer; reasons that differ in their numbers alone are one cause.

    Such a cause stands without the value of its key; where other numbers differ as well, with those of its first point.
    """
    texts = Counter(str(text) for text in data["reason"].values.ravel() if text)
    alike: dict[str, list[str]] = {}
    for text in texts:
        alike.setdefault(re.sub(_NUMBER, "#", text), []).append(text)
    counts: Counter[str] = Counter()
    for each in alike.values():
        name = each[0] if len(each) == 1 else re.sub(r"^(\[\w+\] [\w.]+) = .*?: ", r"\1: ", each[0])
        counts[name] += sum(texts[text] for text in each)
    return counts


def no_answer(data: xr.Dataset) -> str:
    """That no point has an answer, and every cause; empty where a point has one."""
    counts = causes(data)
    if sum(counts.values()) < data["reason"].size:
        return ""
    return "no point has an answer: " + "; ".join(f"{count} × {cause}" for cause, count in counts.most_common())


def at(data: xr.Dataset, number: int) -> dict[str, Any]:
    """A point by its absolute index: the keys that are varied, and what was found there."""
    points = data[[*evaluate.NUMBERS]]
    place = np.unravel_index(number, tuple(points.sizes[name] for name in points[HEADLINE].dims))
    point = points.isel({name: int(k) for name, k in zip(points[HEADLINE].dims, place, strict=True)})
    keys = {str(name): plan.said([point.coords[name].item()])[0] for name in point.coords}
    values = {str(name): point[name].item() for name in point.data_vars}
    return {"keys": keys, "values": {name: value if math.isfinite(value) else None for name, value in values.items()}}


def text(data: xr.Dataset) -> str:
    """The same in a few lines."""
    entries = document(data)
    sizes = " × ".join(f"{size} {name}" for name, size in entries["dimensions"].items())
    lines = [f"{entries['title']}: {entries['points']} point{'s' * (entries['points'] != 1)} ({sizes})"]
    if "ST" in data and _is_spread(data):
        lines += _uncertain(data)
    elif entries["best"] is not None:
        keys, values = entries["best"]["keys"], entries["best"]["values"]
        where = ", ".join(f"{name} = {said(data, name, value)}" for name, value in keys.items() if name != SPEEDS)
        lines.append(f"The best point is {where}:")
        amplitude = values["best_amplitude"]
        there = "" if amplitude is None else f" at an amplitude of {significant(1e3 * amplitude)} mm"
        lines.append(f"  a damping ratio of {significant(100 * values[HEADLINE])} %{there}")
    elif headline(data, entries):
        lines.append(headline(data, entries))
    if entries["without_verdict"]:
        have = "point has" if entries["without_verdict"] == 1 else "points have"
        lines.append(f"{entries['without_verdict']} {have} no verdict: `spindamp run` of such a point says why")
    if entries["without_answer"]:
        have = "point has" if entries["without_answer"] == 1 else "points have"
        lines.append(f"{entries['without_answer']} {have} no answer:")
        lines += [f"  {entry['points']} × {entry['reason']}" for entry in entries["reasons"][:3]]
    return "\n".join(lines)


def headline(data: xr.Dataset, entries: dict[str, Any]) -> str:
    """The answer of a study that is not that of its best point; empty where it is."""
    if entries["best"] is not None:
        return spread(data) if "ST" in data and _is_spread(data) else ""
    if entries["without_answer"] + entries["without_verdict"] < entries["points"]:
        return "No point adds damping at an amplitude that the structure endures"
    return "No point has a verdict" if entries["without_verdict"] else "No point has an answer"


def _is_spread(data: xr.Dataset) -> bool:
    """Whether the middle speed has a damping ratio to speak of."""
    return bool((data["percentiles"].values[_HEADLINE, :, (data.sizes[SPEEDS] - 1) // 2] > 0).any())


def spread(data: xr.Dataset) -> str:
    """How far the largest damping ratio spreads at the middle speed."""
    k = (data.sizes[SPEEDS] - 1) // 2
    low, _, middle, _, high = (100 * float(value) for value in data["percentiles"].values[_HEADLINE, :, k])
    return (
        f"At {float(data['rpm'].values[k]):.6g} rpm the largest damping ratio is {significant(low)} to"
        f" {significant(high)} % (90 %), with a median of {significant(middle)} %"
    )


def _uncertain(data: xr.Dataset) -> list[str]:
    """The spread, and what it is worth measuring for it."""
    ranked = sensitivity.worth_measuring(data, HEADLINE, (data.sizes[SPEEDS] - 1) // 2)
    shares = [f"{name} {significant(100 * total, 2)} ± {significant(100 * half, 2)} %" for name, total, half in ranked]
    if not shares:
        return [spread(data)]
    return [f"{spread(data)}; share of the variance by parameter, interactions included:", f"  {', '.join(shares)}"]


_FIGURES = (
    ("best_damping_ratio", "damping ratio, %", 100.0),
    ("best_amplitude", "at an amplitude of, mm", 1e3),
    ("cutoff", "at rest below, mm", 1e3),
    ("range_high", "half is left up to, mm", 1e3),
    ("cutoff_ratio", "cut-off of the ring-down over the load", 1.0),
    ("ball_mass", "mass of the balls, g", 1e3),
    ("working_error", "error of the damping ratio, %", 100.0),
)
"""What the page says of the best point."""


def write(data: xr.Dataset, out: Path) -> None:
    """Write `sweep.json` and `report.html` into a study's folder.

    Raises:
        BadInput: they cannot be written.
    """
    page = render(data)
    with store.writing(out):
        for name, text in (("sweep.json", f"{dumps(data)}\n"), ("report.html", page)):
            with replacing_file(out / name) as fresh:
                fresh.write_text(text, encoding="utf-8")


def dumps(data: xr.Dataset) -> str:
    """The machine-readable result."""
    return as_json(document(data))


def render(data: xr.Dataset) -> str:
    """The page."""
    entries = document(data)
    return from_template(
        "sweep.html.j2",
        plots.shades_css(SHADES),
        result=entries,
        best=_best_line(data, entries),
        headline=headline(data, entries),
        doubts=_doubts(data) if "ST" in data and entries["best"] is not None else [],
        spreads=_spreads(data) if "ST" in data else {},
        figures=draw(data),
        code=json.loads(data.attrs["code"]),
    )


def _doubts(data: xr.Dataset) -> list[dict[str, Any]]:
    """Percentiles of the damping in % and of the cut-off at every speed, and the parameters that matter."""
    rows = []
    for quantity, called in ((HEADLINE, "damping ratio, %"), ("cutoff", "at rest below, mm")):
        q = sensitivity.QUANTITIES.index(quantity)
        for k, rpm in enumerate(data["rpm"].values):
            ranked = sensitivity.worth_measuring(data, quantity, k)[:2]
            worth = ", ".join(f"{short(name)} {100 * total:.0f} %" for name, total, _ in ranked if total > 0.05)
            values = [_FACTORS[quantity] * float(value) for value in data["percentiles"].values[q, :, k]]
            if math.isfinite(values[0]):
                rows.append({"what": f"{called}, {rpm:.6g} rpm", "values": values, "worth": worth or "none"})
    return rows


def _spreads(data: xr.Dataset) -> dict[str, str]:
    """The ranges that were drawn from, in words."""
    names = [str(name) for name in data["parameter"].values]
    ends = {name: (data[name].values.min(), data[name].values.max()) for name in names}
    return {name: f"{said(data, name, low)} to {said(data, name, high)}" for name, (low, high) in ends.items()}


def _best_line(data: xr.Dataset, entries: dict[str, Any]) -> dict[str, str] | None:
    """The best point in words, name by name."""
    if entries["best"] is None:
        return None
    keys, values = entries["best"]["keys"], entries["best"]["values"]
    words = {name: said(data, name, value) for name, value in keys.items() if name != SPEEDS}
    numbers = ((title, factor, values[name]) for name, title, factor in _FIGURES)
    return words | {title: significant(factor * value) for title, factor, value in numbers if value is not None}
