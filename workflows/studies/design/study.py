"""`spindamp design`: the search, and a map around what it found."""

import hashlib
import json
import math
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack, nullcontext, suppress
from dataclasses import asdict, replace
from functools import partial
from itertools import combinations, product
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from pydantic import TypeAdapter

from workflows.errors import BadInput
from workflows.formatting import share
from workflows.io import folder, provenance
from workflows.progress import Stages
from workflows.report.templates import mm
from workflows.scene.load import DEFAULT, SceneFile, SceneLike, as_scene_file
from workflows.solve import resources
from workflows.solve.model_choice import choose_model
from workflows.solve.results import Floats
from workflows.studies.design import report
from workflows.studies.design import space as spaces
from workflows.studies.design.objectives import BEYOND, Evaluation
from workflows.studies.design.report import DesignResult, Grid
from workflows.studies.design.space import Optimum, Space
from workflows.studies.response import respond
from workflows.studies.sweep import executor, plan
from workflows.studies.sweep.executor import Workers

Score: TypeAlias = "Callable[[Floats, bool], list[Evaluation]]"
"""Scores rows of shares, quickly or with the figures at their full accuracy."""

_POPULATION, _GENERATIONS, _STALE = 32, 40, 8
"""Designs of a generation at least, generations at most, and those without a better design that end the search."""

_BETTER, _LEAST = 1e-2, 1e9
"""Relative gain that counts where figures are quick, which are no better than that; what no score is below."""

_FEW, _FOREMOST = 300, 4
"""Designs that are all looked at, where there are no more; those of them that are compared by full figures."""

MAP = 12
"""Values of each range, in the map around the best and where all designs are looked at."""

NEAR, NEAREST = 0.08, 2e-3
"""How far from the best its neighbours are at first, and when the search ends, in shares."""


class Designs:
    """Scores each design once, for of choices many shares mean the same.

    Scores are kept in a file, a line each, by which a search that was stopped goes on. The file is of one scene, seed
    and version of the program: another's is begun anew.
    """

    def __init__(
        self,
        space: Space,
        score: Score,
        progress: Callable[[str], None] = lambda _: None,
        path: Path | None = None,
        seed: int = 0,
    ) -> None:
        self._space, self._score, self._progress, self._path = space, score, progress, path
        self._scores = dict[str, Evaluation]()
        self._before = {} if path is None else self._read(path, seed)

    def _read(self, path: Path, seed: int) -> dict[str, Evaluation]:
        """Scores from before, without a last line that was cut off; the file is ready for further ones."""
        source = self._space.source
        origin = (executor.identity(), source.scene.model_dump_json(), source.files_sha256, seed)
        digest, scores = hashlib.sha256(repr(origin).encode()).hexdigest(), dict[str, Evaluation]()
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        adapter = TypeAdapter(Evaluation)
        with suppress(ValueError):
            for key, values in map(json.loads, lines[1:] if lines[:1] == [digest] else []):
                scores[key] = adapter.validate_python(values)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(f"{line}\n" for line in [digest, *lines[1 : len(scores) + 1]]), encoding="utf-8")
        return scores

    @property
    def count(self) -> int:
        """Designs that were scored, quickly or not."""
        return len({key.partition(", ")[2] for key in self._scores})

    def __call__(self, shares: Floats, quick: bool) -> list[Evaluation]:
        """Scores at rows of shares; `quick` where a few percent do not count."""
        keys = [repr((quick, *self._space.values(row).values())) for row in shares]
        self._scores |= {key: self._before[key] for key in keys if key in self._before}
        new = {key: row for key, row in zip(keys, shares, strict=True) if key not in self._scores}
        if new:
            scores = dict(zip(new, self._score(np.array(list(new.values())), quick), strict=True))
            self._scores |= scores
            if self._path is not None:
                with self._path.open("a", encoding="utf-8") as file:
                    file.writelines(f"{json.dumps([key, asdict(each)])}\n" for key, each in scores.items())
            self._progress(f"{self.count} design{'s' if self.count > 1 else ''}, {self._best()}")
        return [self._scores[key] for key in keys]

    def _best(self) -> str:
        """The best so far, in words."""
        best = max(self._scores.values(), key=lambda each: each.score)
        if not best.works:
            return "none works yet"
        return f"best so far {f'{share(best.value)} %' if self._space.goal.of_damping else mm(best.value)}"


def search(space: Space, designs: Designs, seed: int) -> Optimum:
    """The best design of a space."""
    few = _few(space)
    start = _globally(space, designs, seed) if few is None else _best_of(designs, few)
    return Optimum(*_locally(space, designs, start), designs.count)


