"""Both ways through the amplitudes against an integrator that shares no code: `python -m tests.benchmarks.way_up`.

Random dampers with two steady motions over a range, eight ramps of 0.1 % a cycle up from the cut-off with the ball at
rest in the middle, and eight down from other places of the ball. Curves are compared over eighths of an octave: the
largest differences of both branches from the mean of the ramps, whose hits are chaotic, away from the folds; of the
bouncing branch also with the means of four times as many sweeps and 256 ramps, where it differs by more than 1 %: two
bouncing motions may exist side by side, and then a mean depends on how many fall into each; and by how
much the promise exceeds any one ramp up, over what that shows, or over 2 % of the peak where that is more: just beyond
the cut-off a ball takes next to nothing, and a percentage of it means nothing. A fold is the least amplitude, midway
through a cycle, before the median ramp falls off. `swing` is how far a ball that rolls about the middle swings where it
is to meet the walls. The reference is `tests.damper.ramps`; a second a damper. `--count N`, `--first SEED`.
`--designs`: two spaces of `design`, each damper of them held at amplitudes from three starts by the same reference:
whether the best is the best, and what it was promised.
"""

import argparse
import dataclasses
import itertools
import math
from typing import Any

import numpy as np
import numpy.typing as npt

import spindamp
from damper import DampingCurve, ParticleDamper, damping_curve
from damper.curve_measurement import SWEEPS
from tests.damper.ramps import led
from workflows.scene.materials import KNOWN

GROWTH, RAMPS, LEAST = 1.001, 8, 0.02
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


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


def ramp(damper: ParticleDamper, first: float, last: float, place: float = 0.0) -> tuple[Floats, Floats]:
    """Amplitudes, midway through a cycle, and damping ratios of a ramp."""
    cycles = round(abs(math.log(last / first)) / math.log(GROWTH))
    amplitudes = np.geomspace(first, last, cycles)
    lost = led(damper, amplitudes, place)
    return amplitudes * np.exp(-lost / 2), lost / (2 * math.pi)


def at(curve: DampingCurve, amplitude: Floats) -> Floats:
    """Damping ratio of a curve."""
    ratio: Floats = np.interp(np.log(amplitude), np.log(curve.amplitude), curve.damping_ratio)
    return ratio


def turning(path: tuple[Floats, Floats]) -> int:
    """The cycle at which a ramp goes over from one motion to another: where its losses change most in 24 cycles."""
    mean = np.convolve(path[1], np.ones(12) / 12, "valid")
    return int(np.argmax(np.abs(np.log(mean[24:] / np.maximum(mean[:-24], 1e-12))))) + 18


def part(path: tuple[Floats, Floats], where: Mask) -> tuple[Floats, Floats]:
    """Some cycles of a ramp."""
    return path[0][where], path[1][where]


def swing(damper: ParticleDamper, amplitude: float) -> float:
    """Half the way of a ball that rolls to and fro at an amplitude in a cavity without end, by what it loses [m]."""
    wide = dataclasses.replace(damper, cavity=(1e3 * amplitude, damper.cavity[1]))
    energy = 0.5 * damper.stiffness[0] * amplitude**2
    lost = -np.expm1(-2 * led(wide, np.full(12, amplitude))[4:]).mean() * energy
    return float(lost / (4 * damper.ball_mass * damper.rolling_threshold))


def stretches(paths: list[tuple[Floats, Floats]], curve: DampingCurve) -> Floats:
    """Damping ratios of ramps and of a curve, means over eighths of an octave of 20 cycles at least, shape (n, 2)."""
    means = []
    for amplitude, shown in paths:
        number = np.floor(8 * np.log2(amplitude))
        each = [number == k for k in np.unique(number)]
        means += [(shown[here].mean(), at(curve, amplitude[here]).mean()) for here in each if here.sum() >= 20]
    return np.array(means).reshape(-1, 2)


def farthest(paths: list[tuple[Floats, Floats]], curve: DampingCurve) -> float:
    """The largest relative difference of a curve from the mean of ramps, in stretches of 2 % of its peak on."""
    amplitude, ratio = (np.concatenate(each) for each in zip(*paths, strict=True))
    shown, promised = stretches([(amplitude, ratio)], curve).T
    return float(np.abs(promised / shown - 1)[shown > LEAST * curve.peak].max(initial=0.0))


def falling(damper: ParticleDamper, low: float, high: float, count: int) -> list[tuple[Floats, Floats]]:
    """Ramps down through both folds, from as many places of the ball."""
    starts = [1.25 * high * 2 ** ((k + 1) / count) for k in range(count)]
    return [ramp(damper, first, 0.6 * low, 1 - k / count) for k, first in enumerate(starts)]


