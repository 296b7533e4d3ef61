"""`spindamp design`: the search, and a map around what it found."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import asdict, replace
from functools import partial
from itertools import combinations, product
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from pydantic import TypeAdapter

from workflows.errors import BadInput
from workflows.formatting import significant
from workflows.io import folder, provenance
from workflows.progress import Stages
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, as_scene_file
from workflows.solve import resources
from workflows.solve.model_choice import choose_model
from workflows.solve.results import Floats
from workflows.studies.design import objectives, report
from workflows.studies.design.objectives import LeastAmplitude
from workflows.studies.design.report import Designed, Grid
from workflows.studies.design.space import Optimum, Scored, Space
from workflows.studies.response import respond
from workflows.studies.sweep import executor, plan
from workflows.studies.sweep.evaluate import PlateCache
from workflows.studies.sweep.executor import Workers
from workflows.studies.sweep.plan import Axis
from workflows.versions import versions

Score: TypeAlias = "Callable[[Floats, bool], list[Scored]]"
"""Scores rows of shares, quickly or with the figures at their full accuracy."""

_POPULATION, _GENERATIONS, _STALE = 32, 40, 8
"""Designs of a generation at least, generations at most, and those without a better design that end the search."""

_BETTER, _LEAST = 1e-2, 1e9
"""Relative gain that counts where figures are quick, which are no better than that; what no score is below."""

_FEW, _FOREMOST = 300, 4
"""Designs that are all looked at, where there are no more; those of them that are compared by full figures."""

_MAP = 12
"""Values of each range, in the map around the best and where all designs are looked at."""

_NEAR, _NEAREST = 0.08, 2e-3
"""How far from the best its neighbours are at first, and when the search ends, in shares."""


def search(
    space: Space, score: Score, seed: int, progress: Callable[[str], None], checkpoint: Checkpoint | None = None
) -> Optimum:
    """The best design of a space; `checkpoint`: the designs that were scored before."""
    return _searched(space, _Known(space, score, progress, checkpoint), seed)


def _searched(space: Space, known: _Known, seed: int) -> Optimum:
    few = _few(space)
    best, scored = _about(space, known, _everywhere(space, known, seed) if few is None else _best_of(known, few))
    return Optimum(best, scored, known.tried)


def _few(space: Space) -> Floats | None:
    """All choices and whole numbers, and values all over the ranges, where that makes few designs; else None."""
    looks = [_looks(axis) for axis in space.axes]
    if math.prod(map(len, looks)) > _FEW:
        return None
    return np.array(list(product(*looks)))


def _looks(axis: Axis) -> Floats:
    """Shares of an axis: of each of its values, and all over its range."""
    if axis.spread is None:
        count = len(axis.values)
    elif axis.key.whole:
        count = math.floor(axis.spread.high) - math.ceil(axis.spread.low) + 1
    else:
        return np.linspace(0.0, 1.0, _MAP)
    return (np.arange(count) + 0.5) / count


def _best_of(score: Score, shares: Floats) -> Floats:
    """The best of some designs: those that are best by quick figures are compared by full ones."""
    quick = np.array([each.score for each in score(shares, True)])
    foremost = shares[np.argsort(-quick, kind="stable")[:_FOREMOST]]
    scores = [each.score for each in score(foremost, False)]
    best: Floats = foremost[int(np.argmax(scores))]
    return best


class Checkpoint:
    """Scores in a file, a line each, by which a search that was stopped goes on.

    The file is of one scene, seed and version of the program: another's is begun anew.
    """

    def __init__(self, path: Path, source: SceneFile, seed: int) -> None:
        self._path, self.scores = path, dict[str, Scored]()
        whose = (executor.digest(), versions(), source.scene.model_dump_json(), source.mesh_sha256, seed)
        of = hashlib.sha256(repr(whose).encode()).hexdigest()
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        scored = TypeAdapter(Scored)
        with suppress(ValueError):  # the last line may be cut off
            for key, values in map(json.loads, lines[1:] if lines[:1] == [of] else []):
                self.scores[key] = scored.validate_python(values)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(f"{line}\n" for line in [of, *lines[1 : len(self.scores) + 1]]), encoding="utf-8")

    def add(self, scores: Mapping[str, Scored]) -> None:
        """Keep further ones."""
        with self._path.open("a", encoding="utf-8") as file:
            file.writelines(f"{json.dumps([key, asdict(each)])}\n" for key, each in scores.items())


class _Known:
    """Scores each design once: of choices, many shares mean the same."""

    def __init__(
        self, space: Space, score: Score, progress: Callable[[str], None], checkpoint: Checkpoint | None
    ) -> None:
        self._space, self._score, self._progress, self._kept = space, score, progress, checkpoint
        self._scores: dict[str, Scored] = {}

    @property
    def tried(self) -> int:
        """Designs that were scored."""
        return len(self._scores)

    def __call__(self, shares: Floats, quick: bool) -> list[Scored]:
        keys = [repr((quick, *self._space.values(row).values())) for row in shares]
        before = {} if self._kept is None else self._kept.scores
        self._scores |= {key: before[key] for key in keys if key in before}
        new = {key: row for key, row in zip(keys, shares, strict=True) if key not in self._scores}
        if new:
            scores = dict(zip(new, self._score(np.array(list(new.values())), quick), strict=True))
            self._scores |= scores
            if self._kept is not None:
                self._kept.add(scores)
            self._progress(f"{self.tried} designs")
        return [self._scores[key] for key in keys]


def sobol(dimensions: int, count: int, seed: int) -> Floats:
    """So many points, a power of two, spread over the unit cube."""
    from scipy.stats import qmc

    shares: Floats = qmc.Sobol(dimensions, scramble=True, rng=seed).random(count)
    return shares


def _everywhere(space: Space, score: Score, seed: int) -> Floats:
    from scipy.optimize import Bounds, differential_evolution

    dimensions = len(space.axes)
    first = sobol(dimensions, max(_POPULATION, 1 << (8 * dimensions - 1).bit_length()), seed)
    best, stale = -_LEAST, 0
    at: Floats = first[0]

    def lost(columns: Any) -> Any:
        nonlocal best, stale, at
        screened = score(columns.T, True)
        scores = np.array([each.score for each in screened])
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
    """The best by full figures near a design: of all neighbours at once, then of closer ones."""
    best, scored, step = start, score(start[None], False)[0], _NEAR
    ways = _ways(len(space.axes), space.continuous)
    while len(ways) and step > _NEAREST:
        near = np.clip(best + step * ways, 0.0, 1.0)
        here = score(near, False)
        k = max(range(len(here)), key=lambda n: here[n].score)
        if here[k].score > scored.score:
            best, scored = near[k], here[k]
        else:
            step *= 0.5
    return best, scored


def _ways(dimensions: int, free: list[int]) -> Floats:
    """Steps to either side along each of the free axes, and along two at once: limits are seldom along one."""
    one = np.eye(dimensions)[free]
    pairs = [first + sign * second for first, second in combinations(one, 2) for sign in (-1.0, 1.0)]
    ways: Floats = np.array([sign * way for way in (*one, *pairs) for sign in (-1.0, 1.0)])
    return ways


_GOES_ON = "the designs evaluated so far are kept; the same command resumes"

_PART = 4
"""Designs that a worker takes at a time, at most."""

_plates = PlateCache()
"""Of this process."""


def design(
    scene: SceneLike = DEFAULT,
    *,
    seed: int = 0,
    pool: AbstractContextManager[Workers] | None = None,
    stages: Stages | None = None,
    partial_results: Path | None = None,
) -> Designed:
    """The damper that damps best within what a scene's [design] allows.

    Args:
        scene: with a table [design].
        seed: of the search.
        pool: the workers; default: the cores of this machine.
        stages: the clock.
        partial_results: a file of designs that were scored; a design that was stopped goes on from it.

    Raises:
        BadInput: the scene is wrong, has no [design], or no design keeps to its limits.
        NoAnswer: the plate has none.
    """
    source = as_scene_file(scene)
    resources.check(source)
    clock = stages or Stages()
    space = objectives.space(source, clock)
    checkpoint = None if partial_results is None else Checkpoint(partial_results, source, seed)
    resumed = nullcontext() if checkpoint is None else folder.resumable(_GOES_ON)
    with resumed, pool or executor.local() as workers, clock("design") as step:
        score = partial(scored, workers, executor.digest())
        known = _Known(space, partial(score, space), step.advance, checkpoint)
        optimum = _searched(space, known, seed)
        impossible = optimum.scored.impossible
        constraints = () if impossible else report.holds(space, optimum, score)
        grid = None if impossible else _around(space, optimum, known)
    if partial_results is not None:
        partial_results.unlink()
    if impossible:
        raise _infeasible(space, optimum.scored)
    best = winner(space, optimum)
    if not optimum.scored.works:
        return Designed(space, optimum, constraints, best, "", grid, None)
    shaken = isinstance(space.goal, LeastAmplitude)
    return Designed(space, optimum, constraints, best, _toml(best), grid, respond(best, clock) if shaken else None)


def _infeasible(space: Space, nearest: Scored) -> BadInput:
    """Why no design keeps to the limits, from the one that comes nearest."""
    over = max(nearest.used, key=lambda item: item[1], default=None)
    if over is None or over[1] <= 1:
        return BadInput(f"no design is feasible: {report.obstacle(nearest)}", file=space.source.name, key="[design]")
    name, share = over
    if name == "density":
        problem = (
            f"no design is feasible: the balls of the closest one are {significant(share)} times as dense as osmium"
        )
        return BadInput(problem, file=space.source.name, key="[damper]")
    pressed = (
        f"the floor carries none of these balls, the best at {significant(share)} times the limit of {name}; use"
        " smaller balls, or a harder ball_material or [damper] floor_material"
    )
    taken = f"the closest one needs {significant(share)} times"
    key, problem = {
        "hardness": ("hardness_ratio", pressed),
        "first yield": ("yield_ratio", pressed),
        "mass": ("mass", f"{taken} the mass allowed"),
    }.get(name, ("wall", f"{taken} the plate's thickness, with its walls"))
    value = space.source.written.get("design", {}).get(key, getattr(space.design, key))
    return BadInput(f"no design satisfies it: {problem}", file=space.source.name, key=f"[design] {key}", value=value)


def winner(space: Space, optimum: Optimum) -> SceneFile:
    """The scene with the best damper, without [design]."""
    values = {axis.key: value for axis, value in zip(space.axes, space.values(optimum.shares).values(), strict=True)}
    data = plan.with_values(plan.base(space.source, list(values)), values)
    scene = plan.of_a_point(space.source, data, space.source.scene.rotor.speeds)
    title = f"{space.source.scene.title}, the best damper"[:200]
    return replace(scene, scene=scene.scene.model_copy(update={"title": title}))


def part(space: Space, shares: Floats, quick: bool, digest: str, numbers: tuple[int, int]) -> list[Scored]:
    """Score the designs from a number to before another; what a worker does."""
    executor.same(digest)
    executor.ready()
    return objectives.scored(space, shares[slice(*numbers)], _plates, quick=quick)


def scored(workers: Workers, digest: str, space: Space, shares: Floats, quick: bool) -> list[Scored]:
    """Score designs, part by part on all workers."""
    size = min(max(len(shares) // (2 * max(workers.count(), 1)), 1), _PART)
    parts = [(begin, begin + size) for begin in range(0, len(shares), size)]
    scores = dict(executor.results(workers, partial(part, space, np.asarray(shares), quick, digest), parts))
    return [each for numbers in parts for each in scores[numbers]]


def _around(space: Space, optimum: Optimum, score: Score) -> Grid | None:
    """What designs are worth over two ranges, all else as in the best."""
    free = space.continuous
    if len(free) < 2:
        return None
    x, y = free[:2]
    shares = np.linspace(0.0, 1.0, _MAP)
    rows = np.repeat(optimum.shares[None], _MAP * _MAP, axis=0)
    rows[:, x], rows[:, y] = np.tile(shares, _MAP), np.repeat(shares, _MAP)
    every = score(rows, True)
    xs, ys = (np.array(plan.drawn(space.axes[k], shares), dtype=float) for k in (x, y))
    table = tuple(tuple(every[n : n + _MAP]) for n in range(0, len(every), _MAP))
    return Grid(space.axes[x].name, xs, space.axes[y].name, ys, table)


def _toml(best: SceneFile) -> str:
    choice = choose_model(best, Stages(visible=False))
    return provenance.as_toml(best.scene, choice.effects, choice.theory) + "\n"