def _few(space: Space) -> Floats | None:
    """All choices and whole numbers, and values all over the ranges, where that makes few designs; else None."""
    counts = [None if axis.is_continuous else len(axis.choices) for axis in space.axes]
    shares = [np.linspace(0.0, 1.0, MAP) if n is None else (np.arange(n) + 0.5) / n for n in counts]
    return np.array(list(product(*shares))) if math.prod(map(len, shares)) <= _FEW else None


def _best_of(score: Score, shares: Floats) -> Floats:
    """The best of some designs: those that are best by quick figures are compared by full ones."""
    quick = np.array([each.score for each in score(shares, True)])
    foremost = shares[np.argsort(-quick, kind="stable")[:_FOREMOST]]
    scores = [each.score for each in score(foremost, False)]
    return np.asarray(foremost[int(np.argmax(scores))])


def _globally(space: Space, score: Score, seed: int) -> Floats:
    """Where quick scores are best, by differential evolution from a Sobol' sample."""
    from scipy.optimize import Bounds, differential_evolution

    dimensions = len(space.axes)
    first = plan.sobol(dimensions, max(_POPULATION, 1 << (8 * dimensions - 1).bit_length()), seed)
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

    how: dict[str, Any] = {"init": first, "maxiter": _GENERATIONS, "tol": 0.0, "polish": False, "rng": seed}
    how |= {"vectorized": True, "updating": "deferred", "callback": lambda *_, **__: stale >= _STALE}
    differential_evolution(lost, Bounds(np.zeros(dimensions), np.ones(dimensions)), **how)
    return at


def _locally(space: Space, score: Score, start: Floats) -> tuple[Floats, Evaluation]:
    """The best by full figures near a design: of all neighbours at once, then of closer ones."""
    best, evaluation, step = start, score(start[None], False)[0], NEAR
    ways = _ways(len(space.axes), space.continuous)
    while len(ways) and step > NEAREST:
        near = np.clip(best + step * ways, 0.0, 1.0)
        here = score(near, False)
        k = max(range(len(here)), key=lambda n: here[n].score)
        if here[k].score > evaluation.score:
            best, evaluation = near[k], here[k]
        else:
            step *= 0.5
    return best, evaluation


def _ways(dimensions: int, free: list[int]) -> Floats:
    """Steps to either side along each of the free axes, and along two at once: limits are seldom along one."""
    one = np.eye(dimensions)[free]
    pairs = [first + sign * second for first, second in combinations(one, 2) for sign in (-1.0, 1.0)]
    return np.asarray([sign * way for way in (*one, *pairs) for sign in (-1.0, 1.0)])


_GOES_ON = "the designs evaluated so far are kept; the same command resumes"

_PART = 4
"""Designs that a worker takes at a time, at most."""


def design(
    scene: SceneLike = DEFAULT,
    *,
    seed: int = 0,
    pool: AbstractContextManager[Workers] | None = None,
    stages: Stages | None = None,
    partial_results: Path | None = None,
) -> DesignResult:
    """The damper that damps best within what a scene's [design] allows.

    Args:
        scene: with a table [design].
        seed: of the search.
        pool: the workers, entered when the first ball has to be simulated; default: the cores of this machine.
        stages: the clock.
        partial_results: a file of designs that were scored; a design that was stopped goes on from it.

    Raises:
        BadInput: the scene is wrong, has no [design], or no design satisfies its limits.
        NoAnswer: the plate has none.
    """
    seed = plan.check_seed(seed)
    source = as_scene_file(scene)
    resources.check(source)
    clock = stages or Stages()
    if spaces.exceeded(least := spaces.least_shares(source)) is not None:
        raise _infeasible(source, Evaluation(0.0, -BEYOND, used=tuple(least.items())))
    space = spaces.design_space(source, clock)
    resumed = nullcontext() if partial_results is None else folder.resumable(_GOES_ON)
    with resumed:
        with ExitStack() as started, clock("design") as step:
            score = Scorer(lambda: started.enter_context(pool or executor.local()))
            designs = Designs(space, partial(score, space), step.advance, partial_results, seed)
            optimum = search(space, designs, seed)
            impossible, works = optimum.evaluation.impossible, optimum.evaluation.works
            optimum = spaces.measured_again(space, optimum)
            constraints = () if impossible else report.active_constraints(space, optimum, score)
            optimum = replace(optimum, worst=report.worst_deviation(space, optimum, score))
            grid = None if impossible else _around(space, optimum, designs)
        if not impossible:
            best = winner(space, optimum)
            response = respond(best, clock) if works and not space.goal.of_damping else None
            optimum = optimum if response is None else report.confirmed(optimum, response)
    if partial_results is not None:
        partial_results.unlink()
    if impossible:
        raise _infeasible(source, optimum.evaluation)
    if optimum.is_vague:
        constraints = tuple(replace(each, gain=None) for each in constraints)
    toml = ""
    if optimum.evaluation.works:
        model = choose_model(best, Stages(visible=False))
        toml = provenance.as_toml(best.with_full_paths().scene, model.effects, model.theory) + "\n"
    return DesignResult(space, optimum, constraints, best, toml, grid, response)


