"""What a careful engineer would remark about a run: one function a remark, None where there is nothing to say.

Remarks on the damper are here, those on the plate in :mod:`workflows.findings.of_the_plate`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from workflows.findings import cutoffs, of_the_ball, of_the_floor, possible, worth
from workflows.findings import of_the_plate as notes_plate
from workflows.findings.of_the_floor import rung_down
from workflows.findings.said import capital, stretch
from workflows.scene import paper, thicknesses
from workflows.scene.cavity import beside
from workflows.solve import damper_stage as ringdowns
from workflows.solve.records import Damping, Results
from workflows.wording import significant, span, whole

EXPLAINED = 1e-9
"""Share of the initial energy that the books may leave unexplained without a word."""


def remarks(results: Results) -> tuple[str, ...]:
    """The remarks that the run calls for, those that bear most on the answer first."""
    found = (remark(results) for remark in REMARKS)
    return tuple(text for text in found if text)


def _capped(results: Results) -> str | None:
    """All speeds whose ring-down ended before its ball did."""
    rung = [(p, d) for p, _, d in rung_down(results)]
    ended = dict.fromkeys(d.outcome for _, d in rung if "cap" in d.outcome)
    parts = []
    for outcome in ended:
        there = [p for p, d in rung if d.outcome == outcome]
        marked = any(cutoffs.shown(results, p).mark for p in there)
        known = f": the cut-offs marked {cutoffs.AT_REST} are those of a ball at rest" if marked else ""
        parts.append(f"{capital(stretch(there, [p for p, _ in rung]))} {outcome}{known}.")
    return " ".join(parts) or None


def _nothing_released(results: Results) -> str | None:
    release = results.scene.release
    still = [p.rpm for p, _, _ in rung_down(results) if p.load_g == 0]
    if release is None or release.ratio is None or not still:
        return None
    return f"At {whole(still[0])} rpm there is no load, so that a ratio of it releases nothing: nothing moves there."


def _held(results: Results) -> str | None:
    """Ring-downs in which the release is too small to set the ball rolling."""
    rung = [(p, d, p.level or p.working) for p, _, d in rung_down(results) if p.load_g > 0 and d.events == 0]
    held = [(p, d, own) for p, d, own in rung if own is not None and own.peak > 0]
    if not held:
        return None
    point, damping, own = min(held, key=lambda entry: entry[0].load_g)
    lift = significant(1e3 * math.hypot(*damping.release))
    needed = significant(1e3 * own.cutoff, 2)
    return (
        f"From {whole(point.rpm)} rpm on, this scene's release of {lift} mm does not set the ball rolling, which takes"
        f" {needed} mm there: those ring-downs show the structure alone."
    )


def _books(results: Results) -> str | None:
    shares = [d.energy.residual / d.energy.initial for _, _, d in rung_down(results) if d.energy.initial > 0]
    worst = max(shares, key=abs, default=0.0)
    if abs(worst) <= EXPLAINED:
        return None
    what = "appears from nowhere" if worst < 0 else "is lost without a cause"
    printed = results.scene.damper is not None and results.scene.damper.formulation == "printed"
    why = ": the printed equations do not conserve energy" if printed else ""
    return f"Up to {significant(100 * abs(worst), 2)} % of the initial energy {what}{why}."


def _work_bound(results: Results) -> str | None:
    from damper import work_bound

    damper = results.scene.damper
    if damper is None or damper.formulation == "printed":
        return None  # the bound rests on conservation of energy
    bounds = []
    for point, _, damping in rung_down(results):
        if damping.cutoff_g:
            system = ringdowns.particle_damper(results.scene, results.effects, point)
            amplitude = damping.cutoff_g * results.scene.rotor.gravity / system.stuck_frequency**2
            bound = work_bound(system, amplitude)
            bounds.append((bound, point.rpm))
    if all(bound > 1 for bound, _ in bounds):
        return None  # nothing takes more than all there is
    limits = [
        f"{f'{significant(100 * bound, 2)} %' if bound <= 1 else 'no bound'} at {whole(rpm)} rpm"
        for bound, rpm in bounds
    ]
    ends = limits if len(limits) == 1 else [limits[0], limits[-1]]
    return (
        "However often it bounces, the ball can take at most 4 (m_p/M2) (clearance/amplitude) of a cycle's energy, both"
        " axes taken together and to leading order in m_p/M2; this is largest at the cut-off:"
        f" {', '.join(ends)}. Any damping beyond that is the structure's own."
    )


def _assumed_damping(results: Results) -> str | None:
    damper, rung = results.scene.damper, rung_down(results)
    if damper is None or damper.damping_ratio == 0 or not rung:
        return None
    share = significant(100 * rung[0][2].intrinsic_sdc)
    return (
        f"The structure's own damping, ζ = {damper.damping_ratio:g}, is an input and alone loses {share} % in a cycle;"
        " the specific damping capacity includes it, as the paper's definition does."
    )


def _effective_ball(results: Results) -> str | None:
    """The paper speaks of one ball, of an effective mass; its plate here carries as many as there can be."""
    damper = results.scene.damper
    if damper is None or damper.count == 1 or not any(paper.row(results.scene, p.load_g) for p in results.speeds):
        return None
    alone = replace(results, scene=results.scene.model_copy(update={"damper": damper.model_copy(update={"count": 1})}))
    dense = possible.too_dense(alone)
    return None if dense is None else f"Of {damper.count} balls, where the paper has one: {dense[0]}."


def _rows(results: Results) -> str | None:
    """Cavities that do not lie side by side: the innermost ones feel less load and less motion."""
    plate, damper = results.scene.plate, results.scene.damper
    if plate is None or plate.width is None or damper is None or damper.housing:
        return None
    place = damper.at or (plate.length or 0.0, 0.0)
    most = beside(damper, thicknesses.at(plate, place), plate.width)
    if damper.count <= most:
        return None
    rows = math.ceil(damper.count / most)
    return (
        f"At most {most} of the {damper.count} cavities lie side by side in a section of the plate: they take {rows}"
        f" rows along the radius, {significant(2e3 * damper.radius * rows)} mm deep. The model has all of them at one"
        " place; further in there is less load and less motion."
    )


def _rolling(results: Results) -> str | None:
    damper = results.scene.damper
    rolled = [(p, math.hypot(*d.release), demand) for p, _, d in rung_down(results) if (demand := _demand(d)) > 0]
    if damper is None:
        return None
    beyond = [each for each in rolled if each[2] > damper.friction]
    if not beyond:
        return None
    points, lifts, demands = zip(*beyond, strict=True)
    lift = span(1e3 * min(lifts), 1e3 * max(lifts), 3)
    return (
        f"In the ring-downs from a release of {lift} mm rolling without slip needs"
        f" a friction of {span(min(demands), max(demands))} {stretch(points, [p for p, _, _ in rolled])}, more than the"
        f" {damper.friction:g} given for wall hits: unless the floor grips better, the ball would slip."
    )


def _demand(damping: Damping) -> float:
    """The friction that pure rolling needs in a ring-down, 0 where the ball does not roll on its floor."""
    return damping.largest_rolling_demand or 0.0


def _release_stress(results: Results) -> str | None:
    material, rung = results.scene.material, rung_down(results)
    if material is None or not rung:
        return None
    lift = max(abs(damping.release[0]) for _, _, damping in rung)
    strain = worth.root_strain(results, lift)
    if strain is None or material.youngs_modulus * strain < 1e8:
        return None
    stress = material.youngs_modulus * strain
    large = ", far outside small deflections and, for most metals, outside the elastic range" if stress > 4e8 else ""
    return (
        f"A release of {significant(1e3 * lift)} mm at the cavity bends the root to about"
        f" {significant(stress / 1e6, 2)} MPa{large}."
    )


def _two_axes(results: Results) -> str | None:
    if results.scene.plate is None or not any(damping.release[1] for _, _, damping in rung_down(results)):
        return None
    if results.effects["structural_modes"].on:
        return None
    lags = [mode.frequency_hz for point in results.speeds for mode in point.modes if mode.family == "lag"]
    known = f"; this plate's first lag mode is at about {significant(min(lags))} Hz" if lags else ""
    return f"As in the paper, both axes have the frequency of the first bending mode{known}."


REMARKS: tuple[Callable[[Results], str | None], ...] = (
    notes_plate.divergence,
    notes_plate.wide,
    _capped,
    of_the_ball.at_rest,
    of_the_ball.weight,
    _nothing_released,
    _held,
    of_the_floor.leaning_load,
    of_the_floor.level_floor,
    of_the_floor.turning_floor,
    of_the_floor.pendulum,
    of_the_floor.scattered,
    of_the_floor.modes_left_out,
    of_the_floor.still_across,
    of_the_floor.level_structure,
    _books,
    _work_bound,
    _assumed_damping,
    of_the_ball.lent,
    _effective_ball,
    _rows,
    _rolling,
    _release_stress,
    notes_plate.root_stress,
    _two_axes,
    notes_plate.stiffness_with_ball,
    notes_plate.real_modes,
    notes_plate.veering,
    notes_plate.frequency_error,
)
"""In the order in which they are reported."""
