"""Times that can be believed on a machine that does other things too: medians after a warm-up, with their spread."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")

_RUNS = 5
_LONG = 1.0
"""Seconds from which once, after the warm-up, is enough."""

_TOO_LONG = 4.0
"""Seconds from which the first run is the only one."""

POLICY = (
    "Each time is the median of up to five runs after a warm-up, its spread the least and the most; what takes a second"
    " runs once more, what takes four seconds only once. Rows of one ladder follow each other in one process, so that"
    " ratios hold better than seconds do."
)


@dataclass(frozen=True)
class Timed(Generic[T]):
    """What some work returned, and the seconds it took: median, least and most."""

    value: T
    median: float
    low: float
    high: float


def timed(work: Callable[[], T]) -> Timed[T]:
    """Run some work often enough to know what it takes."""
    value, first = _once(work)
    if first >= _TOO_LONG:
        return Timed(value, first, first, first)
    seconds = [_once(work)[1] for _ in range(1 if first >= _LONG else _RUNS)]
    return Timed(value, statistics.median(seconds), min(seconds), max(seconds))


def _once(work: Callable[[], T]) -> tuple[T, float]:
    begin = time.perf_counter()
    value = work()
    return value, time.perf_counter() - begin
