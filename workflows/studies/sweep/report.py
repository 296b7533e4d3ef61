"""A study as files for people: `sweep.json` and one page; its sentences are in `sweep.toml`."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.formatting import interval, readable, significant, span, whole
from workflows.io.files import as_json, finite
from workflows.io.folder import replacing_file
from workflows.report import plots
from workflows.report.templates import from_template, said, texts
from workflows.scene.scene import FLAT
from workflows.solve.limits import AIR
from workflows.solve.results import Floats
from workflows.studies.sweep import evaluate, plan, sensitivity, store
from workflows.studies.sweep.evaluate import HEADLINE
from workflows.studies.sweep.plan import SAMPLE, SPEEDS
from workflows.studies.sweep.sensitivity import INDICES, PERCENTILES

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Picture:
    """A picture as SVG, and what it shows."""

    svg: str
    caption: str


def _unit(data: xr.Dataset, name: str) -> tuple[float, str]:
    return readable(str(data[name].attrs.get("units", "1")))


def _short(name: str) -> str:
    """A key without its table."""
    return name.partition(".")[2].replace("_", " ")


def _label(data: xr.Dataset, name: str) -> str:
    """A key with its unit."""
    return ", ".join(filter(None, (_short(name), _unit(data, name)[1])))


def _along(data: xr.Dataset, name: str) -> Floats:
    """The values of a key in the unit that people have for it."""
    return np.asarray(_unit(data, name)[0] * np.asarray(data[name].values, dtype=float))


def _formatted(data: xr.Dataset, name: str, value: Any) -> str:
    """A value of a key in words."""
    if isinstance(value, str):
        return value
    factor, unit = _unit(data, name)
    return f"{significant(factor * float(value), 4)} {unit}".rstrip() if math.isfinite(value) else FLAT


def _at(data: xr.Dataset, name: str | None, k: int) -> str:
    """A key with its kth value; nothing without a key."""
    if name is None:
        return ""
    if name == SPEEDS:
        return f"{whole(float(data['rpm'].values[k]))} rpm"
    return f"{_short(name)} {_formatted(data, name, data[name].values[k])}"


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
    """Round numbers, 1, 2, 5 and so on, over all values; at most as many as there are colours.

    `least`: quantile of the values from which on they are distinguished.
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


def paint(axes: Any, xs: Floats, ys: Floats, values: Floats, levels: list[float], colours: Any, idle: Any) -> None:
    """A map of values along x and y; the part that is idle is hatched up to the colours, which lie above."""
    works = values > 0
    if works.sum() > 1:
        shown = np.where(works, np.clip(values, levels[0], levels[-1]), values)
        axes.contourf(xs, ys, shown, levels, colors=colours)
    if idle.any():
        axes.contourf(xs, ys, idle.astype(float), [1e-9, 1.5], colors="none", hatches=[_HATCH], zorder=0.9)
    axes.set(xscale=scale(xs), yscale=scale(ys))
    axes.grid(visible=False)


def mark(axes: Any, x: float, y: float) -> None:
    """Mark the best point, also at the edge of a map."""
    axes.plot(x, y, "o", color=plots.PAPER, ms=8, mec=plots.INK, mew=1.2, clip_on=False, zorder=5)
    axes.plot(x, y, "x", color=plots.INK, ms=5, mew=1.4, clip_on=False, zorder=6)


def colour_key(figure: Any, levels: list[float], colours: list[str], title: str, *, idle: str = "") -> None:
    """Say below a map which colour is which level, and what is hatched."""
    from matplotlib.patches import Patch

    bands = zip(levels, levels[1:], colours, strict=False)
    named = [Patch(color=colour, label=span(low, high)) for low, high, colour in bands]
    if idle:
        named.insert(0, Patch(facecolor="none", edgecolor=plots.MUTED, lw=0.4, hatch=_HATCH, label=idle))
    figure.legend(handles=named[::-1], title=title, loc="outside lower left", ncols=3, alignment="left")


