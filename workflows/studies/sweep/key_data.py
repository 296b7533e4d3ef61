"""A scene as plain data that keys can be put into, and what must be solved anew where a key differs."""

from __future__ import annotations

from collections.abc import Sequence

from workflows.scene.scene import Scene
from workflows.studies.sweep.keys import SPEEDS, Data, Key


def plain(scene: Scene) -> Data:
    """A scene as plain data that keys can be put into: a material by its name or by its numbers, not by both."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"design"})
    if "name" in data.get("material", {}):
        data["material"] = {"name": data["material"]["name"]}
    if "ball_material" in data.get("damper", {}):
        data["damper"].pop("ball_density", None)
    return data


def written_out(data: Data, keys: Sequence[Key]) -> Data:
    """The data with a plate's material in numbers where one of these is varied."""
    from workflows.scene.materials import KNOWN

    name = data.get("material", {}).get("name")
    numbers = {key.field for key in keys if key.table == ("material",)} - {"name"}
    if name is None or not numbers:
        return data
    names = ("youngs_modulus", "poissons_ratio", "density")
    return data | {"material": {number: getattr(KNOWN[name], number) for number in names}}


_OF_THE_MASS = {"mass_ratio", "mass", "ball_density", "ball_material", "count", "radius"}


def of_the_plate(key: Key) -> bool:
    """Whether a plate must be solved anew where this key differs."""
    if key.table[0] in ("damper", "release"):
        return key.table[0] == "damper" and key.field in ("at", "housing")
    return key.name != SPEEDS


def of_the_mass(key: Key) -> bool:
    """Whether the ball's mass may differ where this key does."""
    return key.table == ("damper",) and key.field in _OF_THE_MASS
