"""Cycles of ring-downs a second of processor, over those of SciPy's: `python -m tests.benchmarks.beside_solve_ivp`.

The paper's damper at 21932 g on a level floor. Releases lie evenly in the logarithm from 3 to 20 mm along x, a quarter
of that along y, each followed for its first 20 cycles of vibration: 1024 of them in one call of `ringdowns`, on one
thread, and every 64th by `solve_ivp` (DOP853, rtol 1e-9) with the same laws of impact, sticking and rolling. In turns,
medians of both; hits are compared, since what is not the same motion takes not the same time.
"""

import sys
import time

import numpy as np

from damper import ringdowns
from tests.damper.scenes import paper
from workflows.studies.work_precision.integration import Integration

CYCLES, RELEASES, EVERY = 20, 1024, 64


def main(turns: int = 5) -> None:
    """Print both, and their ratio."""
    damper, size = paper(damping_ratio=1e-3), np.geomspace(3e-3, 20e-3, RELEASES)
    release = np.column_stack([size, size / 4])
    few = release[EVERY // 2 :: EVERY]
    ringdowns(damper, release[:1], 1, threads=1)
    spent: list[tuple[float, float]] = []
    for _ in range(turns):
        begun = time.process_time()
        batch = ringdowns(damper, release, CYCLES, threads=1)
        middle = time.process_time()
        peers = [Integration(damper, (x, y), CYCLES, "DOP853", 1e-9) for x, y in few.tolist()]
        spent.append((middle - begun, time.process_time() - middle))
    ours, theirs = np.median(spent, axis=0) / (RELEASES * CYCLES, len(few) * CYCLES)
    hits = batch.impacts[EVERY // 2 :: EVERY].sum(), sum(peer.impacts for peer in peers)
    print(f"a cycle: {1e6 * ours:.2f} µs, solve_ivp {1e6 * theirs:.0f} µs: {theirs / ours:.0f} times")
    print(f"hits in {len(few)} ring-downs of {CYCLES} cycles: {hits[0]} and {hits[1]}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
