"""A damper where an engine order crosses a mode: what drives it there and at speeds around, and what that leads to.

Around a crossing the squared frequencies go with the square of the speed (Southwell), the load and the spin with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from workflows.effects.effect import Effect
from workflows.results.crossings import Crossing
from workflows.scene.scene import Scene
from workflows.solve import damper_stage, felt
from workflows.solve.records import SpeedPoint
from workflows.studies.response import driven

if TYPE_CHECKING:
    from damper import Backbone, Forced, Harmonic, ParticleDamper, Start
    from damper.starts import Motions

_ACCURACY = 1e-2
"""To which the mean amplitude is known of motion that does not repeat itself."""

_ABOUT, _WIDTHS = 41, 3.0
"""Speeds by which a linear resonance is looked for, and how far around where it should be, in damping ratios."""


@dataclass(frozen=True, eq=False)
class Crossed:
    """A damper at a crossing, under the greatest of the levels.

    Attributes:
        crossing: of the order with the structure without a ball.
        system: the damper there; axis: along which of its axes the amplitude is; harmonic: what drives it there.
        leads: whether the mode is the one that yields most along x, of which free vibration tells.
        speeds: between which the order is looked at [rad/s].
    """

    crossing: Crossing
    system: ParticleDamper
    axis: int
    harmonic: Harmonic
    leads: bool
    speeds: tuple[float, float]

    def at(self, omega: float) -> tuple[ParticleDamper, Harmonic]:
        """The damper and what drives it at a speed [rad/s]."""
        square = (omega / self.crossing.omega) ** 2
        stiffer = 1 + self._turns * (square - 1)
        system = self.system
        modes = system.modes
        if modes is not None:
            modes = tuple(replace(mode, stiffness=mode.stiffness * stiffer) for mode in modes)
        x, y = system.stiffness
        turned = replace(
            system,
            stiffness=(x * stiffer, y * stiffer),
            modes=modes,
            centrifugal_acceleration=system.centrifugal_acceleration * square,
            rotation=system.rotation * math.sqrt(square),
        )
        return turned, replace(self.harmonic, frequency=self.crossing.order * omega)

    def speed_of(self, frequency: float) -> float:
        """The speed at which the order meets what has a frequency at the crossing's speed, both in rad/s."""
        square = (frequency / (self.crossing.order * self.crossing.omega)) ** 2
        met = square * (1 - self._turns) / max(1 - square * self._turns, 1e-6)
        return min(max(self.crossing.omega * math.sqrt(max(met, 0.0)), self.speeds[0]), self.speeds[1])

    @property
    def _turns(self) -> float:
        """Growth of the squared frequency over that of the squared speed, both relative."""
        return min(self.crossing.turns / self.crossing.order, 0.999)

    @property
    def force(self) -> float:
        """At the cavity along x, of the same effect on the leading mode [N]."""
        return driven.at_cavity(self.system, self.harmonic)

    @property
    def backbone(self) -> Backbone:
        """Free vibration at the crossing."""
        return _free(self.system)

    @property
    def stuck(self) -> float:
        """Frequency of the mode with the ball at rest in it [rad/s]."""
        shape = self._shape
        return self.crossing.order * self.crossing.omega / math.sqrt(1 + self.system.ball_mass * shape**2)

    @property
    def _shape(self) -> float:
        """Displacement of the cavity in the mode of modal mass 1 kg [1/kg^0.5]."""
        modes = self.system.modes
        if modes is None:
            return 1 / math.sqrt(self.system.modal_mass)
        own = (self.crossing.order * self.crossing.omega) ** 2
        near = min(modes, key=lambda mode: abs(mode.stiffness / mode.mass - own))
        return float(abs(near.shape[self.axis])) / math.sqrt(near.mass)

    def swinging(self) -> list[float]:
        """Speeds at which the structure and a ball that swings in a hollow floor are in resonance [rad/s].

        (K - nu² (M + m)) (w² - nu²) = beta nu⁴ m (1 - tau)², of the mode at the cavity along its axis, w the ball's own
        frequency; all but nu goes with the speed.
        """
        system, order = self.system, self.crossing.order
        if system.floor_radius is None:
            return []
        scan = np.linspace(*self.speeds, 2000)
        square = (scan / self.crossing.omega) ** 2
        nu = order * scan
        mass = self._shape**-2
        stiffness = mass * (order * self.crossing.omega) ** 2 * (1 + self._turns * (square - 1))
        pendulum = felt.pendulum(system, self.crossing.omega)
        own = 0.0 if pendulum is None else 2 * math.pi * pendulum.frequency_hz[self.axis]
        share = system.inertia_ratio * system.ball_mass * (1 - system.tilt_share[self.axis]) ** 2
        both = (stiffness - nu**2 * (mass + system.ball_mass)) * (own**2 * square - nu**2) - share * nu**4
        crossed = np.flatnonzero((both[:-1] < 0) != (both[1:] < 0))
        part = both[crossed] / (both[crossed] - both[crossed + 1])
        return [float(omega) for omega in scan[crossed] + part * (scan[crossed + 1] - scan[crossed])]

    def follow(self, speeds: Sequence[float], starts: Sequence[Start], most: int) -> Forced:
        """Steady states at some speeds, of at most so many cycles."""
        from damper import forced

        pairs = [self.at(omega) for omega in speeds]
        dampers, harmonics = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
        return forced(dampers, harmonics, starts, probe=self.axis, accuracy=_ACCURACY, max_cycles=most, threads=1)


