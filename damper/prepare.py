"""The records of ring-downs about to start."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from damper.parameters import energy, half_gap, number, stuck_frequency
from damper.records import LEVEL, STUCK, balls_of, laws_of

if TYPE_CHECKING:
    from damper.arrays import Floats, Integers, Records
    from damper.parameters import Parameters

_CYCLES_AFTER_REST = 3

_LIGHT = 0.1
"""Decay rate over frequency up to which a structure's velocity peaks where it would without damping, nearly."""

_NOTHING = 36.0
"""Decay times after which nothing is left of a vibration: exp(-36) is rounding."""

_LARGEST = 1e150
"""Largest displacement, speed and acceleration at release [SI]: the square of a larger one may overflow."""


@dataclass(frozen=True)
class Prepared:
    """Runs of n ring-downs, dtype `damper.records.LEVEL`, and the energy that they begin with; views of the former."""

    runs: Records
    initial: Floats

    @property
    def laws(self) -> Records:
        """Shape (n, 2 axes, 3 regimes)."""
        return self._views("laws")

    @property
    def axes(self) -> Records:
        """Shape (n, 2)."""
        return self._views("axes")

    @property
    def balls(self) -> Records:
        """Shape (n,)."""
        return self._views("ball")

    @property
    def clocks(self) -> Records:
        """Shape (n,)."""
        return self._views("clock")

    @property
    def books(self) -> Records:
        """Shape (n,)."""
        return self._views("books")

    @property
    def cycles(self) -> Records:
        """Shape (n,)."""
        return self._views("cycle")

    def _views(self, name: str) -> Records:
        views: Records = self.runs[name]
        return views

    def some(self, which: Integers) -> Prepared:
        """Copies of some of the ring-downs."""
        return Prepared(self.runs[which], self.initial[which])

    def take(self, which: Integers, part: Prepared) -> None:
        """Put what `some` gave back in its place."""
        self.runs[which], self.initial[which] = part.runs, part.initial


def prepare(rows: Parameters, start: Floats, cycles: float | None, max_cycles: float) -> Prepared:
    """Set up n ring-downs from `start`, shape (n, 5, 2): u, v, s, w and spin along x and y.

    Raises:
        ValueError: a number is not finite, or its square is not; the number of cycles is not positive, or a ball is
            outside its cavity.
    """
    if cycles is not None and not 0 < number("cycles", cycles) < math.inf:
        raise ValueError(f"cycles must be positive, got {cycles:g}")
    if not (math.isfinite(number("max_cycles", max_cycles)) or cycles is not None) or not max_cycles > 0:
        raise ValueError(f"max_cycles must be positive and finite, got {max_cycles:g}")
    if not np.isfinite(start).all():
        raise ValueError(f"the release must be finite, got {start[~np.isfinite(start)][0]}")
    _check_size(rows, start)
    runs = np.zeros(len(rows), LEVEL)
    axes, clocks, windows = runs["axes"], runs["clock"], runs["cycle"]
    axes["half_gap"] = half = half_gap(rows)
    for i, name in enumerate(("u", "v", "s", "w", "spin")):
        axes[name] = start[:, i]
    place: Floats = axes["s"]
    outside = abs(place) > half + 1e-12 * rows["ball_radius"][:, None]
    if outside.any():
        raise ValueError(f"ball_position {place[outside][0]:g} m lies outside the cavity")
    axes["s"] = np.clip(place, -half, half)

    runs["laws"] = laws = laws_of(rows)
    omega = stuck_frequency(rows)
    period = 2 * np.pi / omega
    size = np.abs(start).max(axis=2)
    reach = np.maximum(size[:, 0], np.maximum(size[:, 1], size[:, 3]) / omega)
    clocks["end"] = period * (max_cycles if cycles is None else cycles)
    clocks["rest"], clocks["last_motion"] = np.inf, -np.inf
    windows["period"], windows["wait"], windows["closes"] = period, _waits(laws[:, 0, STUCK], period), 0.5 * period
    clocks["tail"] = np.maximum(_CYCLES_AFTER_REST * period, windows["wait"] + period) if cycles is None else np.inf
    windows["waiting_since"] = -np.inf
    for name in ("speed", "square", "last_speed", "moving_speed", "waiting_speed"):
        windows[name] = -1.0
    runs["ball"] = balls_of(rows, reach)
    return Prepared(runs, energy(rows, axes))


def _waits(laws: Records, period: Floats) -> Floats:
    """Times [s], shape (n,), from a velocity maximum of free vibration to the zero before the one a period later.

    At most until nothing is left of the vibration; 3/4 of the period where damping is light.
    """
    decay, frequency = laws["decay"], laws["frequency"]
    zero = (2 * np.pi - np.arctan2(frequency, decay)) / frequency
    light = decay <= _LIGHT * frequency
    return np.where(light, 0.75 * period, np.minimum(zero, _NOTHING / np.where(light, 1.0, decay)))


def _check_size(rows: Parameters, start: Floats) -> None:
    """Raise ValueError where squares of the motion from `start` overflow, which kernels do not notice."""
    length, speed = np.abs(start[:, [0, 2]]).max(axis=(1, 2)), np.abs(start[:, [1, 3, 4]]).max(axis=(1, 2))
    with np.errstate(over="ignore", invalid="ignore"):
        omega = np.sqrt(rows["stiffness"].max(axis=1) / rows["modal_mass"])
        small = (
            (length < _LARGEST) & (speed + omega * length < _LARGEST) & (omega * (speed + omega * length) < _LARGEST)
        )
    if not small.all():
        raise ValueError(
            f"the release, or what moves from it, is too large: expected less than {_LARGEST:g} in SI units"
        )
