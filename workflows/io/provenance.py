"""Where numbers come from, for every file of a run: hashes of scene and mesh, versions of what computed them."""

import hashlib
import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from fem.meshes.mesh_sequence import Planform
from fem.meshes.planform import clamped_length
from workflows import versions
from workflows.effects.definition import Effect
from workflows.errors import one_line
from workflows.formatting import DASH, aligned, exact_mm, interval, revolutions, significant
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.materials import KNOWN
from workflows.scene.scene import Scene
from workflows.solve.known_modes import SpaceStructure
from workflows.solve.results import Results, Theory


def resolved_scene(scene: Scene, effects: dict[str, Effect], theory: Theory | None) -> dict[str, Any]:
    """The resolved scene as plain data; a material is its numbers, but for the strengths of the contact."""
    data = scene.model_dump(mode="json", exclude_none=True)
    data.get("material", {}).pop("name", None)
    if scene.rotor.origin is not None:
        del data["rotor"]["hub_radius"]
    both, damper = scene.contact_materials, data.get("damper", {})
    if all(both) and any(KNOWN[each].hardness for each in both if each is not None):
        damper["floor_material"] = both[1]
        del damper["ball_density"]
    else:
        damper.pop("ball_material", None)
    data["effects"] = {name: effect.on for name, effect in effects.items()}
    if theory is not None:
        data["plate"]["theory"] = theory.name
    return data


def document(
    source: SceneFile,
    effects: dict[str, Effect],
    theory: Theory | None,
    form: Planform | None = None,
    space: SpaceStructure | None = None,
) -> dict[str, Any]:
    """What `check --json` prints: the scene, why each effect is on or off, radii and root [m], remarks on the scene.

    A thickness [m] that varies is there too: its least, its greatest, that at the damper. Of a structure in space there
    is the damper's seat: place, load and axes of its cavity, and what each mode does there.
    """
    root, place, _ = radii(source, form, space)
    record: dict[str, Any] = {
        "scene": resolved_scene(source.scene, effects, theory),
        "effects": {name: {"on": effect.on, "why": effect.why} for name, effect in effects.items()},
        "radii": {"root": root, "damper": place},
        "remarks": [*source.remarks, *(() if space is None else space.remarks)],
    }
    if (known := _varying(source, form)) is not None:
        record["thickness"] = dict(zip(("least", "greatest", "damper"), known, strict=True))
    if (length := _root_length(source, form)) is not None:
        record["root_length"] = length
    if space is not None and (seated := space.seat_at(min(source.scene.rotor.speeds))) is not None:
        record["seat"] = asdict(seated)
    return record if theory is None else record | {"theory": vars(theory)}


def _varying(source: SceneFile, form: Planform | None) -> tuple[float, float, float] | None:
    """Least and greatest thickness [m] and that at the damper, where it varies."""
    plate = source.scene.plate
    if plate is None or isinstance(plate.thickness, float):
        return None
    least, _, greatest = plate_mesh.thickness_range(plate, form)
    place = plate_mesh.root_and_place(source, _mesh(form))[1]
    return least, greatest, plate.thickness_at(place, getattr(form, "thickness", None))


def _root_length(source: SceneFile, form: Planform | None) -> float | None:
    """Length [m] of the clamped edge, None without a plate."""
    if form is not None:
        return clamped_length(_mesh(form))
    return None if source.scene.plate is None else source.scene.plate.width


def _mesh(form: Planform | None) -> Any:
    return None if form is None else form.mesh(form.sizes[0])


def heading(source: SceneFile, form: Planform | None = None, space: SpaceStructure | None = None) -> list[str]:
    """What is asked in the words of a person, as comments: speeds, radii, and how the damper lies."""
    scene, (root, place, at) = source.scene, radii(source, form, space)
    lines = [f"{one_line(scene.title)}: {revolutions(scene.rotor.speeds)}", *source.remarks]
    lines += () if space is None else space.remarks
    what = "damper" if scene.damper is not None else "tip mass" if scene.point_mass else "tip"
    root_text = "root" if scene.plate is not None and scene.plate.root is not None else "clamped root"
    inner = "" if root is None else f"{exact_mm(root)} at the {root_text}, "
    lines.append(f"Radii from the axis: {inner}{exact_mm(place)} at the {what}{at}")
    if (mesh := _mesh(form)) is not None:
        lines.append("Plate: {} long, {} wide".format(*map(exact_mm, np.ptp(mesh.p, axis=1))))
    if (length := _root_length(source, form)) is not None:
        lines.append(f"{root_text[0].upper()}{root_text[1:]}: {exact_mm(length)} long")
    if (known := _varying(source, form)) is not None:
        least, greatest, there = map(exact_mm, known)
        lines.append(f"Thickness: {interval(least, greatest)}, {there} at the {what}")
    if scene.damper is not None and scene.plate is not None:
        lines += ["", *_axes("plate")]
    if space is not None:
        lines += [space.described, *_seated(space, source)]
    return [f"# {line}".rstrip() for line in lines]


def _axes(name: str) -> list[str]:
    """The picture of a damper's axes, on a plate or in space."""
    path = Path(__file__).parents[1] / "templates" / f"axes_{name}.txt"
    return path.read_text(encoding="utf-8").splitlines()


