"""Ladder of the damper: fixed steps, `solve_ivp`, and the exact events, by what the ball takes in one ring-down."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from workflows.costs.by_ivp import ByIvp, Integrator, by_ivp
from workflows.costs.ladder import Chosen, Ladder, Row, measure
from workflows.records import SpeedPoint
from workflows.stages import Step
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


def ladder(
    system: ParticleDamper, release: tuple[float, float], point: SpeedPoint, step: Step
) -> tuple[Ladder | None, Chosen]:
    """Error of the energy that the ball takes in 20 cycles, and of the exact events against the tightest integration.

    What the structure's own damping takes is left out: it hides the ball's share, and every method has it right. There
    is no ladder where the ball takes nothing.
    """
    from damper import ringdown, stepped_ringdown

    step.advance("reference")
    exact = ringdown(system, release, CYCLES).energy
    taken = _taken(exact)
    if abs(taken) < _NOTHING * exact.initial:
        return None, Chosen("exact events", f"the ball takes nothing in {CYCLES} cycles", None, None)
    try:
        apart: float | None = abs(_taken(by_ivp(system, release, CYCLES, *_REFERENCE)) / taken - 1.0)
    except (ArithmeticError, ValueError):
        apart = None

    def error(found: _Balance) -> float:
        return abs(_taken(found) / taken - 1.0)

    def of_steps(found: SteppedRingDown) -> tuple[int | None, float]:
        return len(found.time) - 1, error(found)

    def of_ivp(found: ByIvp) -> tuple[int | None, float]:
        return found.evaluations, error(found)

    def of_events(found: RingDown) -> tuple[int | None, float]:
        return found.events, error(found.energy) if apart is None else apart

    rows: list[Row] = []
    for steps in STEPS:
        step.advance(f"{steps} steps a cycle")
        rows.append(
            measure(
                "fixed step, as in the paper",
                f"{steps} a cycle",
                lambda steps=steps: stepped_ringdown(system, release, CYCLES, steps),  # type: ignore[misc]
                of_steps,
            )
        )
    for method, tolerances in METHODS.items():
        for rtol in tolerances:
            step.advance(f"{method}, {rtol:g}")
            rows.append(
                measure(
                    f"solve_ivp, {method}",
                    f"rtol {rtol:g}",
                    lambda method=method, rtol=rtol: by_ivp(system, release, CYCLES, method, rtol),  # type: ignore[misc]
                    of_ivp,
                )
            )
    step.advance("exact events")
    rows.append(measure("exact events", "no step", lambda: ringdown(system, release, CYCLES), of_events))
    between = (
        "which no independent integration could confirm here"
        if apart is None
        else f"from which solve_ivp with {_REFERENCE[0]} at rtol {_REFERENCE[1]:g} differs by {significant(apart, 1)};"
        " the exact events' own error is given against that"
    )
    return (
        Ladder(
            "damper",
            f"relative error of the energy that the ball takes in {CYCLES} cycles at {whole(point.rpm)} rpm",
            f"the exact events, {between}",
            tuple(replace(row, uncertainty=apart) for row in rows),
        ),
        Chosen(
            "exact events",
            "closed form between events, roots to rounding",
            _ROUNDING * exact.initial / abs(taken),
            apart,
        ),
    )


def _taken(found: _Balance) -> float:
    """What the ball took: by rolling, by impacts and, where the equations do not conserve energy, by their fault."""
    return float(found.initial - found.final - found.structure)
