"""Free vibration of the spinning plate at one speed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fem.modes.gyroscopic import solve_gyroscopic
from fem.modes.real import Modes, check_count, check_damping, solve_real
from fem.statics import linearise

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]


def solve_modes(
    operators: Operators,
    omega: float,
    count: int = 6,
    *,
    start: Array | None = None,
    state: Array | None = None,
    damping_ratio: float = 0.0,
) -> Modes:
    """Find the count lowest modes at a speed omega (rad/s).

    start: the state at a neighbouring speed, to warm-start a large deflection. state: that at this speed, if known.
    damping_ratio: viscous damping of each mode of the plate, below 1, which Coriolis forces then share out.

    Rounding takes some digits of a thin plate, most of its lowest frequency. `fem.linalg.rounding`
    estimates how much, some twenty times too cautiously, and the `bounds` of `campbell` contain it. On a square of 8
    x 8 cells it is 1e-5 for a solid of h/L = 1e-4, and grows with (L/h)²; for Mindlin's plates it is below 1e-6, for
    Kirchhoff's below 1e-10, at any thickness. Finer meshes, strips, and speeds next to the critical one lose more.

    Raises:
        ValueError: for a speed that is not one finite number, a count that the plate does not have, and a ratio at
            which modes do not oscillate.
        Divergence: past the critical speed.
        NoEquilibrium: where a large deflection has none.
        Unresolved: for a plate too thin for the theory.
    """
    check_count(operators, count)
    check_damping(damping_ratio)
    stiffness, state = linearise(operators, omega, start, state)
    if operators.gyroscopic is not None and omega != 0.0:
        return solve_gyroscopic(operators, omega, stiffness, count, state, damping_ratio)
    found = solve_real(operators, omega, stiffness, count, state)
    return replace(found, damping_ratios=np.full(found.eigenvalues.size, damping_ratio))
