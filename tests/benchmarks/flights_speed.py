"""Processor time of an event, by what a flight has: `python -m tests.benchmarks.flights_speed [TURNS]`.

The paper's damper at 21932 g rings down from 64 releases: on a level floor, on one that tilts, in a hollow one, driven,
and under further structural modes. One thread, turn by turn, the median of all turns.
"""

import sys
import time
from dataclasses import replace

import numpy as np

from damper import Harmonic, Mode, ParticleDamper, ringdowns
from tests.damper.scenes import paper

RELEASES = 64
LEVEL = paper(damping_ratio=1e-3)


def with_modes(count: int) -> ParticleDamper:
    """Modes along x and y, and further ones along x, six times as fast each and hardly fed."""
    stiffness = LEVEL.stiffness[0]
    modes = [Mode(1.0, stiffness, (1.0, 0.0), (6.9, 0.0)), Mode(1.0, stiffness, (0.0, 1.0), (0.0, 6.9))]
    modes += [Mode(1.0, stiffness * (1.0 + 0.3 * k) ** 2, (0.3, 0.0), (2.0, 0.0)) for k in range(1, count - 1)]
    return replace(LEVEL, modes=tuple(modes))


CASES = {
    "level": (LEVEL, None),
    "tilt": (replace(LEVEL, floor_tilt=(6.9, 6.9)), None),
    "hollow": (replace(LEVEL, floor_radius=(16e-3, 16e-3)), None),
    "tilt and hollow": (replace(LEVEL, floor_tilt=(6.9, 6.9), floor_radius=(16e-3, 16e-3)), None),
    "driven": (LEVEL, Harmonic(LEVEL.stuck_frequency, (3.0, 0.0))),
    "2 modes": (with_modes(2), None),
    "3 modes": (with_modes(3), None),
    "4 modes": (with_modes(4), None),
    "5 modes": (with_modes(5), None),
}


def main(turns: int = 9) -> None:
    """Print a line a case."""
    spent: dict[str, list[float]] = {name: [] for name in CASES}
    release = np.column_stack([np.linspace(0.04, 0.05, RELEASES), np.linspace(0.01, 0.015, RELEASES)])
    for turn in range(turns + 1):
        for name, (damper, harmonic) in CASES.items():
            began = time.process_time()
            found = ringdowns(damper, release, 60, harmonic=harmonic, threads=1)
            if turn:
                spent[name].append((time.process_time() - began) / found.events.sum())
    each = {name: 1e9 * float(np.median(times)) for name, times in spent.items()}
    for name, nanoseconds in each.items():
        print(f"{name:16s} {nanoseconds:7.0f} ns an event, {nanoseconds / each['level']:5.2f} x level")
    print("each further mode:", ", ".join(f"{each[f'{k} modes'] / each[f'{k - 1} modes'] - 1:+.0%}" for k in (3, 4, 5)))


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
