"""Speed of the damper engine: events a second, against `solve_ivp`, and on several cores.

    python -m tests.benchmarks.damper_speed

Noise: machines are shared, so each figure is a median of several runs after a warm-up, with the least and the most
beside it; ratios are taken between runs that follow each other in one process. Nothing here passes or fails.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable

import numpy as np

from damper import ParticleDamper, ringdown, ringdowns
from tests.damper.reference import Reference
from tests.damper.scenes import paper
from workflows.studies.work_precision.study import by_ivp

RELEASE = (20e-3, 5e-3)
CYCLES = 200


def scene() -> ParticleDamper:
    """The paper's damper at 21,932 g on a structure of 1 kg and 269.5 Hz."""
    return paper()


def timed(work: Callable[[], object], repeats: int) -> tuple[float, float, float]:
    """Median, least and most of the seconds that some work takes."""
    work()
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds), min(seconds), max(seconds)


def main() -> None:
    """Print the table."""
    damper = scene()
    long = ringdown(damper, RELEASE, 5000)
    mid, low, high = timed(lambda: ringdown(damper, RELEASE, 5000), 7)
    rates = [long.events / seconds for seconds in (mid, high, low)]
    print(f"one core, 5000 cycles    {rates[0]:12.3g} events/s   ({rates[1]:.3g} to {rates[2]:.3g})")

    angles = np.linspace(0.0, 6.0, 1_000_000)
    floor = timed(lambda: np.sin(angles), 5)[0] / len(angles) * 2
    event = 1e9 * mid / long.events
    print(f"floor: sine and cosine   {1e9 * floor:12.3g} ns; an event costs {event:.3g} ns")

    dense = Reference(damper, RELEASE, CYCLES)
    exact = dense.final / dense.initial
    ours = timed(lambda: ringdown(damper, RELEASE, CYCLES), 50)
    peer = timed(lambda: by_ivp(damper, RELEASE, CYCLES, "DOP853", 1e-9), 3)
    run, other = ringdown(damper, RELEASE, CYCLES), by_ivp(damper, RELEASE, CYCLES, "DOP853", 1e-9)
    error, other_error = abs(run.energy.final / run.energy.initial - exact), abs(other.final / other.initial - exact)
    print(f"{CYCLES} cycles, exact events {ours[0]:12.3g} s   error in energy {error:.1e}")
    print(f"{CYCLES} cycles, DOP853       {peer[0]:12.3g} s   error in energy {other_error:.1e}")
    print(f"ratio                    {peer[0] / ours[0]:12.3g}   ({peer[1] / ours[2]:.3g} to {peer[2] / ours[1]:.3g})")

    rng = np.random.default_rng(0)
    n = 100_000
    release = np.stack([rng.uniform(10e-3, 30e-3, n), rng.uniform(2e-3, 10e-3, n)], axis=1)
    restitution = rng.uniform(0.2, 0.8, n)
    ratios = []
    for _ in range(3):
        seconds = []
        for threads in (1, os.cpu_count() or 1):
            begin = time.perf_counter()
            batch = ringdowns(damper, release, 20, threads=threads, restitution=restitution)
            seconds.append(time.perf_counter() - begin)
        ratios.append(seconds[0] / seconds[1])
    print(
        f"batch of {n} x 20 cycles {batch.events.sum() / seconds[1]:12.3g} events/s on {os.cpu_count()} cores;"
        f" {statistics.median(ratios):.2f} times one core ({min(ratios):.2f} to {max(ratios):.2f})"
    )


if __name__ == "__main__":
    main()
