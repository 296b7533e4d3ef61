"""What the values of a scene must be together; each check raises with the key to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic_core import PydanticCustomError

if TYPE_CHECKING:
    from workflows.scene import Damper, Plate, Release, Scene

_ROUNDING = 1e-9
"""Relative slack of comparisons between lengths, which come from decimal text."""


def fault(key: str, problem: str) -> PydanticCustomError:
    """An error at `key` (relative to the table, or ``table.key`` for the whole scene)."""
    return PydanticCustomError("together", "{problem}", {"problem": problem, "key": key})


def planform(plate: Plate) -> None:
    """Either length and width, or a mesh; and thin enough to be called a plate."""
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
    if plate.length is not None and plate.thickness >= plate.length:
        raise fault("thickness", f"expected less than the length, {plate.length:g} m")


def damper(damper: Damper) -> None:
    """One way of giving the mass, and a ball that fits its cavity."""
    if (damper.mass_ratio is None) == (damper.mass is None):
        raise fault("mass_ratio", "expected either mass_ratio or mass, and not both")
    for side in damper.cavity:
        if side < 2 * damper.radius * (1 - _ROUNDING):
            raise fault(
                "cavity",
                f"a ball of radius {damper.radius:g} m does not fit: expected sides of at least"
                f" {2 * damper.radius:g} m",
            )


def release(release: Release) -> None:
    """One way of giving the release, and one that sets something in motion."""
    given = [key for key in ("displacement", "acceleration", "ratio") if getattr(release, key) is not None]
    if len(given) != 1:
        raise fault(given[-1] if given else "displacement", "expected one of displacement, acceleration and ratio")
    pair = release.displacement if release.displacement is not None else release.acceleration
    if pair is not None and not any(pair):
        raise fault(given[0], "expected a release that is not zero on both axes")


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
    if scene.plate is not None and scene.damper is not None:
        _on_the_plate(scene)


def _structure_only(scene: Scene) -> None:
    for table in ("plate", "material"):
        if getattr(scene, table) is not None:
            raise fault(table, "expected either a plate with its material or a [structure], and not both")
    if scene.damper is None:
        raise fault("damper", "the table is missing: a [structure] alone has nothing to solve")
    if scene.rotor.radius is None:
        raise fault("rotor.radius", "missing: a [structure] needs the radius at which the damper turns")
    for key in ("hub_radius", "stagger"):
        if getattr(scene.rotor, key):
            raise fault(f"rotor.{key}", "belongs to a plate; a [structure] takes radius alone")
    if scene.damper.at is not None:
        raise fault("damper.at", "belongs to a plate; a [structure] takes [rotor] radius")


def _on_the_plate(scene: Scene) -> None:
    plate, damper = scene.plate, scene.damper
    if plate is None or damper is None or damper.at is None or plate.length is None or plate.width is None:
        return
    x, y = damper.at
    if not 0 < x <= plate.length * (1 + _ROUNDING) or abs(y) > plate.width / 2 * (1 + _ROUNDING):
        raise fault(
            "damper.at",
            f"outside the plate: expected x above 0 and at most {plate.length:g} m, y within ±{plate.width / 2:g} m",
        )
