"""What `auto` leaves out: `python -m tests.benchmarks.left_out [PLATES] [SEED]`.

Random plates at one speed each. Of every effect that is left out it is seen how far it would move each frequency, on a
mesh finer than the one it was decided on; where it is more than the accuracy asked for, the line says BROKEN.
"""

import os
import sys
from collections import Counter
from dataclasses import replace

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

from fem import Divergence, Effects, Material, NoEquilibrium, Plate, Rectangle, Rotor, assemble, solve_modes
from workflows.effects import selection
from workflows.scene.scene import Scene

COUNT = 6
SIZE = 4
EFFECTS = ("coriolis", "large_deflection")
MATERIALS = ((2e11, 7850.0), (1.14e11, 4430.0), (7e10, 2700.0))


def draw(seed):
    """A scene: aspect 0.5 to 6, h/b 0.005 to 0.2, any stagger, up to three times as fast as its first frequency."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(0.05, 0.5)
    width = length / np.exp(rng.uniform(np.log(0.5), np.log(6.0)))
    thickness = min(length, width) * np.exp(rng.uniform(np.log(0.005), np.log(0.2)))
    young, density = MATERIALS[rng.integers(3)]
    first = 2.0 * np.pi * 0.16 * thickness / length**2 * np.sqrt(young / density)
    fastest = np.sqrt(2e-2 * young / density) / (3.0 * length)  # strains stay below about 1 %
    stagger = rng.choice([0.0, 90.0, rng.uniform(0.0, 90.0), rng.uniform(70.0, 90.0)])
    return Scene.model_validate(
        {
            "plate": {"length": length, "width": width, "thickness": thickness},
            "material": {"youngs_modulus": young, "poissons_ratio": rng.uniform(0.0, 0.45), "density": density},
            "rotor": {
                "speeds": [float(min(fastest, first * rng.uniform(0.1, 3.0)))],
                "hub_radius": length * rng.choice([0.0, rng.uniform(0.0, 2.0)]),
                "stagger": f"{stagger} deg",
                "modes": COUNT,
            },
            "accuracy": {"frequency": float(rng.choice([1e-2, 1e-3, 1e-3, 1e-4]))},
        }
    )


def frequencies(scene, switches):
    """The six lowest with these effects; None where the plate diverges."""
    given, material = scene.plate, scene.material
    mesh = Rectangle(given.length, given.width).mesh(SIZE)
    plate = Plate(mesh, given.thickness, Material(material.youngs_modulus, material.poissons_ratio, material.density))
    operators = assemble(plate, Rotor(scene.rotor.hub_radius, scene.rotor.stagger), switches)
    try:
        return solve_modes(operators, scene.rotor.speeds[0], COUNT).frequencies_hz
    except (Divergence, NoEquilibrium):
        return None


def moved(decided, other):
    """Largest relative difference between frequencies; None where the plate diverges either way."""
    if decided is None and other is None:
        return None
    if decided is None or other is None:
        return np.inf
    return float(np.abs(other / decided - 1.0).max())


def survey(seeds):
    """For each seed and effect left out: (seed, name, accuracy asked for, what it moves, why it was left out)."""
    for seed in seeds:
        scene = draw(seed)
        decided = selection.resolve(scene)
        switches = Effects(**{name: decided[name].on for name in EFFECTS})
        out = [name for name in EFFECTS if not decided[name].on]
        found = frequencies(scene, switches) if out else None
        for name in EFFECTS:
            change = moved(found, frequencies(scene, replace(switches, **{name: True}))) if name in out else None
            yield seed, name, scene.accuracy.frequency, change, decided[name].why


def main(count=200, first=0):
    """Print a line for every effect of every plate, and how many are broken."""
    tally = Counter()
    for seed, name, asked, change, why in survey(range(first, first + count)):
        kind = "on or diverging" if change is None else "BROKEN" if change > asked else "left out"
        tally[name, kind] += 1
        told = "" if change is None else f"{change:.1e}"
        print(f"{seed:4d} {name:16s} {asked:.0e} {told:8s} {kind:15s} {why}", flush=True)
    for (name, kind), times in sorted(tally.items()):
        print(f"{name}: {times} {kind}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
