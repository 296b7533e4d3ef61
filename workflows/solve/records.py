"""What a run hands on: frozen records, SI inside, from the stages to the writers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from workflows.decisions.effects import Effect
from workflows.decisions.theorising import Theory
from workflows.scene.scene import Scene

if TYPE_CHECKING:
    from damper import Working

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ErrorParts:
    """What the relative error of a frequency is estimated to consist of, each without sign.

    Attributes:
        mesh: left by the mesh; None where unknown.
        layers: left by the layers of a solid.
        basis: added by the reduced basis that answers many speeds, at most.
        theory: of the plate theory against a solid.
        large_deflection, coriolis: what these would move, where they are left out; None where that is not known.
    """

    mesh: float | None
    layers: float
    basis: float
    theory: float
    large_deflection: float | None
    coriolis: float | None

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

    The error is the relative one of the model as a whole, None where unknown, and is made up of the parts; the damping
    ratio is that of a complex mode. The branch is the number of the mode at the lowest speed that this one continues.
    """

    frequency_hz: float
    family: str
    error_parts: ErrorParts | None = None
    damping_ratio: float | None = None
    branch: int = 0

    @property
    def error_estimate(self) -> float | None:
        """Relative error of the frequency, all parts together."""
        return None if self.error_parts is None else self.error_parts.whole


@dataclass(frozen=True)
class Reduced:
    """The structure as the damper feels it, at its place.

    Attributes:
        f1_hz, M1, K1: frequency, mass and stiffness with the ball stuck.
        f2_hz, M2, K2: the same without the ball.
        floor_tilt: slope over displacement of the cavity's floor as the structure bends [1/m].
    """

    f1_hz: float
    M1: float
    K1: float
    f2_hz: float
    M2: float
    K2: float
    floor_tilt: float = 0.0


@dataclass(frozen=True)
class CavityMode:
    """A mode of the plate as the cavity feels it, its modal mass 1 kg; pairs are along the damper's axes.

    Attributes:
        number: of the mode, from 1.
        stiffness: modal, under the ball's pull but without its inertia [N/m].
        shape: displacement of the cavity [-]; slope: of its floor [1/m].
        drawn: force by a unit acceleration of the root along the axes, but for its sign [kg].
        pressed: force by a unit pressure all over the plate [m²].
    """

    number: int
    stiffness: float
    shape: tuple[float, float]
    slope: tuple[float, float]
    drawn: tuple[float, float] = (0.0, 0.0)
    pressed: float = 0.0


@dataclass(frozen=True)
class CutOff:
    """Amplitude of the last cycle in which the ball moved, over g and over the load; None where it never moves."""

    g: float | None
    ratio: float | None


@dataclass(frozen=True)
class Pendulum:
    """A ball in a hollow floor: frequency along each of the damper's axes [Hz], 0 where it finds no way back.

    `order`: over the rotation's frequency; it is the same at all speeds.
    """

    frequency_hz: tuple[float, float]
    order: tuple[float, float]


@dataclass(frozen=True)
class Energy:
    """Where the energy went [J]; `residual` is what the books do not explain."""

    initial: float
    final: float
    structure: float
    rolling: float
    impact: float
    slip: float
    residual: float

    @property
    def ball_share(self) -> float:
        """Share of the energy lost that the ball took, by rolling, impact and slip."""
        ball = self.rolling + self.impact + self.slip
        lost = ball + self.structure
        return ball / lost if lost > 0 else 0.0


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
    """One ring-down. `amplitude_g`, `sdc` and `peak_velocity` hold a value per vibration cycle.

    `stopped` is when the ball came to rest for good [s], None where it did not (yet); the cut-off is the amplitude
    of the last cycle in which it moved. `modal_energies` [J] are those left at the end in the plate's modes, by number,
    where they are simulated. `history` and `path` are kept at the speed that the pictures show, and there is no path of
    a ball that never moves.
    """

    outcome: str
    impacts: int
    events: int
    duration: float
    stopped: float | None
    ball_mass: float
    release: tuple[float, float]
    intrinsic_sdc: float
    peak_sdc: float | None
    peak_sdc_at_g: float | None
    cutoff_g: float | None
    cutoff_ratio: float | None
    largest_rolling_demand: float | None
    amplitude_g: Floats = field(repr=False)
    sdc: Floats = field(repr=False)
    peak_velocity: Floats = field(repr=False)
    energy: Energy
    modal_energies: dict[int, float] = field(default_factory=dict)
    history: History | None = None
    path: BallPath | None = None


