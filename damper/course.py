"""One ring-down on its way: in closed form on a level floor under one mode an axis, else in linear flights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from damper.motion import APART, COUPLED, LEVEL, flights, kinds
from damper.parameters import energy

if TYPE_CHECKING:
    from damper.arrays import Floats, Record, Records
    from damper.model import ParticleDamper
    from damper.modes import Harmonic
    from damper.motion import Flights
    from damper.prepare import Prepared
    from damper.tables import Tables


class Course(Protocol):
    """What `ringdown` asks of either engine."""

    runs: Records
    run: Record
    initial: float
    kind: int

    def states(self, size: int) -> Floats:
        """A table of states for as many events."""

    def release(self, tables: Tables) -> None:
        """Let go."""

    def go_on(self, tables: Tables, budget: int) -> bool:
        """Until the end (True), a full table or the end of the budget."""

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
    return _Linear(damper, flights(damper, damper.parameters, one, harmonic, amplitudes))


class _Closed:
    def __init__(self, damper: ParticleDamper, one: Prepared) -> None:
        self.rows, self.one = damper.parameters, one
        self.runs, self.run, self.initial, self.kind = one.runs, one.runs[0], float(one.initial[0]), LEVEL

    def states(self, size: int) -> Floats:
        return np.zeros((0, 2, 0))

    def release(self, tables: Tables) -> None:
        from damper import engine

        engine.release(self.run, tables)

    def go_on(self, tables: Tables, budget: int) -> bool:
        from damper import engine
        from damper.ending import DONE

        return engine.run(self.run, tables, budget) == DONE

    def energy(self) -> float:
        return float(energy(self.rows, self.one.axes)[0])

    def modal_energies(self) -> Floats | None:
        return None


class _Linear:
    def __init__(self, damper: ParticleDamper, flights: Flights) -> None:
        self.damper, self.rows, self.flights = damper, damper.parameters, flights
        self.runs, self.run, self.flow = flights.runs, flights.runs[0], flights.systems.flows[0]
        self.initial, self.kind = self.energy(), (COUPLED, APART)[int(self.run["system"]["groups"]) - 1]

    def states(self, size: int) -> Floats:
        return np.zeros((size, 2, len(self.run["motion"]["z"])))

    def release(self, tables: Tables) -> None:
        from damper import engine_linear

        engine_linear.release(self.run, self.flow, tables)

    def go_on(self, tables: Tables, budget: int) -> bool:
        from damper import engine_linear
        from damper.ending import DONE

        return engine_linear.run(self.run, self.flow, tables, budget) == DONE

    def energy(self) -> float:
        return float(self.flights.energy(self.rows)[0])

    def modal_energies(self) -> Floats | None:
        return None if self.damper.modes is None else self.flights.modal_energies(self.damper, self.rows)[0]
