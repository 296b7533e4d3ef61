"""Remarks on the plate: its stress, its mesh, and what the ball does to its stiffness."""

from __future__ import annotations

import math

import numpy as np

from workflows.findings import missing, possible, trust
from workflows.solve.records import Results
from workflows.wording import significant, whole

_NOTHING = 1e-3
"""Part of the accuracy asked for below which a change is rounding's, or nobody's concern."""

_WIDE = 2.0
"""Width over length of a mesh from which on it is asked whether it is meant."""


def root_stress(results: Results) -> str | None:
    """The centrifugal pull at the root, where the answer does not speak of it."""
    fastest = max(results.scene.rotor.speeds)
    stress = possible.pull(results, fastest)
    if stress is None or not 1e7 <= stress <= possible.STRONGEST:
        return None
    return (
        f"At {whole(fastest * 30 / math.pi)} rpm the centrifugal pull at the root is {significant(stress / 1e6)} MPa on"
        " average over the section: compare it with the yield of the material."
    )


def wide(results: Results) -> str | None:
    """A mesh that is clamped along its long edge, which may be one laid the wrong way round."""
    plate, surface = results.scene.plate, results.surface
    if plate is None or plate.mesh is None or surface is None:
        return None
    length, width = (float(1e3 * side) for side in np.ptp(surface.points[:, :2], axis=0))
    if width <= _WIDE * length:
        return None
    return (
        f"The mesh is {significant(width)} mm wide and {significant(length)} mm long: the root, at the smallest x, is a"
        " long edge. If a short one is meant, turn the mesh until its length lies along x."
    )


def stiffness_with_ball(results: Results) -> str | None:
    """By how much K1 differs from K2."""
    reduced = [point.reduced for point in results.speeds if point.reduced is not None]
    if results.scene.plate is None or not reduced:
        return None
    change = max((r.K1 / r.K2 - 1 for r in reduced), key=abs)
    if abs(change) < _NOTHING * results.scene.accuracy.frequency:
        return None
    return (
        f"With the ball stuck to it, the plate's effective stiffness changes by up to {significant(100 * change, 2)} %"
        " (K1 against K2), mostly by the ball's own centrifugal pull; the damper uses K1."
    )


def frequency_error(results: Results) -> str | None:
    """How far the frequencies can be trusted, and by what they are off."""
    if results.diagram is None or results.theory is None:
        return None
    own = _AGAINST_SOLID[results.theory.name]
    plate = results.scene.plate
    if plate is not None and plate.mesh is not None and results.theory.name == "solid":
        own += " On cells that are no rectangles a thin solid is too stiff, which finer meshes show; Mindlin's is not."
    if results.scene.point_mass > 0:
        own = (
            "Under a point mass the frequencies fall with every refinement: the estimate holds what cells down to a"
            f" tenth of the thickness would still take off. {own}"
        )
    mesh, said = results.diagram.mesh, trust.sentence(results)
    if said is None:
        unknown = f"The error of the mesh ({mesh}) is not known: it is too large for a finer one to compare with."
        return " ".join(part for part in (unknown, missing.sentence(results), own) if part)
    return f"{said} The mesh: {mesh}. {own}"


def real_modes(results: Results) -> str | None:
    """What Coriolis forces do to the mode that the damper feels, where that is more than the accuracy asked for."""
    if not results.effects["coriolis"].on:
        return None
    moved = [
        mode.frequency_hz / point.reduced.f2_hz - 1
        for point in results.speeds
        if point.reduced is not None
        for mode in [next((mode for mode in point.modes if mode.family == "flap"), None)]
        if mode is not None
    ]
    most = max(moved, key=abs, default=0.0)
    if abs(most) <= results.scene.accuracy.frequency:
        return None
    return (
        f"Coriolis forces move the first bending mode by {significant(100 * most, 2)} %. What the damper feels (M1, K1,"
        " M2, K2) is of a real mode, and without them."
    )


def divergence(results: Results) -> str | None:
    """Speeds that have no answer."""
    if results.diagram is None or not results.diagram.lost:
        return None
    lost, critical = results.diagram.lost, results.diagram.critical
    which = (
        f"{whole(lost[0])} rpm"
        if len(lost) == 1
        else f"{len(lost)} of the speeds asked for, from {whole(lost[0])} rpm on"
    )
    where = "" if critical is None else f" Its critical speed is {critical:.6g} rpm."
    return f"The plate diverges at {which}: it leaves its equilibrium without oscillating, and has no frequency.{where}"


def veering(results: Results) -> str | None:
    """Where modes could not be followed for certain."""
    if results.diagram is None or not results.diagram.veerings:
        return None
    places = [
        f"{whole(low)} and {whole(high)} rpm ({', '.join(names)})" for low, high, names in results.diagram.veerings
    ]
    more = f", and {len(places) - 4} times more" if len(places) > 4 else ""
    return (
        f"Between {'; between '.join(places[:4])}{more} modes change too much to be followed for certain: they exchange"
        " their characters there, or cross at a sharper angle than the steps resolve. A curve of the Campbell diagram"
        " may go on as another mode."
    )


_AGAINST_SOLID = {
    "mindlin": "Theories are held against a solid; Mindlin's is clamped where a solid seems to be, a little outside its"
    " root.",
    "kirchhoff": "Theories are held against a solid; thin-plate theory leaves out shear, which matters most in twist.",
    "solid": "The solid is the reference that other theories are held against.",
}
