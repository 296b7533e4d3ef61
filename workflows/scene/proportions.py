"""What keeps a plate from being one: too thick, a film, a wire or a tape. Lengths are in m."""

from __future__ import annotations

from workflows.scene.faults import ROUNDING

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
