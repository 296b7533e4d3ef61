"""How a search for a mesh goes on from where it was ended, or from plates like its own: which meshes it still tries.

Errors of coarse meshes tell those of finer ones within a factor only, so that a search may end sooner or later; what it
takes then lies between what the two take.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene.source import SceneFile
from workflows.solve import needs, reckoned

if TYPE_CHECKING:
    from fem.meshes.ladder import Planform
    from workflows.solve.decided import Decided
    from workflows.solve.trials import Trial

DOUBTED = 2.0
"""Factor by which errors may be larger or smaller than those of coarser meshes tell."""


@dataclass(frozen=True)
class Course:
    """Sizes of the meshes that a search tries, ascending, and of that which it chooses: the last, or the one before."""

    sizes: tuple[int, ...]
    chosen: int


def ahead(source: SceneFile, form: Planform, trial: Trial) -> tuple[Course, ...]:
    """The soonest end of a search that was ended, and the latest; one where they are the same, or it is over."""
    choice = trial.discrete.choice
    tried = tuple(size for size, _ in choice.tried) or (choice.size,)
    if choice.following is None:
        return (Course(tried, choice.size),)
    following, left = choice.following, dict(choice.tried).get(choice.size, 0.0)

    def error(size: int) -> float:
        return left * float((choice.size / size) ** _order(form))

    model = choice.operators.model.theory
    most = _most(source, form, model, choice.operators.effects.large_deflection)
    room = most / (trial.unknowns / choice.size**2)
    return _within(lambda factor: course(form, tried, following, error, choice.tolerance / factor, room))


def guessed(source: SceneFile, decided: Decided, model: str, trials: Sequence[Trial]) -> tuple[Course, ...]:
    """The same of a search that is not begun, by the errors of two small plates like its own, if there are any.

    Those of bricks tell too little: all that may be tried are.
    """
    from fem.theory.kind import Kind, kind

    (form, _), sizes = decided.plate, tuple(reckoned.sizes_searched(source, decided, model))
    if kind(model) is Kind.SOLID or len(sizes) == 1:
        return (Course(sizes, sizes[-1]),)
    reference = told(form, trials)
    if reference is None:
        return Course(sizes[:2], sizes[0]), Course(sizes, sizes[-1])
    left, unknowns = reference
    each = needs.unknowns(model, form.mesh(sizes[0])) / sizes[0] ** 2

    def error(size: int) -> float:
        return left * float((unknowns / (each * size**2)) ** (0.5 * _order(form)))

    tolerance = trials[-1].discrete.choice.tolerance
    room = _most(source, form, model, decided.effects["large_deflection"].on) / each
    return _within(lambda factor: course(form, sizes[:1], sizes[1], error, tolerance / factor, room))


def told(form: Planform, trials: Sequence[Trial]) -> tuple[float, float] | None:
    """Largest error of the larger of two plates alike, by Richardson's extrapolation, with its unknowns."""
    if len(trials) < 2:
        return None
    coarse, fine = (trial.discrete.choice.rates for trial in trials[-2:])
    if coarse.shape != fine.shape:  # one of them diverges
        return None
    growth = (trials[-1].unknowns / trials[-2].unknowns) ** (0.5 * _order(form)) - 1.0
    return float(np.abs(coarse / fine - 1.0).max()) / growth, trials[-1].unknowns


def course(
    form: Planform,
    tried: tuple[int, ...],
    following: int,
    error: Callable[[int], float],
    tolerance: float,
    room: float,
) -> Course:
    """A search that goes on as `fem.choose_mesh` does, with errors that are known of each size.

    tried: sizes so far; following: the next. room: square of the largest size.
    """
    from fem.accuracy.budget import FIRST, SURE
    from fem.accuracy.choose_mesh import next_size

    while True:
        coarse, tried = tried[-1], (*tried, following)
        safe = tolerance * (SURE if len(tried) > 2 else FIRST)
        for size in (coarse, following):
            if error(size) <= safe:
                return Course(tried, size)
        finer = next_size(form, following, error(following) / tolerance, room / following**2)
        if finer is None:
            return Course(tried, following)
        following = finer


def _within(of: Callable[[float], Course]) -> tuple[Course, ...]:
    soon, late = of(1.0 / DOUBTED), of(DOUBTED)
    return (soon,) if soon == late else (soon, late)


def _order(form: Planform) -> float:
    return 0.5 * sum(form.orders)


def _most(source: SceneFile, form: Planform, model: str, large_deflection: bool) -> float:
    """Unknowns up to which a search goes."""
    from fem.accuracy.choose_mesh import MOST_UNKNOWNS

    return min(MOST_UNKNOWNS[model.partition("/")[0]], needs.most_unknowns(source, form, model, large_deflection))
