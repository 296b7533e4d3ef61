"""Structures for many dampers: a plate is solved once for all that sit on it, at all their speeds."""

from __future__ import annotations

import json
from collections import OrderedDict
from dataclasses import dataclass, field, replace
from threading import Lock
from typing import TYPE_CHECKING

from workflows.effects import rules
from workflows.effects.effect import Effect
from workflows.effects.table import OF_THE_DAMPER, OF_THE_PLATE
from workflows.progress import Stages
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.solve import at_the_cavity, felt, plate_records, plate_stage
from workflows.solve.answering import answering
from workflows.solve.decided import decide
from workflows.solve.plate_records import Discrete
from workflows.solve.records import SpeedPoint, Surface
from workflows.studies.sweep.placed import Carried

if TYPE_CHECKING:
    import fem
    from fem.meshes.mesh_sequence import Planform

_KEPT, _MASSES = 4, 256
"""Plates that are kept at a time, and balls' masses of each."""


@dataclass(frozen=True, eq=False)
class Solved:
    """A plate at all speeds: its effects and matrices, its modes, and the points of the speeds it has an answer at."""

    form: Planform | None
    effects: dict[str, Effect]
    discrete: Discrete
    diagram: fem.Campbell
    reduction: fem.Reduction
    points: tuple[SpeedPoint, ...]
    numbers: tuple[int, ...]
    surface: Surface | None
    carrying: dict[tuple[float | None, float | None, bool], tuple[SpeedPoint, ...]] = field(default_factory=dict)

    def with_ball(self, source: SceneFile, effects: dict[str, Effect]) -> tuple[SpeedPoint, ...]:
        """The points with what a damper of the mass in this scene feels."""
        damper, modes = source.scene.damper, effects["structural_modes"].on
        key = (None, None, modes) if damper is None else (damper.balls, damper.mass_ratio, modes)
        if key not in self.carrying:
            if len(self.carrying) >= _MASSES:
                self.carrying.clear()
            operators = self.discrete.choice.operators
            with answering(source):
                reduced = at_the_cavity.with_ball(source, self.reduction)
                at_cavity = at_the_cavity.cavity_modes(source, effects, operators, self.diagram, reduced)
            self.carrying[key] = tuple(
                replace(point, reduced=reduced[number], cavity_modes=at_cavity[number])
                for point, number in zip(self.points, self.numbers, strict=True)
            )
        return self.carrying[key]


class Plates:
    """The plates that were solved last, for as long as their dampers need them; for several threads."""

    def __init__(self) -> None:
        self._known: OrderedDict[str, Solved] = OrderedDict()
        self._lock = Lock()

    def carry(self, source: SceneFile) -> Carried:
        """The structure of a scene at all its speeds.

        Raises:
            BadInput, NoAnswer: see :func:`workflows.solve.plate_stage.solve`.
        """
        scene = source.scene
        if scene.plate is None:
            effects = rules.resolve(scene, source.name)
            known = {omega: felt.known_structure(scene, omega) for omega in scene.rotor.speeds}
            return Carried(effects, known, None)
        solved = self._solved(source)
        effects = solved.effects | of_the_damper(scene, solved.form)
        points = {point.omega: point for point in solved.with_ball(source, effects)}
        return Carried(effects, points, solved.surface)

    def _solved(self, source: SceneFile) -> Solved:
        key = plate_key(source.scene)
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key]
        found = solve(source)
        with self._lock:
            self._known[key] = found
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
        return found


def plate_key(scene: Scene) -> str:
    """What the solution of a scene's plate depends on, as text: all but the damper, of which the place counts."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"title", "damper", "release", "design"})
    damper = scene.damper
    place = None if damper is None else {"at": damper.at, "housing": damper.housing}
    return json.dumps(data | {"damper": place}, sort_keys=True)


def solve(source: SceneFile) -> Solved:
    """Solve a plate at all speeds of a scene."""
    quiet = Stages(visible=False)
    decided = decide(source, quiet)
    with answering(source):
        discrete = plate_stage.discretise(source, decided, quiet)
        diagram = plate_stage.sweep(source, discrete)
        known = {float(omega): number for number, omega in enumerate(diagram.omega)}
        numbers = [known[omega] for omega in source.scene.rotor.speeds if omega in known]
        none: list[None] = [None] * diagram.omega.size
        points = plate_records.points(source, discrete, diagram, numbers, [*none], [() for _ in none])
        reduction = at_the_cavity.reduction(source, discrete.choice.operators, diagram)
        surface = None
        if source.mesh is not None:
            surface = plate_records.surface(discrete.choice.operators, diagram, numbers[:1], 1)
    effects = {name: decided.effects[name] for name in OF_THE_PLATE}
    return Solved(decided.form, effects, discrete, diagram, reduction, points, tuple(numbers), surface)


def of_the_damper(scene: Scene, form: Planform | None) -> dict[str, Effect]:
    """The effects of a scene's damper, decided as in a run."""
    found = {}
    for name, (called, why, _) in rules.called_for(scene, form, OF_THE_DAMPER).items():
        asked = getattr(scene.effects, name)
        found[name] = Effect(called if asked == "auto" else asked is True, why)
    return found
