"""Structural modes at the cavity, and a harmonic force on them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from damper.parameters import number, pair


@dataclass(frozen=True)
class Mode:
    """A mode of the structure, without the ball, as the cavity feels it; any scale of its coordinate will do.

    Attributes:
        mass: modal mass [kg].
        stiffness: modal stiffness, with what the load does to a ball that stays in its place [N/m].
        shape: displacement of the cavity along x and y for a unit of the mode [-].
        slope: of the cavity's floor along x and y for a unit of the mode [1/m].
        damping_ratio: of the mode [-]; None: the damper's.
        drawn: participation, the mode's force by a unit acceleration of the base along x and y, but for its sign [kg];
            None: as of a structure lumped at the cavity, mass times shape.
    """

    mass: float
    stiffness: float
    shape: tuple[float, float]
    slope: tuple[float, float] = (0.0, 0.0)
    damping_ratio: float | None = None
    drawn: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        for name in ("mass", "stiffness"):
            value = number(name, getattr(self, name))
            if not 0 < value < math.inf:
                raise ValueError(f"a mode's {name} must be positive, got {value:g}")
        for name in ("shape", "slope", "participation"):
            if not all(map(math.isfinite, pair(name, getattr(self, name)))):
                raise ValueError(f"a mode's {name} must be finite, got {getattr(self, name)}")
        if self.damping_ratio is not None and not 0 <= number("damping_ratio", self.damping_ratio) < 1:
            raise ValueError(f"a mode's damping_ratio must be at least 0 and below 1, got {self.damping_ratio:g}")
        for name in ("shape", "slope", "drawn"):  # lists and arrays have no hash
            if getattr(self, name) is not None:
                object.__setattr__(self, name, pair(name, getattr(self, name)))

    @property
    def participation(self) -> tuple[float, float]:
        """`drawn`, or what a structure lumped at the cavity has [kg]."""
        return (self.mass * self.shape[0], self.mass * self.shape[1]) if self.drawn is None else self.drawn


@dataclass(frozen=True)
class Harmonic:
    """A force that goes as cos(frequency t + phase), and a base that moves so.

    Attributes:
        frequency: [rad/s].
        force: at the cavity along x and y [N].
        modal: on each mode, beside that [N]; as many as the damper has modes (without any: one along x, one along y).
        base: acceleration of the structure's root along x and y [m/s^2]; displacements are then relative to the root.
        phase: [rad].
    """

    frequency: float
    force: tuple[float, float] = (0.0, 0.0)
    modal: tuple[float, ...] | None = None
    base: tuple[float, float] = (0.0, 0.0)
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what has no physical sense."""
        if not 0 < number("frequency", self.frequency) < math.inf:
            raise ValueError(f"the harmonic's frequency must be positive, got {self.frequency:g}")
        if self.modal is not None and not isinstance(self.modal, tuple | list):
            raise ValueError(f"modal must be as many numbers as there are modes, or None, got {self.modal!r}")
        modal = [number("modal", value) for value in self.modal or ()]
        values = [*pair("force", self.force), *pair("base", self.base), *modal, number("phase", self.phase)]
        if not all(map(math.isfinite, values)):
            raise ValueError("the harmonic's force, base and phase must be finite")
