"""The scene: what a user describes, as frozen, validated records in SI.

Each class is a table of the TOML file. What a value must be is beside it; what values must be together
is checked in :mod:`workflows.scene.checks`. The JSON Schema comes from these same classes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from workflows.scene import checks as scene_checks
from workflows.scene import materials, units
from workflows.scene.fields import (
    Acceleration,
    Angle,
    Coefficients,
    Cycles,
    Density,
    Frequency,
    Length,
    LengthPair,
    LengthRows,
    Lengths,
    LengthUnit,
    Line,
    LineStiffness,
    LoadPair,
    Mass,
    NotNegative,
    Number,
    Positive,
    Pressure,
    RotationalStiffness,
    Speeds,
    Switch,
    name_of,
)


class Table(BaseModel):
    """A table of the scene: frozen, strict, no unknown keys."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", validate_default=False)


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


class Structure(Table):
    """What the damper sitting on it needs to know, instead of a plate."""

    frequency: Annotated[Frequency, Positive] = Field(description="ω1 / 2π, with the ball stuck")
    mass: Annotated[Mass, Positive] = Field(description="M2: effective mass at the damper, without the ball")


class Rotor(Table):
    """How the structure spins."""

    speeds: Speeds = Field(description="rotation speeds: a list, or count of them from start to stop")
    hub_radius: Annotated[Length, NotNegative] = Field(
        0.0, description="from the axis to the clamped root, wherever a mesh draws the root"
    )
    radius: Annotated[Length, Positive] | None = Field(
        None, description="from the axis to the damper; only with [structure]"
    )
    stagger: Angle = Field(0.0, description="spin axis tilted from the plate's normal towards y")
    precone: Angle = Field(
        0.0, description="of the plate's length out of the plane of rotation, towards the axis; after the stagger"
    )
    gravity: Annotated[Acceleration, Positive] = Field(
        units.STANDARD_GRAVITY, description="the unit g of loads and accelerations"
    )
    modes: Annotated[int, Field(ge=1, le=200)] = Field(6, description="number of modes at each speed")

    @model_validator(mode="after")
    def _sense(self) -> Self:
        scene_checks.rotor(self)
        return self


class Effects(Table):
    """Which effects to simulate: "auto" (when the scene calls for it), true or false."""

    stress_stiffening: Switch = Field(default="auto", description="the centrifugal pull stiffens the plate")
    spin_softening: Switch = Field(default="auto", description="motion across the spin axis is softened")
    coriolis: Switch = Field(default="auto", description="Coriolis forces; the modes are complex")
    large_deflection: Switch = Field(default="auto", description="modes about the plate as the load bends or twists it")
    rotary_inertia: Switch = Field(default="auto", description="inertia of the turning cross-sections")
    rolling_resistance: Switch = Field(default="auto", description="the load resists the ball's rolling")
    impact_friction: Switch = Field(default="auto", description="friction where the ball hits a wall")
    ball_slip: Switch = Field(default="auto", description="slip after a wall hit, until the ball rolls again")


