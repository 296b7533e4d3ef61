"""What a run puts into its tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel

if TYPE_CHECKING:
    from damper.arrays import Record
    from damper.tables import Tables


@kernel
def full(it: Record, tables: Tables) -> bool:
    """Whether there is no more room for the rows of an event."""
    return bool(len(tables.rows) > 0 and it.clock.rows + 2 > len(tables.rows))


@kernel
def write_peak(it: Record, tables: Tables) -> bool:
    """Count a velocity maximum, and write it if asked; False if the table is full."""
    clock = it.clock
    if len(tables.peaks) > 0:
        if clock.peaks == len(tables.peaks):
            return False
        tables.peaks[clock.peaks, 0], tables.peaks[clock.peaks, 1] = it.cycle.time, it.cycle.speed
    clock.peaks += 1
    clock.watched = it.cycle.closes
    return True


@kernel
def write_event(i: int, kind: int, before: float, it: Record, tables: Tables) -> None:
    """Write an event of an axis, if asked; `before` it had this relative velocity."""
    if len(tables.rows) == 0:
        return
    row, axis = tables.rows[it.clock.rows], it.axes[i]
    row.time, row.axis, row.kind = it.clock.time, i, kind
    row.u, row.v, row.s, row.w = axis.u, axis.v, axis.s, axis.w
    row.spin, row.regime, row.direction, row.w_before = axis.spin, axis.regime, axis.direction, before
    it.clock.rows += 1
