"""Pictures of a design: the map around the best, and what the best does over amplitude or through the crossings."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.findings.worth import AIR
from workflows.report import plots as plot
from workflows.studies.design import curves as curves_of
from workflows.studies.design import damping
from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.space import NAMES
from workflows.studies.response import plots, told
from workflows.studies.sweep import maps
from workflows.studies.sweep.pictures import Picture
from workflows.wording import whole

if TYPE_CHECKING:
    from workflows.studies.design.curves import Curve
    from workflows.studies.design.designed import Designed, Grid


def draw(found: Designed) -> list[Picture]:
    """All pictures there are."""
    pictures, goal = [], found.space.goal
    if isinstance(goal, LeastDamping):
        curves = curves_of.of(found.space, found.found, goal)
        if curves:
            pictures.append(_picture(partial(_curves, goal, curves), _OF_CURVES))
    if found.response is not None:
        for number, through in enumerate(found.response.passed):
            shades = maps.spread(len(through.forces) + 1)[:-1]
            drawn = partial(plots.response, found.response, through, str(number), shades)
            pictures.append(_picture(drawn, f"{told.place(through.crossing)}. {_OF_A_RESPONSE}"))
    if found.grid is not None and np.isfinite(found.grid.values).any():
        caption = _OF_DAMPING if isinstance(goal, LeastDamping) else _OF_AMPLITUDES
        pictures.append(_picture(partial(_map, found, found.grid), f"{caption} {_OF_THE_MAP}"))
    return pictures


def _picture(draw: Callable[[], str], caption: str) -> Picture:
    with plot.style():
        return Picture(draw(), caption)


_OF_CURVES = (
    "Damping ratio by the ball of the best damper over the amplitude at the cavity, at each speed. The range that"
    " counts lies between the dashed lines; dotted, the most that any ball of its mass could do in its room."
    f" Grey: what the air gives turbine blades, {100 * AIR[0]:.2f} to {100 * AIR[1]:.2f} %."
)
_OF_A_RESPONSE = (
    "Amplitude over speed with the best damper, from the least cycle to the greatest; dashed, without any ball."
)
_OF_DAMPING = "The least damping ratio over the range,"
_OF_AMPLITUDES = "The greatest amplitude at the crossings,"
_OF_THE_MAP = (
    "with two of the free lengths changed and all else as in the best, which is the cross. White: no such damper helps,"
    " mostly since the load holds the ball at rest. Hatched: a limit is exceeded."
)


def _curves(goal: LeastDamping, curves: list[Curve]) -> str:
    figure, (axes,) = plot.canvas(3.1)
    colours = maps.spread(len(curves) + 1)
    for curve, colour in zip(curves, colours, strict=False):
        shown = curve.working.damping_ratio > 0
        at, ratio = curve.working.amplitude[shown], curve.working.damping_ratio[shown]
        axes.plot(1e3 * at, 100 * ratio, color=colour, label=f"{whole(curve.rpm)} rpm")
        grid = np.geomspace(goal.low, goal.high, 30)
        bound = [damping.bound_of(curve.damper, float(amplitude)) for amplitude in grid]
        axes.plot(1e3 * grid, [100 * b if math.isfinite(b) else math.nan for b in bound], ":", color=colour, lw=1.0)
    axes.axhspan(100 * AIR[0], 100 * AIR[1], color=plot.RULE, lw=0)
    for end in (goal.low, goal.high):
        axes.axvline(1e3 * end, color=plot.INK, lw=0.8, ls=(0, (4, 3)))
    axes.set(xscale="log", yscale="log", xlabel="amplitude at the cavity, mm", ylabel="damping ratio by the ball, %")
    top = max(100 * curve.working.peak for curve in curves)
    axes.set_ylim(1e-3 * top, 4 * max(top, 100 * AIR[1]))
    plot.legend(figure, axes, title="speed")
    return plot.svg(figure, "best", "Damping ratio of the best damper over amplitude")


def _map(found: Designed, grid: Grid) -> str:
    of_damping = isinstance(found.space.goal, LeastDamping)
    factor, name = (100.0, "least damping ratio, %") if of_damping else (1e3, "greatest amplitude, mm")
    figure, (axes,) = plot.canvas(3.4)
    xs, ys = _shown(grid.x, grid.xs), _shown(grid.y, grid.ys)
    values = factor * grid.values
    levels = maps.levels([values]) if of_damping else maps.levels([values], least=0.0)
    colours = maps.spread(len(levels) - 1)
    axes.contourf(
        xs, ys, np.clip(values, levels[0], levels[-1]), levels, colors=colours if of_damping else colours[::-1]
    )
    if grid.beyond.any():
        maps.hatch(axes, xs, ys, grid.beyond)
    best = found.space.values(found.found.shares)
    at = _shown(grid.x, best[grid.x]), _shown(grid.y, best[grid.y])
    maps.mark(axes, *at)
    scales: dict[str, Any] = {"xscale": maps.scale(grid.xs), "yscale": maps.scale(grid.ys)}
    axes.set(xlabel=_label(grid.x), ylabel=_label(grid.y), **scales)
    axes.grid(visible=False)
    idle = "beyond a limit" if grid.beyond.any() else ""
    maps.colour_key(figure, levels, colours if of_damping else colours[::-1], name, idle=idle)
    return plot.svg(figure, "around", f"The {name.partition(',')[0]} around the best design")


def _shown(name: str, value: Any) -> Any:
    """In mm; of a ball its diameter."""
    return 1e3 * np.asarray(value, dtype=float) * (2 if name == "damper.radius" else 1)


def _label(name: str) -> str:
    return f"{NAMES[name].replace('_', ' ')}, mm"
