"""A scene's structure, for every command that needs one: mesh, prestress, modes at every speed, reduction."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

import fem
from fem.reduction.pulse import inverse_mass
from workflows.effects.definition import Effect
from workflows.effects.selection import OF_THE_PLATE
from workflows.errors import present
from workflows.progress import LOG, Stages, Step
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import coupling, resources, results, self_check
from workflows.solve.blade import space_of
from workflows.solve.model_choice import ModelChoice, choose_model, translated_errors
from workflows.solve.results import Cavity, Diagram, Discrete, Floats, Results, SpeedPoint, Surface, Theory, copy_fields

if TYPE_CHECKING:
    from fem.sweep.reduced_basis import ReducedBasis

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


_MASSES = 256
"""Masses of balls for which a plate's points are kept."""


@dataclass(frozen=True, eq=False)
class PlateSolution:
    """A plate at the speeds of a scene that it has an answer at, for dampers of any mass at one place.

    Attributes:
        discrete: its matrices; diagram: the sweep over speeds; numbers: of the points in it.
        points: without a damper.
        reduction: to the damper's place; None without one.
    """

    discrete: Discrete
    diagram: fem.Campbell
    numbers: tuple[int, ...]
    points: tuple[SpeedPoint, ...]
    reduction: fem.Reduction | None
    _coupled: dict[tuple[float | None, float | None, bool], tuple[SpeedPoint, ...]] = field(
        default_factory=dict, init=False, repr=False
    )

    def with_ball(self, source: SceneFile, effects: dict[str, Effect]) -> tuple[SpeedPoint, ...]:
        """The points with the structure as the damper of this scene meets it, which may be another than at first.

        Raises:
            BadInput: too few modes to find the bending mode among.
        """
        damper, modal = source.scene.damper, effects["structural_modes"].on
        if damper is None or self.reduction is None:
            return self.points
        key = (damper.balls, damper.mass_ratio, modal)
        if key not in self._coupled:
            if len(self._coupled) >= _MASSES:
                self._coupled.clear()
            reduced, bends = coupling.with_ball(source, self.reduction), map(self.reduction.bending, self.numbers)
            modes = coupling.cavity_modes(self.reduction, reduced) if modal else [()] * len(reduced)
            self._coupled[key] = tuple(
                replace(point, reduced=reduced[k], cavity_modes=modes[k], root_strain=strain, tip_motion=motion)
                for point, k, (strain, motion) in zip(self.points, self.numbers, bends, strict=True)
            )
        return self._coupled[key]

    def beside(self, source: SceneFile, cavity: Cavity | None) -> PlateSolution:
        """The same plate with cavities that take as much metal out of it; what they leave unknown may differ."""
        discrete = replace(self.discrete, cavity=cavity)
        return replace(self, discrete=discrete, points=results.points(source, discrete, self.diagram, self.numbers))

    @cached_property
    def first_surface(self) -> Surface:
        """The mid-surface with the first mode at the first speed, by which its strength is judged."""
        return self.surface(speeds=1)

    def surface(self, speeds: int | None = None, modes: int = 1) -> Surface:
        """The mid-surface with mode shapes of the first speeds; None: of all."""
        return results.surface(self.discrete.choice.operators, self.diagram, self.numbers[:speeds], modes)