class Damper(Table):
    """Equal balls, each in a cavity of its own, moving in step.

    Its axes lie in the cavity's floor, which faces the spin axis: 1 through the plate's thickness (its z), along which
    it bends, and 2 across (its y).
    """

    at: LengthPair | None = Field(
        None,
        description="place (x, y) on the plate, in the plate's axes (those of a mesh file, where there is one);"
        " default: the middle of the tip",
    )
    mass_ratio: Annotated[Number, Positive, Field(le=1e9)] | None = Field(
        None, description="mass of all balls together over the effective mass M2, dimensionless"
    )
    mass: Annotated[Mass, Positive] | None = Field(None, description="mass of all balls together")
    ball_density: Annotated[Density, Positive] | None = Field(
        None, description="of each ball: all together then weigh count (4/3) π radius³ times as much"
    )
    ball_material: Annotated[str, *name_of(materials.BALLS)] | None = Field(
        None, description="a material whose density is known, instead of ball_density"
    )
    count: Annotated[int, Field(ge=1, le=10**9)] = Field(
        1, description="number of balls: equal, each in a cavity of its own, moving in step"
    )
    radius: Annotated[Length, Positive] = Field(description="of a ball; half its diameter")
    cavity: LengthPair = Field(
        description="sides in the damper's axes: 1 along the bending direction (through the thickness), 2 across;"
        " along the radius the cavity holds the ball"
    )
    housing: Annotated[Mass, Positive] | None = Field(
        None,
        description="mass of what holds the cavity where it stands out of the plate, a point mass at the damper's"
        " place; without it the cavity must fit the plate",
    )
    restitution: Annotated[Number, Field(ge=0, le=1)] = Field(description="e of a wall hit, dimensionless")
    friction: Annotated[Number, NotNegative, Field(le=1e6)] = Field(description="μ of a wall hit, dimensionless")
    rolling_friction: Annotated[Length, NotNegative] = Field(description="μ_r, a length")
    formulation: Literal["consistent", "printed"] = Field(
        "consistent", description="equations that keep Newton's third law, or the paper's as printed"
    )
    damping_ratio: Annotated[Number, Field(ge=0, lt=1)] = Field(
        0.0, description="ζ of the structure itself, dimensionless"
    )
    sticking_ratio: Annotated[Number, Field(gt=0, lt=1)] = Field(
        1e-2, description="ε: a ball sticks to a wall below this part of the structure's velocity, dimensionless"
    )

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, data: Any) -> Any:
        return scene_checks.filled(data, "ball_material", materials.BALLS, ("ball_density",))

    @model_validator(mode="after")
    def _sense(self) -> Self:
        scene_checks.damper(self)
        return self

    @property
    def balls(self) -> float | None:
        """Mass of all balls together [kg]; None where it is a ratio."""
        if self.ball_density is None:
            return self.mass
        return self.count * 4 / 3 * math.pi * self.radius**3 * self.ball_density


class Release(Table):
    """How the structure is let go: from rest, displaced."""

    displacement: LengthPair | None = Field(
        None, description="at release, in the damper's axes: 1 along the bending direction, 2 across"
    )
    acceleration: LoadPair | None = Field(None, description="of the structure at release, in the damper's axes")
    ratio: Annotated[Number, Positive, Field(le=1e9)] | None = Field(
        None, description="acceleration along the damper's axis 1 over the centrifugal load, dimensionless"
    )
    cycles: Cycles = Field("auto", description="number of vibration cycles; auto: until the ball rests for good")

    @model_validator(mode="after")
    def _one(self) -> Self:
        scene_checks.release(self)
        return self


class Accuracy(Table):
    """Relative errors asked for."""

    frequency: Annotated[Number, Field(gt=0, lt=1)] = Field(
        default=1e-3, description="relative error of the plate's frequencies, dimensionless"
    )
    damping: Annotated[Number, Field(gt=0, lt=1)] = Field(
        default=1e-3, description="relative error of the damping, dimensionless"
    )


class Scene(Table):
    """A whole scene: a plate or a structure, a rotor, and perhaps a damper."""

    title: Annotated[Line, Field(max_length=200)] = Field("untitled", description="for people; one line")
    plate: Plate | None = Field(None, description="the plate")
    material: Material | None = Field(None, description="what the plate is made of")
    structure: Structure | None = Field(None, description="what carries the damper, instead of a plate")
    rotor: Rotor = Field(description="how it spins")
    effects: Effects = Field(Effects(), description="which effects are simulated")
    damper: Damper | None = Field(None, description="balls in cavities; left out, with [release], for the plate alone")
    release: Release | None = Field(None, description="how a ring-down begins")
    accuracy: Accuracy = Field(Accuracy(), description="errors that are allowed")

    @model_validator(mode="after")
    def _together(self) -> Self:
        scene_checks.together(self)
        return self

    @property
    def point_mass(self) -> float:
        """What the plate carries at the damper's place [kg], the balls aside: tip mass and housing."""
        tip = 0.0 if self.plate is None else self.plate.tip_mass
        return tip + (0.0 if self.damper is None else self.damper.housing or 0.0)
