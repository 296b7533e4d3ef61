"""Designs drawn at random against the best that the search finds: is any better?

    python -m tests.benchmarks.random_designs [COUNT [SCENE [BEST]]]

COUNT points of a Sobol' sequence with a seed of its own are scored quickly, to about a percent; those that come within
3 % of the best, or above it, again with the figures at their full accuracy. BEST: a design.json that the search left
before; without it, it searches first.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np

from workflows.scene.file import load
from workflows.studies.design import search, space, study
from workflows.studies.sweep import code, crew

NEAR = 0.97
AT_ONCE = 64


def main(count: int = 10_000, scene: str = "design", best: str = "") -> int:
    """Print how many of COUNT designs are better; return that number."""
    free = space.of(load(scene))
    with crew.local() as workers:
        known = _known(best) if best else study.design(scene).found.scored.value
        print(f"the search: {100 * known:.5f} %", flush=True)
        rows = search.sobol(len(free.axes), 1 << (count - 1).bit_length(), seed=12345)[:count]
        began, values, near = time.perf_counter(), [], []
        for begin in range(0, count, AT_ONCE):
            part = rows[begin : begin + AT_ONCE]
            found = study.scored(workers, code.digest(), free, part, quick=True)
            values += [each.value for each in found]
            near += [row for row, each in zip(part, found, strict=True) if each.value > NEAR * known]
            if begin % (16 * AT_ONCE) == 0:
                print(f"{len(values)} designs, best {100 * max(values):.5f} %", flush=True)
        again = study.scored(workers, code.digest(), free, np.array(near), quick=False) if near else []
    better = [each.value for each in again if each.value > known]
    works = sum(value > 0 for value in values)
    print(f"{count} designs in {time.perf_counter() - began:.0f} s: {works} work, at best {100 * max(values):.5f} %;")
    print(f"{len(near)} within 3 % of the search's best, {len(better)} better: {[f'{100 * v:.5f} %' for v in better]}")
    return len(better)


def _known(path: str) -> float:
    value: float = json.loads(Path(path).read_text(encoding="utf-8"))["value"]
    return value


if __name__ == "__main__":
    arguments = sys.argv[1:]
    sys.exit(min(main(*map(int, arguments[:1]), *arguments[1:]), 1))
