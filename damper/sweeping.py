"""Ring-downs that are led down through the amplitudes, cycle by cycle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from damper import engine_linear
from damper.compiled import kernel
from damper.detect import schedule
from damper.engine import DONE, release, run
from damper.flight import begin
from damper.records import STUCK
from damper.trace import stored

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records


@kernel
def run_by_cycles(
    block: tuple[int, int],
    clocks: Records,
    axes: Records,
    laws: Records,
    balls: Records,
    books: Records,
    cycles: Records,
    tables: tuple[Floats, Records],
    budget: int,
    factor: float,
    least: float,
    energies: Floats,
) -> None:
    """Run ring-downs cycle by cycle, and write the energy of structure and ball before and after each.

    Where more energy is left after n cycles than `factor**n` of the first, the structure's motion is made smaller by so
    much; the ball's in its cavity stays as it is. A row of `energies`, shape (n, cycles, 2) [J], stays as it is from
    where the energy falls below `least` or the budget of events is spent.
    """
    peaks, rows = tables
    for k in range(block[0], block[1]):
        after = 0.0
        for n in range(energies.shape[1]):
            clocks[k].end = (n + 1) * cycles[k].period
            if n == 0:
                release(clocks[k], axes[k], laws[k], balls[k], rows)
            else:
                allowed = energies[k, 0, 0] * factor**n
                smaller = math.sqrt(allowed / after) if after > allowed else 1.0
                for i in range(2):
                    axes[k, i].u *= smaller
                    axes[k, i].v *= smaller
                    begin(axes[k, i], laws[k, i], balls[k], clocks[k].time)
                    schedule(axes[k, i], laws[k, i], balls[k], clocks[k].end)
            before = _energy(axes[k], laws[k], balls[k])
            left = budget - clocks[k].events
            if run(clocks[k], axes[k], laws[k], balls[k], books[k], cycles[k], peaks, rows, left) != DONE:
                break
            after = _energy(axes[k], laws[k], balls[k])
            energies[k, n, 0], energies[k, n, 1] = before, after
            if after < least:
                break


@kernel
def _energy(axes: Records, laws: Records, ball: Record) -> float:
    """Energy of structure and ball [J]."""
    twice = 0.0
    for i in range(2):
        axis, speed = axes[i], axes[i].v + axes[i].w
        twice += laws[i, STUCK].stiffness * axis.u * axis.u + ball.host_mass * axis.v * axis.v
        twice += ball.mass * speed * speed + ball.spin_mass * axis.spin * axis.spin
    return 0.5 * twice


@kernel
def run_linear_by_cycles(
    block: tuple[int, int],
    clocks: Records,
    systems: Records,
    motions: Records,
    axes: Records,
    balls: Records,
    books: Records,
    cycles: Records,
    tables: tuple[Floats, Records, Floats],
    budget: int,
    factor: float,
    least: float,
    energies: Floats,
) -> None:
    """The same as `run_by_cycles` in linear flights."""
    peaks, rows, states = tables
    for k in range(block[0], block[1]):
        after, system, motion = 0.0, systems[k], motions[k]
        for n in range(energies.shape[1]):
            clocks[k].end = (n + 1) * cycles[k].period
            if n == 0:
                engine_linear.release(clocks[k], system, motion, axes[k], balls[k], rows, states)
            else:
                allowed = energies[k, 0, 0] * factor**n
                _shrink(math.sqrt(allowed / after) if after > allowed else 1.0, system, motion)
                for g in range(system.groups):
                    engine_linear.restart(g, clocks[k].time, system, motion, axes[k], balls[k])
            before = stored(system, motion, axes[k], balls[k])
            left = budget - clocks[k].events
            where = clocks[k], system, motion, axes[k], balls[k], books[k], cycles[k]
            if engine_linear.run(*where, peaks, rows, states, left) != DONE:
                break
            after = stored(system, motion, axes[k], balls[k])
            energies[k, n, 0], energies[k, n, 1] = before, after
            if after < least:
                break


@kernel
def _shrink(smaller: float, system: Record, motion: Record) -> None:
    """Make the structure's motion smaller."""
    for m in range(system.coordinates):
        if m != system.place[0] and m != system.place[1]:
            motion.z[m] *= smaller
            motion.rate[m] *= smaller
