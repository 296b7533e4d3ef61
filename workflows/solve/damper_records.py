"""What a run finds of the damper at one speed: its own figures, and the ring-down of the scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
import numpy.typing as npt

from workflows.solve.quantity import Part, Quantity, Rows

Floats = npt.NDArray[np.float64]
Pair = tuple[float, float]

_ENDS = ("low", "high")
_CURVE = Rows("curve", "point", "damping ratio over amplitude")
_CYCLES = Rows("cycles", "cycle", "one for each vibration cycle")


@dataclass(frozen=True, eq=False)
class Figures:
    """What a damper does to a steady vibration; amplitudes are the structure's displacements along x at the damper."""

    peak: Annotated[
        float,
        Quantity("1", "largest damping ratio that the ball's losses amount to", "damping_ratio_peak", headline=True),
    ]
    peak_amplitude: Annotated[
        float, Quantity("m", "amplitude at the cavity where that is", "at_amplitude", unknown=True, headline=True)
    ]
    range: Annotated[
        Pair,
        Quantity(
            "m",
            "from where the ball begins to move (or half of the peak is reached) to where half is left",
            ends=_ENDS,
            headline=True,
        ),
    ]
    half: Annotated[
        Pair,
        Quantity("m", "between which the damping is at least half its peak", "half_range", ends=_ENDS, headline=True),
    ]
    cutoff: Annotated[float, Quantity("m", "amplitude up to which the ball stays at rest", unknown=True, headline=True)]
    amplitude: Annotated[Floats, Quantity("m", "amplitude", alone="working_amplitude", rows=_CURVE)]
    damping_ratio: Annotated[Floats, Quantity("1", "damping ratio there", alone="working_damping_ratio", rows=_CURVE)]


@dataclass(frozen=True, eq=False)
class OwnFigures(Figures):
    """The same, with the error of its measurement."""

    error: Annotated[
        float,
        Quantity(
            "1",
            "of the peak and of `half`, relative: spread of the measurement, and what its pace moved",
            alone="working_error",
            headline=True,
        ),
    ]


@dataclass(frozen=True)
class CutOff:
    """That of a ring-down; None where the ball never moves."""

    g: Annotated[
        float | None,
        Quantity("g", "cut-off of a ring-down with the tilt that the scene leaves out; null: the ball never moves"),
    ]
    ratio: Annotated[float | None, Quantity("1", "that over load_g")]


@dataclass(frozen=True)
class Pendulum:
    """A ball in a hollow floor; 0 where it finds no way back. The order is the same at all speeds."""

    frequency_hz: Annotated[Pair, Quantity("Hz", "frequency along each of the damper's axes")]
    order: Annotated[Pair, Quantity("1", "that over the rotation's frequency")]


@dataclass(frozen=True)
class Energy:
    """Where the energy went [J]; `residual` is what the books do not explain."""

    initial: Annotated[float, Quantity("J", "at the release")]
    final: Annotated[float, Quantity("J", "left at the end", short="left")]
    structure: Annotated[float, Quantity("J", "lost to the structure's own damping", short="structure")]
    rolling: Annotated[float, Quantity("J", "lost to rolling resistance", short="rolling")]
    impact: Annotated[float, Quantity("J", "lost in hits of the walls", short="wall hits")]
    slip: Annotated[float, Quantity("J", "lost to slip on the floor", short="slip")]
    residual: Annotated[float, Quantity("J", "not explained by the books")]

    @property
    def ball_share(self) -> float:
        """Share of the energy lost that the ball took, by rolling, impact and slip."""
        ball = self.rolling + self.impact + self.slip
        lost = ball + self.structure
        return ball / lost if lost > 0 else 0.0


@dataclass(frozen=True)
class ModalEnergy:
    """Energy that is left at the end in a mode of the plate."""

    mode: Annotated[int, Quantity("1", "its number", least=1)]
    energy: Annotated[float, Quantity("J")]


