"""Times that can be believed on a machine that does other things too: medians after a warm-up, with their spread."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")

RUNS = 5
_LONG = 1.0
"""Seconds from which once, after the warm-up, is enough."""

TOO_LONG = 4.0
"""Seconds from which the first run is the only one."""

PAIRS, FEWER, FEWEST = 7, 3, 2
"""Pairs of runs by which two pieces of work are compared: of short ones, of long ones, of those that take too long."""

POLICY = (
    "Each time is the median of up to five runs after a warm-up, its spread the least and the most; what takes a second"
    " runs once more, what takes four seconds only once. Rows of one ladder follow each other in one process, so that"
    " ratios hold better than seconds do."
)

POLICY_OF_DIFFERENCES = (
    "What an effect takes is the median difference of seven pairs of runs, with and without it, in turns after a"
    " warm-up; of three pairs where a run takes a second, of two where it takes four. Its spread is the least and the"
    " most of them; where these are not of one sign the difference is called within noise."
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
    if first >= TOO_LONG:
        return Timed(value, first, first, first)
    seconds = [_once(work)[1] for _ in range(1 if first >= _LONG else RUNS)]
    return Timed(value, statistics.median(seconds), min(seconds), max(seconds))


@dataclass(frozen=True)
class Compared(Generic[T]):
    """What some work returned, and the seconds it takes beyond those of other work: median, least and most.

    seconds, others: the median of each by itself.
    """

    value: T
    extra: float
    low: float
    high: float
    seconds: float
    others: float


def compared(work: Callable[[], T], other: Callable[[], object]) -> Compared[T]:
    """Time some work in turns with other that is warm already, so that a busy machine slows both."""
    value, first = _once(work)
    count = PAIRS if first < _LONG else FEWER if first < TOO_LONG else FEWEST
    pairs = [(_once(work)[1], _once(other)[1]) for _ in range(count)]
    extra = [mine - its for mine, its in pairs]
    seconds, others = (statistics.median(column) for column in zip(*pairs, strict=True))
    return Compared(value, statistics.median(extra), min(extra), max(extra), seconds, others)


def _once(work: Callable[[], T]) -> tuple[T, float]:
    begin = time.perf_counter()
    value = work()
    return value, time.perf_counter() - begin
