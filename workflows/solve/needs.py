"""What a run needs of the machine at least, known before any work: a scene that asks for more is refused.

The figures here are of memory, and of time where a scene asks for days. What a mesh takes is known once its first sizes
are tried (`workflows.solve.trials`); the search for a mesh ends where the memory does.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workflows.errors import BadInput
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.solve.fill import Fill, of_each
from workflows.solve.records import SHAPES_AT_MOST

if TYPE_CHECKING:
    from fem.meshes.ladder import Planform

LONGEST = 7 * 86400.0
"""Seconds; what would take longer is refused as well."""

BASE = 2.5e8
"""Bytes of the program itself, with all it loads."""

CYCLE, _CYCLE_TIME = 1.3e3, 1.4e-5
"""Bytes and seconds of a vibration cycle of the damper, from its peak to its line in results.json."""

_AUTO_CYCLES = 100
"""Cycles taken for `cycles = "auto"`: until the ball rests, mostly some tens."""

_LINE, _LINE_TIME = 2.5e3, 2e-5
"""Bytes and seconds of a mode at a speed; a speed itself counts as four."""

_UNKNOWN = {"kirchhoff": 2.4e4, "mindlin": 1.4e4, "solid": 3.8e4, "solid/4": 5.2e4, "solid/6": 6.2e4}
"""Bytes for each unknown of a plate: its matrices, their factor, and the vectors that six modes are sought in."""

_FILLING = 100_000
"""Unknowns from which on the factor's share grows with their number."""

_DEFLECTED = {"mindlin": 2.7, "kirchhoff": 1.5, "solid": 1.8}
"""By how much that grows with large deflection, whose tangent is made anew from every cell."""

_MODE = 250.0
"""Bytes for each unknown and each further mode."""

_ENTRY, _BENT, _SHAPE = 51.0, 7.7e3, 142.0
"""Bytes for each entry of a factor, with what it is made from; for each unknown of a plate that deflects much; for each
unknown and mode."""

_KEPT = {"kirchhoff": 5.5e3, "mindlin": 4.1e3, "solid": 2.9e4}
"""Bytes for each unknown beside these."""

PROGRAM, _KERNELS = 1.6e8, 1.0e8
"""Bytes of the program itself once it has begun, and of the damper's compiled parts."""

_BYTES_OF_A_CELL = 200
"""What a cell and its point take in a mesh file at most."""

_ADDRESSES = 2.5
"""Bytes of address space that the program and its libraries map for each that they use."""


@dataclass(frozen=True)
class Part:
    """A part of the need: bytes and seconds, the key that it comes from, and what would make it smaller."""

    memory: float
    seconds: float
    key: str
    value: object
    advice: str


def parts(source: SceneFile) -> list[Part]:
    """What a scene needs at least, part by part; the largest first."""
    scene = source.scene
    speeds, modes = len(scene.rotor.speeds), scene.rotor.modes
    found = []
    if scene.plate is not None:
        unknowns, points = _least_size(source)
        cause: tuple[str, object, str] = ("[rotor] modes", modes, "ask for fewer modes")
        if source.mesh is not None:
            cause = ("[plate] mesh", scene.plate.mesh, "coarsen the mesh")
        found.append(Part(of_a_plate(scene.plate.theory, unknowns, modes), 0.0, *cause))
        shapes = 8.0 * modes * (6 * unknowns + 9 * points * min(speeds, SHAPES_AT_MOST))
        found.append(Part(shapes, modes * unknowns * 2e-6, "[rotor] modes", modes, "ask for fewer modes"))
        lines = speeds * (modes + 4.0)
        found.append(
            Part(of_lines(scene), lines * _LINE_TIME, "[rotor] speeds", f"{speeds} speeds", "ask for fewer speeds")
        )
    if scene.release is not None:
        asked = scene.release.cycles
        cycles = speeds * float(_AUTO_CYCLES if isinstance(asked, str) else asked)
        many = speeds > 1 and cycles / speeds < speeds
        key, value = ("[rotor] speeds", f"{speeds} speeds") if many else ("[release] cycles", asked)
        advice = f"ask for fewer {'speeds' if many else 'cycles'}"
        found.append(Part(cycles * CYCLE, cycles * _CYCLE_TIME, key, value, advice))
    return sorted(found, key=lambda part: -part.memory)


def memory(source: SceneFile) -> float:
    """Bytes that a run of a scene takes at least, roughly."""
    return BASE + sum(part.memory for part in parts(source))


def check(source: SceneFile) -> None:
    """Refuse a scene that this machine cannot do, whatever mesh it takes.

    Raises:
        BadInput: it needs more memory than there is, or more than a week.
    """
    refuse(source, memory(source), sum(part.seconds for part in parts(source)))


