"""Whether what the tables of a scene describe fits together: the damper in its plate, the balls on what carries them.

Each check raises with the key to look at, ``table.key``; lengths are in m.
"""

from __future__ import annotations

import math

from workflows.scene import cavity
from workflows.scene.damper import HEAVIEST, Damper, Release
from workflows.scene.faults import ROUNDING, fault
from workflows.scene.materials import LIGHTEST
from workflows.scene.plate import Plate
from workflows.scene.thickness_table import thickness_at


def on_the_plate(plate: Plate, damper: Damper | None, release: Release | None) -> None:
    """Damper, tip mass and release are where the plate is. Where a mesh gives the planform, `plate_mesh` looks on."""
    if damper is not None and plate.tip_mass_at is not None:
        raise fault("plate.tip_mass_at", "the tip mass is at the damper's place: leave this out")
    if plate.length is not None and plate.width is not None:
        _on_a_rectangle(plate, (plate.length, plate.width), damper)
    elif damper is not None and isinstance(plate.thickness, float):
        _refused(cavity.through_the_thickness(damper, plate.thickness))
    if damper is not None:
        _number(damper, damper.balls)
    if release is not None and plate.length is not None:
        _displaced(release, plate.length, "the plate's length")


def _on_a_rectangle(plate: Plate, sides: tuple[float, float], damper: Damper | None) -> None:
    length, width = sides
    key, at = ("plate.tip_mass_at", plate.tip_mass_at) if damper is None else ("damper.at", damper.at)
    x, y = (length, 0.0) if at is None else at
    if not 0 < x <= length * (1 + ROUNDING) or abs(y) > width / 2 * (1 + ROUNDING):
        raise fault(key, f"outside the plate: expected x above 0 and at most {length:g} m, y within ±{width / 2:g} m")
    if damper is not None:
        _refused(cavity.misfit(damper, thickness_at(plate.thickness, (x, y)), width, x, width - 2 * abs(y)))


def _refused(odd: tuple[str, str] | None) -> None:
    """Raise what is odd about a damper, as key and problem."""
    if odd is not None:
        raise fault(f"damper.{odd[0]}", odd[1])


def _displaced(release: Release, most: float, what: str, slack: float = 0.0) -> None:
    if max(map(abs, release.displacement or (0.0,))) > most * (1 + slack):
        raise fault("release.displacement", f"expected at most {what}, {most:g} m")


def within(radius: float, damper: Damper, release: Release | None) -> None:
    """Ball, cavity and release that do not reach beyond the axis about which they turn, `radius` away."""
    most, distance = radius * (1 + ROUNDING), f"its distance from the axis, {radius:g} m"
    if damper.radius > most:
        raise fault("damper.radius", f"the ball is larger than {distance}")
    if max(damper.cavity) > most:
        raise fault("damper.cavity", f"the cavity is larger than {distance}")
    if release is not None:
        _displaced(release, radius, "the damper's distance from the axis", ROUNDING)


def weight(damper: Damper, structure: float) -> None:
    """Balls that the structure [kg] carries, not the other way round; of a plate that is known once it is solved."""
    if damper.balls is not None and damper.balls > HEAVIEST * structure:
        key = next(key for key in ("mass", "ball_material", "ball_density") if getattr(damper, key) is not None)
        raise fault(
            f"damper.{key}",
            f"expected balls of at most {HEAVIEST:g} times the structure's mass, {structure:g} kg; these weigh"
            f" {damper.balls:g} kg",
        )
    _number(damper, damper.balls if damper.mass_ratio is None else damper.mass_ratio * structure)


def _number(damper: Damper, mass: float | None) -> None:
    """No more balls than share their mass [kg], where it is known, and are each as heavy as foam at least."""
    if mass is None or damper.count == 1:
        return
    most = max(int(mass / (4 / 3 * math.pi * damper.radius**3 * LIGHTEST)), 1)
    if damper.count > most:
        raise fault(
            "damper.count",
            f"expected at most {most} of radius {damper.radius:g} m that weigh {mass:g} kg together: more would be"
            f" lighter than {LIGHTEST:g} kg/m^3, the lightest foam",
        )