def of(
    scene: Scene, effects: dict[str, Effect], point: SpeedPoint, crossing: Crossing, low: float, high: float
) -> Crossed | None:
    """The damper of a scene at a crossing, on the structure there.

    None where nothing drives the mode or the cavity does not move in it. `low`, `high`: speeds looked at [rad/s].
    """
    excitation = scene.excitation
    modes = driven.modes_of(point, driven.branch_of((point,), crossing))
    if excitation is None or (modes is not None and driven.idle(modes, excitation)):
        return None
    axis = 0 if modes is None else int(abs(modes[0].shape[1]) > abs(modes[0].shape[0]))
    leads = axis == 0 and (modes is None or felt.leading(point.cavity_modes, 0) is modes[0])
    kept = None if modes is None else driven.kept(point, modes)
    system = damper_stage.particle_damper(scene, effects, point, kept)
    harmonic = driven.harmonic_of(system, crossing, point, excitation, max(excitation.levels))
    return Crossed(crossing, system, axis, harmonic, leads, (low, high))


@dataclass(frozen=True)
class Linear:
    """The linear answers about a crossing, each at the speed where it is greatest.

    Attributes:
        without: amplitude without the ball [m]; resting: with the ball at rest [m]; grows: by how much the force may
            grow until the ball cannot stay at rest.
        least: amplitude below which no ball of this mass in this room can bring it [m].
    """

    without: float
    resting: float
    grows: float
    least: float


def linear(crossed: Crossed) -> Linear:
    """Linear answers, and the least amplitude that is conceivable.

    Whatever the ball does, the structure's answer at the frequency nu of the force is that with the ball at rest, and
    that to the ball's own way in the cavity, m nu² (1 - tau) s. No way of at most half a clearance d has a larger part
    at nu than the square wave's, (4 / pi) d: of the amplitude with the ball at rest, as much as a force of
    (4 / pi) m nu² d |1 - tau| at the cavity gives is all that it can take away.
    """
    from damper import Harmonic

    met = crossed.crossing.order * crossed.crossing.omega
    alone = _answers(crossed, *_about(crossed, met)).without
    omega, harmonics = _about(crossed, crossed.stuck)
    found = _answers(crossed, omega, harmonics)
    k = int(np.argmax(np.abs(found.linear)))
    resting, nu, axis = float(np.abs(found.linear[k])), harmonics[k].frequency, crossed.axis
    unit = Harmonic(nu, force=(1.0, 0.0) if axis == 0 else (0.0, 1.0))
    receptance = float(np.abs(_answers(crossed, omega, [unit]).linear[0]))
    system = crossed.system
    held = 4 / math.pi * system.ball_mass * nu**2 * system.half_gap[axis] * abs(1 - system.tilt_share[axis])
    return Linear(
        float(np.abs(alone).max()), resting, float(found.moves_from[k]), max(resting - receptance * held, 0.0)
    )


@lru_cache(maxsize=16)
def _free(system: ParticleDamper) -> Backbone:
    """Free vibration, measured once for a design that is followed again, or under other forces."""
    from damper import backbone

    return backbone(system, threads=1)


def _about(crossed: Crossed, resonance: float) -> tuple[float, list[Harmonic]]:
    """The speed of the structure [rad/s] and what drives it, at frequencies about a resonance.

    Where no speed looked at meets it, the one that comes nearest does.
    """
    low, high = crossed.speeds
    met = crossed.speed_of(resonance)
    if not low < met < high:
        return met, [crossed.at(met)[1]]
    wide = _WIDTHS * max(crossed.system.damping_ratio, 1e-4)
    frequencies = resonance * (1 + wide * np.linspace(-1.0, 1.0, _ABOUT))
    return crossed.crossing.omega, [replace(crossed.harmonic, frequency=float(nu)) for nu in frequencies]


def _answers(crossed: Crossed, omega: float, harmonics: list[Harmonic]) -> Motions:
    from damper.starts import Start, motions_of

    return motions_of(crossed.at(omega)[0], harmonics, (Start.UP,), crossed.axis, 0, 256)
