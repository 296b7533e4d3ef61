"""The headline numbers of a point: one row, and what each of its columns is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.findings import worth
from workflows.findings.worth import Grade
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


QUANTITIES = (
    Quantity("damping_ratio_peak", "1", "largest damping ratio that the ball alone amounts to"),
    Quantity("at_amplitude", "m", "amplitude at the cavity where that is"),
    Quantity("range_low", "m", "amplitude from which on the damper works"),
    Quantity("range_high", "m", "amplitude at which half of the peak is left"),
    Quantity("half_low", "m", "amplitude from which on at least half of the peak is there"),
    Quantity("cutoff", "m", "amplitude up to which the ball stays at rest"),
    Quantity("error", "1", "of the peak, relative, estimated"),
    Quantity("grade", "1", "beside what the air gives: 0 no, 1 hardly, 2 modestly, 3 yes", "i1"),
    Quantity("best_damping_ratio", "1", "largest damping ratio within what the plate endures"),
    Quantity("best_amplitude", "m", "amplitude where that is"),
    Quantity(
        "cutoff_ratio", "1", "of the ring-down: amplitude of the last cycle in which the ball moved over the load"
    ),
    Quantity("peak_sdc", "1", "of the ring-down: largest share of the energy lost in a cycle, the structure's with it"),
    Quantity("impacts", "1", "of the ring-down: hits of the walls", "i8"),
    Quantity("events", "1", "of the ring-down: events of any kind", "i8"),
    Quantity("load_g", "g", "centrifugal load"),
    Quantity("frequency", "Hz", "with the ball stuck"),
    Quantity("effective_mass", "kg", "of the structure at the damper, without the ball"),
    Quantity("ball_mass", "kg", "of all balls together"),
    Quantity("tilt_share", "1", "share of the ball's drive that the tilt of the floor takes"),
)
"""Columns in the order of files."""

_REASON = ("reason", "i4")

ROW = np.dtype([(quantity.name, quantity.kind) for quantity in QUANTITIES] + [_REASON])
"""A row; `reason` is the number of the text that says why there is no answer, -1 where there is one."""

NUMBERS = tuple(quantity.name for quantity in QUANTITIES)
UNGRADED = -1


def empty(count: int) -> Rows:
    """Rows without an answer."""
    rows = np.zeros(count, ROW)
    for quantity in QUANTITIES:
        rows[quantity.name] = np.nan if quantity.kind.startswith("f") else UNGRADED
    rows["reason"] = -1
    return rows


def of_the_structure(row: Any, point: SpeedPoint, ball_mass: float) -> None:
    """Fill in what carries the damper."""
    row["load_g"], row["ball_mass"], row["tilt_share"] = point.load_g, ball_mass, point.tilt_share
    if point.reduced is not None:
        row["frequency"], row["effective_mass"] = point.reduced.f1_hz, point.reduced.M2


def of_the_damper(row: Any, results: Results, point: SpeedPoint) -> None:
    """Fill in the damper's own figures."""
    figures, best = point.working, worth.best(results, point)
    row["grade"] = int(worth.grade(results, point))
    row["best_damping_ratio"] = 0.0
    if figures is None:
        row["damping_ratio_peak"] = 0.0
        return
    row["damping_ratio_peak"], row["at_amplitude"] = figures.peak, figures.peak_amplitude
    row["range_low"], row["range_high"] = figures.range
    row["half_low"], row["cutoff"], row["error"] = figures.half[0], figures.cutoff, figures.error
    if best is not None:
        row["best_damping_ratio"], row["best_amplitude"] = best.damping_ratio, best.amplitude


def of_the_ring_downs(rows: Rows, batch: Batch, gravity: npt.NDArray[np.float64]) -> None:
    """Fill in what ring-downs from the scenes' releases left."""
    rows["peak_sdc"], rows["impacts"], rows["events"] = batch.peak_sdc, batch.impacts, batch.events
    load = rows["load_g"]
    with np.errstate(divide="ignore", invalid="ignore"):
        rows["cutoff_ratio"] = np.where(load > 0, batch.cutoff / gravity / load, np.nan)


def grades() -> str:
    """The words behind the grades."""
    return ", ".join(f"{grade.value} {grade.name.lower()}" for grade in Grade)
