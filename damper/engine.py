"""The event loop: find the next event, fly to it, resolve it, record it.

`run_block` follows ring-downs, also such as are led through the amplitudes (`Ramp`); `advance` is one turn of the loop,
which `damper.steady_motion` shares. Beside it stand the velocity maxima by which cycles are told apart (`watch`,
`close`), and when a run ends (`end_cycle`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from damper.compiled import fused, inlined, kernel, part
from damper.events import account, narrowed, seek, strongest_drive
from damper.flight import derivatives, expand, spend, travel
from damper.impacts import let_go, read, resolve
from damper.state import HIT, NOTHING, RELEASE, ROLLING, RUB, STUCK

if TYPE_CHECKING:
    from damper.model import Floats, Integers, Record, Records
    from damper.state import Tables


@part
def watch(it: Record, begin: float, end: float) -> bool:
    """Look for the window's largest speed from time `begin` to `end`, on which all axes fly.

    Returns True when the window closed, `cycle.time` and `cycle.speed` then hold the peak; call again with the time
    at which it closed until it returns False.
    """
    cycle = it.cycle
    low, high = max(begin, cycle.opens), min(end, cycle.closes)
    if low <= high:
        pieces = 1 + int(8 * (high - low) / cycle.period)
        t, (f, g) = low, _speed(it, low)
        _take(it, t, f)
        for i in range(pieces):
            t_next = low + (high - low) * (i + 1) / pieces
            f_next, g_next = _speed(it, t_next)
            _take(it, t_next, f_next)
            if g > 0.0 > g_next:
                top = _stationary(it, (t, t_next), (g, g_next))
                _take(it, top, _speed(it, top)[0])
            t, g = t_next, g_next
    return bool(end >= cycle.closes)


@part
def _stationary(it: Record, times: tuple[float, float], slopes: tuple[float, float]) -> float:
    """Zero of the rate between two times of opposite sign, by the Illinois rule."""
    low, high = times
    g_low, g_high = slopes
    t = low
    for _ in range(60):
        t = high - g_high * (high - low) / (g_high - g_low)
        g = _speed(it, t)[1]
        if g == 0.0 or abs(high - low) < 1e-8 * it.cycle.period:
            break
        low, g_low, high, g_high = narrowed(low, g_low, high, g_high, t, g)
    return t


@part
def close(cycle: Record, last_motion: float) -> None:
    """Take the peak just found as the end of a cycle and the start of the next, and open the window after it."""
    first = cycle.last_speed < 0.0
    if not first:
        _tally(cycle, last_motion)
    cycle.last_time = 0.0 if first else cycle.time
    cycle.last_speed = cycle.speed
    cycle.opens = cycle.time + cycle.wait
    cycle.closes = cycle.opens + 0.5 * cycle.period
    cycle.speed = cycle.square = -1.0


@part
def _tally(cycle: Record, last_motion: float) -> None:
    """Keep the largest capacity, and where the ball last moved: it may rest for a while and move again."""
    sdc = 1.0 - (cycle.speed / cycle.last_speed) ** 2 if cycle.last_speed > 0.0 else 0.0
    if sdc > cycle.peak_sdc:
        cycle.peak_sdc, cycle.peak_sdc_speed = sdc, cycle.last_speed
    resume(cycle, last_motion)
    if cycle.last_time <= last_motion:
        cycle.moving_speed = cycle.last_speed
    else:
        cycle.waiting_speed, cycle.waiting_since = cycle.last_speed, last_motion


@part
def resume(cycle: Record, last_motion: float) -> None:
    """If the ball moved after it had rested, the cycles in between count as ones before its last motion."""
    if cycle.waiting_speed >= 0.0 and last_motion > cycle.waiting_since:
        cycle.moving_speed, cycle.waiting_speed = cycle.waiting_speed, -1.0


@part
def _take(it: Record, time: float, square: float) -> None:
    """Take a time and the square of the cavity's speed then for the window's largest, if they are."""
    cycle = it.cycle
    if square > cycle.square:
        cycle.square, cycle.time = square, time
        twice = _twice_the_energy(it, time) / (it.ball.host_mass + it.ball.mass) if it.system.several else square
        cycle.speed = math.sqrt(twice)


@part
def _twice_the_energy(it: Record, time: float) -> float:
    """Of all modes, the ball riding along [J]."""
    system, twice = it.system, 0.0
    for g in range(system.groups):
        span, low, c = system.span[g], system.low[g], it.motion.series[g]
        x = (time - it.motion.start[g]) / span
        for m in range(low, system.high[g]):
            if _of_a_mode(m, system):
                gain, rate, _, _ = derivatives(c[m - low], x)
                q = c[m - low, 0] + gain
                twice += system.spring[m, m] * q * q + system.mass[m, m] * (rate / span) ** 2
                for n in range(low, m):
                    if _of_a_mode(n, system):
                        twice += 2.0 * system.mass[m, n] * rate * derivatives(c[n - low], x)[1] / (span * span)
    return twice


@fused
def _speed(it: Record, time: float) -> tuple[float, float]:
    """Square of the cavity's speed at a time, and half its rate.

    What does not change at an event of the other group is seen once, at its end.
    """
    system, motion, square, rate = it.system, it.motion, 0.0, 0.0
    for g in range(system.groups):
        inverse = 1.0 / system.span[g]
        x = (time - motion.start[g]) * inverse
        for i in range(system.first[g], system.last[g]):
            c, seen = motion.series[g, system.cavity[i]], motion.seen[i]
            if x == 0.0:
                seen[1], seen[2] = c[1], c[2]
            elif seen[0] != time:
                _, seen[1], seen[2], _ = derivatives(c, x)
            seen[0] = time
            v = seen[1] * inverse
            square += v * v
            rate += v * (seen[2] * inverse * inverse)
    return square, rate


DONE, PAUSED, BEGINS = 0, 1, 2
"""How a run stands: at its end, with as many events as may be or a full table, or yet to be released."""

DIED_OUT = 1e-6
"""Share of its first velocity maximum at which a vibration is over, whatever the ball does."""

NEAR = 1.01
"""Acceleration over the rolling threshold at which a ball that rolls next to nothing is taken to tremble there."""

TREMOR = 1e-7
"""Share of the energy that a ball must roll away in a cycle to count as moving, where it hits nothing."""


@part
def end_cycle(it: Record, tables: Tables) -> bool:
    """Keep the velocity maximum just found, see whether motion fades, open the next cycle; False without room."""
    clock, peaks = it.clock, tables.peaks
    if 0 < len(peaks) <= clock.peaks:
        return False
    if len(peaks) > 0:
        peaks[clock.peaks, 0], peaks[clock.peaks, 1] = it.cycle.time, it.cycle.speed
    clock.peaks += 1
    clock.watched = it.cycle.closes
    _fade(it)
    close(it.cycle, clock.last_motion)
    return True


@part
def _fade(it: Record) -> None:
    """At a velocity maximum, end a run soon in which nothing more will happen that counts.

    Either the ball, a cycle long, hit no wall and rolled away next to nothing, on a structure whose largest drive is at
    the threshold: without damping of its own it nears the threshold for ever. Or the vibration has died out.
    """
    clock, ball, speed = it.clock, it.ball, it.cycle.speed
    energy = 0.5 * ball.host_mass * speed * speed
    still = clock.impacts == clock.last_impacts and it.books.rolling - clock.last_rolling <= TREMOR * energy
    if clock.peaks == 1:
        clock.first_speed = speed
    clock.last_impacts, clock.last_rolling = clock.impacts, it.books.rolling
    if clock.rest < np.inf or clock.tail == np.inf:
        return
    if speed <= DIED_OUT * clock.first_speed:
        clock.trembles = 2
        settle_down(clock)
    elif still and ball.threshold > 0.0 and strongest_drive(it) <= NEAR * ball.threshold:
        clock.trembles = 1
        settle_down(clock)


@part
def count(kind: int, clock: Record) -> None:
    """Count an event before the flight to it: the counters of `damper.state.Counts`."""
    clock.events += 1
    if kind == HIT:
        clock.impacts += 1


@part
def settle_down(clock: Record) -> None:
    """End the run a little after the last event."""
    clock.rest = clock.time
    clock.end = min(clock.end, clock.time + clock.tail)


@part
def _release(it: Record, flow: Floats, tables: Tables) -> None:
    """Let go at time 0 from the state in `it.motion`."""
    let_go(it, flow)
    for i in range(2):
        _record(i, RELEASE, it.axes[i].w, it, tables)
    for g in range(it.system.groups):
        restart(g, 0.0, it, flow)
    _rest(it, 0.0)


@part
def restart(g: int, time: float, it: Record, flow: Floats) -> None:
    """Begin the flight that follows an event of a group, or the next step of one, and seek its end."""
    it.motion.start[g] = time
    expand(g, it, flow)
    seek(g, it)


@part
def _run(it: Record, flow: Floats, tables: Tables, most: int) -> int:
    """Go on until the end, for `most` events since the release, or until a table is full."""
    clock, motion = it.clock, it.motion
    while True:
        g = earliest(it)
        time = min(motion.next[g], clock.end)
        while watch(it, clock.watched, time):
            if not end_cycle(it, tables):
                return PAUSED
        clock.watched = time
        if it.axes[0].regime != STUCK or it.axes[1].regime != STUCK:
            clock.last_motion = time
        if time >= clock.end:
            arrive(it, time)
            resume(it.cycle, clock.last_motion)
            clock.time = time
            return DONE
        if motion.kind[g] != NOTHING and (clock.events >= most or 0 < len(tables.rows) < clock.rows + 2):
            return PAUSED
        advance(g, time, it, flow, tables)
        _rest(it, time)


class Ramp(NamedTuple):
    """How n ring-downs are led through the amplitudes, and what they show; `Ramp()`: they are left to themselves.

    After m of its `cycles`, shape (n,), a structure is given `factor**m`, shape (n,), of the energy that it began with,
    whatever the ball took, in the modes that are not damped; the ball's motion in its cavity stays as it is.
    `energies`, shape (n, most cycles, 5) [J], are that of the structure, as far as it is led, the ball counted as
    stuck, before each cycle, and what is left of that by what the ball takes in it; that of structure and ball before
    it, the ball's losses by the books, and what it fed to modes that are damped and is lost there: none while it rests.
    A row stays as it is from where it falls below `least` or there are as many events as may be.
    """

    factor: Floats = np.zeros(0)
    cycles: Integers = np.zeros(0, np.int64)
    least: float = 0.0
    energies: Floats = np.zeros((0, 0, 5))


@kernel
def run_block(
    block: tuple[int, int], runs: Records, flows: Floats, tables: Tables, ramp: Ramp, most: int, status: Integers
) -> None:
    """Run the ring-downs from `block[0]` to before `block[1]`, one after the other; call again to continue.

    `status`: of each, how it stands; with `most` events since its release one is paused.
    """
    for k in range(block[0], block[1]):
        it, flow = runs[k], flows[runs[k].system.flow]
        if status[k] == BEGINS:
            _release(it, flow, tables)
            it.books.initial = stored(it)
        if len(ramp.energies) == 0:
            status[k] = _run(it, flow, tables, most)
            it.books.final = stored(it)
            continue
        energies = ramp.energies[k]
        it.cycle.opens = it.cycle.closes = np.inf  # its amplitudes are known: no velocity maxima are sought
        for n in range(ramp.cycles[k]):
            it.clock.end = (n + 1) * it.cycle.period
            if n > 0:
                _scale(math.sqrt(energies[0, 0] * ramp.factor[k] ** n / _of_the_structure(it)), it, flow)
            _open(it.books)
            before, swing = stored(it), _of_the_structure(it)
            if swing < ramp.least:
                break
            status[k] = _run(it, flow, tables, most)
            if status[k] != DONE:
                break
            own, begun = it.books.structure, n * it.cycle.period
            fed = own if it.clock.last_motion > begun else 0.0
            energies[n, 0], energies[n, 1] = swing, swing - (before - stored(it) - own + fed)
            energies[n, 2], energies[n, 3], energies[n, 4] = before, lost(it.books) - own, fed


@part
def _open(books: Record) -> None:
    """Begin the books anew: what is lost at small amplitudes would drown in what was lost at large ones."""
    books.structure = books.rolling = books.impact = books.slip = 0.0


@part
def _of_a_mode(m: int, system: Record) -> bool:
    """Whether a coordinate is that of a mode, not of the ball in its cavity."""
    return bool(m != system.place[0] and m != system.place[1])


@part
def _led(m: int, system: Record) -> bool:
    """Whether a coordinate is led through the amplitudes: a mode without a dashpot."""
    return bool(_of_a_mode(m, system) and system.dashpot[1, m] == 0.0)


@part
def _scale(scale: float, it: Record, flow: Floats) -> None:
    """Change the motion of what is led, and leave the ball's in its cavity."""
    for m in range(it.system.coordinates):
        if _led(m, it.system):
            it.motion.z[m] *= scale
            it.motion.rate[m] *= scale
    for g in range(it.system.groups):
        if it.motion.next[g] < np.inf:  # nothing moves else
            restart(g, it.clock.time, it, flow)


