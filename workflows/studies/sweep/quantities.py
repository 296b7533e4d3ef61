"""The headline numbers of a point: one row, and what each of its columns is; and a block of rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.findings import worth
from workflows.findings.worth import Grade
from workflows.results.columns import headlines
from workflows.solve.records import Results, SpeedPoint

if TYPE_CHECKING:
    import numpy.typing as npt

    from damper import Batch

    Rows = npt.NDArray[np.void]


@dataclass(frozen=True)
class Quantity:
    """A column: its name, unit (1: none) and meaning; `kind` is its type in files."""

    name: str
    unit: str
    meaning: str
    kind: str = "f8"


_OF_A_RUN = tuple(headlines(SpeedPoint))
"""Columns that a run's data set has too, by the same names."""

QUANTITIES = (
    *(Quantity(each.name, each.unit, each.meaning, "i8" if each.kind is int else "f8") for each in _OF_A_RUN),
    Quantity("grade", "1", "beside what the air gives: 0 no, 1 hardly, 2 modestly, 3 yes; -1 no verdict", "i1"),
    Quantity("best_damping_ratio", "1", "largest damping ratio within what the plate endures; none without a verdict"),
    Quantity("best_amplitude", "m", "amplitude where that is"),
    Quantity("ball_mass", "kg", "of all balls together"),
)
"""Columns in the order of files."""

HEADLINE = "best_damping_ratio"
"""What the best point has most of: the damping ratio within what the plate endures."""

_REASON = ("reason", "i4")

ROW = np.dtype([(quantity.name, quantity.kind) for quantity in QUANTITIES] + [_REASON])
"""A row; `reason` is the number of the text that says why there is no answer, -1 where there is one."""

NUMBERS = tuple(quantity.name for quantity in QUANTITIES)
UNGRADED = int(Grade.UNKNOWN)


@dataclass(frozen=True, eq=False)
class Block:
    """Rows of the points from `begin` on, and the texts that their reasons count."""

    begin: int
    rows: Rows
    reasons: tuple[str, ...]


class Reasons:
    """Texts by number, each once."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def number(self, text: str) -> int:
        """Which one it is."""
        if text not in self.texts:
            self.texts.append(text)
        return self.texts.index(text)


def empty(count: int) -> Rows:
    """Rows without an answer."""
    rows = np.zeros(count, ROW)
    for quantity in QUANTITIES:
        rows[quantity.name] = np.nan if quantity.kind.startswith("f") else UNGRADED
    rows["reason"] = -1
    return rows


def of_the_structure(row: Any, point: SpeedPoint, ball_mass: float) -> None:
    """Fill in what carries the damper."""
    _fill(row, point)
    row["ball_mass"] = ball_mass


def of_the_damper(row: Any, results: Results, point: SpeedPoint) -> None:
    """Fill in the damper's own figures."""
    _fill(row, point)
    best, grade = worth.best(results, point), worth.grade(results, point)
    row["grade"] = int(grade)
    if grade is Grade.UNKNOWN:
        return
    row["best_damping_ratio"] = 0.0
    if best is not None:
        row["best_damping_ratio"], row["best_amplitude"] = best.damping_ratio, best.amplitude


def _fill(row: Any, point: SpeedPoint) -> None:
    for quantity in _OF_A_RUN:
        if (value := quantity.of(point)) is not None:
            row[quantity.name] = value


def of_the_ring_downs(rows: Rows, batch: Batch, gravity: npt.NDArray[np.float64]) -> None:
    """Fill in what ring-downs from the scenes' releases left."""
    rows["peak_sdc"], rows["impacts"], rows["events"] = batch.peak_sdc, batch.impacts, batch.events
    load = rows["load_g"]
    with np.errstate(divide="ignore", invalid="ignore"):
        rows["cutoff_ratio"] = np.where(load > 0, batch.cutoff / gravity / load, np.nan)


def grades() -> str:
    """The words behind the grades."""
    return ", ".join(f"{grade.value} {grade.name.lower()}" for grade in Grade)