_MAPPED, _CURVES, _PANELS = 4, 7, 3
"""Values along both axes from which on there is a map; curves of a figure; panels of a figure."""

_QUANTITIES = {HEADLINE: ("damping ratio by the ball, %", 100.0), "cutoff": ("amplitude below which it rests, mm", 1e3)}
"""What is drawn: its name, and the factor from SI."""


@plots.style()
def draw(data: xr.Dataset) -> list[Picture]:
    """What a study looks like: the damping first, then the amplitude below which the ball rests."""
    if not (data[HEADLINE].values > 0).any():
        return []
    if "ST" in data:
        return [Picture(_bars(data), *said("sweep/of_bars"))]
    if SAMPLE in data.dims:
        return [Picture(_scattered(data), *said("sweep/of_sample"))]
    numbers = [str(name) for name in data.dims if np.issubdtype(np.asarray(data[name].values).dtype, np.number)]
    numbers.sort(key=lambda name: -data.sizes[name])
    keys = [name for name in numbers if name != SPEEDS]
    wide = [name for name in (keys if len(keys) > 1 else numbers) if data.sizes[name] >= _MAPPED]
    if len(wide) > 1:
        x, y = wide[:2]
        return [Picture(_map(data, name, x, y), map_caption(data, name, x, y)) for name in _drawn(data, (x, y))]
    x, others = numbers[0], [str(name) for name in data.dims if name != numbers[0]]
    series = max(others, key=lambda name: data.sizes[name], default=None)
    names, others = _drawn(data, (x,) if series is None else (x, series)), _fixed(data, (x, series))
    captions = {name: said("sweep/of_curves", quantity=name, others=others) for name in names}
    return [Picture(_curves(data, name, x, series), *caption) for name, caption in captions.items()]


def _drawn(data: xr.Dataset, along: tuple[str, ...]) -> list[str]:
    """The headline, and what else varies along these keys."""
    return [name for name in _QUANTITIES if name == HEADLINE or _varies(data, name, along)]


def _fixed(data: xr.Dataset, used: tuple[str | None, ...]) -> list[str]:
    """Keys that a picture does not show, with their values: those of the best point."""
    return [_at(data, name, k) for name, k in _best(data).items() if name not in used and data.sizes[name] > 1]


def panels(data: xr.Dataset, used: tuple[str, ...]) -> tuple[str | None, list[int]]:
    """The key with a panel for each of a few values: the speeds, from the lowest to the last at which a ball works."""
    others = [str(name) for name in data.dims if name not in used and data.sizes[name] > 1]
    if not others:
        return None, [0]
    name = SPEEDS if SPEEDS in others else others[-1]
    works = np.flatnonzero(_works(data, name))
    few = np.linspace(0, works.size - 1, min(works.size, _PANELS))
    return name, sorted({int(works[round(k)]) for k in few}) or [0]


def _works(data: xr.Dataset, name: str) -> Any:
    """For each value of a key, whether any ball takes anything there."""
    return (data[HEADLINE] > 0).any(dim=[dim for dim in data.dims if dim != name]).values


def _varies(data: xr.Dataset, quantity: str, along: tuple[str, ...]) -> bool:
    """Whether a quantity changes by more than a tenth along these dimensions anywhere."""
    low, high = data[quantity].min(dim=along), data[quantity].max(dim=along)
    return bool((high > 1.1 * low).any())


def _best(data: xr.Dataset) -> dict[str, int]:
    """Where the damper does most, as a place along every dimension; of points alike one whose friction is enough."""
    table, enough = data[HEADLINE], ~(data["friction_needed"].values > 0)
    place = np.unravel_index(int(np.nanargmax(table.values * np.where(enough, 1 + 1e-9, 1.0))), table.shape)
    return {str(name): int(k) for name, k in zip(table.dims, place, strict=True)}


