"""What rounding leaves of a plate at rest, and which speeds there are."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fem.linalg.lanczos import SingularMatrix, factorise, lanczos, rounding
from fem.operators.assembly import assemble

if TYPE_CHECKING:
    from fem.operators.assembly import Operators
    from fem.plate.root import ElasticRoot

LOST = 0.1
"""What rounding may leave uncertain of the lowest frequency at rest, by an estimate that is some twenty times what is
measured (strips of h/L = 1e-4, W/L = 0.01 against thin-plate theory, 0.05 to 0.19: errors of 2e-3 to 6e-3)."""


ROUGH = 1e-3
"""Residual of the mode at rest: the error of its frequency is of the order of the square."""


class Unresolved(ArithmeticError):
    """Rounding has eaten up the stiffness: in double precision the theory has no answer.

    The plate is too thin, or stands on springs so soft that it is all but loose.

    Attributes:
        uncertain: what is left uncertain of the lowest frequency at rest, relatively; infinite where it has none.
        loose: the root, where it is that which is too soft.
    """

    def __init__(self, theory: str, uncertain: float, loose: ElasticRoot | None = None) -> None:
        left = f"rounding may be {100 * uncertain:.2g} % of" if uncertain < 1.0 else "rounding leaves nothing of"
        thin = (
            f"too thin for theory {theory!r} in double precision: {left} the lowest frequency at rest; "
            "of the theories, kirchhoff loses the fewest digits and solid the most"
        )
        soft = f"too soft in double precision: the plate is all but loose, and {left} its lowest frequency at rest"
        super().__init__(thin if loose is None else soft)
        self.uncertain = uncertain
        self.loose = loose


def check_speed(omega: float) -> None:
    """Raise ValueError unless omega is one finite speed in rad/s."""
    if np.ndim(omega) != 0 or not np.isfinite(omega):
        raise ValueError(f"omega must be one finite speed in rad/s, got {omega!r}")


def check_rest(operators: Operators) -> float:
    """Raise Unresolved unless the plate at rest has a lowest frequency that rounding leaves; its square in rad²/s².

    At rest the stiffness is positive by construction: what is not so there, or is not there, is rounding.
    """
    uncertain, lowest = _uncertain(operators)
    if uncertain <= LOST:
        return lowest
    root = operators.plate.elastic_root
    if root is not None:
        held = replace(operators.plate, elastic_root=None)
        clamped = assemble(held, operators.rotor, operators.effects, operators.model.theory)
        root = root if _uncertain(clamped)[0] <= LOST else None
    raise Unresolved(operators.model.theory, uncertain, root)


def _uncertain(operators: Operators) -> tuple[float, float]:
    """What rounding leaves uncertain of the lowest frequency at rest, relatively, and its square: infinite without."""
    try:
        factor = factorise(operators.stiffness)
    except SingularMatrix:
        return np.inf, np.inf
    if factor.negative:
        return np.inf, np.inf
    value, shape = lanczos(factor, operators.mass, 1, ROUGH)
    return float(rounding(operators.stiffness, shape, value)[0]), float(value[0])
