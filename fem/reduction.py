"""The plate as one mass on one spring at the damper's place, with the ball in flight and with it stuck.

phi is the fundamental flap mode scaled to w = 1 at the damper. Ball in flight: M2 = phi' M phi and
K2 = omega_2² M2. Ball stuck: a point mass that has inertia, pulls on the plate and softens like all mass;
omega_1 is the frequency of that plate, M1 = M2 + m_p and K1 = omega_1² M1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.family import families
from fem.modes import Divergence, Modes, linearise, solve_real
from fem.operators import point_rows, with_point_mass
from fem.solver import refine

if TYPE_CHECKING:
    from fem.operators import Operators

SEARCHED = 4
"""Modes looked through for the fundamental flap mode when none are given."""


@dataclass(frozen=True)
class Reduced:
    """Reduced parameters at a place on the plate, SI units.

    f1_hz, M1, K1 with the ball stuck; f2_hz, M2, K2 without. ball_mass: m_p. mode_index: which of the
    plate's modes, from 0. slope: phi_x per unit of w at the place, 1/m. floor_tilt: Omega² r phi_x / omega_1²,
    how much of the inertia drive a cavity floor that tilts with the plate would cancel; the reduced model
    leaves it out.
    """

    f1_hz: float
    M1: float
    K1: float
    f2_hz: float
    M2: float
    K2: float
    ball_mass: float
    mode_index: int
    slope: float
    floor_tilt: float


def reduce_at(
    operators: Operators,
    omega: float,
    at: tuple[float, float],
    *,
    ball_mass: float | None = None,
    mass_ratio: float | None = None,
    modes: Modes | None = None,
) -> Reduced:
    """Reduced parameters at = (x, y) in m and a speed omega (rad/s), for a ball_mass in kg or as m_p / M2.

    modes: the plate's modes at this speed when they are known already. phi is real: Coriolis forces are left
    out of the reduction. Raises ValueError unless exactly one
    of ball_mass and mass_ratio is given and not negative, when no flap mode is among the modes, when it does
    not move at the place, or off the plate; Divergence past the critical speed.
    """
    given = [value for value in (ball_mass, mass_ratio) if value is not None]
    if len(given) != 1 or not given[0] >= 0.0:
        raise ValueError(f"give either ball_mass or mass_ratio, zero or more, got {ball_mass!r} and {mass_ratio!r}")
    if modes is not None and modes.omega != omega:
        raise ValueError(f"the modes belong to {modes.omega!r} rad/s, not to {omega!r}")
    if modes is None or np.iscomplexobj(modes.shapes):
        still, state = linearise(operators, omega, None if modes is None else modes.state)
        modes = solve_real(operators, omega, still, SEARCHED, state)
    index = flap_index(operators, modes)
    rows = point_rows(operators.model, at)
    lift = (rows @ modes.shapes)[2]
    if abs(lift[index]) * np.sqrt(operators.mass.sum()) < 1e-6:
        raise ValueError(f"the fundamental flap mode does not move at ({at[0]:.6g}, {at[1]:.6g}) m")
    m2 = float(lift[index] ** -2)
    slope = float((point_rows(operators.model, at, (0,)) @ modes.shapes[:, index])[2] / lift[index])
    mass = m2 * mass_ratio if mass_ratio is not None else float(given[0])
    free = float(modes.eigenvalues[index])
    stuck = _stuck(operators, modes, index, at, mass) if mass > 0.0 else free
    return Reduced(
        f1_hz=float(np.sqrt(stuck) / (2 * np.pi)),
        M1=m2 + mass,
        K1=stuck * (m2 + mass),
        f2_hz=float(np.sqrt(free) / (2 * np.pi)),
        M2=m2,
        K2=free * m2,
        ball_mass=mass,
        mode_index=index,
        slope=slope,
        floor_tilt=omega**2 * (operators.rotor.hub_radius + at[0]) * slope / stuck,
    )


def flap_index(operators: Operators, modes: Modes) -> int:
    """Find the lowest flap mode. Raises ValueError when there is none."""
    names = families(operators, modes)
    if "flap" not in names:
        raise ValueError(f"no flap mode among the {len(names)} lowest: {', '.join(names)}")
    return names.index("flap")


def _stuck(operators: Operators, modes: Modes, index: int, at: tuple[float, float], mass: float) -> float:
    """Squared frequency of the mode that the flap mode becomes when a mass sticks to the plate."""
    heavy = with_point_mass(operators, at, mass)
    pull = modes.factor.solve(point_rows(operators.model, at).toarray().T)
    start = np.hstack([modes.shapes, pull])
    stiffness, _ = linearise(heavy, modes.omega, modes.state)
    value, _ = refine(stiffness, heavy.mass, start, index, modes.factor)
    if value <= 0.0:
        raise Divergence(modes.omega, value)
    return value
