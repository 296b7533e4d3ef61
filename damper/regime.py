"""Steady states under a harmonic force: what they are, and their figures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from damper.arrays import Floats, Integers
from damper.locked import Complex
from damper.starts import Motions, Start
from damper.tallies import APERIODIC, LOCKED, PERIODIC, TIRED


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

    @property
    def residual(self) -> Floats:
        """What the books of power do not explain [W]."""
        residual: Floats = self.power_in - self.power_lost - self.stored
        return residual


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
        }


def _regimes(verdict: Integers, divergence: Floats) -> npt.NDArray[np.object_]:
    from damper import steady

    chaotic = divergence * steady.TOGETHER > math.log(steady.APART / steady.NUDGE)
    known = {LOCKED: Regime.LOCKED, PERIODIC: Regime.PERIODIC}
    aperiodic = {False: Regime.MODULATED, True: Regime.CHAOTIC}
    regimes = np.empty(len(verdict), object)
    for k, one in enumerate(verdict):
        regimes[k] = aperiodic[bool(chaotic[k])] if one == APERIODIC else known.get(one, Regime.UNSETTLED)
    return regimes
