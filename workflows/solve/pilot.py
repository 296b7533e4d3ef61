"""How long a run takes and how much memory, reckoned from a small one: coarse meshes, few speeds, few cycles.

The search for a mesh is followed as far as a few seconds go; it says which mesh it would try next, and its errors how
many more there will be (Richardson 1911). What it took, and the sweep over speeds on such a mesh, are the price of the
rest (`workflows.solve.price`). Where the first meshes are large, solids and many cells from a file, small plates like
these are solved instead (`workflows.solve.likeness`).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from statistics import geometric_mean
from time import perf_counter

import numpy as np

from workflows.effects.effect import Effect
from workflows.errors import SpindampError
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage as ringdowns
from workflows.solve import felt, foretold, needs, reckoned
from workflows.solve import plate_stage as plate
from workflows.solve.decided import Decided
from workflows.solve.fill import NOTHING, Fill, fill
from workflows.solve.price import grown
from workflows.solve.records import SpeedPoint
from workflows.solve.trials import FIRST, PATIENCE, PROBED, Trial, alike, followed, some
from workflows.stages import Stages
from workflows.wording import significant

_FEW, _MANY_SPEEDS, _CYCLES = 4, 300, 1000
"""Up to which there are speeds here where each is solved by itself, speeds of one basis, and cycles."""

_START = 4.0
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
    began = perf_counter()
    if decided.form is None:
        speeds = some(source, PROBED).scene.rotor.speeds
        points = tuple(felt.known_structure(source.scene, omega) for omega in speeds)
        memory, seconds = 0.0, 0.0
    else:
        points, memory, seconds = _plate(source, decided)
    own = perf_counter() - began
    _compiled(source, decided.effects, points)
    began = perf_counter()
    cycles, spent = _damper(source, decided.effects, points)
    own += perf_counter() - began
    lines = needs.of_lines(source.scene)
    own = decided.seconds + (own if may_be_large(source, decided) else 0.0)
    memory += needs.of_the_program(source.scene)
    return Need(memory + cycles * needs.CYCLE + lines, _START + own + seconds + spent)


def _plate(source: SceneFile, decided: Decided) -> tuple[tuple[SpeedPoint, ...], float, float]:
    """Speed points on a coarse mesh; bytes and seconds of the search and on that which it will choose."""
    (form, _), model = decided.plate, plate.model(source, decided)
    first = reckoned.first_unknowns(source, form, model)
    memory, _ = reckoned.reckon(source, decided.effects, model, first, 1.0)
    needs.refuse(source, needs.BASE + memory + needs.of_lines(source.scene), 0.0)
    reckoned.pace()  # loads what solves plates
    alone = plate.each_alone(source.scene, decided.effects)
    small = some(source, _FEW if alone else _MANY_SPEEDS)
    trials: list[Trial] = []
    if first > FIRST:
        with suppress(SpindampError, ArithmeticError):  # of small plates, which says nothing of the large one
            trials = alike(small, decided, model)
    courses = foretold.guessed(source, decided, model, trials)
    filled = cache(lambda size: fill(model, form.mesh(size)))
    begun = sum((filled(size) for size in courses[0].sizes[:2]), NOTHING)
    if not trials or grown([trial.search for trial in trials], begun) <= PATIENCE:
        trials = followed(small, decided, trials)
        courses = foretold.ahead(source, form, trials[-1])
    large, modes = decided.effects["large_deflection"].on, source.scene.rotor.modes
    each = len(source.scene.rotor.speeds) / len(small.scene.rotor.speeds)
    taken = []
    for course in courses:
        most = max(course.sizes)
        search = sum((filled(size) for size in course.sizes), NOTHING)
        seconds = _seconds(source, decided, trials, search, filled(course.chosen), each)
        taken.append((needs.of_a_mesh(model, filled(most), modes, large), seconds))
    points = next(trial.points for trial in reversed(trials) if trial.points is not None)
    memory, seconds = (geometric_mean(of) for of in zip(*taken, strict=True))
    return points, memory, seconds


def _seconds(
    source: SceneFile, decided: Decided, trials: list[Trial], searched: Fill, swept: Fill, each: float
) -> float:
    """Seconds of a run on the meshes of a search and on that which it chose; `each`: speeds for one that was tried."""
    each = each if plate.each_alone(source.scene, decided.effects) else 1.0
    bent = decided.effects["large_deflection"].on or decided.effects["coriolis"].on
    search = grown([trial.search for trial in trials], searched)
    sweep, reduction = (
        grown([part for trial in trials if (part := getattr(trial, name)) is not None], swept)
        for name in ("sweep", "reduction")
    )
    return search + each * sweep + (each if bent else 1.0) * reduction


def _compiled(source: SceneFile, effects: dict[str, Effect], points: tuple[SpeedPoint, ...]) -> None:
    """Do in little what is compiled where an installation does it first, and at no other time."""
    from damper import ringdown, working

    if source.scene.release is None or not points:
        return
    scene, point = source.scene, points[-1]
    ringdown(ringdowns.particle_damper(scene, effects, point), felt.released_at(scene, point), 1)
    working(ringdowns.judged(scene, effects, point), sweeps=2, stay=1)


def _damper(source: SceneFile, effects: dict[str, Effect], points: tuple[SpeedPoint, ...]) -> tuple[float, float]:
    """Cycles of all ring-downs, and the seconds that they and the damper's own figures take.

    The lowest and the highest speed tell them alone where they are little beside a run's start.
    """
    release = source.scene.release
    if release is None or not points:
        return 0.0, 0.0
    asked = None if isinstance(release.cycles, str) else release.cycles
    few = release.model_copy(update={"cycles": "auto" if asked is None else min(asked, _CYCLES)})
    more = 1.0 if asked is None else max(asked / _CYCLES, 1.0)
    scene, quiet = source.scene.model_copy(update={"release": few}), Stages(visible=False)
    speeds, began, found = sorted(source.scene.rotor.speeds), perf_counter(), list[tuple[float, float, float]]()
    last = len(points) - 1
    for number in sorted(range(len(points)), key=lambda k: (0 < k < last, abs(k - 0.5 * (last + 0.5)))):
        since = perf_counter()
        (done,) = ringdowns.simulate(scene, effects, (points[number],), quiet)
        now = perf_counter()
        found.append((done.omega, 0.0 if done.damping is None else done.damping.sdc.size, now - since))
        little = more * len(speeds) * max(took for *_, took in found) < 0.5 * _START
        if now - began > PATIENCE or (little and len(found) > 1):
            break
    omega, *each = np.array(sorted(found)).T
    cycles, spent = (more * float(np.interp(speeds, omega, of).sum()) for of in each)
    return cycles, spent
