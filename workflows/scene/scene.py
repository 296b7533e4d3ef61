"""The scene: what a user describes, as frozen, validated records in SI.

Each class is a table of the TOML file, in a module with its checks: what a value must be, and what the values of a
table must be together. Which tables belong together is checked here. The JSON Schema comes from these same classes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from fem.accuracy.tolerances import Budget
from workflows.scene import fitting
from workflows.scene.damper import Damper, Release
from workflows.scene.design import Design
from workflows.scene.excitation import Excitation
from workflows.scene.faults import fault
from workflows.scene.fields import Line
from workflows.scene.plate import Material, Plate
from workflows.scene.rotor import Accuracy, Effects, Rotor, Structure
from workflows.scene.table import Table

_OF_A_PLATE = {
    "rotor.hub_radius": "a [structure] takes radius alone",
    "rotor.stagger": "a [structure] takes radius alone",
    "rotor.precone": "a [structure] takes radius alone",
    "rotor.modes": "the one frequency of a [structure] is given",
    "accuracy.frequency": "the one frequency of a [structure] is given",
    "excitation.pressure": "a [structure] takes force or base",
    "damper.at": "a [structure] takes [rotor] radius",
    "damper.housing": "the mass of a [structure] includes it",
}
"""Keys that a scene without a plate leaves as they are, and why."""


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
        """A plate or a structure, before either is looked at: what one lacks is not asked for because of the other."""
        if isinstance(data, Mapping) and data.get("structure") is not None:
            if data.get("plate") is not None and set(data["structure"]) == {"floor_tilt"}:
                raise fault(
                    "structure.floor_tilt", "the floor on a plate tilts by what the plate bends: leave this out"
                )
            for table in ("plate", "material"):
                if data.get(table) is not None:
                    raise fault(table, "expected a plate with its material or a [structure]: leave one out")
        return data

    @model_validator(mode="after")
    def _together(self) -> Self:
        """Which tables belong together, which exclude each other, and whether what they describe fits together."""
        if self.structure is not None:
            self._without_a_plate(self.structure)
        else:
            self._with_a_plate()
        self._with_a_damper()
        if self.design is not None and self.design.amplitude is None and self.excitation is None:
            raise fault(
                "design.amplitude",
                "missing: the range over which the least damping counts (or give [excitation] instead)",
            )
        if self.plate is not None:
            fitting.on_the_plate(self.plate, self.damper, self.release)
        if self.damper is not None and (radius := self._turning_at) is not None:
            fitting.within(radius, self.damper, None if self.plate is not None else self.release)
        if self.release is not None and self.release.ratio is not None and not any(self.rotor.speeds):
            raise fault("release.ratio", "at rest there is no load, and a ratio of it releases nothing")
        return self

    def _with_a_plate(self) -> None:
        for table in ("plate", "material"):
            if getattr(self, table) is None:
                raise fault(table, "the table is missing (or give [structure] instead of a plate)")
        if self.rotor.radius is not None:
            raise fault("rotor.radius", "belongs to a [structure]; a plate takes hub_radius and [damper] at")

    def _with_a_damper(self) -> None:
        if (self.damper is None) != (self.release is None):
            missing, present = ("release", "damper") if self.release is None else ("damper", "release")
            raise fault(missing, f"the table is missing: [{present}] needs it")
        if self.damper is not None and self.rotor.precone:
            raise fault(
                "rotor.precone",
                "the load then slopes along the cavity's floor, which the damper's model has not: expected 0, or the"
                " plate alone, without [damper] and [release] (tip_mass and tip_mass_at stay)",
            )

    def _without_a_plate(self, structure: Structure) -> None:
        if self.damper is None:
            raise fault("damper", "the table is missing: a [structure] alone has nothing to solve")
        if self.rotor.radius is None:
            raise fault("rotor.radius", "missing: a [structure] needs the radius at which the damper turns")
        self._tilt(self.damper, structure.floor_tilt)
        fitting.weight(self.damper, structure.mass)
        for key, instead in _OF_A_PLATE.items():
            table, name = key.split(".")
            given = getattr(self, table)
            if given is not None and getattr(given, name) != type(given).model_fields[name].default:
                raise fault(key, f"belongs to a plate; {instead}")

    def _tilt(self, damper: Damper, tilt: tuple[float, float]) -> None:
        if max(map(abs, tilt)) * damper.radius >= 1:
            raise fault("structure.floor_tilt", f"expected less than 1 / radius of the ball, {1 / damper.radius:g} 1/m")
        if any(tilt) and damper.formulation == "printed":
            raise fault("structure.floor_tilt", "the printed equations know a level floor only: leave this out")
        if not any(tilt) and self.effects.floor_tilt is True:
            raise fault("effects.floor_tilt", "structure.floor_tilt is 0: give the slope, or leave this out")

    @property
    def _turning_at(self) -> float | None:
        """The damper's distance from the axis [m]; None where it is known only once a mesh is read."""
        if self.plate is None:
            return self.rotor.radius
        at = self.damper.at if self.damper is not None else None
        x = self.plate.length if at is None else at[0]
        return None if self.plate.length is None or x is None else self.rotor.hub_radius + x

    @property
    def budget(self) -> Budget:
        """What each cause may add to the errors allowed."""
        return Budget(self.accuracy.frequency, self.accuracy.damping)

    @property
    def point_mass(self) -> float:
        """What the plate carries at the damper's place [kg], the balls aside: tip mass and housing."""
        tip = 0.0 if self.plate is None else self.plate.tip_mass
        return tip + (0.0 if self.damper is None else self.damper.housing or 0.0)
