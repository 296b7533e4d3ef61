"""The sizes of a run and the memory that it takes at least, known before any factorisation.

A scene that asks for more memory than the machine has is refused, and the search for a mesh ends where the memory does.
Memory follows from the number of unknowns, and from the fill of their factor, which grows with a power of it.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from fem.meshes.mesh_sequence import CELLS_PER_MODE, Planform, Rectangle, begun_with
from fem.theory.registry import THEORIES, theory_of
from workflows.effects.definition import Effect
from workflows.errors import present
from workflows.scene.load import SceneFile
from workflows.solve.results import SHAPES_AT_MOST

BASE = 2.5e8
"""Bytes of the program itself, with all it loads."""

CYCLE = 2e3
"""Bytes of a vibration cycle of the damper, from its peak to its line in results.json.

Of 10 000 cycles 1.8 kB each where the ball mostly rests, 7 kB where it moves and its events are kept.
"""

_AUTO_CYCLES = 100
"""Cycles taken for `cycles = "auto"`: until the ball rests, mostly some tens."""

_LINE = 2.5e3
"""Bytes of a mode at a speed; a speed itself counts as four."""

_FILLING = 100_000
"""Unknowns from which on the factor's share grows with their number."""

_MODE = 250.0
"""Bytes for each unknown and each further mode."""

_BYTES_OF_A_CELL = 200
"""What a cell and its point take in a mesh file at most."""

_ADDRESSES = 2.5
"""Bytes of address space that the program and its libraries map for each that they use."""


@dataclass(frozen=True)
class Sizes:
    """How large a run is.

    Attributes:
        speeds: at which the scene is solved.
        modes: asked for at each speed, None without a plate.
        unknowns: of the plate in the first mesh that is fine enough for these modes, None without a plate.
        ringdowns: ring-downs of the damper, one for each speed.
        cycles: vibration cycles of all ring-downs, None where they last until the ball rests.
        memory: bytes that the run takes at least.
    """

    speeds: int
    modes: int | None
    unknowns: int | None
    ringdowns: int
    cycles: float | None
    memory: float

    def __str__(self) -> str:
        words = [_counted(self.speeds, "speed")]
        if self.modes is not None:
            words.append(_counted(self.modes, "mode"))
        if self.unknowns is not None:
            words.append(f"at least {_counted(self.unknowns, 'unknown')}")
        if self.ringdowns:
            lasting = "" if self.cycles is None else f" of {self.cycles / self.ringdowns:.10g} cycles"
            words.append(f"{_counted(self.ringdowns, 'ring-down')}{lasting}")
        return f"Sizes: {', '.join(words)}; at least {in_words(self.memory)} of memory"


@dataclass(frozen=True)
class Part:
    """A part of the need: bytes, the key that it comes from, and what would make it smaller."""

    memory: float
    key: str
    value: object
    advice: str


def parts(source: SceneFile) -> list[Part]:
    """What a scene needs at least, part by part; the largest first."""
    scene = source.scene
    speeds, modes = len(scene.rotor.speeds), scene.rotor.modes
    listed = []
    if scene.plate is not None:
        points = float(CELLS_PER_MODE * modes)
        if source.mesh is not None:  # which is not read for this
            points = source.mesh.stat().st_size / _BYTES_OF_A_CELL
        unknowns = 4.0 * points
        listed.append(_of_the_mesh(source, of_a_plate(scene.plate.theory, unknowns, modes)))
        shapes = 8.0 * modes * (6 * unknowns + 9 * points * min(speeds, SHAPES_AT_MOST))
        listed.append(Part(shapes, "[rotor] modes", modes, "request fewer modes"))
        listed.append(
            Part(speeds * (modes + 4.0) * _LINE, "[rotor] speeds", f"{speeds} speeds", "request fewer speeds")
        )
    if scene.release is not None:
        stop_cycles = scene.release.cycles
        cycles = speeds * float(_AUTO_CYCLES if isinstance(stop_cycles, str) else stop_cycles)
        many = speeds > 1 and cycles / speeds < speeds
        key, value = ("[rotor] speeds", f"{speeds} speeds") if many else ("[release] cycles", stop_cycles)
        advice = f"request fewer {'speeds' if many else 'cycles'}"
        listed.append(Part(cycles * CYCLE, key, value, advice))
    return sorted(listed, key=lambda part: -part.memory)


