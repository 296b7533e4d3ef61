"""What a theory has wrong of the modes at all speeds of a Campbell diagram."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fem.accuracy.theory_error import doubt, sloping, theory_errors
from fem.theory.kind import Kind, kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators
    from fem.sweep.diagram import Campbell

    Array = NDArray[np.float64]

STRAINED = 0.02
"""Of the strain at the root: CalculiX on plates strained by 0.8 % had up to 0.017 of it in their first mode."""


def over_speeds(operators: Operators, diagram: Campbell) -> Array:
    """Relative errors (k, count) of frequencies against a solid."""
    count, found = diagram.frequencies_hz.shape[1], []
    strained = _strained(operators, diagram.omega)[:, None]
    for part in diagram.parts:
        squares, vectors = part.rates[:, :count] ** 2, part.vectors[:, :, :count]
        if np.iscomplexobj(part.basis):  # of one speed by itself
            found.append(theory_errors(operators, squares[0], part.basis @ vectors[0])[None])
            continue
        energy = doubt(operators, part.basis)
        doubted = np.einsum("kri,rs,ksi->ki", vectors.conj(), energy, vectors, optimize=True).real
        found.append(doubted / squares + sloping(operators))
    return np.vstack(found) + strained


def _strained(operators: Operators, omega: Array) -> Array:
    """What stays uncertain of the stress that stiffens a plate at speeds (k,): a part of the strain at its root."""
    plate, hub = operators.plate, operators.rotor.hub_radius
    if kind(operators.model.theory) is Kind.SOLID or not operators.effects.stress_stiffening:
        return np.zeros(omega.size)
    reach = abs((hub + plate.sides[0]) ** 2 - hub**2)
    return STRAINED * 0.5 * plate.material.density * omega**2 * reach / plate.material.youngs_modulus
