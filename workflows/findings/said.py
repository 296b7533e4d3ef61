"""How the answer says a speed, an amplitude, a share."""

from __future__ import annotations

from workflows.solve.records import SpeedPoint
from workflows.wording import significant, whole


def at_load(point: SpeedPoint) -> str:
    """Where in the range of speeds, within a sentence."""
    return f"at {whole(point.rpm)} rpm" if point.load_g > 0 else "at rest"


def at_speed(point: SpeedPoint) -> str:
    """A speed with its load."""
    return f"{whole(point.rpm)} rpm ({whole(point.load_g)} g)"


def millimetres(length: float) -> str:
    """A length [m] in mm."""
    return significant(1e3 * length, 2)


def percent(share: float) -> str:
    """A share in percent."""
    return significant(100 * share, 2)
