"""Many ring-downs from one call, on all cores."""

from __future__ import annotations

import os
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from damper import laws, self_check
from damper.equations import at_once
from damper.model import Floats, Integers, alike, ensemble, resting_place, stuck_frequency, table, whole
from damper.motion import APART, COUPLED, EnergyBooks, flights, kinds, moved_by, outcome_of, prepare
from damper.ringdown import ringdown
from damper.state import BOOKS, COUNTED, SHARED, Counts, Tables

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from damper.model import Harmonic, Parameters, ParticleDamper, Records
    from damper.motion import Flights

    Progress: TypeAlias = Callable[[int], None]


BLOCK = 64
"""Ring-downs that a thread takes at a time: enough to hide the hand-over, few enough to share the work evenly."""


def workers(threads: int | None) -> int:
    """How many threads to use where so many are asked for; None: one for each core."""
    return (os.cpu_count() or 1) if threads is None else whole("threads", threads)


def in_blocks(
    run: Callable[..., None],
    arguments: tuple[Any, ...],
    size: int,
    threads: int,
    progress: Progress | None = None,
    block_size: int = BLOCK,
) -> None:
    """Call a kernel with (begin, end) and its other arguments for all of range(size), block by block on threads.

    First once idly, which compiles: two threads that compile at once would wait for each other anyway.
    """
    if size:
        run((0, 0), *arguments)

    def counted(begin: int) -> int:
        block = (begin, min(begin + block_size, size))
        run(block, *arguments)
        return block[1] - begin

    if threads == 1:  # a pool would take as long as a short sweep
        for begin in range(0, size, block_size):
            done = begin + counted(begin)
            if progress is not None:
                progress(done)
        return
    with ThreadPoolExecutor(threads) as pool:
        pending = {pool.submit(counted, begin) for begin in range(0, size, block_size)}
        done = 0
        try:
            while pending:
                finished, pending = wait(pending, timeout=0.2, return_when=FIRST_EXCEPTION)
                done += sum(future.result() for future in finished)
                if progress is not None:
                    progress(done)
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise


_AT_ONCE = 64 * BLOCK
"""Runs prepared together: 12 kB each."""


@dataclass(frozen=True)
class Batch(Counts[Integers], EnergyBooks[Floats]):
    """What n ring-downs left, with `damper.state.Counts` and `damper.EnergyBooks`; every array has shape (n,).

    Attributes:
        outcome: why each ended.
        duration: simulated time [s].
        peak_sdc: largest specific damping capacity of a cycle [-].
        peak_sdc_amplitude: dynamic acceleration V omega_1 at which that cycle began [m/s^2]; nan without a cycle.
        cutoff: V omega_1 of the last cycle in which the ball moved [m/s^2]; nan if it never moved or never rested.
        largest_rolling_demand: as in `RingDown`; nan without a normal load.
    """

    outcome: npt.NDArray[np.object_]
    duration: Floats
    peak_sdc: Floats
    peak_sdc_amplitude: Floats
    cutoff: Floats
    largest_rolling_demand: Floats


