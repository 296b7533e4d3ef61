"""Reference motions that the kernels must reproduce before a machine's first results are published.

Each family of kernels is checked once, when its first result is about to leave; a stamp beside the compiled code tells
later starts, until the sources, the versions of what compiles them or the processor change.

The digits come from the reference of the tests (`tests/damper/reference.py`: matrix exponentials of equations that are
derived from the Lagrangian), which shares no code with the kernels: `python -m tests.damper.digits` computes each at
two samplings, which agree in the digits given. All motions end before chaos takes digits from them, and the steady
state attracts its neighbours.
"""

import cmath
import contextlib
import hashlib
import math
import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from threading import RLock
from typing import Any, NamedTuple

import numpy as np

from damper.laws import LawViolation, require
from damper.model import Formulation, Harmonic, Mode, ParticleDamper


def stamp(name: str, package: Path, versions: tuple[str, ...], folder: Path | None = None) -> Path:
    """The file whose existence says that something was checked.

    Args:
        name: what was checked.
        package: folder of the sources that it depends on.
        versions: of what else it depends on.
        folder: where stamps stand; None: beside the compiled sources, or in the user's cache if that cannot be written.
    """
    digest = hashlib.sha256(repr(versions).encode())
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    if folder is None:
        folder = package / "__pycache__"
        if not os.access(folder, os.W_OK):
            folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "spindamp"
    return folder / f"{name}.{digest.hexdigest()[:16]}.checked"


def leave(path: Path) -> None:
    """Leave a stamp in place of older ones; where that fails, the next start checks again."""
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        for older in path.parent.glob(f"{path.name.split('.')[0]}.*.checked"):
            older.unlink(missing_ok=True)
        path.touch()


EXACT = 1e-9
"""Most that a figure may differ from its reference, relative where that exceeds 1: what is left to rounding."""

STARTS = 2
"""Sweeps of a `Sweep`."""


class Motion(NamedTuple):
    """A ring-down for so many cycles; energies in its figures are shares of the initial one."""

    damper: ParticleDamper
    release: tuple[float, float]
    cycles: float
    figures: dict[str, float]
    harmonic: Harmonic | None = None
    amplitudes: tuple[float, ...] | None = None


class Sweep(NamedTuple):
    """Two sweeps down from an amplitude to another, so many cycles an octave; the losses are logarithmic decrements."""

    damper: ParticleDamper
    high: float
    low: float
    stay: int
    figures: dict[str, float]


class Curve(NamedTuple):
    """What `damper.curve_measurement.falling` returns for so many sweeps and cycles an octave."""

    damper: ParticleDamper
    sweeps: int
    stay: int
    figures: dict[str, float]


class SteadyState(NamedTuple):
    """A motion that a force keeps up."""

    damper: ParticleDamper
    harmonic: Harmonic
    figures: dict[str, float]


_STIFFNESS = 1.006 * (2 * math.pi * 269.5) ** 2
_PAPER = ParticleDamper(
    modal_mass=1.0,
    stiffness=(_STIFFNESS, _STIFFNESS),
    ball_mass=0.006,
    ball_radius=1e-3,
    cavity=(2.5e-3, 2.4e-3),
    centrifugal_acceleration=219320.0,
    restitution=0.5,
    friction=0.3,
    rolling_friction=1e-4,
)
_LEVEL = ParticleDamper(
    modal_mass=1.0,
    stiffness=(1.02, 1.3),
    ball_mass=0.02,
    ball_radius=1.0,
    cavity=(2.8, 2.6),
    centrifugal_acceleration=10.0,
    restitution=0.6,
    friction=0.3,
    rolling_friction=0.01,
)
_TILTING = replace(_LEVEL, floor_tilt=(0.03, 0.02), floor_radius=(41.0, 1e9))
_THREE_MODES = (
    Mode(1.0, 1.02, (1.0, 0.1), (0.02, 0.0)),
    Mode(2.0, 3.1, (0.2, 1.0), (0.0, 0.03), 0.02),
    Mode(3.0, 9.0, (0.7, -0.5), (0.05, -0.04)),
)
_COUPLED = replace(_LEVEL, rotation=0.3, stagger=0.5, floor_friction=0.2, modes=_THREE_MODES)
_DAMPED = replace(_TILTING, damping_ratio=0.02)

_ANSWER_AT_REST, _ANSWER_ALONE = (0.04 / (1.02 - mass + 0.04j * math.sqrt(1.02)) for mass in (1.02, 1.0))
"""F / (K - M nu² + i c nu) at nu = 1."""

_PUSH = Harmonic(0.97, (0.05, 0.02), phase=0.4)

