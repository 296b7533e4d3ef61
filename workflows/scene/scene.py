"""The scene: what a user describes, as frozen, validated records in SI.

Each class is a table of the TOML file. What a value must be is beside it; what values must be together
is checked in :mod:`workflows.scene.checks`. The JSON Schema comes from these same classes.
"""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from fem.accuracy.budget import Budget
from workflows.scene import checks as scene_checks
from workflows.scene.damper import Damper, Release
from workflows.scene.design import Design
from workflows.scene.excitation import Excitation
from workflows.scene.fields import Line
from workflows.scene.plate import Material, Plate
from workflows.scene.rotor import Accuracy, Effects, Rotor, Structure
from workflows.scene.table import Table


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
    excitation: Excitation | None = Field(None, description="what shakes the structure, for `response`")
    accuracy: Accuracy = Field(Accuracy(), description="errors that are allowed")
    design: Design | None = Field(None, description="what `spindamp design` may choose; of no influence elsewhere")

    @model_validator(mode="before")
    @classmethod
    def _carrier(cls, data: Any) -> Any:
        return scene_checks.carrier(data)

    @model_validator(mode="after")
    def _together(self) -> Self:
        scene_checks.together(self)
        return self

    @property
    def budget(self) -> Budget:
        """What each cause may add to the errors allowed."""
        return Budget(self.accuracy.frequency, self.accuracy.damping)

    @property
    def point_mass(self) -> float:
        """What the plate carries at the damper's place [kg], the balls aside: tip mass and housing."""
        tip = 0.0 if self.plate is None else self.plate.tip_mass
        return tip + (0.0 if self.damper is None else self.damper.housing or 0.0)
