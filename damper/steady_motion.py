"""Motion under a harmonic force, followed cycle by cycle until it is steady.

Each cycle begins at time 0, where the force begins anew, so that a motion that repeats itself does so to the last bit.
The run is doubled until its second half, the window, passes:

- the ball rests, and nothing that is left of the structure's own motion can move it again: locked;
- the motion comes back to where it was in the last batch of the window, and what is then left to go, by the rate at
  which it came closer since the middle, is at most `REPEATED`: periodic;
- or it comes no closer and does not calm down, and the window's mean amplitude is known to the accuracy asked for, by
  its standard error, by the drift from its first to its second half, and by the balance of power: aperiodic.

A window is at least as long as the structure takes to forget its own motion.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from damper.compiled import kernel, part
from damper.engine import advance, arrive, earliest, lost, restart, stored
from damper.events import narrowed, stays_stuck
from damper.flight import derivatives
from damper.impacts import let_go
from damper.state import APERIODIC, BATCHES, GOES_ON, LOCKED, NOTHING, PERIODIC, STUCK, TIRED, UNSETTLED

if TYPE_CHECKING:
    from damper.model import Floats, Record, Records
    from damper.state import Tables


@part
def follow(it: Record, begin: float, end: float) -> None:
    """Take the probe's extremes between two times of the same flights, at most a step apart."""
    trace = it.envelope
    u, v = _probed(it, begin)
    _take(trace, u)
    u_end, v_end = _probed(it, end)
    _take(trace, u_end)
    if (v > 0.0) == (v_end > 0.0) or end <= begin:
        return
    low, high, v_low, v_high = begin, end, v, v_end
    for _ in range(60):
        t = high - v_high * (high - low) / (v_high - v_low)
        u, v = _probed(it, t)
        if v == 0.0 or abs(high - low) < 1e-9 * trace.period:
            break
        low, v_low, high, v_high = narrowed(low, v_low, high, v_high, t, v)
    _take(trace, u)


@part
def _take(trace: Record, u: float) -> None:
    trace.high, trace.low = max(trace.high, u), min(trace.low, u)


@part
def _probed(it: Record, time: float) -> tuple[float, float]:
    """The probe's displacement and velocity."""
    system, probe, u, v = it.run.system, it.envelope.probe, 0.0, 0.0
    for g in range(system.groups):
        span, low, c = system.span[g], system.low[g], it.run.motion.series[g]
        x = (time - it.run.motion.start[g]) / span
        for m in range(low, system.high[g]):
            if probe[m] != 0.0:
                gain, rate, _, _ = derivatives(c[m - low], x)
                u += probe[m] * (c[m - low, 0] + gain)
                v += probe[m] * rate / span
    return u, v


@part
def open_tally(tally: Record, it: Record) -> None:
    """Begin to add up."""
    tally.cycles = tally.total = tally.squares = tally.greatest = tally.impacts = 0.0
    tally.least = np.inf
    tally.work, tally.lost, tally.stored = it.run.books.work, lost(it.run.books), stored(it.run)


@part
def add_cycle(tally: Record, amplitude: float, impacts: int) -> None:
    """Add a cycle."""
    tally.cycles += 1.0
    tally.total += amplitude
    tally.squares += amplitude * amplitude
    tally.least, tally.greatest = min(tally.least, amplitude), max(tally.greatest, amplitude)
    tally.impacts += impacts


@part
def add_batch(batch: int, it: Record) -> None:
    """Add the last batch, closed, to the window."""
    window, last, means = it.window, it.last, it.envelope.means
    cycles = last.cycles
    means[0, batch], means[1, batch] = last.total / cycles, last.work / (cycles * it.envelope.period)
    means[2, batch] = last.squares / cycles
    window.cycles += cycles
    window.total += last.total
    window.squares += last.squares
    window.impacts += last.impacts
    window.least, window.greatest = min(window.least, last.least), max(window.greatest, last.greatest)


@part
def close_tally(tally: Record, it: Record) -> None:
    """From what was there at the beginning to what was gained."""
    tally.work, tally.lost = it.run.books.work - tally.work, lost(it.run.books) - tally.lost
    tally.stored = stored(it.run) - tally.stored


@part
def mark(it: Record) -> None:
    """Remember the state."""
    for m in range(it.run.system.coordinates):
        it.envelope.reference[0, m], it.envelope.reference[1, m] = it.run.motion.z[m], it.run.motion.rate[m]
    for i in range(2):
        it.envelope.spin[i] = it.run.axes[i].spin


