"""What cannot be: equations that feed a vibration, a ball denser than any solid, a pull that no blade metal bears."""

from __future__ import annotations

import math

import numpy as np

from workflows.scene import thicknesses
from workflows.scene.materials import KNOWN, OSMIUM, is_too_dense
from workflows.solve.records import Floats, Results, SpeedPoint, Surface
from workflows.wording import significant, whole

STRONGEST = 2.4e9
"""Mean stress [Pa] that no blade metal bears: the nominal 0.2 % proof stress of 18Ni2400, the strongest of the maraging
steels (Inco, 18 per cent nickel maraging steels, Nickel Development Institute, publication 4419). Ti-6Al-4V and nickel
alloys bear less than two thirds of it."""

PRINTED = "the equations as printed do not conserve energy"


def refused(results: Results) -> str | None:
    """Why there is no verdict at any speed; None where there may be one."""
    if _printed(results):
        return PRINTED
    dense = too_dense(results)
    return None if dense is None else dense[0]


def is_refused(results: Results, point: SpeedPoint) -> bool:
    """Whether there is no verdict at a speed whatever the damper does there: refused, or the plate torn."""
    return _printed(results) or is_too_dense(_density(results, point)) or torn(results, point)


def _printed(results: Results) -> bool:
    return results.scene.damper is not None and results.scene.damper.formulation == "printed"


def _density(results: Results, point: SpeedPoint) -> float:
    """Of a ball [kg/m³]; 0 without one."""
    damper = results.scene.damper
    if damper is None or point.reduced is None:
        return 0.0
    return damper.density(point.reduced.M1 - point.reduced.M2)


def too_dense(results: Results) -> tuple[str, str] | None:
    """What of a ball is denser than any solid, and what would weigh as much; None where it can be had."""
    damper = results.scene.damper
    density = max((_density(results, point) for point in results.speeds), default=0.0)
    if damper is None or not is_too_dense(density):
        return None
    volume = 4 / 3 * math.pi * damper.radius**3
    one, steel = density * volume, KNOWN["steel"].density
    together = one * damper.count
    return (
        f"a ball of radius {significant(1e3 * damper.radius)} mm and {significant(1e3 * one)} g would be"
        f" {significant(density / OSMIUM, 2)} times as dense as osmium, and nothing is denser",
        f"The figures are those of as heavy balls as can be had, such as {math.ceil(together / (steel * volume))} of"
        " steel ([damper] count), each in a cavity of its own, moving in step.",
    )


def torn(results: Results, point: SpeedPoint) -> bool:
    """Whether the centrifugal pull at the root is more than any blade metal bears."""
    return (pull(results, point.omega) or 0.0) > STRONGEST


def torn_from(results: Results) -> str | None:
    """From which of the speeds on that is so, and by what."""
    lost = [point for point in results.speeds if torn(results, point)]
    if not lost:
        return None
    first = min(lost, key=lambda point: point.omega)
    stress = pull(results, first.omega) or 0.0
    return (
        f"from {whole(first.rpm)} rpm on: there the centrifugal pull at the root, {significant(stress / 1e6)} MPa on"
        f" average, is more than any blade metal bears ({significant(STRONGEST / 1e6)} MPa)"
    )


def pull(results: Results, omega: float) -> float | None:
    """Mean stress over the root's section [Pa]: what hangs on it times its acceleration; None where it is not known."""
    plate, material, rotor = results.scene.plate, results.scene.material, results.scene.rotor
    hung = _hung(results)
    if plate is None or material is None or hung is None:
        return None
    (volume, moment), section = hung
    level = math.cos(rotor.precone)
    stress = material.density * omega**2 * level * (rotor.hub_radius * volume + level * moment) / section
    hangs = level * max(point.radius for point in results.speeds)
    return stress + results.scene.point_mass * omega**2 * hangs / section


def _hung(results: Results) -> tuple[tuple[float, float], float] | None:
    """Volume of the plate and its moment about the root [m³, m^4], and the root's section [m²]."""
    plate = results.scene.plate
    if plate is not None and plate.length is not None and plate.width is not None:
        return thicknesses.volume(plate), thicknesses.section(plate)
    if plate is None or results.surface is None:
        return None
    heights = results.surface.thickness
    if heights is None:
        if not isinstance(plate.thickness, float):
            return None
        heights = np.full(len(results.surface.points), plate.thickness)
    return _of_a_mesh(results.surface, heights)


def _of_a_mesh(surface: Surface, heights: Floats) -> tuple[tuple[float, float], float]:
    """The same of a mesh: each cell as triangles about its first corner, exact for even thickness."""
    points, cells = surface.points[:, :2], surface.cells[1]
    x = points[:, 0] - points[:, 0].min()
    triangles = np.vstack([cells[:, [0, k, k + 1]] for k in range(1, cells.shape[1] - 1)])
    one, other = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    volumes = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2 * heights[triangles].mean(axis=1)
    lengths = np.linalg.norm(np.diff(points[surface.root], axis=1)[:, 0], axis=1)
    section = float((lengths * heights[surface.root].mean(axis=1)).sum())
    return (float(volumes.sum()), float((volumes * x[triangles].mean(axis=1)).sum())), section
