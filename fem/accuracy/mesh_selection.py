"""The cheapest mesh of a planform's ladder whose frequencies are good to a tolerance.

Two coarse meshes give an estimate of the error (Richardson 1911), the estimate predicts the mesh that is needed, and
that mesh together with the one before confirms it. Coarse meshes cost next to nothing, so that the search adds
little to the mesh it ends with.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fem.accuracy.edge_layer import folds
from fem.accuracy.error_estimates import Estimates, TrialMeshes
from fem.accuracy.tolerances import EXACT, FIRST, SURE
from fem.assembly import Operators
from fem.linalg import Array
from fem.meshes.mesh_sequence import Planform, begun_with
from fem.theory.registry import Kind, kind, theory_of

MARGIN = 1.25
"""Factor on the error by which the next mesh is chosen, so that one step is mostly enough."""

PAIRED = 1.5
"""Least ratio of the sizes of the first two meshes, where the ladder has it."""

STEP = 2.0
"""Largest ratio of sizes from one mesh to the next: estimates from coarse meshes reach no further."""

CLOSE, APART = 1.5, 1.3
"""Factor on the tolerance up to which an estimate may come down to it by a better order, for which a mesh in between is
cheaper than one beyond; and the least ratio of their sizes."""

PATIENCE = 4
"""Meshes tried before errors that hardly fall end the search: coarse ones may not show yet how they fall."""

PAIR, LARGE = 1.5, 500
"""By how much a mesh that only tells the error of one from a file may exceed that; cells from which this is asked."""


@dataclass(frozen=True, eq=False)
class Choice:
    """A plate on the mesh chosen, and what is known of its errors.

    Attributes:
        size: in the planform's ladder.
        probes: (k,) speeds in rad/s at which errors were estimated, ascending.
        errors: (k, count) relative, of the frequencies, NaN where no other mesh has any.
        tolerance: asked for.
        tried: each size with its largest error.
        rates: (k, count) circular frequencies at the probes in rad/s, NaN where not known.
        states: probes with the displacement (n,) at which the plate rests, where the deflection is large.
    """

    operators: Operators
    size: int
    probes: Array
    errors: Array
    tolerance: float
    tried: tuple[tuple[int, float], ...] = field(default=())
    rates: Array = field(default_factory=lambda: np.full((1, 1), np.nan))
    states: tuple[tuple[float, Array], ...] = field(default=(), repr=False)

    @property
    def met(self) -> bool:
        """Whether the estimates are known and within the tolerance; otherwise the finest mesh allowed was taken."""
        return bool(self.errors.max() <= self.tolerance)

    def errors_at(self, omega: Array) -> Array:
        """Estimated relative errors (k, count) at speeds (k,) in rad/s, between the probes linear in their square."""
        return np.stack([np.interp(omega**2, self.probes**2, column) for column in self.errors.T], axis=-1)


def choose_mesh(
    planform: Planform,
    build: Callable[[int], Operators],
    speeds: tuple[float, ...],
    count: int,
    tolerance: float,
    most: int | None = None,
) -> Choice:
    """The mesh on which the lowest frequencies are good to a relative tolerance.

    Args:
        planform: gives meshes of several sizes.
        build: matrices for a size of the planform.
        speeds: [rad/s]. Errors are estimated at the lowest and the highest, or where the plate diverges there, at the
            lowest alone; a divergence counts if two meshes show it of which one is three times as fine.
        count: of modes.
        tolerance: relative, of frequencies.
        most: unknowns beyond which no finer mesh is tried; default: those of the theory (`fem.theory.registry`).

    Raises:
        Divergence, NoEquilibrium: there is no mode at the lowest speed.
        ValueError: a tolerance of 0 or less.
    """
    if not tolerance > 0.0:
        raise ValueError(f"tolerance must be above 0, got {tolerance!r}")
    probes = tuple(sorted({min(speeds), max(speeds)}))
    search = Estimates(TrialMeshes(planform, build, probes, count, EXACT * tolerance))
    if len(planform.sizes) == 1 or _alone(search.meshes, most):
        unknown = np.full_like(search.meshes.at(planform.sizes[0]).frequencies, np.nan)
        return _end(search, planform.sizes[0], unknown, tolerance)
    coarse, fine = first_pair(planform, count)
    while True:
        before, errors = search.errors(coarse, fine)
        safe = tolerance * _trust(search)
        if errors.max() <= safe:
            before, errors = before - errors, search.doubted(errors, coarse, fine)
            before = before + errors
        if before.max() <= safe:
            return _end(search, coarse, before, tolerance)
        if errors.max() <= safe:
            return _end(search, fine, errors, tolerance)
        between = [size for size in planform.sizes if coarse < size <= fine / APART]
        if between and len(search.largest) > 2 and errors.max() <= CLOSE * tolerance:
            coarse = between[-1]
            continue
        room = min(_most(search.meshes.operators.theory), most or np.inf) / search.meshes.at(fine).unknowns
        following = next_size(planform, fine, float(errors.max()) / tolerance, room)
        if following is None or (search.slow and len(search.largest) > PATIENCE):
            return _end(search, fine, errors, tolerance)
        coarse, fine = fine, following


def _trust(search: Estimates) -> float:
    """Part of the tolerance that an estimate must meet; of solids, thin on coarse cells, two meshes tell too little."""
    if len(search.largest) > 2:
        return SURE
    return 0.0 if kind(search.meshes.operators.theory) is Kind.SOLID else FIRST


def _end(search: Estimates, size: int, errors: Array, tolerance: float) -> Choice:
    meshes = search.meshes
    alive = meshes.alive(size)
    if meshes.lost is not None and not alive.any():
        raise meshes.lost
    trial = meshes.at(size)
    errors = (errors + trial.drifts * folds(trial.operators.plate))[alive]
    return Choice(
        trial.operators,
        size,
        np.array(meshes.probes)[alive],
        np.where(np.isfinite(errors), errors, np.nan),
        tolerance,
        tuple(sorted(search.largest.items())),
        2.0 * np.pi * trial.frequencies[alive],
        trial.states,
    )


def _alone(meshes: TrialMeshes, most: int | None) -> bool:
    """Whether a planform's coarsest mesh is so large that no other is compared with it."""
    coarsest = meshes.planform.sizes[0]
    if _few_cells(meshes.planform):
        return False
    unknowns = meshes.at(coarsest).unknowns
    return not has_pair(meshes.planform, unknowns, meshes.operators.theory, most)


