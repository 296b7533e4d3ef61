"""The linear answer to a harmonic force: of the structure with the ball at rest in it, and without the ball.

Amplitudes are complex: what is z there moves as the real part of z exp(i frequency t).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.linear import forces_on
from damper.parameters import half_gap, rolling_threshold

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats, Records
    from damper.linear import Structures
    from damper.modes import Harmonic
    from damper.parameters import Parameters

Complex = npt.NDArray[np.complex128]

_LOSSLESS = 1e-14
"""Loss factor that keeps the answer of a structure without damping finite."""


class Locked(NamedTuple):
    """The linear answers of n systems of the same damper while the ball is at rest in the middle of its cavity.

    Attributes:
        z: of the coordinates, shape (n, N).
        drive: largest drive of the ball along x and y, shape (n, 2) [m/s^2].
        power_in, power_lost: of the force and of the dashpots, shape (n,) [W].
    """

    z: Complex
    drive: Floats
    power_in: Floats
    power_lost: Floats


def locked(systems: Records) -> Locked:
    """Solve for the structure's answers, the ball stuck."""
    stiffness, damping, force = _stuck(systems)
    nu, size = systems["frequency"], stiffness.shape[1]
    turn = np.exp(1j * systems["phase"])[:, None]
    loss = np.where(systems["damped"], 0.0, 1j * _LOSSLESS) * nu**2
    matrix = stiffness + 1j * nu[:, None, None] * damping - (nu**2 - loss)[:, None, None] * np.eye(size)
    z = np.linalg.solve(matrix, (force * turn)[..., None])[..., 0]
    rate = 1j * nu[:, None] * z
    shape, pull = systems["mode_shape"][:, :, :size], systems["pull"][:, :, :size]
    drive = np.abs((((nu**2)[:, None, None] * shape - pull) @ z[..., None])[..., 0] + systems["sway"] * turn)
    power_in = 0.5 * np.real(systems["power"][:, :size] * turn * rate.conj()).sum(axis=1)
    power_lost = 0.5 * (systems["dashpot"][:, :size] * np.abs(rate) ** 2).sum(axis=1)
    return Locked(z, drive, power_in, power_lost)


def without_ball(structures: Structures, harmonics: Sequence[Harmonic]) -> Complex:
    """Amplitudes of the modes of the structure alone, shape (n, k)."""
    nu = np.array([harmonic.frequency for harmonic in harmonics])[:, None]
    turn = np.exp(1j * np.array([harmonic.phase for harmonic in harmonics]))[:, None]
    damping = np.where(structures.dashpot > 0, structures.dashpot, _LOSSLESS * structures.mass * nu)
    alone: Complex = (
        forces_on(structures, harmonics) * turn / (structures.spring - structures.mass * nu**2 + 1j * nu * damping)
    )
    return alone


def moves_from(rows: Parameters, drive: Floats) -> Floats:
    """By how much a harmonic may grow until the ball cannot stay at rest, shape (n,); inf where it cannot move."""
    from damper.threshold import MARGIN

    threshold = MARGIN * np.where(half_gap(rows) > 0, rolling_threshold(rows)[:, None], np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(drive > 0, threshold / drive, np.inf)
    least: Floats = factor.min(axis=1)
    return least


def forgets(systems: Records) -> float:
    """Decay rate of what the structure's own motion leaves longest, the ball stuck; 0 without damping [1/s]."""
    stiffness, damping, _ = _stuck(systems[:1])
    modes = np.setdiff1d(np.arange(stiffness.shape[1]), systems["place"][0])
    k, d = stiffness[0][np.ix_(modes, modes)], damping[0][np.ix_(modes, modes)]
    roots = np.linalg.eigvals(np.block([[np.zeros_like(k), np.eye(len(k))], [-k, -d]]))
    return max(0.0, float(-roots.real.max())) if systems["damped"][0] else 0.0


def _stuck(systems: Records) -> tuple[Floats, Floats, Floats]:
    """Stiffness, damping and force of flights with the ball stuck, in SI."""
    first = systems[0]
    size = int(first["coordinates"])
    step = np.empty((len(systems), size))
    for g in range(int(first["groups"])):
        step[:, first["low"][g] : first["high"][g]] = systems["span"][:, g, None]
    stiffness, damping = systems["stiffness"][:, 0, :size, :size], systems["damping"][:, 0, :size, :size]
    return (
        stiffness / step[..., None] ** 2,
        damping / step[..., None],
        systems["force"][:, 0, :size] / step**2,
    )