RINGDOWNS = {
    "level floor": Motion(
        _PAPER, (20e-3, 5e-3), 20, {"hits": 164, "energy left": 0.99138562833, "rolling work": 0.00506813179}
    ),
    "printed equations": Motion(
        replace(_PAPER, formulation=Formulation.PRINTED), (20e-3, 5e-3), 20, {"hits": 165, "energy left": 1.0680097305}
    ),
    "slip after hits": Motion(
        replace(_PAPER, floor_friction=0.3), (20e-3, 5e-3), 6, {"hits": 39, "energy left": 0.99732487634}
    ),
    "tilting, hollow floor": Motion(_TILTING, (1.0, 0.4), 6, {"hits": 23, "energy left": 0.83789618141}),
    "three modes": Motion(_COUPLED, (0.0, 0.0), 5, {"hits": 21, "energy left": 0.6307570328}, None, (0.8, 0.5, 0.3)),
    "harmonic force": Motion(
        _DAMPED, (0.6, 0.0), 6, {"hits": 11, "energy left": 0.94540234479, "work": 1.46256317602}, _PUSH
    ),
}
SWEEPS = {
    "sweeps on a level floor": Sweep(_LEVEL, 1.0, 0.27, 8, {"cycles": 20, "decrements": 0.96454254615}),
    "sweeps on a tilting floor": Sweep(_TILTING, 1.0, 0.27, 8, {"cycles": 20, "decrements": 0.67000214447}),
}
CURVES = {
    "curve on a level floor": Curve(
        replace(_LEVEL, restitution=0.3),
        2,
        28,
        {
            "cut-off": 0.1,
            "peak": 0.00907194034972,
            "amplitude of the peak": 0.36390534043,
            "half below": 0.31947758200,
            "half above": 0.85749475943,
        },
    ),
    "curve on a tilting floor": Curve(
        replace(_TILTING, restitution=0.3),
        2,
        28,
        {
            "cut-off": 1 / 7,
            "peak": 0.00566664831756,
            "amplitude of the peak": 0.40843420718,
            "half below": 0.37425100124,
            "half above": 0.90472905424,
        },
    ),
}
STEADY = {
    "steady state": SteadyState(
        _DAMPED,
        Harmonic(1.0, (0.04, 0.0)),
        {
            "hits a cycle": 2,
            "mean amplitude": 0.89706037588,
            "power": 0.01793035803,
            "amplitude with the ball at rest": abs(_ANSWER_AT_REST),
            "amplitude without the ball": abs(_ANSWER_ALONE),
            "its phase": cmath.phase(_ANSWER_ALONE),
        },
    )
}

FAMILIES: dict[str, dict[str, Any]] = {
    "ring-downs": RINGDOWNS,
    "sweeps": SWEEPS,
    "curves": CURVES,
    "forced": STEADY,
}
"""Families of kernels, and what they must reproduce."""

checked: set[str] = set()
"""Families that this process need not check any more."""

_running: set[str] = set()
_lock = RLock()


class Line(NamedTuple):
    """A figure of a reference motion, as computed here and as it should be."""

    name: str
    figure: str
    value: float
    reference: float

    @property
    def error(self) -> float:
        """Relative where the reference exceeds 1."""
        return abs(self.value - self.reference) / max(abs(self.reference), 1.0)


def once(family: str, run: Callable[..., Any]) -> None:
    """Check a family of kernels unless that was done on this machine.

    Args:
        family: see `FAMILIES`.
        run: what computes its motions: `damper.ringdown`, `curve_measurement.samples_of`, `damper.damping_curve` or
            `damper.forced`.

    Raises:
        LawViolation: a figure differs from its reference.
    """
    if family in checked:
        return
    from damper import compiled

    with _lock:
        if not compiled.COMPILES or family in checked or family in _running:  # its motions come by here themselves
            return
        path = stamp_of(family)
        if not path.exists():
            _check(family, run)
            leave(path)
        checked.add(family)


def stamp_of(family: str) -> Path:
    """Where it stands that a family was checked."""
    from damper import compiled

    return stamp(f"kernels-{family.replace(' ', '-')}", Path(__file__).parent, compiled.versions(), compiled.FOLDER)


def lines(family: str, run: Callable[..., Any]) -> Iterator[Line]:
    """All figures of a family's motions; see `once`."""
    for name, motion in FAMILIES[family].items():
        _running.add(family)
        try:
            computed = figures_of(motion, run)
        finally:
            _running.discard(family)
        yield from (Line(name, figure, computed[figure], reference) for figure, reference in motion.figures.items())


def _check(family: str, run: Callable[..., Any]) -> None:
    try:
        for line in lines(family, run):
            law = f"'{line.name}' comes out as computed independently"
            require(law, f"the error of its {line.figure}", line.error, EXACT)
    except LawViolation as error:
        error.add_note("in the self-check of the compiled kernels")
        raise


def figures_of(motion: Motion | Sweep | Curve | SteadyState, run: Callable[..., Any]) -> dict[str, float]:
    """Figures of a reference motion as computed here; see `once`."""
    damper = motion.damper
    if isinstance(motion, Motion):
        result = run(damper, motion.release, motion.cycles, harmonic=motion.harmonic, amplitudes=motion.amplitudes)
        energy = result.energy
        shares = {"energy left": energy.final, "rolling work": energy.rolling, "work": energy.work}
        return {"hits": float(result.impacts)} | {name: value / energy.initial for name, value in shares.items()}
    if isinstance(motion, Sweep):
        samples = run(damper, motion.low, motion.high, STARTS, motion.stay, 1)
        return {"cycles": float(len(samples)), "decrements": float(np.sum(samples[:, 0] - samples[:, 1]))}
    if isinstance(motion, Curve):
        curve = run(damper, threads=1, sweeps=motion.sweeps, stay=motion.stay)
        return {
            "cut-off": curve.cutoff,
            "peak": curve.peak,
            "amplitude of the peak": curve.peak_amplitude,
            "half below": curve.half[0],
            "half above": curve.half[1],
        }
    state = run(damper, [motion.harmonic], threads=1)
    hits, amplitude, power = (float(each[0, 0]) for each in (state.hits_per_cycle, state.mean, state.power_in))
    return {
        "hits a cycle": hits,
        "mean amplitude": amplitude,
        "power": power,
        "amplitude with the ball at rest": abs(state.linear[0]),
        "amplitude without the ball": abs(state.without[0]),
        "its phase": cmath.phase(state.without[0]),
    }
