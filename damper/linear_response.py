"""Linear response to a harmonic force: of the structure with the ball at rest in it, and without it.

Amplitudes are complex: a coordinate of amplitude z moves as the real part of z exp(i frequency t).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.equations import forces_on
from damper.model import half_gap, rolling_threshold

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.equations import Structures
    from damper.model import Floats, Harmonic, Parameters
    from damper.setup import Systems


Complex = npt.NDArray[np.complexfloating]

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


def locked(systems: Systems) -> Locked:
    """Solve for the structure's answers, the ball stuck; their coordinates are in the systems' order."""
    of, damped = systems.equations, systems.constants["damped"]
    stiffness, damping, force = of.stiffness[:, 0], of.damping[:, 0], of.force[:, 0]
    nu, size = of.frequency, stiffness.shape[1]
    turn = np.exp(1j * of.phase)[:, None]
    loss = 1j * np.where(damped, 0.0, _LOSSLESS) * nu**2
    matrix = stiffness + 1j * nu[:, None, None] * damping - (nu**2 - loss)[:, None, None] * np.eye(size)
    z = np.linalg.solve(matrix, (force * turn)[..., None])[..., 0]
    rate = (1j * nu[:, None] * z)[:, systems.order]
    drive = np.abs((((nu**2)[:, None, None] * of.shape - of.pull) @ z[..., None])[..., 0] + of.sway * turn)
    power_in = 0.5 * np.real(of.power[:, systems.order] * turn * rate.conj()).sum(axis=1)
    power_lost = 0.5 * (systems.constants["dashpot"][:, :size] * np.abs(rate) ** 2).sum(axis=1)
    return Locked(z[:, systems.order], drive, power_in, power_lost)


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
    from damper.slip import MARGIN

    left = rolling_threshold(rows)[:, None] - np.abs(rows["lateral_acceleration"])
    threshold = MARGIN * np.where(half_gap(rows) > 0, np.maximum(left, 0.0), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(drive > 0, threshold / drive, np.where((left < 0) & (threshold == 0), 0.0, np.inf))
    least: Floats = factor.min(axis=1)
    return least


def forgets(systems: Systems) -> float:
    """Decay rate of what the structure's own motion leaves longest, the ball stuck; 0 without damping [1/s]."""
    modes = systems.equations.stiffness.shape[-1] - 2
    k, d = (each[0, 0, :modes, :modes] for each in (systems.equations.stiffness, systems.equations.damping))
    roots = np.linalg.eigvals(np.block([[np.zeros_like(k), np.eye(len(k))], [-k, -d]]))
    return max(0.0, float(-roots.real.max())) if systems.constants["damped"][0] else 0.0