_LIMITS = {"hardness": "hardness_ratio", "first yield": "yield_ratio", "mass": "mass", "thickness": "wall"}
"""Limits, and the keys of [design] that set them."""


def _infeasible(source: SceneFile, nearest: Evaluation) -> BadInput:
    """Why no design satisfies the limits, from the closest one."""
    file, (name, share) = source.name, max(nearest.used, key=lambda item: item[1], default=("", 0.0))
    limit = name if share > 1 else ""
    problem = report.infeasible(limit, share, nearest)
    if limit not in _LIMITS:
        return BadInput(problem, file=file, key="[damper]" if limit == "density" else "[design]")
    key = _LIMITS[limit]
    value = source.written.get("design", {}).get(key, getattr(source.scene.design, key))
    return BadInput(problem, file=file, key=f"[design] {key}", value=value)


def winner(space: Space, optimum: Optimum) -> SceneFile:
    """The scene with the best damper, without [design]."""
    values = dict(zip((axis.key for axis in space.axes), space.values(optimum.shares).values(), strict=True))
    data = plan.with_values(plan.base(space.source, list(values)), values)
    scene = plan.of_a_point(space.source, data, space.source.scene.rotor.speeds)
    which = "best" if optimum.evaluation.works else "closest"
    title = f"{space.source.scene.title}, the {which} damper"[:200]
    return replace(scene, scene=scene.scene.model_copy(update={"title": title}))


def part(space: Space, shares: Floats, quick: bool, digest: str, numbers: tuple[int, int]) -> list[Evaluation]:
    """Score the designs from a number to before another; what a worker does."""
    executor.prepare(digest)
    return spaces.evaluate_designs(space, shares[slice(*numbers)], quick=quick)


_ALONE = 6
"""Designs on a plate or blade that are screened before workers start."""


class Scorer:
    """Scores designs: by formulas in this process until a ball has to be simulated, from then on by the workers.

    Workers take seconds to start. In a space in which the load holds every ball of a known structure none starts; a
    plate or blade is solved for each design, and workers start after a few.
    """

    def __init__(self, start: Callable[[], Workers]) -> None:
        self._start = start
        self._workers: Workers | None = None

    def __call__(self, space: Space, shares: Floats, quick: bool) -> list[Evaluation]:
        """Scores at rows of shares."""
        first = shares if space.source.scene.given is not None else shares[:_ALONE]
        scores = spaces.screened(space, first) if self._workers is None else []
        if len(scores) == len(shares):
            return scores
        self._workers = self._workers or self._start()
        rest = shares[len(scores) :]
        return scores + evaluate_on_workers(self._workers, space, rest, quick)


def evaluate_on_workers(workers: Workers, space: Space, shares: Floats, quick: bool) -> list[Evaluation]:
    """Score designs, part by part on all workers."""
    size = int(min(max(len(shares) // (2 * max(workers.count(), 1)), 1), _PART))
    parts = [(begin, begin + size) for begin in range(0, len(shares), size)]
    work = partial(part, space, np.asarray(shares), quick, executor.digest())
    scores = dict(executor.results(workers, work, parts))
    return [each for numbers in parts for each in scores[numbers]]


def _around(space: Space, optimum: Optimum, score: Score) -> Grid | None:
    """What designs are worth over two ranges, the values of the best among them, and all else as in the best."""
    free = space.continuous
    if len(free) < 2:
        return None
    x, y = free[:2]
    along = [np.union1d(np.linspace(0.0, 1.0, MAP), optimum.shares[k]) for k in (x, y)]
    shape = len(along[1]), len(along[0])
    rows = np.repeat(optimum.shares[None], math.prod(shape), axis=0)
    rows[:, x], rows[:, y] = np.tile(along[0], shape[0]), np.repeat(along[1], shape[1])
    every = score(rows, True)
    xs, ys = (np.array(space.axes[k].at(shares), dtype=float) for k, shares in zip((x, y), along, strict=True))
    beyond = np.array([each.impossible for each in every]).reshape(shape)
    values = np.where(beyond, np.nan, np.array([each.value for each in every]).reshape(shape))
    if not space.goal.of_damping:  # an amplitude of 0: nothing drives it
        values = np.where(values == 0, np.nan, values)
    return Grid(space.axes[x].name, xs, space.axes[y].name, ys, values, beyond)
