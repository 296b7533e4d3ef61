"""Words that both goals use."""

from __future__ import annotations

import math

import numpy as np

from workflows.studies.design import space as spaces
from workflows.studies.design.scored import Found
from workflows.studies.design.space import Space
from workflows.wording import whole


def best(space: Space, found: Found) -> str:
    """The best design, key by key."""
    return ", ".join(spaces.in_words(name, value) for name, value in space.values(found.shares).items())


def rpm(omega: float) -> str:
    """A speed in revolutions."""
    return f"{whole(float(np.round(omega * 30 / math.pi, 9)))} rpm"