def _as_good(data: xr.Dataset) -> int:
    """How many other points reach, within the stated errors, as much as the best."""
    values, width = data[HEADLINE].values, 1 + np.nan_to_num(data["working_error"].values)
    best = tuple(_best(data).values())
    return int((values * width >= values[best] / width[best]).sum()) - 1


def _ends(data: xr.Dataset) -> list[str]:
    """Keys of a grid, of three numbers and more, at an end of which it is best by over a percent; not the speeds."""
    best, ends = _best(data), list[str]()
    for name in (each for each in best if each != SPEEDS and each in data.coords):
        if data.sizes[name] > 2 and data[name].dtype.kind in "fiu":
            along = data[HEADLINE].isel({other: k for other, k in best.items() if other != name}).sortby(name).values
            place = int(np.argsort(np.argsort(data[name].values))[best[name]])
            beside = {0: 1, len(along) - 1: -2}.get(place)
            if beside is not None and not along[place] <= 1.01 * along[beside]:
                ends.append(name)
    return ends


def map_caption(data: xr.Dataset, quantity: str, x: str, y: str) -> str:
    """What a map shows, and what it does not: other keys, where no ball works, up to where balls rest."""
    best, (panel, places) = _best(data), panels(data, (x, y))
    ends, idle, at_rest = list[str](), "", list[str]()
    if quantity == HEADLINE:
        ends = [_short(key) for key in (x, y) if best[key] in (0, data.sizes[key] - 1)]
        still = np.array([]) if panel is None else np.flatnonzero(~_works(data, panel))
        if panel is not None and 0 < still.size < data.sizes[panel]:
            runs = np.split(still, np.flatnonzero(np.diff(still) > 1) + 1)
            idle = ", ".join(" to ".join(_at(data, panel, k) for k in sorted({run[0], run[-1]})) for run in runs)
        if not _varies(data, "cutoff", (x, y)):
            for k in places:
                least = float(np.nanmin(1e3 * data["cutoff"].isel({} if panel is None else {panel: k}).values))
                at_rest.append(f"{significant(least, 2)} mm" + f" at {_at(data, panel, k)}" * (panel is not None))
    of: dict[str, Any] = {"others": _fixed(data, (x, y, panel)), "ends": ends, "idle": idle, "at_rest": at_rest}
    return " ".join(said("sweep/of_map", quantity=quantity, **of))


def _map(data: xr.Dataset, quantity: str, x: str, y: str) -> str:
    """A map of a quantity with the best point marked."""
    (named, factor), best = _QUANTITIES[quantity], _best(data)
    panel, places = panels(data, (x, y))
    fixed = {name: k for name, k in best.items() if name not in (x, y, panel)}
    tables = [
        factor * data[quantity].isel(fixed | ({panel: k} if panel else {})).transpose(y, x).values for k in places
    ]
    levels = contour_levels(tables)
    figure, axes = plots.canvas(2.9, len(places))
    colours = map_spread(len(levels) - 1)
    xs, ys = _along(data, x), _along(data, y)
    for k, each, values in zip(places, axes, tables, strict=True):
        works = values > 0
        paint(each, xs, ys, np.where(works, values, np.nan), levels, colours, ~works)
        if quantity == HEADLINE:
            _boundaries(each, xs, ys, values)
        if panel is None or k == best[panel] or len(places) == 1:
            mark(each, xs[best[x]], ys[best[y]])
        each.set(xlabel=_label(data, x), title=_at(data, panel, k))
        each.set(xlim=(xs.min(), xs.max()), ylim=(ys.min(), ys.max()))
    axes[0].set_ylabel(_label(data, y))
    idle = any(not (values > 0).all() for values in tables)
    colour_key(figure, levels, colours, named, idle="no damping, or no verdict" if idle else "")
    return plots.svg(figure, f"map-{quantity}", f"{named} over {x} and {y}")


