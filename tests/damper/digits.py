"""The digits of `damper.self_check`, by a reference that shares no code with it: `python -m tests.damper.digits`.

Each motion is computed twice, with different samplings, so that what the reference misses shows.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from damper import self_check
from damper.working import SETTLING
from tests.damper.reference import Reference

SAMPLES = (1024, 1500)
"""In a period, of the two."""


def ringdown(name: str, samples: int) -> dict[str, float]:
    """The figures of a ring-down."""
    motion = self_check.RINGDOWNS[name]
    run = Reference(motion.damper, motion.amplitudes or motion.release, motion.cycles, samples, motion.harmonic)
    shares = {"energy left": run.final, "rolling work": run.rolling, "work": run.work}
    return {"hits": run.impacts} | {figure: share / run.initial for figure, share in shares.items()}


def sweeps(name: str, samples: int) -> dict[str, float]:
    """Of sweeps: the structure led down between cycles."""
    sweep, lost = self_check.SWEEPS[name], []
    for n in range(self_check.STARTS):
        first, place = sweep.high * 2 ** ((n + 1) / self_check.STARTS), 1 - n / self_check.STARTS
        lost += descent(sweep, first, place, samples)
    return {"cycles": len(lost), "decrements": math.fsum(lost)}


def descent(sweep: self_check.Sweep, first: float, place: float, samples: int) -> list[float]:
    """A sweep down from an amplitude, as `damper.amplitude_sweep` describes it."""
    damper = sweep.damper
    settling, least = SETTLING, 0.5 * damper.stiffness[0] * sweep.low**2
    cycles = settling + math.ceil(sweep.stay * (math.log2(sweep.high / sweep.low) + 1))
    run = Reference(damper, (first, 0.0), 0.0, samples, place=(place * damper.half_gap[0], 0.0))
    stuck, mode = run.mass[: run.k, : run.k], slice(run.k + 2, 2 * run.k + 2)

    def swing() -> float:
        """Energy of the structure with the ball riding along."""
        return 0.5 * float(run.x[mode] @ stuck @ run.x[mode] + run.spring @ run.x[: run.k] ** 2)

    begun, lost = swing(), []
    for n in range(cycles):
        scale = math.sqrt(begun * 4 ** (-n / sweep.stay) / swing())
        run.x[: run.k] *= scale
        run.x[mode] *= scale
        before, now = run.energy(), swing()
        if now < least:
            break
        run.cycles = n + 1
        run.go_on()
        if n >= settling:
            lost.append(-0.5 * math.log1p((run.energy() - before) / now))
    return lost


def steady(name: str, samples: int) -> dict[str, float]:
    """Of a steady state, once the structure has forgotten how it began."""
    motion = self_check.STEADY[name]
    ratio, settling, parts = motion.damper.stuck_frequency / motion.harmonic.frequency, 240, 500
    run = Reference(motion.damper, (0.0, 0.0), settling * ratio, samples, motion.harmonic)
    impacts, work, seen = run.impacts, run.work, [run.x[0]]
    for k in range(1, parts + 1):
        run.cycles = (settling + k / parts) * ratio
        run.go_on()
        seen.append(run.x[0])
    amplitude = 0.5 * (crest(seen) + crest([-u for u in seen]))
    power = (run.work - work) / (2 * math.pi / motion.harmonic.frequency)
    return {"hits a cycle": run.impacts - impacts, "mean amplitude": amplitude, "power": power}


def crest(u: list[float]) -> float:
    """Largest value of a smooth function by a polynomial through the samples about it."""
    k = int(np.argmax(u))
    x = np.arange(-3, 4)
    p = np.polynomial.Polynomial.fit(x, [u[(k + n) % (len(u) - 1)] for n in x], 6)
    return float(max(p(t.real) for t in p.deriv().roots() if abs(t) < 1))


def main() -> None:
    ways = dict.fromkeys(self_check.RINGDOWNS, ringdown) | dict.fromkeys(self_check.SWEEPS, sweeps)
    ways |= dict.fromkeys(self_check.STEADY, steady)
    for name in sys.argv[1:] or ways:
        for samples in SAMPLES:
            began = time.perf_counter()
            print(f"{name}: {ways[name](name, samples)} in {time.perf_counter() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main()