@dataclass(frozen=True, eq=False)
class StructureState:
    """The structure of a scene at its speeds, as a damper meets it.

    Attributes:
        source: the scene, with these speeds; effects: of plate and damper.
        points: one for each speed that has an answer; plate: None where the structure is given.
        surface: of the plate, as far as it is kept; diagram: what a Campbell diagram has beside the points.
        solver: what gives it at other speeds.
    """

    source: SceneFile
    effects: dict[str, Effect]
    points: tuple[SpeedPoint, ...]
    plate: PlateSolution | None = None
    surface: Surface | None = None
    diagram: Diagram | None = None
    mesh_sha256: str | None = None
    solver: StructureSolver | None = None

    @property
    def theory(self) -> Theory | None:
        """The plate's."""
        return None if self.plate is None else self.plate.discrete.theory

    @cached_property
    def by_speed(self) -> dict[float, SpeedPoint]:
        """The points by their speed [rad/s]."""
        return {point.omega: point for point in self.points}

    def results(self, stages: Stages | None = None) -> Results:
        """A run's results."""
        timings = {} if stages is None else stages.timings()
        scene, notes = self.source.scene, self.source.remarks
        return copy_fields(Results, self, scene=scene, speeds=self.points, notes=notes, timings=timings)

    def with_pictures(self, *, shapes: bool = True) -> StructureState:
        """With what the pictures of a run show: veerings, lost speeds and, with `shapes`, the plate's surface."""
        rotor, plate = self.source.scene.rotor, self.plate
        if self.solver is not None and (space := self.solver.space) is not None:
            speeds = [point.omega for point in self.points]
            drawn = space.surface(speeds, rotor.modes if shapes else 1)
            return replace(self, surface=drawn, diagram=Diagram(space.described))
        if plate is None:
            return self
        surface = plate.surface(modes=rotor.modes) if shapes else self.surface
        diagram = results.diagram_of(plate.discrete, plate.diagram, rotor.modes, rotor.speeds)
        return replace(self, surface=surface, diagram=diagram)


