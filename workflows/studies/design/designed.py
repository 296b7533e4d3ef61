"""What a search found, and the map around it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.scene.source import SceneFile
from workflows.studies.design import verdict
from workflows.studies.design.holds import Holds
from workflows.studies.design.scored import Found, Scored
from workflows.studies.design.space import Space
from workflows.studies.response import document as response_document
from workflows.studies.response import peaks
from workflows.studies.response.records import Response
from workflows.studies.sweep import plans

if TYPE_CHECKING:
    import numpy.typing as npt

    from workflows.studies.design.scored import Floats


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
        return None if self.response is None else max(row.mean for row in peaks.rows(self.response))


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


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
