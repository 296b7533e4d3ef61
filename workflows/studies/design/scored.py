"""What a design is worth, the best that was found, and what any goal says of itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from workflows.studies.sweep.placed import Placed

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]

BEYOND, NONE = 100.0, 200.0
"""What a design loses that exceeds a limit, and one that makes no sense."""


@dataclass(frozen=True)
class Scored:
    """What a design is worth.

    Attributes:
        value: what the goal is about: the least damping ratio, or the greatest amplitude [m]; 0 where there is none.
        score: what is searched for the most of.
        bound: what no ball of its mass in its room can better, at the goal's own amplitudes, speeds and forces; nan
            where there is no such figure.
        speed: at which the value is taken [rad/s]; amplitude: at which [m]; order: of the engine, 0 without.
        cutoff: largest amplitude over the speeds up to which the ball stays at rest [m].
        without: amplitude without any ball that the value stands beside [m]; nan where there is none.
        grows: by how much the force may grow at most before no ball is left at rest [-]; nan without a force.
        mass: of all balls [kg].
        used: shares of the limits.
        endured: amplitude that the plate endures [m]; inf where it is not known.
        why: why it is worth nothing; empty where it is worth something.
    """

    value: float
    score: float
    bound: float = math.nan
    speed: float = math.nan
    amplitude: float = math.nan
    cutoff: float = math.nan
    mass: float = math.nan
    used: tuple[tuple[str, float], ...] = ()
    why: str = ""
    order: int = 0
    without: float = math.nan
    grows: float = math.nan
    endured: float = math.inf

    @property
    def impossible(self) -> bool:
        """Whether it exceeds a limit, or makes no sense."""
        return self.score <= -BEYOND

    @property
    def works(self) -> bool:
        """Whether it is worth anything."""
        return not self.why


@dataclass(frozen=True)
class Found:
    """The best design: its shares, its worth with full figures, and how many were tried."""

    shares: Floats
    scored: Scored
    evaluations: int


class Goal(Protocol):
    """What designs are compared by."""

    @property
    def said(self) -> str:
        """What the value is, in words."""

    @property
    def speeds(self) -> tuple[float, ...]:
        """At which a design is looked at, ascending [rad/s]."""

    def worth(self, placed: list[Placed], *, quick: bool) -> Scored:
        """What a damper is worth that is placed on its structure at these speeds; `quick`: to a few percent."""
