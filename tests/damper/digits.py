"""The digits of `damper.self_check`, by integrators that share no code with it: `python -m tests.damper.digits`.

Each motion is computed twice, with different steps, so that what an integration gets wrong shows. Takes some minutes.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from damper import self_check
from damper.working import SETTLING
from tests.damper.lagrangian import Lagrangian
from tests.damper.reference import Reference

STEPS = (math.inf, 0.05)
"""Longest steps of the two integrations [s]; the dampers are of unit size."""


def ringdown(name: str, step: float) -> dict[str, float]:
    """By matrix exponentials, `step` in cycles, on level floors; else from the Lagrangian."""
    motion = self_check.RINGDOWNS[name]
    if name in self_check.LEVEL:
        exact = Reference(motion.damper, motion.release, motion.cycles, round(1 / step))
        left, rolling = exact.final / exact.initial, exact.rolling / exact.initial
        return {"hits": exact.impacts, "energy left": left, "rolling work": rolling}
    end = motion.cycles * 2 * math.pi / motion.damper.stuck_frequency
    release = np.array(motion.amplitudes or motion.release)
    run = Lagrangian(motion.damper, release, end, motion.harmonic, step, sys.maxsize)
    hits = sum(kind == "hit" for _, _, kind in run.events)
    return {"hits": hits, "energy left": run.final / run.initial, "work": float(run.work) / run.initial}


def sweeps(name: str, step: float) -> dict[str, float]:
    """From the Lagrangian, the structure led down between cycles."""
    sweep, lost = self_check.SWEEPS[name], []
    for n in range(self_check.STARTS):
        first, place = sweep.high * 2 ** ((n + 1) / self_check.STARTS), 1 - n / self_check.STARTS
        lost += descent(sweep, first, place, step)
    return {"cycles": len(lost), "decrements": math.fsum(lost)}


def descent(sweep: self_check.Sweep, first: float, place: float, step: float) -> list[float]:
    """A sweep down from an amplitude, as `damper.amplitude_sweep` describes it."""
    damper = sweep.damper
    period = 2 * math.pi / damper.stuck_frequency
    settling, least = SETTLING, 0.5 * damper.stiffness[0] * sweep.low**2
    cycles = settling + math.ceil(sweep.stay * (math.log2(sweep.high / sweep.low) + 1))
    run = Lagrangian(damper, np.array([first, 0.0]), 0.0, None, step, sys.maxsize, (place * damper.half_gap[0], 0.0))
    stuck, mode = run.mass[: run.k, : run.k], slice(run.k + 2, 2 * run.k + 2)

    def swing() -> float:
        """Energy of the structure with the ball riding along."""
        return 0.5 * float(run.y[mode] @ stuck @ run.y[mode] + run.spring @ run.y[: run.k] ** 2)

    begun, lost = swing(), []
    for n in range(cycles):
        scale = math.sqrt(begun * 4 ** (-n / sweep.stay) / swing())
        run.y[: run.k] *= scale
        run.y[mode] *= scale
        before, now = run.energy(), swing()
        if now < least:
            break
        run.end = (n + 1) * period
        run.go_on()
        if n >= settling:
            lost.append(-0.5 * math.log1p((run.energy() - before) / now))
    return lost


def steady(name: str, step: float) -> dict[str, float]:
    """From the Lagrangian, once the structure has forgotten how it began."""
    motion = self_check.STEADY[name]
    period, settling, parts = 2 * math.pi / motion.harmonic.frequency, 240, 500
    run = Lagrangian(motion.damper, np.zeros(2), settling * period, motion.harmonic, step, sys.maxsize)
    events, work, seen = len(run.events), run.y[-1], [run.y[0]]
    for k in range(1, parts + 1):
        run.end = (settling + k / parts) * period
        run.go_on()
        seen.append(run.y[0])
    hits = sum(kind == "hit" for _, _, kind in run.events[events:])
    amplitude = 0.5 * (crest(seen) + crest([-u for u in seen]))
    return {"hits a cycle": hits, "mean amplitude": amplitude, "power": float(run.y[-1] - work) / period}


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
        for step in (1 / 1024, 1 / 1500) if name in self_check.LEVEL else STEPS:
            began = time.perf_counter()
            print(f"{name}: {ways[name](name, step)} in {time.perf_counter() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main()
