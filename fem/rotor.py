"""The rotor: spin axis, hub and blade angles, and which effects of spinning count."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, isfinite, pi, sin
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Speed = TypeVar("Speed", float, NDArray[np.float64])


def in_rpm(omega: Speed) -> Speed:
    """Revolutions per minute of a speed, or of an array of speeds, in rad/s."""
    return omega * 30 / pi


def from_rpm(speed: Speed) -> Speed:
    """Rad/s of a speed, or of an array of speeds, in revolutions per minute."""
    return speed * pi / 30


def across(axis: NDArray[Any]) -> NDArray[Any]:
    """I - n n^T, (3, 3): the part of a vector that is perpendicular to an axis, a unit vector (3,)."""
    import numpy as np

    return np.eye(3) - np.outer(axis, axis)


def turning(axis: NDArray[Any]) -> NDArray[Any]:
    """The matrix (3, 3) of v -> n x v with an axis n, a unit vector (3,)."""
    import numpy as np

    return np.cross(np.eye(3), axis)


@dataclass(frozen=True)
class Rotor:
    """The spin axis: it passes hub_radius (m) inside the clamped root and leans by stagger (rad) from z towards y.

    The root turns at the radius hub_radius wherever the mesh draws it; what lies a further out turns at hub_radius + a.
    Where hub_radius is negative the plate is clamped beyond the axis and points at it. With stagger 0 flapping is out
    of the plane of rotation, with pi/2 it is in it.

    Attributes:
        precone (rad): the angle between the plate's length, its x, and the plane of rotation, positive towards the
            axis's end. The plate is laid in the plane of rotation, x outwards and z along the axis; turned about its x
            by the stagger; then raised about the root by the precone, in the plane through axis and x. The axis then is
            (sin precone, cos precone sin stagger, cos precone cos stagger) in the plate's coordinates, and the root's
            radius goes along (cos precone, -sin precone sin stagger, -sin precone cos stagger). What lies a further out
            along x turns at hub_radius + a cos precone.

    Raises:
        ValueError: for values that are not finite.
    """

    hub_radius: float = 0.0
    stagger: float = 0.0
    precone: float = 0.0

    def __post_init__(self) -> None:
        for name, what in (("precone", "angle in rad"), ("hub_radius", "number of m"), ("stagger", "angle in rad")):
            if not isfinite(getattr(self, name)):
                raise ValueError(f"{name} must be a finite {what}, got {getattr(self, name)!r}")

    @property
    def axis(self) -> NDArray[Any]:
        """Unit vector n of the spin axis, (3,)."""
        c = cos(self.precone)
        return _without_dust(sin(self.precone), c * sin(self.stagger), c * cos(self.stagger))

    @property
    def outwards(self) -> NDArray[Any]:
        """Unit vector (3,) from the axis to the root, perpendicular to the axis."""
        s = sin(self.precone)
        return _without_dust(cos(self.precone), -s * sin(self.stagger), -s * cos(self.stagger))

    @property
    def projector(self) -> NDArray[Any]:
        """What leaves the part of a vector that is perpendicular to the axis, (3, 3)."""
        return across(self.axis)

    @property
    def spin(self) -> NDArray[Any]:
        """The matrix (3, 3) of v -> n x v."""
        return turning(self.axis)


def _without_dust(*n: float) -> NDArray[Any]:
    """At a right angle cos is 6e-17, not 0: such dust would couple what is not coupled."""
    import numpy as np

    return np.where(np.abs(n) < 1e-15, 0.0, n)


@dataclass(frozen=True)
class Effects:
    """What is counted. An effect that is off is neither assembled nor solved for.

    Attributes:
        rotary_inertia: that of turning sections, in plates; a solid always has it.

    Raises:
        TypeError: for a switch that is neither True nor False.
        ValueError: for large deflection without stress stiffening, which is part of it.
    """

    stress_stiffening: bool = True
    spin_softening: bool = True
    coriolis: bool = False
    large_deflection: bool = False
    rotary_inertia: bool = True

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:
            if not isinstance(getattr(self, name), bool):
                raise TypeError(f"{name} must be True or False, got {getattr(self, name)!r}")
        if self.large_deflection and not self.stress_stiffening:
            raise ValueError("large_deflection needs stress_stiffening, which is part of it")
