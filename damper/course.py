"""One ring-down on its way: in closed form on a level floor under one mode an axis, else in linear flights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from damper.motion import LEVEL, flights, kinds, watch_harmonic
from damper.parameters import energy

if TYPE_CHECKING:
    from damper.arrays import Floats, Records
    from damper.model import ParticleDamper
    from damper.modes import Harmonic
    from damper.prepare import Prepared


class Course(Protocol):
    """What `ringdown` asks of either engine."""

    initial: float

    def states(self, size: int) -> Floats:
        """A table of states for as many events."""

    def release(self, rows: Records, states: Floats) -> None:
        """Let go."""

    def run(self, peaks: Floats, rows: Records, states: Floats, budget: int) -> bool:
        """Go on, until the end (True), a full table or the end of the budget."""

    def energy(self) -> float:
        """Of structure and ball, now [J]."""

    def modal_energies(self) -> Floats | None:
        """Of each of the damper's modes, now [J]; None without modes."""


def course_of(
    damper: ParticleDamper,
    one: Prepared,
    harmonic: Harmonic | None = None,
    amplitudes: tuple[float, ...] | None = None,
) -> Course:
    """The course of the one ring-down that is prepared."""
    if kinds(damper, damper.parameters, harmonic)[0] == LEVEL:
        return _Closed(damper, one)
    return _Linear(damper, one, harmonic, amplitudes)


class _Closed:
    def __init__(self, damper: ParticleDamper, one: Prepared) -> None:
        self.rows, self.one, self.initial = damper.parameters, one, float(one.initial[0])

    def states(self, size: int) -> Floats:
        return np.zeros((0, 2, 0))

    def release(self, rows: Records, states: Floats) -> None:
        from damper import engine

        one = self.one
        engine.release(one.clocks[0], one.axes[0], one.laws[0], one.balls[0], rows)

    def run(self, peaks: Floats, rows: Records, states: Floats, budget: int) -> bool:
        from damper import engine

        one = self.one
        where = one.clocks[0], one.axes[0], one.laws[0], one.balls[0], one.books[0], one.cycles[0]
        return engine.run(*where, peaks, rows, budget) == engine.DONE

    def energy(self) -> float:
        return float(energy(self.rows, self.one.axes)[0])

    def modal_energies(self) -> Floats | None:
        return None


class _Linear:
    def __init__(
        self,
        damper: ParticleDamper,
        one: Prepared,
        harmonic: Harmonic | None,
        amplitudes: tuple[float, ...] | None,
    ) -> None:
        self.damper, self.rows, self.one = damper, damper.parameters, one
        self.flights = flights(damper, self.rows, one.axes, harmonic, amplitudes)
        self.system, self.motion = self.flights.systems[0], self.flights.motions[0]
        self.initial = self.energy()
        if harmonic is not None:
            watch_harmonic(one.cycles, harmonic)

    def states(self, size: int) -> Floats:
        return np.zeros((size, 2, len(self.motion["z"])))

    def release(self, rows: Records, states: Floats) -> None:
        from damper import engine_linear

        one = self.one
        engine_linear.release(one.clocks[0], self.system, self.motion, one.axes[0], one.balls[0], rows, states)

    def run(self, peaks: Floats, rows: Records, states: Floats, budget: int) -> bool:
        from damper import engine_linear
        from damper.engine import DONE

        one = self.one
        where = one.clocks[0], self.system, self.motion, one.axes[0], one.balls[0], one.books[0], one.cycles[0]
        return engine_linear.run(*where, peaks, rows, states, budget) == DONE

    def energy(self) -> float:
        return float(self.flights.energy(self.rows, self.one.axes)[0])

    def modal_energies(self) -> Floats | None:
        return None if self.damper.modes is None else self.flights.modal_energies(self.damper, self.rows)[0]
