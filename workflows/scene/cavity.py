"""Whether ball and cavity fit the plate, and how they lie in it.

The load presses the ball outwards, along the plate's x, onto the cavity's floor, which is perpendicular to x. On it the
ball rolls along two axes, those of the damper: 1 through the thickness (z), the direction in which the plate bends, and
2 across (y). Side 1 of the cavity therefore has the thickness for room and side 2 the width; along x the ball takes its
diameter. What does not fit stands out of the plate: that takes a housing, and a housing has a mass.

Misfits are returned as key and problem; lengths are in m.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from workflows.scene.faults import ROUNDING

if TYPE_CHECKING:
    from workflows.scene.damper import Damper

_FOIL = 1e-5 * 1000.0
"""Mass per area [kg/m^2] of foil 0.01 mm thick, of density 1000 kg/m^3."""

PICTURE = """\
  z, bending                       The plate's axes: x outwards along the radius,
  ^   +----------------------+     y across, z through the thickness.
  |   |       +-----+        |     [damper] at is a place (x, y) on the plate.
  |   |       |  o  |        |     The damper's axes lie in the cavity's floor:
  |   +-------+-----+--------+     1 along z (bending): cavity[0], displacement[0]
  +----------------------> y       2 along y (across):  cavity[1], displacement[1]
  the plate's section at the damper, seen along x; the load presses the ball o outwards, on the floor"""
"""How plate and damper lie to each other, for `spindamp check`."""


def through_the_thickness(damper: Damper, thickness: float) -> tuple[str, str] | None:
    """Side 1 leaves a wall on either side of it."""
    if damper.housing or damper.cavity[0] < thickness * (1 - ROUNDING):
        return None
    return "cavity", (
        f"side 1 lies along the bending direction, through the plate's thickness: expected less than {_mm(thickness)},"
        " or housing = the mass of what stands out of the plate"
    )


def in_the_plane(damper: Damper, reach: float, room: float) -> tuple[str, str] | None:
    """Ball and side 2 lie in the plate: `reach` is from the root to the damper's place, `room` the width there.

    The width counts as far as it lies on both sides of the place alike.
    """
    if 2 * damper.radius >= reach * (1 - ROUNDING):
        return "radius", f"the ball does not fit between the root and its place: expected less than {_mm(reach / 2)}"
    if damper.housing or damper.cavity[1] < room * (1 - ROUNDING):
        return None
    if room <= ROUNDING * reach:
        return "at", (
            "on the plate's edge there is no room for a cavity: expected a place further in, or housing = the mass of"
            " what stands out of the plate"
        )
    return "cavity", (
        f"side 2 lies across the plate: expected less than {_mm(room)}, the room at its place, another place (at),"
        " or housing = the mass of what stands out of the plate"
    )


def beside(damper: Damper, thickness: float, width: float) -> int:
    """How many cavities, wall to wall, lie side by side in a section of the plate; at least one."""
    layers, across = int(thickness / damper.cavity[0] + ROUNDING), int(width / damper.cavity[1] + ROUNDING)
    return max(layers, 1) * max(across, 1)


def side_by_side(damper: Damper, thickness: float, width: float, reach: float) -> tuple[str, str] | None:
    """The cavities of all balls lie between the root and the damper's place, in as many rows as it takes."""
    most = beside(damper, thickness, width) * int(reach / (2 * damper.radius) + ROUNDING)
    if damper.housing or damper.count <= most:
        return None
    return "count", (
        f"no more than {most} cavities of this size lie in the plate between its root and the damper's place: expected"
        " fewer, or housing = the mass of what stands out of the plate"
    )


def housing_too_light(damper: Damper) -> tuple[str, str] | None:
    """No housing weighs less than foil over the two open faces of each cavity, as light as plastic."""
    faces = 2 * 2 * damper.radius * damper.cavity[1] * damper.count
    least = _FOIL * faces
    if damper.housing is None or damper.housing >= least:
        return None
    return "housing", f"lighter than plastic foil of 0.01 mm over the open faces: expected at least {1e3 * least:.2g} g"


def misfit(damper: Damper, thickness: float, width: float, reach: float, room: float) -> tuple[str, str] | None:
    """The first misfit of a damper in a plate; see `in_the_plane` for `reach` and `room`."""
    return (
        through_the_thickness(damper, thickness)
        or in_the_plane(damper, reach, room)
        or side_by_side(damper, thickness, width, reach)
        or housing_too_light(damper)
    )


def _mm(length: float) -> str:
    return f"{1e3 * length:.6g} mm"
