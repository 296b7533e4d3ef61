"""A root that yields: its stiffness along the root edge."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite


@dataclass(frozen=True)
class ElasticRoot:
    """Stiffness per length of the root against displacement (N/m per m) and against rotation (N m/rad per m).

    Raises:
        ValueError: unless both are positive and finite: without either the plate could move as a rigid body.
    """

    stiffness: float
    rotational: float

    def __post_init__(self) -> None:
        for name, unit in (("stiffness", "N/m²"), ("rotational", "N m/rad per m")):
            value = getattr(self, name)
            if not (isfinite(value) and value > 0.0):
                raise ValueError(f"{name} must be a positive number of {unit}, got {value!r}")
