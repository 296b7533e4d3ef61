"""Rotary inertia: that of the cross-sections, which turn as the plate bends."""

from __future__ import annotations

from workflows.effects.definition import Called, Case, Definition


def called_for(case: Case) -> Called:
    """Wherever there is a plate."""
    if case.scene.plate is None:
        return Called(False, "the structure's mass is given")
    return Called(True, "the cross-sections of a thick plate turn as they bend")


EFFECT = Definition("plate", called_for, "rotary inertia")