def _boundaries(axes: Axes, xs: Floats, ys: Floats, values: Floats) -> None:
    """Where the damper does as much as the air, and a tenth of it."""
    inside = [level for level in (10 * AIR[0], 100 * AIR[0]) if np.nanmin(values) < level < np.nanmax(values)]
    if inside:
        lines = axes.contour(xs, ys, values, inside, colors=plots.INK, linewidths=1.0, linestyles="dashed")
        axes.clabel(lines, fmt=lambda level: significant(level, 2), fontsize=6.5)


def _curves(data: xr.Dataset, quantity: str, x: str, series: str | None) -> str:
    """A quantity over one key, a curve for each value of another."""
    (named, factor), best = _QUANTITIES[quantity], _best(data)
    figure, (axes,) = plots.canvas(3.1)
    count = 1 if series is None else data.sizes[series]
    places = sorted({round(k) for k in np.linspace(0, count - 1, min(count, _CURVES))})
    fixed = {name: k for name, k in best.items() if name not in (x, series)}
    bars = list[tuple[Floats, Floats, str]]()
    for number, k in enumerate(places):
        point = data.isel(fixed | ({series: k} if series else {}))
        values = factor * point[quantity].values
        look: dict[str, Any] = {"color": plots.CATEGORIES[number], "marker": plots.MARKERS[number]}
        label = _at(data, series, k) or None
        shown = np.where(values > 0, values, np.nan)
        axes.plot(_along(data, x), shown, label=label, **look)
        error = 1 + point["working_error"].values
        bars.append((shown / error, shown * error, plots.CATEGORIES[number]))
    if quantity == HEADLINE:
        plots.air(axes)
    axes.set(xlabel=_label(data, x), ylabel=named, xscale=scale(_along(data, x)))
    axes.set_yscale(_value_scale(data[quantity].isel(fixed).values))
    if quantity == HEADLINE:
        axes.set_ylim(axes.get_ylim())  # an error without bound must not set them
        for low, high, colour in bars:
            axes.vlines(_along(data, x), low, high, color=colour, lw=1.0)
    if series is not None:
        plots.legend(figure, axes)
    return plots.svg(figure, f"curves-{quantity}", f"{named} over {x}")


def _value_scale(values: Floats) -> Any:
    """Logarithmic for positive values over more than a power of ten."""
    positive = values[values > 0]
    return "log" if positive.size and positive.max() > 10 * positive.min() else "linear"


def _bars(data: xr.Dataset) -> str:
    """Total indices of the peak and of the cut-off, a bar for each parameter."""
    titles = {HEADLINE: "largest damping ratio", "cutoff_ratio": "cut-off over the load"}
    names = [str(name) for name in data["parameter"].values]
    figure, panels = plots.canvas(0.9 + 0.34 * len(names), len(titles))
    for axes, (quantity, title) in zip(panels, titles.items(), strict=True):
        point = data.sel(quantity=quantity).isel({SPEEDS: _middle(data)})
        totals, halves = (100 * np.nan_to_num(point[index].values) for index in ("ST", "ST_conf"))
        axes.barh(range(len(names)), totals, color=plots.CATEGORIES[0], height=0.5)
        axes.errorbar(totals, range(len(names)), xerr=halves, fmt="none", ecolor=plots.INK, elinewidth=1.0)
        axes.set(title=title, xlabel="share of the variance, %", xlim=(0, None))
        axes.grid(visible=False, axis="y")
        axes.set_yticks(range(len(names)), [_short(name) for name in names])
    return plots.svg(figure, "indices", "Total Sobol' indices of each parameter")


def _middle(data: xr.Dataset) -> int:
    """The number of the middle speed."""
    return int(data.sizes[SPEEDS] - 1) // 2


_SCATTERED, _DOTS = 6, 2000
"""Keys of a sample that are drawn, and points."""


