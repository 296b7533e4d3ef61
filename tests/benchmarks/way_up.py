"""Both ways through the amplitudes against an integrator that shares no code: `python -m tests.benchmarks.way_up`.

Random dampers with two steady motions over a range, ramps of 0.1 % a cycle up from the cut-off with the ball at rest in
the middle, and down again; how far a ball that rolls about the middle swings where it is to meet the walls; and by how
much the published curve exceeds the ramp up anywhere. The reference is that of the tests; some 20 s a damper.
`--count N`, `--first SEED`. `--designs`: two spaces of `design`, each damper of them held at five amplitudes from three
starts by the same reference: whether the best is the best, and what it was promised.
"""

from __future__ import annotations

import argparse
import dataclasses
import itertools
import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

import spindamp
from damper import ParticleDamper, Working, working
from tests.damper.digits import ramp
from workflows.scene.materials import KNOWN

GROWTH = 1.001
SAMPLES = 128
Floats = npt.NDArray[np.float64]


def drawn(seed: int) -> ParticleDamper:
    """A steel ball on a structure, with a cut-off below half the clearance."""
    rng = np.random.default_rng(seed)
    radius, mass = rng.uniform(1e-3, 4e-3), 10 ** rng.uniform(-1.5, 0)
    ball = 7850 * 4 / 3 * math.pi * radius**3
    omega, gap = 2 * math.pi * 10 ** rng.uniform(2, 3), 10 ** rng.uniform(-3.7, -2.5)
    load = (rng.uniform(3000, 15000) * math.pi / 30) ** 2 * rng.uniform(0.1, 0.5)
    cutoff = gap * 10 ** rng.uniform(-1.5, -0.4)
    stiffness, side = (mass + ball) * omega**2, 2 * (radius + gap)
    lever = min(cutoff * omega**2 / load, 0.5) * radius
    return ParticleDamper(
        mass, (stiffness,) * 2, ball, radius, (side, side), load, float(rng.uniform(0.3, 0.95)), 0.3, lever
    )


def followed(cycles: Iterator[tuple[float, float]], last: float, *, rising: bool) -> tuple[Floats, Floats]:
    """Amplitudes, midway through a cycle, and damping ratios of a ramp, averaged over 12 cycles."""
    path = list(itertools.takewhile(lambda cycle: (cycle[0] < last) is rising, cycles))
    level, lost = np.array(path).T
    mean = np.convolve(lost / (2 * math.pi), np.ones(12) / 12, "valid")
    return (level * np.exp(-lost / 2))[6 : 6 + len(mean)], mean


def at(curve: Working, amplitude: Floats) -> Floats:
    """Damping ratio of a curve."""
    ratio: Floats = np.interp(np.log(amplitude), np.log(curve.amplitude), curve.damping_ratio)
    return ratio


def turning(path: tuple[Floats, Floats]) -> float:
    """The amplitude at which a ramp goes over from one motion to another: where its losses change most in 24 cycles."""
    change = np.abs(np.log(path[1][24:] / np.maximum(path[1][:-24], 1e-12)))
    return float(path[0][int(np.argmax(change)) + 12])


def swing(damper: ParticleDamper, amplitude: float) -> float:
    """Half the way of a ball that rolls to and fro at an amplitude in a cavity without end, by what it loses [m]."""
    wide = dataclasses.replace(damper, cavity=(1e3 * amplitude, damper.cavity[1]))
    lost = [decrement for _, decrement in itertools.islice(ramp(wide, amplitude, 0.0, 1.0, SAMPLES), 4, 12)]
    energy = 0.5 * damper.stiffness[0] * amplitude**2
    return float(-np.expm1(-2 * np.array(lost)).mean()) * energy / (4 * damper.ball_mass * damper.rolling_threshold)


def excess(curve: Working, path: tuple[Floats, Floats]) -> float:
    """The most by which a curve promises more than a ramp shows, over stretches of an eighth of an octave.

    Over what is shown, or a twentieth of the peak where that is more, as just beyond the cut-off.
    """
    part = np.where(path[0] > curve.amplitude[0], np.floor(8 * np.log2(path[0])), -math.inf)
    stretches = [part == k for k in np.unique(part)[1:-1]]
    pairs = [(float(path[1][each].mean()), float(at(curve, path[0][each]).mean())) for each in stretches]
    return max((promise - shown) / max(shown, 0.05 * curve.peak) for shown, promise in pairs)


