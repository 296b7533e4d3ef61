"""What the values of a scene must be together; each check raises with the key to look at."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError

from workflows.scene import cavity, thicknesses
from workflows.scene.materials import KNOWN

if TYPE_CHECKING:
    from workflows.scene.damper import Damper, Release
    from workflows.scene.excitation import Excitation
    from workflows.scene.plate import Material, Plate, Thickness
    from workflows.scene.rotor import Rotor
    from workflows.scene.scene import Scene

_ROUNDING = 1e-9
"""Relative slack of comparisons between lengths, which come from decimal text."""

_THINNEST, _SLENDEREST = 1e4, 100.0
"""Largest ratios of the plate's extent to its thickness, and of its length to its width or the other way round."""


_LIGHTEST = 10.0
"""Density [kg/m^3] below which a number is more likely one of g/cm^3: foams begin here, metals in g/cm^3 end at 23."""

HEAVIEST = 10.0
"""Mass of all balls over the structure's up to which they damp it, and are not what is damped."""

_SOFTEST = 1e4
"""Modulus [Pa] below which a number is more likely one of GPa: gels end here, diamond has 1200 GPa."""

_LARGEST = 10.0
"""Side [m] from which, on a plate out of proportion, a number is more likely one of mm."""

OSMIUM = 22_600.0
"""Density [kg/m^3] of the densest element."""


def fault(key: str, problem: str) -> PydanticCustomError:
    """An error at `key` (relative to the table, or ``table.key`` for the whole scene)."""
    return PydanticCustomError("together", "{problem}", {"problem": problem, "key": key})


def filled(data: Any, name: str, names: tuple[str, ...], numbers: tuple[str, ...]) -> Any:
    """A table with the numbers of the material that its key `name` holds; as it is where there is none (of `names`)."""
    if not isinstance(data, Mapping) or data.get(name) is None:
        return data
    for number in numbers:
        if number in data:
            raise fault(number, f"{name} gives it: leave one out")
    if not isinstance(data[name], str) or data[name] not in names:
        return data
    return {**data, **{number: getattr(KNOWN[data[name]], number.removeprefix("ball_")) for number in numbers}}


def thickness(thickness: Thickness) -> None:
    """One way of giving a thickness that varies, and a table whose parts fit together."""
    given = [key for key in ("values", "polynomial", "field") if getattr(thickness, key) is not None]
    if len(given) != 1:
        raise fault(
            given[-1] if given else "values",
            f"expected one of a table (x, y, values), a polynomial and a field of the mesh file"
            f"{': leave one out' * bool(given)}",
        )
    x, y, values = thickness.x, thickness.y, thickness.values
    if values is None:
        for key in ("x", "y"):
            if getattr(thickness, key) is not None:
                raise fault(key, "belongs to a table with values: leave it out")
        return
    if x is None:
        raise fault("x", "missing: the places along x of the table's values")
    for key, places in (("x", x), ("y", y or ())):
        if any(b <= a for a, b in pairwise(places)):
            raise fault(key, "expected places that ascend")
    columns = 1 if y is None else len(y)
    if len(values) != len(x) or any(len(row) != columns for row in values):
        what = "one thickness" if y is None else f"a list of {columns} thicknesses, one for each y,"
        raise fault("values", f"expected {what} for each of the {len(x)} places along x")
    if min(map(min, values)) <= 0.0:
        raise fault("values", "expected thicknesses above 0")


def planform(plate: Plate) -> None:
    """Either length and width, or a mesh; and thin enough to be called a plate."""
    if plate.tip_mass_at is not None and not plate.tip_mass:
        raise fault("tip_mass_at", "expected a tip_mass beside it")
    if plate.mesh is None and not isinstance(plate.thickness, float) and plate.thickness.field:
        raise fault("thickness.field", "belongs to a mesh: name a mesh, or give a table or a polynomial")
    if plate.mesh is None and plate.mesh_unit is not None:
        raise fault("mesh_unit", "belongs to a mesh: leave this out, or name a mesh")
    if plate.mesh is not None:
        for key in ("length", "width"):
            if getattr(plate, key) is not None:
                raise fault(key, "the mesh gives the planform: leave this out, or leave out mesh")
        if not plate.mesh.strip() or "\0" in plate.mesh:
            raise fault("mesh", "expected the name of a mesh file")
        return
    for key in ("length", "width"):
        if getattr(plate, key) is None:
            raise fault(key, "missing (or name a mesh instead of length and width)")
    if plate.length is not None and plate.width is not None:
        try:
            least, _, greatest = thicknesses.spread(plate)
        except ValueError as error:
            raise fault("thickness", str(error)) from error
        odd = disproportion(least, greatest, plate.length, plate.width)
        if odd is not None:
            key, problem = odd
            raise fault(key, problem + _in_millimetres(least, greatest, plate.length, plate.width))


