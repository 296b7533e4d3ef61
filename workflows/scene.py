"""The scene: what a user describes, as frozen, validated records in SI.

Each class is a table of the TOML file. What a value must be is beside it; what values must be together
is checked in :mod:`workflows.scene_checks`. The JSON Schema comes from these same classes.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from workflows import scene_checks, units
from workflows.scene_fields import (
    Acceleration,
    Angle,
    Cycles,
    Density,
    Frequency,
    Length,
    LengthPair,
    Line,
    LoadPair,
    Mass,
    NotNegative,
    Number,
    Positive,
    Pressure,
    Speeds,
    Switch,
)


class Table(BaseModel):
    """A table of the scene: frozen, strict, no unknown keys."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", validate_default=False)


class Plate(Table):
    """The plate, clamped at the root x = 0; x radial, y across, z through the thickness."""

    length: Annotated[Length, Positive] | None = Field(None, description="radial, from the clamped root")
    width: Annotated[Length, Positive] | None = Field(None, description="across, centred on y = 0")
    thickness: Annotated[Length, Positive]
    mesh: Line | None = Field(None, description="mid-surface mesh file, instead of length and width")
    theory: Literal["auto", "kirchhoff", "mindlin", "solid"] = "auto"
    tip_mass: Annotated[Mass, NotNegative] = Field(0.0, description="point mass at the damper's place")

    @model_validator(mode="after")
    def _planform(self) -> Self:
        scene_checks.planform(self)
        return self


class Material(Table):
    """Linear, isotropic, homogeneous."""

    youngs_modulus: Annotated[Pressure, Positive]
    poissons_ratio: Annotated[Number, Field(gt=-1, lt=0.5)]
    density: Annotated[Density, Positive]

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

    speeds: Speeds
    hub_radius: Annotated[Length, NotNegative] = Field(0.0, description="from the axis to the clamped root")
    radius: Annotated[Length, Positive] | None = Field(
        None, description="from the axis to the damper; only with [structure]"
    )
    stagger: Angle = Field(0.0, description="spin axis tilted from the plate's normal towards y")
    gravity: Annotated[Acceleration, Positive] = Field(
        units.STANDARD_GRAVITY, description="the unit g of loads and accelerations"
    )
    modes: Annotated[int, Field(ge=1, le=200)] = 6

    @model_validator(mode="after")
    def _sense(self) -> Self:
        scene_checks.rotor(self)
        return self


class Effects(Table):
    """Which effects to simulate: "auto" (when the scene calls for it), true or false."""

    stress_stiffening: Switch = "auto"
    spin_softening: Switch = "auto"
    coriolis: Switch = "auto"
    large_deflection: Switch = "auto"
    rotary_inertia: Switch = "auto"
    rolling_resistance: Switch = "auto"
    impact_friction: Switch = "auto"
    ball_slip: Switch = "auto"


class Damper(Table):
    """Equal balls, each in a cavity of its own, moving in step."""

    at: LengthPair | None = Field(None, description="place on the plate; default: the middle of the tip")
    mass_ratio: Annotated[Number, Positive, Field(le=1e9)] | None = Field(None, description="all balls over M2")
    mass: Annotated[Mass, Positive] | None = Field(None, description="all balls together")
    count: Annotated[int, Field(ge=1, le=10**9)] = 1
    radius: Annotated[Length, Positive]
    cavity: LengthPair
    restitution: Annotated[Number, Field(ge=0, le=1)] = Field(description="e of a wall hit")
    friction: Annotated[Number, NotNegative, Field(le=1e6)] = Field(description="μ of a wall hit")
    rolling_friction: Annotated[Length, NotNegative] = Field(description="μ_r, a length")
    formulation: Literal["consistent", "printed"] = "consistent"
    damping_ratio: Annotated[Number, Field(ge=0, lt=1)] = Field(0.0, description="ζ of the structure itself")
    sticking_ratio: Annotated[Number, Field(gt=0, lt=1)] = Field(1e-2, description="ε")

    @model_validator(mode="after")
    def _sense(self) -> Self:
        scene_checks.damper(self)
        return self


class Release(Table):
    """How the structure is let go: from rest, displaced."""

    displacement: LengthPair | None = None
    acceleration: LoadPair | None = Field(None, description="of the structure at release, on each axis")
    ratio: Annotated[Number, Positive, Field(le=1e9)] | None = Field(
        None, description="acceleration along x over the centrifugal load"
    )
    cycles: Cycles = "auto"

    @model_validator(mode="after")
    def _one(self) -> Self:
        scene_checks.release(self)
        return self


class Accuracy(Table):
    """Relative errors asked for."""

    frequency: Annotated[Number, Field(gt=0, lt=1)] = 1e-3
    damping: Annotated[Number, Field(gt=0, lt=1)] = 1e-3


class Scene(Table):
    """A whole scene: a plate or a structure, a rotor, and perhaps a damper."""

    title: Annotated[Line, Field(max_length=200)] = "untitled"
    plate: Plate | None = None
    material: Material | None = None
    structure: Structure | None = None
    rotor: Rotor
    effects: Effects = Effects()
    damper: Damper | None = None
    release: Release | None = None
    accuracy: Accuracy = Accuracy()

    @model_validator(mode="after")
    def _together(self) -> Self:
        scene_checks.together(self)
        return self
