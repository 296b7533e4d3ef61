"""Remarks on the plate: its stress, its mesh, and what the ball does to its stiffness."""

from __future__ import annotations

import math

from workflows.records import Results
from workflows.wording import significant


def root_stress(results: Results) -> str | None:
    """The centrifugal pull at the root: what hangs on it times its acceleration, over the section."""
    plate, material, rotor = results.scene.plate, results.scene.material, results.scene.rotor
    if plate is None or material is None or plate.length is None or plate.width is None:
        return None
    fastest, tip = max(rotor.speeds), rotor.hub_radius + plate.length
    stress = material.density * fastest**2 * (tip**2 - rotor.hub_radius**2) / 2
    stress += plate.tip_mass * fastest**2 * tip / (plate.width * plate.thickness)
    if stress < 1e7:
        return None
    return (
        f"At {fastest * 30 / math.pi:.0f} rpm the centrifugal pull at the root is {significant(stress / 1e6)} MPa on"
        " average over the section: compare it with the yield of the material."
    )


def stiffness_with_ball(results: Results) -> str | None:
    """By how much K1 differs from K2."""
    reduced = [point.reduced for point in results.speeds if point.reduced is not None]
    if results.scene.plate is None or not reduced:
        return None
    change = max((r.K1 / r.K2 - 1 for r in reduced), key=abs)
    return (
        f"With the ball stuck to it, the plate's effective stiffness changes by up to {significant(100 * change, 2)} %"
        " (K1 against K2), mostly by the ball's own centrifugal pull; the damper uses K1."
    )


def mesh_error(results: Results) -> str | None:
    """The estimated error of the mesh beside the known one of the theory: two different numbers."""
    errors = [p.modes[0].error_estimate for p in results.speeds if p.modes]
    known = [error for error in errors if error is not None]
    if not known or results.theory is None:
        return None
    asked = results.scene.accuracy.frequency
    verdict = "" if max(known) <= asked else f", more than the {significant(100 * asked)} % asked for"
    verdict += _higher(results, asked)
    return (
        f"The mesh ({results.mesh}) leaves an estimated error of {significant(100 * max(known), 1)} % in the first"
        f" frequency{verdict}. The theory's own error is another: {_AGAINST_SOLID[results.theory.name]}."
    )


def _higher(results: Results, asked: float) -> str:
    """Which modes beside the first miss the accuracy asked for: the mesh is chosen by the first."""
    worst = [(m.error_estimate or 0.0, m.family) for p in results.speeds for m in p.modes[1:]]
    error, family = max(worst, default=(0.0, ""))
    if error <= asked:
        return ""
    return f" and up to {significant(100 * error, 1)} % in a higher mode ({family}), by which the mesh is not chosen"


_AGAINST_SOLID = {
    "mindlin": "Mindlin is 0.2 % below solid bricks in bending and in twist for a plate eight times wider than thick",
    "kirchhoff": "Kirchhoff is 0.3 % above solid bricks in bending and 5 % in twist for a plate eight times wider than"
    " thick",
    "solid": "none here, the solid being the reference",
}
