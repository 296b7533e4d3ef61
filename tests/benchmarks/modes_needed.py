"""How much a structural mode beyond the leading one moves the damping: over its weight at the cavity.

    python -m tests.benchmarks.modes_needed [COUNT] [SEED]
    python -m tests.benchmarks.modes_needed curves [COUNT] [SEED]

Random dampers on a flap mode, with and without a second one that the cavity feels as much, six times as fast. Both are
compared by the energy that the ball takes in a ring-down through the working range, averaged over releases that differ
by a few percent, since hits make single ones chaotic. The weight is the ball's mass over the second mode's there.

With `curves`: what two to seven modes more do to the peak of the damping curve, growing and falling, relatively, over
the energy that a hit feeds into them beside what restitution takes.
"""

import sys
from dataclasses import replace

import numpy as np

from damper import Mode, ParticleDamper, damping_curve, ringdown

RELEASES = 100


def share(damper: ParticleDamper, release: np.ndarray) -> tuple[float, float]:
    """What the ball takes of the initial energy until it rests, and the standard error of it."""
    rest = (0.0,) * (len(damper.modes or ()) - 1)
    books = [ringdown(damper, (0.0, 0.0), amplitudes=(float(x), *rest), max_cycles=2000).energy for x in release]
    part = np.array([(found.rolling + found.impact + found.slip) / found.initial for found in books])
    return float(part.mean()), float(part.std() / np.sqrt(len(part)))


def main(count: int = 40, seed: int = 1) -> None:
    random = np.random.default_rng(seed)
    ratios = []
    for number in range(count):
        mass, zeta = 10 ** random.uniform(-3.5, -1.5), 10 ** random.uniform(-3, -2.3)
        omega, load = 2 * np.pi * 300.0, 10 ** random.uniform(3.5, 5.0)
        cavity, e = (2e-3 + 10 ** random.uniform(-4, -2.5), 2.4e-3), random.uniform(0.2, 0.9)
        lever, modes = 10 ** random.uniform(-5.5, -4), (Mode(1.0, omega**2, (1.0, 0.0)),)
        damper = ParticleDamper(1.0, (omega**2,) * 2, mass, 1e-3, cavity, load, e, 0.0, lever, zeta, modes=modes)
        cutoff = damper.rolling_threshold / omega**2
        top = 4 * max(cutoff, 2 * damper.half_gap[0])
        release = top * np.linspace(0.9, 1.1, RELEASES)
        alone, own = share(damper, release)
        second = Mode(1.0, (6.27 * omega) ** 2, (1.0, 0.0))
        both, other = share(replace(damper, modes=(*(damper.modes or ()), second)), release)
        change, noise = abs(both / alone - 1), 2 * np.hypot(own, other) / alone
        ratios.append((change / mass, noise / mass))
        print(
            f"{number:3d} weight {mass:.1e} zeta {zeta:.1e}: {100 * change:.3f} ± {100 * noise:.3f} %, over the weight"
            f" {change / mass:.2f} ± {noise / mass:.2f}",
            flush=True,
        )
    found = np.array(ratios)
    certain = found[found[:, 0] > found[:, 1]]
    print(f"median {np.median(found[:, 0]):.2f}, greatest beyond its noise {certain[:, 0].max():.2f}")


MORE = ((6.1, 1.02), (16.8, 1.05), (32.0, 1.25), (36.5, 0.78), (44.0, 1.09), (52.0, 0.89), (57.0, 1.08))
"""Frequency and motion of further flap modes of a titanium plate, over the first's."""


def curves(count: int = 40, seed: int = 5) -> None:
    random = np.random.default_rng(seed)
    for _ in range(count):
        mass, omega, load = 10 ** random.uniform(-3, -1.7), 2 * np.pi * 300, 10 ** random.uniform(3.5, 5)
        e, lever, gap = random.uniform(0.1, 0.95), 10 ** random.uniform(-5.5, -4.3), 10 ** random.uniform(-4, -2.7)
        modes = (Mode(1.0, omega**2, (1.0, 0.0)),)
        cavity = (2e-3 + 2 * gap, 2.4e-3)
        few = ParticleDamper(1.0, (omega**2,) * 2, mass, 1e-3, cavity, load, e, 0.0, lever, 0.0, modes=modes)
        more = tuple(Mode(1.0, (r * omega) ** 2, (s, 0.0)) for r, s in MORE[: random.integers(2, 8)])
        before, after = (damping_curve(each, threads=1) for each in (few, replace(few, modes=modes + more)))
        added = mass * sum(mode.shape[0] ** 2 for mode in more)
        ratio = added * (1 + e) / (1 - e) / (1 + mass + added) ** 2
        if before.peak > 0:
            falls = [(curve.from_above or curve).peak for curve in (before, after)]
            up, down, noise = after.peak / before.peak - 1, falls[1] / falls[0] - 1, before.error + after.error
            print(
                f"e {e:.2f}, over restitution {ratio:.3f}: growing {up:+.3f} ± {noise:.3f}, falling {down:+.3f};"
                f" over that {up / ratio:+.2f} ± {noise / ratio:.2f}, {down / ratio:+.2f}",
                flush=True,
            )


if __name__ == "__main__":
    if sys.argv[1:2] == ["curves"]:
        curves(*map(int, sys.argv[2:]))
    else:
        main(*map(int, sys.argv[1:]))
