"""A Campbell diagram here and in CalculiX: `python tests/benchmarks/campbell_vs_calculix.py`.

The paper's plate, six modes with stress stiffening and spin softening. The truth is CalculiX on a fine mesh. On a
ladder of coarser ones CalculiX solves each speed afresh; here 1000 speeds are swept, and a speed costs a thousandth of
everything: mesh, assembly, prestress, basis and answers. An error is the largest over six modes and three speeds
against the truth, so that what Mindlin's theory itself lacks is in it. The two are compared at the finest rung of
CalculiX's ladder that is not more accurate than the sweep, each at its least time of several turns; CalculiX may use
all cores, the sweep uses one.

Where ccx is not installed the script says so and stops.
"""

import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import calculix
import numpy as np

from fem import Effects, Material, Plate, Rotor, assemble, campbell, rectangle

SIZE, STEEL = (0.2, 0.08, 0.01), (2e11, 0.3, 7850.0)
SPEEDS = np.array([0.0, 10000.0, 17500.0]) * np.pi / 30.0
TRUTH = (40, 16, 2)
LADDER = [(10, 4, 2), (12, 5, 2), (14, 6, 2), (16, 7, 2), (20, 8, 2)]
MESH = (14, 6)
COUNT = 6


def timed(work, turns):
    """What the work returns, and its least wall-clock time in s."""
    times = []
    for _ in range(turns):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return result, min(times)


def bricks(cells, turns=1):
    """CalculiX's frequencies (speed, mode) in Hz, and its time for a speed, with one thread or all, what is faster."""
    found, times = [], []
    for omega in SPEEDS:
        runs = [
            timed(lambda o=omega, n=n: calculix.frequencies(SIZE, STEEL, cells, o, count=COUNT, threads=n), turns)
            for n in {1, os.cpu_count() or 1}
        ]
        found.append(runs[0][0])
        times.append(min(taken for _, taken in runs))
    return np.array(found), float(np.mean(times))


def sweep(speeds):
    """Frequencies (speed, mode) in Hz of a sweep, from the mesh on."""
    plate = Plate(rectangle(SIZE[0], SIZE[1], *MESH), SIZE[2], Material(*STEEL))
    return campbell(assemble(plate, Rotor(), Effects()), speeds, COUNT)


def main():
    """Print the table and the verdict."""
    if not calculix.available():
        print("skipped: CalculiX (ccx) is not installed; Debian has it as calculix-ccx")
        return 0
    truth, _ = bricks(TRUTH)
    here = np.abs(sweep(SPEEDS).frequencies_hz / truth - 1.0).max()
    thousand = np.union1d(np.linspace(0.0, SPEEDS[-1], 1000 - SPEEDS.size), SPEEDS)
    swept, taken = timed(lambda: sweep(thousand), 7)
    per_speed = taken / swept.omega.size
    print(f"{'':34}{'largest error':>15}{'time a speed':>15}{'times longer':>15}")
    print(f"{f'sweep, Mindlin {MESH[0]}x{MESH[1]}':34}{here:>15.2%}{per_speed:>13.2e} s")
    verdict = None
    for cells in LADDER:
        found, time_there = bricks(cells, turns=3)
        error = np.abs(found / truth - 1.0).max()
        print(
            f"{'CalculiX C3D20R ' + 'x'.join(map(str, cells)):34}{error:>15.2%}{time_there:>13.2e} s"
            f"{time_there / per_speed:>15.0f}"
        )
        if error >= here:
            verdict = cells, time_there / per_speed
    if verdict is None:
        print("no rung of the ladder is as inaccurate as the sweep")
        return 1
    print(f"At equal or better error a speed is {verdict[1]:.0f} times faster than CalculiX's {verdict[0]}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
