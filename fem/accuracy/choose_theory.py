"""The cheapest theory whose frequencies are as close to a solid's as is asked."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from fem.accuracy.budget import Budget
from fem.accuracy.theory_error import theory_errors, thin_errors
from fem.modes.real import Divergence, solve_real
from fem.operators.assembly import assemble
from fem.plate.rotor import Effects, Rotor
from fem.theory.kirchhoff import is_rectangles

if TYPE_CHECKING:
    from fem.plate.given import Plate

STOUT = 0.3
"""Thickness over the smaller side beyond which a plate is a block."""

DEAR = 3e-3
"""Accuracy below which a solid is not taken unasked: a plate of 20 x 8 x 1 cm takes 2 s for 1e-2, and 45 s for 1e-3."""

ENOUGH = 1e-3
"""Residual of the modes."""


@dataclass(frozen=True)
class Chosen:
    """A theory, why it was chosen, and an estimate of its own relative error against a solid, in frequency."""

    name: str
    why: str
    model_error: float


def choose_theory(
    plate: Plate,
    rotor: Rotor | None = None,
    effects: Effects | None = None,
    speeds: tuple[float, ...] = (0.0,),
    count: int = 6,
    accuracy: float = 1e-3,
) -> Chosen:
    """Choose the cheapest theory for the count lowest modes at speeds in rad/s and a relative accuracy in frequency.

    The plate's mesh may be coarse: what each theory has wrong is found from the modes on it. Thin-plate theory knows no
    large deflection: it is off by about 0.4 theta² at a rotation theta.

    Raises:
        ValueError: for an accuracy that is not positive.
        Unresolved: for a plate too thin for Mindlin's theory.
    """
    if not 0.0 < accuracy < inf:
        raise ValueError(f"accuracy must be positive and finite, got {accuracy!r}")
    effects, budget = effects or Effects(), Budget(accuracy)
    ratio = plate.thickest / min(plate.sides)
    if ratio > STOUT:
        return Chosen("solid", f"the plate is a block: its thickness is {ratio:.2g} of its smaller side", 0.0)
    errors = own_errors(plate, rotor or Rotor(), effects, speeds, count)
    thin, thick = errors["kirchhoff"], errors["mindlin"]
    if effects.large_deflection:
        why = "the load deflects the plate: only Mindlin's theory and the solid know finite rotations"
    elif thin <= budget.thin:
        return Chosen("kirchhoff", f"thin: shear and the clamp change frequencies by {_percent(thin)} at most", thin)
    else:
        why = f"thin-plate theory would be off by about {_percent(thin)}"
    if thick <= budget.sheared:
        return Chosen("mindlin", why, thick)
    left = f"Mindlin's theory would be off by about {_percent(thick)}"
    if accuracy >= DEAR and is_rectangles(plate.mesh) and not effects.large_deflection:
        return Chosen("solid", left, 0.0)
    why = 'theory = "solid" is exact, and dear' if accuracy < DEAR else "a solid would be no better here"
    return Chosen("mindlin", f"{left}; {why}", thick)


def own_errors(plate: Plate, rotor: Rotor, effects: Effects, speeds: tuple[float, ...], count: int) -> dict[str, float]:
    """What thin-plate theory and Mindlin's, its root held, are off by at most against a solid, relatively.

    Of the count lowest modes at the lowest of some speeds in rad/s and the highest, as far as there are modes.
    """
    plain = replace(effects, coriolis=False, large_deflection=False)
    operators = assemble(plate, rotor, plain, "mindlin/held")
    worst = np.zeros(2)
    for omega in sorted({min(speeds), max(speeds)}):
        try:
            modes = solve_real(operators, omega, operators.at(omega), count, tolerance=ENOUGH)
        except Divergence:
            break
        found = [rule(operators, modes.eigenvalues, modes.shapes).max() for rule in (thin_errors, theory_errors)]
        worst = np.maximum(worst, found)
    return {"kirchhoff": float(worst[0]), "mindlin": float(worst[1])}


def _percent(part: float) -> str:
    return f"{100 * part:.1g} %"
