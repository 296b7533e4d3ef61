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

from damper.modes import Harmonic
from damper.parameters import inertia_ratio
from damper.records import ROLLING, STUCK
from damper.structures import forces_on, load_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.arrays import Floats
    from damper.parameters import Parameters
    from damper.structures import Structures

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
