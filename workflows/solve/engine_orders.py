"""Where engine orders meet natural frequencies: for the pictures of a run, and for the forced response."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.rotor import from_rpm
from workflows.errors import BadInput, present
from workflows.formatting import interval, turning, whole
from workflows.scene.scene import Scene
from workflows.solve.results import Mode, Results, SpeedPoint, VibrationReduction, copy_fields


@dataclass(frozen=True)
class Branch:
    """A mode followed over the speeds: its family, what a legend says, (speed, mode) of the run that it consists of."""

    family: str
    label: str
    places: tuple[tuple[int, int], ...]


def branches(results: Results) -> list[Branch]:
    """The modes followed over ascending speeds, each named by its family at the lowest speed it is seen at."""
    tracks: dict[int, list[tuple[int, int]]] = {}
    for at, point in sorted(enumerate(results.speeds), key=lambda each: each[1].rpm):
        for place, mode in enumerate(point.modes):
            tracks.setdefault(mode.branch, []).append((at, place))
    names = _names(results.speeds)
    return [Branch(*names[branch], tuple(track)) for branch, track in tracks.items()]


def labels(points: Sequence[SpeedPoint]) -> dict[int, str]:
    """What a legend calls the branches of some points, by their number."""
    return {branch: label for branch, (_, label) in _names(points).items()}


def _names(points: Sequence[SpeedPoint]) -> dict[int, tuple[str, str]]:
    """Family of each branch at the lowest speed it is seen at, and the same with its number there."""
    names: dict[int, tuple[str, str]] = {}
    for mode in (mode for point in sorted(points, key=lambda each: each.rpm) for mode in point.modes):
        if mode.branch not in names:
            number = 1 + sum(family == mode.family for family, _ in names.values())
            names[mode.branch] = mode.family, f"{mode.family} {number}"
    return names


ENGINE_ORDERS = (1, 2, 3, 4, 6, 8, 12, 16)
"""Multiples of the rotation's frequency that are looked at in any scene."""


def orders(scene: Scene) -> tuple[int, ...]:
    """Those, and the ones that the scene's [excitation] names."""
    listed = () if scene.excitation is None else scene.excitation.orders
    return tuple(sorted({*ENGINE_ORDERS, *listed}))


@dataclass(frozen=True)
class Crossing:
    """An engine order that meets a mode.

    Attributes:
        order, branch: which order, and which of the modes at the lowest speed the mode continues, from 0.
        family: what the mode does there; label: what a legend calls it.
        rpm: speed [rev/min]; frequency_hz: of both [Hz].
        error: relative, of the frequency, None where it is not known; `basis`: what the reduced basis adds of it.
        turns: how fast the mode's frequency grows with the speed's, [-].
    """

    order: int
    branch: int
    family: str
    label: str
    rpm: float
    frequency_hz: float
    error: float | None
    basis: float
    turns: float

    @property
    def omega(self) -> float:
        """Speed [rad/s]."""
        return from_rpm(self.rpm)

    @property
    def place(self) -> str:
        """Where it is, in words."""
        return f"order {self.order} at {turning(self.omega)}"

    def moved(self, to: Crossing | SpeedPoint | VibrationReduction) -> Crossing:
        """The same order and mode, at the speed of something else."""
        return replace(self, rpm=to.rpm, frequency_hz=self.order * to.rpm / 60)


def crossings(results: Results) -> list[Crossing]:
    """Those of a run with the usual orders, where they were solved at the speed that estimates name.

    A structure that is given has no modes, and none of them.
    """
    if not any(point.modes for point in results.speeds):
        return []
    met = []
    for each in of_points(results.speeds, orders(results.scene)):
        solved = [known for known in results.reductions if (known.order, known.mode) == (each.order, each.branch + 1)]
        met.append(each.moved(min(solved, key=lambda known: abs(known.rpm - each.rpm), default=each)))
    return met


def of_points(points: Sequence[SpeedPoint], orders: Iterable[int]) -> list[Crossing]:
    """Crossings between the speeds of some points, ascending in order, mode and speed.

    Between two speeds f² goes with Ω² along a straight line, as it does for a mode that keeps its shape (Southwell);
    an order is a line through the origin there, so that they meet at most once. A structure that is given has one mode,
    whose frequency does not depend on the speed.
    """
    names = labels(points) or {0: "flap 1"}
    met = []
    for branch in sorted(names):
        track = _track(points, branch)
        rpm, hertz = (np.array(values) for values in zip(*((p.rpm, frequency_of(p, k)) for p, k in track), strict=True))
        for order in orders:
            apart = hertz**2 - (order * rpm / 60) ** 2
            meets = np.flatnonzero((apart[:-1] * apart[1:] <= 0) & (apart[1:] != 0))
            met += [_between(order, names[branch], track[k], track[k + 1]) for k in meets]
    return sorted(met, key=lambda crossing: crossing.order)