def _seated(space: SpaceStructure, source: SceneFile) -> list[str]:
    """How the cavity lies, and what each mode does there at the lowest speed."""
    seated = space.seat_at(min(source.scene.rotor.speeds))
    if seated is None:
        return []
    rows: list[tuple[str, ...]] = [("mode", "Hz", "family", *_COLUMNS, *(f"{name}, axis 2" for name in _COLUMNS))]
    for mode in seated.modes:
        idle = [(each or 0.0) > _IDLE * min(mass or math.inf for mass in mode.mass) for each in mode.mass]
        cells = [
            DASH if value is None or idle[axis] else significant(scale * value, digits)
            for axis in range(2)
            for value, scale, digits in zip(mode.along(axis), (1e3, 1e-3, 1.0), (5, 4, 4), strict=True)
        ]
        rows.append((str(mode.number), significant(mode.frequency_hz, 5), mode.family, *cells))
    directions = [(1.0, each) for each in (seated.load, seated.normal, *seated.axes)]
    place, load, normal, first, second = (
        ", ".join(f"{scale * round(part, 9) + 0.0:.5g}" for part in vector)
        for scale, vector in ((1e3, seated.place), *directions)
    )
    leaning = ""
    if load != normal:
        angle = math.degrees(math.acos(min(sum(a * b for a, b in zip(seated.load, seated.normal, strict=True)), 1.0)))
        leaning = f"; floor's normal ({normal}), {angle:.2g}° from the load, which pulls the ball along the floor"
    return [
        "",
        *_axes("space"),
        f"Place ({place}) mm, {seated.how}; load along ({load}){leaning}",
        f"Axis 1 ({first}), axis 2 ({second})",
        f"At {revolutions([min(source.scene.rotor.speeds)])}, without the ball:",
        *aligned(rows),
    ]


_IDLE = 1e6
"""Effective mass of a mode over that along its other axis from which on it does not move the cavity there."""

_COLUMNS = ("M2 g", "K2 N/mm", "tilt 1/m")
"""Of each axis."""


def radii(
    source: SceneFile, form: Planform | None, space: SpaceStructure | None = None
) -> tuple[float | None, float, str]:
    """Radii [m] of the clamped root, which a [structure] has not, and of the damper; and its place on the plate."""
    hub = source.scene.rotor.hub_radius
    if space is not None:
        return None, space.radius, ""
    if source.scene.plate is None:
        return None, source.scene.rotor.radius or 0.0, ""
    root, (x, y) = plate_mesh.root_and_place(source, _mesh(form))
    outwards = plate_mesh.rotor(source.scene).outwards
    return hub, float(hub + outwards[0] * (x - root) + outwards[1] * y), f" (x = {exact_mm(x)}, y = {exact_mm(y)})"


def as_toml(scene: Scene, effects: dict[str, Effect], theory: Theory | None) -> str:
    """The resolved scene as TOML, the reasons in comments."""
    data = resolved_scene(scene, effects, theory)
    data["rotor"]["speeds"] = [f"{speed!r} rad/s" for speed in scene.rotor.speeds]
    reasons = _sources(scene) | {("effects", name): effect.why for name, effect in effects.items()}
    reasons["rotor", "speeds"] = revolutions(scene.rotor.speeds)
    if theory is not None:
        reasons["plate", "theory"] = theory.why
    return "\n".join(_lines(data, reasons))


def _lines(table: dict[str, Any], reasons: dict[tuple[str, str], str], key: str = "") -> list[str]:
    """The keys of a table, and then the tables in it; `key`: of the table, empty of the whole scene."""
    inner = {name: item for name, item in table.items() if isinstance(item, dict)}
    lines = [_line(name, item, reasons.get((key, name))) for name, item in table.items() if name not in inner]
    for name, item in inner.items():
        within = f"{key}.{name}" if key else name
        lines += ["", f"[{within}]", *_lines(item, reasons, within)]
    return lines


def _sources(scene: Scene) -> dict[tuple[str, str], str]:
    """Where the numbers of materials are from, and what balls of a density weigh."""
    sources: dict[tuple[str, str], str] = {}
    material, damper = scene.material, scene.damper
    if material is not None and material.name is not None:
        sources["material", "youngs_modulus"] = f"{material.name}: {KNOWN[material.name].source}"
    if damper is not None and damper.ball_density is not None:
        name = damper.ball_material
        known = "" if name is None else f"{name}: {KNOWN[name].source}; "
        balls = "the ball weighs" if damper.count == 1 else f"{damper.count} balls together weigh"
        sources["damper", "ball_density"] = f"{known}{balls} {significant(1e3 * (damper.balls or 0.0))} g"
    return sources


def _line(key: str, value: object, reason: str | None) -> str:
    # TOML and JSON write numbers, strings, booleans and lists alike.
    bare = all(letter.isascii() and (letter.isalnum() or letter in "-_") for letter in key)
    text = f"{key if bare else json.dumps(key, ensure_ascii=False)} = {json.dumps(value, ensure_ascii=False)}"
    return f"{text:<28} # {reason}" if reason else text


def scene_sha256(results: Results) -> str:
    """SHA-256 of the resolved scene in its canonical form: JSON in UTF-8, keys sorted, no spaces, SI.

    The same scene, however it was written, has the same hash. A mesh file counts by its name here; its bytes have a
    hash of their own.
    """
    scene = resolved_scene(results.scene, results.effects, results.theory)
    canonical = json.dumps(scene, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def hashes(results: Results) -> dict[str, str]:
    """What this was computed from, by the names that every file gives them."""
    digests = {"scene_sha256": scene_sha256(results)}
    return digests if results.mesh_sha256 is None else digests | {"mesh_sha256": results.mesh_sha256}


def line(results: Results) -> str:
    """All in one line of text, for files that take a remark."""
    digests = ", ".join(f"{name} {value}" for name, value in hashes(results).items())
    return f"{digests}; {versions.line()}"
