"""`spindamp design`: the search, what it found, and a map around it."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.decisions.decided import decide
from workflows.results import resolved
from workflows.scene.file import DEFAULT, SceneFile, SceneLike, opened
from workflows.solve import needs
from workflows.stages import Stages
from workflows.studies.design import objective, search, verdict
from workflows.studies.design import space as spaces
from workflows.studies.design.objective import Scored
from workflows.studies.design.search import Found
from workflows.studies.design.space import Space
from workflows.studies.design.verdict import Holds
from workflows.studies.sweep import crew, fingerprint, kernels, plans, scenes
from workflows.studies.sweep.crew import Crew
from workflows.studies.sweep.plates import Plates

if TYPE_CHECKING:
    from workflows.studies.design.space import Floats

_PART = 4
"""Designs that a worker takes at a time."""

_MAP = 12
"""Values of each range in the map around the best."""

_plates = Plates()
"""Of this process."""


@dataclass(frozen=True, eq=False)
class Designed:
    """What a search found.

    Attributes:
        space: what it searched.
        found: the best design.
        holds: what keeps it from being better.
        scene: the scene with the best damper, without [design]; None where no design makes sense.
        toml: the same as a file that `run` takes.
        grid: the map around the best: names of the axes, their values in SI, and the least damping there.
    """

    space: Space
    found: Found
    holds: tuple[Holds, ...]
    scene: SceneFile | None
    toml: str
    grid: Grid | None

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        scored, design = self.found.scored, self.space.design
        values = self.space.values(self.found.shares)
        damper = None if self.scene is None else self.scene.scene.damper
        best: dict[str, Any] = {name.partition(".")[2]: plans.said([value])[0] for name, value in values.items()}
        return {
            "schema_version": 1,
            "title": self.space.source.scene.title,
            "objective": "least damping ratio over the amplitudes, at the speed where it is least",
            "constraints": design.model_dump(mode="json", exclude_none=True),
            "best": best | {"cavity": None if damper is None else list(damper.cavity)},
            "value": scored.value,
            "at": {"speed": _known(scored.speed), "amplitude": _known(scored.amplitude)},
            "bound": _known(scored.bound),
            "cutoff": _known(scored.cutoff),
            "ball_mass": _known(scored.mass),
            "holds": [vars(each) for each in self.holds],
            "evaluations": self.found.evaluations,
            "verdict": verdict.verdict(self.space, self.found),
            "why": verdict.sentences(self.space, self.found, self.holds),
        }


@dataclass(frozen=True, eq=False)
class Grid:
    """A map: names and values (SI) along x and y, and the least damping ratio, shape (y, x)."""

    x: str
    xs: Floats
    y: str
    ys: Floats
    values: Floats


def design(
    scene: SceneLike = DEFAULT,
    *,
    seed: int = 0,
    hired: AbstractContextManager[Crew] | None = None,
    stages: Stages | None = None,
) -> Designed:
    """The damper that damps best within what a scene's [design] allows.

    Raises:
        BadInput: the scene is wrong, or has no [design].
        NoAnswer: the plate has none.
    """
    source = opened(scene)
    space = spaces.of(source)
    needs.check(source)
    clock = stages or Stages()
    with hired or crew.local() as workers, clock("design") as step:
        score = partial(scored, workers, fingerprint.digest())
        found = search.search(space, partial(score, space), seed, step.advance)
        held = verdict.holds(space, found, score)
        grid = _around(space, found, partial(score, space))
    best = None if found.scored.impossible else winner(space, found)
    return Designed(space, found, held, best, "" if best is None else _toml(best), grid)


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
    """The least damping over two ranges, all else as in the best design."""
    free = space.continuous
    if len(free) < 2:
        return None
    x, y = free[:2]
    shares = np.linspace(0.0, 1.0, _MAP)
    rows = np.repeat(found.shares[None], _MAP * _MAP, axis=0)
    rows[:, x], rows[:, y] = np.tile(shares, _MAP), np.repeat(shares, _MAP)
    values = np.array([each.value for each in score(rows, True)]).reshape(_MAP, _MAP)
    xs, ys = (np.array(plans.drawn(space.axes[k], shares), dtype=float) for k in (x, y))
    return Grid(space.axes[x].name, xs, space.axes[y].name, ys, values)


def _toml(best: SceneFile) -> str:
    decided = decide(best, Stages(visible=False))
    return resolved.as_toml(best.scene, decided.effects, decided.theory) + "\n"


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
