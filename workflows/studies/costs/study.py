"""`spindamp accuracy`: every ladder that a scene has."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from workflows import pipeline
from workflows.errors import NoAnswer
from workflows.progress import Stages
from workflows.scene import plate_mesh
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage as ringdowns
from workflows.solve import felt, records
from workflows.solve import plate_stage as plate
from workflows.solve.decided import Decided, decide
from workflows.solve.plate_records import Discrete
from workflows.solve.records import Floats
from workflows.studies.costs import dampers, pipelines, plates, speeds
from workflows.studies.costs.ladder import Costs, Ladder, Picked
from workflows.studies.costs.plates import Problem

if TYPE_CHECKING:
    import fem


def study(source: SceneFile, stages: Stages | None = None) -> Costs:
    """Time against error for the plate, the speeds, the damper and the whole, as far as the scene has them.

    Raises:
        BadInput: see :func:`workflows.solve.plate_stage.solve`.
        NoAnswer: see there; or the scene has nothing whose accuracy costs anything.
    """
    stages = stages or Stages()
    ladders: list[Ladder] = []
    chosen: dict[str, Picked] = {}
    decided = decide(source, Stages(visible=False))
    if decided.form is not None:
        found, picked = _plate(source, decided, stages)
        ladders += found
        chosen |= picked
    if source.scene.damper is not None:
        with stages("damper", len(dampers.STEPS) + sum(map(len, dampers.METHODS.values())) + 2) as step:
            points = pipeline.structure(source, Stages(visible=False), shapes=False, decided=decided).points
            point = points[records.shown(points)]
            system = dampers.level(ringdowns.particle_damper(source.scene, decided.effects, point))
            ladder, exact = dampers.ladder(system, felt.released_at(source.scene, point), point, step)
        ladders += [] if ladder is None else [ladder]
        chosen["damper"] = exact
    with stages("pipeline", len(pipelines.ASKED) + 1) as step:
        whole, picked = pipelines.ladders(source, step)
    if not ladders:
        raise NoAnswer(f"{source.name}: {chosen['damper'].setting}, so that there is no accuracy to pay for")
    asked = source.scene.accuracy.model_dump()
    return Costs(source.scene.title, asked, (*ladders, *whole), chosen | picked)


def _plate(source: SceneFile, decided: Decided, stages: Stages) -> tuple[list[Ladder], dict[str, Picked]]:
    (form, _), solver = decided.plate, plate.discretise(source, decided, Stages(visible=False))
    operators, count = solver.choice.operators, source.scene.rotor.modes
    plain = replace(operators.effects, coriolis=False, large_deflection=False)
    problem = Problem(
        form=form,
        plate=lambda mesh: plate_mesh.plate(source, mesh, form),
        rotor=operators.rotor,
        effects=plain,
        omega=float(solver.choice.probes[-1]),
        count=count,
    )
    steps = 3 + sum(len(plates.sizes(problem, method.finest)) for method in plates.METHODS)
    with stages("plate", steps) as step:
        ladders, limits = plates.ladders(problem, step)
    linear = replace(operators, effects=plain, gyroscopic=None)
    with stages("speeds", 6) as step:
        ladder, basis = speeds.speeds(linear, problem.omega, count, step)
    mesh = _chosen(solver, problem, limits)
    left_out = _left_out(operators.effects)
    said = [replace(ladder, reference=ladder.reference + left_out) for ladder in (*ladders, ladder)]
    return said, {"plate": mesh, "speeds": basis}


def _left_out(effects: fem.Effects) -> str:
    """What the scene has on and the plate's ladders are without, in words."""
    names = {"large deflection": effects.large_deflection, "Coriolis forces": effects.coriolis}
    on = [name for name, switch in names.items() if switch]
    return f"; all without {' and '.join(on)}, which the scene has on" if on else ""


def _chosen(solver: Discrete, problem: Problem, limits: dict[str, tuple[Floats, float]]) -> Picked:
    """The mesh that the scene's accuracy chose, its estimate, and its error against the limit of its theory."""
    from fem import solve_modes

    name, error = solver.theory.name, None
    estimate = float(np.max(solver.choice.errors)) + solver.layers
    if name in limits:
        linear = replace(solver.choice.operators, effects=problem.effects, gyroscopic=None)
        frequencies = solve_modes(linear, problem.omega, problem.count).frequencies_hz
        error = float(np.abs(frequencies / limits[name][0] - 1.0).max())
    return Picked(name, solver.mesh, estimate if np.isfinite(estimate) else None, error)
