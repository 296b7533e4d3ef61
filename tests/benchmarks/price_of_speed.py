"""What a thousand speeds cost: `python tests/benchmarks/price_of_speed.py` prints processor times as JSON.

The paper's plate on the coarsest mesh of its kind whose six frequencies are good to 1e-3. One solve is assembly,
prestress and six modes at one speed; the sweep is assembly, prestress and six modes at 1000 speeds. One BLAS thread,
least of several turns.
"""

import json
import os
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

from fem import Effects, Material, Plate, Rotor, assemble, campbell, rectangle, solve_modes

TURNS = 7


def least(work):
    """Least processor time in s of several turns."""
    times = []
    for _ in range(TURNS):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def main():
    """Time one solve, the sweep, and one more solve when the matrices are there."""
    plate = Plate(rectangle(0.2, 0.08, 28, 11), 0.01, Material(2e11, 0.3, 7850.0))
    top = 17500.0 * np.pi / 30.0
    speeds = np.linspace(0.0, top, 1000)
    operators = assemble(plate, Rotor(), Effects())
    print(
        json.dumps(
            {
                "one_solve_s": least(lambda: solve_modes(assemble(plate, Rotor(), Effects()), top, 6)),
                "next_speed_s": least(lambda: solve_modes(operators, top, 6)),
                "thousand_speeds_s": least(lambda: campbell(assemble(plate, Rotor(), Effects()), speeds, 6)),
                "largest_bound": float(campbell(operators, speeds, 6).bounds.max()),
            }
        )
    )


if __name__ == "__main__":
    main()
