"""States between events, from the flights that the event table holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from damper.compiled import kernel
from damper.flight import begin, increments, relative
from damper.records import ROLLING, SLIPPING, STUCK
from damper.slip import spin_after

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records


@kernel
def evaluate(flights: Records, laws: Records, ball: Record, times: Floats, out: Floats) -> None:
    """Fill `out`, shape (5, n), with u, v, s, w and spin of n flights at n times."""
    for k in range(len(times)):
        axis = flights[k]
        begin(axis, laws, ball, axis.start)
        tau = times[k] - axis.start
        law = laws[axis.regime]
        du, dv, _ = increments(axis, law, tau)
        out[0, k], out[1, k] = axis.u + axis.v * tau + du, axis.v + dv
        out[2, k], out[3, k], out[4, k] = axis.s, 0.0, 0.0
        if axis.regime != STUCK:
            out[2, k], out[3, k], _, _ = relative(axis, law, tau)
        if axis.regime == ROLLING:
            out[4, k] = out[3, k]
        elif axis.regime == SLIPPING or axis.spin != 0.0:
            out[4, k] = spin_after(axis, ball, tau)