@part
def _of_the_structure(it: Record) -> float:
    """Energy of the structure, as far as it is led, the ball counted as stuck to it [J]."""
    return 0.5 * _twice_stored(it, 0.0, True)


@part
def _twice_stored(it: Record, twice: float, led: bool) -> float:
    """Twice the energy of masses and springs, of all or of what is led, added to what is there so far [J]."""
    system, motion = it.system, it.motion
    for m in range(system.coordinates):
        for n in range(system.coordinates):
            if not led or (_led(m, system) and _led(n, system)):
                twice += motion.rate[m] * system.mass[m, n] * motion.rate[n]
                twice += motion.z[m] * system.spring[m, n] * motion.z[n]
    return twice


@part
def lost(books: Record) -> float:
    """Energy lost so far [J]."""
    return float(books.structure + books.rolling + books.impact + books.slip)


@part
def stored(it: Record) -> float:
    """Energy of structure and ball [J]."""
    twice = it.ball.spin_mass * (it.axes[0].spin ** 2 + it.axes[1].spin ** 2)
    for i in range(2):
        twice -= 2.0 * it.ball.mass * it.system.lateral[i] * it.motion.z[it.system.place[i]]
    return 0.5 * _twice_stored(it, twice, False)


@part
def earliest(it: Record) -> int:
    """The group whose event, or end of a step, comes next; x before y."""
    return 0 if it.system.groups == 1 or it.motion.next[0] <= it.motion.next[1] else 1


