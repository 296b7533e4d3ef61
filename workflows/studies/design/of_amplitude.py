"""What there is to say of the best design by the amplitude at the crossings, and why none helps if none does."""

from __future__ import annotations

import math

from workflows.studies.design import words
from workflows.studies.design.amplitude import LeastAmplitude
from workflows.studies.design.scored import Found
from workflows.studies.design.space import Space
from workflows.wording import significant


def verdict(found: Found) -> str:
    """The answer in a line."""
    scored = found.scored
    if not scored.works:
        return "No damper of these helps at the crossings"
    cut = significant(100 * (1 - scored.value / scored.without), 2)
    more = f", and more than the plate endures ({_mm(scored.endured)} mm)" * (scored.value > scored.endured)
    return (
        f"The greatest amplitude at the crossings is {_mm(scored.value)} mm, {cut} % less than without a damper{more}"
    )


def sentences(found: Found, goal: LeastAmplitude) -> list[str]:
    """What carries it."""
    scored, level = found.scored, _level(goal)
    lines = [
        f"Under {level} it is greatest at order {scored.order} and {words.rpm(scored.speed)}: {_mm(scored.value)} mm;"
        f" without any ball, the greatest of the crossings is {_mm(scored.without)} mm."
    ]
    if scored.bound > 0:
        part = significant(100 * (scored.without - scored.value) / (scored.without - scored.bound), 2)
        lines.append(
            f"No ball of this mass in this room can bring it below {_mm(scored.bound)} mm: its way in the cavity is too"
            f" short to hold the rest of the force. Of what is conceivable, it does {part} %."
        )
    else:
        lines.append(
            "Its mass and its room set no bound: a ball that went from wall to wall in step could hold the whole force."
        )
    return lines


def why_none(space: Space, found: Found, goal: LeastAmplitude) -> list[str]:
    """Why nothing helps, from the design that comes nearest."""
    scored, damper = found.scored, space.source.scene.damper
    place = f"At order {scored.order} and {words.rpm(scored.speed)}, under {_level(goal)},"
    if scored.grows < 1:
        able = significant(100 * (1 - scored.bound / scored.without), 2)
        left = significant(100 * scored.value / scored.without, 4)
        lines = [
            f"{place} the ball of the best moves, but leaves {left} % of the amplitude, {_mm(scored.without)} mm."
            f" Whatever it did, a ball of its mass in its room could take no more than {able} %: a larger mass or room"
            " is needed."
        ]
        return [*lines, f"The best of {found.evaluations} designs tried has {words.best(space, found)}."]
    if not math.isfinite(scored.grows):
        return [f"{place} the tilt of the floor takes all of what would drive a ball."]
    lines = [
        f"{place} the structure vibrates by {_mm(scored.without)} mm, and the load holds every ball at rest up to"
        f" {significant(scored.grows, 3)} times as much or more."
    ]
    if damper is not None and damper.rolling_friction > 0:
        needed = damper.rolling_friction / scored.grows
        lines.append(
            "A ball begins to roll where its inertia exceeds rolling friction over radius times the load. It would take"
            f" a rolling friction of {significant(1e3 * needed)} mm instead of"
            f" {significant(1e3 * damper.rolling_friction)} mm, or that much more force."
        )
    return [*lines, f"The ball of {found.evaluations} designs tried that moves first has {words.best(space, found)}."]


def _level(goal: LeastAmplitude) -> str:
    return f"{significant(max(goal.excitation.levels))} {goal.excitation.unit}"


def _mm(length: float) -> str:
    return significant(1e3 * length)