@dataclass(frozen=True, eq=False)
class SpeedPoint:
    """Everything found at one speed. `radius` is the damper's (or the tip's) distance from the axis.

    Attributes:
        cavity_modes: the plate's modes as the cavity feels them, where they are simulated.
        damping: what the scene's release leads to, with its effects.
        working: the damper's own figures, on a floor that tilts as the structure bends.
        level: the same on a level floor, where the scene keeps it level; None where the two do not differ.
        tilted: cut-off with the tilt that the scene leaves out.
        pendulum: of a ball in a hollow floor.
    """

    omega: float
    rpm: float
    radius: float
    load_g: float
    modes: tuple[Mode, ...] = ()
    reduced: Reduced | None = None
    cavity_modes: tuple[CavityMode, ...] = ()
    damping: Damping | None = None
    working: Working | None = None
    level: Working | None = None
    tilted: CutOff | None = None
    pendulum: Pendulum | None = None

    @property
    def tilt_share(self) -> float:
        """Share of the ball's drive that the tilt of the cavity's floor takes, Ω²R slope/ω1² [-]."""
        if self.reduced is None:
            return 0.0
        return self.omega**2 * self.radius * self.reduced.floor_tilt / (2 * math.pi * self.reduced.f1_hz) ** 2


@dataclass(frozen=True, eq=False)
class Surface:
    """The plate's mid-surface with its mode shapes.

    Attributes:
        points: (n, 3) [m].
        cells: kind of cell as meshio calls it, and connectivity (m, 3 or 4).
        outline: the points at the ends of each edge of one cell only, (edges, 2); root: of those that are held.
        shapes: (speeds, modes, n, 3), mass-normalised.
        at: which of the run's speeds the first axis of `shapes` holds.
        thickness: at the points, (n,) [m], where it varies.
        behind: what of complex modes lags a quarter of a period behind `shapes`, like these; None where nothing does.
        finer: the same with points between the mesh's, where these are too few for a smooth picture; its `lines` are
            the edges of the mesh's cells, (k, 2).
    """

    points: Floats = field(repr=False)
    cells: tuple[str, npt.NDArray[np.int64]] = field(repr=False)
    outline: npt.NDArray[np.int64] = field(repr=False)
    root: npt.NDArray[np.int64] = field(repr=False)
    shapes: Floats = field(repr=False)
    at: tuple[int, ...]
    thickness: Floats | None = field(default=None, repr=False)
    behind: Floats | None = field(default=None, repr=False)
    finer: Surface | None = field(default=None, repr=False)
    lines: npt.NDArray[np.int64] | None = field(default=None, repr=False)


@dataclass(frozen=True)
class Diagram:
    """What the modes over speed have beyond the modes themselves.

    Attributes:
        mesh: in words.
        bound: largest relative error of a frequency against the full model at its speed.
        bases: vectors of each reduced basis; none where every speed was solved in full.
        veerings: between which two speeds [rpm] modes of which families cannot be told apart.
        lost: speeds [rpm] asked for at which the plate diverges; critical: where it begins to, if known.
    """

    mesh: str
    bound: float
    bases: tuple[int, ...]
    veerings: tuple[tuple[float, float, tuple[str, ...]], ...]
    lost: tuple[float, ...]
    critical: float | None


@dataclass(frozen=True, eq=False, repr=False)
class Results:
    """A finished run, before anything is written. mesh_sha256: of the mesh file, if the scene names one.

    `workflows.save` and `workflows.save_report` write it out.
    """

    scene: Scene
    effects: dict[str, Effect]
    speeds: tuple[SpeedPoint, ...]
    surface: Surface | None = None
    theory: Theory | None = None
    diagram: Diagram | None = None
    mesh_sha256: str | None = None
    notes: tuple[str, ...] = ()
    timings: dict[str, float] = field(default_factory=dict)


def shown(points: tuple[SpeedPoint, ...]) -> int:
    """Which speed the pictures show: the middle one."""
    return sorted(range(len(points)), key=lambda i: points[i].rpm)[(len(points) - 1) // 2]


def expect(results: object, who: str) -> None:
    """Raise TypeError unless results are what `who` was given."""
    if not isinstance(results, Results):
        raise TypeError(f"{who} takes what run returns, got {type(results).__name__}")
