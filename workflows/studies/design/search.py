"""The best design: first all over the space, then about the best; the same seed finds the same design.

Differential evolution on a Sobol' sample, a generation at a time; then Nelder and Mead's simplex over the ranges with
the figures at their full accuracy. What a generation asks for is scored in parts of a fixed size, so that the number of
workers has no part in it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from workflows.studies.design.scored import Found, Scored
from workflows.studies.design.space import Space

if TYPE_CHECKING:
    from workflows.studies.design.scored import Floats

Score: TypeAlias = "Callable[[Floats, bool], list[Scored]]"
"""Scores rows of shares, quickly or with the figures at their full accuracy."""

_POPULATION, _GENERATIONS, _STALE = 32, 40, 8
"""Designs of a generation at least, generations at most, and those without a better design that end the search."""

_BETTER, _LEAST = 1e-3, 1e9
"""Relative gain that counts, and what no score is below."""

_LOCAL, _NEAR = 30, 0.08
"""Designs that the simplex may try for each range, and the size of its first, in shares."""


def search(space: Space, score: Score, seed: int, progress: Callable[[str], None]) -> Found:
    """The best design of a space."""
    known = _Known(space, score, progress)
    best, scored = _about(space, known, _everywhere(space, known, seed))
    return Found(best, scored, known.tried)


class _Known:
    """Scores each design once: of choices, many shares mean the same."""

    def __init__(self, space: Space, score: Score, progress: Callable[[str], None]) -> None:
        self._space, self._score, self._progress = space, score, progress
        self._scores: dict[tuple[object, ...], Scored] = {}

    @property
    def tried(self) -> int:
        """Designs that were scored."""
        return len(self._scores)

    def __call__(self, shares: Floats, quick: bool) -> list[Scored]:
        keys = [(quick, *self._space.values(row).values()) for row in shares]
        new = {key: row for key, row in zip(keys, shares, strict=True) if key not in self._scores}
        if new:
            self._scores |= zip(new, self._score(np.array(list(new.values())), quick), strict=True)
            self._progress(f"{self.tried} designs")
        return [self._scores[key] for key in keys]


def sobol(dimensions: int, count: int, seed: int) -> Floats:
    """So many points, a power of two, spread over the unit cube."""
    from scipy.stats import qmc

    found: Floats = qmc.Sobol(dimensions, scramble=True, rng=seed).random(count)
    return found


def _everywhere(space: Space, score: Score, seed: int) -> Floats:
    from scipy.optimize import Bounds, differential_evolution

    dimensions = len(space.axes)
    first = sobol(dimensions, max(_POPULATION, 1 << (8 * dimensions - 1).bit_length()), seed)
    best, stale = -_LEAST, 0
    at: Floats = first[0]

    def lost(columns: Any) -> Any:
        nonlocal best, stale, at
        found = score(columns.T, True)
        scores = np.array([each.score for each in found])
        k = int(np.argmax(scores))
        if scores[k] > best + _BETTER * abs(best):
            best, stale, at = float(scores[k]), 0, columns.T[k].copy()
        else:
            stale += 1
        return -scores

    how: dict[str, Any] = {"callback": lambda *_, **__: stale >= _STALE}
    differential_evolution(
        lost,
        Bounds(np.zeros(dimensions), np.ones(dimensions)),
        init=first,
        maxiter=_GENERATIONS,
        tol=0.0,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=seed,
        **how,
    )
    return at


def _about(space: Space, score: Score, start: Floats) -> tuple[Floats, Scored]:
    from scipy.optimize import minimize

    best, scored = start, score(start[None], False)[0]
    free = space.continuous
    if not free:
        return best, scored

    def lost(part: Floats) -> float:
        nonlocal best, scored
        shares = start.copy()
        shares[free] = np.clip(part, 0.0, 1.0)
        found = score(shares[None], False)[0]
        if found.score > scored.score:
            best, scored = shares, found
        return -found.score

    corner = start[free]
    away = np.where(corner > 0.5, -_NEAR, _NEAR)
    simplex = np.vstack([corner, corner + np.diag(away)])
    minimize(
        lost,
        corner,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(free),
        options={"initial_simplex": simplex, "maxfev": _LOCAL * len(free), "xatol": 2e-3, "fatol": 0.0},
    )
    return best, scored
