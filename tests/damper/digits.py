"""The digits of `damper.self_check`, by a reference that shares no code with it: `python -m tests.damper.digits`.

Each motion is computed twice, with different samplings, so that what the reference misses shows.
"""

import itertools
import math
import sys
import time
from collections.abc import Iterator

import numpy as np

from damper import ParticleDamper, self_check
from damper.curve_measurement import SETTLING
from tests.damper.reference import Reference

SAMPLES = (1024, 1500)
"""In a period, of the two."""


def ringdown(name: str, samples: int) -> dict[str, float]:
    """The figures of a ring-down."""
    damper, given, _ = self_check.RINGDOWNS[name]
    release = given.get("amplitudes", given["release"])
    run = Reference(damper, release, given["cycles"], samples, given.get("harmonic"))
    shares = {"energy left": run.final, "rolling work": run.rolling, "work": run.work}
    return {"hits": run.impacts} | {figure: share / run.initial for figure, share in shares.items()}


def sweeps(name: str, samples: int) -> dict[str, float]:
    """Of sweeps: the structure led down between cycles."""
    damper, given, _ = self_check.SWEEPS[name]
    lost = [each for _, each in descents(damper, samples, given["high"], given["low"], given["sweeps"], given["stay"])]
    return {"cycles": len(lost), "decrements": math.fsum(lost)}


def descents(
    damper: ParticleDamper, samples: int, high: float, low: float, sweeps: int, stay: int
) -> list[tuple[float, float]]:
    """Amplitude and decrement of each cycle of sweeps down, as `damper.engine.Ramp` describes it."""
    cycles, found = SETTLING + math.ceil(stay * (math.log2(high / low) + 1)), []
    for n in range(sweeps):
        each = ramp(damper, high * 2 ** ((n + 1) / sweeps), 1 - n / sweeps, 4 ** (-1 / stay), samples)
        reached = itertools.takewhile(lambda cycle: cycle[0] >= low, itertools.islice(each, cycles))
        found += list(reached)[SETTLING:]
    return found


def ramp(
    damper: ParticleDamper, first: float, place: float, factor: float, samples: int, speed: float = 0.0
) -> Iterator[tuple[float, float]]:
    """Amplitude and decrement of each cycle where the structure's energy changes by a factor from one to the next.

    The ball begins at a share of half the clearance, at rest or rolling.
    """
    run = Reference(damper, (first, 0.0), 0.0, samples, place=(place * damper.half_gap[0], 0.0))
    if speed:
        run.x[run.w[0]] = run.x[run.spin[0]] = speed
        run.roll(0, int(math.copysign(1, speed)))
    stuck, mode = run.mass[: run.k, : run.k], slice(run.k + 2, 2 * run.k + 2)

    def swing() -> float:
        """Energy of the structure with the ball riding along."""
        return 0.5 * float(run.x[mode] @ stuck @ run.x[mode] + run.spring @ run.x[: run.k] ** 2)

    begun = swing()
    for n in itertools.count():
        scale = math.sqrt(begun * factor**n / swing())
        run.x[: run.k] *= scale
        run.x[mode] *= scale
        before, now = run.final, swing()
        run.cycles = n + 1
        run.go_on()
        amplitude = math.sqrt(2 * now / damper.stiffness[0])
        yield amplitude, -0.5 * math.log1p((run.final - before) / now)


def damping_curve(name: str, samples: int) -> dict[str, float]:
    """What is read off the curve of sweeps at the slowest pace, as the fields of `DampingCurve` are described."""
    damper, given, _ = self_check.CURVES[name]
    gap = damper.half_gap[0]
    square = damper.stiffness[0] / (damper.modal_mass + damper.ball_mass)
    held = abs(square - damper.centrifugal_acceleration * damper.floor_tilt[0])
    cutoff = damper.rolling_friction / damper.ball_radius * damper.centrifugal_acceleration / held
    high = 8 * gap * square / held
    place, ratio = binned(descents(damper, samples, high, cutoff, given["sweeps"], 4 * given["stay"]))
    best = ratio.index(max(ratio))
    peak, amplitude = ratio[best], 2 ** place[best]
    crossed = [k for k in range(len(ratio) - 1) if (ratio[k] > peak / 2) != (ratio[k + 1] > peak / 2)]
    below, above = max(k for k in crossed if k < best), min(k for k in crossed if k >= best)
    ends = []
    for k in (below, above):
        x, y = place[k : k + 2], ratio[k : k + 2]
        ends.append(2 ** (x[0] + (x[1] - x[0]) * (peak / 2 - y[0]) / (y[1] - y[0])))
    return {"cut-off": cutoff, "peak": peak, "amplitude of the peak": amplitude} | {
        "half below": ends[0],
        "half above": ends[1],
    }


def binned(cycles: list[tuple[float, float]]) -> tuple[list[float], list[float]]:
    """Mean octave and damping ratio in twelfths of an octave in which more than a cycle was spent.

    A cycle counts in each by the share of its way, in octaves, that lies there.
    """
    totals: dict[int, list[float]] = {}
    for amplitude, decrement in cycles:
        high = math.log2(amplitude)
        way = decrement / math.log(2)
        low, high = min(high - way, high), max(high - way, high)
        for k in range(math.floor(12 * low), math.floor(12 * high) + 1):
            begin, end = max(low, k / 12), min(high, (k + 1) / 12)
            share = (end - begin) / (high - low) if way else 1.0
            if share > 0:
                of = totals.setdefault(k, [0.0, 0.0, 0.0])
                of[0] += share
                of[1] += share * (begin + end) / 2
                of[2] += share * decrement / (2 * math.pi)
    kept = [totals[k] for k in sorted(totals) if totals[k][0] > 1]
    return [place / time for time, place, _ in kept], [lost / time for time, _, lost in kept]


def steady(name: str, samples: int) -> dict[str, float]:
    """Of a steady state, once the structure has forgotten how it began."""
    damper, given, _ = self_check.STEADY[name]
    (harmonic,) = given["harmonics"]
    ratio, settling, parts = damper.stuck_frequency / harmonic.frequency, 240, 500
    run = Reference(damper, (0.0, 0.0), settling * ratio, samples, harmonic)
    impacts, work, seen = run.impacts, run.work, [run.x[0]]
    for k in range(1, parts + 1):
        run.cycles = (settling + k / parts) * ratio
        run.go_on()
        seen.append(run.x[0])
    amplitude = 0.5 * (crest(seen) + crest([-u for u in seen]))
    power = (run.work - work) / (2 * math.pi / harmonic.frequency)
    return {"hits a cycle": run.impacts - impacts, "mean amplitude": amplitude, "power": power}


def crest(u: list[float]) -> float:
    """Largest value of a smooth function by a polynomial through the samples about it."""
    k = int(np.argmax(u))
    x = np.arange(-3, 4)
    p = np.polynomial.Polynomial.fit(x, [u[(k + n) % (len(u) - 1)] for n in x], 6)
    return float(max(p(t.real) for t in p.deriv().roots() if abs(t) < 1))


def main() -> None:
    ways = dict.fromkeys(self_check.RINGDOWNS, ringdown) | dict.fromkeys(self_check.SWEEPS, sweeps)
    ways |= dict.fromkeys(self_check.CURVES, damping_curve)
    ways |= dict.fromkeys(self_check.STEADY, steady)
    for name in sys.argv[1:] or ways:
        for samples in SAMPLES:
            began = time.perf_counter()
            print(f"{name}: {ways[name](name, samples)} in {time.perf_counter() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main()
