"""The plate theories by name, the choice among them, and how far each is from a solid."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fem.discretisation import Discretisation
    from fem.plate import Plate

THEORIES = ("mindlin", "kirchhoff", "solid")
"""Names of the theories, the default first; "kirchhoff/morley" and "solid/4" name an element or layers too.

The solid is the reference on rectangles; on distorted cells and triangles a thin one locks, and Mindlin's theory does
not.
"""

TORSION = 0.38
"""Thin-plate theory overstates torsion frequencies by this times h/b.

Saint-Venant's rectangular bar gives 0.315; the rest is transverse shear at the clamp (plates of aspect 1 to 10,
h/b from 0.015 to 0.2, against Mindlin's theory: 0.33 to 0.39).
"""

CLAMP = 0.04
"""Mindlin's theory understates frequencies by about this times h/L.

At the clamp a solid cannot narrow, which no plate theory sees. Against bricks, plates of aspect 1 to 2.5 with nu = 0.3
and h/L from 0.015 to 0.2: 0.026 to 0.056 in the six lowest modes; a fifth of that with nu = 0.
"""

STOUT = 0.3
"""Thickness over the smaller side beyond which a plate is a block."""

LAYERED = {2: 0.012, 4: 0.002, 6: 0.0005}
"""Error of a solid of so many layers of bricks, times h/L: the corner at the clamp is singular across them as well."""


@dataclass(frozen=True)
class Chosen:
    """A theory, why it was chosen, and an estimate of its own relative error against a solid, in frequency."""

    name: str
    why: str
    model_error: float


def discretise(plate: Plate, theory: str, rotary_inertia: bool = True) -> Discretisation:
    """Make the model of a plate in the named theory.

    Raises ValueError for an unknown name or one that the mesh does not allow, TypeError for what is no name.
    """
    from fem import kirchhoff, mindlin, solid

    if not isinstance(theory, str):
        raise TypeError(f"theory must be the name of one, got {theory!r}")
    if theory == "auto":
        theory = choose_theory(*plate.sides, plate.thickest).name
    name, _, element = theory.partition("/")
    if name == "kirchhoff" and element in ("", *kirchhoff.ELEMENTS):
        return kirchhoff.discretise(plate, rotary_inertia, element or None)
    if theory == "mindlin":
        return mindlin.discretise(plate, rotary_inertia)
    if name == "solid" and element in ("", *map(str, LAYERED)):
        return solid.discretise(plate, int(element or min(LAYERED)))
    elements = [f"kirchhoff/{element}" for element in kirchhoff.ELEMENTS] + [f"solid/{layers}" for layers in LAYERED]
    raise ValueError(f"theory must be one of auto, {', '.join([*THEORIES, *elements])}, got {theory!r}")


def choose_theory(
    length: float, width: float, thickness: float, accuracy: float = 1e-3, large_deflection: bool = False
) -> Chosen:
    """Choose the cheapest theory for a plate of these dimensions (m) and a relative accuracy in frequency.

    Thin-plate theory is taken where its difference from Mindlin's leaves half the accuracy to the mesh; the solid
    where the plate is a block. With large deflection it is Mindlin's, whose director may turn as far as it is turned;
    thin-plate theory is off by about 0.4 theta² there at a rotation theta. Mindlin's own difference from the solid is
    reported, and not held against it: below it only theory = "solid" goes. Raises ValueError unless all four are
    positive and finite.
    """
    if not all(0.0 < value < inf for value in (length, width, thickness, accuracy)):
        given = f"{length!r}, {width!r}, {thickness!r} and {accuracy!r}"
        raise ValueError(f"length, width, thickness and accuracy must be positive and finite, got {given}")
    ratio = thickness / min(length, width)
    if ratio > STOUT:
        return Chosen("solid", f"the plate is a block: its thickness is {ratio:.2g} of its smaller side", 0.0)
    if large_deflection:
        why = "the load deflects the plate: only Mindlin's theory and the solid know finite rotations"
        return Chosen("mindlin", why, model_error("mindlin", length, width, thickness))
    if TORSION * ratio <= 0.5 * accuracy:
        why = (
            f"thin: shear changes twist by {100 * TORSION * ratio:.1g} % at most, at a thickness of {ratio:.1g} widths"
        )
        return Chosen("kirchhoff", why, model_error("kirchhoff", length, width, thickness))
    why = f"thin-plate theory would be off by about {100 * TORSION * ratio:.2g} % in twist"
    return Chosen("mindlin", why, model_error("mindlin", length, width, thickness))


def model_error(theory: str, length: float, width: float, thickness: float) -> float:
    """Estimate how far a theory's frequencies are from a solid's, relatively; of the worst of the lowest modes.

    The solid is one that the mesh leaves without error: on distorted cells thin solids lock (`fem.solid`).
    """
    if theory.startswith("solid"):
        return 0.0
    clamp = CLAMP * thickness / length
    return clamp if theory == "mindlin" else max(clamp, TORSION * thickness / min(length, width))


def solid_theory(length: float, thickness: float, accuracy: float) -> tuple[str, float]:
    """The solid with enough layers for half an accuracy, or with the most: (name, error left by the layers)."""
    left = {layers: factor * thickness / length for layers, factor in LAYERED.items()}
    enough = [layers for layers, error in left.items() if error <= 0.5 * accuracy]
    layers = min(enough, default=max(left))
    return f"solid/{layers}", left[layers]
