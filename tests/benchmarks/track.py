"""How long the main things take, medians: `python -m tests.benchmarks.track`. Nothing passes or fails by it.

`python -m tests.benchmarks.track --beside TREE` runs the same tasks in turns with those of another tree of the project,
a work tree of an earlier commit, say: one process each, a task of one after that of the other, so that what slows the
machine slows both. It prints the medians and the median of the ratios, and between which half of these lie.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import spindamp
from damper import Harmonic, forced, ringdown, ringdowns
from fem import Effects, Material, Plate, Rectangle, Rotor, assemble, campbell, solve_modes
from tests.damper import scenes
from workflows.io.serialise import dumps

RUNS = 5
TURNS = 15

DIAGRAM: dict[str, Any] = {
    "plate": {"length": 0.2, "width": 0.08, "thickness": 0.01},
    "material": {"name": "steel"},
    "rotor": {"speeds": {"start": "0 rpm", "stop": "17500 rpm", "count": 2000}},
    "accuracy": {"frequency": 0.01},
}


def tasks() -> dict[str, Callable[[], Any]]:
    """By name; what each needs is made beforehand."""
    plate = Plate(Rectangle(0.2, 0.08).mesh(4), 0.01, Material(182.6e9, 0.3, 7850.0))
    operators, bent = (assemble(plate, Rotor(0.1, 0.5), Effects(large_deflection=large)) for large in (False, True))
    damper = scenes.paper()
    diagram, paper = spindamp.campbell(DIAGRAM), spindamp.run("paper")
    releases = np.column_stack([np.linspace(1e-3, 20e-3, 200), np.full(200, 5e-3)])
    driven = scenes.paper(damping_ratio=2e-3, floor_tilt=(6.8, 6.8))
    speeds = driven.stuck_frequency * np.linspace(0.985, 1.015, 60)
    crossing = [Harmonic(float(nu), (size, 0.0)) for nu in speeds for size in (83.0, 193.0, 414.0, 828.0, 1655.0)]
    vary = {"damper.mass_ratio": "log:0.001:0.05:3", "damper.clearance": "log:0.1 mm:4 mm:4"}
    sweep = partial(spindamp.sweep, "paper", executor=ThreadPoolExecutor(1))
    return {
        "matrices": lambda: assemble(plate, Rotor(0.1, 0.5), Effects()),
        "six modes at one speed": lambda: solve_modes(operators, 1000.0),
        "six modes, large deflection": lambda: solve_modes(bent, 300.0),
        "six modes at 1000 speeds": lambda: campbell(operators, np.linspace(0.0, 1800.0, 1000)),
        "a ring-down of 100 cycles": lambda: ringdown(damper, (20e-3, 5e-3), 100),
        "200 ring-downs of 20 cycles": lambda: ringdowns(damper, releases, 20),
        "a crossing of 60 speeds under 5 forces": lambda: forced([driven] * len(crossing), crossing),
        "the JSON of 2000 speeds": lambda: dumps(diagram),
        "the data set of 2000 speeds": lambda: spindamp.dataset(diagram),
        "the JSON of a run of the paper": lambda: dumps(paper),
        "the data set of a run of the paper": lambda: spindamp.dataset(paper),
        "a run of the paper": lambda: spindamp.run("paper"),
        "a quick sweep of 84 points": lambda: sweep(vary, quick=True),
    }


def taken(work: Callable[[], Any]) -> float:
    """Seconds, the median after a warm-up."""
    work()
    found = []
    for _ in range(RUNS):
        began = time.perf_counter()
        work()
        found.append(time.perf_counter() - began)
    return median(found)


def main() -> None:
    """This tree by itself."""
    for name, work in tasks().items():
        print(f"{name}: {1e3 * taken(work):.1f} ms", flush=True)


def answer() -> None:
    """Do tasks by their names from standard input, and say the seconds of each."""
    known = tasks()
    print(json.dumps(list(known)), flush=True)
    for line in sys.stdin:
        began = time.perf_counter()
        known[line.strip()]()
        print(time.perf_counter() - began, flush=True)


def opened(tree: Path) -> subprocess.Popen[str]:
    """A process that does the tasks, of this file, with the code of a tree."""
    command = [sys.executable, __file__, "--answer"]
    environment = os.environ | {"PYTHONPATH": str(tree.resolve())}
    return subprocess.Popen(
        command, cwd=tree, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def asked(process: subprocess.Popen[str], task: str) -> float:
    """Seconds of one task."""
    process.stdin.write(task + "\n")
    process.stdin.flush()
    return float(process.stdout.readline())


def beside(tree: Path) -> None:
    """This tree and another in turns."""
    with opened(Path()) as mine, opened(tree) as other:
        names, _ = json.loads(mine.stdout.readline()), other.stdout.readline()
        for name in names:
            asked(mine, name), asked(other, name)
            turns = np.array([(asked(mine, name), asked(other, name)) for _ in range(TURNS)])
            here, there = 1e3 * np.median(turns, axis=0)
            low, ratio, high = np.quantile(turns[:, 0] / turns[:, 1], (0.25, 0.5, 0.75))
            print(f"{name}: {here:.1f} ms, {there:.1f} there: {ratio:.2f} times ({low:.2f} to {high:.2f})", flush=True)
        for process in (mine, other):
            process.communicate()


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--answer"]:
            answer()
        case ["--beside", tree]:
            beside(Path(tree))
        case _:
            main()