def _scattered(data: xr.Dataset) -> str:
    """The damping of a sample over each of its keys."""
    keys = [name for name in store.keys_of(data) if data[name].dims == (SAMPLE,)]
    keys = [name for name in keys if np.issubdtype(np.asarray(data[name].values).dtype, np.number)][:_SCATTERED]
    table = data[HEADLINE].isel({SPEEDS: _middle(data)}) if SPEEDS in data.dims else data[HEADLINE]
    figure, panels = plots.canvas(2.4, max(len(keys), 1))
    for axes, name in zip(panels, keys, strict=False):
        axes.plot(_along(data, name)[:_DOTS], 100 * table.values[:_DOTS], ".", color=plots.CATEGORIES[0], ms=2)
        axes.set(xlabel=_label(data, name), yscale=_value_scale(100 * table.values))
    panels[0].set_ylabel(_QUANTITIES[HEADLINE][0])
    return plots.svg(figure, "sample", "Damping ratio over each key of the sample")


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
        "without_friction": int((data["friction_needed"] > 0).sum()),
        "reasons": [{"reason": text, "points": count} for text, count in reasons.most_common(20)],
        "best": _point(data, _best(data)) if (flat > 0).any() else None,
        "best_at_end": _ends(data) if (flat > 0).any() else [],
        "as_good": _as_good(data) if (flat > 0).any() else 0,
    }
    return entries | ({"uncertain": _uncertain(data)} if "ST" in data else {})


def _uncertain(data: xr.Dataset) -> list[dict[str, Any]]:
    """Percentiles and indices as plain data, an entry for each quantity and speed."""
    entries = []
    for quantity in sensitivity.QUANTITIES:
        for k, rpm in enumerate(data["rpm"].values):
            point = data.sel(quantity=quantity).isel({SPEEDS: k})
            columns = zip(data["parameter"].values, *(point[index].values for index in INDICES), strict=True)
            indices = [{"parameter": str(n)} | dict(zip(INDICES, map(finite, row), strict=True)) for n, *row in columns]
            percentiles = zip(map(str, PERCENTILES), map(finite, point["percentiles"].values), strict=True)
            entry = {"quantity": quantity, "rpm": float(rpm)}
            entries.append(entry | {"percentiles": dict(percentiles), "indices": indices})
    return entries


_NUMBER = r"[-+]?\d[\d.]*(e[-+]?\d+)?"


def causes(data: xr.Dataset) -> Counter[str]:
    """How many points each cause leaves without an answer; reasons that differ in their numbers alone are one cause.

    Such a cause stands without the value of its key; where other numbers differ as well, with those of its first point.
    """
    texts = Counter(str(text) for text in data["reason"].values.ravel() if text)
    groups: dict[str, list[str]] = {}
    for text in texts:
        groups.setdefault(re.sub(_NUMBER, "#", text), []).append(text)
    counts: Counter[str] = Counter()
    for each in groups.values():
        name = each[0] if len(each) == 1 else re.sub(r"^(\[\w+\] [\w.]+) = .*?: ", r"\1: ", each[0])
        counts[name] += sum(texts[text] for text in each)
    return counts


def no_answer(data: xr.Dataset) -> str:
    """That no point has an answer, and every cause; empty where a point has one."""
    counts = causes(data)
    if sum(counts.values()) < data["reason"].size:
        return ""
    return "no point has an answer: " + "; ".join(f"{count} × {cause}" for cause, count in counts.most_common())


def _point(data: xr.Dataset, place: dict[str, int]) -> dict[str, Any]:
    """A point: the keys that are varied, and its quantities."""
    point = data[[quantity.name for quantity in evaluate.QUANTITIES]].isel(place)
    keys = {str(name): plan.as_plain([point.coords[name].item()])[0] for name in point.coords}
    values = {str(name): point[name].item() for name in point.data_vars}
    return {"keys": keys, "values": {name: value if math.isfinite(value) else None for name, value in values.items()}}


