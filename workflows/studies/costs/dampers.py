"""Ladder of the damper: fixed steps, `solve_ivp`, and the exact events, by what the ball takes in one ring-down."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

from workflows.progress import Step
from workflows.solve.records import SpeedPoint
from workflows.studies.costs.by_ivp import ByIvp, Integrator, by_ivp
from workflows.studies.costs.ladder import Ladder, Picked, Rung, measure
from workflows.wording import significant, whole

if TYPE_CHECKING:
    from damper import ParticleDamper, RingDown, SteppedRingDown

CYCLES = 20
STEPS = (20, 40, 80, 160, 320, 640, 1280, 2560, 5120, 10240)
METHODS: dict[Integrator, tuple[float, ...]] = {
    "RK45": (1e-3, 1e-5, 1e-7, 1e-9),
    "DOP853": (1e-3, 1e-6, 1e-9, 1e-12),
    "LSODA": (1e-3, 1e-6, 1e-9),
    "Radau": (1e-3, 1e-6),
}
"""Integrators of `solve_ivp` with their relative tolerances."""

_REFERENCE: tuple[Integrator, float] = ("DOP853", 1e-13)

_ROUNDING = 1e-12
"""Share of the initial energy that rounding may misplace in the exact events' books."""

_NOTHING = 1e-9
"""Share of the initial energy below which what the ball takes drowns in rounding."""


class _Balance(Protocol):
    """Energies [J] at the start and at the end, and what the structure's own dashpot took."""

    @property
    def initial(self) -> float: ...
    @property
    def final(self) -> float: ...
    @property
    def structure(self) -> float: ...


def level(system: ParticleDamper) -> ParticleDamper:
    """The damper on a level floor with one mode along each axis, which is what the other methods know."""
    return replace(system, floor_tilt=(0.0, 0.0), floor_radius=None, rotation=0.0, modes=None)


def ladder(
    system: ParticleDamper, release: tuple[float, float], point: SpeedPoint, step: Step
) -> tuple[Ladder | None, Picked]:
    """Error of the energy that the ball takes in 20 cycles, and of the exact events against the tightest integration.

    What the structure's own damping takes is left out: it hides the ball's share, and every method has it right. There
    is no ladder where the ball takes nothing.
    """
    from damper import ringdown

    step.advance("reference")
    exact = ringdown(system, release, CYCLES).energy
    taken = _taken(exact)
    if abs(taken) < _NOTHING * exact.initial:
        return None, Picked("exact events", f"the ball takes nothing in {CYCLES} cycles", None, None)
    contest = _Contest(system, release, taken, _apart(system, release, taken))
    rows = (*contest.steps(step), *contest.integrators(step), contest.events(step))
    found = Ladder(
        "damper",
        f"relative error of the energy that the ball takes in {CYCLES} cycles at {whole(point.rpm)} rpm",
        f"the exact events, {_between(contest.apart)}",
        tuple(replace(row, uncertainty=contest.apart) for row in rows),
    )
    rounding = _ROUNDING * exact.initial / abs(taken)
    return found, Picked("exact events", "closed form between events, roots to rounding", rounding, contest.apart)


def _apart(system: ParticleDamper, release: tuple[float, float], taken: float) -> float | None:
    """How far the tightest integration is from what the exact events say is taken; None where it has no answer."""
    try:
        return abs(_taken(by_ivp(system, release, CYCLES, *_REFERENCE)) / taken - 1.0)
    except (ArithmeticError, ValueError):
        return None


def _between(apart: float | None) -> str:
    if apart is None:
        return "which no independent integration could confirm here"
    return (
        f"from which solve_ivp with {_REFERENCE[0]} at rtol {_REFERENCE[1]:g} differs by {significant(apart, 1)};"
        " the exact events' own error is given against that"
    )


@dataclass(frozen=True, eq=False)
class _Contest:
    """One ring-down by every method; `taken` [J] is what the ball takes, `apart` the tightest integration's error."""

    system: ParticleDamper
    release: tuple[float, float]
    taken: float
    apart: float | None

    def steps(self, step: Step) -> Iterator[Rung]:
        """The paper's way, from coarse steps to fine ones."""
        from damper import stepped_ringdown

        def judge(found: SteppedRingDown) -> tuple[int | None, float]:
            return len(found.time) - 1, self._error(found)

        for steps in STEPS:
            step.advance(f"{steps} steps a cycle")
            solve = partial(stepped_ringdown, self.system, self.release, CYCLES, steps)
            yield measure("fixed step, as in the paper", f"{steps} a cycle", solve, judge)

    def integrators(self, step: Step) -> Iterator[Rung]:
        """Those of SciPy, from loose tolerances to tight ones."""

        def judge(found: ByIvp) -> tuple[int | None, float]:
            return found.evaluations, self._error(found)

        for method, tolerances in METHODS.items():
            for rtol in tolerances:
                step.advance(f"{method}, {rtol:g}")
                solve = partial(by_ivp, self.system, self.release, CYCLES, method, rtol)
                yield measure(f"solve_ivp, {method}", f"rtol {rtol:g}", solve, judge)

    def events(self, step: Step) -> Rung:
        """What a run uses; held against the tightest integration, where that has an answer."""
        from damper import ringdown

        def judge(found: RingDown) -> tuple[int | None, float]:
            return found.events, self._error(found.energy) if self.apart is None else self.apart

        step.advance("exact events")
        return measure("exact events", "no step", partial(ringdown, self.system, self.release, CYCLES), judge)

    def _error(self, found: _Balance) -> float:
        return abs(_taken(found) / self.taken - 1.0)


def _taken(found: _Balance) -> float:
    """What the ball took: by rolling, by impacts and, where the equations do not conserve energy, by their fault."""
    return float(found.initial - found.final - found.structure)