class StructureSolver:
    """Solves the structure of a scene, on one mesh, at whatever speeds are asked for."""

    def __init__(
        self, source: SceneFile, stages: Stages, choice: ModelChoice | None = None, size: int | None = None
    ) -> None:
        """Settle mesh, effects and theory, and assemble the plate's matrices.

        Args:
            source: the scene.
            stages: the clock.
            choice: what the scene calls for, where that is known.
            size: that of a mesh of its planform's sequence; without it, the accuracy asked for chooses.

        Raises:
            BadInput: the theory or a place on the plate is no good.
            NoAnswer: the plate is too thin for its theory in double precision.
        """
        self.source, self.stages = source, stages
        if source.scene.plate is not None:
            for library in ("skfem", "fem.accuracy.mesh_selection"):  # loading is of no stage
                import_module(library)
        self.choice = choose_model(source, stages) if choice is None else choice
        for name, effect in self.choice.effects.items():
            LOG.info("effect %s %s: %s", name, "on" if effect.on else "off", effect.why)
        self.discrete: Discrete | None = None
        self._uncut: Discrete | None = None
        self._bases: WeakKeyDictionary[fem.Operators, tuple[ReducedBasis, ...]] = WeakKeyDictionary()
        with translated_errors(source), stages("modes"):
            self.space = space_of(source)
            if self.choice.form is not None:
                self._uncut = discretise(source, self.choice, stages, size)
                cavity = cavity_of(source, self._uncut, self.choice.effects)
                self.discrete = with_cavities(source, self._uncut, cavity)
        if self.space is not None:
            self.source = replace(source, remarks=(*source.remarks, *self.space.remarks))

    def with_switches(self, source: SceneFile) -> StructureSolver:
        """The same structure, met by the damper of a scene that differs in what it insists on of the ball alone."""
        other, switches = copy(self), source.scene.effects
        on = {
            name: replace(effect, on=True)
            for name, effect in self.choice.effects.items()
            if getattr(switches, name) is True
        }
        other.source, other.choice = source, replace(self.choice, effects=self.choice.effects | on)
        return other

    def with_cavities_of(
        self, source: SceneFile, effects: dict[str, Effect], like: Iterable[PlateSolution]
    ) -> PlateSolution:
        """The plate on the same mesh at the speeds of its scene, with the cavities of another scene's damper.

        Args:
            source: the other scene.
            effects: of its damper too.
            like: solutions at these speeds, of which one with the same metal in it serves.

        Raises:
            BadInput, NoAnswer: see :meth:`at`.
        """
        uncut = present(self._uncut)
        cavity = cavity_of(source, uncut, self.choice.effects | effects)
        solutions = {solution.discrete.cavity: solution for solution in like}
        if cavity in solutions:
            return solutions[cavity]
        for solution in solutions.values():
            if _metal(solution.discrete.cavity) == _metal(cavity):
                return solution.beside(source, cavity)
        return self._plate(source, with_cavities(source, uncut, cavity))

    @property
    def solves_each_speed(self) -> bool:
        """Whether every speed of the plate is solved by itself, so that more of them cost more."""
        return self.discrete is not None and one_by_one(self.source.scene, self.discrete.choice.operators)

    def at(self, speeds: Iterable[float] | None = None, *, followed: bool = True) -> StructureState:
        """The structure at speeds [rad/s], or at those of its scene.

        Speeds at which the plate diverges have no point, as long as any speed has one. Unless modes are `followed`, a
        plate's branches at one speed are not those at another.

        Raises:
            BadInput: a place on the plate, or too few modes to find the bending mode among.
            NoAnswer: the plate diverges at all speeds.
        """
        source, effects = self.source, self.choice.effects
        if speeds is not None:
            source = source.changed(rotor={"speeds": tuple(float(speed) for speed in speeds)})
        if self.space is not None:
            with translated_errors(source), self.stages("reduction"):
                points = self.space.points(source, effects)
            return StructureState(source, effects, points, mesh_sha256=self.space.sha256, solver=self)
        if self.discrete is None:
            points = tuple(coupling.known_structure(source.scene, omega) for omega in source.scene.rotor.speeds)
            return StructureState(source, effects, points, solver=self)
        plate = self._plate(source, self.discrete, followed=followed)
        with translated_errors(source), self.stages("reduction"):
            points = plate.with_ball(source, effects)
        surface = None if source.mesh is None else plate.first_surface
        return StructureState(source, effects, points, plate, surface, None, self.choice.mesh_sha256, self)

    def plate(self) -> PlateSolution:
        """The plate at the speeds of its scene, for other dampers too.

        Raises:
            BadInput, NoAnswer: see :meth:`at`.
        """
        return self._plate(self.source, present(self.discrete))

    def inverse_mass(self, durations: Sequence[float]) -> Floats | None:
        """Twice the energy that hits along axis 1 of the damper leave, over the square of their impulse, (k,) [1/kg].

        durations: of the hits (k,) [s]. None where only some of the modes are known.
        """
        if self.space is not None:
            return None if self.space.inverse_mass is None else self.space.inverse_mass(durations)
        if self._uncut is None:
            return None
        with self.stages("reduction"):
            operators = self._uncut.choice.operators
            place = operators.at_place(plate_mesh.place(self.source, operators.plate.mesh))
            return inverse_mass(operators, place.floor[[0]].toarray()[0], np.array(durations))

    def _plate(self, source: SceneFile, discrete: Discrete, *, followed: bool = True) -> PlateSolution:
        operators = discrete.choice.operators
        with translated_errors(source):
            with self.stages("modes", counted(source.scene, operators)) as step:
                diagram = sweep(source, discrete, step, self._bases.get(operators, ()), followed=followed)
                self._bases.setdefault(operators, diagram.bases)
            with self.stages("reduction"):
                damper = source.scene.damper
                reduction = None if damper is None else coupling.reduction(source, operators, diagram)
        known = {float(omega): number for number, omega in enumerate(diagram.omega)}
        numbers = tuple(known[omega] for omega in source.scene.rotor.speeds if omega in known)
        with self.stages("modes"):
            return PlateSolution(
                discrete, diagram, numbers, results.points(source, discrete, diagram, numbers), reduction
            )