def _best_keys(data: xr.Dataset, entries: dict[str, Any]) -> dict[str, str]:
    """The keys of the best point in words."""
    keys = {} if entries["best"] is None else entries["best"]["keys"]
    return {SPEEDS if n == "rpm" else n: _formatted(data, n, value) for n, value in keys.items() if n != SPEEDS}


def _spread(data: xr.Dataset) -> dict[str, Any] | None:
    """How far the largest damping ratio spreads at the middle speed; None where there is none to speak of."""
    if "ST" not in data:
        return None
    percentiles = data["percentiles"].sel(quantity=HEADLINE).isel({SPEEDS: _middle(data)}).values
    ranked = sensitivity.worth_measuring(data, HEADLINE, _middle(data))
    if not (percentiles > 0).any():
        return None
    known = {"rpm": float(data["rpm"].values[_middle(data)]), "percentiles": percentiles.tolist(), "ranked": ranked}
    return known | {"judged": float(np.isfinite(data[HEADLINE].isel({SPEEDS: _middle(data)}).values).mean())}


def text(data: xr.Dataset) -> str:
    """The same in a few lines."""
    entries = document(data)
    return "\n".join(said("sweep/text", **_known(data, entries)))


def _known(data: xr.Dataset, entries: dict[str, Any]) -> dict[str, Any]:
    """What sentences on a sweep are made of."""
    best = entries["best"] or {"values": {}}
    error = best["values"].get("working_error") or 0.0
    return {"result": entries, "best": _best_keys(data, entries), "error": error, "spread": _spread(data)}


def write(data: xr.Dataset, out: Path) -> None:
    """Write `sweep.json` and `report.html` into a study's folder.

    Raises:
        BadInput: they cannot be written.
    """
    contents = {"sweep.json": as_json(document(data)) + "\n", "report.html": render(data)}
    with store.writing(out):
        for name, content in contents.items():
            with replacing_file(out / name) as fresh:
                fresh.write_text(content, encoding="utf-8")


def render(data: xr.Dataset) -> str:
    """The page."""
    entries = document(data)
    known, best = _known(data, entries), None
    if entries["best"] is not None:
        numbers = ((title, factor, entries["best"]["values"][name]) for name, title, factor in texts("sweep")["best"])
        figures = {title: significant(factor * value) for title, factor, value in numbers if value is not None}
        best = known["best"] | figures
    drawn = {str(name): data[str(name)].values for name in data["parameter"].values} if "ST" in data else {}
    ranges = {n: interval(_formatted(data, n, v.min()), _formatted(data, n, v.max())) for n, v in drawn.items()}
    return from_template(
        "sweep.html.j2",
        plots.shades_css(SHADES),
        result=entries,
        best=best,
        headline=" ".join(said("sweep/headline", **known)),
        friction=" ".join(said("sweep/without_friction", **known)),
        percentiles=_percentiles(data) if "ST" in data and best is not None else [],
        ranges=ranges,
        figures=draw(data),
        code=json.loads(data.attrs["code"]),
    )


def _percentiles(data: xr.Dataset) -> list[dict[str, Any]]:
    """Percentiles of the damping in % and of the cut-off at every speed, and the parameters that matter."""
    rows = []
    for quantity, title in ((HEADLINE, "damping ratio, %"), ("cutoff", "at rest below, mm")):
        for k, rpm in enumerate(data["rpm"].values):
            ranked = sensitivity.worth_measuring(data, quantity, k)[:2]
            worth = ", ".join(f"{_short(name)} {100 * total:.0f} %" for name, total, _ in ranked if total > 0.05)
            values = _QUANTITIES[quantity][1] * data["percentiles"].sel(quantity=quantity).isel({SPEEDS: k}).values
            if math.isfinite(values[0]):
                rows.append({"what": f"{title}, {rpm:.6g} rpm", "values": values.tolist(), "worth": worth or "none"})
    return rows
