"""What a thousand speeds cost: `python tests/benchmarks/price_of_speed.py` prints processor times as JSON.

The paper's plate on the coarsest even mesh whose six frequencies are good to 1e-3, and on a graded one that is as good.
One solve is assembly, prestress and six modes at one speed; the sweep is assembly, prestress and six modes at 1000
speeds. One BLAS thread, least of several turns.
"""

import json
import os
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

from fem import Effects, Material, Plate, Rectangle, Rotor, assemble, campbell, rectangle, solve_modes

TURNS = 7


def least(work):
    """Least processor time in s of several turns."""
    times = []
    for _ in range(TURNS):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def price(mesh):
    """Time one solve, the sweep, and one more solve when the matrices are there."""
    plate = Plate(mesh, 0.01, Material(2e11, 0.3, 7850.0))
    top = 17500.0 * np.pi / 30.0
    speeds = np.linspace(0.0, top, 1000)
    operators = assemble(plate, Rotor(), Effects())
    one = least(lambda: solve_modes(assemble(plate, Rotor(), Effects()), top, 6))
    sweep = least(lambda: campbell(assemble(plate, Rotor(), Effects()), speeds, 6))
    return {
        "one_solve_s": one,
        "next_speed_s": least(lambda: solve_modes(operators, top, 6)),
        "thousand_speeds_s": sweep,
        "ratio": sweep / one,
        "largest_bound": float(campbell(operators, speeds, 6).bounds.max()),
    }


def main():
    """Print the prices on both meshes."""
    meshes = {"even, 28 x 11": rectangle(0.2, 0.08, 28, 11), "graded, 20 x 8": Rectangle(0.2, 0.08).mesh(4)}
    print(json.dumps({name: price(mesh) for name, mesh in meshes.items()}, indent=1))


if __name__ == "__main__":
    main()
