"""The plate as one mass on one spring at the damper's place, with the ball in flight and with it stuck.

phi is the fundamental flap mode scaled to w = 1 at the damper. Ball in flight: M2 = phi' M phi and
K2 = omega_2² M2. Ball stuck: a point mass that has inertia, pulls on the plate and softens like all mass;
omega_1 is the frequency of that plate, M1 = M2 + m_p and K1 = omega_1² M1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.linalg.davidson import refine
from fem.linalg.lanczos import SingularMatrix, factorise, lanczos
from fem.meshes.locate import PlaceError
from fem.modes.family import families
from fem.modes.real import Divergence, Modes, lowest, solve_real
from fem.operators.assembly import point_rows, with_point_mass
from fem.statics.linearised import linearise

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]

SEARCHED = 4
"""Modes looked through for the fundamental flap mode when none are given."""


class NoFlapMode(ValueError):
    """None of the modes looked through bends the plate along its length."""


@dataclass(frozen=True)
class Reduced:
    """Reduced parameters at a place on the plate, SI units.

    f1_hz, M1, K1 with the ball stuck; f2_hz, M2, K2 without.

    Attributes:
        ball_mass: m_p.
        mode_index: which of the plate's modes, from 0.
        slope: phi_x per unit of w at the place, 1/m.
        floor_tilt: Omega² r phi_x / omega_1², where Omega² r is the load along x: how much of the inertia drive a
            cavity floor that tilts with the plate would cancel; the reduced model leaves it out. With precone the load
            slopes along the floor as well, which is left out too.
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

    modes: the plate's modes at this speed when they are known already. phi is real: Coriolis forces are left out.

    Raises:
        ValueError: unless exactly one of ball_mass and mass_ratio is given and not negative.
        NoFlapMode: when none is among the modes.
        PlaceError: when it does not move at the place, or off the plate.
        Divergence: past the critical speed.
    """
    check_mass(ball_mass, mass_ratio)
    if modes is not None and modes.omega != omega:
        raise ValueError(f"the modes belong to {modes.omega!r} rad/s, not to {omega!r}")
    if modes is None or np.iscomplexobj(modes.shapes):
        modes = searched(operators, omega, None if modes is None else modes.state)
    index = flap_index(families(operators, modes))
    (mode,) = flap_modes(operators, at, flap_rows(operators, at) @ modes.shapes[:, [index]])
    mass = mode.mass * mass_ratio if mass_ratio is not None else float(ball_mass or 0.0)
    free = float(modes.eigenvalues[index])
    stuck = _stuck(operators, modes, index, at, mass) if mass > 0.0 else free
    return reduced(omega**2 * operators.pull(at), index, mode, mass, free, stuck)


def searched(operators: Operators, omega: float, start: Array | None = None) -> Modes:
    """Real modes enough to find the flap mode among; start: the state at this or a neighbouring speed, if known."""
    still, state = linearise(operators, omega, start)
    return solve_real(operators, omega, still, SEARCHED, state)


def check_mass(ball_mass: float | None, mass_ratio: float | None) -> None:
    """Raise ValueError unless exactly one is given, finite and not negative."""
    given = [value for value in (ball_mass, mass_ratio) if value is not None]
    if len(given) != 1 or not 0.0 <= given[0] < np.inf:
        raise ValueError(
            f"give either ball_mass or mass_ratio, zero or more and finite, got {ball_mass!r} and {mass_ratio!r}"
        )


@dataclass(frozen=True)
class FlapMode:
    """A flap mode scaled to w = 1 at a place: its modal mass in kg and its slope phi_x in 1/m there."""

    mass: float
    slope: float


def flap_rows(operators: Operators, at: tuple[float, float]) -> Array:
    """Rows (2, n) that give w and its slope w_x at a place.

    Raises:
        PlaceError: off the plate.
    """
    return np.vstack([point_rows(operators.model, at, d)[[2]].toarray() for d in ((), (0,))])


def flap_modes(operators: Operators, at: tuple[float, float], motions: Array) -> list[FlapMode]:
    """Scale mass-normalised flap modes of which w and w_x (2, k) at a place are known.

    Raises:
        PlaceError: where one of them does not move.
    """
    if np.abs(motions[0]).min() * np.sqrt(operators.mass.sum()) < 1e-6:
        raise PlaceError(f"the fundamental flap mode does not move at ({at[0]:.6g}, {at[1]:.6g}) m")
    return [FlapMode(float(lift**-2), float(slope / lift)) for lift, slope in motions.T]


def reduced(load: float, index: int, mode: FlapMode, ball_mass: float, free: float, stuck: float) -> Reduced:
    """Collect the parameters from the squared circular frequencies without the ball (free) and with it (stuck).

    load: acceleration along x at the place, in m/s².
    """
    return Reduced(
        f1_hz=float(np.sqrt(stuck) / (2 * np.pi)),
        M1=mode.mass + ball_mass,
        K1=stuck * (mode.mass + ball_mass),
        f2_hz=float(np.sqrt(free) / (2 * np.pi)),
        M2=mode.mass,
        K2=free * mode.mass,
        ball_mass=ball_mass,
        mode_index=index,
        slope=mode.slope,
        floor_tilt=load * mode.slope / stuck,
    )


def flap_index(names: list[str]) -> int:
    """Find the lowest flap mode among families.

    Raises:
        NoFlapMode: when there is none.
    """
    if "flap" not in names:
        raise NoFlapMode(f"no flap mode among the {len(names)} lowest: {', '.join(names)}")
    return names.index("flap")


def _stuck(operators: Operators, modes: Modes, index: int, at: tuple[float, float], mass: float) -> float:
    """Squared frequency of the mode that the flap mode becomes when a mass sticks to the plate."""
    heavy = with_point_mass(operators, at, mass)
    stiffness, _ = linearise(heavy, modes.omega, modes.state)
    value, _ = become(operators, modes.omega, (stiffness, heavy.mass), modes.shapes, index, at)
    return value


def become(
    operators: Operators,
    omega: float,
    stuck: tuple[csc_array, csc_array],
    shapes: Array,
    index: int,
    at: tuple[float, float],
) -> tuple[float, Array]:
    """Follow one of a plate's shapes (n, k) when a mass sticks to it at a place: (eigenvalue, shape (n,)).

    stuck: stiffness and mass then. Of the modes then, it is the one whose plate moves most alike.

    Raises:
        Divergence: when the stiffness is lost.
    """
    stiffness, mass = stuck
    try:
        factor = factorise(stiffness)
    except SingularMatrix:
        raise Divergence(omega, 0.0) from None
    if factor.negative:
        raise Divergence(omega, lowest(stiffness, mass, lanczos(factor, mass, 1)[0]), factor.negative)
    start = np.column_stack([shapes, factor.solve(point_rows(operators.model, at).toarray().T)])
    value, shape = refine(stiffness, mass, start, index, factor, operators.mass)
    if value <= 0.0:
        raise Divergence(omega, value)
    return value, shape
