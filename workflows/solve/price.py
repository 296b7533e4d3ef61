"""What a part of a run takes on finer meshes, by what it took on coarse ones.

Factors grow as their products, solutions as the entries of the factor (`workflows.solve.fill`), all else as the
unknowns, apart from what no mesh changes, as the modes of projected matrices. How many factors and solutions there are
hardly depends on the mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

from workflows.solve.fill import Fill

T = TypeVar("T")

_APART = 1.5
"""Ratio of unknowns from which on two meshes tell what does not grow."""


@dataclass(frozen=True)
class Part:
    """Seconds that a part of a run took on its meshes; among them for factors, solutions, and projected matrices."""

    on: Fill
    seconds: float
    factoring: float
    solving: float
    projecting: float = 0.0

    @property
    def rest(self) -> float:
        """Seconds for all else."""
        return max(self.seconds - self.factoring - self.solving - self.projecting, 0.0)


def timed(work: Callable[[], T]) -> tuple[T, Callable[[Fill], Part]]:
    """The result of some work, and what it took as a part of a run, once it is known what it was done on."""
    from fem.linalg.spent import spent

    with spent() as book:
        began = perf_counter()
        found = work()
        seconds = perf_counter() - began
    return found, lambda on: Part(on, seconds, book.factoring, book.solving, book.projecting)


def grown(parts: Sequence[Part], on: Fill) -> float:
    """Seconds of a part of a run on other meshes; `parts`: the same on coarse ones, ascending."""
    last = parts[-1]
    factoring = last.factoring * on.work / last.on.work
    solving = last.solving * on.entries / last.on.entries
    always, each = _line(parts)
    return factoring + solving + last.projecting + always + each * on.unknowns


def _line(parts: Sequence[Part]) -> tuple[float, float]:
    """Seconds of all else: those that are always there, and those for each unknown; neither is negative."""
    first, last = parts[0], parts[-1]
    if last.on.unknowns < _APART * first.on.unknowns:
        return 0.0, last.rest / last.on.unknowns
    each = (last.rest - first.rest) / (last.on.unknowns - first.on.unknowns)
    each = min(max(each, 0.0), last.rest / last.on.unknowns)
    return last.rest - each * last.on.unknowns, each
