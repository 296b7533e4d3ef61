"""The speeds between which a resonance is followed."""

from __future__ import annotations

import math

import numpy as np

from workflows.results.crossings import Crossing
from workflows.solve.records import Floats

_RINGS = 5.0
"""Half the width of the band looked through, in damping ratios of the structure: the response falls to a tenth."""

_SHIFTS = 1.5
"""And in shifts of the frequency by the ball's mass, so that the structure's resonance is in it with and without."""

_BENT = 3.0
"""In the middle of the band speeds are three times as close as evenly spaced, so that no peak falls between them."""

_NARROWEST = 2e-3
"""Least half width of the band."""


def band(crossing: Crossing, zeta: float, shift: float, speeds: tuple[float, float]) -> tuple[float, float]:
    """Speeds between which the resonance is [rad/s], within what the scene asks for."""
    low, high = speeds
    relative = max(_RINGS * zeta + _SHIFTS * shift, _NARROWEST)
    half = crossing.omega * relative * crossing.order / max(abs(crossing.order - crossing.turns), 1e-3)
    return max(crossing.omega - half, low), min(crossing.omega + half, high)


def gathered(middle: float, low: float, high: float, count: int) -> Floats:
    """Speeds through a band [rad/s], closer to each other towards its middle."""
    x = np.linspace(-1.0, 1.0, count)
    bent = np.sinh(_BENT * x) / math.sinh(_BENT)
    return np.where(x < 0, middle + (middle - low) * bent, middle + (high - middle) * bent)
