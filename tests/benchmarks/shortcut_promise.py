"""The short way to an amplitude at resonance (`damper.backbone`) beside the steady state of the motion, at random.

    python -m tests.benchmarks.shortcut_promise [how many] [first seed]

Each scene is driven at the frequency that free vibration has at the largest amplitude which the short way promises.
What the motion then comes to from three starts is held against the nearest of the answers promised there.
"""

import itertools
import math
import sys
from dataclasses import dataclass, replace

import numpy as np

from damper import Harmonic, ParticleDamper, Regime, backbone, forced


@dataclass(frozen=True)
class Point:
    """One steady state beside what was promised."""

    seed: int
    regime: Regime
    hits: float
    held: float  # cut-off over half the clearance
    size: float  # amplitude over half the clearance
    mass_ratio: float
    answers: int
    off: float  # promised over true, less 1
    helps: float  # amplitude over the linear answer


def scene(seed: int) -> tuple[ParticleDamper, float]:
    """A damper on a structure of 1 kg and 1 rad/s with the ball stuck, and the height of a force at resonance."""
    rng = np.random.default_rng([seed, 18])
    ball, radius, zeta = 10 ** rng.uniform(-3.5, -1.3), 1e-3, 10 ** rng.uniform(-3, -2)
    gap = 10 ** rng.uniform(-1, 0.5)
    held = rng.choice([0.0, 10 ** rng.uniform(-2, 1.5)], p=[0.15, 0.85])
    share = rng.choice([0.0, rng.uniform(0, 0.8)])
    threshold = held * gap * (1 - share)
    lever = rng.uniform(0.01, 0.2)
    load = threshold / lever if threshold > 0 else rng.choice([0.0, 10.0])
    restitution, rolls = rng.uniform(0.2, 0.9), lever * radius if threshold > 0 else 0.0
    sides = (2 * (radius + gap),) * 2
    damper = ParticleDamper(1.0, (1 + ball,) * 2, ball, radius, sides, load, restitution, 0.3, rolls, zeta)
    if load > 0:
        damper = replace(damper, floor_tilt=(share / load, share / load))
    reach = max(held, 0.3) * gap * 10 ** rng.uniform(0, 1.2)
    return damper, reach * 2 * zeta * math.sqrt(1 + ball)


def held(damper: ParticleDamper) -> float:
    """Cut-off over half the clearance."""
    cutoff = damper.rolling_threshold / damper.stuck_frequency**2 / abs(1 - damper.tilt_share[0])
    return cutoff / damper.half_gap[0]


def points(seed: int) -> list[Point]:
    """The steady states of a scene."""
    damper, force = scene(seed)
    short = backbone(damper)
    nu = short.answers(force)[-1][1]
    promised = np.array([amplitude for amplitude, _ in short.answers(force, nu)])
    found = forced(damper, [Harmonic(nu, (force, 0.0))])
    gap = damper.half_gap[0]
    mass, many, states = damper.ball_mass, len(promised), []
    for regime, hits, size in zip(
        found.regime[0], found.hits_per_cycle[0].tolist(), found.rms[0].tolist(), strict=True
    ):
        off = float(promised[np.argmin(np.abs(np.log(promised / size)))]) / size - 1
        linear = size / float(abs(found.linear[0]))
        states.append(Point(seed, regime, hits, held(damper), size / gap, mass, many, off, linear))
    return states


def told(name: str, some: list[Point]) -> None:
    """A line of the table."""
    off = np.array([abs(p.off) for p in some])
    if off.size:
        worst = some[int(np.argmax(off))]
        print(
            f"{name:44s}{len(off):5d}  median {np.median(off):8.2%}  nine of ten {np.quantile(off, 0.9):8.2%}"
            f"  worst {off.max():8.2%} (scene {worst.seed})"
        )


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    every = [p for seed in range(first, first + count) for p in points(seed)]
    told("all", every)
    for regime in Regime:
        told(regime.value, [p for p in every if p.regime is regime])
    moving = [p for p in every if p.regime is not Regime.LOCKED]
    told("moving", moving)
    edges = [0.0, 1e-9, 0.03, 0.1, 0.3, 1.0, 3.0, math.inf]
    for low, high in itertools.pairwise(edges):
        told(f"cut-off {low:g} to {high:g} half clearances", [p for p in moving if low <= p.held < high])
    for low, high in ((0, 1e-3), (1e-3, 1e-2), (1e-2, 1)):
        told(f"mass ratio {low:g} to {high:g}", [p for p in moving if low <= p.mass_ratio < high])
    trusted = [p for p in moving if p.held >= 0.3 and p.mass_ratio <= 0.01]
    told("held by 0.3 or more, mass ratio up to 0.01", trusted)
    told("all others", [p for p in moving if p not in trusted])
    told("one answer", [p for p in moving if p.answers == 1])
    told("several answers", [p for p in moving if p.answers > 1])


if __name__ == "__main__":
    main()
