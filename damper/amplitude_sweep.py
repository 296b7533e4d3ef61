"""Kernels of sweeps through the amplitudes: ring-downs led down, or up, cycle by cycle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from damper import engine
from damper.compiled import kernel, part
from damper.engine import DONE
from damper.steady_motion import lost, stored

if TYPE_CHECKING:
    from damper.model import Floats, Record, Records
    from damper.state import Tables


class Ramp(NamedTuple):
    """How ring-downs are led through the amplitudes, and what they show.

    After n cycles the structure is given `factor**n` of the energy that it began with, whatever the ball took; the
    ball's motion in its cavity stays as it is. `energies`, shape (n, cycles, 4) [J], are that of the structure, the
    ball counted as stuck, before each cycle, and what the losses in it leave of that; that of structure and ball before
    it, and those losses by the books. A row stays as it is from where it falls below `least` or the budget of events is
    spent.
    """

    budget: int
    factor: float
    least: float
    energies: Floats


@kernel
def run_ramps(block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, ramp: Ramp) -> None:
    """Lead ring-downs."""
    for k in range(block[0], block[1]):
        it, flow, energies = runs[k], flows[runs[k].system.flow], ramp.energies[k]
        it.cycle.opens = it.cycle.closes = np.inf  # its amplitudes are known: no velocity maxima are sought
        for n in range(len(energies)):
            it.clock.end = (n + 1) * it.cycle.period
            if n == 0:
                engine.release(it, flow, tables)
            else:
                _scale(math.sqrt(energies[0, 0] * ramp.factor**n / _of_the_structure(it)), it, flow)
            _open(it.books)
            before, swing = stored(it), _of_the_structure(it)
            if swing < ramp.least or engine.run(it, flow, tables, ramp.budget - it.clock.events) != DONE:
                break
            energies[n, 0], energies[n, 1] = swing, swing - (before - stored(it))
            energies[n, 2], energies[n, 3] = before, lost(it.books)


@part
def _open(books: Record) -> None:
    """Begin the books anew: what is lost at small amplitudes would drown in what was lost at large ones."""
    books.structure = books.rolling = books.impact = books.slip = 0.0


@part
def _scale(scale: float, it: Record, flow: Floats) -> None:
    """Change the structure's motion, and leave the ball's in its cavity."""
    for m in range(it.system.coordinates):
        if m != it.system.place[0] and m != it.system.place[1]:
            it.motion.z[m] *= scale
            it.motion.rate[m] *= scale
    for g in range(it.system.groups):
        if it.motion.next[g] < np.inf:  # nothing moves else
            engine.restart(g, it.clock.time, it, flow)


@part
def _of_the_structure(it: Record) -> float:
    """Energy of the structure, the ball counted as stuck to it [J]."""
    system, motion, twice = it.system, it.motion, 0.0
    for m in range(system.coordinates):
        for n in range(system.coordinates):
            if m != system.place[0] and m != system.place[1] and n != system.place[0] and n != system.place[1]:
                twice += motion.rate[m] * system.mass[m, n] * motion.rate[n]
                twice += motion.z[m] * system.spring[m, n] * motion.z[n]
    return 0.5 * twice
