"""Compile the damper's kernels once, before several processes that would all do it: `python -m tests.kernels_ready`."""

from __future__ import annotations

from dataclasses import replace

from damper import Harmonic, backbone, forced, ringdown, ringdowns, sample, stepped_ringdown, working
from tests.benchmarks.flights_speed import level


def main() -> None:
    """Move a ball in every way that has kernels of its own."""
    paper = level()
    force = Harmonic(paper.stuck_frequency, (5.0, 0.0))
    for damper in (paper, replace(paper, floor_tilt=(5.0, 5.0))):
        sample(ringdown(damper, (1e-3, 0.0), 3, keep_events=True), [1e-4])
        ringdowns(damper, [(1e-3, 0.0)], 3)
        working(damper)
    forced(paper, [force])
    backbone(paper)
    stepped_ringdown(paper, (1e-3, 0.0), 3)


if __name__ == "__main__":
    main()
