"""The cut-off that tables show: the ring-down's own, or else the one that is known of a ball at rest."""

from __future__ import annotations

import math
from typing import NamedTuple

from workflows.solve.records import Reduced, Results, SpeedPoint

AT_REST, MEANS = "*", "* Up to there a ball at rest stays at rest; the ring-down itself shows no cut-off."
"""Of a number in a table, and what it stands for below."""


class Shown(NamedTuple):
    """Acceleration over g, that over the load, and the mark of one that no ring-down shows; None where not known."""

    g: float | None
    ratio: float | None
    mark: str


def in_g(results: Results, reduced: Reduced, amplitude: float) -> float:
    """Acceleration over g of a vibration of that amplitude [m]."""
    return (2 * math.pi * reduced.f1_hz) ** 2 * amplitude / results.scene.rotor.gravity


def shown(results: Results, point: SpeedPoint) -> Shown:
    """The cut-off at a speed, on the floor of the scene's ring-down."""
    damping, own, reduced = point.damping, point.level or point.working, point.reduced
    if damping is not None and damping.cutoff_g is not None:
        return Shown(damping.cutoff_g, damping.cutoff_ratio, "")
    if own is None or reduced is None or not 0 < own.cutoff < math.inf or point.load_g == 0:
        return Shown(None, None, "")
    g = in_g(results, reduced, own.cutoff)
    return Shown(g, g / point.load_g, AT_REST)


def legend(results: Results) -> list[str]:
    """What the mark stands for, where a table has it."""
    return [MEANS] if any(shown(results, point).mark for point in results.speeds) else []
