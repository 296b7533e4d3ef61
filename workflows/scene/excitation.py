"""The table of what shakes the structure: [excitation]."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from workflows.scene import checks as scene_checks
from workflows.scene.fields import Forces, Loads, Orders, Pressures
from workflows.scene.table import Table


class Excitation(Table):
    """Harmonic forces whose frequency is a multiple of the rotation's, at one level or several."""

    orders: Orders = Field(
        description="engine orders, frequency over that of the rotation: whole numbers, dimensionless"
    )
    force: Forces | None = Field(
        None,
        description="height of a force at the damper's place along the damper's axis 1: a level, or a list of them",
    )
    pressure: Pressures | None = Field(
        None, description="height of a pressure all over the plate, along its z: a level, or a list of them"
    )
    base: Loads | None = Field(
        None,
        description="height of the root's acceleration along the damper's axis 1: a level, or a list of them;"
        " amplitudes are then relative to the root",
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        scene_checks.excitation(self)
        return self

    @property
    def kind(self) -> str:
        """Which of force, pressure and base it is."""
        return next(name for name in ("force", "pressure", "base") if getattr(self, name) is not None)

    @property
    def levels(self) -> tuple[float, ...]:
        """Heights, ascending [N, Pa or m/s²]."""
        found: tuple[float, ...] = getattr(self, self.kind)
        return tuple(sorted(found))

    @property
    def unit(self) -> str:
        """Of the levels."""
        return {"force": "N", "pressure": "Pa", "base": "m/s²"}[self.kind]