def has_pair(planform: Planform, unknowns: float, theory: str, most: int | None = None) -> bool:
    """Whether the mesh next to the coarsest may be solved to estimate the coarsest one's error.

    Args:
        planform: of the plate.
        unknowns: of its coarsest mesh.
        theory: by name.
        most: unknowns at most; default: those of the theory.
    """
    if len(planform.sizes) == 1:
        return False
    following = unknowns * (planform.sizes[1] / planform.sizes[0]) ** 2
    return _few_cells(planform) or bool(following <= min(PAIR * _most(theory), most or np.inf))


def _few_cells(planform: Planform) -> bool:
    return int(planform.mesh(planform.sizes[0]).t.shape[1]) < LARGE


def _most(theory: str) -> int:
    return theory_of(theory)[0].most_unknowns


def first_pair(planform: Planform, count: int) -> tuple[int, int]:
    """The two meshes to begin with.

    The first has enough cells; the other is `PAIRED` times coarser.
    """
    sizes = planform.sizes
    fine = begun_with(planform, count)
    return max(size for size in sizes if size <= max(fine / PAIRED, sizes[0])), fine


def next_size(planform: Planform, size: int, excess: float, room: float) -> int | None:
    """The size that should bring an error down by a factor, or the largest that may be tried.

    Args:
        planform: of the plate.
        size: the last one tried.
        excess: factor by which its error is too large.
        room: factor by which the unknowns may grow.

    Returns:
        None where no larger size may be tried.
    """
    finer = [other for other in planform.sizes if other > size and (other / size) ** 2 <= room]
    wanted = size * min(max(MARGIN, (MARGIN * excess) ** (2.0 / sum(planform.orders))), STEP)
    return next((other for other in finer if other >= wanted), finer[-1] if finer else None)