def _of_the_mesh(source: SceneFile, memory: float) -> Part:
    """What a plate's mesh takes."""
    plate = source.scene.plate
    if plate is not None and plate.mesh is not None:
        return Part(memory, "[plate] mesh", plate.mesh, "coarsen the mesh")
    return Part(memory, "[rotor] modes", source.scene.rotor.modes, "request fewer modes")


def memory(source: SceneFile) -> float:
    """Bytes that a run of a scene takes at least, roughly."""
    return BASE + sum(part.memory for part in parts(source))


def check(source: SceneFile) -> None:
    """Refuse a scene that this machine cannot do, whatever mesh it takes.

    Raises:
        BadInput: it needs more memory than there is.
    """
    if worst := parts(source)[:1]:
        _require(source, memory(source), worst[0])


def sizes(source: SceneFile, form: Planform | None, effects: dict[str, Effect], model: str) -> Sizes:
    """How large a run of a scene is; `form`, None without one, and `model`: of its plate, with its theory in `fem`.

    Raises:
        BadInput: its first meshes need more memory than there is.
    """
    scene, needed = source.scene, memory(source)
    speeds, modes, first = len(scene.rotor.speeds), None, None
    if form is not None:
        large = effects["large_deflection"].on
        most = most_unknowns(source, form, model, large)
        modes, first = scene.rotor.modes, int(_first_unknowns(form, model, scene.rotor.modes, most))
        needed = max(needed, BASE + _beside_the_plate(source) + of_a_plate(model, first, modes, large))
    rings, stop_cycles = 0 if scene.damper is None or scene.release is None else speeds, scene.stop_cycles
    return Sizes(speeds, modes, first, rings, None if stop_cycles is None else float(rings * stop_cycles), needed)


def most_unknowns(source: SceneFile, form: Planform, model: str, large_deflection: bool) -> int:
    """Unknowns of the largest plate that the memory holds, with all else that the scene needs.

    Raises:
        BadInput: the mesh that a search for one begins with, or the only one, has more.
    """
    modes, others, there = source.scene.rotor.modes, _beside_the_plate(source), available()
    each = of_a_plate(model, 1.0, modes, large_deflection)
    most = int(min(max((there - BASE - others) / each, 1.0), 2**60))
    first = of_a_plate(model, _first_unknowns(form, model, modes, most), modes, large_deflection)
    _require(source, BASE + others + first, _of_the_mesh(source, first))
    return most


def of_a_blade(unknowns: float) -> float:
    """Bytes that a solid blade of so many unknowns takes: two factors, matrices, cells' tables and modes."""
    return float(unknowns * (_EACH_OF_A_BLADE + _FILL_OF_A_BLADE * float(unknowns / _FILLING) ** (1.0 / 3.0)))


_EACH_OF_A_BLADE, _FILL_OF_A_BLADE = 1.5e4, 3.5e4
"""Bytes for each unknown: of what grows with their number, and of factors at _FILLING unknowns."""


def check_blade(source: SceneFile, unknowns: int) -> None:
    """Refuse a solid blade of so many unknowns that this machine cannot do.

    Raises:
        BadInput: it needs more memory than there is.
    """
    needed, advice = of_a_blade(unknowns), f"coarsen the mesh, which has {unknowns} unknowns"
    _require(source, BASE + needed, Part(needed, "[blade] mesh", present(source.scene.blade).mesh, advice))


