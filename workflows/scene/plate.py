"""The tables of the plate: [plate] with its thickness and root, [material]."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from workflows.scene import checks as scene_checks
from workflows.scene import materials, units
from workflows.scene.fields import (
    Coefficients,
    Density,
    Length,
    LengthPair,
    LengthRows,
    Lengths,
    LengthUnit,
    Line,
    LineStiffness,
    Mass,
    NotNegative,
    Number,
    Positive,
    Pressure,
    RotationalStiffness,
    name_of,
)
from workflows.scene.table import Table


class Thickness(Table):
    """A thickness that varies over the planform, symmetric about the flat mid-surface.

    A table over x and y, bilinear between its places; a polynomial in x and y; or a field of the mesh file. x and y are
    the plate's (the mesh file's, where there is one).
    """

    x: Lengths | None = Field(None, description="of a table: places along x, ascending")
    y: Lengths | None = Field(None, description="of a table: places across, ascending; left out: the same all across")
    values: LengthRows | None = Field(None, description="of a table: for each x a list of the thicknesses at each y")
    polynomial: Coefficients | None = Field(
        None, description="coefficients of x^i y^j, number j in list i; numbers without a unit are in powers of m"
    )
    field: Line | None = Field(
        None, description="point data of the mesh file, in the unit of its coordinates, linear between its points"
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        scene_checks.thickness(self)
        return self


class Root(Table):
    """An elastic root: springs all along the root edge in place of the clamp. Without both the plate would be loose."""

    stiffness: Annotated[LineStiffness, Positive] = Field(
        description="against displacement in every direction, per length of the root"
    )
    rotational_stiffness: Annotated[RotationalStiffness, Positive] = Field(
        description="against rotation of the root's section, per length of the root"
    )


_VARYING = "[varying]"
"""Marks a thickness that is a table among the errors that pydantic finds; no key of a scene has brackets."""


def _kind_of_thickness(value: Any) -> str:
    return _VARYING if isinstance(value, Mapping | Thickness) else "[constant]"


class Plate(Table):
    """The plate, held at its root, the edge at the smallest x; x radial, y across, z through the thickness."""

    length: Annotated[Length, Positive] | None = Field(
        None, description="along the radius, from the clamped root at x = 0"
    )
    width: Annotated[Length, Positive] | None = Field(None, description="across, centred on y = 0")
    thickness: Annotated[
        Annotated[Annotated[Length, Positive], Tag("[constant]")] | Annotated[Thickness, Tag(_VARYING)],
        Discriminator(_kind_of_thickness),
    ] = Field(description="through the plate, along z; or the table [plate.thickness], where it varies")
    mesh: Line | None = Field(None, description="mid-surface mesh file, instead of length and width")
    mesh_unit: LengthUnit | None = Field(None, description="unit of the coordinates in the mesh file; default: m")
    theory: Literal["auto", "kirchhoff", "mindlin", "solid"] = Field(
        "auto", description="plate theory; auto: the cheapest that is as exact as [accuracy] asks"
    )
    tip_mass: Annotated[Mass, NotNegative] = Field(0.0, description="point mass at the damper's place")
    tip_mass_at: LengthPair | None = Field(
        None, description="place (x, y) of the tip mass where there is no [damper]; default: the middle of the tip"
    )

    root: Root | None = Field(None, description="springs that hold the root; left out: it is clamped")

    @model_validator(mode="after")
    def _planform(self) -> Self:
        scene_checks.planform(self)
        return self

    @property
    def mesh_scale(self) -> float:
        """Metres to the unit of the mesh file."""
        return 1.0 if self.mesh_unit is None else units.to_si(f"1 {self.mesh_unit}", units.LENGTH)


_NUMBERS = ("youngs_modulus", "poissons_ratio", "density")


def _either(schema: dict[str, Any]) -> None:
    """Of a material: its name, or the three numbers."""
    schema["oneOf"] = [{"required": ["name"]}, {"required": schema.pop("required")}]


class Material(Table):
    """Linear, isotropic, homogeneous: three numbers, or the name of a material that has them."""

    model_config = ConfigDict(json_schema_extra=_either)

    name: Annotated[str, *name_of(materials.PLATES)] | None = Field(
        None, description="a material whose numbers are known, instead of the numbers"
    )
    youngs_modulus: Annotated[Pressure, Positive] = Field(description="E")
    poissons_ratio: Annotated[Number, Field(gt=-1, lt=0.5)] = Field(description="ν, dimensionless")
    density: Annotated[Density, Positive] = Field(description="ρ")

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, data: Any) -> Any:
        return scene_checks.filled(data, "name", materials.PLATES, _NUMBERS)

    @model_validator(mode="after")
    def _sense(self) -> Self:
        scene_checks.material(self)
        return self
