"""From a scene to results, in one direction: plate → reduced structure → damper → results."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem.modal_model import ModalModel
from workflows.errors import read_from
from workflows.formatting import significant
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, as_scene_file
from workflows.scene.plate_mesh import place
from workflows.solve import damper, excitation, limits, resources
from workflows.solve.hits import with_hits
from workflows.solve.model_choice import ModelChoice
from workflows.solve.results import Results, middle_speed
from workflows.solve.structure import StructureSolver, StructureState


def structure(
    source: SceneFile,
    stages: Stages,
    *,
    shapes: bool = True,
    size: int | None = None,
    choice: ModelChoice | None = None,
) -> StructureState:
    """Solve the scene's plate, or take its structure as given; with `shapes` its mode shapes are kept.

    `size`, `choice`: see :class:`workflows.solve.structure.StructureSolver`.

    Raises:
        BadInput, NoAnswer: see there.
    """
    state = StructureSolver(source, stages, choice, size).at()
    with stages("modes"):
        return state.with_pictures(shapes=shapes)


def damped(state: StructureState, stages: Stages) -> StructureState:
    """Ring the damper down on a structure at every speed; a scene without a damper stays as it is."""
    scene = state.source.scene
    if scene.damper is None:
        return state
    with read_from(state.source.name):
        points = damper.simulate(scene, state.effects, state.points, stages, middle_speed(state.points))
    return replace(state, points=points)


def results(state: StructureState, stages: Stages) -> Results:
    """Gather what a run found, with a verdict at each speed; its notes are those on how the scene is written."""
    reductions = excitation.estimates(state, stages)
    judged = limits.with_verdicts(state.results(stages=stages))
    return replace(with_hits(judged, state), reductions=reductions)


def run(scene: SceneLike = DEFAULT, stages: Stages | None = None) -> Results:
    """The whole of a run, nothing written.

    Args:
        scene: the name of a shipped scene, the path of a file, a dict, a Scene or what `load` returns.
        stages: the clock to go by, if not one of its own.

    Raises:
        BadInput: the scene is wrong, or needs more than this machine has; the message says what would be right.
        NoAnswer: the physics has none.
        TypeError: it is no scene.
    """
    source = as_scene_file(scene)
    resources.check(source)
    stages = stages or Stages()
    return results(damped(structure(source, stages), stages), stages)


def modes(source: SceneFile, stages: Stages) -> ModalModel:
    """The structure of a scene as its real modes: at the scene's speeds; those of files as they are.

    Coriolis forces, which make modes complex, are left out.

    Raises:
        BadInput: it has none.
        BadInput, NoAnswer: see :class:`workflows.solve.structure.StructureSolver`.
    """
    from fem.output import modal_model

    if source.scene.given is not None:
        problem = "the table is missing: modes requires [plate], [blade] or [structure] modes"
        raise source.wrong(problem, "[plate]")
    speeds = tuple(sorted(source.scene.rotor.speeds))
    solver = StructureSolver(source.changed(effects={"coriolis": False}, rotor={"speeds": speeds}), stages)
    if solver.space is not None:
        model = solver.space.model
        return model if source.scene.blade is None else replace(model, speeds=tuple(map(solver.space.modes, speeds)))
    plate, errors = solver.plate(), []
    for point in plate.points:
        own = [mode.error_estimate for mode in point.modes]
        errors.append(None if None in own else np.array(own, dtype=np.float64))
    operators = plate.discrete.choice.operators
    at = None if source.scene.damper is None else place(source, operators.plate.mesh)
    return modal_model(operators, plate.diagram, plate.numbers, errors, at)


def plate_only(source: SceneFile) -> SceneFile:
    """The scene without its damper.

    Raises:
        BadInput: it has no plate.
    """
    if source.scene.given is not None:
        raise source.wrong("the table is missing: campbell needs a plate, a blade or known modes", "[plate]")
    damper, material = source.scene.damper, source.scene.material
    if source.scene.plate is not None and material is not None and damper is not None and damper.cut:
        grams = significant(1e3 * material.density * damper.cut, 2)
        uncut = f"The frequencies are those of the plate alone, before the cavities take {grams} g out of it"
        counted = "which `run` includes where [effects] cavity_mass is on"
        source = replace(source, remarks=(*source.remarks, f"{uncut}, {counted}."))
    return source.plate_alone()


def at_one_speed(source: SceneFile, omega: float | None = None) -> SceneFile:
    """The scene at one speed [rad/s], where no order crosses a mode; by default its middle one.

    Raises:
        BadInput: it has no damper.
    """
    if source.scene.damper is None:
        raise source.wrong("the table is missing: ringdown needs a damper", "[damper]")
    speeds = sorted(source.scene.rotor.speeds)
    speed = speeds[(len(speeds) - 1) // 2] if omega is None else omega
    return source.changed(rotor={"speeds": (speed,)}, excitation=None)
