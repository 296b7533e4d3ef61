"""Steady states under a harmonic force or a moving base, found by following the motion."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from damper import laws, self_check
from damper.batch import further, in_blocks, workers
from damper.equations import at_once
from damper.model import Floats, Harmonic, Integers, ParticleDamper, number, table, whole
from damper.starts import Complex, Motions, Start, go_on, motions_of, together, usual_starts
from damper.state import APERIODIC, DRIVEN, LOCKED, PERIODIC, TIRED, Tables

if TYPE_CHECKING:
    from collections.abc import Callable


class Regime(StrEnum):
    """What a steady state is."""

    LOCKED = "locked"
    PERIODIC = "periodic"
    MODULATED = "modulated"
    CHAOTIC = "chaotic"
    UNSETTLED = "not settled"  # within the cycles allowed, or the events of a cycle: power is nan then


@dataclass(frozen=True, eq=False)
class Forced:
    """Steady states at n points, each from several starts; arrays have shape (n, starts) where they do not say (n,).

    A cycle is one of the force; its amplitude is half of what the cavity's displacement along x, or the probe, goes
    through in it. Figures of a motion that repeats itself are those of its period, all others of the window.

    Attributes:
        starts: of each column.
        regime: a `Regime`: ball at rest (the linear answer in closed form), periodic, modulated, chaotic, not settled.
        repeats: cycles after which a periodic motion repeats itself, 1 for a locked one; 0: it does not.
        hits_per_cycle: wall hits in a cycle, on average.
        least, mean, rms, greatest: of the amplitudes of cycles [m].
        error: of the mean [m]: standard error or half the drift through the window, whichever is larger; of periodic
            motion what is left to go.
        power_in, power_lost: put in by the force; lost to dashpots, hits, rolling and slip [W].
        stored: rate at which the energy of structure and ball changes from the window's start to its end [W].
        power_error: standard error of `power_in` [W].
        divergence: exponent by which two neighbouring motions part a cycle; nan where it was not asked for [-].
        cycles: that were followed.
        linear: complex amplitude with the ball at rest in the middle of its cavity, shape (n,) [m].
        without: complex amplitude without the ball, shape (n,) [m].
        moves_from: by how much the force may grow until the ball cannot stay at rest, shape (n,) [-].
        state: at the end, from which another call may go on, shape (n, starts, 2, N).
    """

    starts: tuple[Start, ...]
    regime: npt.NDArray[np.object_]
    repeats: Integers
    hits_per_cycle: Floats
    least: Floats
    mean: Floats
    rms: Floats
    greatest: Floats
    error: Floats
    power_in: Floats
    power_lost: Floats
    stored: Floats
    power_error: Floats
    divergence: Floats
    cycles: Integers
    linear: Complex
    without: Complex
    moves_from: Floats
    state: Floats

    @property
    def residual(self) -> Floats:
        """What the books of power do not explain [W]."""
        return np.asarray(self.power_in - self.power_lost - self.stored)


def summary(m: Motions, divergence: Floats) -> dict[str, npt.NDArray[Any]]:
    """Figures of all motions, by name."""
    traces = m.runs["envelope"]
    verdict = traces["verdict"]
    still, repeated = verdict == LOCKED, verdict == PERIODIC
    part = np.where(repeated | (verdict == TIRED), m.runs["last"], m.runs["window"])
    height, error, period = np.abs(m.linear), traces["error"], traces["period"]

    def figure(resting: Floats | float, moving: Floats) -> Floats:
        return np.where(still, resting, moving)

    with np.errstate(divide="ignore", invalid="ignore"):
        time = np.where(verdict == TIRED, np.nan, part["cycles"] * period)  # its books are not closed
        mean = part["total"] / part["cycles"]
        unsure = np.maximum(error[:, 0], 0.5 * np.abs(traces["drift"]))
        return {
            "regime": _regimes(verdict, divergence),
            "repeats": np.where(still, 1, np.where(repeated, traces["repeats"], 0)),
            "hits_per_cycle": figure(0.0, part["impacts"] / part["cycles"]),
            "least": figure(height, part["least"]),
            "mean": figure(height, mean),
            "rms": figure(height, np.sqrt(part["squares"] / part["cycles"])),
            "greatest": figure(height, part["greatest"]),
            "error": figure(0.0, np.where(repeated, traces["left"] * height, unsure)),
            "power_in": figure(m.power[:, 0], part["work"] / time),
            "power_lost": figure(m.power[:, 1], part["lost"] / time),
            "stored": figure(0.0, part["stored"] / time),
            "power_error": figure(0.0, np.where(repeated, 0.0, error[:, 1])),
            "divergence": divergence,
            "cycles": traces["cycles"].copy(),
            "state": _states(m, still),
        }


def _states(m: Motions, still: npt.NDArray[np.bool_]) -> Floats:
    """States at the end, shape (n, 2, N); with the ball at rest, when the structure moves as the force has it."""
    motion, place = m.runs["run"]["motion"], m.runs["run"]["system"]["place"]
    found = np.stack([motion["z"], motion["rate"]], axis=1)
    found[still] = m.runs["envelope"]["still"][still]
    np.put_along_axis(found[:, 0], place, np.take_along_axis(motion["z"], place, axis=1), axis=1)
    return found


def _regimes(verdict: Integers, divergence: Floats) -> npt.NDArray[np.object_]:
    from damper import steady_motion

    chaotic = divergence * steady_motion.TOGETHER > math.log(steady_motion.APART / steady_motion.NUDGE)
    known = {LOCKED: Regime.LOCKED, PERIODIC: Regime.PERIODIC, APERIODIC: Regime.MODULATED}
    regimes = [
        Regime.CHAOTIC if parts else known.get(one, Regime.UNSETTLED)
        for one, parts in zip(verdict, chaotic, strict=True)
    ]
    return np.array(regimes, object)


_AT_ONCE = 2048
"""Motions prepared together: 14 kB each."""

_BLOCK = 4


def forced(
    damper: ParticleDamper | Sequence[ParticleDamper],
    harmonics: Iterable[Harmonic],
    starts: Sequence[Start] | None = None,
    *,
    probe: Sequence[float] | int = 0,
    accuracy: float = 1e-2,
    max_cycles: int = 100_000,
    states: Floats | None = None,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Forced:
    """Steady states under harmonic forces; the same bits on any number of threads.

    A run is doubled until its second half is steady (see `damper.steady_motion`); memory does not grow with its length.

    Args:
        damper: what is driven; one for each harmonic, or one for all.
        harmonics: what drives it, n of them.
        starts: where motions begin; None: `UP`, `DOWN` and `RANDOM`, and of hollow floors `RESONANT`.
        probe: displacement whose amplitude is followed: the cavity's along x (0) or y (1), or weights of the modes
            (without modes: of x and of y).
        accuracy: to which the mean amplitude of a motion that does not repeat itself must be known, relative.
        max_cycles: cap on the cycles of each run, but for the end of its window of 64 or more.
        states: in which motions begin instead, shape (n, 2, N): those of `Forced.state` of dampers alike.
        threads: how many to use; None: one for each core.
        progress: called now and then with the number of motions done.

    Raises:
        ValueError: as many dampers as harmonics are asked for; a harmonic that does not move the probe; a value without
            physical sense.
        TypeError: one harmonic stands by itself, not in a sequence.
    """
    if isinstance(harmonics, Harmonic):
        raise TypeError("forced takes a sequence of harmonics: put this one into a list")
    harmonics = list(harmonics)
    dampers = [damper] * len(harmonics) if isinstance(damper, ParticleDamper) else list(damper)
    if len(dampers) != len(harmonics) or not dampers:
        raise ValueError(f"dampers must be as many as harmonics, at least one; got {len(dampers)} and {len(harmonics)}")
    if not 0 < number("accuracy", accuracy) < 1:
        raise ValueError(f"accuracy must be between 0 and 1, got {accuracy:g}")
    columns = usual_starts(dampers[0]) if starts is None else tuple(Start(start) for start in starts)
    begun = None if states is None else table("states", states)
    if begun is not None:
        if begun.shape != (len(dampers), 2, *DRIVEN["run"]["motion"]["z"].shape) or len(columns) != 1:
            raise ValueError(f"states must be two rows for each harmonic, from one start, got shape {begun.shape}")
        if not np.isfinite(begun).all():
            raise ValueError("states must be finite")
    if not columns:
        raise ValueError("starts must be at least one")
    most, cores = whole("max_cycles", max_cycles), workers(threads)
    modes = max(2 if one.modes is None else len(one.modes) for one in dampers)
    size = max(1, min(_AT_ONCE // len(columns), at_once(modes, coupled=True)))

    def part(begin: int) -> dict[str, npt.NDArray[Any]]:
        here = slice(begin, begin + size)
        m = _begun(dampers[here], harmonics[here], columns, probe, begin, most)
        if begun is not None:
            go_on(m, begun[here])
        return _followed(m, accuracy, most, cores, further(progress, begin * len(columns)))

    parts = [part(begin) for begin in range(0, len(dampers), size)]
    self_check.once("forced", forced)
    figures = {name: np.concatenate([each[name] for each in parts]) for name in parts[0]}
    figures = {name: each.reshape(-1, len(columns), *each.shape[1:]) for name, each in figures.items()}
    figures |= {name: figures[name][:, 0] for name in ("linear", "without", "moves_from")}
    return Forced(columns, **figures)


def _begun(
    dampers: Sequence[ParticleDamper],
    harmonics: Sequence[Harmonic],
    starts: tuple[Start, ...],
    probe: Sequence[float] | int,
    first: int,
    longest: int,
) -> Motions:
    """The motions of some of the points at their start, the first of them numbered so."""
    groups, at = [], 0
    for _, same in itertools.groupby(dampers, key=id):
        one = list(same)
        here = harmonics[at : at + len(one)]
        groups.append(motions_of(one[0], here, starts, probe, first + at, longest))
        at += len(one)
    return together(groups)


def _followed(
    m: Motions, accuracy: float, most: int, threads: int, progress: Callable[[int], None] | None
) -> dict[str, npt.NDArray[Any]]:
    """The fields of `Forced` for motions, which are followed to their steady states."""
    from damper import steady_motion

    arguments = m.runs, m.flows, Tables(), accuracy, most
    in_blocks(steady_motion.run_block, arguments, len(m.runs), threads, progress, _BLOCK)
    figures = summary(m, _divergence(m, threads))
    laws.check_steady_states(m, figures)
    return figures | {"linear": m.linear, "without": m.without, "moves_from": m.moves_from}


def _divergence(m: Motions, threads: int) -> Floats:
    """Exponents of the motions that do not repeat themselves, nan of the others."""
    from damper import steady_motion

    exponents = np.full(len(m.runs), np.nan)
    which = np.flatnonzero(m.runs["envelope"]["verdict"] == APERIODIC)
    pairs, growth = np.stack([m.runs[which]] * 2, axis=1), np.full(len(which), np.nan)
    motions = pairs["run"]["motion"]
    structure = 1 - np.eye(motions["z"].shape[-1])[pairs["run"]["system"]["place"][:, 0]].sum(axis=1)
    for name in ("z", "rate"):
        motions[name][:, 1] *= 1 + steady_motion.NUDGE * structure

    arguments = pairs, m.flows, Tables(), growth
    in_blocks(steady_motion.run_together, arguments, len(which), threads, None, _BLOCK)
    exponents[which] = growth
    return exponents
