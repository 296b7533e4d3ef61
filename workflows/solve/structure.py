"""The plate's stages: mesh, prestress, modes at every speed, reduction to what the damper feels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from workflows.effects.definition import Effect, LeftOut
from workflows.effects.selection import EFFECTS, OF_THE_PLATE
from workflows.errors import BadInput
from workflows.progress import Stages, Step
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import coupling, resources, results, self_check
from workflows.solve.error_translation import answering
from workflows.solve.model_choice import Decided, with_layers
from workflows.solve.results import Diagram, Discrete, SpeedPoint, Surface, Theory

if TYPE_CHECKING:
    import fem


_STEPS = 100
"""Speeds between the lowest and the highest by which modes are followed, where a speed costs next to nothing."""

_MODES_FOLLOWED = 12
"""Modes up to which that is so."""

_STIFFENED = 50.0
"""Growth of a squared frequency from the lowest speed to the highest up to which that is so: one reduced basis answers
all speeds between. Beyond, they take several, or are solved one by one."""

_FEW_STEPS = 12
"""Speeds by which modes are followed there."""

_FOR_BENDING = 4
"""Modes that are looked through for the first bending mode."""


@dataclass(frozen=True, eq=False)
class PlateAnswer:
    """The plate, solved at every speed."""

    points: tuple[SpeedPoint, ...]
    surface: Surface | None
    theory: Theory
    diagram: Diagram


def solve(
    source: SceneFile,
    decided: Decided,
    stages: Stages,
    *,
    shapes: bool = True,
    size: int | None = None,
) -> PlateAnswer:
    """Solve the plate of a scene at all its speeds; with `shapes` its surface and mode shapes are kept.

    `decided`: what the scene calls for. `size` is that of a mesh of its planform's ladder; without it, the accuracy
    asked for chooses.

    Speeds at which the plate diverges have no point, as long as any speed has one.

    Raises:
        BadInput: the theory or a place on the plate is no good.
        NoAnswer: the plate diverges at all speeds, or is too thin for its theory in double precision.
    """
    with answering(source), stages("modes"):
        discrete = discretise(source, decided, stages, size)
    points, diagram, numbers = points_on(source, decided, discrete, stages)
    asked = source.scene.rotor.speeds
    with stages("modes"):
        surface = (
            results.surface(discrete.choice.operators, diagram, numbers, source.scene.rotor.modes) if shapes else None
        )
        beyond = results.diagram_of(discrete, diagram, source.scene.rotor.modes, asked)
    return PlateAnswer(points, surface, discrete.theory, beyond)


def points_on(
    source: SceneFile, decided: Decided, discrete: Discrete, stages: Stages
) -> tuple[tuple[SpeedPoint, ...], fem.Campbell, list[int]]:
    """What is found at the speeds of a scene on matrices that are known; the sweep, and their numbers in it.

    Raises:
        BadInput, NoAnswer: see :func:`solve`.
    """
    with answering(source):
        with stages("modes", counted(source.scene, discrete.choice.operators)) as step:
            diagram = sweep(source, discrete, step)
        with stages("reduction"):
            reduced, at_cavity = coupling.felt(source, decided.effects, discrete.choice.operators, diagram)
    known = {float(omega): number for number, omega in enumerate(diagram.omega)}
    numbers = [known[omega] for omega in source.scene.rotor.speeds if omega in known]
    with stages("modes"):
        return results.points(source, discrete, diagram, numbers, reduced, at_cavity), diagram, numbers


def discretise(
    source: SceneFile,
    decided: Decided,
    stages: Stages,
    size: int | None = None,
) -> Discrete:
    """Matrices on the cheapest mesh whose estimated errors meet the accuracy asked for, or on the finest.

    With a `size` of the planform's ladder they are on that mesh, with errors that are not known.
    """
    from fem import Choice, Effects, MeshError, PlaceError, assemble, choose_mesh, with_coriolis

    scene, effects = source.scene, decided.effects
    form, theory = decided.plate
    plain = Effects(**{name: effects[name].on for name in OF_THE_PLATE if EFFECTS[name].on_the_mesh})
    rotor = plate_mesh.rotor(scene)
    model, layers = with_layers(source, form, theory)

    def build(size: int) -> fem.Operators:
        with stages("mesh"):
            plate = plate_mesh.plate(source, form.mesh(size), form)
        with stages("prestress"):
            return assemble(plate, rotor, plain, model)

    def whole(operators: fem.Operators) -> fem.Operators:
        return with_coriolis(operators) if effects["coriolis"].on else operators

    if size is not None:
        unknown = np.full((1, max(scene.rotor.modes, _FOR_BENDING)), np.nan)
        choice = Choice(whole(build(size)), size, np.array([max(scene.rotor.speeds)]), unknown, np.inf)
        return Discrete(choice, theory, plate_mesh.in_words(source, form, size), layers, _left_out(effects))
    try:
        left_out = sum(found.largest for found in _left_out(effects).values())
        tolerance = scene.budget.mesh(layers + (theory.model_error or 0.0), left_out)
        fit = resources.most_unknowns(source, form, model, plain.large_deflection)
        choice = choose_mesh(form, build, scene.rotor.speeds, scene.rotor.modes, tolerance, fit)
        choice = replace(choice, operators=whole(choice.operators))
    except MeshError as error:
        raise BadInput(str(error), file=source.name, key="[plate]") from error
    except PlaceError as error:
        raise plate_mesh.off_the_plate(source, error) from error
    described = plate_mesh.in_words(source, form, choice.size)
    if layers:
        described += f", {model.removeprefix('solid/')} layers of bricks"
    return Discrete(choice, theory, described, layers, _left_out(effects))


def _left_out(effects: dict[str, Effect]) -> dict[str, LeftOut]:
    return {name: effect.left_out for name, effect in effects.items() if effect.left_out is not None}


def sweep(source: SceneFile, discrete: Discrete, step: Step | None = None) -> fem.Campbell:
    """Modes at every speed asked for and, where they cost next to nothing, at others by which they are followed."""
    from fem import campbell

    def progress(number: int) -> None:
        if step is not None:
            step.advance(f"{number} of {speeds.size} speeds")

    self_check.plates()
    scene, operators = source.scene, discrete.choice.operators
    speeds = np.array(scene.rotor.speeds)
    if not one_by_one(scene, operators):
        speeds = np.union1d(speeds, steps(speeds.min(), speeds.max(), discrete.choice.rates))
    count = scene.rotor.modes if scene.damper is None else max(scene.rotor.modes, _FOR_BENDING)
    return campbell(
        operators, speeds, count, tolerance=scene.budget.basis, states=discrete.choice.states, progress=progress
    )


def counted(scene: Scene, operators: fem.Operators) -> int | None:
    """How many speeds the sweep solves, each by itself; None where one reduced basis answers all of them."""
    from fem.sweep.campbell import hardly_any

    speeds = len(set(scene.rotor.speeds))
    alone = operators.effects.large_deflection or (
        one_by_one(scene, operators) and hardly_any(speeds, scene.rotor.modes)
    )
    return speeds if alone else None


def one_by_one(scene: Scene, operators: fem.Operators) -> bool:
    """Whether every speed is solved by itself, so that speeds beside those asked for would cost."""
    return operators.effects.large_deflection or scene.rotor.modes > _MODES_FOLLOWED


def steps(low: float, high: float, rates: np.ndarray) -> np.ndarray:
    """Speeds between low and high in rad/s: evenly, or such that modes that are stiffened much grow by like factors.

    rates: (k, count), of the modes at the lowest speed and the highest, as far as they are known.
    """
    growth = float((rates[-1] / rates[0]).max() ** 2)
    if not growth > _STIFFENED:
        return np.linspace(low, high, _STEPS)
    share = (growth ** np.linspace(0.0, 1.0, _FEW_STEPS + 2)[1:-1] - 1.0) / (growth - 1.0)
    return np.sqrt(low**2 + share * (high**2 - low**2))