def discretise(source: SceneFile, model_choice: ModelChoice, stages: Stages, size: int | None = None) -> Discrete:
    """Matrices on the cheapest mesh whose estimated errors meet the accuracy asked for, or on the finest.

    With a `size` of the planform's ladder they are on that mesh, with errors that are not known.
    """
    scene, effects = source.scene, model_choice.effects
    form, theory = model_choice.plate
    # The errors of a mesh hardly depend on Coriolis forces, which make its choice many times dearer.
    plain = fem.Effects(**{name: effects[name].on for name in OF_THE_PLATE if name != "coriolis"})
    rotor, model, layers = plate_mesh.rotor(scene), model_choice.model, model_choice.layers

    def build(size: int) -> fem.Operators:
        with stages("mesh"):
            plate = plate_mesh.plate(source, form.mesh(size), form)
        with stages("prestress"):
            tried = model_choice.tried
            alike = tried is not None and (tried.model.theory, tried.effects) == (model, plain)
            if tried is not None and alike and np.array_equal(tried.plate.mesh.p, plate.mesh.p):
                return tried
            return fem.assemble(plate, rotor, plain, model)

    def whole(operators: fem.Operators) -> fem.Operators:
        return fem.with_coriolis(operators) if effects["coriolis"].on else operators

    left_out = {name: effect.left_out for name, effect in effects.items() if effect.left_out is not None}
    if size is not None:
        unknown = np.full((1, max(scene.rotor.modes, _FOR_BENDING)), np.nan)
        choice = fem.Choice(whole(build(size)), size, np.array([max(scene.rotor.speeds)]), unknown, np.inf)
        return Discrete(choice, theory, plate_mesh.describe_mesh(source, form, size), layers, left_out)
    with source.blaming("[plate]", None, fem.MeshError), plate_mesh.placed(source):
        most = sum(effect.largest for effect in left_out.values())
        tolerance = scene.budget.mesh(layers + (theory.model_error or 0.0), most)
        fit = resources.most_unknowns(source, form, model, plain.large_deflection)
        choice = fem.choose_mesh(form, build, scene.rotor.speeds, scene.rotor.modes, tolerance, fit)
        choice = replace(choice, operators=whole(choice.operators))
    described = plate_mesh.describe_mesh(source, form, choice.size)
    if layers:
        described += f", {model.removeprefix('solid/')} layers of bricks"
    LOG.info("%s theory on %s, %d unknowns", theory.name, described, choice.operators.mass.shape[0])
    return Discrete(choice, theory, described, layers, left_out)


def cavity_of(source: SceneFile, discrete: Discrete, effects: dict[str, Effect]) -> Cavity | None:
    """What the damper's cavities take out of the plate; None: nothing, or the scene leaves it out."""
    scene, damper = source.scene, source.scene.damper
    if damper is None or not damper.cut or scene.effects.cavity_mass is False:
        return None
    at, counted = plate_mesh.place(source, discrete.choice.operators.plate.mesh), effects["cavity_mass"].on
    return Cavity(at, damper.cut, damper.cavity[0], damper.weakens, single=damper.count == 1, counted=counted)


def _metal(cavity: Cavity | None) -> tuple[float, float] | None:
    """Volume [m³] and depth [m] of what is taken out of the plate's inertia."""
    return None if cavity is None or not cavity.counted else (cavity.volume, cavity.depth)


def with_cavities(source: SceneFile, discrete: Discrete, cavity: Cavity | None) -> Discrete:
    """The same plate with cavities.

    Raises:
        BadInput: the plate has no room for them.
    """
    choice, damper = discrete.choice, source.scene.damper
    if cavity is not None and cavity.counted:
        with source.blaming("[damper] cavity", damper and damper.cavity, fem.PlaceError):
            operators = fem.with_cavity(choice.operators, cavity.at, cavity.volume, cavity.depth)
        choice = replace(choice, operators=operators, states=())
    return replace(discrete, choice=choice, cavity=cavity)


def sweep(
    source: SceneFile, discrete: Discrete, step: Step, bases: Iterable[ReducedBasis], *, followed: bool
) -> fem.Campbell:
    """Modes at every speed asked for and, where they cost next to nothing, at others by which they are followed.

    bases: of a sweep of the same plate before; followed: whether the modes at different speeds must be told apart.
    """

    def progress(number: int) -> None:
        step.advance(f"{number} of {speeds.size} speeds")

    self_check.plates()
    scene, operators = source.scene, discrete.choice.operators
    speeds = np.array(scene.rotor.speeds)
    if followed and not one_by_one(scene, operators):
        more = steps(speeds.min(), speeds.max(), discrete.choice.rates)
        if speeds.size == 1 or np.diff(np.sort(speeds)).max() > np.diff(more).min():
            speeds = np.union1d(speeds, more)
    count = scene.rotor.modes if scene.damper is None else max(scene.rotor.modes, _FOR_BENDING)
    basis, states = scene.budget.basis, discrete.choice.states
    return fem.campbell(operators, speeds, count, tolerance=basis, states=states, bases=bases, progress=progress)


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