def _require(source: SceneFile, needed: float, worst: Part) -> None:
    """Refuse what needs more memory than there is, by its largest part."""
    there = available() + _own_memory()
    if needed > there:
        problem = (
            f"this needs about {in_words(needed)} of memory, but only {in_words(there)} are available: {worst.advice}"
        )
        raise source.wrong(problem, worst.key, worst.value)


def _beside_the_plate(source: SceneFile) -> float:
    """Bytes of what does not change with the mesh: cycles, and lines of results."""
    return sum(part.memory for part in parts(source) if part.key not in ("[plate] mesh", "[rotor] modes"))


def _first_unknowns(form: Planform, model: str, modes: int, most: int) -> float:
    """Unknowns of the first mesh of a search that has enough cells for the modes, or of the only one."""
    if not isinstance(form, Rectangle):
        from fem.accuracy.mesh_selection import has_pair

        coarsest = unknowns(model, form.mesh(form.sizes[0]))
        if not has_pair(form, coarsest, model, most):
            return coarsest
        return unknowns(model, form.mesh(begun_with(form, modes)))
    along, across = form.cells(begun_with(form, modes))  # no mesh is made, for which scikit-fem would be loaded
    counts = (along + 1) * (across + 1), along * (across + 1) + across * (along + 1), along * across
    return _in_all(model, counts, quads=True)


def of_a_plate(model: str, unknowns: float, modes: int, large_deflection: bool = False) -> float:
    """Bytes that so many unknowns of a plate take in a theory, or in the least ("auto"), up to some 150 000 of them."""
    name, _, element = model.partition("/")
    each, deflected = min(
        (theory.memory.get(element, theory.memory[""]), theory.deflected)
        for theory in ([THEORIES[name]] if name in THEORIES else THEORIES.values())
    )
    each *= float(max(unknowns / _FILLING, 1.0) ** 0.3)
    return float(unknowns) * (each * (deflected if large_deflection else 1.0) + _MODE * max(modes - 6, 0))


def unknowns(model: str, mesh: Any) -> float:
    """How many a theory has on a mesh, those at the clamped root included."""
    from fem.theory.kirchhoff import is_rectangles
    from fem.theory.solid import quadrilaterals

    name, quads = model.partition("/")[0], mesh.t.shape[0] == 4
    if name == "kirchhoff" and quads and not is_rectangles(mesh):
        mesh, quads = mesh.to_meshtri(), False
    if name == "solid":
        mesh = quadrilaterals(mesh)
    return _in_all(model, (mesh.p.shape[1], mesh.facets.shape[1], mesh.t.shape[1]), quads)


def _in_all(model: str, counts: tuple[int, int, int], quads: bool) -> float:
    """Unknowns that a theory has on so many corners, edges and cells."""
    theory, element = theory_of(model)
    return float(sum(own * count for own, count in zip(theory.unknowns(element, quads), counts, strict=True)))


def available() -> float:
    """Bytes of memory that a program can still get here; infinite where the system does not say."""
    free = [float("inf")]
    with suppress(OSError, psutil.Error):
        free.append(float(psutil.virtual_memory().available))
    with suppress(OSError, ValueError):  # of a container
        free.append(float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    with suppress(ImportError, OSError, ValueError):
        from resource import RLIM_INFINITY, RLIMIT_AS, getrlimit

        limit = getrlimit(RLIMIT_AS)[0]
        if limit != RLIM_INFINITY:
            free.append(max(limit - psutil.Process().memory_info().vms, 0.0) / _ADDRESSES)
    return min(free)


def _own_memory() -> float:
    """Bytes that this process has of those in BASE: counted in what is needed, and gone from what is there."""
    try:
        return min(float(psutil.Process().memory_info().rss), BASE)
    except (OSError, psutil.Error):
        return 0.0


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def in_words(size: float) -> str:
    """A number of bytes as people say it."""
    for unit, factor in (("TB", 1e12), ("GB", 1e9)):
        if size >= factor:
            return f"{size / factor:.{0 if size >= 10 * factor else 1}f} {unit}"
    return f"{size / 1e6:.0f} MB"