def ringdowns(
    damper: ParticleDamper,
    release: npt.ArrayLike,
    cycles: float | None = None,
    *,
    harmonic: Harmonic | None = None,
    amplitudes: npt.ArrayLike | None = None,
    threads: int | None = None,
    max_cycles: float = 100_000,
    max_events: int = 50_000_000,
    progress: Progress | None = None,
    **varied: npt.ArrayLike,
) -> Batch:
    """Run many ring-downs from rest; each gives bit for bit what `ringdown` gives, on any number of threads.

    Memory does not grow with the number of cycles. Ctrl-C ends the call at the next block of ring-downs.

    Args:
        damper: what the ring-downs have in common.
        release: the structures' displacements along x and y at time 0, shape (n, 2) [m].
        cycles: length of each run in periods 2 pi / omega_1; None: until its ball rests for good.
        harmonic: a force that drives them all; `cycles` must then be given.
        amplitudes: of the damper's modes at time 0, in place of what `release` makes of them, shape (n, modes).
        threads: how many to use; None: one for each core.
        max_cycles: cap where `cycles` is None.
        max_events: cap on the events of each run.
        progress: called now and then with the number of ring-downs done.
        varied: fields of `ParticleDamper` that differ, each of shape (n,) or, for those along x and y, (n, 2); a
            `floor_radius` of inf is a flat floor.

    Raises:
        ValueError: a wrong shape, an unknown field, or a value without physical sense.
    """
    cores = workers(threads)
    displacement = table("release", release)
    if displacement.ndim != 2 or displacement.shape[1] != 2:
        raise ValueError(f"release must have shape (n, 2), got {displacement.shape}")
    start = np.zeros((len(displacement), 5, 2))
    start[:, 0] = displacement
    modal = None
    if amplitudes is not None:
        modal, start[:, 0] = moved_by(damper, amplitudes, len(start))
    rows = ensemble(damper.parameters, len(displacement), varied)
    start[:, 2] = resting_place(rows)
    prepared = prepare(rows, start, cycles, max_cycles, harmonic)
    most, kind = whole("max_events", max_events), kinds(damper, rows, harmonic)
    status, done = np.zeros(len(rows), np.int64), 0
    for which in _parts(damper, rows, kind):
        f = flights(damper, rows[which], prepared[which], harmonic, None if modal is None else modal[which])
        status[which] = _followed(f, most, cores, further(progress, done))
        prepared[which] = f.runs[SHARED]
        done += len(which)
    batch = _summary(rows, prepared, status, fixed_cycles=cycles is not None)
    velocity = np.maximum(prepared["clock"]["first_speed"], prepared["cycle"]["last_speed"])
    extremes = laws.Extremes(kind, prepared["axes"]["excursion"], velocity, 0.0, harmonic is not None)
    laws.check_ringdowns(damper, rows, batch, extremes)
    self_check.once("ring-downs", ringdown)
    return batch


def _parts(damper: ParticleDamper, rows: Parameters, kind: Integers) -> Iterator[Integers]:
    """Which to prepare together: of one kind, and as many as there is room for."""
    modes, equal = 2 if damper.modes is None else len(damper.modes), alike(rows)
    for each in (APART, COUPLED):
        which = np.flatnonzero(kind == each)
        room = _AT_ONCE if equal else at_once(modes, coupled=each == COUPLED)
        yield from (which[k : k + room] for k in range(0, len(which), room))


def _followed(f: Flights, most: int, threads: int, progress: Progress | None) -> Integers:
    """Have ring-downs run to their ends, or to so many events: how each stands then."""
    from damper import engine

    status = np.full(len(f.runs), engine.BEGINS)
    arguments = f.runs, f.systems.flows, Tables(), engine.Ramp(), most, status
    in_blocks(engine.run_block, arguments, len(status), threads, progress)
    laws.check_rest(f.runs)
    return status


def further(progress: Progress | None, before: int) -> Progress | None:
    """The same of a part, before which so many were done."""
    return None if progress is None else lambda done: progress(before + done)


def _summary(rows: Parameters, prepared: Records, status: Integers, *, fixed_cycles: bool) -> Batch:
    from damper.engine import DONE

    clocks, books, cycles = prepared["clock"], prepared["books"], prepared["cycle"]
    omega, load = stuck_frequency(rows), rows["centrifugal_acceleration"]
    rested = np.isfinite(clocks["rest"]) & (clocks["trembles"] != 2)
    rested &= np.isfinite(clocks["last_motion"]) & (cycles["moving_speed"] >= 0)
    demand = prepared["axes"]["demand"].max(axis=1)
    booked: dict[str, Any] = {name: books[name].copy() for name in BOOKS.names or ()}
    counted: dict[str, Any] = {name: clocks[name].copy() for name in COUNTED}
    outcomes = [outcome_of(s == DONE, fixed_cycles, clock) for s, clock in zip(status, clocks, strict=True)]
    return Batch(
        outcome=np.array(outcomes, dtype=object),
        duration=clocks["time"].copy(),
        **booked,
        **counted,
        peak_sdc=cycles["peak_sdc"].copy(),
        peak_sdc_amplitude=np.where(cycles["peak_sdc_speed"] > 0, cycles["peak_sdc_speed"] * omega, np.nan),
        cutoff=np.where(rested, cycles["moving_speed"] * omega, np.nan),
        largest_rolling_demand=np.divide(demand, load, out=np.full_like(load, np.nan), where=load > 0),
    )