def _in_millimetres(least: float, greatest: float, length: float, width: float) -> str:
    """A question where large sides, taken as millimetres, would be those of a plate; else nothing."""
    large = {name: side for name, side in (("length", length), ("width", width)) if side >= _LARGEST}
    scaled = (side * 1e-3 if side >= _LARGEST else side for side in (length, width))
    if not large or disproportion(least, greatest, *scaled) is not None:
        return ""
    name, side = next(iter(large.items()))
    return f"; {name} = {side:g} is in m: was '{side:g} mm' meant?"


def disproportion(least: float, greatest: float, length: float, width: float) -> tuple[str, str] | None:
    """What keeps a plate from being one, as key and problem: too thick, a film, a wire or a tape."""
    extent = max(length, width)
    if extent > _SLENDEREST * min(length, width):
        return "width", f"expected a width within a factor of {_SLENDEREST:g} of the length, {length:g} m"
    if greatest >= length:
        return "thickness", f"expected less than the length, {length:g} m"
    if greatest > width * (1 + _ROUNDING):
        return "thickness", f"expected at most the width, {width:g} m: z, through the thickness, is the thin side"
    if least < extent / _THINNEST:
        return "thickness", f"expected at least {extent / _THINNEST:.3g} m on a plate {extent:g} m large"
    return None


def material(material: Material) -> None:
    """A modulus and a density that something solid has."""
    modulus = material.youngs_modulus
    if modulus < _SOFTEST * (1 - _ROUNDING):
        meant = f": {modulus:g} is in Pa; was '{modulus:g} GPa' meant?" if modulus >= 0.1 else ""
        raise fault("youngs_modulus", f"expected at least {_SOFTEST:g} Pa, of the softest rubber{meant}")
    _density("density", material.density)


def _density(key: str, value: float) -> None:
    if value < _LIGHTEST * (1 - _ROUNDING):
        meant = f": was '{value:g} g/cm^3' meant?" if value >= 0.1 else ""
        raise fault(key, f"expected at least {_LIGHTEST:g} kg/m^3, the lightest foam{meant}")


def rotor(rotor: Rotor) -> None:
    """A stagger within half a turn: beyond, it is more likely a number of degrees without its unit."""
    if abs(rotor.stagger) > math.pi * (1 + _ROUNDING):
        raise fault("stagger", "expected an angle within ±180 deg (a bare number is in radians)")
    if abs(rotor.precone) > math.pi / 2 * (1 + _ROUNDING):
        raise fault("precone", "expected an angle within ±90 deg (a bare number is in radians)")


def damper(damper: Damper) -> None:
    """One way of giving the mass, a ball that fits its cavity, and a rolling resistance that lets it roll."""
    given = [key for key in ("mass_ratio", "mass", "ball_density") if getattr(damper, key) is not None]
    if len(given) != 1:
        raise fault(
            given[0] if given else "mass_ratio",
            f"expected one of mass_ratio, mass, ball_density and ball_material{': leave one out' * bool(given)}",
        )
    if damper.ball_density is not None:
        _density("ball_density", damper.ball_density)
        if damper.ball_density > OSMIUM * (1 + _ROUNDING):
            raise fault("ball_density", f"expected at most {OSMIUM:g} kg/m^3, that of osmium: nothing is denser")
    for side in damper.cavity:
        if side < 2 * damper.radius * (1 - _ROUNDING):
            raise fault(
                "cavity",
                f"a ball of radius {damper.radius:g} m does not fit: expected sides of at least"
                f" {2 * damper.radius:g} m",
            )
    if damper.floor_radius is not None:
        _hollow(damper, damper.floor_radius)
    if damper.rolling_friction > damper.radius * (1 + _ROUNDING):
        raise fault(
            "rolling_friction",
            f"expected a length of at most the ball's radius, {damper.radius:g} m: over it, this is the coefficient",
        )


