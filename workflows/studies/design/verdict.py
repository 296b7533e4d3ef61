"""What there is to say of the best design: how far below the bound, what holds it, and why none works if none does."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from workflows.findings.worth import AIR
from workflows.studies.design import space as spaces
from workflows.studies.design.search import Found
from workflows.studies.design.space import Space
from workflows.studies.sweep.axes import Spread
from workflows.wording import significant, whole

if TYPE_CHECKING:
    from workflows.studies.design.objective import Scored
    from workflows.studies.design.space import Floats

_HELD = 0.02
"""Share of a range from its end, and of a limit, from which on it counts as what holds the design."""

_FURTHER = 0.05
"""By which a range is taken further, to see what that would give."""


Score: TypeAlias = "Callable[[Space, Floats, bool], list[Scored]]"
"""Scores rows of shares in a space, quickly or with the figures at their full accuracy."""


@dataclass(frozen=True)
class Holds:
    """What keeps the best design from being better.

    Attributes:
        name: what [design] calls it.
        said: in words.
        gain: of the least damping by taking it 5 % further, relative; None where that is not known.
    """

    name: str
    said: str
    gain: float | None = None


def holds(space: Space, found: Found, score: Score) -> tuple[Holds, ...]:
    """The ends of ranges, and the limits, at which the best design lies."""
    held = [
        Holds(name, f"{100 * share:.0f} % of the {name} allowed is used")
        for name, share in found.scored.used
        if share > 1 - _HELD
    ]
    values = space.values(found.shares)
    for k in space.continuous:
        share, axis = found.shares[k], space.axes[k]
        if _HELD < share < 1 - _HELD or axis.spread is None:
            continue
        end = "least" if share < 0.5 else "greatest"
        said = f"{spaces.in_words(axis.name, values[axis.name])} is the {end} allowed"
        held.append(Holds(spaces.NAMES[axis.name], said, _gain(space, found, score, k, upwards=share > 0.5)))
    return tuple(held)


def _gain(space: Space, found: Found, score: Score, k: int, *, upwards: bool) -> float | None:
    """What the best design would gain by going on beyond the end of a range."""
    spread = space.axes[k].spread
    if spread is None or found.scored.value <= 0:
        return None
    low, high = (spread.low, spread.high * (1 + _FURTHER)) if upwards else (spread.low / (1 + _FURTHER), spread.high)
    wider = replace(space.axes[k], spread=Spread(low, high, spread.law))
    axes = (*space.axes[:k], wider, *space.axes[k + 1 :])
    shares = found.shares.copy()
    shares[k] = 1.0 if upwards else 0.0
    (further,) = score(replace(space, axes=axes), shares[None], False)
    return further.value / found.scored.value - 1 if further.value > 0 else None


def verdict(space: Space, found: Found) -> str:
    """The answer in a line."""
    scored = found.scored
    if scored.value <= 0:
        return "No damper of these works over the whole range"
    grade = "as much as the air" if scored.value >= AIR[0] else "less than the air"
    return f"At least a damping ratio of {_percent(scored.value)} %, {grade} gives a blade"


def sentences(space: Space, found: Found, held: tuple[Holds, ...]) -> list[str]:
    """What carries it."""
    scored = found.scored
    if scored.value <= 0:
        return _why_none(space, found)
    low, high = (1e3 * end for end in space.design.amplitude)
    best = ", ".join(spaces.in_words(name, value) for name, value in space.values(found.shares).items())
    lines = [
        f"The best of {found.evaluations} designs tried: {best}; its balls weigh {significant(1e3 * scored.mass)} g.",
        f"From {significant(low)} to {significant(high)} mm, its damping ratio is least at {_rpm(scored.speed)} and"
        f" {significant(1e3 * scored.amplitude)} mm: {_percent(scored.value)} %. Below"
        f" {significant(1e3 * scored.cutoff)} mm the load holds its ball at rest.",
    ]
    if math.isfinite(scored.bound):
        lines.append(
            f"No ball of this mass in this room can do more than {_percent(scored.bound)} % over the whole range: it"
            f" does {100 * scored.value / scored.bound:.0f} % of that."
        )
    for each in held:
        gain = "" if each.gain is None else f"; 5 % further would change the damping by {100 * each.gain:+.1f} %"
        lines.append(f"What holds it: {each.said}{gain}.")
    if not held:
        lines.append("No limit holds it: the best lies inside all ranges.")
    return lines


def _why_none(space: Space, found: Found) -> list[str]:
    """Why nothing works, from the design that comes nearest."""
    scored, damper = found.scored, space.source.scene.damper
    low = space.design.amplitude[0]
    if scored.impossible:
        return [f"The design that comes nearest cannot be: {scored.why}."]
    if not math.isfinite(scored.cutoff):
        return [f"At {_rpm(scored.speed)} the tilt of the floor takes all of what would drive a ball."]
    lines = [
        f"At {_rpm(scored.speed)} the load holds every ball at rest below {significant(1e3 * scored.cutoff)} mm or"
        f" more, and damping from {significant(1e3 * low)} mm on is asked for.",
    ]
    if damper is not None and damper.rolling_friction > 0 and scored.cutoff > low:
        needed = damper.rolling_friction * low / scored.cutoff
        lines.append(
            "A ball begins to roll where its inertia exceeds rolling friction over radius times the load. It would take"
            f" a rolling friction of {significant(1e3 * needed)} mm instead of"
            f" {significant(1e3 * damper.rolling_friction)} mm, or a least amplitude above the cut-off."
        )
    best = ", ".join(spaces.in_words(name, value) for name, value in space.values(found.shares).items())
    return [*lines, f"The lowest cut-off of {found.evaluations} designs tried has {best}."]


def _rpm(omega: float) -> str:
    return f"{whole(float(np.round(omega * 30 / math.pi, 9)))} rpm"


def _percent(ratio: float) -> str:
    return significant(100 * ratio)
