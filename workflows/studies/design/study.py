"""`spindamp design`: the search, and a map around what it found."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from workflows.errors import BadInput
from workflows.progress import Stages
from workflows.results import resolved
from workflows.scene.file import DEFAULT, SceneLike, opened
from workflows.scene.source import SceneFile
from workflows.solve import resources
from workflows.solve.decided import decide
from workflows.studies.design import asked, holds, objective, search
from workflows.studies.design.amplitude import LeastAmplitude
from workflows.studies.design.designed import Designed, Grid
from workflows.studies.design.scored import Found, Scored
from workflows.studies.design.space import Space
from workflows.studies.response.study import respond
from workflows.studies.sweep import crew, fingerprint, kernels, plans, scenes
from workflows.studies.sweep.crew import Crew
from workflows.studies.sweep.plates import Plates
from workflows.wording import significant

if TYPE_CHECKING:
    from workflows.studies.design.scored import Floats

_PART = 4
"""Designs that a worker takes at a time."""

_MAP = 12
"""Values of each range in the map around the best."""

_plates = Plates()
"""Of this process."""


def design(
    scene: SceneLike = DEFAULT,
    *,
    seed: int = 0,
    hired: AbstractContextManager[Crew] | None = None,
    stages: Stages | None = None,
) -> Designed:
    """The damper that damps best within what a scene's [design] allows.

    Raises:
        BadInput: the scene is wrong, has no [design], or no design keeps to its limits.
        NoAnswer: the plate has none.
    """
    source = opened(scene)
    resources.check(source)
    clock = stages or Stages()
    space = asked.space(source, clock)
    with hired or crew.local() as workers, clock("design") as step:
        score = partial(scored, workers, fingerprint.digest())
        found = search.search(space, partial(score, space), seed, step.advance)
        if found.scored.impossible:
            raise _infeasible(space, found.scored)
        held = holds.holds(space, found, score)
        grid = _around(space, found, partial(score, space))
    best = winner(space, found)
    if not found.scored.works:
        return Designed(space, found, held, best, "", grid, None)
    shaken = isinstance(space.goal, LeastAmplitude)
    return Designed(space, found, held, best, _toml(best), grid, respond(best, clock) if shaken else None)


def _infeasible(space: Space, nearest: Scored) -> BadInput:
    """Why no design keeps to the limits, from the one that comes nearest."""
    over = max(nearest.used, key=lambda item: item[1], default=None)
    if over is None or over[1] <= 1:
        return BadInput(f"no design makes sense: {nearest.why}", file=space.source.name, key="[design]")
    name, share = over
    if name == "density":
        problem = f"no design can be had: the one that comes nearest is {significant(share)} times as dense as osmium"
        return BadInput(problem, file=space.source.name, key="[damper]")
    key = "mass" if name == "mass" else "wall"
    value = space.source.written.get("design", {}).get(key, getattr(space.design, key))
    what = "the mass allowed" if name == "mass" else "the plate's thickness, with its walls"
    problem = f"no design keeps to it: the one that comes nearest takes {significant(share)} times {what}"
    return BadInput(problem, file=space.source.name, key=f"[design] {key}", value=value)


def winner(space: Space, found: Found) -> SceneFile:
    """The scene with the best damper, without [design]."""
    values = {axis.key: value for axis, value in zip(space.axes, space.values(found.shares).values(), strict=True)}
    data = scenes.with_values(scenes.base(space.source, list(values)), values)
    given = scenes.of_a_point(space.source, data, space.source.scene.rotor.speeds)
    title = f"{space.source.scene.title}, the best damper"[:200]
    return replace(given, scene=given.scene.model_copy(update={"title": title}))


def part(space: Space, shares: Floats, quick: bool, digest: str, number: int) -> list[Scored]:
    """Score a part of some designs; what a worker does."""
    fingerprint.same(digest)
    kernels.ready()
    return objective.scored(space, shares[number * _PART : (number + 1) * _PART], _plates, quick=quick)


def scored(workers: Crew, digest: str, space: Space, shares: Floats, quick: bool) -> list[Scored]:
    """Score designs, part by part on all workers."""
    parts = range(-(-len(shares) // _PART))
    found = dict(crew.results(workers, partial(part, space, np.asarray(shares), quick, digest), parts))
    return [each for number in parts for each in found[number]]


def _around(space: Space, found: Found, score: search.Score) -> Grid | None:
    """What designs are worth over two ranges, all else as in the best."""
    free = space.continuous
    if len(free) < 2:
        return None
    x, y = free[:2]
    shares = np.linspace(0.0, 1.0, _MAP)
    rows = np.repeat(found.shares[None], _MAP * _MAP, axis=0)
    rows[:, x], rows[:, y] = np.tile(shares, _MAP), np.repeat(shares, _MAP)
    every = score(rows, True)
    xs, ys = (np.array(plans.drawn(space.axes[k], shares), dtype=float) for k in (x, y))
    table = tuple(tuple(every[n : n + _MAP]) for n in range(0, len(every), _MAP))
    return Grid(space.axes[x].name, xs, space.axes[y].name, ys, table)


def _toml(best: SceneFile) -> str:
    decided = decide(best, Stages(visible=False))
    return resolved.as_toml(best.scene, decided.effects, decided.theory) + "\n"
