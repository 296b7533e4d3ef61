"""Spin softening: motion across the spin axis is softened."""

from __future__ import annotations

import math

from workflows.effects.definition import AT_REST, GIVEN, Called, Case, Definition


def called_for(case: Case) -> Called:
    """Wherever a plate spins."""
    rotor = case.scene.rotor
    if case.scene.plate is None:
        return GIVEN
    if not case.spins:
        return AT_REST
    if abs(math.sin(rotor.stagger)) > 1e-9:
        return Called(True, "the plate is staggered: its bending moves across the spin axis")
    if abs(math.sin(rotor.precone)) > 1e-9:
        return Called(True, "the plate is coned: its bending moves across the spin axis")
    return Called(True, "in-plane modes and, a little, the turning cross-sections of bending move across the spin axis")


EFFECT = Definition("plate", called_for, "spin softening", costs=("fem.rotor.Rotor.projector",))