@inlined
def advance(g: int, time: float, it: Record, flow: Floats, tables: Tables) -> None:
    """Fly to a group's next event, or the end of its step, resolve it, start the flights that follow, record it."""
    i, kind, clock, ball = it.motion.axis[g], it.motion.kind[g], it.clock, it.ball
    fly(g, it.motion.at[g], it)
    if kind == NOTHING and it.motion.settled[g] != 0:  # it flies on: there is nothing to seek
        it.motion.start[g], it.motion.next[g] = time, time + it.system.span[g]
        expand(g, it, flow)
        return
    if kind == NOTHING:
        restart(g, time, it, flow)
        return
    axis, other, apart = it.axes[i], it.axes[1 - i], it.system.groups == 2
    clock.time = time
    count(kind, clock)
    leaves = ball.hold > ball.threshold  # its dent, which held it along the other axis too
    if apart and (leaves or (kind == HIT and ball.friction > 0.0 and other.regime != STUCK)):
        fly(1 - g, (time - it.motion.start[1 - g]) / it.system.span[1 - g], it)
    before, sliding = axis.w, other.w
    rubbed = resolve(i, kind, it, flow)
    if rubbed or (kind == HIT and not apart):
        _record(1 - i, RUB, sliding, it, tables)
    if apart and (rubbed or leaves):
        restart(1 - g, time, it, flow)
    restart(g, time, it, flow)
    _record(i, kind, before, it, tables)