def ends(points: Sequence[SpeedPoint], crossing: Crossing) -> tuple[tuple[SpeedPoint, int], tuple[SpeedPoint, int]]:
    """The points that a crossing lies between, each with the number of its mode there, from 0."""
    track = _track(points, crossing.branch)
    above = next(k for k in range(1, len(track)) if track[k][0].rpm >= crossing.rpm or k == len(track) - 1)
    return track[above - 1], track[above]


def no_crossing(points: Sequence[SpeedPoint], orders: Sequence[int], file: str, driven: bool = True) -> BadInput:
    """That no order crosses a mode between the lowest and the highest of these points, and where it would.

    Or, not `driven`, that those that do drive none at the damper's place.
    """
    low, high = min(point.rpm for point in points), max(point.rpm for point in points)
    what = "no order crosses a mode" if driven else "none of these orders drives a mode at the damper's place"
    problem = f"{what} {interval(whole(low), whole(high), ' and ', 'between ', 'at ')} rpm"
    for order in orders if driven else ():
        rpm = crossing_beyond(points, order)
        problem += "" if rpm is None else f"; order {order} would meet the first mode near {whole(rpm)} rpm"
    return BadInput(problem, file=file, key="[excitation] orders", value=list(orders))


def crossing_beyond(points: Sequence[SpeedPoint], order: int) -> float | None:
    """The speed [rev/min] at which an order would meet the first mode beyond these points; None where it never would.

    f² goes with Ω² as between the lowest and the highest of them.
    """
    track = _track(points, 0)
    (a, f), (b, g) = ((point.rpm, frequency_of(point, k)) for point, k in (track[0], track[-1]))
    growth = 0.0 if a == b else 3600 * (g**2 - f**2) / (b**2 - a**2)
    square = (3600 * f**2 - growth * a**2) / (order**2 - growth) if order**2 > growth else -1.0
    return math.sqrt(square) if square > 0 else None


def reached_within_error(points: Sequence[SpeedPoint], rpm: float) -> float:
    """The first mode's error at the end of the speeds nearest to another speed, where that lies within it; else 0."""
    end = min(points, key=lambda point: abs(point.rpm - rpm))
    error = end.modes[0].error_estimate if end.modes else None
    return error if error is not None and abs(rpm / end.rpm - 1) <= error else 0.0


def _track(points: Sequence[SpeedPoint], branch: int) -> list[tuple[SpeedPoint, int]]:
    """Points that have a branch, by speed, each with which of its modes that is, from 0; of a given structure all."""
    by_speed = sorted(points, key=lambda point: point.omega)
    every = [(point, k) for point in by_speed for k, mode in enumerate(point.modes) if mode.branch == branch]
    return every or [(point, 0) for point in by_speed]


def _between(order: int, label: str, low: tuple[SpeedPoint, int], high: tuple[SpeedPoint, int]) -> Crossing:
    """The crossing of an order with a mode between two points on either side of it."""
    (a, f), (b, g) = ((point.rpm, frequency_of(point, k)) for point, k in (low, high))
    below, above = f**2 - (order * a / 60) ** 2, g**2 - (order * b / 60) ** 2
    rpm = math.sqrt(a**2 + below / (below - above) * (b**2 - a**2))
    point, k = low if rpm - a < b - rpm else high
    mode = point.modes[k] if point.modes else Mode(f, "flap")
    basis = 0.0 if mode.error_parts is None else mode.error_parts.basis
    turns = 3600 * (g**2 - f**2) / (b**2 - a**2) / order
    of = {"order": order, "label": label, "rpm": rpm, "frequency_hz": order * rpm / 60, "error": mode.error_estimate}
    return copy_fields(Crossing, mode, **of, basis=basis, turns=turns)


def frequency_of(point: SpeedPoint, k: int) -> float:
    """Of a point's mode k, from 0, without the ball; of a structure that is given its own [Hz]."""
    return point.modes[k].frequency_hz if point.modes else present(point.reduced).f2_hz
