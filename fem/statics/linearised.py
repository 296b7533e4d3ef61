"""The stiffness at a speed, about the state that the load leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.statics.large_deflection import equilibrium, tangent
from fem.statics.rest import check_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]


def linearise(
    operators: Operators, omega: float, start: Array | None = None, state: Array | None = None
) -> tuple[csc_array, Array | None]:
    """Return the stiffness (n, n) at a speed, and the state it is taken about if the deflection is large.

    start, state: see `fem.solve_modes`.

    Raises:
        ValueError: for a speed that is not one finite number.
    """
    check_speed(omega)
    if not operators.effects.large_deflection:
        return operators.at(omega), None
    if omega == 0.0:
        return operators.stiffness, np.zeros_like(operators.load)
    if state is None:
        state = equilibrium(operators, omega, start)
    return tangent(operators, omega, state), state
