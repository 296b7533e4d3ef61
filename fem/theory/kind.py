"""The three kinds of plate theory; the name of one may say more after a slash: its element, its layers, its clamp."""

from __future__ import annotations

from enum import StrEnum


class Kind(StrEnum):
    """What a theory takes for a plate: a surface that only bends, one that shears too, or a body."""

    KIRCHHOFF = "kirchhoff"
    MINDLIN = "mindlin"
    SOLID = "solid"


def kind(theory: str) -> Kind:
    """The kind of a theory by its name.

    Raises:
        ValueError: for another name.
    """
    return Kind(theory.partition("/")[0])
