"""`spindamp design`: the search, what it found, and a map around it."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput
from workflows.results import resolved
from workflows.scene.file import DEFAULT, SceneFile, SceneLike, opened
from workflows.solve import needs
from workflows.solve.decided import decide
from workflows.stages import Stages
from workflows.studies.design import holds, objective, search, verdict
from workflows.studies.design import space as spaces
from workflows.studies.design.amplitude import LeastAmplitude
from workflows.studies.design.holds import Holds
from workflows.studies.design.scored import Scored
from workflows.studies.design.search import Found
from workflows.studies.design.space import Space
from workflows.studies.response import document as response_document
from workflows.studies.response import told
from workflows.studies.response.records import Response
from workflows.studies.response.study import respond
from workflows.studies.sweep import crew, fingerprint, kernels, plans, scenes
from workflows.studies.sweep.crew import Crew
from workflows.studies.sweep.plates import Plates
from workflows.wording import significant

if TYPE_CHECKING:
    import numpy.typing as npt

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
        found: the best design; where none works, the one that comes nearest.
        holds: what keeps it from being better.
        scene: the scene with the best damper, without [design].
        toml: the same as a file that `run` and `response` take; empty where none works.
        grid: the map around the best: names of the axes, their values in SI, and what designs are worth there.
        response: of the best, where designs are compared by the amplitude at the crossings.
    """

    space: Space
    found: Found
    holds: tuple[Holds, ...]
    scene: SceneFile
    toml: str
    grid: Grid | None
    response: Response | None

    def document(self) -> dict[str, Any]:
        """The machine-readable result."""
        scored, design = self.found.scored, self.space.design
        values = self.space.values(self.found.shares)
        damper = self.scene.scene.damper
        best: dict[str, Any] = {name.partition(".")[2]: plans.said([value])[0] for name, value in values.items()}
        found = {
            "schema_version": 1,
            "title": self.space.source.scene.title,
            "objective": self.space.goal.said,
            "constraints": design.model_dump(mode="json", exclude_none=True),
            "best": best | {"cavity": None if damper is None else list(damper.cavity)},
            "works": scored.works,
            "value": scored.value,
            "at": {"speed": _known(scored.speed), "amplitude": _known(scored.amplitude), "order": scored.order},
            "without": _known(scored.without),
            "bound": _known(scored.bound),
            "cutoff": _known(scored.cutoff),
            "ball_mass": _known(scored.mass),
            "holds": [vars(each) for each in self.holds],
            "evaluations": self.found.evaluations,
            "verdict": verdict.verdict(self.space, self.found),
            "why": verdict.sentences(self.space, self.found, self.holds),
        }
        if self.response is not None:
            found |= {"confirmed": self.confirmed, "crossings": response_document.entries(self.response)}
        return found

    @property
    def confirmed(self) -> float | None:
        """The greatest mean amplitude at the crossings, followed as `response` does [m]; None without."""
        return None if self.response is None else max(row.mean for row in told.rows(self.response))


@dataclass(frozen=True, eq=False)
class Grid:
    """A map: names and values (SI) along x and y, and what the design there is worth, rows of y."""

    x: str
    xs: Floats
    y: str
    ys: Floats
    scored: tuple[tuple[Scored, ...], ...]

    @property
    def values(self) -> Floats:
        """Shape (y, x); nan where a design works nowhere or exceeds a limit."""
        return np.array([[each.value if each.works else np.nan for each in row] for row in self.scored])

    @property
    def beyond(self) -> npt.NDArray[np.bool_]:
        """Where a limit is exceeded, shape (y, x)."""
        return np.array([[each.impossible for each in row] for row in self.scored])


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
    needs.check(source)
    clock = stages or Stages()
    space = spaces.of(source, clock)
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


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
