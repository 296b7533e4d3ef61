"""From a scene to results, in one direction: plate → reduced structure → damper → results."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from workflows.effects.definition import Effect
from workflows.errors import BadInput, read_from
from workflows.findings.remarks import remarks
from workflows.formatting import whole
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, opened
from workflows.scene.rotor import FASTEST, typed
from workflows.solve import coupling, resources
from workflows.solve import damper as ringdowns
from workflows.solve import structure as plate
from workflows.solve.model_choice import Decided, decide
from workflows.solve.results import Results, SpeedPoint, middle
from workflows.solve.structure import PlateAnswer


@dataclass(frozen=True, eq=False)
class Solved:
    """The first half of a run: the structure at every speed, before the damper."""

    source: SceneFile
    effects: dict[str, Effect]
    points: tuple[SpeedPoint, ...]
    plate: PlateAnswer | None
    mesh_sha256: str | None = None


def structure(
    source: SceneFile,
    stages: Stages,
    *,
    shapes: bool = True,
    size: int | None = None,
    decided: Decided | None = None,
) -> Solved:
    """Solve the scene's plate, or take its structure as given; `shapes` and `size` are those of `plate.solve`.

    `decided`: what :func:`workflows.solve.model_choice.decide` says of the source, where that is known.

    Raises:
        BadInput, NoAnswer: see :func:`workflows.solve.structure.solve`.
    """
    found = decided or decide(source, stages)
    if found.form is None:
        points = tuple(coupling.known_structure(source.scene, omega) for omega in source.scene.rotor.speeds)
        return Solved(source, found.effects, points, None)
    answer = plate.solve(source, found, stages, shapes=shapes, size=size)
    return Solved(source, found.effects, answer.points, answer, found.mesh_sha256)


def damped(found: Solved, stages: Stages) -> Solved:
    """Ring the damper down on a structure at every speed; a scene without a damper stays as it is."""
    scene = found.source.scene
    if scene.damper is None:
        return found
    with read_from(found.source.name):
        points = ringdowns.simulate(scene, found.effects, found.points, stages, middle(found.points))
    return replace(found, points=points)


def results(found: Solved, stages: Stages) -> Results:
    """Gather what a run found, with the remarks it calls for."""
    answer = found.plate
    gathered = Results(
        scene=found.source.scene,
        effects=found.effects,
        speeds=found.points,
        surface=None if answer is None else answer.surface,
        theory=None if answer is None else answer.theory,
        diagram=None if answer is None else answer.diagram,
        mesh_sha256=found.mesh_sha256,
        timings=stages.timings(),
    )
    return replace(gathered, notes=(*found.source.remarks, *remarks(gathered)))


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
    source = opened(scene)
    resources.check(source)
    stages = stages or Stages()
    return results(damped(structure(source, stages), stages), stages)


def plate_only(source: SceneFile) -> SceneFile:
    """The scene without its damper.

    Raises:
        BadInput: it has no plate.
    """
    if source.scene.plate is None:
        raise BadInput("the table is missing: campbell needs a plate", file=source.name, key="[plate]")
    return source.plate_alone()


def at_one_speed(source: SceneFile, rpm: float | None = None) -> SceneFile:
    """The scene at one speed [rev/min]; by default its middle one.

    Raises:
        BadInput: it has no damper, or nothing spins so fast.
    """
    if source.scene.damper is None:
        raise BadInput("the table is missing: ringdown needs a damper", file=source.name, key="[damper]")
    speeds = sorted(source.scene.rotor.speeds)
    omega = speeds[(len(speeds) - 1) // 2]
    if rpm is not None:
        if isinstance(rpm, bool) or not isinstance(rpm, int | float):
            raise BadInput("expected a number of revolutions per minute", key="--rpm", value=rpm)
        omega = rpm * math.pi / 30
        if not 0 <= omega <= FASTEST:
            most = FASTEST * 30 / math.pi
            raise BadInput(f"expected a rotation speed between 0 and {whole(most)} rpm", key="--rpm", value=typed(rpm))
    return source.changed(rotor=source.scene.rotor.model_copy(update={"speeds": (omega,)}))
