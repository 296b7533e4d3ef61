"""The paper's own algorithm: fixed time steps, and events noticed only at the end of the step in which they fell.

Section II.B of the paper takes 40 steps a vibration cycle, the state at the end of one being the start of the next. On
a step each axis moves exactly, by a matrix exponential, with the regime and the sign of friction that held at the
step's start, the best that such a scheme can do. At its end Table I is applied as printed, but that a ball outside a
wall must also move outwards to hit it, since otherwise eq. (10) would drive a ball that is on its way back out again;
the ball is then put on the wall. Where the relative velocity has changed sign, the ball sticks if the structure's
acceleration is below the rolling threshold. What the paper leaves open is thus settled in its favour.
`damper.ringdown` has none of these errors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from damper.model import pair, whole
from damper.motion import flights, prepare
from damper.state import STUCK

if TYPE_CHECKING:
    from damper.equations import Systems
    from damper.model import Floats, ParticleDamper


@dataclass(frozen=True, eq=False)
class SteppedRingDown:
    """What the fixed-step algorithm gives.

    Attributes:
        time: shape (n + 1,) [s].
        velocity: of the structure, shape (n + 1, 2) [m/s].
        impacts: number of wall hits noticed.
        initial, final: energy of structure and ball [J]; structure: what the structure's own dashpot took of it [J].
        peak_velocities: largest sampled speed in each vibration cycle from the release, shape (cycles,) [m/s].
    """

    time: Floats
    velocity: Floats
    impacts: int
    initial: float
    final: float
    structure: float
    peak_velocities: Floats

    @property
    def sdc(self) -> Floats:
        """Specific damping capacity from each cycle to the next, shape (cycles - 1,) [-]."""
        v = self.peak_velocities
        return np.asarray(1.0 - (v[1:] / v[:-1]) ** 2)


def stepped_ringdown(
    damper: ParticleDamper,
    release: tuple[float, float],
    cycles: int,
    steps_per_cycle: int = 40,
    *,
    friction_opposes_structure: bool = False,
) -> SteppedRingDown:
    """Release from rest, the ball at the cavity's centre, and step through whole cycles of 2 pi / omega_1.

    Args:
        damper: what is simulated; slip on the floor (`floor_friction`) is not part of the paper's algorithm.
        release: the structure's displacements along x and y at time 0 [m].
        cycles: how many.
        steps_per_cycle: 40 in the paper.
        friction_opposes_structure: take the sign of rolling friction from the structure's velocity, not from the
            relative one: not what the paper prints, but what a slip in its program would do.

    Raises:
        ValueError: no step or cycle, a release that is not two finite numbers, or a damper with slip, a dent, a floor
            that is not level, or several modes.
    """
    from damper.fixed_step_kernel import march

    if damper.floor_friction is not None or damper.break_away > 0:
        name, what = ("break_away", "dent") if damper.floor_friction is None else ("floor_friction", "slip")
        raise ValueError(f"{name}: the paper's algorithm has no {what}")
    if damper.modes is not None or not damper.level:
        raise ValueError("the paper's algorithm supports a level floor only, moved by one mode along each axis")
    cycles, steps_per_cycle = whole("cycles", cycles), whole("steps_per_cycle", steps_per_cycle)
    rows = damper.parameters
    rest = (0.0, 0.0)
    one = prepare(rows, np.array([[pair("release", release), rest, rest, rest, rest]]), float(cycles), math.inf)
    step = 2 * math.pi / damper.stuck_frequency / steps_per_cycle
    velocity = np.zeros((cycles * steps_per_cycle + 1, 2))
    flying = flights(damper, rows, one)
    run = flying.runs[0]
    steps, losses = propagators(flying.systems, step)
    impacts = march(run, flying.systems.flows[0], steps, losses, friction_opposes_structure, velocity)
    speed = np.hypot(velocity[1:, 0], velocity[1:, 1])
    return SteppedRingDown(
        time=np.arange(len(velocity), dtype=np.float64) * step,
        velocity=velocity,
        impacts=int(impacts),
        **{name: float(run["books"][name]) for name in ("initial", "final", "structure")},
        peak_velocities=speed.reshape(cycles, steps_per_cycle).max(axis=1),
    )


def propagators(systems: Systems, step: float) -> tuple[Floats, Floats]:
    """What a step does to u, s, their rates and the resistance along each axis, stuck and rolling.

    Returns:
        Matrices onto u, s and their rates, shape (2, 2, 4, 5), and of the form that is the work of the structure's
        dashpot, shape (2, 2, 5, 5) (C. F. Van Loan, IEEE Trans. Autom. Control 23 (1978) 395).
    """
    from scipy.linalg import expm

    of, scale = systems.equations, np.array([1.0, 1.0, step, step, step**2])
    steps, losses = np.zeros((2, 2, 4, 5)), np.zeros((2, 2, 5, 5))
    for axis, regime in np.ndindex(2, 2):
        group = [axis, 2 + axis]
        here = np.ix_(group, group)
        rates, square = np.zeros((5, 5)), np.zeros((5, 5))
        rates[:2, 2:4], square[2, 2] = np.eye(2), 1.0
        rates[2:4, :2], rates[2:4, 2:4] = -of.stiffness[0, regime][here] * step**2, -of.damping[0, regime][here] * step
        rates[2:4, 4] = of.resistance[0, regime, axis, group]
        both = expm(np.block([[-rates.T, square], [np.zeros((5, 5)), rates]]))
        after = both[5:, 5:]
        steps[axis, regime] = (after * scale / scale[:, None])[:4]
        dashpot = systems.constants["dashpot"][0, 0 if regime == STUCK else 1, systems.constants["low"][0, axis]]
        losses[axis, regime] = dashpot / step * (after.T @ both[:5, 5:]) * scale * scale[:, None]
    return steps, losses
