"""What the best damper does over amplitude, at every speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.space import Space
from workflows.studies.sweep import blocks, plans, quantities
from workflows.studies.sweep.placed import measured
from workflows.studies.sweep.plates import Plates
from workflows.studies.sweep.quantities import Reasons

if TYPE_CHECKING:
    from damper import ParticleDamper, Working
    from workflows.studies.design.scored import Found


@dataclass(frozen=True, eq=False)
class Curve:
    """The damper at a speed [rev/min], and its figures."""

    rpm: float
    damper: ParticleDamper
    working: Working


def of(space: Space, found: Found, goal: LeastDamping) -> list[Curve]:
    """A curve for each speed at which the best ball takes anything, up to the highest amplitude of the goal."""
    plan = space.plan(np.asarray(found.shares)[None])
    size = plans.size(plan)
    placed = blocks.all_placed(space.source, plan, 0, Plates(), quantities.empty(size), Reasons())
    curves = []
    for each in placed:
        damper = each.judged
        figures = measured(damper, {}, reach=goal.high)
        if figures.amplitude.size:
            curves.append(Curve(each.point.rpm, damper, figures))
    return curves
