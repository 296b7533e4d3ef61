"""How long a run takes and how much memory, reckoned from a small one: coarse meshes, few speeds, few cycles.

The first meshes of the search tell how fine the last will be (Richardson 1911), and their times what it costs on this
machine; they are followed as far as a few seconds go. Where the first meshes are large, solids and many cells from a
file, small plates like these are solved instead (`workflows.solve.likeness`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, log
from time import perf_counter
from typing import TYPE_CHECKING

from workflows.effects.effect import Effect
from workflows.errors import SpindampError
from workflows.scene.source import SceneFile
from workflows.solve import at_the_cavity, felt, likeness, needs, plate_records, reckoned
from workflows.solve import damper_stage as ringdowns
from workflows.solve import plate_stage as plate
from workflows.solve.answering import answering
from workflows.solve.decided import Decided
from workflows.solve.records import SpeedPoint
from workflows.stages import Stages
from workflows.wording import significant

if TYPE_CHECKING:
    from fem.meshes.ladder import Planform
    from workflows.solve.plate_records import Discrete

_UNKNOWNS, PATIENCE = (4000, 16_000, 64_000), 5.0
"""Up to which meshes are tried here, one after the other as long as the next should take no more seconds than that."""

_GROWTH, _SLOWEST, _FASTEST = 1.2, 0.9, 1.6
"""Power of the unknowns that the work grows with, where two trials do not tell; the least and the largest believed."""

_SPEEDS, _CYCLES = 3, 1000
"""Up to which there are speeds and cycles here."""

_SEARCH = 1.3
"""Work of a search over that of the last of its meshes, each of which is about half as large as the next."""

_START = 5.0
"""Seconds to start the program, to draw and to write."""

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
    small = _small(source)
    if decided.form is None:
        points = tuple(felt.known_structure(small.scene, omega) for omega in small.scene.rotor.speeds)
        memory, seconds = 0.0, 0.0
    else:
        points, memory, seconds = _plate(source, small, decided)
    cycles, spent = _damper(source, small, decided.effects, points)
    lines = needs.of_lines(source.scene)
    return Need(needs.BASE + memory + cycles * needs.CYCLE + lines, _START + seconds + spent)


def _small(source: SceneFile) -> SceneFile:
    """The scene at its lowest speed, its highest and one between."""
    speeds = sorted(source.scene.rotor.speeds)
    few = tuple(dict.fromkeys((speeds[0], speeds[len(speeds) // 2], speeds[-1])))
    rotor = source.scene.rotor.model_copy(update={"speeds": few})
    return replace(source, scene=source.scene.model_copy(update={"rotor": rotor}))


def _plate(source: SceneFile, small: SceneFile, decided: Decided) -> tuple[tuple[SpeedPoint, ...], float, float]:
    """Speed points on a coarse mesh; bytes and seconds on that which the search will end with."""
    (form, _), model = decided.plate, plate.model(source, decided)
    first = reckoned.first_unknowns(source, form, model)
    memory, _ = reckoned.reckon(source, decided.effects, model, first, 1.0)
    needs.refuse(source, needs.BASE + memory + needs.of_lines(source.scene), 0.0)
    slowness = reckoned.pace()  # also loads what solves plates
    found: _Trial | None = None
    if first > _UNKNOWNS[0]:
        try:
            alike = likeness.known(source, small, decided, model)
        except (SpindampError, ArithmeticError):  # of small plates, which says nothing of the large one
            last = reckoned.searched(source, decided, model)[-1]
            return (), *reckoned.reckon(source, decided.effects, model, last, slowness)
        if first > _UNKNOWNS[-1] or alike.once > PATIENCE:
            return alike.points, alike.memory, alike.seconds
    for most in (size for size in _UNKNOWNS if size >= first):
        if found is not None and found.spent * (most / found.unknowns) ** _GROWTH >= PATIENCE:
            break
        found = _tried(source, small, decided, most, found)
        if found.last:
            break
    if found is None:
        raise ValueError("no mesh was tried")
    return found.points, found.memory, found.seconds


@dataclass(frozen=True, eq=False)
class _Trial:
    """A search that ends with a coarse mesh: its unknowns and seconds, and what the whole search takes by it."""

    unknowns: float
    spent: float
    points: tuple[SpeedPoint, ...]
    memory: float
    seconds: float
    last: bool


def _tried(source: SceneFile, small: SceneFile, decided: Decided, most: float, before: _Trial | None) -> _Trial:
    """Solve the plate on meshes of no more than so many unknowns, and see what finer ones take."""
    (form, _), scene = decided.plate, source.scene
    with answering(source):
        began = perf_counter()
        discrete = plate.discretise(small, decided, Stages(visible=False), most=int(most))
        searched = perf_counter()
        operators = discrete.choice.operators
        diagram = plate.sweep(small, discrete)
        reduced, at_cavity = at_the_cavity.felt(small, decided.effects, operators, diagram)
        swept = perf_counter()

    large, model = operators.effects.large_deflection, operators.model.theory
    here, spent = float(operators.mass.shape[0]), swept - began
    there = here * _growth(source, form, discrete, here)
    each = len(scene.rotor.speeds) / len(small.scene.rotor.speeds) if large else 1.0
    power = _GROWTH
    if before is not None and here > 2.0 * before.unknowns:
        power = min(max(log(spent / before.spent) / log(here / before.unknowns), _SLOWEST), _FASTEST)
    search = (searched - began) * (1.0 if there == here else _SEARCH)
    seconds = (search + (swept - searched) * each) * (there / here) ** power
    points = plate_records.at_speeds(small, discrete, diagram, reduced, at_cavity)
    return _Trial(here, spent, points, needs.of_a_plate(model, there, scene.rotor.modes, large), seconds, there == here)


def _growth(source: SceneFile, form: Planform, discrete: Discrete, unknowns: float) -> float:
    """By what factor the unknowns grow until the accuracy asked for is met, or the search ends."""
    from fem.accuracy.budget import SURE
    from fem.accuracy.choose_mesh import MOST_UNKNOWNS, next_size

    choice = discrete.choice
    left = dict(choice.tried).get(choice.size, 0.0)  # without what no mesh takes away, which the search leaves out
    if not left > SURE * choice.tolerance:
        return 1.0
    model = choice.operators.model.theory
    fit = needs.most_unknowns(source, form, model, choice.operators.effects.large_deflection)
    room = min(MOST_UNKNOWNS[model.partition("/")[0]], fit) / unknowns
    following = next_size(form, choice.size, left / choice.tolerance, room, step=inf)
    return 1.0 if following is None else (following / choice.size) ** 2


def _damper(
    source: SceneFile, small: SceneFile, effects: dict[str, Effect], points: tuple[SpeedPoint, ...]
) -> tuple[float, float]:
    """Cycles of all ring-downs, and the seconds that they and the damper's own figures take."""
    release = source.scene.release
    if release is None or not points:
        return 0.0, 0.0
    asked = None if isinstance(release.cycles, str) else release.cycles
    few = release.model_copy(update={"cycles": "auto" if asked is None else min(asked, _CYCLES)})
    scene = small.scene.model_copy(update={"release": few})
    began = perf_counter()
    ringdowns.simulate(scene, effects, points[:1], Stages(visible=False))  # loads and compiles
    tried = points if perf_counter() - began <= PATIENCE else points[-1:]
    began = perf_counter()
    found = ringdowns.simulate(scene, effects, tried, Stages(visible=False))
    spent = (perf_counter() - began) / len(tried)
    cycles = sum(point.damping.sdc.size for point in found if point.damping is not None) / len(tried)
    speeds = len(source.scene.rotor.speeds)
    more = 1.0 if asked is None else max(asked / _CYCLES, 1.0)
    return speeds * cycles * more, speeds * spent * more
