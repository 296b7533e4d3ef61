"""Work and precision: rows of time against error, and what the scene's accuracy chose among them."""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, TypeVar

from workflows.studies.costs.timing import POLICY, Timed, timed

T = TypeVar("T")


@dataclass(frozen=True)
class Rung:
    """One setting of one method.

    Attributes:
        unknowns: size of what is solved, or steps taken; None where there is no such number.
        time_s: median seconds; spread_s: least and most. None where it failed.
        error: relative, against the ladder's reference; uncertainty: how far that can be trusted, None if unknown.
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
class Ladder:
    """Rows that answer the same question, held against one reference, which says how far it can be trusted itself."""

    stage: str
    quantity: str
    reference: str
    rows: tuple[Rung, ...]


@dataclass(frozen=True)
class Picked:
    """What the scene's accuracy chose in a stage, with the estimate it goes by and the error it turned out to have."""

    method: str
    setting: str
    error_estimate: float | None
    error: float | None


@dataclass(frozen=True, eq=False)
class Costs:
    """All ladders of a scene."""

    title: str
    asked: dict[str, float]
    ladders: tuple[Ladder, ...]
    chosen: dict[str, Picked]

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        return {
            "schema_version": 1,
            "title": self.title,
            "asked": self.asked,
            "machine": machine(),
            "noise": POLICY,
            "ladders": [asdict(ladder) | {"rows": [_row(row) for row in ladder.rows]} for ladder in self.ladders],
            "chosen": {stage: asdict(chosen) for stage, chosen in self.chosen.items()},
        }


def machine() -> dict[str, Any]:
    """On what the times were taken."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
    }


def measure(
    method: str,
    setting: str,
    work: Callable[[], T],
    judge: Callable[[T], tuple[int | None, float]],
    share: float = 1.0,
) -> Rung:
    """Time some work and judge what it returns, as (unknowns, error); what fails is a row that says why.

    share: how much more the whole would take than the part of it that is timed.
    """
    try:
        found: Timed[T] = timed(work)
        unknowns, error = judge(found.value)
    except (ArithmeticError, ValueError, RuntimeError) as reason:
        return Rung(method, setting, failed=str(reason) or type(reason).__name__)
    times = share * found.median, (share * found.low, share * found.high)
    if not math.isfinite(error):
        return Rung(method, setting, unknowns, *times, failed="no number came out")
    return Rung(method, setting, unknowns, *times, error=error)


def _row(row: Rung) -> dict[str, Any]:
    entry = asdict(row)
    if row.failed is None:
        del entry["failed"]
    return entry


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()
