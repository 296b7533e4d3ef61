"""What the force of a scene does to the structure at a crossing: which modes count, and how they are driven."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from workflows.results.crossings import Crossing
from workflows.scene.excitation import Excitation
from workflows.solve import felt
from workflows.solve.records import CavityMode, SpeedPoint

if TYPE_CHECKING:
    import damper

_STILL = 1e-6
"""Displacement of the cavity over that of the whole plate, and force over that of a mode, that counts as none."""


def branch_of(points: Sequence[SpeedPoint], crossing: Crossing) -> int:
    """What the mode that is crossed is called among some speeds: branches are numbered at the lowest of them."""
    point = min(points, key=lambda point: abs(point.omega - crossing.omega))
    near = min(point.modes, key=lambda mode: abs(mode.frequency_hz - crossing.frequency_hz), default=None)
    return 0 if near is None else near.branch


def modes_of(point: SpeedPoint, branch: int) -> list[CavityMode] | None:
    """The mode that is crossed first, then the others; None where the structure is given."""
    if not point.cavity_modes:
        return None
    crossed = next((k for k, mode in enumerate(point.modes) if mode.branch == branch), 0)
    return [point.cavity_modes[crossed], *(m for k, m in enumerate(point.cavity_modes) if k != crossed)]


def kept(point: SpeedPoint, modes: list[CavityMode]) -> list[CavityMode]:
    """The mode crossed and those that yield most along either axis, ascending."""
    leaders = [felt.leading(point.cavity_modes, axis) for axis in range(2)]
    numbers = {modes[0].number} | {mode.number for mode in leaders if mode is not None}
    return [mode for mode in point.cavity_modes if mode.number in numbers]


def idle(modes: list[CavityMode], excitation: Excitation) -> str:
    """Why a crossing has nothing to follow; nothing where it has."""
    most = max(math.hypot(*mode.shape) for mode in modes)
    if math.hypot(*modes[0].shape) <= _STILL * most:
        return "the damper's place does not move in this mode"
    pushes = [abs(_push(mode, excitation.kind)) for mode in modes]
    return "" if pushes[0] > _STILL * max(pushes) else "the excitation does not drive this mode"


def _push(mode: CavityMode, kind: str) -> float:
    """Modal force by a unit of the excitation."""
    return {"force": mode.shape[0], "pressure": mode.pressed, "base": -mode.drawn[0]}[kind]


def harmonic_of(
    system: damper.ParticleDamper, crossing: Crossing, point: SpeedPoint, excitation: Excitation, level: float
) -> damper.Harmonic:
    """The excitation at a level, at a speed."""
    from damper import Harmonic

    frequency = crossing.order * point.omega
    if excitation.kind == "force":
        return Harmonic(frequency, force=(level, 0.0))
    if excitation.kind == "base":
        return Harmonic(frequency, base=(level, 0.0))
    pressed = {mode.stiffness: mode.pressed for mode in point.cavity_modes}
    return Harmonic(frequency, modal=tuple(level * pressed[mode.stiffness] for mode in system.modes or ()))


def at_cavity(system: damper.ParticleDamper, harmonic: damper.Harmonic) -> float:
    """The force at the cavity along x that drives the leading mode as much, with the ball's part in a base [N]."""
    if system.modes is None:
        return abs(harmonic.force[0] - system.stuck_mass * harmonic.base[0])
    k = system.leading(0)
    mode = system.modes[k]
    modal = 0.0 if harmonic.modal is None else harmonic.modal[k]
    drawn = mode.participation[0] + system.ball_mass * mode.shape[0]
    return abs(harmonic.force[0] + (modal - drawn * harmonic.base[0]) / mode.shape[0])
