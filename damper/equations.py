"""The equations of motion of structure and ball as linear systems, one for each pair of regimes of the two axes.

Structural modes q_k move the cavity, u = Phi q along x and y, and tilt its floor; the ball is at s in it. With the
ball's inertia and what the load does to a ball off its place,

    L = q'M q'/2 + m |u' + s'|²/2 + (2/5) m |s'|²/2 - q K q/2 - m s E q - m s D s/2,

E = G kappa - Omega² P Phi and D = G / rho - Omega² P: G the load, kappa the slopes of the floor, rho the radii of the
path of the ball's centre, P the projection onto the plane of rotation, as a stagger turns it. K holds what the load
does to a ball in its place. Rolling resistance or sliding friction is a constant force on s. Each flight is then

    z'' = - stiffness z - damping z' + resistance + force cos(nu t + phase),   z = (q, s).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.model import Harmonic, in_plane, inertia_ratio, path_curvature
from damper.state import ROLLING, STUCK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.model import Floats, Mode, Parameters, ParticleDamper


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


REGIMES = 3


class Equations(NamedTuple):
    """Of the flights of n dampers in every pair of regimes of x and y, in the N coordinates (q, s).

    Attributes:
        stiffness, damping: shape (n, 9, N, N).
        resistance: what a unit of resisting acceleration does along each axis, shape (n, 9, 2, N).
        force: what a harmonic does at its height, shape (n, 9, N).
        shape: u = shape z, shape (n, 2, N).
        pull: the load accelerates the ball in its cavity by -pull z, shape (n, 2, N).
        sway: the harmonic accelerates a stuck ball against its cavity, shape (n, 2).
        power: that it puts in per velocity, shape (n, N).
        frequency, phase: of the harmonic, 0 where there is none, shape (n,).
    """

    stiffness: Floats
    damping: Floats
    resistance: Floats
    force: Floats
    shape: Floats
    pull: Floats
    sway: Floats
    power: Floats
    frequency: Floats
    phase: Floats


def equations_of(
    rows: Parameters, structures: Structures, harmonic: Harmonic | Sequence[Harmonic] | None = None
) -> Equations:
    """Equations of dampers on structures; one harmonic drives all of them, or each has its own."""
    n = len(rows)
    pull, curve = load_of(rows, structures)
    sway, load, driven = _driven(rows, structures, harmonic)
    flights = [
        _flight(_Felt(structures, pull, curve, rows["ball_mass"][:, None, None], load, sway), _beta(rows, regimes))
        for regimes in np.ndindex(REGIMES, REGIMES)
    ]
    stiffness, damping, resistance, force = (np.stack(each, axis=1) for each in zip(*flights, strict=True))
    return Equations(
        stiffness=stiffness,
        damping=damping,
        resistance=resistance,
        force=force,
        shape=np.concatenate([structures.shape, np.zeros((n, 2, 2))], axis=2),
        pull=np.concatenate([pull, curve], axis=2),
        sway=sway,
        power=load,
        frequency=driven[:, 0],
        phase=driven[:, 1],
    )


class _Felt(NamedTuple):
    """A structure, what the load and a harmonic do to the ball on it, and the ball's mass."""

    structures: Structures
    pull: Floats
    curve: Floats
    ball: Floats
    load: Floats
    sway: Floats


def _beta(rows: Parameters, regimes: tuple[int, ...]) -> Floats:
    """How much of the structure's acceleration the ball lags behind by, along each axis, shape (n, 2)."""
    share = {STUCK: np.zeros(len(rows)), ROLLING: inertia_ratio(rows)}
    return np.stack([share.get(regime, np.ones(len(rows))) for regime in regimes], axis=1)


def _flight(felt: _Felt, beta: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Stiffness, damping, resistance and force in one pair of regimes.

    Along each axis the ball's acceleration in space is b = (1 - beta) u'' + h, h = -beta (E q + D s + resistance), and
    M q'' + C q' + K q + m Phi' b + m E's = 0: two equations for u'', the rest is substitution.
    """
    structures, pull, curve, ball, load, sway = felt
    n, k = structures.mass.shape
    compliance = structures.shape @ (structures.shape / structures.mass[:, None, :]).transpose(0, 2, 1)
    inverse = 1.0 / structures.mass[:, :, None]
    lag = beta[:, :, None]
    back = np.linalg.inv(np.eye(2) + ball * compliance * (1.0 - beta)[:, None, :])

    def response(modes: Floats, h: Floats) -> Floats:
        """Accelerations of z from those that the modes would have without the ball, and from h."""
        u = back @ (structures.shape @ modes - ball * compliance @ h)
        b = (1.0 - lag) * u + h
        return np.concatenate([modes - ball * inverse * (structures.shape.transpose(0, 2, 1) @ b), b - u], axis=1)

    eye = np.broadcast_to(np.eye(k), (n, k, k))
    springs = np.concatenate([structures.spring[:, :, None] * eye, ball * pull.transpose(0, 2, 1)], axis=2)
    stiffness = -response(-inverse * springs, -lag * np.concatenate([pull, curve], axis=2))
    dashpots = np.concatenate([structures.dashpot[:, :, None] * eye, np.zeros((n, k, 2))], axis=2)
    damping = -response(-inverse * dashpots, np.zeros((n, 2, k + 2)))
    resistance = response(np.zeros((n, k, 2)), -lag * np.eye(2))
    force = response(inverse * load[:, :k, None], lag * sway[:, :, None])
    return stiffness, damping, resistance.transpose(0, 2, 1), force[..., 0]


def _driven(
    rows: Parameters, structures: Structures, harmonic: Harmonic | Sequence[Harmonic] | None
) -> tuple[Floats, Floats, Floats]:
    """A harmonic's acceleration of the ball against its base, its force on each coordinate, frequency and phase."""
    n, k = structures.mass.shape
    if harmonic is None:
        return np.zeros((n, 2)), np.zeros((n, k + 2)), np.zeros((n, 2))
    each = (harmonic,) * n if isinstance(harmonic, Harmonic) else tuple(harmonic)
    sway = -np.array([one.base for one in each])
    ball = rows["ball_mass"][:, None] * sway
    modal = forces_on(structures, each) + (ball[:, None, :] @ structures.shape)[:, 0]
    driven = np.array([(one.frequency, one.phase) for one in each])
    return sway, np.concatenate([modal, ball], axis=1), driven
