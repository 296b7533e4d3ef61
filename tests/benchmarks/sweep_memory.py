"""Memory of the process that gathers a sweep, over the number of its points.

    python -m tests.benchmarks.sweep_memory [POINTS ...]

The shards are there already, filled with numbers drawn at random, so that what is measured is the process that reads
and writes: peak resident memory and seconds, each in a process of its own. What a worker takes does not depend on the
number of points, since it has one shard at a time.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from workflows.progress import Stages
from workflows.studies.sweep import evaluate, executor, store, study
from workflows.studies.sweep.evaluate import Block


def main(sizes: list[int]) -> None:
    """Print a line for each number of points."""
    for points in sizes or [10_000, 100_000]:
        done = subprocess.run(
            [sys.executable, "-m", __spec__.name, "one", str(points)], check=True, text=True, stdout=-1
        )
        print(done.stdout.strip())


def one(points: int) -> None:
    """Gather a study of so many points."""
    import resource

    count = round(points / 10)
    asked = study.asked(
        "structure",
        {"damper.mass_ratio": f"0.001:0.01:{count}", "rotor.speeds": "1000 rpm:9000 rpm:10"},
        quick=True,
    )
    draw = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as place:
        out = Path(place) / "out"
        with store.opened(out, asked.key, asked.identity) as opened:
            for number, (begin, end) in enumerate(asked.ranges):
                rows = evaluate.empty(end - begin)
                for name in evaluate.NUMBERS:
                    rows[name] = draw.random(end - begin)
                opened.write(number, Block(begin, rows, ()))
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        began = time.perf_counter()
        with ThreadPoolExecutor(1) as idle:
            study.complete(asked, out, executor.given(idle), Stages(visible=False))
        seconds = time.perf_counter() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    said = f"{before / 1e3:.0f} MB before, peak {peak / 1e3:.0f} MB, {seconds:.1f} s"
    print(f"{points} points, {len(asked.ranges)} shards: {said}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["one"]:
        one(int(sys.argv[2]))
    else:
        main(list(map(int, sys.argv[1:])))
