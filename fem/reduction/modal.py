"""The plate's modes as a ball in a cavity feels them: how they move its place and tilt the floor, speed by speed.

The cavity's floor faces the load. On the plate's centre line its axis 1 lies along z, through the thickness, and its
axis 2 along y. As the plate moves, its place goes by (w, v) there, and the floor, which bends and turns with the
material, tilts by (w_x, -u_y): the slope against the load of a ball that moves along either axis.

A ball in a cavity pulls on the plate even while it rolls and has no inertia of its own there. The modes are therefore
those of the plate under that pull, within the span of its own: K(Omega) + Omega² m K_a, K_a being what the load of 1 kg
at the place adds, against the plate's mass. What lies beyond that span changes them in second order of the mass ratio.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, vstack

from fem.assembly import Operators, rows_at, uniform_load, with_point_mass
from fem.linalg import Array
from fem.meshes import thickness
from fem.modes import Divergence
from fem.statics import linearise
from fem.sweep.campbell import Campbell, without_coriolis


@dataclass(frozen=True, eq=False)
class ModesAtPlace:
    """Modes of a plate at a place, without the ball's inertia, ascending; every modal mass is 1 kg.

    Attributes:
        omega: speeds, shape (n,) [rad/s].
        stiffness: omega_k² under the ball's pull, shape (n, k) [N/m].
        shape: displacement of the place along the floor's two axes, shape (n, 2, k) [-].
        slope: of the floor along them, shape (n, 2, k) [1/m].
        drawn: force on the modes by a unit acceleration of the root along the two axes, but for its sign,
            shape (n, 2, k) [kg].
        pressed: force on the modes by a unit pressure all over the plate along z, shape (n, k) [m²].
    """

    omega: Array
    stiffness: Array
    shape: Array
    slope: Array
    drawn: Array
    pressed: Array


def modes_at(operators: Operators, diagram: Campbell, at: tuple[float, float], masses: Array) -> ModesAtPlace:
    """Modes at a place under the pull of balls, at every speed of a diagram.

    The modes are real: a diagram with Coriolis forces is made again without them.

    Args:
        operators: of the plate.
        diagram: its modes over speeds.
        at: place (x, y) [m].
        masses: of the balls at each speed, shape (n,) [kg].

    Raises:
        PlaceError: off the plate.
        Divergence: the pull takes the stiffness of a mode.
    """
    operators, diagram = without_coriolis(operators, diagram)
    count = diagram.frequencies_hz.shape[1]
    place = operators.at_place(at)
    rows = vstack([place.floor, csc_array(load_rows(operators, place.axes[:2]))]).tocsc()
    stiffness, motions = [], []
    for part in diagram.parts:
        balls, masses = masses[: part.omega.size], masses[part.omega.size :]
        vectors = part.vectors[:, :, :count]
        if operators.effects.large_deflection:  # of one speed, about the bent state of the plate with the ball
            shapes = part.basis @ vectors[0]
            heavy = with_point_mass(operators, at, float(balls[0]))
            loaded = (shapes.T @ (linearise(heavy, float(part.omega[0]), part.state)[0] @ shapes))[None]
        else:
            pull = part.basis.T @ (place.ball[0] @ part.basis)  # of 1 kg
            weight = (part.omega**2 * balls)[:, None, None]
            loaded = part.rates[:, :count, None] ** 2 * np.eye(count)
            loaded = loaded + weight * (vectors.transpose(0, 2, 1) @ pull @ vectors)
        values, turned = np.linalg.eigh(loaded)
        if values.min() <= 0.0:
            worst = int(values[:, 0].argmin())
            raise Divergence(float(part.omega[worst]), float(values[worst, 0]))
        vectors = vectors @ turned
        stiffness.append(values)
        motions.append((rows @ part.basis) @ vectors)
    motion = np.concatenate(motions)
    parts = motion[:, :2], motion[:, 2:4], motion[:, 4:6], motion[:, 6]
    return ModesAtPlace(diagram.omega, np.concatenate(stiffness), *parts)


def load_rows(operators: Operators, axes: Array) -> Array:
    """Load vectors (3, n): unit accelerations of the root along two axes (2, 3), and a unit pressure along z.

    Those of the accelerations have the opposite sign.
    """
    height = thickness.of(operators.plate.thickness, operators.model.points[:2])
    pressed = uniform_load(operators.model, 1.0 / height, np.eye(3)[2])
    return np.vstack([axes @ drawn_rows(operators), pressed])


def drawn_rows(operators: Operators) -> Array:
    """Load vectors (3, n) of unit accelerations of the root along x, y and z, with the opposite sign."""
    pulls = [mass * rows_at(operators.model, places) for places, mass in operators.points]
    drawn = []
    for axis in range(3):
        load = uniform_load(operators.model, operators.plate.material.density, np.eye(3)[axis])
        drawn.append(sum((rows[axis::3].sum(axis=0) for rows in pulls), load))
    return np.array(drawn)
