"""When a run is over: at rest for good, or where nothing more will happen that counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel
from damper.keeping import write_peak
from damper.peaks import close

if TYPE_CHECKING:
    from damper.arrays import Record
    from damper.tables import Tables

DONE, PAUSED, FULL = 0, 1, 2
"""Why the loop returns: the end is reached, the budget of events is spent, or a table is full."""

DIED_OUT = 1e-6
"""Share of its first velocity maximum at which a vibration is over, whatever the ball does."""

NEAR = 1.01
"""Acceleration over the rolling threshold at which a ball that rolls next to nothing is taken to tremble there."""

TREMOR = 1e-7
"""Share of the energy that a ball must roll away in a cycle to count as moving, where it hits nothing."""


@kernel
def end_cycle(it: Record, tables: Tables, drive: float) -> bool:
    """Keep the velocity maximum just found, see whether motion fades, open the next cycle; False without room."""
    if not write_peak(it, tables):
        return False
    _fade(it, drive)
    close(it.cycle, it.clock.last_motion)
    return True


@kernel
def _fade(it: Record, drive: float) -> None:
    """At a velocity maximum, end a run soon in which nothing more will happen that counts.

    Either the ball, a cycle long, hit no wall and rolled away next to nothing, on a structure whose largest drive is at
    the threshold: without damping of its own it nears the threshold for ever. Or the vibration has died out.
    """
    clock, ball, speed = it.clock, it.ball, it.cycle.speed
    energy = 0.5 * ball.host_mass * speed * speed
    still = clock.impacts == clock.last_impacts and it.books.rolling - clock.last_rolling <= TREMOR * energy
    if clock.peaks == 1:
        clock.first_speed = speed
    clock.last_impacts, clock.last_rolling = clock.impacts, it.books.rolling
    if clock.rest < np.inf or clock.tail == np.inf:
        return
    if speed <= DIED_OUT * clock.first_speed:
        clock.trembles = 2
        settle_down(clock)
    elif still and ball.threshold > 0.0 and drive <= NEAR * ball.threshold:
        clock.trembles = 1
        settle_down(clock)


@kernel
def settle_down(clock: Record) -> None:
    """End the run a little after the last event."""
    clock.rest = clock.time
    clock.end = min(clock.end, clock.time + clock.tail)
