"""The points of a study by absolute index, over a grid or a sample, and the scene of each."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from workflows.errors import BadInput
from workflows.scene.load import SceneFile, parse
from workflows.scene.scene import FLAT
from workflows.studies.sweep.axes import (
    CLEARANCE,
    MOST,
    SPEEDS,
    Axis,
    Data,
    Key,
    Value,
    find,
    of_the_cavity,
    of_the_mass,
    of_the_plate,
    plain,
    written_out,
)

if TYPE_CHECKING:
    import numpy.typing as npt


SAMPLE = "sample"
"""The dimension of a sample."""


class Plan(Protocol):
    """Points in an order of their own, speeds last, so that those of one plate and of one ball lie together."""

    @property
    def axes(self) -> tuple[Axis, ...]:
        """What is varied, the speeds last."""

    @property
    def dimensions(self) -> dict[str, int]:
        """Names and lengths of the dimensions, slowest first; their product is the number of points."""

    def columns(self, begin: int, end: int) -> dict[str, list[Value]]:
        """The values of every axis at the points from `begin` to before `end`."""

    def coordinates(self) -> dict[str, tuple[str, list[Value]]]:
        """The values of every axis along its dimension."""

    def speeds(self, begin: int, end: int) -> tuple[float, ...]:
        """All speeds at which the plates of these points are solved, ascending [rad/s]."""

    def identity(self) -> dict[str, Any]:
        """What makes the plan this one, as plain data."""


def size(plan: Plan) -> int:
    """The number of points."""
    return math.prod(plan.dimensions.values())


@dataclass(frozen=True)
class Grid:
    """Every value of each axis with every one of the others."""

    axes: tuple[Axis, ...]

    @property
    def dimensions(self) -> dict[str, int]:
        """One for each axis."""
        return {axis.name: len(axis.values) for axis in self.axes}

    def columns(self, begin: int, end: int) -> dict[str, list[Value]]:
        """See :class:`Plan`."""
        places = np.unravel_index(np.arange(begin, end), tuple(self.dimensions.values()))
        return {axis.name: [axis.values[k] for k in at] for axis, at in zip(self.axes, places, strict=True)}

    def coordinates(self) -> dict[str, tuple[str, list[Value]]]:
        """Each axis along itself."""
        return {axis.name: (axis.name, list(axis.values)) for axis in self.axes}

    def speeds(self, begin: int, end: int) -> tuple[float, ...]:
        """Those of the whole grid, for any points."""
        return tuple(sorted(float(value) for value in self.axes[-1].values))

    def identity(self) -> dict[str, Any]:
        """Keys and values."""
        return {"grid": {axis.name: said(axis.values) for axis in self.axes}}


@dataclass(frozen=True)
class Sample:
    """So many points, spread evenly over all axes at once; every one at all speeds, unless these are sampled as well.

    Attributes:
        axes: what is sampled, and last the speeds.
        count: points of the sample.
        seed: of the scrambling.
        tiles: rows of shares from 0 to 1, in place of a Sobol' sequence: shape (count, axes but the speeds').
    """

    axes: tuple[Axis, ...]
    count: int
    seed: int
    sampled_speeds: bool = False
    tiles: npt.NDArray[np.float64] | None = field(default=None, repr=False, compare=False)

    @property
    def drawn(self) -> tuple[Axis, ...]:
        """The axes that are sampled."""
        return self.axes if self.sampled_speeds else self.axes[:-1]

    @property
    def dimensions(self) -> dict[str, int]:
        """The sample, and the speeds where they are not sampled."""
        found = {SAMPLE: self.count}
        return found if self.sampled_speeds else found | {SPEEDS: len(self.axes[-1].values)}

    @property
    def _each(self) -> int:
        return 1 if self.sampled_speeds else len(self.axes[-1].values)

    def columns(self, begin: int, end: int) -> dict[str, list[Value]]:
        """See :class:`Plan`."""
        first, last = begin // self._each, -(-end // self._each)
        rows = np.arange(begin, end)
        shares = self._shares(first, last)[rows // self._each - first]
        found = {axis.name: drawn(axis, shares[:, k]) for k, axis in enumerate(self.drawn)}
        if not self.sampled_speeds:
            found[SPEEDS] = [self.axes[-1].values[k] for k in rows % self._each]
        return found

    def _shares(self, begin: int, end: int) -> npt.NDArray[np.float64]:
        if self.tiles is not None:
            return self.tiles[begin:end]
        from scipy.stats import qmc

        sequence = qmc.Sobol(len(self.drawn), scramble=True, rng=self.seed)
        if begin:
            sequence.fast_forward(begin)
        count = end - begin
        power = 1 << (count - 1).bit_length()  # scipy warns of a first draw that is no power of two
        found: npt.NDArray[np.float64] = sequence.random(power)[:count]
        return found

    def coordinates(self) -> dict[str, tuple[str, list[Value]]]:
        """Each sampled axis along the sample."""
        every = self.columns(0, self.count * self._each)
        found = {axis.name: (SAMPLE, every[axis.name][:: self._each]) for axis in self.drawn}
        return found if self.sampled_speeds else found | {SPEEDS: (SPEEDS, list(self.axes[-1].values))}

    def speeds(self, begin: int, end: int) -> tuple[float, ...]:
        """All that are given; of sampled ones those of these points, and the ends of their range."""
        if not self.sampled_speeds:
            return tuple(sorted(float(value) for value in self.axes[-1].values))
        return tuple(sorted({float(value) for value in self.columns(begin, end)[SPEEDS]}))

    def identity(self) -> dict[str, Any]:
        """Keys, spreads and the seed."""
        axes = {axis.name: vars(axis.spread) if axis.spread else said(axis.values) for axis in self.axes}
        return {"sample": axes, "count": self.count, "seed": self.seed, "tiled": self.tiles is not None}


def said(values: Sequence[Value]) -> list[Value]:
    """Values as JSON has them, in which nothing is infinite."""
    return [FLAT if value == math.inf else value for value in values]


def drawn(axis: Axis, shares: npt.NDArray[np.float64]) -> list[Value]:
    """The values of an axis at shares from 0 to 1: of its spread, or one of its values each."""
    if axis.spread is None:
        places = np.minimum((shares * len(axis.values)).astype(int), len(axis.values) - 1)
        return [axis.values[k] for k in places]
    found = axis.spread.at(shares)
    if axis.key.whole:
        low, high = math.ceil(axis.spread.low), math.floor(axis.spread.high)
        return [int(value) for value in np.clip(np.floor(low + shares * (high - low + 1)), low, high)]
    return [float(value) for value in found]


def grid(axes: Sequence[Axis], speeds: Sequence[float]) -> Grid:
    """All axes against each other: first those that change the plate, then cavities, then masses; speeds last."""
    for axis in axes:
        if not axis.values:
            _refuse(axis, "a range over a grid needs its COUNT: START:STOP:COUNT")
    found = Grid(_in_order(axes, speeds))
    if size(found) > MOST:
        raise BadInput(f"expected at most {MOST:.0e} points, not {size(found):.3g}", key="--vary")
    return found


def sample(axes: Sequence[Axis], speeds: Sequence[float], count: int, seed: int) -> Sample:
    """So many points over all axes."""
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST:
        raise BadInput(f"expected a whole number of points from 1 to {MOST:.0e}", key="--sample", value=count)
    return Sample(_in_order(axes, speeds), count, seed, any(axis.name == SPEEDS and axis.spread for axis in axes))


def _in_order(axes: Sequence[Axis], speeds: Sequence[float]) -> tuple[Axis, ...]:
    def rank(axis: Axis) -> int:
        if axis.name == SPEEDS:
            return 4
        if of_the_plate(axis.key):
            return 0
        return 1 if of_the_cavity(axis.key) else 2 if of_the_mass(axis.key) else 3

    given = list(axes)
    if not any(axis.name == SPEEDS for axis in given):
        given.append(Axis(find(SPEEDS, "--vary"), tuple(speeds)))
    return tuple(sorted(given, key=rank))


def _refuse(axis: Axis, problem: str) -> None:
    raise BadInput(problem, key=f"--vary {axis.name}", value=axis.text)


def base(source: SceneFile, varied: Sequence[Key]) -> Data:
    """The study's scene as plain data, ready for these keys.

    Raises:
        BadInput: it lacks a table that a key belongs to.
    """
    data = written_out(plain(source.scene), varied)
    for key in varied:
        table = key.table[0]
        if table not in data:
            raise BadInput(f"the scene {source.name} has no [{table}]", key=f"--vary {key.name}")
    return data


def with_values(data: Data, values: Mapping[Key, Value]) -> Data:
    """A copy of plain data with values put in; clearances last, which add to the ball's diameter."""
    found = copy.deepcopy(data)
    for key in sorted(values, key=lambda key: key.name.startswith(CLEARANCE)):
        key.put(found, values[key])
    return found


def of_a_point(source: SceneFile, data: Data, speeds: Sequence[float]) -> SceneFile:
    """The scene of plain data at these speeds.

    Raises:
        BadInput: its values are wrong together.
    """
    table, name = SPEEDS.split(".")
    whole = data | {table: data[table] | {name: list(speeds)}}
    return replace(source, scene=parse(whole, source.name), remarks=())
