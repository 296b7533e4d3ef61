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


class Motion(NamedTuple):
    """A reference motion: the damper, what else its family's function is called with, and figures of the result.

    Energies are shares of the initial one, losses of sweeps logarithmic decrements.
    """

    damper: ParticleDamper
    arguments: dict[str, Any]
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

_PAPERS = {"release": (20e-3, 5e-3), "cycles": 20}

RINGDOWNS = {
    "level floor": Motion(_PAPER, _PAPERS, {"hits": 164, "energy left": 0.99138562833, "rolling work": 0.00506813179}),
    "printed equations": Motion(
        replace(_PAPER, formulation=Formulation.PRINTED), _PAPERS, {"hits": 165, "energy left": 1.0680097305}
    ),
    "slip after hits": Motion(
        replace(_PAPER, floor_friction=0.3), _PAPERS | {"cycles": 6}, {"hits": 39, "energy left": 0.99732487634}
    ),
    "tilting, hollow floor": Motion(
        _TILTING, {"release": (1.0, 0.4), "cycles": 6}, {"hits": 23, "energy left": 0.83789618141}
    ),
    "three modes": Motion(
        _COUPLED,
        {"release": (0.0, 0.0), "cycles": 5, "amplitudes": (0.8, 0.5, 0.3)},
        {"hits": 21, "energy left": 0.6307570328},
    ),
    "harmonic force": Motion(
        _DAMPED,
        {"release": (0.6, 0.0), "cycles": 6, "harmonic": Harmonic(0.97, (0.05, 0.02), phase=0.4)},
        {"hits": 11, "energy left": 0.94540234479, "work": 1.46256317602},
    ),
}
"""By `damper.ringdown`."""

_DOWN = {"high": 1.0, "low": 0.27, "sweeps": 2, "stay": 8, "threads": 1}
SWEEPS = {
    "sweeps on a level floor": Motion(_LEVEL, _DOWN, {"cycles": 20, "decrements": 0.96454254615}),
    "sweeps on a tilting floor": Motion(_TILTING, _DOWN, {"cycles": 20, "decrements": 0.67000214447}),
}
"""By `damper.curve_measurement.samples_of`."""

_FEW = {"sweeps": 2, "stay": 28, "threads": 1}
CURVES = {
    "curve on a level floor": Motion(
        replace(_LEVEL, restitution=0.3),
        _FEW,
        {
            "cut-off": 0.1,
            "peak": 0.00907194034972,
            "amplitude of the peak": 0.36390534043,
            "half below": 0.31947758200,
            "half above": 0.85749475943,
        },
    ),
    "curve on a tilting floor": Motion(
        replace(_TILTING, restitution=0.3),
        _FEW,
        {
            "cut-off": 1 / 7,
            "peak": 0.00566664831756,
            "amplitude of the peak": 0.40843420718,
            "half below": 0.37425100124,
            "half above": 0.90472905424,
        },
    ),
}
"""By `damper.curve_measurement.falling`."""

STEADY = {
    "steady state": Motion(
        _DAMPED,
        {"harmonics": [Harmonic(1.0, (0.04, 0.0))], "threads": 1},
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
"""By `damper.forced`."""

FAMILIES = {"ring-downs": RINGDOWNS, "sweeps": SWEEPS, "curves": CURVES, "forced": STEADY}
"""Families of kernels, and what they must reproduce."""

_READ: dict[str, Callable[[Any], Any]] = {
    "hits": lambda run: run.impacts,
    "energy left": lambda run: run.energy.final / run.energy.initial,
    "rolling work": lambda run: run.energy.rolling / run.energy.initial,
    "work": lambda run: run.energy.work / run.energy.initial,
    "cycles": len,
    "decrements": lambda samples: np.sum(samples[:, 0] - samples[:, 1]),
    "cut-off": lambda curve: curve.cutoff,
    "peak": lambda curve: curve.peak,
    "amplitude of the peak": lambda curve: curve.peak_amplitude,
    "half below": lambda curve: curve.half[0],
    "half above": lambda curve: curve.half[1],
    "hits a cycle": lambda state: state.hits_per_cycle[0, 0],
    "mean amplitude": lambda state: state.mean[0, 0],
    "power": lambda state: state.power_in[0, 0],
    "amplitude with the ball at rest": lambda state: abs(state.linear[0]),
    "amplitude without the ball": lambda state: abs(state.without[0]),
    "its phase": lambda state: cmath.phase(state.without[0]),
}
"""How each figure is read off a result."""

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


def figures_of(motion: Motion, run: Callable[..., Any]) -> dict[str, float]:
    """Figures of a reference motion as computed here; see `once`."""
    result = run(motion.damper, **motion.arguments)
    return {figure: float(_READ[figure](result)) for figure in motion.figures}
