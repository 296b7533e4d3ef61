"""The tables of the plate: [plate] with its thickness and root, [material]."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, WithJsonSchema, model_validator

from fem.meshes.thickness import Bilinear, Polynomial, Profile
from fem.meshes.thickness import of as thickness_of
from workflows.scene import materials
from workflows.scene import quantities as q
from workflows.scene.quantities import ROUNDING, Table, fault, wrong

GRID = 129
"""Places along each side of a rectangle at which a thickness is looked at."""

MOST_COEFFICIENTS = 12
"""Of a polynomial, along x and along y: in powers of metres higher ones drown in rounding."""


def _length_rows(value: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Rows of lengths; of a plain list each is a row of its own."""
    if not isinstance(value, list | tuple) or not value:
        raise wrong("expected a list of lists of lengths, one list for each x")
    rows = [row if isinstance(row, list | tuple) else [row] for row in value]
    if not all(rows):
        raise wrong(f"expected a list such as ['{q.LENGTH.example}', '{q.LENGTH.example}']")
    return tuple(tuple(q.si(q.LENGTH, item, info) for item in row) for row in rows)


def _coefficients(value: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    """Rows i of coefficients j of x^i y^j, each a length to the power 1 - i - j."""
    if not isinstance(value, list | tuple) or not value or not all(isinstance(r, list | tuple) and r for r in value):
        raise wrong("expected a list of lists, of x^i y^j the coefficient j in list i: [['5 mm'], ['-0.01 mm/mm']]")
    if max(len(value), *map(len, value)) > MOST_COEFFICIENTS:
        raise wrong(f"expected at most {MOST_COEFFICIENTS} lists of at most {MOST_COEFFICIENTS} coefficients")
    return tuple(
        tuple(q.si(q.length_power(1 - i - j), item, info) for j, item in enumerate(row)) for i, row in enumerate(value)
    )


_ROWS = q.array_schema(q.quantity_schema(q.LENGTH))
LengthRows = Annotated[
    tuple[tuple[float, ...], ...],
    BeforeValidator(_length_rows),
    WithJsonSchema(q.array_schema({"anyOf": [q.quantity_schema(q.LENGTH), _ROWS]})),
]
_COEFFICIENT = {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": ["5 mm", "-0.01 mm/mm"]}
Coefficients = Annotated[
    tuple[tuple[float, ...], ...],
    BeforeValidator(_coefficients),
    WithJsonSchema(q.array_schema(q.array_schema(_COEFFICIENT, 1, MOST_COEFFICIENTS), 1, MOST_COEFFICIENTS)),
]


class Thickness(Table):
    """A thickness that varies over the planform, symmetric about the flat mid-surface.

    A table over x and y, bilinear between its points; a polynomial in x and y; or a field of the mesh file. x and y are
    the plate's (the mesh file's, where there is one).
    """

    x: q.Lengths | None = None
    """of a table: places along x, ascending"""
    y: q.Lengths | None = None
    """of a table: places across, ascending; default: constant across"""
    values: LengthRows | None = None
    """of a table: for each x, a list of the thicknesses at each y"""
    polynomial: Coefficients | None = None
    """coefficients of x^i y^j, number j in list i; numbers without a unit are in powers of m"""
    field: q.Line | None = None
    """point data of the mesh file, in the unit of its coordinates, linear between its points"""

    @model_validator(mode="after")
    def _one(self) -> Self:
        """One way of giving a thickness that varies, and a table whose parts fit together."""
        ways = "a table (x, y, values), a polynomial and a field of the mesh file"
        q.check_one(self, ("values", "polynomial", "field"), ways)
        if self.values is not None:
            self._fits(self.values)
        for key in ("x", "y") if self.values is None else ():
            if getattr(self, key) is not None:
                raise fault(key, "belongs to a table with values: leave it out")
        return self

    def _fits(self, values: tuple[tuple[float, ...], ...]) -> None:
        """The parts of a table, together."""
        if self.x is None:
            raise fault("x", "missing: the places along x of the table's values")
        for key, places in (("x", self.x), ("y", self.y or ())):
            if any(b <= a for a, b in pairwise(places)):
                raise fault(key, "expected places in ascending order")
        columns = 1 if self.y is None else len(self.y)
        if len(values) != len(self.x) or any(len(row) != columns for row in values):
            what = "one thickness" if self.y is None else f"a list of {columns} thicknesses, one for each y,"
            raise fault("values", f"expected {what} for each of the {len(self.x)} places along x")
        if min(map(min, values)) <= 0.0:
            raise fault("values", "expected thicknesses above 0")

    def profile(self, field: Profile | None = None) -> Profile:
        """The thickness as `fem` takes it; `field`: that of the mesh file, where it is one.

        Raises:
            ValueError: it is a field of the mesh file, which is not given.
        """
        if self.polynomial is not None:
            return Polynomial(self.polynomial)
        if self.values is not None:
            return Bilinear(self.x or (), self.y or (0.0,), self.values)
        if field is None:
            raise ValueError("a thickness from the mesh file needs the mesh")
        return field


def extremes(profile: float | Thickness, length: float, width: float) -> tuple[float, float]:
    """Least and greatest thickness [m] of a rectangle with these sides [m].

    Raises:
        ValueError: it is not above 0 all over the plate, or a table does not cover it.
    """
    if isinstance(profile, float):
        return profile, profile
    x, y = np.linspace(0.0, length, GRID), np.linspace(-0.5 * width, 0.5 * width, GRID)
    values = np.asarray(thickness_of(profile.profile(), np.stack(np.meshgrid(x, y, indexing="ij"))))
    return float(values.min()), float(values.max())


_THINNEST, _SLENDEREST = 1e4, 100.0
"""Largest ratios of the plate's extent to its thickness, and of its length to its width or the other way round."""

_LARGEST = 10.0
"""Side [m] from which, on a plate out of proportion, a number is more likely one of mm."""


def disproportion(least: float, greatest: float, length: float, width: float) -> tuple[str, str] | None:
    """The key of what is out of proportion, and the problem."""
    extent = max(length, width)
    if extent > _SLENDEREST * min(length, width):
        return "width", f"expected a width within a factor of {_SLENDEREST:g} of the length, {length:g} m"
    if greatest >= length:
        meant = f": a number without a unit is in m, was '{greatest:g} mm' meant?" if greatest >= 1 else ""
        return "thickness", f"expected less than the length, {length:g} m{meant}"
    if greatest > width * (1 + ROUNDING):
        return "thickness", f"expected at most the width, {width:g} m: z, through the thickness, is the thin side"
    if least < extent / _THINNEST:
        return "thickness", f"expected at least {extent / _THINNEST:.3g} m on a plate {extent:g} m large"
    return None


def in_millimetres(least: float, greatest: float, length: float, width: float) -> str:
    """A question where large sides, taken as millimetres, would be those of a plate; else nothing."""
    large = {name: side for name, side in (("length", length), ("width", width)) if side >= _LARGEST}
    scaled = (side * 1e-3 if side >= _LARGEST else side for side in (length, width))
    if not large or disproportion(least, greatest, *scaled) is not None:
        return ""
    name, side = next(iter(large.items()))
    return f"; {name} = {side:g} is in m: was '{side:g} mm' meant?"


_SOFTEST = 1e4
"""Modulus [Pa] below which a number is more likely one of GPa: gels end here, diamond has 1200 GPa."""


class Root(Table):
    """An elastic root: springs along the whole root edge in place of the clamp. Both stiffnesses are required."""

    stiffness: Annotated[q.LineStiffness, q.Positive]
    """stiffness against displacement in every direction, per length of the root"""
    rotational_stiffness: Annotated[q.RotationalStiffness, q.Positive]
    """stiffness against rotation of the root's section, per length of the root"""


VALUE, TABLE = Tag("[value]"), Tag("[table]")
"""Mark what a key holds among the errors that pydantic finds; no key of a scene has brackets."""

VALUE_OR_TABLE = Discriminator(lambda value: f"[{'table' if isinstance(value, Mapping | Table) else 'value'}]")
"""Of a key that holds either; what is wrong is said of the one that is there."""


class Plate(Table):
    """The plate, clamped at its root, the edge at the smallest x; x radial, y across, z through the thickness."""

    length: Annotated[q.Length, q.Positive] | None = None
    """along the radius, from the clamped root at x = 0"""
    width: Annotated[q.Length, q.Positive] | None = None
    """across, centred on y = 0"""
    thickness: Annotated[
        Annotated[Annotated[q.Length, q.Positive], VALUE] | Annotated[Thickness, TABLE], VALUE_OR_TABLE
    ]
    """through the plate, along z; or the table [plate.thickness] if it varies"""
    mesh: q.MeshFile | None = None
    """mid-surface mesh file, instead of length and width"""
    mesh_unit: q.LengthUnit | None = None
    """unit of the coordinates in the mesh file; default: m"""
    theory: Literal["auto", "kirchhoff", "mindlin", "solid"] = "auto"
    """plate theory; auto: the cheapest that meets [accuracy]"""
    tip_mass: Annotated[q.Mass, q.NotNegative] = 0.0
    """point mass at the damper's place; without [damper] in the middle of the tip, or at tip_mass_at"""
    tip_mass_at: q.LengthPair | None = None
    """place (x, y) of the tip mass where there is no [damper]; default: the middle of the tip"""

    root: Root | None = None
    """springs that support the root; default: it is clamped"""

    @model_validator(mode="after")
    def _planform(self) -> Self:
        """Either length and width, or a mesh; and thin enough to be called a plate."""
        if self.tip_mass_at is not None and not self.tip_mass:
            raise fault("tip_mass_at", "expected a tip_mass beside it")
        if self.mesh is None and not isinstance(self.thickness, float) and self.thickness.field:
            raise fault("thickness.field", "belongs to a mesh: name a mesh, or give a table or a polynomial")
        if self.mesh is None and self.mesh_unit is not None:
            raise fault("mesh_unit", "belongs to a mesh: leave this out, or name a mesh")
        for key in ("length", "width") if self.mesh is not None else ():
            if getattr(self, key) is not None:
                raise fault(key, "the mesh gives the planform: leave this out, or leave out mesh")
        if self.mesh is None:
            self._rectangle()
        return self

    def thickness_at(self, place: tuple[float, float], field: Profile | None = None) -> float:
        """The thickness [m] at a place (x, y) [m]; `field` as in :meth:`Thickness.profile`."""
        thickness = self.thickness
        return thickness if isinstance(thickness, float) else thickness.profile(field).near(place)

    def _rectangle(self) -> None:
        for key in ("length", "width"):
            if getattr(self, key) is None:
                raise fault(key, "missing (or name a mesh instead of length and width)")
        if self.length is not None and self.width is not None:
            try:
                least, greatest = extremes(self.thickness, self.length, self.width)
            except ValueError as error:
                raise fault("thickness", str(error)) from error
            odd = disproportion(least, greatest, self.length, self.width)
            if odd is not None:
                key, problem = odd
                raise fault(key, problem + in_millimetres(least, greatest, self.length, self.width))


def _either(schema: dict[str, Any]) -> None:
    """Of a material: its name, or the three numbers."""
    schema["oneOf"] = [{"required": ["name"]}, {"required": schema.pop("required")}]


class Material(Table, json_schema_extra=_either):
    """Linear, isotropic, homogeneous: three numbers, or the name of a known material."""

    name: Annotated[str, *q.name_of(materials.PLATES)] | None = None
    """name of a known material, instead of the numbers"""
    youngs_modulus: Annotated[q.Pressure, q.Positive]
    """E"""
    poissons_ratio: Annotated[q.Number, Field(gt=-1, lt=0.5)]
    """ν, dimensionless"""
    density: Annotated[q.Density, q.Positive]
    """ρ"""

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, data: Any) -> Any:
        return materials.with_numbers(data, "name", materials.PLATES, materials.NUMBERS)

    @model_validator(mode="after")
    def _sense(self) -> Self:
        """A modulus and a density that something solid has."""
        modulus = self.youngs_modulus
        if modulus < _SOFTEST * (1 - ROUNDING):
            meant = f": {modulus:g} is in Pa; was '{modulus:g} GPa' meant?" if modulus >= 0.1 else ""
            raise fault("youngs_modulus", f"expected at least {_SOFTEST:g} Pa, of the softest rubber{meant}")
        materials.check_density("density", self.density)
        return self
