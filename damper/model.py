"""The particle damper: what it is made of, in SI, validated once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum


class Formulation(StrEnum):
    """Which equations govern a rolling ball.

    ``CONSISTENT``: Newton's third law and a solid sphere that rolls on a floor; energy is conserved up to the
    work of impacts, rolling resistance and the structure's own damping. ``PRINTED``: eqs. (1)-(4) of the paper
    as they stand (moment of inertia about the centre, no reaction of the ball's inertia); energy is not conserved.
    """

    CONSISTENT = "consistent"
    PRINTED = "printed"


@dataclass(frozen=True)
class ParticleDamper:
    """A ball in a cavity on a vibrating structure, pressed onto the cavity's floor by a centrifugal load.

    Attributes:
        modal_mass: M2, effective mass of the structure without the ball [kg].
        stiffness: K, effective stiffness of the structure along x and y [N/m].
        ball_mass: m_p, mass of all balls together [kg]; they move in step.
        ball_radius: r [m].
        cavity: l1 and l2, the cavity's length along x and width along y [m].
        centrifugal_acceleration: Omega**2 R, what presses the ball onto the floor [m/s^2].
        restitution: e, ratio of the normal relative speeds after and before a wall hit [-].
        friction: mu, cap on the ratio of tangential to normal impulse in a wall hit [-].
        rolling_friction: mu_r, lever arm of the rolling resistance [m].
        damping_ratio: zeta, the structure's own damping without the ball [-].
        sticking_ratio: epsilon, relative to structural speed below which a hit ends in sticking [-].
        formulation: which equations of rolling are used.
        floor_friction: coefficient of sliding friction on the floor [-]. Given, the ball keeps its spin in a wall
            hit, since the floor's finite force has no time to change it, and slips until it rolls again. None:
            the spin follows the new rolling velocity at once, as in the paper.

    Raises:
        ValueError: a quantity has no physical sense; the message names it.
    """

    modal_mass: float
    stiffness: tuple[float, float]
    ball_mass: float
    ball_radius: float
    cavity: tuple[float, float]
    centrifugal_acceleration: float
    restitution: float
    friction: float = 0.0
    rolling_friction: float = 0.0
    damping_ratio: float = 0.0
    sticking_ratio: float = 1e-2
    formulation: Formulation = Formulation.CONSISTENT
    floor_friction: float | None = None

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        _require(self.modal_mass > 0, "modal_mass", self.modal_mass, "positive")
        for k in self.stiffness:
            _require(k > 0, "stiffness", k, "positive")
        _require(self.ball_mass > 0, "ball_mass", self.ball_mass, "positive")
        _require(self.ball_radius > 0, "ball_radius", self.ball_radius, "positive")
        for length in self.cavity:
            fits = length >= 2 * self.ball_radius * (1 - 1e-12)
            _require(fits, "cavity", length, f"at least the ball's diameter {2 * self.ball_radius:g} m")
        _require(
            self.centrifugal_acceleration >= 0,
            "centrifugal_acceleration",
            self.centrifugal_acceleration,
            "≥ 0",
        )
        _require(0 <= self.restitution <= 1, "restitution", self.restitution, "between 0 and 1")
        _require(self.friction >= 0, "friction", self.friction, "≥ 0")
        _require(self.rolling_friction >= 0, "rolling_friction", self.rolling_friction, "≥ 0")
        _require(0 <= self.damping_ratio < 1, "damping_ratio", self.damping_ratio, "at least 0 and below 1")
        _require(self.sticking_ratio >= 0, "sticking_ratio", self.sticking_ratio, "≥ 0")
        Formulation(self.formulation)
        if self.floor_friction is not None:
            _require(self.floor_friction > 0, "floor_friction", self.floor_friction, "positive")
            if self.formulation is Formulation.PRINTED:
                raise ValueError("floor_friction: the printed equations know no slip; use the consistent formulation")

    @property
    def stuck_mass(self) -> float:
        """M1 = M2 + m_p [kg]."""
        return self.modal_mass + self.ball_mass

    @property
    def stuck_frequency(self) -> float:
        """omega_1 along x, the ball stuck [rad/s]."""
        return math.sqrt(self.stiffness[0] / self.stuck_mass)

    @property
    def half_gap(self) -> tuple[float, float]:
        """How far the ball's centre can go from the cavity's centre along x and y [m]."""
        return tuple(max(0.5 * length - self.ball_radius, 0.0) for length in self.cavity)  # type: ignore[return-value]

    @property
    def rolling_threshold(self) -> float:
        """a_r = mu_r N / (r m_p): the structure's acceleration above which a stuck ball rolls [m/s^2]."""
        return self.rolling_friction / self.ball_radius * self.centrifugal_acceleration

    @property
    def inertia_ratio(self) -> float:
        """Beta in  s'' = -beta (u'' - a_r sigma)  [-].

        5/7 for a solid sphere on a floor (moments about the contact); 5/2 as the paper prints it (moment of
        inertia about the centre in an equation of moments about the contact); 1 for a ball that nothing presses
        onto the floor, which floats.
        """
        if self.centrifugal_acceleration == 0.0:
            return 1.0
        return 5 / 7 if self.formulation is Formulation.CONSISTENT else 5 / 2

    @property
    def spin_mass(self) -> float:
        """Mass-equivalent of the rolling ball's spin, 2/5 m_p [kg]; none in the printed equations or afloat."""
        if self.formulation is Formulation.PRINTED or self.centrifugal_acceleration == 0.0:
            return 0.0
        return 0.4 * self.ball_mass


def _require(holds: bool, name: str, value: float, rule: str) -> None:
    if not (holds and math.isfinite(value)):
        raise ValueError(f"{name} must be {rule}, got {value:g}")
