"""How the answer says a speed, an amplitude, a share."""

from __future__ import annotations

from collections.abc import Sequence

from workflows.solve.records import SpeedPoint
from workflows.wording import significant, whole


def at_load(point: SpeedPoint) -> str:
    """Where in the range of speeds, within a sentence."""
    return f"at {whole(point.rpm)} rpm" if point.load_g > 0 else "at rest"


def at_speed(point: SpeedPoint) -> str:
    """A speed with its load."""
    return f"{whole(point.rpm)} rpm ({whole(point.load_g)} g)"


def stretch(chosen: Sequence[SpeedPoint], points: Sequence[SpeedPoint]) -> str:
    """Where some of the points lie among all, in few words: up to, from, from ... to; both with rising load."""
    places = sorted(points, key=lambda point: point.load_g)
    at = sorted(places.index(point) for point in chosen)
    first, last = (at_speed(places[k]) for k in (at[0], at[-1]))
    if len(at) == 1:
        return f"at {first}"
    if at[-1] - at[0] >= len(at):
        among = f"at {len(at)} of {len(places)} speeds from {first} to {last}"
        return f"at {first} and {last}" if len(at) == 2 else among
    if len(at) == len(places) or (at[0] > 0 and at[-1] < len(places) - 1):
        return f"from {first} to {last}"
    return f"up to {last}" if at[0] == 0 else f"from {first} on"


def capital(text: str) -> str:
    """The text as the begin of a sentence."""
    return text[0].upper() + text[1:]


def millimetres(length: float) -> str:
    """A length [m] in mm."""
    return significant(1e3 * length, 2)


def percent(share: float) -> str:
    """A share in percent."""
    return significant(100 * share, 2)
