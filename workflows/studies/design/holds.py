"""What keeps the best design from being better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

from workflows.studies.design import space as spaces
from workflows.studies.design.scored import Found
from workflows.studies.design.space import Space
from workflows.studies.sweep.axes import Spread

if TYPE_CHECKING:
    from workflows.studies.design.scored import Floats, Scored

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
        gain: of the value by taking it 5 % further, relative; None where that is not known.
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
    if spread is None or not found.scored.works:
        return None
    low, high = (spread.low, spread.high * (1 + _FURTHER)) if upwards else (spread.low / (1 + _FURTHER), spread.high)
    wider = replace(space.axes[k], spread=Spread(low, high, spread.law))
    axes = (*space.axes[:k], wider, *space.axes[k + 1 :])
    shares = found.shares.copy()
    shares[k] = 1.0 if upwards else 0.0
    (further,) = score(replace(space, axes=axes), shares[None], False)
    return further.value / found.scored.value - 1 if further.works else None
