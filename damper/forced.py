"""What a harmonic force or a moving base leads to: the steady state, by following the motion until it is there."""

from __future__ import annotations

import functools
import itertools
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from damper import laws, self_check
from damper.arrays import Floats
from damper.blocks import in_blocks
from damper.flows import at_once
from damper.model import ParticleDamper
from damper.modes import Harmonic
from damper.parameters import number, whole
from damper.regime import Forced, summary
from damper.starts import Motions, Start, motions_of, together
from damper.tables import nothing_kept
from damper.tallies import APERIODIC

if TYPE_CHECKING:
    from collections.abc import Callable

_AT_ONCE = 2048
"""Motions prepared together: 14 kB each."""

_BLOCK = 4


def forced(
    damper: ParticleDamper | Sequence[ParticleDamper],
    harmonics: Sequence[Harmonic],
    starts: Sequence[Start] = tuple(Start),
    *,
    probe: Sequence[float] | int = 0,
    accuracy: float = 1e-2,
    max_cycles: int = 100_000,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Forced:
    """Steady states under harmonic forces; the same bits on any number of threads.

    A run is doubled until its second half is steady (`damper.steady` says when); memory does not grow with its length.

    Args:
        damper: what is driven; one for each harmonic, or one for all.
        harmonics: what drives it, n of them.
        starts: where motions begin.
        probe: displacement whose amplitude is followed: the cavity's along x (0) or y (1), or weights of the modes
            (without modes: of x and of y).
        accuracy: to which the mean amplitude of a motion that does not repeat itself must be known, relative.
        max_cycles: cap on the cycles of each run.
        threads: how many to use; None: one for each core.
        progress: called now and then with the number of motions done.

    Raises:
        ValueError: as many dampers as harmonics are asked for; a harmonic that does not move the probe; a value without
            physical sense.
    """
    dampers = [damper] * len(harmonics) if isinstance(damper, ParticleDamper) else list(damper)
    if len(dampers) != len(harmonics) or not dampers:
        raise ValueError(f"dampers must be as many as harmonics, at least one; got {len(dampers)} and {len(harmonics)}")
    if not 0 < number("accuracy", accuracy) < 1:
        raise ValueError(f"accuracy must be between 0 and 1, got {accuracy:g}")
    columns = tuple(Start(start) for start in starts)
    if not columns:
        raise ValueError("starts must be at least one")
    workers = (os.cpu_count() or 1) if threads is None else whole("threads", threads)
    how = _How(columns, probe, accuracy, whole("max_cycles", max_cycles), workers)
    modes = max(2 if one.modes is None else len(one.modes) for one in dampers)
    size, parts = max(1, min(_AT_ONCE // len(columns), at_once(modes, coupled=True))), []
    for begin in range(0, len(dampers), size):
        here = slice(begin, begin + size)
        done = begin * len(columns)
        count = None if progress is None else functools.partial(_further, progress, done)
        parts.append(_part(dampers[here], harmonics[here], begin, how, count))
    self_check.once("forced", forced)
    return Forced(columns, **{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def _further(progress: Callable[[int], None], before: int, done: int) -> None:
    progress(before + done)


class _How(NamedTuple):
    """What all motions of a call have in common."""

    starts: tuple[Start, ...]
    probe: Sequence[float] | int
    accuracy: float
    most: int
    threads: int


def _part(
    dampers: Sequence[ParticleDamper],
    harmonics: Sequence[Harmonic],
    first: int,
    how: _How,
    progress: Callable[[int], None] | None,
) -> dict[str, npt.NDArray[Any]]:
    """The fields of `Forced` for some of the points, the first of them numbered so."""
    from damper import steady

    groups, at = [], 0
    for _, same in itertools.groupby(dampers, key=id):
        one = list(same)
        here = harmonics[at : at + len(one)]
        groups.append(motions_of(one[0], here, how.starts, how.probe, first + at, how.most))
        at += len(one)
    m, tables = together(groups), nothing_kept()

    def work(block: tuple[int, int]) -> None:
        steady.run_block(block, m.runs, m.flows, tables, how.accuracy, how.most)

    in_blocks(work, len(m.runs), how.threads, progress, _BLOCK)
    shape = len(dampers), len(how.starts)
    figures = summary(m, _divergence(m, how.threads))
    laws.check_steady_states(m, figures)
    shaped = {name: value.reshape(shape) for name, value in figures.items()}
    return shaped | {name: getattr(m, name).reshape(shape)[:, 0] for name in ("linear", "without", "moves_from")}


def _divergence(m: Motions, threads: int) -> Floats:
    """Exponents of the motions that do not repeat themselves, nan of the others."""
    from damper import steady

    exponents = np.full(len(m.runs), np.nan)
    which = np.flatnonzero(m.runs["envelope"]["verdict"] == APERIODIC)
    pairs, growth, tables = np.stack([m.runs[which]] * 2, axis=1), np.full(len(which), np.nan), nothing_kept()
    motions = pairs["run"]["motion"]
    structure = 1 - np.eye(motions["z"].shape[-1])[pairs["run"]["system"]["place"][:, 0]].sum(axis=1)
    for name in ("z", "rate"):
        motions[name][:, 1] *= 1 + steady.NUDGE * structure

    def work(block: tuple[int, int]) -> None:
        steady.run_together(block, pairs, m.flows, tables, growth)

    in_blocks(work, len(which), threads, None, _BLOCK)
    exponents[which] = growth
    return exponents
