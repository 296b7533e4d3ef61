"""What designs are worth: placed on the structure, held against the limits, and then against the goal.

A design beyond a limit is worth nothing; what is compared then is how far beyond.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from workflows.findings import doubt, possible, worth
from workflows.studies.design import space as spaces
from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.scored import BEYOND, NONE, Scored
from workflows.studies.design.space import Space
from workflows.studies.sweep import blocks, plans, quantities
from workflows.studies.sweep.placed import Placed
from workflows.studies.sweep.plates import Plates
from workflows.studies.sweep.quantities import Reasons
from workflows.wording import significant, whole

if TYPE_CHECKING:
    from workflows.studies.design.scored import Floats


def scored(space: Space, shares: Floats, plates: Plates, *, quick: bool) -> list[Scored]:
    """The designs at rows of shares; `quick` where a few percent do not count."""
    plan = space.plan(shares)
    speeds = len(space.goal.speeds)
    rows, reasons = quantities.empty(plans.size(plan)), Reasons()
    placed: list[list[Placed]] = [[] for _ in shares]
    for each in blocks.all_placed(space.solved_as, plan, 0, plates, rows, reasons):
        placed[each.number // speeds].append(each)
    found = []
    for number, mine in enumerate(placed):
        missing = rows["reason"][number * speeds : (number + 1) * speeds]
        if (missing >= 0).any():
            found.append(Scored(0.0, -NONE, why=reasons.texts[int(missing.max())]))
        else:
            found.append(_one(space, mine, quick=quick))
    return found


def _one(space: Space, placed: list[Placed], *, quick: bool) -> Scored:
    """A design on its structure at every speed."""
    scene = placed[0].scene
    mass = max(each.damper.ball_mass for each in placed)
    if (why := _no_verdict(space, placed)) is not None:
        return Scored(0.0, -NONE, mass=mass, why=why)
    used = tuple(spaces.used(space.design, scene, mass).items())
    over = spaces.misfit(space.design, scene, mass)
    if over is not None:
        name, ratio = over
        return Scored(0.0, -BEYOND - math.log(ratio), mass=mass, used=used, why=f"beyond the limit of {name}")
    endured = worth.endured(max(placed, key=lambda each: each.point.omega).results)
    endured = math.inf if endured is None else endured
    return replace(space.goal.worth(placed, quick=quick), mass=mass, used=used, endured=endured)


def _no_verdict(space: Space, placed: list[Placed]) -> str | None:
    """Why there is no verdict on a design, whatever its ball does; None where there may be one."""
    slowest, fastest = (end(placed, key=lambda each: each.point.omega) for end in (min, max))
    if worth.weighs(slowest.point):
        return f"at {whole(slowest.point.rpm)} rpm {doubt.WEIGHT}"
    if (torn := possible.torn_from(fastest.results)) is not None:
        return torn
    if not isinstance(space.goal, LeastDamping):
        return None
    endured = worth.endured(fastest.results)
    if endured is not None and space.goal.low > endured:
        return f"the least of its amplitudes would {worth.beyond(fastest.results)}"
    grip = worth.grip(slowest.results, slowest.point, space.goal.high)
    if grip > worth.DRY:
        taken = f"to roll takes a friction of {significant(grip, 2)} at the greatest of its amplitudes"
        return f"at {whole(slowest.point.rpm)} rpm every ball would slide, for {taken}"
    return None
