"""Compile the damper's kernels once, before several processes that would all do it: `python -m tests.kernels_ready`.

With the name of an engine only what it needs: `level` or `linear`.
"""

from __future__ import annotations

import sys
from dataclasses import replace

from damper import Harmonic, ParticleDamper, backbone, forced, ringdown, ringdowns, sample, stepped_ringdown, working
from tests.benchmarks.flights_speed import LEVEL


def moved(damper: ParticleDamper) -> None:
    """Move a ball in every way that has kernels of its own and needs no force."""
    sample(ringdown(damper, (1e-3, 0.0), 3, keep_events=True), [1e-4])
    ringdowns(damper, [(1e-3, 0.0)], 3)
    working(damper)


def on_level_floors() -> None:
    """The paper's engine, and its fixed steps."""
    moved(LEVEL)
    stepped_ringdown(LEVEL, (1e-3, 0.0), 3)


def on_any_floor() -> None:
    """The engine of linear flights, and what is made of a motion that a force keeps up, which calls it."""
    moved(replace(LEVEL, floor_tilt=(5.0, 5.0)))
    forced(LEVEL, [Harmonic(LEVEL.stuck_frequency, (5.0, 0.0))])
    backbone(LEVEL)


ENGINES = {"level": on_level_floors, "linear": on_any_floor}


if __name__ == "__main__":
    for name in sys.argv[1:] or ENGINES:
        ENGINES[name]()
