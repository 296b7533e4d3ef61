"""The plate theories by name, and the choice among them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fem.discretisation import Discretisation
    from fem.plate import Plate

THEORIES = ("mindlin", "kirchhoff", "solid")
"""Names of the theories, the default first; "kirchhoff/morley" and the like name an element too."""

TORSION = 0.315
"""Thin-plate theory overstates torsion frequencies by this times h/b (Saint-Venant's rectangular bar)."""

STOUT = 0.3
"""Thickness over the smaller side beyond which a plate is a block."""


def discretise(plate: Plate, theory: str, rotary_inertia: bool = True) -> Discretisation:
    """Make the model of a plate in the named theory.

    Raises ValueError for an unknown name or one that the mesh does not allow.
    """
    from fem import kirchhoff, mindlin, solid

    if theory == "auto":
        theory, _ = choose_theory(plate)
    name, _, element = theory.partition("/")
    if name == "kirchhoff" and element in ("", *kirchhoff.ELEMENTS):
        return kirchhoff.discretise(plate, rotary_inertia, element or None)
    if theory == "mindlin":
        return mindlin.discretise(plate, rotary_inertia)
    if theory == "solid":
        return solid.discretise(plate)
    raise ValueError(f"theory must be auto, {', '.join(THEORIES)}, got {theory!r}")


def choose_theory(plate: Plate, accuracy: float = 1e-3) -> tuple[str, str]:
    """Choose the cheapest theory that is good to a relative accuracy in frequency: (name, why)."""
    sides = np.ptp(plate.mesh.p, axis=1)
    ratio = plate.thickness / float(sides.min())
    error = TORSION * ratio
    if ratio > STOUT:
        return "solid", f"the plate is a block: its thickness is {ratio:.2g} of its smaller side"
    if error <= accuracy:
        return "kirchhoff", f"thin: shear changes twist by about {error:.1g} at h/b = {ratio:.2g}"
    return "mindlin", f"thin-plate theory would be off by about {100 * error:.2g} % in twist at h/b = {ratio:.2g}"
