"""Random balls that nothing presses onto the floor, followed for long:  python -m tests.damper.afloat [how many] [seed]

Without a threshold a ball leaves its wall as soon as the structure draws it off, however briefly and slowly; what hits
take is then all that the energy can lose.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from damper import Mode, ParticleDamper, RingDown, ringdown

CYCLES = 500
BOOKS = 1e-10
"""Largest share of the energy that the books may leave unexplained."""
INSIDE = 1e-12
"""Largest overlap of ball and wall, over the gap."""


def scene(seed: int) -> tuple[ParticleDamper, tuple[float, ...]]:
    """A damper at rest, of one mode along each axis or of several, and their amplitudes at release."""
    rng = np.random.default_rng(seed)
    modes = None
    if rng.random() < 0.7:
        along = [(1.0, 0.0), (rng.uniform(-1, 1), rng.choice([0.0, 1e-5, rng.uniform(-1, 1)])), (0.0, 1.0)]
        shapes = [*along, *((rng.normal(), 0.0) for _ in range(rng.integers(0, 2)))]
        modes = tuple(Mode(1.0, 10 ** rng.uniform(-0.2, 2.0), shape) for shape in shapes)
    damper = ParticleDamper(
        modal_mass=1.0,
        stiffness=(1.0, 10 ** rng.uniform(-0.3, 2)),
        ball_mass=10 ** rng.uniform(-4, -0.5),
        ball_radius=1.0,
        cavity=tuple(2 + 2 * 10 ** rng.uniform(-2, 0.5, 2)),
        centrifugal_acceleration=0.0,
        restitution=rng.uniform(0.3, 0.99),
        friction=rng.choice([0.0, rng.uniform(0.0, 0.6)]),
        modes=modes,
    )
    return damper, (1.0, *rng.normal(size=len(modes or (0, 0)) - 1) * rng.choice([0.0, 0.1, 1.0]))


def follow(damper: ParticleDamper, amplitudes: tuple[float, ...], cycles: float = CYCLES) -> RingDown:
    if damper.modes is None:
        return ringdown(damper, amplitudes, cycles, keep_events=True, max_events=100_000)
    return ringdown(damper, (0.0, 0.0), cycles, amplitudes=amplitudes, keep_events=True, max_events=100_000)


def fault(motion: RingDown) -> float:
    """By how much the books or the walls are overstepped: 1 is as far as is allowed."""
    missing = abs(motion.energy.residual) / motion.energy.initial / BOOKS
    place = [np.abs(motion.rows["s"][motion.rows["axis"] == i]).max() for i in range(2)]
    return max(missing, *((s / gap - 1.0) / INSIDE for s, gap in zip(place, motion.damper.half_gap, strict=True)))


def soak(dampers: int, seed: int = 0) -> tuple[int, list[int]]:
    """How many hits there were, and the seeds of the dampers in which something was amiss."""
    hits, bad = 0, []
    for k in range(seed, seed + dampers):
        motion = follow(*scene(k))
        hits += motion.impacts
        if not fault(motion) <= 1.0:
            bad.append(k)
    return hits, bad


def main() -> None:
    asked, seed = [int(float(given)) for given in (*sys.argv[1:], *("1000", "0")[len(sys.argv) - 1 :])]
    begin = time.perf_counter()
    hits, bad = soak(asked, seed)
    print(f"{asked} dampers, {hits} hits, amiss with seeds {bad}, {time.perf_counter() - begin:.0f} s")
    sys.exit(len(bad) > 0)


if __name__ == "__main__":
    main()
