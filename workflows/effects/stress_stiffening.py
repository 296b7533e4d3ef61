"""Stress stiffening: the centrifugal pull stiffens the plate."""

from __future__ import annotations

from workflows.effects.definition import AT_REST, GIVEN, Called, Case, Definition


def called_for(case: Case) -> Called:
    """Wherever a plate spins."""
    if case.scene.plate is None:
        return GIVEN
    if not case.spins:
        if case.scene.effects.large_deflection is True:
            return Called(True, "nothing spins, but large_deflection, which the scene asks for, needs it")
        return AT_REST
    return Called(True, "the plate spins, and the centrifugal pull stiffens it")


_COSTS = ("fem.operators.assembly._held", "fem.operators.assembly._stiffening")

EFFECT = Definition("plate", called_for, "stress stiffening", costs=_COSTS)
