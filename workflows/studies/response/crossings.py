"""Where engine orders cross modes, from frequencies over speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workflows.solve.records import Floats, SpeedPoint

_RINGS = 5.0
"""Half the width of the band looked through, in damping ratios of the structure: the response falls to a tenth."""

_SHIFTS = 1.5
"""And in shifts of the frequency by the ball's mass, so that the structure's resonance is in it with and without."""

_BENT = 3.0
"""In the middle of the band speeds are three times as close as evenly spaced, so that no peak falls between them."""

_NARROWEST = 2e-3
"""Least half width of the band."""


@dataclass(frozen=True)
class Crossing:
    """An engine order that meets a mode.

    Attributes:
        order, branch: which order, and which of the modes at the lowest speed the mode continues, from 0.
        family: what the mode does.
        omega: speed [rad/s]; frequency [Hz].
        error: relative, of the frequency, None where it is not known; `basis`: what the reduced basis adds of it.
        turns: how fast the mode's frequency grows with the speed's, [-].
    """

    order: int
    branch: int
    family: str
    omega: float
    frequency: float
    error: float | None
    basis: float
    turns: float

    @property
    def rpm(self) -> float:
        """Speed [rev/min]."""
        return self.omega * 30 / math.pi

    def band(self, zeta: float, shift: float, low: float, high: float) -> tuple[float, float]:
        """Speeds between which the resonance is [rad/s], within what the scene asks for."""
        relative = max(_RINGS * zeta + _SHIFTS * shift, _NARROWEST)
        half = self.omega * relative * self.order / max(abs(self.order - self.turns), 1e-3)
        return max(self.omega - half, low), min(self.omega + half, high)


def of_points(points: Sequence[SpeedPoint], orders: Sequence[int]) -> tuple[Crossing, ...]:
    """Crossings between the speeds of some points, ascending in order and speed; frequencies between are linear.

    A structure that is given has one mode, whose frequency does not depend on the speed.
    """
    by_speed = sorted(points, key=lambda point: point.omega)
    found = []
    for order in sorted(orders):
        for branch in sorted(_branches(by_speed)):
            track = [(p, k) for p in by_speed if (k := _number(p, branch)) is not None]
            found += _on(order, branch, track)
    return tuple(found)


def _branches(points: Sequence[SpeedPoint]) -> set[int]:
    return {mode.branch for point in points for mode in point.modes} if any(p.modes for p in points) else {0}


def _number(point: SpeedPoint, branch: int) -> int | None:
    """Which of a point's modes continues a branch, from 0; None where it is not among them."""
    if not point.modes:
        return 0
    return next((k for k, mode in enumerate(point.modes) if mode.branch == branch), None)


def _on(order: int, branch: int, track: Sequence[tuple[SpeedPoint, int]]) -> list[Crossing]:
    omega = np.array([point.omega for point, _ in track])
    hertz = np.array([_hertz(point, k) for point, k in track])
    above = order * omega / (2 * math.pi) - hertz
    found = []
    for n in map(int, np.flatnonzero((above[:-1] < 0) != (above[1:] < 0))):
        share = above[n] / (above[n] - above[n + 1])
        point, k = track[n if share < 0.5 else n + 1]
        mode = point.modes[k] if point.modes else None
        parts = None if mode is None else mode.error_parts
        found.append(
            Crossing(
                order=order,
                branch=branch,
                family="flap" if mode is None else mode.family,
                omega=float(omega[n] + share * (omega[n + 1] - omega[n])),
                frequency=float(hertz[n] + share * (hertz[n + 1] - hertz[n])),
                error=None if mode is None else mode.error_estimate,
                basis=0.0 if parts is None else parts.basis,
                turns=float(2 * math.pi * (hertz[n + 1] - hertz[n]) / (omega[n + 1] - omega[n])),
            )
        )
    return found


def _hertz(point: SpeedPoint, k: int) -> float:
    if point.modes:
        return point.modes[k].frequency_hz
    if point.reduced is None:
        raise ValueError("the structure is not known")
    return point.reduced.f2_hz


def gathered(middle: float, low: float, high: float, count: int) -> Floats:
    """Speeds through a band [rad/s], closer to each other towards its middle."""
    x = np.linspace(-1.0, 1.0, count)
    bent = np.sinh(_BENT * x) / math.sinh(_BENT)
    return np.where(x < 0, middle + (middle - low) * bent, middle + (high - middle) * bent)
