"""A damper on the structure that carries it, and its own figures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from workflows.effects.effect import Effect
from workflows.scene.scene import Scene
from workflows.solve import damper_stage
from workflows.solve.records import Results, SpeedPoint, Surface

if TYPE_CHECKING:
    from damper import ParticleDamper, Working

QUICK = {"sweeps": 4, "stay": 60}
"""What the working range is measured with where a percent of it does not count."""


@dataclass(frozen=True, eq=False)
class Carried:
    """What carries a damper: its effects, a point for each speed that has an answer, and the plate's surface."""

    effects: dict[str, Effect]
    points: dict[float, SpeedPoint]
    surface: Surface | None


@dataclass(frozen=True, eq=False)
class Placed:
    """The damper of a point on the structure that carries it."""

    number: int
    scene: Scene
    carried: Carried
    point: SpeedPoint
    damper: ParticleDamper
    release: tuple[float, float]

    @property
    def judged(self) -> ParticleDamper:
        """The damper that a verdict speaks of."""
        return damper_stage.judged(self.scene, self.carried.effects, self.point)

    @property
    def results(self) -> Results:
        """A run at this point alone, without the damper's own figures."""
        return Results(self.scene, self.carried.effects, (self.point,), surface=self.carried.surface)


def measured(damper: ParticleDamper, known: dict[ParticleDamper, Working], **how: Any) -> Working:
    """The damper's own figures; those of one that differs in the structure's damping alone are known already."""
    from damper import working

    bare = replace(damper, damping_ratio=0.0)
    if bare not in known:
        known[bare] = working(bare, threads=1, **how)
    return known[bare]
