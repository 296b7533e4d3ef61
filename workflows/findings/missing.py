"""What the material that the cavities take out of the plate would do, which is solved whole."""

from __future__ import annotations

from typing import NamedTuple

from workflows.solve.records import Reduced, Results
from workflows.wording import significant

_NOTABLE = 1e-3
"""Relative shift of a frequency from which on it is worth a word, whatever the accuracy."""


class Missing(NamedTuple):
    """Mass [kg] that is not there, and the largest relative shift of the first bending frequency over the speeds."""

    mass: float
    shift: float


def sentence(results: Results) -> str | None:
    """What the frequencies leave out, in words; None where that is nothing, or hardly anything."""
    hole, damper = missing(results), results.scene.damper
    if hole is None or damper is None or abs(hole.shift) <= min(_NOTABLE, results.scene.accuracy.frequency):
        return None
    cut = "its cavity is cut" if damper.count == 1 else f"its {damper.count} cavities are cut"
    return (
        f"That is of the plate before {cut}: {significant(1e3 * hole.mass, 2)} g less"
        f" {'raise' if hole.shift > 0 else 'lower'} its first bending frequency by up to about"
        f" {significant(100 * abs(hole.shift), 2)} %."
    )


def missing(results: Results) -> Missing | None:
    """What the cavities take out of the plate; None where there are none in it.

    A hole is a negative point mass where the damper is; the stiffness that goes with it hardly counts where the plate
    hardly bends, as near its tip. Along the radius a cavity holds its ball.
    """
    damper, material = results.scene.damper, results.scene.material
    reduced = [point.reduced for point in results.speeds if point.reduced is not None]
    if damper is None or material is None or damper.housing or not reduced:
        return None
    mass = material.density * damper.count * 2 * damper.radius * damper.cavity[0] * damper.cavity[1]
    return Missing(mass, max((_shift(each, mass) for each in reduced), key=abs))


def _shift(reduced: Reduced, mass: float) -> float:
    """To first order in the mass: less inertia, and less pull, of which the ball's own mass shows how it stiffens."""
    ball = reduced.M1 - reduced.M2
    pull = (reduced.K1 - reduced.K2) / reduced.K2 / ball if ball > 0 else 0.0
    return mass / 2 * (1 / reduced.M2 - pull)
