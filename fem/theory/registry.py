"""Plate theories by name, and what kind of body each takes a plate for."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fem.plate import Plate
    from fem.theory.discretisation import Discretisation


THEORIES = ("mindlin", "kirchhoff", "solid")
"""Names of the theories, the default first; "kirchhoff/morley" and "solid/4" name an element or layers too, and
"mindlin/held" is clamped as a solid is (`fem.theory.clamp`).

The solid is the reference on rectangles; on distorted cells and triangles a thin one locks, and Mindlin's theory does
not.
"""

LAYERED = {2: 0.012, 4: 0.002, 6: 0.0005}
"""Error of a solid of so many layers of bricks, times h/L: the corner at the clamp is singular across them as well."""


def discretise(plate: Plate, theory: str, rotary_inertia: bool = True) -> Discretisation:
    """Make the model of a plate in the named theory.

    Raises:
        ValueError: for an unknown name or one that the mesh does not allow.
        TypeError: for what is no name.
    """
    from fem.theory import clamp, kirchhoff, mindlin, solid

    if not isinstance(theory, str):
        raise TypeError(f"theory must be the name of one, got {theory!r}")
    if theory == "auto":
        raise ValueError("theory must be the name of one; fem.choose_theory(plate).name is that of the cheapest")
    name, _, element = theory.partition("/")
    if name == "kirchhoff" and element in ("", *kirchhoff.ELEMENTS):
        return kirchhoff.discretise(plate, rotary_inertia, element or None)
    if theory == "mindlin":
        return mindlin.discretise(plate, rotary_inertia)
    if theory == "mindlin/held":
        return clamp.discretise(plate, rotary_inertia)
    if name == "solid" and element in ("", *map(str, LAYERED)):
        return solid.discretise(plate, int(element or min(LAYERED)))
    elements = ["mindlin/held", *(f"kirchhoff/{element}" for element in kirchhoff.ELEMENTS)]
    elements += [f"solid/{layers}" for layers in LAYERED]
    raise ValueError(f"theory must be one of {', '.join([*THEORIES, *elements])}, got {theory!r}")


def solid_theory(length: float, thickness: float, tolerance: float) -> tuple[str, float]:
    """The solid with enough layers for a tolerance, or with the most: (name, error left by the layers)."""
    left = {layers: factor * thickness / length for layers, factor in LAYERED.items()}
    enough = [layers for layers, error in left.items() if error <= tolerance]
    layers = min(enough, default=max(left))
    return f"solid/{layers}", left[layers]


class Kind(StrEnum):
    """What a theory takes for a plate: a surface that only bends, one that shears too, or a body."""

    KIRCHHOFF = "kirchhoff"
    MINDLIN = "mindlin"
    SOLID = "solid"


def kind(theory: str) -> Kind:
    """The kind of a theory by its name.

    Raises:
        ValueError: for another name.
    """
    return Kind(theory.partition("/")[0])
