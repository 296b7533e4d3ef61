"""The damping curve of a damper: equivalent damping ratio against amplitude.

A ring-down tells of one release and of the structure's own damping. What belongs to the damper is how much of the
energy the ball takes in a cycle while the structure, without damping of its own, vibrates along x with an amplitude A
that is held, whatever the ball takes. It is measured on sweeps that come down through all amplitudes, from several
starts, slower where that changes them; what it still changes is in the error.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from damper import laws, self_check
from damper.batch import in_blocks
from damper.damping_curve import BINNED, Working, figures, nothing, spread
from damper.model import inertia_ratio, whole
from damper.motion import CLOSED_FORM, flights, kinds, prepare
from damper.state import nothing_kept

if TYPE_CHECKING:
    from damper.model import Floats, ParticleDamper

SWEEPS, STAY = 16, 120
"""Sweeps through the amplitudes, and cycles that each of them takes for an octave at least."""

_SLOWER = 4
"""By how much sweeps become slower, once, where the pace moves the peak."""

_SAME = 0.03
"""Relative difference of peaks, and of where half of them is left, up to which the pace does not move them."""

SETTLING = 12
"""Cycles that the ball is given to find its motion at the start of a sweep."""

_EVENTS = 2000
"""Most events that a cycle may have on average; a sweep with more is left out from there on."""

_OCTAVES, _MOST_OCTAVES = 2, 24
"""By which sweeps begin higher until the damping falls to half its peak, and the most that they may go through."""

_LOWEST = 1e-3
"""Least amplitude over half the clearance that is looked at where nothing holds the ball."""

_BALANCED = 1e-3
"""Share of its drive that a ball must be left with for its figures to have a meaning."""


@dataclass(frozen=True)
class _Pace:
    """Sweeps, and the cycles of each for an octave."""

    sweeps: int
    stay: int

    def __post_init__(self) -> None:
        if whole("sweeps", self.sweeps) < 2:
            raise ValueError(f"sweeps must be at least 2, got {self.sweeps}")
        whole("stay", self.stay)


def working(
    damper: ParticleDamper,
    *,
    threads: int | None = None,
    sweeps: int = SWEEPS,
    stay: int = STAY,
    reach: float = 0.0,
) -> Working:
    """Measure the damper on sweeps through the amplitudes along x, the structure's own damping set aside.

    A sweep comes from above, so that the ball is in motion: one that little holds may keep bouncing at amplitudes at
    which it would not begin to. A ball at rest in the middle of its cavity then takes less, until it meets a wall.

    Args:
        damper: what is measured; its damping ratio has no influence.
        threads: see :func:`damper.ringdowns`.
        sweeps: through the amplitudes, from as many starts.
        stay: cycles that a sweep takes for an octave, and four times as many where the pace moves the peak, as it does
            where hits take next to nothing from the ball. 4 sweeps of 60 take a fifth of the time, and move the peak by
            less than 1 %, mostly.
        reach: amplitude up to which the curve goes at least [m].
    """
    pace = _Pace(sweeps, stay)
    bare = undamped(damper)
    left = abs(1 - bare.tilt_share[0])
    gap = bare.half_gap[0]
    if left < _BALANCED:
        return nothing(math.inf)
    cutoff = bare.leaving_threshold / bare.stuck_frequency**2 / left
    laws.check_rest_amplitude(bare, cutoff)
    if gap == 0 or (cutoff == 0 and bare.restitution == 1):
        return nothing(cutoff)
    lowest, top = max(cutoff, _freely(bare) * gap / left), 8 * max(cutoff, gap / left)
    top = max(top, reach)
    before, top = _falling(bare, cutoff, lowest, top, replace(pace, stay=max(stay // _SLOWER, 1)), threads)
    if before.peak == 0:
        return before
    found = _found(bare, cutoff, lowest, top, pace, threads)
    if _moved(before, found) > _SAME:
        before, found = found, _found(bare, cutoff, lowest, top, replace(pace, stay=_SLOWER * stay), threads)
    return replace(found, error=max(found.error, _moved(before, found)))


def _moved(before: Working, found: Working) -> float:
    """Relative difference of two peaks, or of the amplitudes between which half of them is left, the largest."""
    if found.peak == 0:
        return 1.0
    was, now = np.array([before.peak, *before.half]), np.array([found.peak, *found.half])
    return float(np.abs(was / now - 1).max())


def _falling(
    damper: ParticleDamper, cutoff: float, low: float, top: float, pace: _Pace, threads: int | None
) -> tuple[Working, float]:
    """Figures up to where the damping has fallen to half its peak, and the amplitude that this takes."""
    while True:
        found = _found(damper, cutoff, low, top, pace, threads)
        if found.peak == 0 or found.damping_ratio[-1] < found.peak / 2 or top > low * 2**_MOST_OCTAVES:
            return found, top
        top *= 2**_OCTAVES


def _found(damper: ParticleDamper, cutoff: float, low: float, top: float, pace: _Pace, threads: int | None) -> Working:
    """Figures of sweeps at a pace."""
    samples = samples_of(damper, low, top, pace.sweeps, pace.stay, threads)
    self_check.once("level curves" if kinds(damper, damper.parameters)[0] == CLOSED_FORM else "linear curves", working)
    whole = figures(samples, cutoff)
    if whole is None:
        return nothing(cutoff)
    laws.check_curve(damper, whole)
    laws.check_readings(whole, samples)
    return replace(whole, error=max(spread(samples, whole), BINNED))


def undamped(damper: ParticleDamper) -> ParticleDamper:
    """The damper on a structure without damping of its own."""
    modes = None if damper.modes is None else tuple(replace(mode, damping_ratio=None) for mode in damper.modes)
    return replace(damper, damping_ratio=0.0, modes=modes)


def _freely(damper: ParticleDamper) -> float:
    """Half the amplitude, over half the clearance, down to which a ball that nothing holds keeps bouncing.

    Two symmetric hits a cycle exist from rho / sqrt(1 + rho^2) on, rho = (2/pi) (1 - e)/(1 + e), for a free ball
    (Weidemann, Bergman, Vakakis and Krack 2025, doi 10.1007/s11071-025-10928-4); a rolling one feels beta times that.
    """
    e = max([damper.restitution, *(ratio for _, ratio in damper.restitution_by_speed)])
    beta = float(inertia_ratio(damper.parameters)[0])
    rho = 2 / math.pi * (1 - e) / (1 + e)
    return max(0.5 * rho / math.hypot(1, rho) / beta, _LOWEST)


def samples_of(damper: ParticleDamper, low: float, high: float, sweeps: int, stay: int, threads: int | None) -> Floats:
    """Samples on sweeps from high to low, a row for each cycle of each sweep.

    From cycle to cycle the structure is led to a little less motion, the ball keeps its own in its cavity. Columns: the
    logarithms of the amplitude before a cycle and of what its losses would leave of that, and two by which the sweeps
    fall into halves.
    """
    from damper import amplitude_sweep

    each = np.arange(sweeps)
    start = np.zeros((sweeps, 5, 2))
    start[:, 0, 0] = high * 2 ** ((each + 1) / sweeps)  # at least one octave's share above, to settle on the way
    start[:, 2, 0] = damper.half_gap[0] * (1 - each / sweeps)
    cycles = SETTLING + math.ceil(stay * (math.log2(high / low) + 1))
    many = np.repeat(damper.parameters, sweeps)
    p = prepare(many, start, cycles, cycles)
    tables = nothing_kept()
    energy = np.full((sweeps, cycles, 4), np.nan)
    energy[..., 3] = laws.NOT_REACHED
    least = 0.5 * damper.stiffness[0] * low**2
    descent = amplitude_sweep.Descent(_EVENTS * cycles, 4 ** (-1 / stay), float(least), energy)
    closed = kinds(damper, damper.parameters)[0] == CLOSED_FORM
    f = None if closed else flights(damper, many, p, amplitudes=_in_one_mode(damper, start[:, 0, 0]))

    def work(block: tuple[int, int]) -> None:
        if f is None:
            amplitude_sweep.run_level(block, p.runs, tables, descent)
        else:
            amplitude_sweep.run_linear(block, f.runs, f.systems.flows, tables, descent)

    in_blocks(work, sweeps, threads or os.cpu_count() or 1, block_size=1)
    if f is not None:
        f.give_back(p)
    laws.check_sweeps(damper, energy, p.axes["excursion"])
    self_check.once("level sweeps" if closed else "linear sweeps", samples_of)
    with np.errstate(divide="ignore", invalid="ignore"):  # what rounding leaves of nothing has either sign
        level = 0.5 * np.log(2 * energy[:, SETTLING:, :2] / damper.stiffness[0])
    halves = np.repeat(np.column_stack([each % 2, each // (sweeps // 2)]), level.shape[1], axis=0)
    rows: Floats = np.column_stack([level.reshape(-1, 2), halves])
    return rows[np.isfinite(rows).all(axis=1)]


def _in_one_mode(damper: ParticleDamper, displacement: Floats) -> Floats | None:
    """Amplitudes of the modes where the one that yields most along x moves the cavity so, shape (n, k)."""
    if damper.modes is None:
        return None
    k = damper.leading(0)
    amplitudes = np.zeros((len(displacement), len(damper.modes)))
    amplitudes[:, k] = displacement / damper.modes[k].shape[0]
    return amplitudes
