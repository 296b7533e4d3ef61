"""Random flights whose next event is checked by brute force:  python -m tests.damper.flights [how many] [seed]"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import numba as nb
import numpy as np

from damper import ParticleDamper
from damper.engine import restart
from damper.model import ensemble
from damper.motion import flights, prepare
from damper.state import ROLLING, STUCK
from tests.damper.test_linear import scene

SAMPLES = 10_000
SLACK = 1e-12
"""By which a sample may be beyond a guard, of the largest term in it: rounding."""


@nb.njit
def horner(series, x):
    f = 0.0
    for k in range(len(series) - 1, -1, -1):
        f = f * x + series[k]
    return f


@nb.njit
def drive(i, g, it, x):
    """What accelerates a stuck ball against the cavity, from the series of its place."""
    system, c = it.system, it.motion.series[g]
    low, high, span = system.low[g], system.high[g], system.span[g]
    cavity, second = c[high - low + i - system.first[g]], 0.0
    for k in range(len(cavity) - 1, 1, -1):
        second = second * x + k * (k - 1) * cavity[k]
    total = -second / (span * span)
    for m in range(low, high):
        total -= system.pull[i, m] * horner(c[m - low], x)
    return total


@nb.njit
def missed(g, it):
    """Samples before the next event at which one has already happened."""
    system, motion, ball, count, end = it.system, it.motion, it.ball, 0, it.motion.at[g]
    for i in range(system.first[g], system.last[g]):
        axis, s = it.axes[i], motion.series[g, system.place[i] - system.low[g]]
        cavity = motion.series[g, system.high[g] - system.low[g] + i - system.first[g]]
        rate = np.abs(s[1:]).sum()
        for n in range(1, SAMPLES):
            x = end * n / SAMPLES
            if axis.regime == ROLLING:
                position, speed = axis.direction * horner(s, x), 0.0
                for k in range(len(s) - 1, 0, -1):
                    speed = speed * x + axis.direction * k * s[k]
                count += position > axis.half_gap * (1 + SLACK) or speed < -SLACK * rate
            elif axis.regime == STUCK:
                pull = drive(i, g, it, x)
                size = ball.threshold + np.abs(cavity).sum() / system.span[g] ** 2
                outwards = motion.z[system.place[i]] * pull > 0 and abs(motion.z[system.place[i]]) >= axis.half_gap
                count += abs(pull) > ball.threshold * (1 + SLACK) + SLACK * size and not outwards
    return count


def check(runs, flows, found):
    """Begin every flight, and look through it up to its next event."""
    for k in range(len(runs)):
        for g in range(runs[k].system.groups):
            restart(g, 0.0, runs[k], flows[runs[k].system.flow])
            if runs[k].motion.at[g] > 0.0:
                found[k] += missed(g, runs[k])


def soak(flights_asked: int, seed: int = 0) -> tuple[int, int]:
    """How many flights were looked through, and in how many of them an event was missed."""
    rng, done, bad, each = np.random.default_rng(seed), 0, 0, 200
    while done < flights_asked:
        damper, _, _ = scene(int(rng.integers(1 << 30)))
        bad += int((look(replace(damper, floor_friction=None), each, rng) > 0).sum())
        done += each
    return done, bad


def look(damper: ParticleDamper, each: int, rng: np.random.Generator) -> np.ndarray:
    """Random states of one damper: positions anywhere in the cavity, axes rolling or stuck."""
    rows = ensemble(damper.parameters, each, {})
    start = np.zeros((each, 5, 2))
    start[:, :2] = rng.normal(size=(each, 2, 2)) * 10 ** rng.uniform(-2, 1, (each, 1, 1))
    start[:, 2] = rng.uniform(-1, 1, (each, 2)) * np.array(damper.half_gap)
    f = flights(damper, rows, prepare(rows, start, 1.0, 1.0))
    axes, motions = f.runs["axes"], f.runs["motion"]
    speed = rng.normal(size=(each, 2)) * 10 ** rng.uniform(-3, 1, (each, 2)) * rng.integers(0, 2, (each, 2))
    axes["w"] = axes["spin"] = speed
    axes["regime"] = np.where(speed != 0, ROLLING, STUCK)
    axes["direction"] = np.sign(speed)
    for i in range(2):
        motions["rate"][np.arange(each), f.systems.constants["place"][:1, i]] = speed[:, i]
    found = np.zeros(each, np.int64)
    check(f.runs, f.systems.flows, found)
    return found


def main() -> None:
    asked = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
    begin = time.perf_counter()
    done, bad = soak(asked, seed=int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    print(f"{done} flights of {SAMPLES} samples each, {bad} with a missed event, {time.perf_counter() - begin:.0f} s")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