@part
def distance(it: Record, trace: Record) -> float:
    """Largest difference of the state from the one that a trace remembers, in the coordinates' scales."""
    system, motion, axes = it.run.system, it.run.motion, it.run.axes
    z, rate, spin = trace.reference[0], trace.reference[1], trace.spin
    turn, most = 2.0 * math.pi / trace.period, 0.0
    for m in range(system.coordinates):
        if trace.scale[m] > 0.0:
            most = max(most, abs(motion.z[m] - z[m]) / trace.scale[m])
            most = max(most, abs(motion.rate[m] - rate[m]) / (turn * trace.scale[m]))
    for i in range(2):
        if trace.scale[system.place[i]] > 0.0:
            most = max(most, abs(axes[i].spin - spin[i]) / (turn * trace.scale[system.place[i]]))
    return most


REPEATED = 1e-7
"""Of the linear answer's amplitude: what may be left to go to the orbit that a periodic motion comes to."""

NEARER = 0.5
"""By which a motion that comes to a periodic one must come closer to itself within half a window."""

_CALMER = 0.8
"""By which the variance of the amplitudes of a motion that calms down falls within half a window."""

_ALIKE = 1e-5
"""Share of the mean by which amplitudes may vary in a motion without hits that counts as periodic."""

_STILL = 1e-12
"""Variance over square below which an amplitude is constant, but for rounding."""


@part
def judge(trace: Record, window: Record, length: int, accuracy: float) -> None:
    """The verdict on a window, and the errors of its means."""
    for row in range(2):
        trace.error[row] = _standard_error(trace.means[row])
    half, mean = BATCHES // 2, window.total / window.cycles
    trace.drift = (trace.means[0, half:].sum() - trace.means[0, :half].sum()) / half
    middle, end = trace.near[0], trace.near[1]
    closer = end < NEARER * middle or _calmer(trace.means)
    trace.left = _left(middle, end, 0.5 * length / max(trace.repeats, 1))
    if trace.left <= REPEATED:
        trace.verdict = PERIODIC
    elif not closer and _steady(trace, window, accuracy * mean):
        balanced = abs(window.stored) <= accuracy * abs(window.work)
        trace.verdict = APERIODIC if balanced else GOES_ON
        varied = (window.greatest - window.least) / mean
        if balanced and window.impacts == 0.0 and varied <= _ALIKE:  # only the ball's place creeps
            trace.verdict, trace.left, trace.repeats = PERIODIC, varied, 1


@part
def _calmer(means: Floats) -> bool:
    """Whether the amplitudes of cycles vary less in the second half of the window than in the first."""
    half = BATCHES // 2
    first = means[2, :half].sum() / half - (means[0, :half].sum() / half) ** 2
    second = means[2, half:].sum() / half - (means[0, half:].sum() / half) ** 2
    return bool(second < _CALMER * first and first > _STILL * means[2, 0])


@part
def _left(middle: float, end: float, turns: float) -> float:
    """Way left to an orbit that is come to geometrically; what comes no closer is there, but for rounding."""
    if end >= middle:
        return end
    return end / -math.expm1(math.log(end / middle) / turns) if end > 0.0 else 0.0


@part
def _steady(trace: Record, window: Record, allowed: float) -> bool:
    """Whether the mean amplitude is known so well, and drifts no more than chance explains or than that."""
    error = trace.error[0]
    return bool(error <= allowed and abs(trace.drift) <= max(6.0 * error, allowed))


@part
def _standard_error(means: Floats) -> float:
    """Of the mean of batches that each remember something of the one before."""
    n = len(means)
    mean = means.sum() / n
    square = lagged = 0.0
    for k in range(n):
        square += (means[k] - mean) ** 2
        if k:
            lagged += (means[k] - mean) * (means[k - 1] - mean)
    if square == 0.0:
        return 0.0
    memory = min(max(lagged / square, 0.0), 0.9)
    return math.sqrt(square / (n - 1) / n * (1.0 + memory) / (1.0 - memory))


_MUCH = 0.1
"""By which a motion must come closer to itself after some more cycles for these to be its period."""

_SAME = 1e-10
"""Distance at which a motion is where it was, but for rounding."""

_LONGEST = 64
"""Cycles after which a periodic motion must repeat itself."""

EVENTS = 5000
"""Most events in a cycle; a ball that has more, hardly free to move, is left at that."""

APART, NUDGE, TOGETHER = 1e-4, 1e-9, 512
"""Two motions that begin `NUDGE` apart and are `APART` within so many cycles are chaotic."""


