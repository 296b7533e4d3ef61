"""Where engine orders meet natural frequencies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from workflows.results import curves
from workflows.scene.scene import Scene
from workflows.solve.records import Results

ENGINE_ORDERS = (1, 2, 3, 4, 6, 8, 12, 16)
"""Multiples of the rotation's frequency that are looked at in any scene."""


def orders(scene: Scene) -> tuple[int, ...]:
    """Those, and the ones that the scene's [excitation] names."""
    asked = () if scene.excitation is None else scene.excitation.orders
    return tuple(sorted({*ENGINE_ORDERS, *asked}))


@dataclass(frozen=True)
class Crossing:
    """A speed at which an engine order excites a mode."""

    order: int
    label: str
    rpm: float
    frequency_hz: float


def crossings(results: Results) -> list[Crossing]:
    """All of them within the speeds of a run.

    Between two speeds f² goes with Ω² along a straight line, as it does for a mode that keeps its shape (Southwell);
    an order is a line through the origin there, so that they meet at most once.
    """
    return [
        Crossing(order, track.label, rpm, order * rpm / 60)
        for track in curves.campbell(results)
        for order in orders(results.scene)
        for low, high in pairwise(zip(track.x.tolist(), track.y.tolist(), strict=True))
        if (rpm := _meeting(order, low, high)) is not None
    ]


def _meeting(order: int, low: tuple[float, float], high: tuple[float, float]) -> float | None:
    """The speed [rpm] between two points (rpm, Hz) at which an order meets the frequency; None where it does not."""
    (a, f), (b, g) = low, high
    below, above = f**2 - (order * a / 60) ** 2, g**2 - (order * b / 60) ** 2
    if below == above or below * above > 0 or above == 0:
        return None
    share = below / (below - above)
    return math.sqrt(a**2 + share * (b**2 - a**2))
