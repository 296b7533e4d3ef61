"""How long a run takes and how much memory, reckoned from a small one: coarse meshes, few speeds, few cycles.

The first meshes of the search tell how fine the last will be (Richardson 1911), and their times what it costs on
this machine: work grows as the power 1.3 of the unknowns, between that of the matrices (1) and that of a planar mesh's
factor (1.5; George, SIAM J. Numer. Anal. 10 (1973) 345), of solids as 1.5. Where the first meshes are large, solids and
many cells from a file, they are not solved for this; what they take is reckoned from what others took, and from how
fast this machine is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from time import perf_counter
from typing import TYPE_CHECKING

from workflows import needs, plate, plate_records, ringdowns
from workflows.answering import answering
from workflows.decided import Decided
from workflows.effects import Effect
from workflows.records import SpeedPoint
from workflows.scene_file import SceneFile
from workflows.stages import Stages
from workflows.wording import significant

if TYPE_CHECKING:
    from workflows.plate_mesh import Planform
    from workflows.plate_records import Discrete

_UNKNOWNS = 4000
"""Up to which meshes are tried here."""

_SPEEDS, _CYCLES = 3, 1000
"""Up to which there are speeds and cycles here."""

_GROWTH = {"kirchhoff": 1.3, "mindlin": 1.3, "solid": 1.5}

_PRICE = {"kirchhoff": 1.7e-6, "mindlin": 1.7e-6, "solid": 8e-7, "solid/4": 1.9e-6, "solid/6": 2.5e-6}
"""Seconds that matrices and six modes at two speeds took for one unknown, to be grown by the power above."""

_DEFLECTED, _TURNING = 8.0, 6.0
"""By how much large deflection and Coriolis forces make modes dearer."""

_REFERENCE = 4, 0.1
"""Size of a mesh of the paper's plate, and the seconds that its modes took on the machine where prices were taken."""

_SEARCH = 1.3
"""Work of a search over that of the last of its meshes, each of which is about half as large as the next."""

_START = 5.0
"""Seconds to start the program, to draw and to write."""

_ROUGH = 3e-3
"""Accuracy from which on the first meshes of bricks are fine enough."""

_USUAL, _USUALLY = 12_000, 1e-3
"""Unknowns of most meshes for six modes, and the accuracy up to which that is so; they grow with its root."""

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
        memory, _ = _unsolved(source, decided.effects, model, _first(source, decided.form, model), pace=1.0)
        _, seconds = _unsolved(source, decided.effects, model, _usual(source, decided, model), pace=1.0)
    cycles = 0 if scene.release is None or isinstance(scene.release.cycles, str) else scene.release.cycles
    speeds = len(scene.rotor.speeds)
    many = speeds > _MANY or speeds * cycles > _MANY_CYCLES
    return many or seconds > _LONG / _WITHIN or memory > needs.available() / _WITHIN


def _usual(source: SceneFile, decided: Decided, model: str) -> float:
    """Unknowns of the mesh that a search may end with."""
    (form, _), scene = decided.plate, source.scene
    first = _first(source, form, model)
    if model.startswith("solid"):
        return max(first, _finest(source, form, model, decided.effects))
    finer = 4.0 * first if source.mesh is not None and len(form.sizes) > 2 else first
    finer_still = max(_USUALLY / scene.accuracy.frequency, 1.0) ** 0.5
    return max(finer, _USUAL * max(scene.rotor.modes / 6, 1.0) * float(finer_still))


def need(source: SceneFile, decided: Decided) -> Need:
    """Reckon what a run of a scene takes.

    Raises:
        BadInput, NoAnswer: what a run would raise.
    """
    small = _small(source)
    if decided.form is None:
        points = tuple(ringdowns.known_structure(small.scene, omega) for omega in small.scene.rotor.speeds)
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
    pace = _pace()  # also loads what solves plates
    (form, _), effects, model = decided.plate, decided.effects, plate.model(source, decided)
    first = _first(source, form, model)
    if first > _UNKNOWNS:
        last = max(first, _finest(source, form, model, effects)) if model.startswith("solid") else first
        return (), *_unsolved(source, effects, model, last, pace)
    with answering(source):
        began = perf_counter()
        discrete = plate.discretise(small, decided, Stages(visible=False), most=_UNKNOWNS)
        searched = perf_counter()
        operators = discrete.choice.operators
        diagram = plate.sweep(small, discrete)
        reduced = plate.reduce(small, operators, diagram)
        swept = perf_counter()

    scene, here = source.scene, float(operators.mass.shape[0])
    there = here * _growth(source, form, discrete, here)
    larger = (there / here) ** _GROWTH[operators.model.theory.partition("/")[0]]
    each = len(scene.rotor.speeds) / len(small.scene.rotor.speeds) if plate.one_by_one(scene, operators) else 1.0
    seconds = ((searched - began) * (1.0 if there == here else _SEARCH) + (swept - searched) * each) * larger
    memory = needs.of_a_plate(operators.model.theory, there, scene.rotor.modes, operators.effects.large_deflection)
    numbers = [int((diagram.omega == omega).argmax()) for omega in small.scene.rotor.speeds if omega in diagram.omega]
    return plate_records.points(small, discrete, diagram, numbers, reduced), memory, seconds


