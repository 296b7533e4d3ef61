"""Many ring-downs from one call, on all cores."""

from __future__ import annotations

import os
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from damper.arrays import Floats, Integers
from damper.parameters import energy, ensemble, stuck_frequency, table, whole
from damper.prepare import Prepared, prepare
from damper.records import EVENT
from damper.ringdown import outcome_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from damper.model import ParticleDamper
    from damper.parameters import Parameters

_BLOCK = 64
"""Ring-downs that a thread takes at a time: enough to hide the hand-over, few enough to share the work evenly."""


@dataclass(frozen=True)
class Batch:
    """What n ring-downs left; every array has shape (n,).

    Attributes:
        outcome: why each ended.
        duration: simulated time [s].
        impacts: number of wall hits.
        events: number of events of any kind.
        initial, final: energy of structure and ball [J].
        structure, rolling, impact, slip: energy lost, by cause [J].
        peak_sdc: largest specific damping capacity of a cycle [-].
        peak_sdc_amplitude: dynamic acceleration V omega_1 at which that cycle began [m/s^2]; nan without a cycle.
        cutoff: V omega_1 of the last cycle in which the ball moved [m/s^2]; nan if it never moved or never rested.
        largest_rolling_demand: as in `RingDown`; nan without a normal load.
    """

    outcome: npt.NDArray[np.object_]
    duration: Floats
    impacts: Integers
    events: Integers
    initial: Floats
    final: Floats
    structure: Floats
    rolling: Floats
    impact: Floats
    slip: Floats
    peak_sdc: Floats
    peak_sdc_amplitude: Floats
    cutoff: Floats
    largest_rolling_demand: Floats

    @property
    def residual(self) -> Floats:
        """What the energy books do not explain [J]."""
        residual: Floats = self.initial - self.final - self.structure - self.rolling - self.impact - self.slip
        return residual


def ringdowns(
    damper: ParticleDamper,
    release: npt.ArrayLike,
    cycles: float | None = None,
    *,
    threads: int | None = None,
    max_cycles: float = 100_000,
    max_events: int = 50_000_000,
    progress: Callable[[int], None] | None = None,
    **varied: npt.ArrayLike,
) -> Batch:
    """Run many ring-downs from rest; each gives bit for bit what `ringdown` gives, on any number of threads.

    Memory does not grow with the number of cycles. Ctrl-C ends the call at the next block of ring-downs.

    Args:
        damper: what the ring-downs have in common.
        release: the structures' displacements along x and y at time 0, shape (n, 2) [m].
        cycles: length of each run in periods 2 pi / omega_1; None: until its ball rests for good.
        threads: how many to use; None: one for each core.
        max_cycles: cap where `cycles` is None.
        max_events: cap on the events of each run.
        progress: called now and then with the number of ring-downs done.
        varied: fields of `ParticleDamper` that differ, each of shape (n,) or, for those along x and y, (n, 2).

    Raises:
        ValueError: a wrong shape, an unknown field, or a value without physical sense.
    """
    workers = (os.cpu_count() or 1) if threads is None else whole("threads", threads)
    displacement = table("release", release)
    if displacement.ndim != 2 or displacement.shape[1] != 2:
        raise ValueError(f"release must have shape (n, 2), got {displacement.shape}")
    start = np.zeros((len(displacement), 5, 2))
    start[:, 0] = displacement
    rows = ensemble(damper.parameters, len(displacement), varied)
    prepared = prepare(rows, start, cycles, max_cycles)
    status = _run(prepared, workers, whole("max_events", max_events), progress)
    return _summary(rows, prepared, status, asked=cycles is not None)


def _run(prepared: Prepared, threads: int, max_events: int, progress: Callable[[int], None] | None) -> Integers:
    """Have every ring-down run, block by block on a pool of threads; the compiled engine needs no lock."""
    from damper import engine

    status = np.zeros(len(prepared.clocks), np.int64)
    tables = (np.zeros((0, 2)), np.zeros(0, EVENT))
    p = prepared

    def work(block: tuple[int, int]) -> None:
        engine.run_block(block, p.clocks, p.axes, p.laws, p.balls, p.books, p.cycles, tables, max_events, status)

    in_blocks(work, len(status), threads, progress)
    return status


def in_blocks(
    work: Callable[[tuple[int, int]], None],
    size: int,
    threads: int,
    progress: Callable[[int], None] | None = None,
    block_size: int = _BLOCK,
) -> None:
    """Call `work` with (begin, end) for all of range(size), block by block on a pool of threads; first once idly.

    The idle call compiles: two threads that compile at once would wait for each other anyway.
    """
    if size:
        work((0, 0))

    def counted(begin: int) -> int:
        block = (begin, min(begin + block_size, size))
        work(block)
        return block[1] - begin

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


def _summary(rows: Parameters, prepared: Prepared, status: Integers, *, asked: bool) -> Batch:
    from damper import engine

    clocks, books, cycles = prepared.clocks, prepared.books, prepared.cycles
    omega, load = stuck_frequency(rows), rows["centrifugal_acceleration"]
    rested = np.isfinite(clocks["rest"]) & (clocks["trembles"] != 2)
    rested &= np.isfinite(clocks["last_motion"]) & (cycles["moving_speed"] >= 0)
    demand = prepared.axes["demand"].max(axis=1)
    losses: dict[str, Any] = {name: books[name].copy() for name in ("structure", "rolling", "impact", "slip")}
    outcomes = [outcome_of(s == engine.DONE, asked, clock) for s, clock in zip(status, clocks, strict=True)]
    return Batch(
        outcome=np.array(outcomes, dtype=object),
        duration=clocks["time"].copy(),
        impacts=clocks["impacts"].copy(),
        events=clocks["events"].copy(),
        initial=prepared.initial,
        final=energy(rows, prepared.axes),
        **losses,
        peak_sdc=cycles["peak_sdc"].copy(),
        peak_sdc_amplitude=np.where(cycles["peak_sdc_speed"] > 0, cycles["peak_sdc_speed"] * omega, np.nan),
        cutoff=np.where(rested, cycles["moving_speed"] * omega, np.nan),
        largest_rolling_demand=np.divide(demand, load, out=np.full_like(load, np.nan), where=load > 0),
    )
