"""What there is to say of the best design by its damping: how far below the bound, and why none works if none does."""

from __future__ import annotations

import math

from workflows.findings.worth import AIR
from workflows.studies.design import words
from workflows.studies.design.damping import LeastDamping
from workflows.studies.design.scored import Found
from workflows.studies.design.space import Space
from workflows.wording import significant


def verdict(found: Found, goal: LeastDamping) -> str:
    """The answer in a line."""
    scored = found.scored
    if not scored.works:
        return "No damper of these works over the whole range"
    grade = "as much as the air" if scored.value >= AIR[0] else "less than the air"
    limit = f", where the plate endures it: up to {significant(1e3 * scored.endured)} mm" * (goal.high > scored.endured)
    return f"At least a damping ratio of {_percent(scored.value)} %, {grade} gives a blade{limit}"


def sentences(space: Space, found: Found, goal: LeastDamping) -> list[str]:
    """What carries it."""
    scored = found.scored
    low, high = 1e3 * goal.low, 1e3 * goal.high
    lines = [
        f"From {significant(low)} to {significant(high)} mm, its damping ratio is least at {words.rpm(scored.speed)}"
        f" and {significant(1e3 * scored.amplitude)} mm: {_percent(scored.value)} %. Below"
        f" {significant(1e3 * scored.cutoff)} mm the load holds its ball at rest.",
    ]
    if math.isfinite(scored.bound):
        lines.append(
            f"No ball of this mass in this room can do more than {_percent(scored.bound)} % over the whole range: it"
            f" does {100 * scored.value / scored.bound:.0f} % of that."
        )
    if space.source.scene.excitation is not None:
        lines.append(
            "[design] amplitude is what designs were compared by; without it, it is the amplitude at the crossings that"
            " [excitation] makes."
        )
    return lines


def why_none(space: Space, found: Found, goal: LeastDamping) -> list[str]:
    """Why nothing works, from the design that comes nearest."""
    scored, damper = found.scored, space.source.scene.damper
    if not math.isfinite(scored.cutoff):
        return [f"At {words.rpm(scored.speed)} the tilt of the floor takes all of what would drive a ball."]
    lines = [
        f"At {words.rpm(scored.speed)} the load holds every ball at rest below {significant(1e3 * scored.cutoff)} mm or"
        f" more, and damping from {significant(1e3 * goal.low)} mm on is asked for.",
    ]
    if damper is not None and damper.rolling_friction > 0 and scored.cutoff > goal.low:
        needed = damper.rolling_friction * goal.low / scored.cutoff
        lines.append(
            "A ball begins to roll where its inertia exceeds rolling friction over radius times the load. It would take"
            f" a rolling friction of {significant(1e3 * needed)} mm instead of"
            f" {significant(1e3 * damper.rolling_friction)} mm, or a least amplitude above the cut-off."
        )
    return [*lines, f"The lowest cut-off of {found.evaluations} designs tried has {words.best(space, found)}."]


def _percent(ratio: float) -> str:
    return significant(100 * ratio)