def compare(seed: int) -> str:
    """A damper's line: folds and the largest difference of either branch from the reference, away from the folds."""
    damper = drawn(seed)
    found = working(damper, threads=1)
    above = found.descending
    low, high = found.folds
    if not low < high:
        return f"{seed:3d}  e {damper.restitution:.2f}  one motion throughout"
    top = 1.25 * high
    up = followed(ramp(damper, 0.99 * found.cutoff, 0.0, GROWTH**2, SAMPLES), top, rising=True)
    down = followed(ramp(damper, top, 1.0, GROWTH**-2, SAMPLES), 0.85 * low, rising=False)
    begun = up[0] > 0.9 * low
    stops, begins = turning(down), turning((up[0][begun], up[1][begun]))
    lower, upper = (up[0] > 1.1 * low) & (up[0] < 0.93 * min(begins, found.jump[0])), down[0] > 1.08 * low
    errors = [
        abs(float(np.mean(path[1][where] / at(curve, path[0][where]) - 1))) if where.any() else math.nan
        for path, curve, where in ((up, found, lower), (down, above, upper))
    ]
    return (
        f"{seed:3d}  e {damper.restitution:.2f}  rolling {100 * errors[0]:5.2f} %  bouncing {100 * errors[1]:5.2f} %"
        f"  stops {1e3 * low:8.4f} mm, reference {100 * (stops / low - 1):+5.1f} %"
        f"  sure {1e3 * high:8.4f} mm, swing {100 * (swing(damper, high) / damper.half_gap[0] - 1):+5.1f} %"
        f"  begins {1e3 * found.jump[0]:8.4f} to {1e3 * found.jump[1]:8.4f} mm, reference {1e3 * begins:8.4f}"
        f"  excess {100 * excess(found, up):+5.1f} %"
    )


SPACES = (  # restitution, frequency [Hz], mass [kg], speed [rpm], diameters, clearances and amplitudes [mm]
    (0.8, 500.0, 0.1, 6000.0, (5.0,), (1.0, 2.75, 6.0), (0.5, 1.0)),
    (0.5, 200.0, 0.3, 3000.0, (3.0, 4.0, 5.0), (0.4, 0.8, 1.6), (0.7, 1.4)),
)


def least(damper: ParticleDamper, amplitudes: Iterable[float]) -> float:
    """Damping ratio that a ball adds at least, held at amplitudes, from the middle, aside and rolling about it."""
    found = []
    for amplitude in amplitudes:
        for place in (0.0, 0.5, -min(5 / 7 * amplitude / damper.half_gap[0], 1.0)):
            cycles = itertools.islice(ramp(damper, amplitude, place, 1.0, SAMPLES), 40, 160)
            found.append(float(np.mean([lost for _, lost in cycles])) / (2 * math.pi))
    return min(found)


def designs() -> None:
    """Print a line for each damper of the spaces, what `design` chooses, and what it promises."""
    for restitution, frequency, mass, rpm, diameters, clearances, ends in SPACES:
        scene: dict[str, Any] = {
            "structure": {"frequency": frequency, "mass": mass},
            "rotor": {"speeds": [f"{rpm} rpm"], "radius": 0.2},
            "damper": {
                "ball_material": "steel",
                "radius": 5e-4 * diameters[0],
                "cavity": [1e-3 * (diameters[0] + clearances[0])] * 2,
                "restitution": restitution,
                "friction": 0.3,
                "rolling_friction": 2e-5,
            },
            "effects": {"ball_slip": False, "indentation": False},
            "design": {
                "ball_diameter": [1e-3 * each for each in diameters if len(diameters) > 1] or None,
                "clearance": [1e-3 * each for each in clearances],
                "amplitude": [1e-3 * end for end in ends],
            },
        }
        scene["design"] = {key: value for key, value in scene["design"].items() if value}
        found = spindamp.design(scene)
        best, shown = found.scene.scene.damper, {}
        for diameter, clearance in itertools.product(diameters, clearances):
            ball = KNOWN["steel"].density * math.pi / 6 * (1e-3 * diameter) ** 3
            load, side = (rpm * math.pi / 30) ** 2 * 0.2, 1e-3 * (diameter + clearance)
            m2, radius = mass, 5e-4 * diameter
            stiffness = (m2 + ball) * (2 * math.pi * frequency) ** 2
            damper = ParticleDamper(m2, (stiffness,) * 2, ball, radius, (side,) * 2, load, restitution, 0.3, 2e-5)
            shown[diameter, clearance] = least(damper, 1e-3 * np.geomspace(*ends, 5))
            print(f"  {diameter} mm in {clearance} mm: {100 * shown[diameter, clearance]:.4f} %", flush=True)
        chosen = round(2e3 * best.radius, 6), round(1e3 * (best.cavity[0] - 2 * best.radius), 6)
        print(
            f"e {restitution}: chosen {chosen}, promised {100 * found.found.scored.value:.4f} %, shown"
            f" {100 * shown[chosen]:.4f} %; best by brute force {max(shown, key=lambda each: shown[each])}",
            flush=True,
        )


def main() -> None:
    """Print a line for each damper."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--designs", action="store_true")
    given = parser.parse_args()
    if given.designs:
        designs()
        return
    for seed in range(given.first, given.first + given.count):
        print(compare(seed), flush=True)


if __name__ == "__main__":
    main()