@dataclass(frozen=True, eq=False)
class History:
    """The structure's motion, sampled: t (n,) [s], velocity (n, 2) [m/s]."""

    t: Floats = field(repr=False)
    velocity: Floats = field(repr=False)


@dataclass(frozen=True, eq=False)
class BallPath:
    """The ball's way through its cavity over a stretch of a ring-down; straight lines between the times are close.

    Attributes:
        t: (n,) [s], ascending; the time of every event is among them.
        ball: its centre from the cavity's, (n, 2) [m].
        structure: displacement of the cavity, (n, 2) [m].
        regime: from each time on, along each axis, (n, 2): 0 at rest in the cavity, 1 rolling, 2 slipping.
        at: which of the times have an event, (k,); kind: what it is: `release`, `start` (it sets off), `reversal`,
            `hit`, `rub` (along the wall that is hit), `grip` (slip ends); axis: 0 or 1.
    """

    t: Floats = field(repr=False)
    ball: Floats = field(repr=False)
    structure: Floats = field(repr=False)
    regime: npt.NDArray[np.int64] = field(repr=False)
    at: npt.NDArray[np.int64] = field(repr=False)
    kind: tuple[str, ...] = field(repr=False)
    axis: npt.NDArray[np.int64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Damping:
    """One ring-down. Arrays hold a value per vibration cycle.

    What has no annotation is not published, but serves pictures and findings: `stopped` is when the ball came to rest
    for good [s], None where it did not (yet); `ball_mass` that of all balls [kg]; `release` the displacement at the
    release along the damper's axes [m]. `modal_energies` [J] are those left at the end in the plate's modes, by number,
    where they are simulated. `history` and `path` are kept at the speed that the pictures show; there is no path of a
    ball that never moves.
    """

    outcome: str
    impacts: Annotated[int, Quantity("1", "hits of the walls", headline=True)]
    events: Annotated[int, Quantity("1", "events of any kind", headline=True)]
    duration: Annotated[float, Quantity("s", "time simulated", inner=True)]
    stopped: float | None
    ball_mass: float
    release: Pair
    intrinsic_sdc: Annotated[float, Quantity("1", "what the structure's own damping loses in a cycle")]
    peak_sdc: Annotated[
        float | None, Quantity("1", "everything lost in a cycle over its energy, at most", headline=True)
    ]
    peak_sdc_at_g: Annotated[float | None, Quantity("g", "amplitude where that is")]
    cutoff_g: Annotated[float | None, Quantity("g", "amplitude of the last cycle in which the ball moved")]
    cutoff_ratio: Annotated[float | None, Quantity("1", "cutoff_g over load_g", headline=True)]
    largest_rolling_demand: Annotated[
        float | None, Quantity("1", "friction that pure rolling needs, over the normal load")
    ]
    amplitude_g: Annotated[Floats, Quantity("g", "V ω1 / g", rows=_CYCLES)] = field(repr=False)
    sdc: Annotated[
        Floats,
        Quantity(
            "1",
            "null: the ball gave the structure more energy than it had, which is no cycle",
            rows=_CYCLES,
            unknown=True,
        ),
    ] = field(repr=False)
    peak_velocity: Annotated[Floats, Quantity("m/s", "of the structure", rows=_CYCLES)] = field(repr=False)
    energy: Annotated[Energy, Part("joules; residual is what the books do not explain", prefix="energy_")]
    modal_energies: dict[int, float] = field(default_factory=dict)
    history: History | None = None
    path: BallPath | None = None

    @property
    def modal(
        self,
    ) -> Annotated[
        tuple[ModalEnergy, ...],
        Part("left at the end in the plate's modes, joules", "modal_energies", prefix="modal_", along="modal"),
    ]:
        """The modal energies as records."""
        return tuple(ModalEnergy(number, energy) for number, energy in self.modal_energies.items())
