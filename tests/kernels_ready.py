"""Compile the damper's kernels once, before several processes that would all do it: `python -m tests.kernels_ready`."""

from damper import Harmonic, damping_curve, forced, ringdown, ringdowns, sample, stepped_ringdown
from tests.benchmarks.flights_speed import LEVEL


def main() -> None:
    """Ring-downs, sweeps, the paper's fixed steps, and what a force keeps up."""
    sample(ringdown(LEVEL, (1e-3, 0.0), 3, keep_events=True), [1e-4])
    ringdowns(LEVEL, [(1e-3, 0.0)], 3)
    damping_curve(LEVEL)
    stepped_ringdown(LEVEL, (1e-3, 0.0), 3)
    forced(LEVEL, [Harmonic(LEVEL.stuck_frequency, (5.0, 0.0))])


if __name__ == "__main__":
    main()
