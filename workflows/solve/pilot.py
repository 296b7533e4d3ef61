"""How long a run takes and how much memory, reckoned from a small one: coarse meshes, few speeds, few cycles.

The search for a mesh is followed as far as a few seconds go; it says which mesh it would try next, and its errors how
many more there will be (Richardson 1911). What it took, and the sweep over speeds on such a mesh, are the price of the
rest (`workflows.solve.price`). Where the first meshes are large, solids and many cells from a file, small plates like
these are solved instead (`workflows.solve.likeness`).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from workflows.effects.effect import Effect
from workflows.errors import SpindampError
from workflows.scene.source import SceneFile
from workflows.solve import at_the_cavity, felt, likeness, needs, plate_records, reckoned
from workflows.solve import damper_stage as ringdowns
from workflows.solve import plate_stage as plate
from workflows.solve.answering import answering
from workflows.solve.decided import Decided
from workflows.solve.fill import NOTHING, Fill, fill
from workflows.solve.price import Part, grown, timed
from workflows.solve.records import SpeedPoint
from workflows.stages import Stages
from workflows.wording import significant

if TYPE_CHECKING:
    from fem.meshes.ladder import Planform
    from workflows.solve.plate_records import Discrete

_UNKNOWNS, PATIENCE = (6000, 20_000, 80_000), 3.0
"""Up to which meshes are tried here, one after the other as long as the next should take no more seconds than that."""

_GROWTH = 1.3
"""Power of the unknowns that the work grows with, where it is only to be known whether a mesh takes long."""

_FEW, _MANY_SPEEDS, _CYCLES = 4, 300, 1000
"""Up to which there are speeds here where each is solved by itself, speeds of one basis, and cycles."""

_START = 5.0
"""Seconds to start the program, to draw and to write."""

_PROBED = 3
"""Speeds at which the damper is tried."""

_LONG, _WITHIN = 60.0, 3.0
"""Seconds that count as long; the factor within which they are reckoned without solving anything, and memory too."""

_MANY, _MANY_CYCLES = 200, 100_000
"""Numbers of speeds and cycles that count as many."""


@dataclass(frozen=True)
class Need:
    """What a run takes, within a factor of two: bytes of memory, seconds on this machine as busy as it is now."""

    memory: float
    seconds: float


def in_words(found: Need) -> str:
    """For people."""
    seconds = found.seconds
    time = (
        f"{significant(seconds, 1)} s"
        if seconds < 90
        else f"{significant(seconds / 60, 2)} minutes"
        if seconds < 5400
        else f"{significant(seconds / 3600, 2)} hours"
    )
    return f"A run takes about {time} and {needs.in_words(found.memory)} of memory."


def may_be_large(source: SceneFile, decided: Decided) -> bool:
    """Whether a run of a scene may take a minute, or its first meshes much memory, so that it is worth a `need`.

    Reckoned from the scene alone, which takes next to nothing. Finer meshes end where the memory does.
    """
    scene, memory, seconds = source.scene, 0.0, 0.0
    if decided.form is not None:
        model = plate.model(source, decided)
        first = reckoned.first_unknowns(source, decided.form, model)
        usual = reckoned.usual_unknowns(source, decided, model)
        memory, _ = reckoned.reckon(source, decided.effects, model, first, 1.0)
        _, seconds = reckoned.reckon(source, decided.effects, model, usual, 1.0)
    cycles = 0 if scene.release is None or isinstance(scene.release.cycles, str) else scene.release.cycles
    speeds = len(scene.rotor.speeds)
    many = speeds > _MANY or speeds * cycles > _MANY_CYCLES
    return many or seconds > _LONG / _WITHIN or memory > needs.available() / _WITHIN


def need(source: SceneFile, decided: Decided) -> Need:
    """Reckon what a run of a scene takes.

    Raises:
        BadInput, NoAnswer: what a run would raise, or its first meshes already ask for too much memory.
    """
    began = perf_counter()
    if decided.form is None:
        speeds = _some(source, _PROBED).scene.rotor.speeds
        points = tuple(felt.known_structure(source.scene, omega) for omega in speeds)
        memory, seconds = 0.0, 0.0
    else:
        points, memory, seconds = _plate(source, decided)
    cycles, spent = _damper(source, decided.effects, points)
    lines = needs.of_lines(source.scene)
    own = perf_counter() - began if may_be_large(source, decided) else 0.0
    return Need(needs.BASE + memory + cycles * needs.CYCLE + lines, _START + own + seconds + spent)


def _some(source: SceneFile, most: int) -> SceneFile:
    """The scene at no more than so many of its speeds, the lowest and the highest among them."""
    speeds = sorted(source.scene.rotor.speeds)
    if len(speeds) <= most:
        return source
    few = tuple(speeds[round(k * (len(speeds) - 1) / (most - 1))] for k in range(most))
    rotor = source.scene.rotor.model_copy(update={"speeds": few})
    return replace(source, scene=source.scene.model_copy(update={"rotor": rotor}))


def _plate(source: SceneFile, decided: Decided) -> tuple[tuple[SpeedPoint, ...], float, float]:
    """Speed points on a coarse mesh; bytes and seconds on that which the search will end with."""
    (form, _), model = decided.plate, plate.model(source, decided)
    first = reckoned.first_unknowns(source, form, model)
    memory, _ = reckoned.reckon(source, decided.effects, model, first, 1.0)
    needs.refuse(source, needs.BASE + memory + needs.of_lines(source.scene), 0.0)
    reckoned.pace()  # loads what solves plates
    alone = plate.each_alone(source.scene, decided.effects)
    small = _some(source, _FEW if alone else _MANY_SPEEDS)
    trials: list[_Trial] = []
    if first > _UNKNOWNS[0]:
        with suppress(SpindampError, ArithmeticError):  # of small plates, which says nothing of the large one
            trials = _alike(small, decided, model)
    sizes = tuple(reckoned.sizes_searched(source, decided, model))
    begun = sum((fill(model, form.mesh(size)) for size in sizes[:2]), NOTHING)
    if not trials or grown([trial.search for trial in trials], begun) <= PATIENCE:
        trials = _followed(small, decided, [most for most in _UNKNOWNS if most >= first] or [_UNKNOWNS[-1]], trials)
        choice = trials[-1].discrete.choice
        sizes = (*(size for size, _ in choice.tried), *ahead(source, form, trials[-1].discrete)) or (choice.size,)
    large = decided.effects["large_deflection"].on
    most = max(needs.unknowns(model, form.mesh(size)) for size in sizes)
    meshes = [fill(model, form.mesh(size)) for size in sizes]
    seconds = _seconds(source, decided, trials, meshes, len(source.scene.rotor.speeds) / len(small.scene.rotor.speeds))
    points = next(trial.points for trial in reversed(trials) if trial.points is not None)
    return points, needs.of_a_plate(model, most, source.scene.rotor.modes, large), seconds


def _seconds(source: SceneFile, decided: Decided, trials: list[_Trial], meshes: list[Fill], each: float) -> float:
    """Seconds of a run on the meshes of a search, of which the last is swept; `each`: speeds for one that was tried."""
    each = each if plate.each_alone(source.scene, decided.effects) else 1.0
    bent = decided.effects["large_deflection"].on or decided.effects["coriolis"].on
    search = grown([trial.search for trial in trials], sum(meshes, NOTHING))
    sweep, reduction = (
        grown([part for trial in trials if (part := getattr(trial, name)) is not None], meshes[-1])
        for name in ("sweep", "reduction")
    )
    return search + each * sweep + (each if bent else 1.0) * reduction


@dataclass(frozen=True, eq=False)
class _Trial:
    """A search that ends with a coarse mesh, and what is done on that; the search alone where that would take long."""

    discrete: Discrete
    search: Part
    sweep: Part | None = None
    reduction: Part | None = None
    points: tuple[SpeedPoint, ...] | None = None

    @property
    def unknowns(self) -> float:
        """Of its mesh."""
        return float(self.discrete.choice.operators.mass.shape[0])

    @property
    def next(self) -> float:
        """Unknowns of the mesh that the search would go on with; infinite where it has ended."""
        following = self.discrete.choice.following
        return np.inf if following is None else self.unknowns * (following / self.discrete.choice.size) ** 2

    @property
    def spent(self) -> float:
        """Seconds of all parts."""
        return sum(part.seconds for part in (self.search, self.sweep, self.reduction) if part is not None)


def _alike(small: SceneFile, decided: Decided, model: str) -> list[_Trial]:
    """Small plates like that of the scene, the second as long as it takes no longer than patience."""
    trials: list[_Trial] = []
    for unknowns in likeness.UNKNOWNS:
        if not trials or _foreseen(trials, unknowns) <= PATIENCE:
            trials.append(_tried(small, likeness.like(decided, model, unknowns), model, 0.0))
    return trials


def _followed(small: SceneFile, decided: Decided, mosts: list[int], trials: list[_Trial]) -> list[_Trial]:
    """The search of the scene up to more and more unknowns, as far as patience goes, and its sweep as far as that.

    trials: of plates like it, which are kept.
    """
    model, own = plate.model(small, decided), list[_Trial]()
    for most in mosts:
        if own and own[-1].next > most:
            continue
        swept = not own + trials or _foreseen(trials + own, most) <= PATIENCE
        if own and own[-1].search.seconds * (most / own[-1].unknowns) ** _GROWTH > PATIENCE:
            break
        own.append(_tried(small, decided, model, most, swept))
    return trials + own


def _foreseen(trials: list[_Trial], unknowns: float) -> float:
    """Seconds of a trial with more unknowns, roughly, by the last that was swept."""
    last = next(trial for trial in reversed(trials) if trial.sweep is not None)
    return last.spent * float((unknowns / last.unknowns) ** _GROWTH)


def _tried(small: SceneFile, decided: Decided, model: str, until: float, swept: bool = True) -> _Trial:
    """Solve the plate on the meshes before those of so many unknowns."""
    (form, _), quiet = decided.plate, Stages(visible=False)
    with answering(small):
        discrete, searched = timed(lambda: plate.discretise(small, decided, quiet, until=until))
        choice = discrete.choice
        sizes = [size for size, _ in choice.tried] or [choice.size]
        on = [fill(model, form.mesh(size)) for size in sizes]
        trial = _Trial(discrete, searched(sum(on, NOTHING)))
        if not swept:
            return trial
        diagram, sweeping = timed(lambda: plate.sweep(small, discrete))
        found, reducing = timed(lambda: at_the_cavity.felt(small, decided.effects, choice.operators, diagram))
        last = fill(model, form.mesh(choice.size))
        points = plate_records.at_speeds(_some(small, _PROBED), discrete, diagram, *found)
    return replace(trial, sweep=sweeping(last), reduction=reducing(last), points=points)


def ahead(source: SceneFile, form: Planform, discrete: Discrete) -> tuple[int, ...]:
    """Sizes that a search will still try after it was ended: the next, and others if its errors fall as they should."""
    from fem.accuracy.budget import SURE
    from fem.accuracy.choose_mesh import MOST_UNKNOWNS, next_size

    choice, found, following = discrete.choice, list[int](), discrete.choice.following
    operators = choice.operators
    model, here = operators.model.theory, float(operators.mass.shape[0])
    fit = needs.most_unknowns(source, form, model, operators.effects.large_deflection)
    most = min(MOST_UNKNOWNS[model.partition("/")[0]], fit)
    size, left = choice.size, dict(choice.tried).get(choice.size, 0.0)
    while following is not None:
        found.append(following)
        left *= (size / following) ** (0.5 * sum(form.orders))
        size = following
        room = most / (here * (size / choice.size) ** 2)
        met = left <= SURE * choice.tolerance
        following = None if met else next_size(form, size, left / choice.tolerance, room)
    return tuple(found)


def _damper(source: SceneFile, effects: dict[str, Effect], points: tuple[SpeedPoint, ...]) -> tuple[float, float]:
    """Cycles of all ring-downs, and the seconds that they and the damper's own figures take."""
    from damper import ringdown

    release = source.scene.release
    if release is None or not points:
        return 0.0, 0.0
    asked = None if isinstance(release.cycles, str) else release.cycles
    few = release.model_copy(update={"cycles": "auto" if asked is None else min(asked, _CYCLES)})
    scene, quiet = source.scene.model_copy(update={"release": few}), Stages(visible=False)
    system = ringdowns.particle_damper(scene, effects, points[-1])
    ringdown(system, felt.released_at(scene, points[-1]), 1)  # loads and compiles
    began, found = perf_counter(), list[SpeedPoint]()
    for point in reversed(points):
        found += ringdowns.simulate(scene, effects, (point,), quiet)
        if perf_counter() - began > PATIENCE:
            break
    spent = (perf_counter() - began) / len(found)
    cycles = sum(point.damping.sdc.size for point in found if point.damping is not None) / len(found)
    speeds = len(source.scene.rotor.speeds)
    more = 1.0 if asked is None else max(asked / _CYCLES, 1.0)
    return speeds * cycles * more, speeds * spent * more
