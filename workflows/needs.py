"""What a run needs of the machine, estimated before any work: a scene that asks for more than there is, is refused.

The figures are rough, a factor of two either way; they are there to tell minutes from months and a gigabyte from a
terabyte. Each was measured on the shipped scenes (the growth of the process, results as JSON included).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from workflows.errors import BadInput
from workflows.scene_file import SceneFile

LONGEST = 7 * 86400.0
"""Seconds; what would take longer is refused as well."""

_BASE = 2.5e8
"""Bytes of the program itself, with all it loads."""

_CYCLE, _CYCLE_TIME = 1.3e3, 1.4e-5
"""Bytes and seconds of a vibration cycle of the damper, from its peak to its line in results.json."""

_AUTO_CYCLES = 100
"""Cycles taken for `cycles = "auto"`: until the ball rests, mostly some tens."""

_LINE, _LINE_TIME = 2.5e3, 2e-5
"""Bytes and seconds of a mode at a speed; a speed itself counts as four."""

_UNKNOWN, _UNKNOWN_TIME = 1.8e4, 4e-4
"""Bytes and seconds for each unknown of a plate, up to _LINEAR; from there on both grow as their power 1.3."""

_LINEAR = 250_000

_UNKNOWNS_AT_A_POINT = {"kirchhoff": 4, "mindlin": 3, "auto": 3, "solid": 9}
_CELLS_FOR_A_MODE = 80
"""Cells that a mode calls for at the usual accuracy, on a grid of our own."""

_BYTES_OF_A_CELL = 80
"""What a cell and its point take in a mesh file as text."""

_ADDRESSES = 2.5
"""Bytes of address space that the program and its libraries map for each that they use."""

_SHAPES_AT_MOST = 20
"""Speeds whose mode shapes are kept."""


@dataclass(frozen=True)
class Part:
    """A part of the need: bytes and seconds, the key that it comes from, and what would make it smaller."""

    memory: float
    seconds: float
    key: str
    value: object
    advice: str


def parts(source: SceneFile) -> list[Part]:
    """What a scene needs, part by part; the largest first."""
    scene = source.scene
    speeds, modes = len(scene.rotor.speeds), scene.rotor.modes
    found = []
    if scene.plate is not None:
        unknowns, points = _size(source)
        growth = max(unknowns / _LINEAR, 1.0) ** 0.3
        cause: tuple[str, object, str] = ("[rotor] modes", modes, "ask for fewer modes")
        if source.mesh is not None:
            unknowns = max(unknowns, min(4 * unknowns, _refined_to(scene.plate.theory)))
            cause = ("[plate] mesh", scene.plate.mesh, "coarsen the mesh")
        found.append(Part(unknowns * _UNKNOWN * growth, unknowns * _UNKNOWN_TIME * growth, *cause))
        shapes = 8.0 * modes * (6 * unknowns + 9 * points * min(speeds, _SHAPES_AT_MOST))
        found.append(Part(shapes, modes * unknowns * 2e-6, "[rotor] modes", modes, "ask for fewer modes"))
        lines = speeds * (modes + 4.0)
        found.append(
            Part(lines * _LINE, lines * _LINE_TIME, "[rotor] speeds", f"{speeds} speeds", "ask for fewer speeds")
        )
    if scene.release is not None:
        asked = scene.release.cycles
        cycles = speeds * float(_AUTO_CYCLES if isinstance(asked, str) else asked)
        many = speeds > 1 and cycles / speeds < speeds
        key, value = ("[rotor] speeds", f"{speeds} speeds") if many else ("[release] cycles", asked)
        advice = f"ask for fewer {'speeds' if many else 'cycles'}"
        found.append(Part(cycles * _CYCLE, cycles * _CYCLE_TIME, key, value, advice))
    return sorted(found, key=lambda part: -part.memory)


def memory(source: SceneFile) -> float:
    """Bytes that a run of a scene takes, roughly."""
    return _BASE + sum(part.memory for part in parts(source))


def check(source: SceneFile) -> None:
    """Refuse a scene that this machine cannot do.

    Raises:
        BadInput: it needs more memory than there is, or more than a week.
    """
    every = parts(source)
    needed, there = _BASE + sum(part.memory for part in every), available()
    if needed > there:
        worst = every[0]
        problem = f"this needs about {in_words(needed)} of memory, and {in_words(there)} are there"
        raise BadInput(f"{problem}: {worst.advice}", file=source.name, key=worst.key, value=worst.value)
    seconds = sum(part.seconds for part in every)
    if seconds > LONGEST:
        worst = max(every, key=lambda part: part.seconds)
        problem = f"this takes about {seconds / 86400:.0f} days: {worst.advice}"
        raise BadInput(problem, file=source.name, key=worst.key, value=worst.value)


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


def _size(source: SceneFile) -> tuple[float, float]:
    """Unknowns and points of the plate's mesh; of a file, which is not read for this, by its length."""
    scene = source.scene
    theory = scene.plate.theory if scene.plate is not None else "auto"
    if source.mesh is not None:
        points = source.mesh.stat().st_size / _BYTES_OF_A_CELL
        return points * _UNKNOWNS_AT_A_POINT[theory], points
    points = float(_CELLS_FOR_A_MODE * scene.rotor.modes)
    return min(points * _UNKNOWNS_AT_A_POINT[theory], _refined_to(theory)), points


def _refined_to(theory: str) -> float:
    """Unknowns up to which the search for a mesh refines; while the theory is open, the most of any."""
    from fem.choice import MOST_UNKNOWNS

    return float(MOST_UNKNOWNS.get(theory, max(MOST_UNKNOWNS.values())))


def in_words(size: float) -> str:
    """A number of bytes as people say it."""
    for unit, factor in (("TB", 1e12), ("GB", 1e9)):
        if size >= factor:
            return f"{size / factor:.{0 if size >= 10 * factor else 1}f} {unit}"
    return f"{size / 1e6:.0f} MB"