def compare(seed: int) -> str:
    """A damper's line: differences from eight ramps up and eight down, the largest in any stretch; folds; excess."""
    damper = drawn(seed)
    found = damping_curve(damper, threads=1)
    above, cutoff, (low, high) = found.descending, found.cutoff, found.folds
    if not low < high:
        return f"{seed:3d}  e {damper.restitution:.2f}  one motion throughout"
    up = []
    for k in range(RAMPS):
        rising = ramp(damper, 0.99 * cutoff * GROWTH ** (-0.618 * k), 1.25 * high)
        up.append(part(rising, rising[1] > 0))
    down = falling(damper, low, high, RAMPS)
    begins = [path[0][turning(path)] for path in (part(path, path[0] > 1.15 * cutoff) for path in up)]
    stops = [path[0][: turning(path)].min() for path in (part(path, path[0] < 2 * low) for path in down)]
    rolling = [part(path, path[0] < 0.93 * min(*begins, found.jump[0])) for path in up]
    clear = 1.08 * low * math.exp(math.pi * above.peak)  # by half of what a cycle takes
    bouncing = [part(path, (path[0] > clear) & (path[0] < 1.2 * high)) for path in down]
    differs, averaged = farthest(bouncing, above), ""
    if differs > 0.01:
        many = [part(path, (path[0] > clear) & (path[0] < 1.2 * high)) for path in falling(damper, low, high, 256)]
        sure = farthest(many, damping_curve(damper, threads=1, sweeps=4 * SWEEPS).descending)
        averaged = f" ({100 * sure:.1f} %)"
    shown, promised = stretches(up, found).T
    excess = float(((promised - shown) / np.maximum(shown, LEAST * found.peak)).max())
    return (
        f"{seed:3d}  e {damper.restitution:.2f}  rolling {100 * farthest(rolling, found):4.1f} %"
        f"  bouncing {100 * differs:4.1f} %{averaged:8s}"
        f"  stops {1e3 * low:7.4f} mm, ramps {100 * (np.median(stops) / low - 1):+4.1f} %"
        f"  sure {1e3 * high:7.4f} mm, swing {100 * (swing(damper, high) / damper.half_gap[0] - 1):+4.1f} %"
        f"  begins {1e3 * found.jump[0]:7.4f} to {1e3 * found.jump[1]:7.4f} mm,"
        f" ramps {1e3 * min(begins):7.4f} to {1e3 * max(begins):7.4f}"
        f"  excess {100 * excess:+4.1f} %"
    )


SPACES = (  # restitution, frequency [Hz], mass [kg], speed [rpm], diameters, clearances and amplitudes [mm]
    (0.8, 500.0, 0.1, 6000.0, (5.0,), (1.0, 2.75, 6.0), (0.5, 1.0)),
    (0.5, 200.0, 0.3, 3000.0, (3.0, 4.0, 5.0), (0.4, 0.8, 1.6), (0.7, 1.4)),
)


def least(damper: ParticleDamper, low: float, high: float) -> float:
    """Damping ratio that a ball adds at least, held at amplitudes: from the middle, aside, and rolling about it.

    What keeps the amplitude up cycle by cycle pushes a rolling ball aside, which therefore counts for a few cycles.
    """

    def added(amplitude: float, place: float, first: int, last: int, speed: float = 0.0) -> float:
        return float(led(damper, np.full(last, amplitude), place, speed)[first:].mean()) / (2 * math.pi)

    found = [added(amplitude, place, 40, 160) for amplitude in np.geomspace(low, high, 5) for place in (0.0, 0.5)]
    omega, gap = damper.stuck_frequency, damper.half_gap[0]
    for amplitude in np.geomspace(low, high, 33):
        drag = damper.rolling_threshold / (omega**2 * amplitude)  # over the drive's height
        if (turn := -0.5 * math.pi * drag) < -0.5:
            continue
        turn = math.asin(turn)  # phase at which the ball turns, ahead of the crest
        place = 5 / 7 * amplitude / gap * (turn * math.sin(turn) - 0.5 * drag * turn**2 - 1)
        if 5 / 7 * amplitude * math.cos(turn) < gap:
            speed = 5 / 7 * amplitude * omega * (drag * turn - math.sin(turn))
            found.append(added(amplitude, place, 1, 5, speed))
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
            shown[diameter, clearance] = least(damper, *(1e-3 * end for end in ends))
            print(f"  {diameter} mm in {clearance} mm: {100 * shown[diameter, clearance]:.4f} %", flush=True)
        chosen = round(2e3 * best.radius, 6), round(1e3 * (best.cavity[0] - 2 * best.radius), 6)
        print(
            f"e {restitution}: chosen {chosen}, promised {100 * found.optimum.evaluation.value:.4f} %, shown"
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