def _first(source: SceneFile, form: Planform, model: str) -> float:
    """Unknowns of the finer of the two meshes that a search begins with, or of the only one."""
    from fem.choice import first_pair, has_pair

    coarsest = needs.unknowns(model, form.mesh(form.sizes[0]))
    if not has_pair(form, coarsest, model):
        return coarsest
    return needs.unknowns(model, form.mesh(first_pair(form, source.scene.rotor.modes)[1]))


def _finest(source: SceneFile, form: Planform, model: str, effects: dict[str, Effect]) -> float:
    """Unknowns of the finest mesh that a search for bricks may try, which it does for all but rough accuracies."""
    from fem.choice import MOST_UNKNOWNS

    fit = needs.most_unknowns(source, form, model, effects["large_deflection"].on)
    most = min(MOST_UNKNOWNS["solid"], fit)
    each = needs.unknowns(model, form.mesh(form.sizes[0])) / form.sizes[0] ** 2
    if source.scene.accuracy.frequency >= _ROUGH:
        return each
    return max(each * size**2 for size in form.sizes if size == form.sizes[0] or each * size**2 <= most)


def _unsolved(
    source: SceneFile, effects: dict[str, Effect], model: str, unknowns: float, pace: float
) -> tuple[float, float]:
    """Bytes and seconds of a plate whose first meshes are large: the search is taken to end with the finer of them."""
    scene, large = source.scene, effects["large_deflection"].on
    name = model.partition("/")[0]
    once = pace * _PRICE.get(model, _PRICE[name]) * unknowns ** _GROWTH[name] * max(scene.rotor.modes / 6, 1.0)
    each = once * (_DEFLECTED if large else 1.0)
    alone = large or scene.rotor.modes > plate.MODES_FOLLOWED
    turning = _TURNING if effects["coriolis"].on else 1.0
    speeds = len(scene.rotor.speeds) if alone else 1
    return needs.of_a_plate(model, unknowns, scene.rotor.modes, large), each * (1.0 + speeds * turning)


def _pace() -> float:
    """How slow this machine is against the one that prices were taken on."""
    from fem import Effects, Material, Plate, Rectangle, Rotor, assemble
    from fem.probing import probe

    size, usual = _REFERENCE
    for _ in range(2):  # the first loads
        began = perf_counter()
        mesh = Rectangle(0.2, 0.08).mesh(size)
        operators = assemble(Plate(mesh, 0.003, Material(114e9, 0.33, 4430.0)), Rotor(0.1, 0.5), Effects())
        probe(operators, (10.0, 600.0), 6, 1e-6)
        spent = perf_counter() - began
    return spent / usual


def _growth(source: SceneFile, form: Planform, discrete: Discrete, unknowns: float) -> float:
    """By what factor the unknowns grow until the accuracy asked for is met, or the search ends."""
    from fem.choice import MOST_UNKNOWNS, next_size

    choice = discrete.choice
    if choice.met or not choice.errors.max() > 0.0:
        return 1.0
    model = choice.operators.model.theory
    fit = needs.most_unknowns(source, form, model, choice.operators.effects.large_deflection)
    room = min(MOST_UNKNOWNS[model.partition("/")[0]], fit) / unknowns
    following = next_size(form, choice.size, float(choice.errors.max()) / choice.tolerance, room, step=inf)
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
    ringdowns.simulate(scene, effects, points[:1], Stages(visible=False))  # loads and compiles
    began = perf_counter()
    found = ringdowns.simulate(scene, effects, points, Stages(visible=False))
    spent = (perf_counter() - began) / len(points)
    cycles = sum(point.damping.sdc.size for point in found if point.damping is not None) / len(points)
    speeds = len(source.scene.rotor.speeds)
    more = 1.0 if asked is None else max(asked / _CYCLES, 1.0)
    return speeds * cycles * more, speeds * spent * more
