"""Random plates, over everything that a scene accepts, and what each must keep."""

from typing import Any

import numpy as np

from fem import Divergence, Effects, Material, NoEquilibrium, Plate, Rotor, assemble, campbell, rectangle, solve_modes
from fem.linalg import rounding
from tests.soak.dice import Dice, power, sometimes
from workflows.scene.scene import SLOWEST

Scene = dict[str, Any]

EXACT = 1e-6
"""Relative slack of comparisons of one frequency computed in two ways, above what rounding leaves uncertain."""
COUNT = 5


def scene(dice: Dice) -> Scene:
    """Length, slenderness, thickness, material, speed, stagger, hub, effects and a point mass, far apart each."""
    length = power(dice, -3, 1)
    width = length * power(dice, -1.5, 0.7)
    theory = dice.one_of(("mindlin", "kirchhoff", "solid"))
    thinnest = -1.5 if theory == "solid" else -5.0
    thickness = min(length, width) * power(dice, thinnest, -0.5)
    modulus, density = power(dice, 6, 12), power(dice, 1, 4.5)
    # the flap frequency of a beam sets the scale of the speed
    rate = 1.015 * thickness / length**2 * np.sqrt(modulus / density)
    fastest = min(9e4, 0.05 / length * np.sqrt(modulus / density))  # strains stay small
    tip_mass = density * length * width * thickness * sometimes(dice, (0.0,), power(dice, -3, 3))
    hub = sometimes(dice, (0.0,), length * power(dice, -2, 1))
    stiffened = dice.between(0.0, 1.0) < 0.9
    large = stiffened and dice.between(0.0, 1.0) < 0.2
    if large and tip_mass > 0.0:  # under great strains a plate rests in several places
        fastest = min(fastest, np.sqrt(1e-2 * modulus * width * thickness / (tip_mass * (length + hub))))
    speed = min(fastest, rate * sometimes(dice, (0.0, 1.0), power(dice, -3, 1.3)))
    stagger = sometimes(dice, (0.0, np.pi / 2), dice.between(-np.pi, np.pi))
    coriolis = dice.between(0.0, 1.0) < 0.25
    return {
        "title": "soak",
        "plate": {"length": length, "width": width, "thickness": thickness, "theory": theory, "tip_mass": tip_mass},
        "material": {
            "youngs_modulus": modulus,
            "poissons_ratio": sometimes(dice, (0.0, 0.3), dice.between(-0.9, 0.49)),
            "density": density,
        },
        "rotor": {
            "speeds": [float(speed) if speed >= SLOWEST else 0.0],
            "hub_radius": hub,
            "stagger": float(stagger),
            "modes": COUNT,
        },
        "effects": {
            "stress_stiffening": stiffened,
            "spin_softening": dice.between(0.0, 1.0) < 0.9,
            "coriolis": coriolis,
            "large_deflection": large,
            "rotary_inertia": dice.one_of((True, False)),
        },
    }


