"""The tables of the plate: [plate] with its thickness and root, [material]."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from workflows.scene import materials, quantities
from workflows.scene.quantities import (
    ROUNDING,
    Density,
    Length,
    LengthPair,
    LengthUnit,
    Line,
    LineStiffness,
    Mass,
    NotNegative,
    Number,
    Positive,
    Pressure,
    RotationalStiffness,
    Table,
    fault,
    name_of,
)
from workflows.scene.thickness_table import Thickness, extremes

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
        return "thickness", f"expected less than the length, {length:g} m"
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
        """Either length and width, or a mesh; and thin enough to be called a plate."""
        if self.tip_mass_at is not None and not self.tip_mass:
            raise fault("tip_mass_at", "expected a tip_mass beside it")
        if self.mesh is None and not isinstance(self.thickness, float) and self.thickness.field:
            raise fault("thickness.field", "belongs to a mesh: name a mesh, or give a table or a polynomial")
        if self.mesh is None and self.mesh_unit is not None:
            raise fault("mesh_unit", "belongs to a mesh: leave this out, or name a mesh")
        if self.mesh is None:
            self._rectangle()
        else:
            self._from_a_file(self.mesh)
        return self

    def _from_a_file(self, mesh: str) -> None:
        for key in ("length", "width"):
            if getattr(self, key) is not None:
                raise fault(key, "the mesh gives the planform: leave this out, or leave out mesh")
        if not mesh.strip() or "\0" in mesh:
            raise fault("mesh", "expected the name of a mesh file")

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

    @property
    def mesh_scale(self) -> float:
        """Metres to the unit of the mesh file."""
        return 1.0 if self.mesh_unit is None else quantities.to_si(f"1 {self.mesh_unit}", quantities.LENGTH)


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
        return materials.filled(data, "name", materials.PLATES, _NUMBERS)

    @model_validator(mode="after")
    def _sense(self) -> Self:
        """A modulus and a density that something solid has."""
        modulus = self.youngs_modulus
        if modulus < _SOFTEST * (1 - ROUNDING):
            meant = f": {modulus:g} is in Pa; was '{modulus:g} GPa' meant?" if modulus >= 0.1 else ""
            raise fault("youngs_modulus", f"expected at least {_SOFTEST:g} Pa, of the softest rubber{meant}")
        materials.dense_enough("density", self.density)
        return self
