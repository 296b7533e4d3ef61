"""Times that can be believed on a machine that does other things too: medians after a warm-up, with their spread."""

import math
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, replace
from typing import Any, Generic, TypeVar

from workflows.io.files import StudyResult
from workflows.progress import Step

T = TypeVar("T")

RUNS = 5
_LONG = 1.0
"""Seconds from which once, after the warm-up, is enough."""

TOO_LONG = 4.0
"""Seconds from which the first run is the only one."""

PAIRS, FEWER, FEWEST = 7, 3, 2
"""Pairs of runs by which two pieces of work are compared: of short ones, of long ones, of those that take too long."""


@dataclass(frozen=True)
class Timing(Generic[T]):
    """What some work returned, and the seconds it took: median, least and most."""

    value: T
    median: float
    low: float
    high: float


def timed(work: Callable[[], T]) -> Timing[T]:
    """Run some work often enough to know what it takes."""
    value, first = _once(work)
    repeats = 0 if first >= TOO_LONG else 1 if first >= _LONG else RUNS
    seconds = [_once(work)[1] for _ in range(repeats)] or [first]
    return Timing(value, statistics.median(seconds), min(seconds), max(seconds))


def compared(work: Callable[[], T], other: Callable[[], object]) -> tuple[Timing[T], float, float]:
    """Time some work in turns with other that is warm already, so that a busy machine slows both.

    Returns:
        What the work returned with the seconds it takes beyond the other; the medians of both by themselves.
    """
    value, first = _once(work)
    count = PAIRS if first < _LONG else FEWER if first < TOO_LONG else FEWEST
    pairs = [(_once(work)[1], _once(other)[1]) for _ in range(count)]
    extra = [mine - its for mine, its in pairs]
    medians = (statistics.median(column) for column in zip(*pairs, strict=True))
    return Timing(value, statistics.median(extra), min(extra), max(extra)), *medians


def _once(work: Callable[[], T]) -> tuple[T, float]:
    begin = time.perf_counter()
    value = work()
    return value, time.perf_counter() - begin


@dataclass(frozen=True)
class Setting:
    """One setting of one method.

    Attributes:
        unknowns: size of what is solved, or steps taken; None where there is no such number.
        time_s: median seconds; spread_s: least and most. None where it failed.
        error: relative, against the study's reference; uncertainty: how far that can be trusted, None if unknown.
        failed: why there is no time and no error.
    """

    method: str
    setting: str
    unknowns: int | None = None
    time_s: float | None = None
    spread_s: tuple[float, float] | None = None
    error: float | None = None
    uncertainty: float | None = None
    failed: str | None = None


@dataclass(frozen=True)
class ConvergenceStudy:
    """Rows that answer the same question, held against one reference, which says how far it can be trusted itself."""

    stage: str
    quantity: str
    reference: str
    rows: tuple[Setting, ...]


@dataclass(frozen=True)
class Choice:
    """What the scene's accuracy chose in a stage, with the estimate it goes by and the error it turned out to have."""

    method: str
    setting: str
    error_estimate: float | None
    error: float | None


@dataclass(frozen=True, eq=False, repr=False)
class WorkPrecision(StudyResult):
    """All studies of a scene; `left_out`: why it has none of some stages."""

    REPORT = "workflows.studies.work_precision.report"
    title: str
    targets: dict[str, float]
    studies: tuple[ConvergenceStudy, ...]
    chosen: dict[str, Choice]
    left_out: str | None = None


def measure(
    method: str, setting: str, work: Callable[[], T], judge: Callable[[T], tuple[int | None, float]], share: float = 1.0
) -> tuple[Setting, T | None]:
    """Time some work and judge what it returns, as (unknowns, error); what fails is a row that says why.

    share: how much more the whole would take than the part of it that is timed.
    """
    value: T | None = None
    try:
        run = timed(work)
        value = run.value
        unknowns, error = judge(run.value)
    except (ArithmeticError, ValueError, RuntimeError) as reason:
        return Setting(method, setting, failed=str(reason) or type(reason).__name__), value
    row = Setting(method, setting, unknowns, share * run.median, (share * run.low, share * run.high))
    known = {"error": error} if math.isfinite(error) else {"failed": "no number was obtained"}
    return replace(row, **known), value


def ladder(step: Step, cases: Iterable[tuple[Any, ...]]) -> tuple[Setting, ...]:
    """A row for each case, which has the arguments of `measure`."""
    rows = []
    for case in cases:
        step.advance(", ".join(case[:2]))
        rows.append(measure(*case)[0])
    return tuple(rows)


def entry(row: Any) -> dict[str, Any]:
    """A row as plain data; it says why it failed only if it did."""
    return {name: value for name, value in asdict(row).items() if (name, value) != ("failed", None)}


def machine() -> dict[str, Any]:
    """On what the times were taken."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.partition(":")[2].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
