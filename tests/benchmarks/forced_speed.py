"""Speed of steady states: a cycle of the motion, and a whole crossing without and with the ball.

    python -m tests.benchmarks.forced_speed

Noise: a cycle is told by the median of several runs, with the least and the most. Nothing here passes or fails.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

from damper import Harmonic, ParticleDamper, Regime, forced, ringdown
from tests.damper.scenes import paper

ZETA, CYCLES = 2e-3, 2000


def scene() -> ParticleDamper:
    """The paper's damper at 21,932 g on a structure of 1 kg and 269.5 Hz, its floor tilting."""
    return paper(damping_ratio=ZETA, floor_tilt=(6.8, 6.8))


def main() -> None:
    """Print the table."""
    damper = scene()
    omega = damper.stuck_frequency
    still = damper.rolling_threshold / omega**2 / (1 - damper.tilt_share[0])
    force = 1.5 * still * 2 * ZETA * damper.stiffness[0]
    harmonic = Harmonic(omega, (force, 0.0))
    state = forced(damper, [harmonic])
    print(f"steady: {state.regime[0, 0]}, {state.hits_per_cycle[0, 0]:g} hits a cycle, {state.cycles[0, 0]} cycles")
    amplitude = float(state.mean[0, 0])
    taken = []
    for _ in range(5):
        begin = time.perf_counter()
        run = ringdown(damper, (0.0, 0.0), CYCLES, velocity=(-omega * amplitude, 0.0), harmonic=harmonic)
        taken.append((time.perf_counter() - begin) / CYCLES)
    each = f"{1e6 * statistics.median(taken):.1f} us ({1e6 * min(taken):.1f} to {1e6 * max(taken):.1f})"
    print(f"a cycle of {run.events / CYCLES:.1f} events: {each}")

    speeds = omega * np.linspace(0.985, 1.015, 60)
    dampers, harmonics = [], []
    for nu in speeds:  # a damper of its own at each speed, as on a plate
        here = scene()
        dampers += [here] * 5
        harmonics += [Harmonic(float(nu), (force * level, 0.0)) for level in (0.3, 0.7, 1.5, 3.0, 6.0)]
    begin = time.perf_counter()
    crossing = forced(dampers, harmonics)
    seconds = time.perf_counter() - begin
    kinds = {str(kind): int((crossing.regime == kind).sum()) for kind in Regime}
    print(f"60 speeds x 5 forces x 3 starts: {seconds:.1f} s; {crossing.cycles.sum():.3g} cycles; {kinds}")


if __name__ == "__main__":
    main()
