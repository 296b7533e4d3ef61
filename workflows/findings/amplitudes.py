"""At what amplitudes a ball does what it can: where half of its best is left, what wakes it, what is out of reach."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from workflows.findings import worth
from workflows.findings.cutoffs import in_g
from workflows.findings.said import at_load, capital, millimetres, percent
from workflows.solve.records import Results, SpeedPoint
from workflows.wording import span, whole

if TYPE_CHECKING:
    from workflows.solve.damper_records import OwnFigures

_BELOW = 0.8
"""Part of the amplitude that sets a ball off below which it is worth a word that it goes on."""

_ROLLS = 5 / 7
"""Displacement of a free rolling ball in its cavity over that of the floor."""

_KNOWN = 0.05
"""Relative error of a peak that is worth a word."""


def known_within(point: SpeedPoint) -> str:
    """How well a best figure is known, where it is not known well."""
    error = 0.0 if point.working is None else point.working.error
    return f" (known within {percent(min(error, 1.0))} %)" if error > _KNOWN else ""


def between(results: Results, points: list[SpeedPoint]) -> str | None:
    """Between what amplitudes the ball does half of its best, at the lowest load at which it can and at the highest."""
    limit = worth.endured(results) or math.inf
    known = [(p, w) for p in points if worth.best(results, p) is not None and (w := p.working) is not None]
    working = [(p, w) for p, w in known if w.half[0] < limit]
    if not working:
        return None
    ends = [working[0]] if len(working) == 1 else [working[0], working[-1]]
    ranges = []
    for point, figures in ends:
        low, high = figures.half[0], min(figures.half[1], limit)
        loads = [in_g(results, point.reduced, value) for value in (low, high) if point.reduced and point.load_g]
        said = f" ({whole(loads[0])} to {whole(loads[1])} g)" if loads else ""
        ends_there = ", all that the plate endures" if high < figures.half[1] else ""
        ranges.append(f"{at_load(point)} at amplitudes of {span(1e3 * low, 1e3 * high)} mm{said}{ends_there}")
    held = [
        f"{at_load(p)} below {millimetres(w.cutoff)} mm{_goes_on(results, p, w.cutoff)}"
        for p, w in ends
        if w.cutoff > 0
    ]
    rests = f" The load holds it at rest {', '.join(held)}." if held else ""
    return f"At least half of its best is left {', '.join(ranges)}.{_at_rest(results, ends)}{rests}"


def _goes_on(results: Results, point: SpeedPoint, cutoff: float) -> str:
    """Down to where a ball in motion goes on, far below what sets it off, as one in a hollow floor may."""
    if point.level is not None or point.damping is None or not point.damping.cutoff_g or point.reduced is None:
        return ""
    last = point.damping.cutoff_g / in_g(results, point.reduced, 1.0)
    return f" (one in motion goes on down to {millimetres(last)} mm)" if last < _BELOW * cutoff else ""


def reach(results: Results, points: list[SpeedPoint]) -> str | None:
    """From what load on the ball is out of reach of what the plate endures."""
    limit = worth.endured(results)
    lost = [(p, w) for p in points if worth.best(results, p) is None and (w := p.working) is not None]
    lost = [(p, w) for p, w in lost if w.peak > 0]
    if limit is None or not lost:
        return None
    point, figures = lost[0]
    said = at_load(point)
    return (
        f"{capital(said)} it takes {millimetres(figures.cutoff)} mm to set the ball rolling, but more than"
        f" {millimetres(limit)} mm would {worth.beyond(results)}: there the damper is out of reach."
    )


def _at_rest(results: Results, ends: list[tuple[SpeedPoint, OwnFigures]]) -> str:
    """Up to where a ball at rest in the middle meets no wall, where one that bounces goes on doing so below that.

    As the vibration grows, a ball that rolls freely goes by 5/7 of the floor's way.
    """
    damper = results.scene.damper
    if damper is None or damper.floor_radius is not None:
        return ""
    gap = damper.cavity[0] / 2 - damper.radius
    wakes = [(p, w, gap / (_ROLLS * abs(1 - p.tilt_share))) for p, w in ends if p.tilt_share != 1]
    said = [f"{at_load(p)} below {millimetres(a)} mm" for p, w, a in wakes if w.half[0] < _BELOW * a]
    if not said:
        return ""
    walls = f"as the vibration grows, one at rest meets no wall {', '.join(said)}"
    return f" That is a ball that bounces: {walls}, and takes less."
