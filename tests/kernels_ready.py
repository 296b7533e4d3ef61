"""Compile the damper's kernels once, before several processes that would all do it: `python -m tests.kernels_ready`.

With a name only that part: `free` or `forced`.
"""

import sys

from damper import Harmonic, damping_curve, forced, ringdown, ringdowns, sample, stepped_ringdown
from tests.benchmarks.flights_speed import LEVEL


def free() -> None:
    """Ring-downs, sweeps, and the paper's fixed steps."""
    sample(ringdown(LEVEL, (1e-3, 0.0), 3, keep_events=True), [1e-4])
    ringdowns(LEVEL, [(1e-3, 0.0)], 3)
    damping_curve(LEVEL)
    stepped_ringdown(LEVEL, (1e-3, 0.0), 3)


def kept_up() -> None:
    """What a force keeps up."""
    forced(LEVEL, [Harmonic(LEVEL.stuck_frequency, (5.0, 0.0))])


PARTS = {"free": free, "forced": kept_up}


if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
