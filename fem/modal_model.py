"""A structure that is known by its modes: nodes, perhaps cells, and per speed frequencies and mass-normalised shapes.

Whatever gives such modes, a file or a mesh that was solved, what a damper needs is the same: how its place moves and
turns in each mode, and the modes at speeds between those that are known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.linalg import Array, Ints, perpendicular, symmetric
from fem.meshes.cells import Cell, cell, faces_of
from fem.meshes.planform import position


class OffTheStructure(ValueError):
    """A place that is not on the structure, or that its nodes do not determine; the message says which."""


class BadSpeeds(ValueError):
    """Modes at several speeds from which none follow at another, `omega` [rad/s]."""

    def __init__(self, omega: float) -> None:
        super().__init__(f"the squared frequencies between the speeds fall below 0 at {omega:g} rad/s")
        self.omega = omega


class BadCells(ValueError):
    """Cells that are listed twice, or whose nodes are not in the order of their kind; the message says which."""


@dataclass(frozen=True, eq=False)
class ModesAtSpeed:
    """Real modes at one speed, ascending.

    Attributes:
        omega: rotation speed [rad/s].
        frequencies_hz: (k,), above 0.
        shapes: displacements of the nodes, (k, n, 3), of modal mass 1 kg [kg^-1/2].
        static: displacement of the nodes by the load of this speed, (n, 3) [m]; None: not known.
        rotations: of the nodes in the modes, (k, n, 3) [rad/m kg^-1/2]; None: displacements alone are known.
        damping_ratios: (k,) of critical; None: not known.
        errors: relative errors of the frequencies, (k,), estimated; None: not known.
        interpolation: what interpolation between speeds adds to them, (k,); None: not known; zeros where there is none.
        drawn: force on each mode by a unit acceleration of the root along x, y and z, but for its sign, (k, 3)
            [kg^1/2]; None: not known.
        tracks: what the modes are called over the speeds, (k,): numbers from 0; None: their numbers here.
    """

    omega: float
    frequencies_hz: Array
    shapes: Array
    static: Array | None = None
    rotations: Array | None = None
    damping_ratios: Array | None = None
    errors: Array | None = None
    interpolation: Array | None = None
    drawn: Array | None = None
    tracks: Ints | None = None

    @property
    def squares(self) -> Array:
        """Squared circular frequencies (k,) [1/s²]: the modal stiffness."""
        return np.asarray((2.0 * np.pi * self.frequencies_hz) ** 2)


@dataclass(frozen=True, eq=False)
class ModalModel:
    """A structure at the speeds at which its modes are known.

    Attributes:
        points: undeformed nodes, (n, 3) [m].
        speeds: what is known at each, ascending.
        axis: unit vector of the spin axis, (3,); origin: a point on it, (3,) [m].
        cells: pairs of meshio's name and connectivity (c, nodes); may be empty.
        sets: numbers (from 0) of the nodes in named sets.
        labels: what the nodes are called in their file, (n,); None: by their numbers from 1 on.
    """

    points: Array
    speeds: tuple[ModesAtSpeed, ...]
    axis: Array
    origin: Array
    cells: tuple[tuple[str, Ints], ...] = ()
    sets: Mapping[str, Ints] = field(default_factory=dict)
    labels: Ints | None = None

    @property
    def size(self) -> float:
        """Diagonal of the box around the nodes [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    def load(self, point: Array) -> Array:
        """Vectors from the spin axis to points (..., 3) [m].

        Times Omega² they are the centrifugal acceleration there.
        """
        return perpendicular(point - self.origin, self.axis)

    @cached_property
    def omegas(self) -> Array:
        """The speeds at which the modes are known [rad/s], ascending."""
        return np.array([modes.omega for modes in self.speeds])

    def chunks(self, dimension: int) -> Iterator[tuple[str, Cell, Ints]]:
        """The cells that are flat (2) or have a volume (3), some thousand at once: name, kind and nodes (c, k)."""
        for name, cells in self.cells:
            if cell(name).dimension == dimension:
                yield from ((name, cell(name), chunk) for chunk in np.array_split(cells, max(1, len(cells) // _CHUNK)))

    @cached_property
    def weights(self) -> Array:
        """Volume or, of flat cells alone, area that each node stands for, the integral of its shape function, (n,).

        Ones without cells.
        """
        volumes = np.zeros(len(self.points))
        for _, kind, chunk in self.chunks(max((cell(name).dimension for name, _ in self.cells), default=0)):
            points, weights = kind.rule
            sizes = np.abs(kind.sizes(self.points[chunk], points)) * weights
            np.add.at(volumes, chunk, sizes @ kind.shape(points))
        return volumes if volumes.any() else np.ones(len(volumes))

    @cached_property
    def _turns(self) -> Array:
        """Rotations (s, k, k) of each speed's modes among themselves to be as like those of the middle one as they can.

        Through modes turned so, and their small stiffness, polynomials go past crossings and veerings. Source: Amsallem
        and Farhat, SIAM J. Sci. Comput. 33 (2011) 2169; the nodes' displacements stand for the mass. Where the load
        bends the structure it turns these, and a low mode would get stiffness of high ones, which the load hardly mixes
        with it: there modes are as like as their frequencies are, too.
        """
        from scipy.linalg import polar

        half = len(self.speeds) // 2
        middle, count = self._flat[half], len(self._flat[half])
        like = [middle @ each.T for each in self._flat]
        if self._bent > _BENT:
            ratios = [np.divide.outer(self.speeds[half].squares[:count], each.squares[:count]) for each in self.speeds]
            like = [each * np.sqrt(np.minimum(r, 1 / r)) for each, r in zip(like, ratios, strict=True)]
        return np.array([polar(each)[0] for each in like])

    @cached_property
    def _bent(self) -> float:
        """Largest displacement across the load, by it, over the structure's size; 0 where none is known."""
        along = self.load(self.points)
        along /= np.maximum(np.linalg.norm(along, axis=1), _STILL * self.size)[:, None]
        static = [modes.static for modes in self.speeds if modes.static is not None]
        across = [each - (each * along).sum(axis=1)[:, None] * along for each in static]
        return max((float(np.linalg.norm(each, axis=1).max()) for each in across), default=0.0) / self.size

    @cached_property
    def _flat(self) -> list[Array]:
        """As many shapes as are known at every speed, (k, 3 n) each."""
        count = min(modes.frequencies_hz.size for modes in self.speeds)
        return [modes.shapes[:count].reshape(count, -1) for modes in self.speeds]

    @cached_property
    def likeness(self) -> Array:
        """Of each mode the least modal assurance criterion with what it becomes at the next speed or before, (k,)."""
        turns, flat = self._turns, self._flat
        least = np.ones(turns.shape[1])
        for one, other in (*pairwise(range(len(flat))), *pairwise(range(len(flat) - 1, -1, -1))):
            become = turns[one].T @ turns[other] @ flat[other]
            product = (flat[one] * become).sum(axis=1) ** 2
            least = np.minimum(least, product / ((flat[one] ** 2).sum(axis=1) * (become**2).sum(axis=1)))
        return least

    def at(self, omega: float, *, fewer: bool = False) -> ModesAtSpeed:
        """The modes at a speed [rad/s]: those known there, or by polynomials in its square through the speeds around.

        The error of interpolation is the most that leaving out the nearest speed changes a frequency, as modes exchange
        their errors where they cross; of two speeds alone it is not known.

        Args:
            omega: the speed.
            fewer: without the nearest of the speeds around.

        Raises:
            ValueError: beyond the speeds known.
        """
        low, high = self.omegas.min(), self.omegas.max()
        exact = np.flatnonzero(np.abs(self.omegas - omega) <= SAME_SPEED * max(high, abs(omega)))
        if not low <= omega <= high and not exact.size:
            raise ValueError(f"the modes are known from {low:g} to {high:g} rad/s, not at {omega:g}")
        near = self._near(omega, fewer=fewer and not exact.size)
        values, vectors, weights = self._reduced(omega, near)
        interpolation: Array | None = None
        if exact.size:
            modes, interpolation = chosen(self.speeds[int(exact[0])], np.arange(values.size)), np.zeros(values.size)
        else:
            modes = self._between(omega, near, values, vectors, weights)
            if not fewer and near.size > 2:
                changes = self.at(omega, fewer=True).frequencies_hz / modes.frequencies_hz - 1.0
                interpolation = np.full(changes.size, np.abs(changes).max())
        return replace(modes, omega=omega, interpolation=interpolation, tracks=self._tracks(omega, vectors))

    def _near(self, omega: float, *, fewer: bool = False) -> Ints:
        """Numbers of the speeds that a polynomial goes through, ascending."""
        near = np.argsort(np.abs(self.omegas**2 - omega**2), kind="stable")[:_NEIGHBOURS]
        return np.asarray(np.sort(near[1:] if fewer else near))

    def _reduced(self, omega: float, near: Ints) -> tuple[Array, Array, Array]:
        """Squared circular frequencies (k,) at a speed, and the modes (k, k) as sums of the turned ones, by columns.

        Also the weights of the speeds near it, by which it is interpolated.
        """
        weights = lagrange(self.omegas[near] ** 2, omega**2)
        stiffness = sum(
            weight * (self._turns[k] * self.speeds[k].squares[: len(self._turns[k])]) @ self._turns[k].T
            for weight, k in zip(weights, near, strict=True)
        )
        values, vectors = np.linalg.eigh(stiffness)
        if values[0] <= 0.0:
            raise BadSpeeds(omega)
        return values, vectors * np.sign(vectors[np.abs(vectors).argmax(axis=0), np.arange(values.size)]), weights

    def _between(self, omega: float, near: Ints, values: Array, vectors: Array, weights: Array) -> ModesAtSpeed:
        """Modes at a speed between those known, through some of them: see `_reduced`."""
        turns, speeds = self._turns[near], [self.speeds[k] for k in near]
        own = [vectors.T @ turn for turn in turns]

        def turned(parts: Sequence[Array]) -> Array:
            return np.asarray(
                sum(w * np.tensordot(o, part[: len(o)], 1) for w, o, part in zip(weights, own, parts, strict=True))
            )

        def mean(parts: Sequence[Array]) -> Array:
            return np.asarray(sum(w * (o**2 @ part[: len(o)]) for w, o, part in zip(weights, own, parts, strict=True)))

        def largest(parts: Sequence[Array]) -> Array:
            return np.asarray(np.max([o**2 @ part[: len(o)] for o, part in zip(own, parts, strict=True)], axis=0))

        def at_nodes(parts: Sequence[Array]) -> Array:
            return np.asarray(np.tensordot(weights, np.array(parts), 1))

        optional: dict[str, Any] = {}
        every = {"static": at_nodes, "rotations": turned, "drawn": turned, "damping_ratios": mean, "errors": largest}
        for name, how in every.items():
            parts = [part for modes in speeds if (part := getattr(modes, name)) is not None]
            if len(parts) == len(speeds):
                optional[name] = how(parts)
        shapes = turned([modes.shapes for modes in speeds])
        return ModesAtSpeed(omega, np.sqrt(values) / (2.0 * np.pi), shapes, **optional)

    @cached_property
    def _steps(self) -> Tracks:
        low, high = self.speeds[0].omega, self.speeds[-1].omega
        return Tracks.followed(lambda omega: self._reduced(omega, self._near(omega))[1], low, high)

    def _tracks(self, omega: float, vectors: Array) -> Ints:
        """Which mode of the lowest speed each of those at a speed continues, (k,)."""
        return np.arange(len(vectors)) if len(self.speeds) == 1 else self._steps.of(omega, vectors)


_BENT = 1e-3
"""Displacement across the load, over the structure's size, from which on the load bends it."""

TRACKED = 201
"""Speeds by which modes are followed through crossings."""


@dataclass(frozen=True, eq=False)
class Tracks:
    """Modes followed through crossings: vectors (m, q, count) at speeds (m,), and the track of each (m, count)."""

    omegas: Array
    vectors: Array
    tracks: Ints

    @classmethod
    def followed(cls, vectors_at: Callable[[float], Array], low: float, high: float) -> Tracks:
        """Follow modes from a speed to another, in rad/s, in fine steps, numbered by frequency at the first."""
        omegas = np.linspace(low, high, TRACKED)
        vectors = np.array([vectors_at(float(omega)) for omega in omegas])
        tracks: list[Ints] = [np.arange(vectors.shape[2])]
        for before, after in pairwise(vectors):
            tracks.append(_continued(before, after, tracks[-1]))
        return cls(omegas, vectors, np.array(tracks))

    def of(self, omega: float, vectors: Array) -> Ints:
        """Tracks (count,) of modes (q, count) at a speed in rad/s."""
        near = int(np.abs(self.omegas - omega).argmin())
        return _continued(self.vectors[near], vectors, self.tracks[near])


def _continued(before: Array, after: Array, tracks: Ints) -> Ints:
    """Tracks of modes (q, count) that are most alike to others of which they are known."""
    from scipy.optimize import linear_sum_assignment

    rows, order = linear_sum_assignment(-np.abs(before.T @ after))
    numbers = np.empty_like(tracks)
    numbers[order] = tracks[rows]
    return numbers


SAME_SPEED = 1e-9
"""Relative difference of speeds that are the same."""

_NEIGHBOURS = 4
"""Speeds that a polynomial goes through, at most."""


def chosen(modes: ModesAtSpeed, order: Ints) -> ModesAtSpeed:
    """Some of the modes, in an order."""
    values = {each.name: getattr(modes, each.name) for each in fields(modes) if each.name not in ("omega", "static")}
    return replace(modes, **{name: known[order] for name, known in values.items() if known is not None})


def lagrange(nodes: Array, at: float) -> Array:
    """Weights (n,) of values at nodes (n,) in the polynomial through them at a place."""
    off = nodes[:, None] - nodes[None, :] + np.eye(nodes.size)
    part = (at - nodes[None, :]) / off
    part[np.eye(nodes.size, dtype=bool)] = 1.0
    return np.asarray(part.prod(axis=1))


@dataclass(frozen=True, eq=False)
class Place:
    """A place on the structure, and how the nodes around it give its motion.

    Attributes:
        point: (3,) [m]; distance: of it from what was asked for [m].
        nodes: numbers of the nodes (k,); value: their weights in a displacement, (k,).
        slopes: their weights in its derivatives by x, y and z, (3, k) [1/m]; other: the same, found another way.
        tangent: (3, 3): what of a direction the nodes reach into; the identity, of a surface its tangent plane.
        how: in words.
    """

    point: Array
    distance: float
    nodes: Ints
    value: Array
    slopes: Array
    other: Array
    tangent: Array
    how: str

    def displacement(self, shapes: Array) -> Array:
        """Displacements (k, 3) of the place in shapes (k, n, 3)."""
        return np.asarray(np.einsum("p,kpi->ki", self.value, shapes[:, self.nodes]))

    def gradient(self, modes: ModesAtSpeed) -> tuple[Array, Array]:
        """Gradients (k, 3, 3), the derivative of component i by x_j at [:, i, j], and their uncertainty (k, 3, 3).

        Of surfaces and lines what leaves them turns with the nodes' rotations or, where these are not known, as fibres
        that stay normal. The uncertainty is the difference, with its sign, from gradients found another way.
        """
        moved = modes.shapes[:, self.nodes]
        first, second = (self._complete(np.einsum("jp,kpi->kij", each, moved)) for each in (self.slopes, self.other))
        if modes.rotations is not None:
            x, y, z = np.einsum("p,kpi->ik", self.value, modes.rotations[:, self.nodes])
            zero = np.zeros_like(x)
            turned = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
            first = turned + self.tangent @ (first - turned) @ self.tangent
        return first, first - second

    def _complete(self, within: Array) -> Array:
        normal = np.eye(3) - self.tangent
        within = within @ self.tangent
        return np.asarray(within - np.swapaxes(normal @ within, 1, 2))


FAR = 0.05
"""Distance from the structure, relative to its size, beyond which a place is not on it."""


def place(model: ModalModel, point: Array) -> Place:
    """The place of a structure nearest to a point (3,) [m]: in or on its cells; without cells, among its nodes.

    Raises:
        OffTheStructure: it is far away, or the nodes do not determine derivatives there.
    """
    distances = np.linalg.norm(model.points - point, axis=1)
    inside = _in_cells(model, point)
    if inside is None:
        order = np.argsort(distances)
        least = float(distances[order[0]])
        apart = np.linalg.norm(model.points - model.points[order[0]], axis=1)
        if least > max(FAR * model.size, float(apart[apart > 0.0].min(initial=np.inf))):
            raise _far(model, point, least)
        return _on_a_node(model, _fitted(model.points, point))
    hit, where, distance = inside
    if distance > FAR * model.size:
        raise _far(model, point, distance)
    nodes, value, slopes, tangent = _of_cells(model, hit)
    fit = _fitted(model.points, where)
    every = np.union1d(nodes, fit.nodes)
    own, mean, other = np.zeros(every.size), np.zeros((3, every.size)), np.zeros((3, every.size))
    own[np.searchsorted(every, nodes)] = value
    mean[:, np.searchsorted(every, nodes)], other[:, np.searchsorted(every, fit.nodes)] = slopes, fit.slopes
    if all(cell(name).powers.max() == 1 for name, _, _ in hit):
        mean, other = other, mean  # the slopes of linear cells jump from one to the next
    how = "in one cell" if len(hit) == 1 else f"where {len(hit)} cells meet"
    return _on_a_node(model, Place(where, distance, every, own, mean, other, tangent, how))


def _on_a_node(model: ModalModel, at: Place) -> Place:
    """A place that is a node's moves with this node, whether cells know of it or not."""
    node = int(np.linalg.norm(model.points - at.point, axis=1).argmin())
    if np.linalg.norm(model.points[node] - at.point) > _TOUCHING * model.size or node not in at.nodes:
        return at
    return replace(at, value=(at.nodes == node).astype(float))


def _far(model: ModalModel, point: Array, distance: float) -> OffTheStructure:
    low, high = model.points.min(axis=0), model.points.max(axis=0)
    box = ", ".join(f"{a:.6g} to {b:.6g}" for a, b in zip(low, high, strict=True))
    return OffTheStructure(
        f"{position(point)} m lies {distance:.3g} m off the structure, whose x, y, z go from {box} m"
    )


_TOUCHING = 1e-6
"""Distance, relative to a cell, within which a point belongs to it as well."""


def _in_cells(model: ModalModel, point: Array) -> tuple[list[tuple[str, Ints, Array]], Array, float] | None:
    """The cells that a point lies in, or the nearest, with the reference place in each; the place, and its distance."""
    candidates = []
    for name, cells in model.cells:
        corners = model.points[cells]
        low, high = corners.min(axis=1), corners.max(axis=1)
        off = np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0), axis=1)
        candidates += [(float(off[k]), name, cells[k]) for k in np.argsort(off)[:_TRIED]]
    if not candidates:
        return None
    nearest: list[tuple[float, str, Ints, Array]] = []
    for off_box, name, nodes in sorted(candidates, key=lambda each: each[0]):
        if nearest and off_box > nearest[0][0] + _TOUCHING * model.size:
            break
        at, distance = cell(name).nearest(model.points[nodes], point)
        nearest.append((distance, name, nodes, at))
        nearest.sort(key=lambda each: each[0])
    least, name, nodes, at = nearest[0]
    where = cell(name).shape(at[None])[0] @ model.points[nodes]
    again = [(name, nodes, *cell(name).nearest(model.points[nodes], where)) for _, name, nodes, _ in nearest]
    hits = [(n, c, a) for n, c, a, d in again if d <= _TOUCHING * np.ptp(model.points[c], axis=0).max()]
    return hits, np.asarray(where), least


_TRIED = 60
"""Cells of a kind in which a place is looked for."""


def _of_cells(model: ModalModel, hits: Sequence[tuple[str, Ints, Array]]) -> tuple[Ints, Array, Array, Array]:
    """Nodes, their weights in value and derivatives, means over cells, and what of directions these reach into."""
    every = np.unique(np.concatenate([nodes for _, nodes, _ in hits]))
    value, slopes, tangent = np.zeros(every.size), np.zeros((3, every.size)), np.zeros((3, 3))
    for name, nodes, at in hits:
        kind, columns = cell(name), np.searchsorted(every, nodes)
        gradients, size = kind.gradients(model.points[nodes][None], at[None])
        if not np.isfinite(size).all() or size[0, 0] == 0.0:
            raise OffTheStructure("a cell at this place has no size")
        value[columns] += kind.shape(at[None])[0] / len(hits)
        slopes[:, columns] += gradients[0, 0].T / len(hits)
        tangent += (model.points[nodes].T @ gradients[0, 0]) / len(hits)
    if cell(hits[0][0]).dimension == 3:
        return every, value, slopes, np.eye(3)
    strongest = np.linalg.eigh(symmetric(tangent))[1][:, 1:]
    return every, value, slopes, strongest @ strongest.T


_FLAT = 0.05
"""What a coordinate of nodes keeps beside a quadratic function of the others, relative to its own spread, where the
nodes lie on a surface or a line."""

_THIN = 1e-4
"""The same relative to the longest spread."""

_PER_TERM = 4
"""Nodes to a coefficient of a fit, where there are so many."""


def _fitted(points: Array, point: Array) -> Place:
    """A place by a weighted fit of quadratic polynomials to the nodes around it, its other slopes as far off as may be.

    Raises:
        OffTheStructure: fewer nodes than a slope takes.
    """
    distances = np.linalg.norm(points - point, axis=1)
    order = np.argsort(distances, kind="stable")
    if order.size < 2:
        raise OffTheStructure("one node alone gives no slope: expected at least two nodes, or rotations")
    near = order[: _PER_TERM * 10]
    frame, spread = _local_frame(points[near])
    dimension = spread.size
    near = near[: [6, 15, 40][dimension - 1]]
    local = (points[near] - point) @ frame[:, :dimension] / spread
    reach = float(np.linalg.norm(local, axis=1).max()) * (1.0 + 1e-3)
    value, slopes = _polynomial(local, reach, 2)
    rough = slopes + _MARGIN * (_polynomial(local, reach, 3)[1] - slopes)
    back = frame[:, :dimension] / spread
    tangent = frame[:, :dimension] @ frame[:, :dimension].T
    how = f"fitted to {near.size} nodes around it"
    return Place(point, 0.0, near, value, back @ slopes, back @ rough, tangent, how)


_MARGIN = 2.0
"""Of the difference between a quadratic and a cubic fit, what counts as the uncertainty of the former."""


def _local_frame(points: Array) -> tuple[Array, Array]:
    """Axes (3, 3) of some nodes by their spread, and the spreads along as many as the nodes fill."""
    middle = points - points.mean(axis=0)
    frame = np.linalg.svd(middle, full_matrices=True)[2].T
    local = middle @ frame
    spread = np.abs(local).max(axis=0)
    if spread[0] == 0.0:
        raise OffTheStructure("all nodes around it coincide")
    dimension = int((spread > _THIN * spread[0]).sum())
    while dimension > 1:
        others, last = local[:, : dimension - 1] / spread[: dimension - 1], local[:, dimension - 1]
        terms = _terms(others, 2 if len(points) > _PER_TERM * dimension else 1)
        left = last - terms @ np.linalg.lstsq(terms, last, rcond=None)[0]
        if np.abs(left).max() > _FLAT * spread[dimension - 1]:
            break
        dimension -= 1
    return frame, spread[:dimension]


def _terms(local: Array, degree: int) -> Array:
    """Monomials (k, terms) at places (k, d), the linear ones after the constant."""
    powers = [each for each in product(range(degree + 1), repeat=local.shape[1]) if sum(each) <= degree]
    linear = [tuple(row) for row in np.eye(local.shape[1], dtype=int).tolist()]
    powers.sort(key=lambda each: (sum(each), linear.index(each) if each in linear else 0))
    return np.stack([np.prod(local**each, axis=1) for each in np.array(powers)], axis=1)


def _polynomial(local: Array, reach: float, degree: int) -> tuple[Array, Array]:
    """Weights of nodes in the value (k,) and the derivatives (d, k) of a weighted fit at the origin of their places.

    It is of the degree asked for, or where there are too few nodes of a lower one.
    """
    dimension = local.shape[1]
    if len(local) <= dimension:
        raise OffTheStructure(f"{len(local)} nodes do not determine a slope")
    terms = next(t for k in range(degree, 0, -1) if (t := _terms(local, k)).shape[1] <= len(local))
    weights = (1.0 - (np.linalg.norm(local, axis=1) / reach) ** 2) ** 2
    weighted = terms * weights[:, None]
    columns = _independent(weighted)
    if columns[: 1 + dimension] != list(range(1 + dimension)):
        raise OffTheStructure("the nodes around it do not determine a slope")
    solved = np.linalg.pinv(weighted[:, columns]) * weights
    return solved[0], solved[1 : 1 + dimension]


_DEPENDENT = 1e-4
"""Part of a column that is left beside those before it, up to which it counts as one of them."""


def _independent(columns: Array) -> list[int]:
    """Which columns are not made of those before them: a term that nodes cannot tell from lower ones is left out."""
    chosen: list[int] = []
    basis = np.zeros((len(columns), 0))
    for number, column in enumerate(columns.T):
        left = column - basis @ (basis.T @ column)
        left -= basis @ (basis.T @ left)
        size = float(np.linalg.norm(left))
        if size > _DEPENDENT * float(np.linalg.norm(column)):
            chosen.append(number)
            basis = np.column_stack([basis, left / size])
    return chosen


@dataclass(frozen=True, eq=False)
class Pull:
    """What the load of 1 kg at a place does to the structure.

    Attributes:
        axis: the spin axis, (3,).
        stiffening: what the stress that its pull causes adds to the stiffness of modes, over Omega², (k, k) [1].
        strays: how far the way on which that is added up lies outside the structure [m]; before it enters, beside it.
    """

    place: Place
    axis: Array
    stiffening: Callable[[ModesAtSpeed], Array]
    strays: float = 0.0

    def stiffness(self, modes: ModesAtSpeed) -> Array:
        """What it adds to the modal stiffness, over Omega², (k, k) [1].

        It softens as all mass that moves across the axis does.
        """
        flat = perpendicular(self.place.displacement(modes.shapes), self.axis)
        return np.asarray(self.stiffening(modes) - flat @ flat.T)


SAMPLES = 48
"""Places on the way from the root to another at which its shortening is added up."""

_ENTERED = 1e-6
"""Distance of a line from the structure, relative to its length, up to which it lies in it."""


def pull(model: ModalModel, at: Place, samples: int = SAMPLES) -> Pull:
    """What the load of 1 kg at a place does, where modes are all that is known.

    It pulls on the structure outwards: as this bends, the straight line from the innermost nodes' radius to the place
    shortens by half the square of its turn, and the load moves inwards. Source: potential energy of a constant force at
    the end of an inextensible line. Where the line leaves the structure, what is nearest to it counts; from one side of
    a gap to the other it is straight. samples: places at which that is added up.
    """
    arm = model.load(at.point)
    radius = float(np.linalg.norm(arm))
    outwards = arm / radius if radius > 0.0 else arm
    length = max(0.0, -float(((model.points - at.point) @ outwards).min()))
    if radius == 0.0 or length == 0.0:
        return Pull(at, model.axis, lambda modes: np.zeros((len(modes.shapes),) * 2))
    line = at.point + np.linspace(-length, 0.0, samples + 1)[:, None] * outwards
    nearest = [_weights(model, point) for point in line]
    every = np.unique(np.concatenate([nodes for nodes, _, _ in nearest]))
    weights, feet = np.zeros((len(line), every.size)), np.array([foot for _, _, foot in nearest])
    for row, (nodes, value, _) in zip(weights, nearest, strict=True):
        row[np.searchsorted(every, nodes)] = value
    steps = np.maximum(np.linalg.norm(np.diff(feet, axis=0), axis=1), length / samples)

    def stiffening(modes: ModesAtSpeed) -> Array:
        moved = np.einsum("sp,kpi->ski", weights, modes.shapes[:, every])
        turned = perpendicular(np.diff(moved, axis=0), outwards)
        return np.asarray(radius * np.einsum("ski,sli,s->kl", turned, turned, 1.0 / steps))

    off = feet - line
    entered = np.linalg.norm(off, axis=1) < _ENTERED * length
    before = np.cumsum(entered) == 0  # inboard of an oblique root the structure lies ahead, not beside the line
    off[before] = perpendicular(off[before], outwards)
    return Pull(at, model.axis, stiffening, float(np.linalg.norm(off, axis=1).max()))


def _weights(model: ModalModel, point: Array) -> tuple[Ints, Array, Array]:
    """What of the structure is nearest to a point (3,): nodes (k,), their weights in its displacement, its place."""
    inside = _in_cells(model, point)
    if inside is None:
        fit = _fitted(model.points, point)
        return fit.nodes, fit.value, point
    (name, cells, at), *_ = inside[0]
    order = np.argsort(cells)
    return cells[order], cell(name).shape(at[None])[0][order], inside[1]


def densities(model: ModalModel, modes: ModesAtSpeed) -> Array | None:
    """Density that would make the modal mass of each mode 1 kg, were it uniform, (k,) [kg/m³].

    None where not all nodes that move belong to cells with a volume.
    """
    integrals = _integrals(model, modes)
    return None if integrals is None else 1.0 / np.diag(integrals[0])


def drawn_by(model: ModalModel, modes: ModesAtSpeed) -> Array | None:
    """Force on each mode by a unit acceleration of the root, but for its sign, (k, 3), with the density of the first.

    None where that is not known.
    """
    integrals = _integrals(model, modes)
    if integrals is None:
        return None
    products, means = integrals
    sizes = np.diag(products) ** 0.5
    return np.asarray(means / sizes[:, None] / sizes[0])


def uneven_mass(model: ModalModel, modes: ModesAtSpeed) -> float:
    """Largest cosine between two modes by the volume: above 0, the mass in which they are orthogonal is not uniform.

    0 where not all nodes that move belong to cells with a volume.
    """
    integrals = _integrals(model, modes)
    if integrals is None:
        return 0.0
    sizes = np.diag(integrals[0]) ** 0.5
    return float(np.abs(integrals[0] / np.outer(sizes, sizes) - np.eye(len(sizes))).max())


def uneven_stiffness(model: ModalModel, modes: ModesAtSpeed, densities: Array) -> bool:
    """Whether densities (k,) that the modes imply come from the scale of their shapes, and not from point masses.

    The scale changes the modulus that each mode's frequency and strains imply by the same factor as its density; masses
    leave it. So the moduli differ from mode to mode by more than their ratios to the densities.
    """
    energies = np.zeros(modes.frequencies_hz.size)
    for _, kind, chunk in model.chunks(3):
        points, weights = kind.rule
        slopes, sizes = kind.gradients(model.points[chunk], points)
        for k, shape in enumerate(modes.shapes):
            strain = symmetric(np.einsum("cpnj,cni->cpij", slopes, shape[chunk], optimize=True))
            trace = np.trace(strain, axis1=2, axis2=3)
            density = (strain**2).sum(axis=(2, 3)) + _POISSON / (1.0 - 2.0 * _POISSON) * trace**2
            energies[k] += float(np.sum(density * np.abs(sizes) * weights))
    moduli = modes.frequencies_hz**2 / energies
    return bool(np.ptp(np.log(moduli)) > np.ptp(np.log(moduli / densities)))


_POISSON = 0.3
"""Poisson's ratio of a material that is not known."""


def _integrals(model: ModalModel, modes: ModesAtSpeed) -> tuple[Array, Array] | None:
    """Integrals of products of two shapes (k, k) and of the shapes (k, 3) over the volume.

    None where not all nodes that move belong to cells with a volume.

    Raises:
        BadCells: a cell's nodes are not in order, or cells are there twice.
    """
    for name, cells in model.cells:
        twice = len(cells) - len(np.unique(np.sort(cells, axis=1), axis=0))
        if twice > 0 and cell(name).dimension == 3:
            raise BadCells(f"{twice} cells {name} are listed twice: expected each once")
    count = modes.frequencies_hz.size
    products, means = np.zeros((count, count)), np.zeros((count, 3))
    loose = np.ones(len(model.points), dtype=bool)
    for name, kind, chunk in model.chunks(3):
        loose[chunk] = False
        points, weights = kind.rule
        sizes = kind.sizes(model.points[chunk], points)
        turned = np.flatnonzero(sizes.min(axis=1) * sizes.max(axis=1) < -_FOLDED * sizes.max(axis=1) ** 2)
        if turned.size:
            nodes = chunk[turned[0]] if model.labels is None else model.labels[chunk[turned[0]]]
            raise BadCells(
                f"a cell {name} is partly inverted, with the nodes {', '.join(map(str, nodes.tolist()))}:"
                " expected them in the order of meshio"
            )
        sizes = np.abs(sizes) * weights
        moved = np.einsum("pn,kcni->kcpi", kind.shape(points), modes.shapes[:, chunk])
        weighed = (moved * np.sqrt(sizes)[..., None]).reshape(count, -1)
        products += weighed @ weighed.T
        means += np.einsum("kcpi,cp->ki", moved, sizes)
    return None if modes.shapes[:, loose].any() or np.diag(products).min() <= 0.0 else (products, means)


_FOLDED = 0.05
"""Part of a cell's largest mapping, of the other sign, from which on its nodes are not in order."""

_CHUNK = 2000
"""Cells whose integrals are taken at once."""

_STILL = 1e-9
"""Displacement over the largest of its mode that counts as none."""


OUTER, TIP = 0.25, 0.02
"""Parts of the radial extent, from the outermost node inwards: whose nodes say where the tip is, and are the tip's."""


def deflection(model: ModalModel, static: Array) -> tuple[float, float | None]:
    """What a static displacement does to a structure.

    Args:
        model: of the structure.
        static: displacement (n, 3) [m].

    Returns:
        The largest displacement [m], and the angle [rad] by which the tip turns about the direction from the axis to
        its middle, right-handed: that of the rotation in the plane across it which fits its nodes best; None where
        the structure surrounds the axis.
    """
    arms, largest = model.load(model.points), float(np.linalg.norm(static, axis=1).max())
    radii = np.linalg.norm(arms, axis=1)
    outwards = arms[radii >= radii.max() - OUTER * np.ptp(radii)].mean(axis=0)
    reach = np.linalg.norm(outwards)
    if reach <= ON_ONE_SIDE * radii.mean():
        return largest, None
    outwards = outwards / reach
    along = arms @ outwards
    tip = along >= along.max() - TIP * np.ptp(along)
    across = np.eye(3) - np.outer(outwards, outwards)
    before, after = ((each - each.mean(axis=0)) @ across for each in (model.points[tip], (model.points + static)[tip]))
    turned = np.arctan2(np.cross(before, after).sum(axis=0) @ outwards, (before * after).sum())
    return largest, float(turned)


def held(shapes: Array) -> NDArray[np.bool_]:
    """Which nodes (n,) none of the shapes (..., n, 3) moves."""
    moved = np.abs(shapes).reshape(-1, *shapes.shape[-2:])
    return np.asarray((moved <= _STILL * moved.max(axis=(1, 2), keepdims=True)).all(axis=(0, 2)))


def largest_strain(model: ModalModel, modes: ModesAtSpeed, number: int) -> float | None:
    """Largest principal strain in the cells in a mode, numbered from 0 [m^-1 per kg^1/2 m].

    Of a shape w about a static displacement u it is that of Green, sym((I + grad u)^T grad w); where none is known, the
    linear one. At each node the mean over the cells that meet there; what the theory has infinite at the rim of a clamp
    and in sharp corners, the mesh has finite. None where no cell with a volume is held.
    """
    shape, total, count = modes.shapes[number], np.zeros((len(model.points), 3, 3)), np.zeros(len(model.points))
    for _, kind, there in model.chunks(3):
        slopes = kind.gradients(model.points[there], kind.nodes)[0]
        moved = np.einsum("cpnj,cni->cpij", slopes, shape[there], optimize=True)
        if modes.static is not None:
            bent = np.einsum("cpnj,cni->cpij", slopes, modes.static[there], optimize=True)
            moved += np.swapaxes(bent, 2, 3) @ moved
        np.add.at(total, there, symmetric(moved))
        np.add.at(count, there, 1.0)
    at = count > 0.0
    if not (held(modes.shapes) & at).any():
        return None
    mean = total[at] / count[at][:, None, None]
    return float(np.abs(np.linalg.eigvalsh(mean)).max())


def faces(cells: Sequence[tuple[str, Ints]]) -> Ints:
    """Triangles (m, 3) of the surface of cells; none without them.

    Mid-side nodes are among their corners.
    """
    triangles = [np.zeros((0, 3), dtype=np.int64)]
    for every, times in faces_of(cells):
        triangles += [every[times == 1][:, list(part)] for part in _triangles(every.shape[1])]
    return np.concatenate(triangles)


def outside(model: ModalModel, points: Array) -> Array | None:
    """How far points (p, 3) lie outside the structure, (p,) [m]; None where no cells have a volume."""
    solid = replace(model, cells=tuple((name, nodes) for name, nodes in model.cells if cell(name).dimension == 3))
    nearest = [_in_cells(solid, point) for point in points]
    return np.array([each[2] for each in nearest if each is not None]) if solid.cells else None


def _triangles(ring: int) -> list[tuple[int, int, int]]:
    """A face of so many nodes around as triangles: its corners are cut off, and a fan fills the rest."""
    if ring <= 4:
        return [(0, k, k + 1) for k in range(1, ring - 1)]
    middles = list(range(1, ring, 2))
    cut = [(k, (k + 1) % ring, (k - 1) % ring) for k in range(0, ring, 2)]
    return cut + [(middles[0], middles[k], middles[k + 1]) for k in range(1, len(middles) - 1)]


_SHARP = 0.8
"""Cosine of the angle between two triangles up to which their common edge is one of the structure's."""


def edges(points: Array, triangles: Ints) -> Ints:
    """Edges (k, 2) of a surface: its boundary, and where it turns sharply."""
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    one, other = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    normals = np.cross(one, other)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    unique, first, inverse, times = np.unique(sides, axis=0, return_index=True, return_inverse=True, return_counts=True)
    last = np.zeros(len(unique), dtype=np.int64)
    last[inverse.ravel()] = np.arange(len(sides))
    turn = np.abs((normals[first // 3] * normals[last // 3]).sum(axis=1))
    return np.asarray(unique[(times != 2) | (turn < _SHARP)])


_SECTIONS = 12
"""Parts of the span in which motions are taken apart."""

FAMILIES = ("flap", "twist", "chord", "lag", "axial")


def families(model: ModalModel, modes: ModesAtSpeed) -> list[str]:
    """Name each mode by the largest share of its motion, one of `FAMILIES`.

    In each of the sections along the span the nodes' mean motion through the thickness is flap, along the chord lag,
    along the span axial; the turn about the span is twist, and what is left bends chords. All nodes count alike. The
    chord of nodes along a line is in the plane of rotation.
    """
    middle = model.points - model.points.mean(axis=0)
    span = _span(model, modes)
    along = middle @ span
    section = np.searchsorted(np.quantile(along, np.linspace(0, 1, _SECTIONS + 1)[1:-1]), along)
    energy = np.zeros((len(FAMILIES), modes.frequencies_hz.size))
    for number in np.unique(section):
        here = section == number
        flat = perpendicular(middle[here] - middle[here].mean(axis=0), span)
        wide = np.linalg.norm(flat, axis=1).max() > _THIN * model.size
        chord = np.linalg.svd(flat, full_matrices=False)[2][0] if wide else _across(span, model.axis)
        moved = modes.shapes[:, here]
        mean = moved.mean(axis=1)
        weight = float(len(flat))
        through = np.cross(span, chord)
        energy[0] += weight * (mean @ through) ** 2
        energy[3] += weight * (mean @ chord) ** 2
        energy[4] += weight * (mean @ span) ** 2
        turned, inertia = np.cross(span, flat), float((flat**2).sum())
        twist = np.einsum("kpi,pi->k", moved, turned) ** 2 / inertia if inertia > 0.0 else 0.0
        energy[1] += twist
        across = perpendicular(moved - mean[:, None], span)
        energy[2] += np.maximum((across**2).sum(axis=(1, 2)) - twist, 0.0)
    return [FAMILIES[k] for k in energy.argmax(axis=0)]


def root_to_centre(points: Array, weights: Array, root: Ints | NDArray[np.bool_]) -> Array | None:
    """Unit vector (3,) from the middle of a root's nodes to the centre of points (n, 3) with weights (n,).

    None where the root lies around the centre, or has no two nodes.
    """
    ends = points[root]
    if len(ends) < 2:
        return None
    way = weights @ points / weights.sum() - ends.mean(axis=0)
    extent = float(np.ptp(points @ way))  # times the length of `way`
    return None if way @ way <= _AROUND * extent else np.asarray(way / np.linalg.norm(way))


_AROUND = 0.1
"""Distance of the centre from the root's middle, over the extent along it, up to which the root lies around it."""

ON_ONE_SIDE = 0.5
"""Distance of the middle of the nodes from the axis, over theirs, up to which they surround it, as a disc does."""


def _span(model: ModalModel, modes: ModesAtSpeed) -> Array:
    """Unit vector (3,) along a structure.

    From its root to its centre; where no root is known, or it lies around that, outwards from the spin axis; where the
    structure surrounds this, its longest extent.
    """
    root = held(modes.shapes)
    if (way := root_to_centre(model.points, np.where(root, 0.0, model.weights), root)) is not None:
        return way
    arms = model.load(model.points)
    arm = arms.mean(axis=0)
    if np.linalg.norm(arm) > ON_ONE_SIDE * np.linalg.norm(arms, axis=1).mean():
        return np.asarray(arm / np.linalg.norm(arm))
    return np.asarray(np.linalg.svd(model.points - model.points.mean(axis=0), full_matrices=False)[2][0])


def _across(direction: Array, axis: Array) -> Array:
    """A unit vector across a direction and the spin axis."""
    other = np.cross(axis, direction)
    if np.linalg.norm(other) < _THIN:
        other = np.cross(direction, np.eye(3)[int(np.abs(direction).argmin())])
    return np.asarray(other / np.linalg.norm(other))
