"""From a scene to results, in one direction: plate → reduced structure → damper → results."""

from __future__ import annotations

from dataclasses import dataclass, replace

from workflows.effects.effect import Effect
from workflows.errors import read_from
from workflows.findings.of_the_damper import remarks
from workflows.progress import Stages
from workflows.scene.file import DEFAULT, SceneLike, opened
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage as ringdowns
from workflows.solve import felt, records, resources
from workflows.solve import plate_stage as plate
from workflows.solve.decided import Decided, decide
from workflows.solve.plate_stage import PlateAnswer
from workflows.solve.records import Results, SpeedPoint


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

    `decided`: what :func:`workflows.solve.decided.decide` says of the source, where that is known.

    Raises:
        BadInput, NoAnswer: see :func:`workflows.solve.plate_stage.solve`.
    """
    found = decided or decide(source, stages)
    if found.form is None:
        points = tuple(felt.known_structure(source.scene, omega) for omega in source.scene.rotor.speeds)
        return Solved(source, found.effects, points, None)
    answer = plate.solve(source, found, stages, shapes=shapes, size=size)
    return Solved(source, found.effects, answer.points, answer, found.mesh_sha256)


def damped(found: Solved, stages: Stages) -> Solved:
    """Ring the damper down on a structure at every speed; a scene without a damper stays as it is."""
    scene = found.source.scene
    if scene.damper is None:
        return found
    with read_from(found.source.name):
        points = ringdowns.simulate(scene, found.effects, found.points, stages, records.shown(found.points))
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
