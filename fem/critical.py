"""The critical speed: where spin softening has eaten up the stiffness and the plate diverges."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.modes import check_rest
from fem.solver import factorise, krylov, lanczos, random_block

if TYPE_CHECKING:
    from fem.operators import Operators


NEVER = 1e-6
"""A critical speed above this to the power -1/2 times the lowest frequency at rest counts as none."""


def critical_speed(operators: Operators) -> float:
    """Lowest speed in rad/s at which K(Omega) is singular; infinity where it never is.

    Prestress is taken as linear in Omega², also where the effects ask for large deflection. Raises Unresolved for a
    plate too thin for its theory.
    """
    if operators.softening is None and operators.geometric is None:
        return np.inf
    check_rest(operators)
    loss = -operators.spinning
    factor = factorise(operators.stiffness)
    start = factor.solve(loss @ random_block(loss.shape[0]))
    values, _ = krylov(lambda x, _: factor.solve(loss @ x), operators.stiffness, start, 1, np.asarray, floor=NEVER)
    rest, _ = lanczos(factor, operators.mass, 1)
    return float(values[0] ** -0.5) if values[0] > NEVER / rest[0] else np.inf