def _hollow(damper: Damper, floor: tuple[float, float]) -> None:
    """A hollow floor in which the ball finds room, and whose equations are not the paper's."""
    if damper.formulation == "printed":
        raise fault("floor_radius", "the printed equations know a flat floor only: leave this out")
    for radius, side in zip(floor, damper.cavity, strict=True):
        least = max(damper.radius, side / 2)
        if radius <= least * (1 + _ROUNDING):
            why = "half the cavity's side" if side / 2 > damper.radius else "the ball's radius"
            raise fault("floor_radius", f"expected more than {why}, {least:g} m")


def release(release: Release) -> None:
    """One way of giving the release, and one that sets something in motion."""
    given = [key for key in ("displacement", "acceleration", "ratio") if getattr(release, key) is not None]
    if len(given) != 1:
        raise fault(given[-1] if given else "displacement", "expected one of displacement, acceleration and ratio")
    pair = release.displacement if release.displacement is not None else release.acceleration
    if pair is not None and not any(pair):
        raise fault(given[0], "expected a release that is not zero on both axes")


def excitation(excitation: Excitation) -> None:
    """One way of giving the force."""
    given = [key for key in ("force", "pressure", "base") if getattr(excitation, key) is not None]
    if len(given) != 1:
        found = f"expected one of force, pressure and base{': leave one out' * bool(given)}"
        raise fault(given[-1] if given else "force", found)


def together(scene: Scene) -> None:
    """The tables of a scene: which belong together, which exclude each other."""
    if scene.structure is not None:
        _structure_only(scene)
    else:
        for table in ("plate", "material"):
            if getattr(scene, table) is None:
                raise fault(table, "the table is missing (or give [structure] instead of a plate)")
        if scene.rotor.radius is not None:
            raise fault("rotor.radius", "belongs to a [structure]; a plate takes hub_radius and [damper] at")
    if (scene.damper is None) != (scene.release is None):
        missing, present = ("release", "damper") if scene.release is None else ("damper", "release")
        raise fault(missing, f"the table is missing: [{present}] needs it")
    if scene.damper is not None and scene.rotor.precone:
        raise fault(
            "rotor.precone",
            "the load then slopes along the cavity's floor, which the damper's model has not: expected 0, or the plate"
            " alone, without [damper] and [release] (tip_mass and tip_mass_at stay)",
        )
    if scene.design is not None and scene.design.amplitude is None and scene.excitation is None:
        raise fault(
            "design.amplitude", "missing: the range over which the least damping counts (or give [excitation] instead)"
        )
    if scene.plate is not None:
        _on_the_plate(scene.plate, scene.damper)
        _release_of(scene.plate, scene.release)
    if scene.damper is not None and (radius := _turning_at(scene)) is not None:
        _within(radius, scene.damper, None if scene.plate is not None else scene.release)
    if scene.release is not None and scene.release.ratio is not None and not any(scene.rotor.speeds):
        raise fault("release.ratio", "at rest there is no load, and a ratio of it releases nothing")


def carrier(data: Any) -> Any:
    """A plate or a structure, before either is looked at: what one lacks is not asked for because of the other."""
    if isinstance(data, Mapping) and data.get("structure") is not None:
        if data.get("plate") is not None and set(data["structure"]) == {"floor_tilt"}:
            raise fault("structure.floor_tilt", "the floor on a plate tilts by what the plate bends: leave this out")
        for table in ("plate", "material"):
            if data.get(table) is not None:
                raise fault(table, "expected a plate with its material or a [structure]: leave one out")
    return data


