"""How far energy lets structure and ball go, and the most energy that a ball can take.

In the coordinates of `damper.linear`, what acts on the ball along its way s in the cavity takes the energy

    L = - [m s' Gamma s' / 2 + m spin² / 5 + m s (D - N) s / 2 - m s B q]
        - m ∫ s B q' dt + m ∫ s' (A s + Gamma Phi M⁻¹ C q') dt

with Gamma = (1 + m Phi M⁻¹ Phi')⁻¹, B = Gamma Phi M⁻¹ K - E, and N and A the symmetric and the antisymmetric part of
m Gamma Phi M⁻¹ E'. This follows from the equations of motion, integrated by parts across all hits. For one mode
B = omega_1² (1 - tau), and the integral of s B q' is the work bound 4 (m / M2) (d / A) (1 - tau) of a sinusoidal cycle.
Here q' is bounded by the energy instead, so that no waveform is assumed: a factor of at most pi / 2 more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from damper.parameters import half_gap
from damper.structures import load_of

if TYPE_CHECKING:
    from damper.arrays import Floats
    from damper.parameters import Parameters
    from damper.structures import Structures


class Bounds(NamedTuple):
    """Bounds on n dampers; T and V are the kinetic and elastic energy of the structure.

    Attributes:
        ball: mass m, shape (n,) [kg].
        gap: half the clearance along each axis, shape (n, 2) [m].
        depth: least potential energy of structure and ball, with its sign changed, shape (n,) [J].
        mobility: the cavity's speed is at most sqrt(2 mobility T), shape (n,) [1/kg].
        flexibility: its displacement is at most sqrt(2 flexibility V), shape (n, 2) [m/N].
        drive: abs(B q') is at most drive sqrt(2 T), shape (n, 2).
        hold: abs(B q) is at most hold sqrt(2 V), shape (n, 2).
        damped: abs(B q') is at most damped times the root of the dashpots' power; inf without dashpots, shape (n, 2).
        skew: abs(A), which couples the axes, shape (n,) [1/s²].
        bowl: abs(m s (D - N) s / 2) at most, shape (n,) [J].
        pull: abs(m E s) at most, shape (n, k) [N].
    """

    ball: Floats
    gap: Floats
    depth: Floats
    mobility: Floats
    flexibility: Floats
    drive: Floats
    hold: Floats
    damped: Floats
    skew: Floats
    bowl: Floats
    pull: Floats

    def speed(self, energy: Floats) -> Floats:
        """Largest sqrt(2 T), and sqrt(2 V), at a total energy, both of shape (n, …) [J^0.5]."""
        depth = self.depth.reshape(-1, *(1,) * (energy.ndim - 1))
        speed: Floats = np.sqrt(np.maximum(2 * (energy + depth), 0.0))
        return speed

    def work(self, speed: Floats, time: Floats | float, path: Floats | float = np.inf) -> Floats:
        """Largest L at such a speed, without the terms in `bowl`, the ball's own energy and the dashpots.

        Args:
            speed: see `speed`, shape (n,).
            time: for which it lasts [s].
            path: bound on the integral of abs(B q') along each axis, if known, shape (n, 2) [m/s²].
        """
        speed, time = speed[:, None], np.asarray(time).reshape(-1, 1)
        along = np.fmin(path, self.drive * speed * time) + 2 * self.hold * speed
        across = self.skew[:, None] * np.sqrt(1 / self.ball + self.mobility)[:, None] * speed * time
        work: Floats = self.ball * (self.gap * (along + across)).sum(axis=1)
        return work

    def dashpot_work(self, structures: Structures, speed: Floats, time: Floats | float) -> Floats:
        """Largest integral of m s' Gamma Phi M⁻¹ C q' in L, for one mode an axis, shape (n,) [J].

        The structure's equation times s gives
        M1 ∫ s' u' dt + m ∫ s'² dt = [M1 s u' + m s s'] + ∫ s (c u' + K u + m E s) dt.
        """
        speed, time, ball = speed[:, None], np.asarray(time).reshape(-1, 1), self.ball[:, None]
        mass, stuck = structures.mass, structures.mass + ball
        ends = 2 * speed * (stuck / np.sqrt(mass) + np.sqrt(ball * stuck / mass))
        forces = speed * (structures.dashpot / np.sqrt(mass) + np.sqrt(structures.spring)) + self.pull
        work: Floats = (ball * structures.dashpot / stuck**2 * self.gap * (ends + time * forces)).sum(axis=1)
        return work


def bounds_of(rows: Parameters, structures: Structures) -> Bounds:
    """Bounds of dampers on structures."""
    gap, ball = half_gap(rows), rows["ball_mass"][:, None, None]
    pull, curve = load_of(rows, structures)
    mass, spring, dashpot = (each[:, None, :] for each in (structures.mass, structures.spring, structures.dashpot))
    per_force = structures.shape / mass
    compliance = per_force @ structures.shape.transpose(0, 2, 1)
    gamma = np.linalg.inv(np.eye(2) + ball * compliance)
    drive = gamma @ (per_force * spring) - pull
    turned = ball * gamma @ per_force @ pull.transpose(0, 2, 1)
    even = 0.5 * (turned + turned.transpose(0, 2, 1))
    sag = ball**2 * (pull / spring) @ pull.transpose(0, 2, 1) - ball * curve
    corner = 0.5 * gap[:, :, None] * gap[:, None, :]
    (x, xy), y = compliance[:, 0].T, compliance[:, 1, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        damped = np.where(drive == 0, 0.0, drive**2 / dashpot).sum(axis=2)
    return Bounds(
        ball=rows["ball_mass"],
        gap=gap,
        depth=(corner * np.where(np.eye(2) > 0, np.maximum(sag, 0.0), np.abs(sag))).sum(axis=(1, 2)),
        mobility=0.5 * (x + y) + np.hypot(0.5 * (x - y), xy),
        flexibility=(structures.shape**2 / spring).sum(axis=2),
        drive=np.sqrt((drive**2 / mass).sum(axis=2)),
        hold=np.sqrt((drive**2 / spring).sum(axis=2)),
        damped=np.sqrt(damped),
        skew=0.5 * np.abs(turned[:, 0, 1] - turned[:, 1, 0]),
        bowl=(corner * ball * np.abs(curve - even)).sum(axis=(1, 2)),
        pull=(ball * np.abs(pull.transpose(0, 2, 1)) @ gap[:, :, None])[..., 0],
    )
