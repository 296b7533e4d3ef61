"""What a run finds of the structure at one speed: its modes, and what the damper feels of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from workflows.solve.quantity import Part, Quantity

Pair = tuple[float, float]


@dataclass(frozen=True)
class ErrorParts:
    """What the relative error of a frequency is estimated to consist of, each without sign.

    None where a part is not known, or an effect is not left out.
    """

    mesh: Annotated[float | None, Quantity("1", "left by the mesh")]
    layers: Annotated[float, Quantity("1", "left by the layers of a solid")]
    basis: Annotated[float, Quantity("1", "added by the reduced basis that answers many speeds, at most", unknown=True)]
    theory: Annotated[float, Quantity("1", "of the plate theory, against a solid")]
    large_deflection: Annotated[float | None, Quantity("1", "what large deflection would move, left out")]
    coriolis: Annotated[float | None, Quantity("1", "what Coriolis forces would move, left out")]

    @property
    def whole(self) -> float | None:
        """The sum; None where the mesh's part is not known."""
        if self.mesh is None:
            return None
        left_out = (self.large_deflection or 0.0) + (self.coriolis or 0.0)
        return self.mesh + self.layers + self.basis + self.theory + left_out


@dataclass(frozen=True)
class Mode:
    """A mode of the plate at one speed.

    The branch is the number of the mode at the lowest speed that this one continues.
    """

    frequency_hz: Annotated[float, Quantity("Hz", "natural frequency")]
    family: Annotated[str, Quantity("", "what the mode does")]
    error_parts: Annotated[
        ErrorParts | None,
        Part(
            "of the relative error, each without sign; null where unknown, or where an effect is not left out",
            prefix="error_",
        ),
    ] = None
    damping_ratio: Annotated[float | None, Quantity("1", "of a complex mode", absent=True)] = None
    branch: int = 0

    @property
    def error_estimate(
        self,
    ) -> Annotated[float | None, Quantity("1", "relative error of the frequency as a whole, the sum of its parts")]:
        """Relative error of the frequency, all parts together; None where unknown."""
        return None if self.error_parts is None else self.error_parts.whole


@dataclass(frozen=True)
class Reduced:
    """The structure as the damper feels it, at its place: 1 with the ball stuck, 2 without it."""

    f1_hz: Annotated[float, Quantity("Hz", "frequency with the ball stuck", headline=True)]
    M1: Annotated[float, Quantity("kg", "mass with the ball stuck")]
    K1: Annotated[float, Quantity("N/m", "stiffness with the ball stuck")]
    f2_hz: Annotated[float, Quantity("Hz", "frequency without the ball")]
    M2: Annotated[float, Quantity("kg", "mass without the ball", headline=True)]
    K2: Annotated[float, Quantity("N/m", "stiffness without the ball")]
    floor_tilt: Annotated[float, Quantity("1/m", "slope of the cavity's floor over its displacement")] = 0.0


@dataclass(frozen=True)
class CavityMode:
    """A mode of the plate as the cavity feels it, its modal mass 1 kg; pairs are along the damper's axes.

    Attributes:
        drawn: force by a unit acceleration of the root along the axes, but for its sign [kg].
        pressed: force by a unit pressure all over the plate [m²].
    """

    number: Annotated[int, Quantity("1", "of the mode", least=1)]
    stiffness: Annotated[float, Quantity("N/m", "modal, under the ball's pull but without its inertia")]
    shape: Annotated[Pair, Quantity("1", "displacement of the cavity")]
    slope: Annotated[Pair, Quantity("1/m", "of its floor")]
    drawn: Pair = (0.0, 0.0)
    pressed: float = 0.0


@dataclass(frozen=True)
class Theory:
    """The plate theory used, why, and an estimate of its own relative error in frequency against a solid.

    The estimate is the largest of the modes asked for, on a coarse mesh, None where nothing was to be chosen; modes
    have their own.
    """

    name: str
    why: str
    model_error: float | None = None
