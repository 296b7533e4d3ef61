"""What a short pulse of force leaves in a body: the energy that a hit feeds into all of its modes together.

In a mode of modal mass 1, circular frequency w and motion phi at the place, along the force, a pulse of impulse J that
lasts for tau leaves (S phi J)² / 2, S being the spectrum of the pulse at w over that at 0: 1 in modes far slower than
the pulse, which take it as an instantaneous hit, and nothing in those far faster. `spectrum` is that of half a sine
wave, about which the force between elastic bodies in Hertz's contact grows and falls (Johnson, Contact Mechanics, 1985,
section 11.4). Over all modes it is simulated, mesh and all, without looking for one of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from fem.assembly import Body
    from fem.linalg import Array

_STEPS = 24
"""Steps of the shortest pulse: the energy that it leaves is then known to about 1 %."""


def spectrum(rates: Array, duration: float) -> Array:
    """Spectrum of a pulse of half a sine wave over that at zero, in size, (k,).

    Args:
        rates: circular frequencies (k,) [rad/s].
        duration: of the pulse [s].
    """
    x = np.asarray(rates) * duration / np.pi
    return np.asarray(np.abs(np.pi / 4 * (np.sinc((x - 1) / 2) + np.sinc((x + 1) / 2))))


def inverse_mass(body: Body, force: Array, durations: Array) -> Array:
    """Twice the energy that pulses of force leave in a body, over the square of their impulse: 1/mass (k,) [1/kg].

    That of a rigid body that is free to move is the inverse of its mass. The force is half a sine wave over time; its
    response by Newmark's method of average acceleration, which keeps energy.

    Args:
        body: its stiffness is that at rest, which differs from that under load in slow modes alone.
        force: a unit force over its unknowns (n,).
        durations: of the pulses (k,) [s].
    """
    durations = np.asarray(durations, dtype=float)
    step = float(durations.min()) / _STEPS
    stiffness, mass = body.stiffness, body.mass
    factor = body.factorise((mass + 0.25 * step**2 * stiffness).tocsc())
    return np.array([_left(body, force, factor.solve, step, round(each / step)) for each in durations])


def _left(body: Body, force: Array, solve: Callable[[Array], Array], step: float, steps: int) -> float:
    """The same of a pulse of so many steps [s], by what solves the mass and a quarter of its stiffness."""
    pushed = np.sin(np.pi * np.arange(1, steps + 1) / steps)
    displacement, velocity, acceleration = np.zeros((3, force.size))
    for push in pushed:
        displacement = displacement + step * velocity + 0.25 * step**2 * acceleration
        velocity = velocity + 0.5 * step * acceleration
        acceleration = solve(push * force - body.stiffness @ displacement)
        displacement = displacement + 0.25 * step**2 * acceleration
        velocity = velocity + 0.5 * step * acceleration
    energy = velocity @ (body.mass @ velocity) + displacement @ (body.stiffness @ displacement)
    return float(energy) / (step * float(pushed.sum())) ** 2
