"""Designs drawn at random against the best that the search finds: is any better?

    python -m tests.benchmarks.random_designs [COUNT [SCENE [BEST]]]

COUNT points of a Sobol' sequence with a seed of its own are scored quickly, to about a percent; those that come within
3 % of the best, or above it, again with the figures at their full accuracy. BEST: a design.json that the search left
before; without it, it searches first. SCENE: by the damping, or by the amplitude at the crossings ([excitation]).
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

from workflows.scene.load import load
from workflows.studies.design import space as spaces
from workflows.studies.design import study
from workflows.studies.sweep import executor
from workflows.studies.sweep.plan import sobol

NEAR = 0.97
AT_ONCE = 64


def main(count: int = 10_000, scene: str = "design", best: str = "") -> int:
    """Print how many of COUNT designs are better; return that number."""
    free = spaces.design_space(load(scene))
    sign = 1 if free.design.amplitude is not None else -1
    unit = 100.0 if sign > 0 else 1e3
    with executor.local() as workers:
        known = _known(best) if best else study.design(scene).optimum.evaluation.value
        print(f"the search: {unit * known:.5f}", flush=True)
        rows = sobol(len(free.axes), 1 << (count - 1).bit_length(), seed=12345)[:count]
        began, worth, near = time.perf_counter(), [], []
        for begin in range(0, count, AT_ONCE):
            part = rows[begin : begin + AT_ONCE]
            found = study.evaluate_on_workers(workers, free, part, quick=True)
            worth += [each for each in found if each.works]
            near += [
                row for row, each in zip(part, found, strict=True) if each.works and _near(each.value, known, sign)
            ]
            if begin % (16 * AT_ONCE) == 0:
                print(f"{begin + len(part)} designs, {len(worth)} work", flush=True)
        again = study.evaluate_on_workers(workers, free, np.array(near), quick=False) if near else []
    better = [each.value for each in again if each.works and sign * (each.value - known) > 0]
    most = max((sign * each.value for each in worth), default=0.0)
    took = time.perf_counter() - began
    print(f"{count} designs in {took:.0f} s: {len(worth)} work, at best {unit * sign * most:.5f};")
    print(f"{len(near)} within 3 % of the search's best, {len(better)} better: {[f'{unit * v:.5f}' for v in better]}")
    return len(better)


def _near(value: float, known: float, sign: int) -> bool:
    """Whether a value is better than the best known, or hardly worse."""
    return value > NEAR * known if sign > 0 else NEAR * value < known


def _known(path: str) -> float:
    value: float = json.loads(Path(path).read_text(encoding="utf-8"))["value"]
    return value


if __name__ == "__main__":
    arguments = sys.argv[1:]
    sys.exit(min(main(*map(int, arguments[:1]), *arguments[1:]), 1))