def sensible(seed: int) -> Scene:
    """Of metal: aspect 0.5 to 6, h/b 0.005 to 0.2, any stagger, up to three times as fast as its first frequency."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(0.05, 0.5)
    width = length / np.exp(rng.uniform(np.log(0.5), np.log(6.0)))
    thickness = min(length, width) * np.exp(rng.uniform(np.log(0.005), np.log(0.2)))
    young, density = ((2e11, 7850.0), (1.14e11, 4430.0), (7e10, 2700.0))[rng.integers(3)]
    poisson = rng.uniform(0.0, 0.45)
    first = 2.0 * np.pi * 0.16 * thickness / length**2 * np.sqrt(young / density)
    fastest = np.sqrt(2e-2 * young / density) / (3.0 * length)  # strains stay below about 1 %
    stagger = rng.choice([0.0, 90.0, rng.uniform(0.0, 90.0), rng.uniform(70.0, 90.0)])
    speed, hub = min(fastest, first * rng.uniform(0.1, 3.0)), length * rng.choice([0.0, rng.uniform(0.0, 2.0)])
    return {
        "plate": {"length": length, "width": width, "thickness": thickness},
        "material": {"youngs_modulus": young, "poissons_ratio": poisson, "density": density},
        "rotor": {"speeds": [speed], "hub_radius": hub, "stagger": np.deg2rad(stagger), "modes": 6},
        "accuracy": {"frequency": rng.choice([1e-2, 1e-3, 1e-3, 1e-4])},
    }


def mesh(dice: Dice, given: Scene) -> Any:
    """A coarse mesh of rectangles, of skewed quadrilaterals or of triangles, graded or not."""
    plate = given["plate"]
    nx, ny = dice.one_of((2, 3, 5, 8)), dice.one_of((1, 2, 4))
    made = rectangle(1.0, 1.0, nx, ny)
    points = made.p.copy()
    if dice.one_of((True, False)):
        points[0] **= dice.between(0.5, 2.0)
    if dice.one_of((True, False)):
        points = _skewed(made, points, dice)
    made = type(made)(points * np.array([[plate["length"]], [plate["width"]]]), made.t)
    return made.to_meshtri() if dice.one_of((True, False)) else made


def _skewed(made: Any, points: np.ndarray, dice: Dice) -> np.ndarray:
    """Inner points moved by up to a quarter of the distance to the nearest other point."""
    outer = np.unique(made.facets[:, made.boundary_facets()])
    for k in np.setdiff1d(np.arange(points.shape[1]), outer):
        others = np.delete(points, k, axis=1)
        room = 0.25 * np.linalg.norm(others - points[:, [k]], axis=0).min()
        points[:, k] += room * np.array([dice.between(-0.7, 0.7), dice.between(-0.7, 0.7)])
    return points


def operators_of(given: Scene, mesh: Any) -> Any:
    """The matrices of a scene on a mesh."""
    p, m, r = given["plate"], given["material"], given["rotor"]
    material = Material(m["youngs_modulus"], m["poissons_ratio"], m["density"])
    plate = Plate(mesh, p["thickness"], material, p["tip_mass"], (p["length"], 0.0))
    return assemble(plate, Rotor(r["hub_radius"], r["stagger"]), Effects(**given["effects"]), p["theory"])


def faults(given: Scene, mesh: Any) -> tuple[list[str], str]:
    """What the plate of a scene did not keep, and how its solution ended."""
    operators, omega = operators_of(given, mesh), given["rotor"]["speeds"][0]
    found = []
    if not (operators.mass.diagonal() >= 0.0).all():
        found.append("a mass is negative")
    if abs(operators.mass - operators.mass.T).max() > 1e-12 * abs(operators.mass).max():
        found.append("the mass matrix is not symmetric")
    try:
        modes = solve_modes(operators, omega, COUNT)
    except Divergence as ended:
        return found + _of_divergence(operators, omega, ended), "divergence"
    except NoEquilibrium:
        return found, "no equilibrium"
    return found + _of_modes(operators, omega, modes) + _of_sweep(operators, omega, modes), "modes"


def _of_divergence(operators: Any, omega: float, ended: Divergence) -> list[str]:
    found = []
    if omega == 0.0:
        found.append("a plate at rest diverges")
    if not (np.isfinite(ended.eigenvalue) and ended.eigenvalue <= 0.0):
        found.append(f"divergence with the eigenvalue {ended.eigenvalue:.3g}")
    try:
        solve_modes(operators, 0.0, 1)
    except Divergence:
        found.append("a plate at rest diverges")
    return found


def _of_modes(operators: Any, omega: float, modes: Any) -> list[str]:
    found = []
    values = modes.eigenvalues
    if not (np.isfinite(values).all() and (values > 0.0).all()):
        return [f"eigenvalues are {values}"]
    if (np.diff(values) < 0.0).any():
        found.append("frequencies are out of order")
    if not np.isfinite(modes.shapes).all():
        found.append("shapes are not finite")
    uncertain = rounding(operators.at(omega), np.abs(modes.shapes), values)
    few = solve_modes(operators, omega, 2).eigenvalues
    if (np.abs(few / values[:2] - 1.0) > EXACT + 2.0 * uncertain[:2]).any():
        found.append(f"the count asked for changes frequencies by {np.abs(few / values[:2] - 1).max():.2g}")
    if operators.gyroscopic is None:
        back = modes.factor.solve(operators.mass @ modes.shapes) * values
        left = np.linalg.norm(back - modes.shapes, axis=0) / np.linalg.norm(modes.shapes, axis=0)
        if not (left < 1e-5 + 10.0 * _stray(uncertain, values)).all():
            found.append(f"shapes miss the equations by {left.max():.2g}")
    return found


def _stray(uncertain: np.ndarray, values: np.ndarray) -> np.ndarray:
    """How much of another mode a solution for each mode contains: rounding is about (u_j v_j u_k v_k)^1/2, over v_j."""
    return np.asarray(np.sqrt(uncertain[:, None] * uncertain * values / values[:, None]).max(axis=0))


def _of_sweep(operators: Any, omega: float, modes: Any) -> list[str]:
    """A sweep up to the speed gives the same frequencies, within its own bounds."""
    try:
        swept = campbell(operators, np.array([0.0, 0.5, 1.0]) * omega, COUNT)
    except Divergence:
        return ["a sweep diverges where one speed does not"]
    if not swept.omega.size or swept.omega[-1] != omega:
        return [] if _beyond_an_unstable_one(operators, omega) else ["a sweep leaves out a speed that has modes"]
    error = np.abs(swept.frequencies_hz[-1] / modes.frequencies_hz - 1.0)
    worst = int(np.argmax(error - swept.bounds[-1]))
    if error[worst] > swept.bounds[-1][worst] + 1e-8:
        return [f"a sweep is off by {error[worst]:.2g} in mode {worst + 1}, its bound is {swept.bounds[-1][worst]:.2g}"]
    return []


def _beyond_an_unstable_one(operators: Any, omega: float) -> bool:
    """Whether a greatly deflected plate is stable at a speed but not at half of it: the sweep ends at the first."""
    if not operators.effects.large_deflection:
        return False
    try:
        solve_modes(operators, 0.5 * omega, 1)
    except (Divergence, NoEquilibrium):
        return True
    return False
