"""Plate theories by name: what body each takes a plate for, and what else is asked of one."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from fem.plate import Plate
from fem.theory import kirchhoff, mindlin, solid
from fem.theory.discretisation import Discretisation


class Kind(StrEnum):
    """What a theory takes for a plate: a surface that only bends, one that shears too, or a body."""

    KIRCHHOFF = "kirchhoff"
    MINDLIN = "mindlin"
    SOLID = "solid"


@dataclass(frozen=True)
class PlateTheory:
    """A plate theory, and all that meshes, errors, memory and reports need to know of it.

    Attributes:
        kind: what it takes for a plate.
        discretise: its model of a plate, with rotary inertia or without, in an element ("": the best for the mesh).
        elements: what may stand behind its name and a slash: elements, layers, or how it is clamped.
        most_unknowns: beyond which no finer mesh is tried: a factor then takes seconds and some gigabytes.
        unknowns: of each corner, edge and cell, in an element and on quadrilaterals or triangles.
        memory: bytes for each unknown, by element where it counts: matrices, their factor, vectors of six modes.
        deflected: by how much that grows with large deflection, whose tangent is made anew from every cell.
        lacks: part of what the clamp does, in bending and in stretching, that it lacks at most, by element where it
            counts; of the solid nothing, which is the reference.
        against_solid: how it differs from the solid, as reports say it.
    """

    kind: Kind
    discretise: Callable[[Plate, bool, str], Discretisation]
    elements: tuple[str, ...]
    most_unknowns: int
    unknowns: Callable[[str, bool], tuple[int, int, int]]
    memory: Mapping[str, float]
    deflected: float
    lacks: Mapping[str, tuple[float, float]]
    against_solid: str


LAYERED = {2: 0.012, 4: 0.002, 6: 0.0005}
"""Error of a solid of so many layers of bricks, times h/L: the corner at the clamp is singular across them as well.

In torsion of a bar it does not fall with the length: h over `_SECTION` widths counts where that is more.
"""

_SECTION = 2.5
"""Against CalculiX's C3D20R, of five bars whose thickness is 0.4 to 1 of their width."""


def _sheared(plate: Plate, rotary_inertia: bool, element: str) -> Discretisation:
    make = mindlin.held if element == "held" else mindlin.discretise
    return make(plate, rotary_inertia)


def _layered(plate: Plate, _: bool, element: str) -> Discretisation:
    return solid.discretise(plate, int(element or min(LAYERED)))


def _of_bricks(element: str, _: bool) -> tuple[int, int, int]:
    column = 3 * (2 * int(element or min(LAYERED)) + 1)
    return column, column, column


_FREE = (1.2, 1.2 * mindlin.STRETCHED)
"""What plates lack that are clamped at their root."""

THEORIES = {
    "mindlin": PlateTheory(
        kind=Kind.MINDLIN,
        discretise=_sheared,
        elements=("held",),
        most_unknowns=100_000,
        unknowns=lambda _, quads: (5, 5, 5 if quads else 2),
        memory={"": 1.4e4},
        deflected=2.7,
        lacks={"": _FREE, "held": (0.22, 0.5)},
        against_solid="Errors are relative to a solid. The plate is clamped slightly outside its root, where a solid"
        " appears to be.",
    ),
    "kirchhoff": PlateTheory(
        kind=Kind.KIRCHHOFF,
        discretise=kirchhoff.discretise,
        elements=tuple(kirchhoff.ORDER),
        most_unknowns=100_000,
        unknowns=lambda _, quads: (6, 2, 2) if quads else (8, 3, 0),
        memory={"": 2.4e4},
        deflected=1.5,
        lacks={"": _FREE},
        against_solid="Errors are relative to a solid. Thin-plate theory neglects shear, which matters most in twist.",
    ),
    "solid": PlateTheory(
        kind=Kind.SOLID,
        discretise=_layered,
        elements=tuple(map(str, LAYERED)),
        most_unknowns=60_000,
        unknowns=_of_bricks,
        memory={"": 3.8e4, "4": 5.2e4, "6": 6.2e4},
        deflected=1.8,
        lacks={"": (0.0, 0.0)},
        against_solid="A solid is the reference for errors.",
    ),
}
"""The theories by name, the default first; "kirchhoff/morley" and "solid/4" name an element or layers too, and
"mindlin/held" is clamped as a solid is (`fem.theory.mindlin`).

The solid is the reference on rectangles; on distorted cells and triangles a thin one locks, and Mindlin's theory does
not.
"""


def theory_of(theory: str) -> tuple[PlateTheory, str]:
    """The record of a theory by its name, and the element that the name has too, or "".

    Raises:
        ValueError: for another name.
    """
    name, slash, element = theory.partition("/")
    if name not in THEORIES or (slash and element not in ("", *THEORIES[name].elements)):
        elements = [f"{each}/{element}" for each, known in THEORIES.items() for element in known.elements]
        raise ValueError(f"theory must be one of {', '.join([*THEORIES, *elements])}, got {theory!r}")
    return THEORIES[name], element


def discretise(plate: Plate, theory: str, rotary_inertia: bool = True) -> Discretisation:
    """The model of a plate in a theory.

    Args:
        plate: with its mesh.
        theory: name in `THEORIES`.
        rotary_inertia: whether turning sections have inertia.

    Raises:
        ValueError: an unknown name, or one that the mesh does not allow.
        TypeError: something that is no name.
    """
    if not isinstance(theory, str):
        raise TypeError(f"theory must be the name of one, got {theory!r}")
    if theory == "auto":
        raise ValueError("theory must be the name of one; fem.choose_theory(plate).name is that of the cheapest")
    known, element = theory_of(theory)
    return known.discretise(plate, rotary_inertia, element)


def kind(theory: str) -> Kind:
    """The kind of a theory by its name.

    Raises:
        ValueError: for another name.
    """
    return theory_of(theory)[0].kind


def clamp_lacks(theory: str) -> tuple[float, float]:
    """Part of what the clamp does, in bending and in stretching, that a theory lacks at most.

    Raises:
        ValueError: for another name.
    """
    known, element = theory_of(theory)
    return known.lacks.get(element, known.lacks[""])


def solid_theory(sides: tuple[float, float], thickness: float, tolerance: float) -> tuple[str, float]:
    """The solid theory with enough layers for a tolerance, or with the most.

    Args:
        sides: length and width of the plate [m].
        thickness: of the plate [m].
        tolerance: relative, in frequency.

    Returns:
        Name, and the relative error that the layers leave.
    """
    least = min(sides[0], _SECTION * sides[1])
    left = {layers: factor * thickness / least for layers, factor in LAYERED.items()}
    enough = [layers for layers, error in left.items() if error <= tolerance]
    layers = min(enough, default=max(left))
    return f"solid/{layers}", left[layers]
