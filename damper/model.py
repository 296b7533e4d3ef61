"""The particle damper: what it is made of, in SI, validated once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

import numpy as np

from damper import parameters as derived
from damper.arrays import Floats
from damper.modes import Mode
from damper.parameters import PARAMETERS, Parameters, number, pair, validate


class Formulation(StrEnum):
    """Which equations govern a rolling ball.

    ``CONSISTENT``: Newton's third law and a solid sphere that rolls on a floor; energy is conserved up to the
    work of impacts, rolling resistance and the structure's own damping. ``PRINTED``: eqs. (1)-(4) of the paper
    as they stand (moment of inertia about the centre, no reaction of the ball's inertia); energy is not conserved.
    """

    CONSISTENT = "consistent"
    PRINTED = "printed"


_ABSENT = {"printed": False, "floor_friction": 0.0, "floor_radius": np.inf}
"""Rows' values for what a damper has not."""


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
            hit but for what the wall's friction takes of it, since the floor's finite force has no time to change it,
            and slips until it rolls again. None: the spin follows the new rolling velocity at once, as in the paper.
        floor_tilt: kappa, slope of the cavity's floor along x and y over the structure's displacement [1/m]; the load
            then pulls the ball down the slope, by Omega**2 R kappa u.
        floor_radius: of the cavity's floor along x and y [m], more than the ball's; None: flat. A bowl of radius rho_c
            draws the ball back to its middle by Omega**2 R s / (rho_c - r).
        rotation: Omega [rad/s], which draws a ball outwards in the plane of rotation by Omega**2 times its way
            in it; 0: leave that out.
        stagger: angle by which the axis of rotation is tilted from x towards y [rad]; at 0 the plane of rotation
            holds y, at pi/2 it holds x. Only what `rotation` does depends on it.
        modes: structural modes that move the cavity, in place of one along x and one along y; `modal_mass` and
            `stiffness` then only say what amplitudes, cycles and bounds refer to: those of the mode that yields most
            along x (and y), scaled to 1 there. None: these two make the structure, and `floor_tilt` is theirs.

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
    floor_tilt: tuple[float, float] = (0.0, 0.0)
    floor_radius: tuple[float, float] | None = None
    rotation: float = 0.0
    stagger: float = 0.0
    modes: tuple[Mode, ...] | None = None

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        Formulation(self.formulation)
        if self.floor_friction is not None and not number("floor_friction", self.floor_friction) > 0:
            raise ValueError(f"floor_friction must be positive or None, got {self.floor_friction:g}")
        listed = isinstance(self.modes, tuple | list) and len(self.modes) > 0
        if self.modes is not None and not (listed and all(isinstance(mode, Mode) for mode in self.modes)):
            raise ValueError(f"modes must be a tuple of at least one Mode, or None, got {self.modes!r}")
        if self.modes is not None and not any(any(mode.shape) for mode in self.modes):
            raise ValueError("modes: none of them moves the cavity")
        if self.modes is not None and pair("floor_tilt", self.floor_tilt) != (0.0, 0.0):
            raise ValueError("floor_tilt belongs to a structure without modes; these have slopes of their own")
        validate(_row(self))
        for name in ("stiffness", "cavity", "floor_tilt", "floor_radius"):  # lists and arrays have no hash
            if getattr(self, name) is not None:
                object.__setattr__(self, name, pair(name, getattr(self, name)))
        if self.modes is not None:
            object.__setattr__(self, "modes", tuple(self.modes))

    @property
    def parameters(self) -> Parameters:
        """The fields as one row, shape (1,), for what works on many dampers alike; not to be written to."""
        return _known_row(self)

    @property
    def level(self) -> bool:
        """Whether the load pulls the ball to no side, as in the paper: the floor neither tilts nor is curved."""
        return bool(derived.level(self.parameters)[0])

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
    def tilt_share(self) -> tuple[float, float]:
        """Share tau of the ball's drive that the load's pull takes away along x and y [-].

        The load accelerates a ball in the middle of its cavity by -E u; where u swings with the frequency omega of an
        axis, its drive is u'' + E u = (1 - tau) u'', tau = E / omega**2. On a floor that tilts E = Omega**2 R kappa.
        """
        pull, square = self.pull, np.array(self.stiffness) / self.stuck_mass
        return float(pull[0, 0] / square[0]), float(pull[1, 1] / square[1])

    @property
    def pull(self) -> Floats:
        """E: the load accelerates a ball in the middle of its cavity by -E u, shape (2, 2) [1/s^2].

        In a structure of several modes, that of those that yield most to a force at the cavity along x and along y.
        """
        load = self.parameters["centrifugal_acceleration"][0] * np.diag(self._tilt)
        pull: Floats = load - derived.in_plane(self.parameters)[0]
        return pull

    def leading(self, axis: int) -> int:
        """Which of the modes yields most to a force at the cavity along an axis."""
        modes = self.modes or ()
        return max(range(len(modes)), key=lambda k: modes[k].shape[axis] ** 2 / modes[k].stiffness)

    @property
    def _tilt(self) -> tuple[float, float]:
        """Slope over displacement along x and y [1/m]."""
        if self.modes is None:
            return self.floor_tilt
        x, y = (self.modes[self.leading(i)] for i in range(2))
        return x.slope[0] / (x.shape[0] or math.inf), y.slope[1] / (y.shape[1] or math.inf)

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


def _row(damper: ParticleDamper) -> Parameters:
    """The fields of a damper as one row, shape (1,)."""
    rows = np.zeros(1, PARAMETERS)
    for name in PARAMETERS.names or ():
        if name == "printed" or (name in ("floor_friction", "floor_radius") and getattr(damper, name) is None):
            rows[name] = _ABSENT[name]
            continue
        rows[name] = (pair if rows[name].ndim == 2 else number)(name, getattr(damper, name))
    rows["printed"] = damper.formulation == Formulation.PRINTED
    rows.flags.writeable = False
    return rows


_known_row = lru_cache(maxsize=256)(_row)
