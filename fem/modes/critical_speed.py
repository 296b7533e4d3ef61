"""The critical speed: where spin softening has eaten up the stiffness and the plate diverges.

K(Omega) is linear in Omega², so that its least eigenvalue is a concave function of it: positive at rest and at some
speed it is positive between. The signs of the pivots (Sylvester) therefore bracket the critical speed. From a speed a
just below it, Omega² - a² are the inverse eigenvalues of K(a)^-1 (softening - stiffening): the wanted one is
positive, and stiffening, however strong, brings none below -1 / a².
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.linalg.lanczos import NotConverged, SingularMatrix, factorise, krylov, random_block
from fem.statics.rest import check_rest

if TYPE_CHECKING:
    from fem.linalg.lanczos import Factor
    from fem.operators.assembly import Operators


NEVER = 1e3
"""A critical speed above this times the lowest frequency at rest counts as none."""

RUNG = 4.0
"""Ratio of the speeds between which the critical one is bracketed."""


def critical_speed(operators: Operators) -> float:
    """Lowest speed in rad/s at which K(Omega) is singular; infinity where it never is.

    It is the mesh's: where stiffening and softening nearly cancel, as in the plane of rotation without a hub, a coarse
    mesh may have a critical speed that a finer one has not, or not have one. Prestress is taken as linear in Omega²,
    also where the effects ask for large deflection.

    Raises:
        Unresolved: for a plate too thin for its theory.
        NotConverged: the iteration does not converge.
    """
    if operators.softening is None and operators.geometric is None:
        return np.inf
    rest = check_rest(operators)
    below = NEVER * float(np.sqrt(rest))
    if _stable(operators, below) is not None:
        return np.inf
    while (factor := _stable(operators, below)) is None:
        below = below / RUNG if below**2 * NEVER**2 > rest else 0.0
    loss = -operators.spinning
    start = factor.solve(loss @ random_block(loss.shape[0]))
    values, _ = krylov(lambda x, _: factor.solve(loss @ x), operators.at(below), start, 1, np.asarray)
    if values[0] <= 0.0:
        raise NotConverged(f"rounding hides the critical speed above {below:.6g} rad/s")
    return float(np.sqrt(below**2 + 1.0 / values[0]))


def _stable(operators: Operators, omega: float) -> Factor | None:
    """Factor of K at a speed in rad/s, if it is positive."""
    try:
        factor = factorise(operators.at(omega))
    except SingularMatrix:
        return None
    return None if factor.negative else factor
