"""Table II of the paper, and whether a scene is the plate it speaks of."""

from collections.abc import Iterable
from dataclasses import dataclass

from workflows.scene.scene import Scene

SDC_RANGE = (0.14, 0.18)
"""Specific damping capacity that the paper reports over its loads (Fig. 3 and section III.A)."""


@dataclass(frozen=True)
class TableRow:
    """A row of Table II: accelerations in g."""

    load: float
    frequency: float
    cutoff: float
    ratio: float


TABLE_II = (
    TableRow(2687, 208.9, 191, 0.07),
    TableRow(5483, 218.8, 493, 0.09),
    TableRow(12337, 241.3, 1303, 0.11),
    TableRow(21932, 269.5, 2211, 0.10),
    TableRow(34269, 301.7, 3465, 0.10),
    TableRow(49348, 336.7, 5028, 0.10),
    TableRow(67168, 373.5, 6819, 0.10),
)


def is_known(scene: Scene, loads_g: Iterable[float]) -> bool:
    """Whether Table II has any of these loads."""
    return any(row(scene, load_g) for load_g in loads_g)


def row(scene: Scene, load_g: float) -> TableRow | None:
    """The row of Table II that a computed load belongs to, if the scene is the paper's plate."""
    plate, rotor = scene.plate, scene.rotor
    if plate is None or rotor.hub_radius or rotor.stagger or rotor.precone:
        return None
    measures = zip((plate.length, plate.width, plate.thickness), (0.2, 0.08, 0.01), strict=True)
    if not all(isinstance(ours, float) and abs(ours - theirs) <= 1e-9 for ours, theirs in measures):
        return None
    return next((entry for entry in TABLE_II if abs(load_g - entry.load) <= 1e-3 * entry.load), None)
