"""Structural modes as dampers feel them at the cavity: which coordinates there are, and what couples the two axes.

Structural modes q_k move the cavity, u = Phi q along x and y, and tilt its floor; the ball is at s in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.parameters import in_plane, path_curvature

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats
    from damper.model import ParticleDamper
    from damper.modes import Harmonic, Mode
    from damper.parameters import Parameters


class Structures(NamedTuple):
    """Structural modes as n dampers feel them.

    Attributes:
        mass, spring, dashpot: shape (n, k).
        shape, slope: displacement and slope of the cavity's floor along x and y, shape (n, 2, k).
        drawn: force on the modes by unit acceleration of the base, but for its sign, shape (n, 2, k) [kg].
    """

    mass: Floats
    spring: Floats
    dashpot: Floats
    shape: Floats
    slope: Floats
    drawn: Floats


def structures_by(damper: ParticleDamper, rows: Parameters) -> Structures:
    """The structures that rows of a damper vibrate on."""
    return single_modes(rows) if damper.modes is None else structures_of(rows, damper.modes)


def single_modes(rows: Parameters) -> Structures:
    """One mode along x and one along y, as in the paper."""
    n = len(rows)
    shape, slope = np.zeros((n, 2, 2)), np.zeros((n, 2, 2))
    shape[:, 0, 0] = shape[:, 1, 1] = 1.0
    slope[:, 0, 0], slope[:, 1, 1] = rows["floor_tilt"].T
    mass = np.repeat(rows["modal_mass"][:, None], 2, axis=1)
    dashpot = 2 * rows["damping_ratio"][:, None] * np.sqrt(rows["stiffness"] * mass)
    return Structures(mass, rows["stiffness"].copy(), dashpot, shape, slope, mass[:, None, :] * shape)


def structures_of(rows: Parameters, modes: tuple[Mode, ...]) -> Structures:
    """A damper's modes, the same for all rows; those without a damping ratio have that of the rows."""
    n = len(rows)
    mass, spring = (np.tile([getattr(mode, name) for mode in modes], (n, 1)) for name in ("mass", "stiffness"))
    shape, slope, drawn = (
        np.tile(np.transpose([getattr(mode, name) for mode in modes]), (n, 1, 1))
        for name in ("shape", "slope", "participation")
    )
    ratio = np.stack([rows["damping_ratio"] if m.damping_ratio is None else np.full(n, m.damping_ratio) for m in modes])
    return Structures(mass, spring, 2 * ratio.T * np.sqrt(spring * mass), shape, slope, drawn)


def load_of(rows: Parameters, structures: Structures) -> tuple[Floats, Floats]:
    """E, shape (n, 2, k), and D, shape (n, 2, 2): the load accelerates the ball by -(E q + D s) [1/s²]."""
    spin, load = in_plane(rows), rows["centrifugal_acceleration"][:, None]
    pull = load[:, :, None] * structures.slope - spin @ structures.shape
    return pull, (load * path_curvature(rows))[:, :, None] * np.eye(2) - spin


def couples(rows: Parameters, structures: Structures) -> npt.NDArray[np.bool_]:
    """Whether anything couples the two axes of a damper, shape (n,)."""
    pull, curve = load_of(rows, structures)
    felt = (structures.shape != 0) | (pull != 0)
    coupled: npt.NDArray[np.bool_] = (felt[:, 0] & felt[:, 1]).any(axis=1) | (curve[:, 0, 1] != 0)
    return coupled


def members_of(rows: Parameters, structures: Structures) -> list[list[int]]:
    """Coordinates (q, s) of each group: those of x and those of y, or all in one where anything couples them."""
    k, pull = structures.mass.shape[1], load_of(rows, structures)[0]
    if couples(rows, structures).any():
        return [list(range(k + 2))]
    along_y = ((structures.shape[:, 1] != 0) | (pull[:, 1] != 0)).any(axis=0)
    return [[*np.flatnonzero(~along_y), k], [*np.flatnonzero(along_y), k + 1]]


def forces_on(structures: Structures, harmonics: Sequence[Harmonic]) -> Floats:
    """Height of each harmonic's force on the modes, without the ball's part in a moving base, shape (n, k) [N]."""
    k = structures.mass.shape[1]
    for one in harmonics:
        if one.modal is not None and len(one.modal) != k:
            raise ValueError(f"modal must be {k} forces, one for each mode, got {len(one.modal)}")
    push, base = (np.array([getattr(one, name) for one in harmonics])[:, None, :] for name in ("force", "base"))
    modal = np.array([one.modal or (0.0,) * k for one in harmonics])
    forces: Floats = modal + (push @ structures.shape)[:, 0] - (base @ structures.drawn)[:, 0]
    return forces
