"""The particle damper: what it is made of, in SI, validated once."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from damper import parameters as derived
from damper.parameters import PARAMETERS, Parameters, number, pair, validate


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
        Formulation(self.formulation)
        if self.floor_friction is not None and not number("floor_friction", self.floor_friction) > 0:
            raise ValueError(f"floor_friction must be positive or None, got {self.floor_friction:g}")
        validate(self.parameters)

    @property
    def parameters(self) -> Parameters:
        """The fields as one row, shape (1,), for what works on many dampers alike."""
        rows = np.zeros(1, PARAMETERS)
        for name in PARAMETERS.names or ():
            if name == "printed" or (name == "floor_friction" and self.floor_friction is None):
                continue
            rows[name] = (pair if rows[name].ndim == 2 else number)(name, getattr(self, name))
        rows["printed"] = self.formulation == Formulation.PRINTED
        return rows

    @property
    def stuck_mass(self) -> float:
        """M1 = M2 + m_p [kg]."""
        return self.modal_mass + self.ball_mass

    @property
    def stuck_frequency(self) -> float:
        """omega_1 along x, the ball stuck [rad/s]."""
        return float(derived.stuck_frequency(self.parameters)[0])

    @property
    def half_gap(self) -> tuple[float, float]:
        """How far the ball's centre can go from the cavity's centre along x and y [m]."""
        x, y = derived.half_gap(self.parameters)[0]
        return float(x), float(y)

    @property
    def rolling_threshold(self) -> float:
        """a_r = mu_r N / (r m_p): the structure's acceleration above which a stuck ball rolls [m/s^2]."""
        return float(derived.rolling_threshold(self.parameters)[0])

    @property
    def inertia_ratio(self) -> float:
        """Beta in  s'' = -beta (u'' - a_r sigma)  [-].

        5/7 for a solid sphere on a floor (moments about the contact); 5/2 as the paper prints it (moment of
        inertia about the centre in an equation of moments about the contact); 1 for a ball that nothing presses
        onto the floor, which floats.
        """
        return float(derived.inertia_ratio(self.parameters)[0])

    @property
    def spin_mass(self) -> float:
        """Mass-equivalent of the rolling ball's spin, 2/5 m_p [kg]; none in the printed equations or afloat."""
        return float(derived.spin_mass(self.parameters)[0])