def _structure_only(scene: Scene) -> None:
    if scene.damper is None:
        raise fault("damper", "the table is missing: a [structure] alone has nothing to solve")
    if scene.rotor.radius is None:
        raise fault("rotor.radius", "missing: a [structure] needs the radius at which the damper turns")
    if scene.structure is not None and max(map(abs, scene.structure.floor_tilt)) * scene.damper.radius >= 1:
        raise fault(
            "structure.floor_tilt", f"expected less than 1 / radius of the ball, {1 / scene.damper.radius:g} 1/m"
        )
    if scene.structure is not None:
        _tilt_of(scene, scene.structure.floor_tilt)
        _weight_of(scene.damper, scene.structure.mass)
    for key in ("hub_radius", "stagger", "precone"):
        if getattr(scene.rotor, key):
            raise fault(f"rotor.{key}", "belongs to a plate; a [structure] takes radius alone")
    for key in ("rotor.modes", "accuracy.frequency"):
        table, name = key.split(".")
        given = getattr(scene, table)
        if getattr(given, name) != type(given).model_fields[name].default:
            raise fault(key, "belongs to a plate; the one frequency of a [structure] is given")
    if scene.excitation is not None and scene.excitation.pressure is not None:
        raise fault("excitation.pressure", "belongs to a plate; a [structure] takes force or base")
    if scene.damper.at is not None:
        raise fault("damper.at", "belongs to a plate; a [structure] takes [rotor] radius")
    if scene.damper.housing is not None:
        raise fault("damper.housing", "belongs to a plate; the mass of a [structure] includes it")


def _turning_at(scene: Scene) -> float | None:
    """The damper's distance from the axis [m]; None where it is known only once a mesh is read."""
    if scene.plate is None:
        return scene.rotor.radius
    at = scene.damper.at if scene.damper is not None else None
    x = scene.plate.length if at is None else at[0]
    return None if scene.plate.length is None or x is None else scene.rotor.hub_radius + x


def _within(radius: float, damper: Damper, release: Release | None) -> None:
    """Ball, cavity and release that do not reach beyond the axis about which they turn."""
    most, distance = radius * (1 + _ROUNDING), f"its distance from the axis, {radius:g} m"
    if damper.radius > most:
        raise fault("damper.radius", f"the ball is larger than {distance}")
    if max(damper.cavity) > most:
        raise fault("damper.cavity", f"the cavity is larger than {distance}")
    if release is not None and max(map(abs, release.displacement or (0.0,))) > most:
        raise fault("release.displacement", f"expected at most the damper's distance from the axis, {radius:g} m")


def _tilt_of(scene: Scene, tilt: tuple[float, float]) -> None:
    if any(tilt) and scene.damper is not None and scene.damper.formulation == "printed":
        raise fault("structure.floor_tilt", "the printed equations know a level floor only: leave this out")
    if not any(tilt) and scene.effects.floor_tilt is True:
        raise fault("effects.floor_tilt", "structure.floor_tilt is 0: give the slope, or leave this out")


def _weight_of(damper: Damper, structure: float) -> None:
    """Balls that the structure carries, not the other way round; of a plate that is known once it is solved."""
    if damper.balls is not None and damper.balls > HEAVIEST * structure:
        key = "mass" if damper.mass is not None else "ball_density"
        raise fault(
            f"damper.{key}",
            f"expected balls of at most {HEAVIEST:g} times the structure's mass, {structure:g} kg; these weigh"
            f" {damper.balls:g} kg",
        )


def _on_the_plate(plate: Plate, damper: Damper | None) -> None:
    """Damper and tip mass are where the plate is. Where a mesh gives the planform, `plate_mesh` looks for the rest."""
    if damper is not None and plate.tip_mass_at is not None:
        raise fault("plate.tip_mass_at", "the tip mass is at the damper's place: leave this out")
    if plate.length is None or plate.width is None:
        odd = None
        if damper is not None and isinstance(plate.thickness, float):
            odd = cavity.through_the_thickness(damper, plate.thickness)
    else:
        key, at = ("plate.tip_mass_at", plate.tip_mass_at) if damper is None else ("damper.at", damper.at)
        x, y = (plate.length, 0.0) if at is None else at
        if not 0 < x <= plate.length * (1 + _ROUNDING) or abs(y) > plate.width / 2 * (1 + _ROUNDING):
            raise fault(
                key,
                f"outside the plate: expected x above 0 and at most {plate.length:g} m, y within"
                f" ±{plate.width / 2:g} m",
            )
        room = plate.width - 2 * abs(y)
        odd = None if damper is None else cavity.misfit(damper, thicknesses.at(plate, (x, y)), plate.width, x, room)
    if odd is not None:
        raise fault(f"damper.{odd[0]}", odd[1])


def _release_of(plate: Plate, release: Release | None) -> None:
    if release is None or plate.length is None:
        return
    if max(map(abs, release.displacement or (0.0,))) > plate.length:
        raise fault("release.displacement", f"expected at most the plate's length, {plate.length:g} m")