def refuse(source: SceneFile, memory: float, seconds: float) -> None:
    """Refuse a scene that needs so many bytes and seconds, if that is too much.

    Raises:
        BadInput: it is more memory than there is, or more than a week; with the key that it comes from most.
    """
    every, there = parts(source), available() + _held()
    if memory > there:
        worst = every[0]
        problem = f"this needs about {in_words(memory)} of memory, and {in_words(there)} are there"
        raise BadInput(f"{problem}: {worst.advice}", file=source.name, key=worst.key, value=worst.value)
    if seconds > LONGEST:
        worst = max(every, key=lambda part: part.seconds)
        problem = f"this takes about {seconds / 86400:.0f} days: {worst.advice}"
        raise BadInput(problem, file=source.name, key=worst.key, value=worst.value)


def most_unknowns(source: SceneFile, form: Planform, model: str, large_deflection: bool) -> int:
    """Unknowns of the largest plate that the memory holds, with all else that the scene needs.

    Raises:
        BadInput: the coarsest mesh there is has more.
    """
    modes = source.scene.rotor.modes
    others = sum(part.memory for part in parts(source) if part.key not in ("[plate] mesh", "[rotor] modes"))
    there = available()
    most = (there - BASE - others) / of_a_plate(model, 1.0, modes, large_deflection)
    least = unknowns(model, form.mesh(form.sizes[0]))
    if least > most:
        needed = BASE + others + of_a_plate(model, least, modes, large_deflection)
        problem = f"this needs about {in_words(needed)} of memory, and {in_words(there)} are there"
        given = source.scene.plate.mesh if source.scene.plate is not None else None
        if given is not None:
            raise BadInput(f"{problem}: coarsen the mesh", file=source.name, key="[plate] mesh", value=given)
        raise BadInput(f"{problem}: ask for fewer modes", file=source.name, key="[rotor] modes", value=modes)
    return int(min(most, 2**60))


def of_lines(scene: Scene) -> float:
    """Bytes that the modes at all speeds take in the results and their text."""
    return len(scene.rotor.speeds) * (scene.rotor.modes + 4.0) * _LINE


def of_a_plate(model: str, unknowns: float, modes: int, large_deflection: bool = False) -> float:
    """Bytes that so many unknowns of a plate take in a theory, roughly, up to some 150 000 of them."""
    name = model.partition("/")[0]
    each = _UNKNOWN.get(model, _UNKNOWN.get(name, min(_UNKNOWN.values())))
    each *= float(max(unknowns / _FILLING, 1.0) ** 0.3)
    return float(unknowns) * (each * (_DEFLECTED[name] if large_deflection else 1.0) + _MODE * max(modes - 6, 0))


def of_a_mesh(model: str, on: Fill, modes: int, large_deflection: bool = False) -> float:
    """Bytes that a plate takes on a mesh whose fill is known.

    Figures are of fifty searches and sweeps over all theories, 600 to 100 000 unknowns and 2 to 60 modes.
    """
    each = _KEPT[model.partition("/")[0]] + (_BENT if large_deflection else 0.0) + _SHAPE * modes
    return _ENTRY * on.entries + each * on.unknowns


def of_the_program(scene: Scene) -> float:
    """Bytes that a scene takes whatever its plate."""
    return PROGRAM + (0.0 if scene.damper is None else _KERNELS)


def unknowns(model: str, mesh: Any) -> float:
    """How many a theory has on a mesh, those at the clamped root included."""
    mesh, each = of_each(model, mesh)
    counts = mesh.p.shape[1], mesh.facets.shape[1], mesh.t.shape[1]
    return float(sum(own * count for own, count in zip(each, counts, strict=True)))


def available() -> float:
    """Bytes of memory that a program can still get here; infinite where the system does not say."""
    import psutil

    found = [float("inf")]
    with suppress(OSError, psutil.Error):
        found.append(float(psutil.virtual_memory().available))
    with suppress(OSError, ValueError):  # of a container
        found.append(float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    with suppress(ImportError, OSError, ValueError):
        from resource import RLIM_INFINITY, RLIMIT_AS, getrlimit

        limit = getrlimit(RLIMIT_AS)[0]
        if limit != RLIM_INFINITY:
            found.append(max(limit - psutil.Process().memory_info().vms, 0.0) / _ADDRESSES)
    return min(found)


def _held() -> float:
    """Bytes that this process has of those in BASE: counted in what is needed, and gone from what is there."""
    import psutil

    try:
        return min(float(psutil.Process().memory_info().rss), BASE)
    except (OSError, psutil.Error):
        return 0.0


def _least_size(source: SceneFile) -> tuple[float, float]:
    """Unknowns and points of the plate's mesh at least; of a file, which is not read for this, by its length."""
    from fem.accuracy.tried import CELLS_PER_MODE

    points = float(CELLS_PER_MODE * source.scene.rotor.modes)
    if source.mesh is not None:
        points = source.mesh.stat().st_size / _BYTES_OF_A_CELL
    return 4.0 * points, points


def in_words(size: float) -> str:
    """A number of bytes as people say it."""
    for unit, factor in (("TB", 1e12), ("GB", 1e9)):
        if size >= factor:
            return f"{size / factor:.{0 if size >= 10 * factor else 1}f} {unit}"
    return f"{size / 1e6:.0f} MB"
