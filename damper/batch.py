"""Many ring-downs from one call, on all cores."""

from __future__ import annotations

import functools
import os
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from damper import laws, self_check
from damper.equations import at_once
from damper.model import Floats, Integers, alike, ensemble, resting_place, stuck_frequency, table, whole
from damper.motion import APART, COUPLED, flights, kinds, outcome_of, prepare
from damper.ringdown import ringdown
from damper.state import BOOKS, COUNTED, Counts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from damper.model import Harmonic, Parameters, ParticleDamper, Records

    Progress: TypeAlias = Callable[[int], None]


BLOCK = 64
"""Ring-downs that a thread takes at a time: enough to hide the hand-over, few enough to share the work evenly."""


def in_blocks(
    work: Callable[[tuple[int, int]], None],
    size: int,
    threads: int,
    progress: Callable[[int], None] | None = None,
    block_size: int = BLOCK,
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
class Batch(Counts[Integers]):
    """What n ring-downs left, with the counters of `damper.state.Counts`; every array has shape (n,).

    Attributes:
        outcome: why each ended.
        duration: simulated time [s].
        initial, final: energy of structure and ball [J].
        structure, rolling, impact, slip: energy lost, by cause [J].
        work: energy put in by a harmonic force [J].
        peak_sdc: largest specific damping capacity of a cycle [-].
        peak_sdc_amplitude: dynamic acceleration V omega_1 at which that cycle began [m/s^2]; nan without a cycle.
        cutoff: V omega_1 of the last cycle in which the ball moved [m/s^2]; nan if it never moved or never rested.
        largest_rolling_demand: as in `RingDown`; nan without a normal load.
    """

    outcome: npt.NDArray[np.object_]
    duration: Floats
    initial: Floats
    final: Floats
    structure: Floats
    rolling: Floats
    impact: Floats
    slip: Floats
    work: Floats
    peak_sdc: Floats
    peak_sdc_amplitude: Floats
    cutoff: Floats
    largest_rolling_demand: Floats

    @property
    def residual(self) -> Floats:
        """What the energy books do not explain [J]."""
        lost = self.structure + self.rolling + self.impact + self.slip
        residual: Floats = self.initial - self.final - lost + self.work
        return residual


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
    workers = (os.cpu_count() or 1) if threads is None else whole("threads", threads)
    displacement = table("release", release)
    if displacement.ndim != 2 or displacement.shape[1] != 2:
        raise ValueError(f"release must have shape (n, 2), got {displacement.shape}")
    start = np.zeros((len(displacement), 5, 2))
    start[:, 0] = displacement
    if harmonic is not None and cycles is None:
        raise ValueError("cycles must be given where a harmonic force drives the motion: it never comes to rest")
    modal = None if amplitudes is None else _amplitudes(damper, amplitudes, start)
    rows = ensemble(damper.parameters, len(displacement), varied)
    start[:, 2] = resting_place(rows)
    prepared = prepare(rows, start, cycles, max_cycles)
    run = _Run(damper, harmonic, modal, workers, whole("max_events", max_events))
    kind = kinds(damper, rows, harmonic)
    status, initial, final = run.by_kinds(kind, rows, prepared, progress)
    batch = _summary(rows, prepared, status, (initial, final), fixed_cycles=cycles is not None)
    velocity = np.maximum(prepared["clock"]["first_speed"], prepared["cycle"]["last_speed"])
    extremes = laws.Extremes(kind, prepared["axes"]["excursion"], velocity, 0.0, harmonic is not None)
    laws.check_ringdowns(damper, rows, batch, extremes)
    self_check.once("ring-downs", ringdown)
    return batch


@dataclass(frozen=True)
class _Run:
    """What the ring-downs of a batch have in common."""

    damper: ParticleDamper
    harmonic: Harmonic | None
    amplitudes: Floats | None
    threads: int
    most: int

    def of_one_kind(
        self, rows: Parameters, p: Records, progress: Progress | None, amplitudes: Floats | None
    ) -> tuple[Integers, Floats, Floats]:
        """Have ring-downs of one kind run: why each ended, and its energy at the beginning and at the end."""
        from damper import engine
        from damper.state import nothing_kept

        f = flights(self.damper, rows, p, self.harmonic, amplitudes)
        initial, status = f.energy(rows), np.full(len(p), engine.BEGINS)
        tables, ramp = nothing_kept(), engine.no_ramp()

        def work(block: tuple[int, int]) -> None:
            engine.run_block(block, f.runs, f.systems.flows, tables, ramp, self.most, status)

        in_blocks(work, len(status), self.threads, progress)
        p[:] = f.state()
        laws.check_rest(f.runs)
        return status, initial, f.energy(rows)

    def by_kinds(
        self, kind: Integers, rows: Parameters, prepared: Records, progress: Progress | None
    ) -> tuple[Integers, Floats, Floats]:
        """Each kind of flight by itself."""
        status, initial, final, done = np.zeros(len(kind), np.int64), np.zeros(len(kind)), np.zeros(len(kind)), 0
        for which in self._parts(kind, rows):
            part = prepared[which]
            count = None if progress is None else functools.partial(_further, progress, done)
            modal = None if self.amplitudes is None else self.amplitudes[which]
            status[which], initial[which], final[which] = self.of_one_kind(rows[which], part, count, modal)
            prepared[which] = part
            done += len(which)
        return status, initial, final

    def _parts(self, kind: Integers, rows: Parameters) -> Iterator[Integers]:
        """Which to prepare together: of one kind, and as many as there is room for."""
        modes, equal = 2 if self.damper.modes is None else len(self.damper.modes), alike(rows)
        for each in (APART, COUPLED):
            which = np.flatnonzero(kind == each)
            room = _AT_ONCE if equal else at_once(modes, coupled=each == COUPLED)
            yield from (which[k : k + room] for k in range(0, len(which), room))


def _amplitudes(damper: ParticleDamper, amplitudes: npt.ArrayLike, start: Floats) -> Floats:
    """Amplitudes of the modes, shape (n, k), the cavity's displacement by them filled into the start."""
    modal = table("amplitudes", amplitudes)
    count = len(damper.modes or ())
    if not count or modal.shape != (len(start), count):
        raise ValueError(f"amplitudes must have shape {(len(start), count)}, got {modal.shape}")
    start[:, 0] = modal @ np.array([mode.shape for mode in damper.modes or ()])
    return modal


def _further(progress: Progress, before: int, done: int) -> None:
    progress(before + done)


def _summary(
    rows: Parameters, prepared: Records, status: Integers, energies: tuple[Floats, Floats], *, fixed_cycles: bool
) -> Batch:
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
        initial=energies[0],
        final=energies[1],
        **booked,
        **counted,
        peak_sdc=cycles["peak_sdc"].copy(),
        peak_sdc_amplitude=np.where(cycles["peak_sdc_speed"] > 0, cycles["peak_sdc_speed"] * omega, np.nan),
        cutoff=np.where(rested, cycles["moving_speed"] * omega, np.nan),
        largest_rolling_demand=np.divide(demand, load, out=np.full_like(load, np.nan), where=load > 0),
    )
