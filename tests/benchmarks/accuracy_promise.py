"""Whether the mesh chosen keeps its promise: `python -m tests.benchmarks.accuracy_promise [SCENES] [SEED]`.

Plates drawn over the sensible ranges, for 1e-2, 1e-3 and 1e-4: the true error is that against a mesh half again to
twice as fine as the one chosen, extrapolated; the time is that of the search against that of the coarsest mesh of the
ladder that truly meets the tolerance.
"""

import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

from fem import Effects, Material, Plate, Rectangle, Rotor, assemble, choose_mesh, choose_theory, solve_modes
from tests.soak import plates

COUNT = 6
TOLERANCES = (1e-2, 1e-3, 1e-4)
DEAR = 3.0


def drawn(seed):
    """A plate's planform, thickness, material, rotor and speeds."""
    given = plates.sensible(seed)
    length, width, thickness = given["plate"].values()
    rotor = Rotor(given["rotor"]["hub_radius"], given["rotor"]["stagger"])
    return (
        Rectangle(length, width),
        thickness,
        Material(*given["material"].values()),
        rotor,
        (0.0, *given["rotor"]["speeds"]),
    )


def bends(rotor):
    """Whether the load bends the plate, so that its deflection may be large."""
    return bool(abs(np.sin(2.0 * rotor.stagger)) > 1e-9)


def timed(work, *arguments):
    """What some work returns, and its least processor time in s of three turns."""
    times = []
    for _ in range(3):
        start = time.process_time()
        found = work(*arguments)
        times.append(time.process_time() - start)
    return found, min(times)


def scene(seed):
    """Search and truth for one plate: rows of (tolerance, size, estimate, true error, time, cheapest time)."""
    planform, thickness, material, rotor, speeds = drawn(seed)
    rows = []
    for tolerance in TOLERANCES:
        theory = choose_theory(Plate(planform.mesh(2), thickness, material), accuracy=tolerance).name

        effects = Effects(large_deflection=bends(rotor))

        def build(size, theory=theory, effects=effects):
            return assemble(Plate(planform.mesh(size), thickness, material), rotor, effects, theory)

        def frequencies(size, build=build):
            operators = build(size)
            return np.array([solve_modes(operators, speed, COUNT).frequencies_hz for speed in sorted(set(speeds))])

        choice, spent = timed(choose_mesh, planform, build, speeds, COUNT, tolerance)
        fine = next((s for s in planform.sizes if s >= 1.5 * choice.size), planform.sizes[-1])
        if theory == "solid":
            fine = next(s for s in planform.sizes if s > choice.size)
        limit = frequencies(fine)
        got = frequencies(choice.size)
        growth = (fine / choice.size) ** 3.8
        limit = limit + (limit - got) / (growth - 1.0)
        true = np.abs(got / limit - 1.0)
        cheapest = None
        for size in planform.sizes:
            found, took = timed(frequencies, size)
            if np.abs(found / limit - 1.0).max() <= tolerance:
                cheapest = (size, took)
                break
            if size > choice.size:
                break
        rows.append((theory, tolerance, choice, true, spent, cheapest))
    return planform, thickness, bends(rotor), rows


def main(count=30, first=0):
    """Print a line for every plate and tolerance, and what was worst."""
    broken = 0
    ratios, prices = [], []
    scene(first)  # warm-up
    for seed in range(first, first + count):
        planform, thickness, bent, rows = scene(seed)
        for theory, tolerance, choice, true, spent, cheapest in rows:
            ratio = choice.errors.max() / true.max()
            price = spent / cheapest[1] if cheapest else np.nan
            ratios.append(ratio)
            prices.append(price)
            kept = true.max() <= tolerance
            broken += not kept
            modes = choice.errors / true
            theory += " bent" if bent else ""
            print(
                f"{seed:3d} {planform.length / planform.width:5.2f} {thickness / planform.width:6.3f} {theory:14s} "
                f"{tolerance:.0e} size {choice.size:3d} estimate {choice.errors.max():.1e} true {true.max():.1e} "
                f"ratio {ratio:5.2f} modes {modes.min():.2f}-{modes.max():.2f} time {spent:6.2f} s = {price:4.1f} x "
                f"size {cheapest[0] if cheapest else '-'}{'' if kept else '  BROKEN'}{'' if choice.met else ' UNMET'}",
                flush=True,
            )
    dear = np.nansum(np.array(prices) > DEAR)
    print(
        f"{len(ratios)} choices: {broken} broken, estimate/true {min(ratios):.2f} to {max(ratios):.2f}, price up to "
        f"{np.nanmax(prices):.1f}, median {np.nanmedian(prices):.1f}, above {DEAR:g} in {dear:.0f}"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