@part
def arrive(it: Record, time: float) -> None:
    """Bring all groups to a time, in the middle of their flights."""
    for g in range(it.system.groups):
        fly(g, (time - it.motion.start[g]) / it.system.span[g], it)
        it.motion.start[g] = time


@part
def fly(g: int, x: float, it: Record) -> None:
    """Bring a group x steps on from its start: its state there, and the work done on the way."""
    system, motion, axes = it.system, it.motion, it.axes
    span = system.span[g]
    travel(g, x, it)
    for i in range(system.first[g], system.last[g]):
        if axes[i].regime == ROLLING:
            account(motion.series[g, system.lane[i]], x, span, axes[i], it.ball)
        read(i, it)
        spend(axes[i], motion.gain[system.place[i]], x * span, it.ball, it.books)


@part
def _record(i: int, kind: int, before: float, it: Record, tables: Tables) -> None:
    """Write an event of an axis, whose relative velocity was `before`, and the state of the whole motion, if asked."""
    if len(tables.rows) == 0:
        return
    for m in range(tables.states.shape[2]):
        tables.states[it.clock.rows, 0, m] = it.motion.z[m]
        tables.states[it.clock.rows, 1, m] = it.motion.rate[m]
    row, axis = tables.rows[it.clock.rows], it.axes[i]
    row.time, row.axis, row.kind = it.clock.time, i, kind
    row.u, row.v, row.s, row.w = axis.u, axis.v, axis.s, axis.w
    row.spin, row.regime, row.direction, row.w_before = axis.spin, axis.regime, axis.direction, before
    it.clock.rows += 1


@part
def _rest(it: Record, now: float) -> None:
    """Once nothing will ever happen again, the run ends a little later than the last event."""
    for g in range(it.system.groups):
        if it.motion.settled[g] == 0:
            return
    if it.clock.rest == np.inf:
        settle_down(it.clock)
        it.clock.end = max(it.clock.end, now)
