"""Modes of one plate at a few speeds, as exact as it takes to compare meshes, for little more than one solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fem.davidson import lowest_modes
from fem.modes import Divergence, Modes, check_count, linearise, solve_modes, solve_real
from fem.statics import NoEquilibrium

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from fem.operators import Operators

    Array = NDArray[np.float64]

ROUGH = 1e-4
"""Largest residual of the modes at the first speed; the error of their frequencies is of the order of its square."""


def probe(operators: Operators, speeds: tuple[float, ...], count: int, exact: float) -> list[tuple[Array, Array]]:
    """Find the count lowest modes at speeds in rad/s, ascending, up to the first at which the plate has none.

    exact: relative, of squared frequencies. Returns eigenvalues (count,) in rad²/s² and mass-normalised shapes
    (n, count) for each speed. Raises ValueError as `solve_modes` does, and for the first speed Divergence,
    NoEquilibrium and Unresolved.
    """
    first = _first(operators, speeds[0], count, exact)
    found = [(first.eigenvalues, first.shapes)]
    for speed in speeds[1:]:
        try:
            found.append(_from(operators, first, speed, exact))
        except (Divergence, NoEquilibrium):
            break
    return found


def _first(operators: Operators, speed: float, count: int, exact: float) -> Modes:
    if operators.gyroscopic is not None:
        return solve_modes(operators, speed, count)
    check_count(operators, count)
    stiffness, state = linearise(operators, speed)
    return solve_real(operators, speed, stiffness, count, state, tolerance=min(ROUGH, exact))


def _from(operators: Operators, known: Modes, speed: float, exact: float) -> tuple[Array, Array]:
    """Modes at a speed in rad/s from those at another, or by themselves where they differ too much."""
    if operators.gyroscopic is None:
        stiffness, _ = linearise(operators, speed)
        near = lowest_modes(stiffness, operators.mass, known.shapes, known.factor, exact)
        if near is not None and near[0][0] > 0.0:
            return near
    modes = solve_modes(operators, speed, known.eigenvalues.size)
    return modes.eigenvalues, modes.shapes
