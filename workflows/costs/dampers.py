"""Ladder of the damper: fixed steps, `solve_ivp`, and the exact events, on one ring-down."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.costs.by_ivp import ByIvp, Integrator, by_ivp
from workflows.costs.ladder import Chosen, Ladder, Row, measure
from workflows.records import SpeedPoint
from workflows.stages import Step
from workflows.wording import significant

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


def ladder(
    system: ParticleDamper, release: tuple[float, float], point: SpeedPoint, step: Step
) -> tuple[Ladder, Chosen]:
    """Error of the energy that is lost in 20 cycles, and of the exact events against the tightest integration."""
    from damper import ringdown, stepped_ringdown

    step.advance("reference")
    exact = ringdown(system, release, CYCLES)
    lost = exact.energy.initial - exact.energy.final
    try:
        judge_of_exact = by_ivp(system, release, CYCLES, *_REFERENCE)
        apart: float | None = abs(judge_of_exact.final - exact.energy.final) / abs(lost)
    except (ArithmeticError, ValueError):
        apart = None

    def error(final: float) -> float:
        return abs(final - exact.energy.final) / abs(lost)

    def of_steps(found: SteppedRingDown) -> tuple[int | None, float]:
        return len(found.time) - 1, error(found.final)

    def of_ivp(found: ByIvp) -> tuple[int | None, float]:
        return found.evaluations, error(found.final)

    def of_events(found: RingDown) -> tuple[int | None, float]:
        return found.events, error(found.energy.final) if apart is None else apart

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
            f"relative error of the energy lost in {CYCLES} cycles at {point.rpm:.0f} rpm",
            f"the exact events, {between}",
            tuple(rows),
        ),
        Chosen("exact events", "closed form between events, roots to rounding", 1e-11, apart),
    )
