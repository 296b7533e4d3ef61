"""Counterexamples sought, over the same space of scenes as the soak's, and shrunk where one is found."""

import dataclasses
import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fem import Effects, Plate, Rotor, assemble, rectangle, solve_modes
from tests.compiler import COMPILED
from tests.soak import plates, rings

T = TypeVar("T")
ringdowns = settings(
    max_examples=150 if COMPILED else 5, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
slow = settings(max_examples=12, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


class Drawn:
    """Dice that hypothesis throws."""

    def __init__(self, draw: st.DrawFn) -> None:
        self._draw = draw

    def between(self, low: float, high: float) -> float:
        return self._draw(st.floats(low, high, allow_nan=False))

    def one_of(self, choices: Sequence[T]) -> T:
        return choices[self._draw(st.integers(0, len(choices) - 1))]


@st.composite
def ring_scenes(draw: st.DrawFn) -> rings.Scene:
    dice = Drawn(draw)
    kind = rings.kind(dice)
    return rings.scene(dice, dataclasses.replace(kind, cycles=min(kind.cycles, 20.0) if kind.cycles != "auto" else 3.0))


@st.composite
def plate_scenes(draw: st.DrawFn) -> tuple[plates.Scene, object]:
    dice = Drawn(draw)
    scene = plates.scene(dice)
    return scene, plates.mesh(dice, scene)


@ringdowns
@given(ring_scenes())
def test_ring_downs(scene: rings.Scene) -> None:
    """Finite; events capped; energy never rising in the consistent equations; the ball inside its cavity."""
    assert rings.faults(rings.run([scene], threads=1), 0, scene) == []
    assert rings.overlap(scene, cycles=5.0) <= rings.INSIDE


@slow
@given(plate_scenes())
def test_plates(drawn: tuple[plates.Scene, object]) -> None:
    """Frequencies real and ordered, or Divergence; independent of how many are asked for."""
    assert plates.faults(*drawn)[0] == []


@slow
@given(plate_scenes())
def test_speed_to_zero(drawn: tuple[plates.Scene, object]) -> None:
    """Omega -> 0 is the plate at rest."""
    scene, mesh = drawn
    operators = plates.operators_of(scene, mesh)
    rest = solve_modes(operators, 0.0, 3)
    slowly = solve_modes(operators, 1e-7 * math.sqrt(rest.eigenvalues[0]), 3)
    uncertain = plates.rounding(operators.stiffness, np.abs(rest.shapes), rest.eigenvalues)
    np.testing.assert_array_less(np.abs(slowly.eigenvalues / rest.eigenvalues - 1), plates.EXACT + 4 * uncertain)


@pytest.mark.parametrize("theory", ["mindlin", "kirchhoff"])
def test_thickness_to_zero(theory: str) -> None:
    """h -> 0: at speed a plate becomes a membrane, whose frequencies no longer depend on its thickness."""
    found = []
    for thickness in (1e-4, 1e-5, 1e-6):
        plate = Plate(rectangle(0.2, 0.08, 8, 3), thickness, plates.Material(2e11, 0.3, 7850.0))
        found.append(solve_modes(assemble(plate, Rotor(0.1), Effects(), theory), 300.0, 3).frequencies_hz)
    far, near = (np.abs(found[k] / found[2] - 1).max() for k in (0, 1))
    assert near < 0.2 * far
    assert near < 0.05
