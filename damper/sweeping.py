"""Ring-downs that are led down through the amplitudes, cycle by cycle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from damper import engine, engine_linear
from damper.compiled import kernel
from damper.detect import schedule
from damper.ending import DONE
from damper.flight import begin
from damper.records import STUCK
from damper.trace import stored

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records
    from damper.tables import Tables


class Descent(NamedTuple):
    """How ring-downs are led down, and what they show.

    Where more energy is left after n cycles than `factor**n` of the first, the structure's motion is made smaller by so
    much; the ball's in its cavity stays as it is. `energies`, shape (n, cycles, 2) [J], are those of structure and ball
    before and after each cycle; a row stays as it is from where the energy falls below `least` or the budget of events
    is spent.
    """

    budget: int
    factor: float
    least: float
    energies: Floats


@kernel
def run_level(block: tuple[int, int], runs: Records, tables: Tables, descent: Descent) -> None:
    """Lead down ring-downs in closed form."""
    for k in range(block[0], block[1]):
        it, energies, after = runs[k], descent.energies[k], 0.0
        for n in range(len(energies)):
            it.clock.end = (n + 1) * it.cycle.period
            if n == 0:
                engine.release(it, tables)
            else:
                _shrink_level(_smaller(n, after, energies, descent), it)
            before = _stored_level(it)
            if engine.run(it, tables, descent.budget - it.clock.events) != DONE:
                break
            after = _stored_level(it)
            energies[n, 0], energies[n, 1] = before, after
            if after < descent.least:
                break


@kernel
def run_linear(block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, descent: Descent) -> None:
    """Lead down ring-downs in linear flights."""
    for k in range(block[0], block[1]):
        it, flow, energies, after = runs[k], flows[runs[k].system.flow], descent.energies[k], 0.0
        for n in range(len(energies)):
            it.clock.end = (n + 1) * it.cycle.period
            if n == 0:
                engine_linear.release(it, flow, tables)
            else:
                _shrink_linear(_smaller(n, after, energies, descent), it, flow)
            before = stored(it)
            if engine_linear.run(it, flow, tables, descent.budget - it.clock.events) != DONE:
                break
            after = stored(it)
            energies[n, 0], energies[n, 1] = before, after
            if after < descent.least:
                break


@kernel
def _smaller(n: int, after: float, energies: Floats, descent: Descent) -> float:
    """By what the structure's motion is made smaller before cycle n."""
    allowed = energies[0, 0] * descent.factor**n
    return math.sqrt(allowed / after) if after > allowed else 1.0


@kernel
def _shrink_level(smaller: float, it: Record) -> None:
    """Make the structure's motion smaller."""
    for i in range(2):
        it.axes[i].u *= smaller
        it.axes[i].v *= smaller
        begin(it.axes[i], it.laws[i], it.ball, it.clock.time)
        schedule(it.axes[i], it.laws[i], it.ball, it.clock.end)


@kernel
def _shrink_linear(smaller: float, it: Record, flow: Floats) -> None:
    """The same in linear flights."""
    for m in range(it.system.coordinates):
        if m != it.system.place[0] and m != it.system.place[1]:
            it.motion.z[m] *= smaller
            it.motion.rate[m] *= smaller
    for g in range(it.system.groups):
        engine_linear.restart(g, it.clock.time, it, flow)


@kernel
def _stored_level(it: Record) -> float:
    """Energy of structure and ball [J]."""
    ball, twice = it.ball, 0.0
    for i in range(2):
        axis, speed = it.axes[i], it.axes[i].v + it.axes[i].w
        twice += it.laws[i, STUCK].stiffness * axis.u * axis.u + ball.host_mass * axis.v * axis.v
        twice += ball.mass * speed * speed + ball.spin_mass * axis.spin * axis.spin
    return 0.5 * twice
