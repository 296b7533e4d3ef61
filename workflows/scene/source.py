"""A scene and where it came from."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from workflows.scene.scene import Scene
from workflows.scene.table import Table


@dataclass(frozen=True)
class SceneFile:
    """A scene and where it came from: `name` for messages, `folder` for the files it names.

    `remarks` are on how it is written, and lost where it becomes a `Scene`; `written`: its tables as they were written.
    """

    scene: Scene
    name: str
    folder: Path
    remarks: tuple[str, ...] = ()
    written: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def mesh(self) -> Path | None:
        """The mesh file the plate names, relative to the scene's folder."""
        plate = self.scene.plate
        return None if plate is None or plate.mesh is None else self.folder / plate.mesh

    @cached_property
    def mesh_sha256(self) -> str | None:
        """SHA-256 of the mesh file's bytes, where the plate names one; read once."""
        if self.mesh is None:
            return None
        with self.mesh.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()

    def plate_alone(self) -> SceneFile:
        """The same without the damper; a housing stays, a part of the point mass at the damper's place."""
        plate, damper, mass = self.scene.plate, self.scene.damper, self.scene.point_mass
        if plate is not None and damper is not None and mass:
            plate = plate.model_copy(update={"tip_mass": mass, "tip_mass_at": damper.at})
        return self.changed(plate=plate, damper=None, release=None)

    def changed(self, **tables: Table | None) -> SceneFile:
        """The same scene with some of its tables replaced."""
        return replace(self, scene=self.scene.model_copy(update=tables))