@part
def cycle(it: Record, flow: Floats, tables: Tables) -> bool:
    """Go through one cycle of the force; False where it has too many events."""
    trace, clock, motion = it.envelope, it.run.clock, it.run.motion
    stop, begin = clock.events + EVENTS, 0.0
    trace.high, trace.low = -np.inf, np.inf
    for g in range(it.run.system.groups):
        restart(g, 0.0, it.run, flow)
    while True:
        g = earliest(it.run)
        time = min(motion.next[g], trace.period)
        follow(it, begin, time)
        begin = time
        if time >= trace.period:
            arrive(it.run, time)
            trace.cycles += 1
            return True
        if motion.kind[g] != NOTHING and clock.events >= stop:
            return False
        advance(g, time, it.run, flow, tables)


@kernel
def run_block(block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, accuracy: float, most: int) -> None:
    """Bring the motions from `block[0]` to before `block[1]` to their steady states, one after the other."""
    for k in range(block[0], block[1]):
        if runs[k].envelope.verdict != LOCKED:
            flow = flows[runs[k].run.system.flow]
            let_go(runs[k].run, flow)
            _settle(runs[k], flow, tables, accuracy, most)


@part
def _settle(it: Record, flow: Floats, tables: Tables, accuracy: float, most: int) -> None:
    """Double the run until its second half is steady."""
    trace = it.envelope
    length = trace.patience
    trace.verdict = GOES_ON
    open_tally(it.window, it)
    open_tally(it.last, it)
    for _ in range(length):
        if not _one(it, flow, tables):
            return
    while trace.verdict == GOES_ON:
        if not _look(length, it, flow, tables):
            return
        judge(trace, it.window, length, accuracy)
        length *= 2
        if trace.verdict == GOES_ON and trace.cycles + length > most:
            trace.verdict = UNSETTLED
    if trace.verdict == PERIODIC:
        open_tally(it.last, it)
        for _ in range(trace.repeats):
            if not _one(it, flow, tables):
                return
        close_tally(it.last, it)


@part
def _one(it: Record, flow: Floats, tables: Tables) -> bool:
    """A cycle and its amplitude; False where that settles it."""
    trace = it.envelope
    if _locked(it):
        trace.verdict = LOCKED
        return False
    before = it.run.clock.impacts
    if not cycle(it, flow, tables):
        trace.verdict = TIRED
        return False
    add_cycle(it.last, 0.5 * (trace.high - trace.low), it.run.clock.impacts - before)
    return True


@part
def _look(length: int, it: Record, flow: Floats, tables: Tables) -> bool:
    """Go through a window, batch by batch; False where it ends before."""
    trace = it.envelope
    open_tally(it.window, it)
    for batch in range(BATCHES):
        open_tally(it.last, it)
        mark(it)
        near, repeats, halfway = np.inf, 0, 2 * (batch + 1) % BATCHES == 0
        for n in range(length // BATCHES):
            if not _one(it, flow, tables):
                return False
            if n < _LONGEST and halfway:
                here = distance(it, trace)
                if here < _MUCH * near and near > _SAME:  # a multiple of the period is hardly nearer
                    near, repeats = here, n + 1
        if halfway:
            trace.near[2 * (batch + 1) // BATCHES - 1], trace.repeats = near, repeats
        close_tally(it.last, it)
        add_batch(batch, it)
    close_tally(it.window, it)
    return True


@part
def _locked(it: Record) -> bool:
    """Whether the ball, at rest, will never move again: the structure's own motion dies out."""
    trace, system, motion, axes = it.envelope, it.run.system, it.run.motion, it.run.axes
    for i in range(2):
        if axes[i].regime != STUCK or axes[i].spin != 0.0 or system.damped == 0:
            return False
    for m in range(system.coordinates):
        trace.away[0, m] = motion.z[m] - trace.still[0, m]
        trace.away[1, m] = motion.rate[m] - trace.still[1, m]
    stays = True
    for i in range(2):
        stays = stays and stays_stuck(i, it.run, trace.away[0], trace.away[1], trace.drive[i])
    return stays


@kernel
def run_together(block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, growth: Floats) -> None:
    """Follow pairs of motions, [:, 0] and [:, 1], that begin a nudge apart: their divergence a cycle, shape (n,)."""
    for k in range(block[0], block[1]):
        one, other, flow = runs[k, 0], runs[k, 1], flows[runs[k, 0].run.system.flow]
        apart, cycles = NUDGE, 0
        while cycles < TOGETHER and apart < APART:
            if not (cycle(one, flow, tables) and cycle(other, flow, tables)):
                return
            mark(one)
            apart = distance(other, one.envelope)
            cycles += 1
        growth[k] = math.log(max(apart, 1e-300) / NUDGE) / cycles
