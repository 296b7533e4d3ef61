"""Speeds at which the plates are strained and turned as drawn: `python -m tests.survey.speeds` prints them.

On coarse meshes of Mindlin's theory; what CalculiX is asked does not hang on them, and `plates.SPEEDS` not on these.
"""

import numpy as np

from fem import Effects, Material, Plate, Rotor
from fem.accuracy.neglected_effects import bent
from tests.survey import plates

NEAR = 0.2
"""Within which of what was drawn the search ends."""


def static_state(case, omega):
    """The static state of a plate at a speed in rad/s, None where it diverges; of the mean thickness, and one mode."""
    mesh = case.planform.even(1)
    thickness = float(case.thickness_at(*mesh.p[:, mesh.t].mean(axis=1)).mean())
    kg, *at = case.tip or (0.0,)
    plate = Plate(mesh, thickness, Material(*case.material), kg, tuple(at) or None)
    return bent(plate, Rotor(case.hub, np.radians(case.stagger)), Effects(), (omega,), 1)


def share(case, omega):
    """The larger of strain and rotation over what was drawn."""
    state = static_state(case, omega)
    if state is None or not np.isfinite(state.shift):
        return 4.0
    return max(state.strain / case.strain, state.rotation / case.rotation)


def speed(case):
    """In rpm, two digits. Both grow about with the square of the speed."""
    young, _, density = case.material
    length = case.planform.sides[0]
    omega = np.sqrt(2.0 * case.strain * young / density / (length * (length + 2.0 * case.hub)))
    for _ in range(8):
        found = share(case, omega)
        if abs(found - 1.0) < NEAR:
            break
        omega /= np.sqrt(np.clip(found, 0.25, 4.0))
    return float(f"{omega * 30.0 / np.pi:.2g}")


if __name__ == "__main__":
    for case in plates.cases():
        print(f"{speed(case):.0f}, ", end="", flush=True)
