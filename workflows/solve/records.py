"""What a run hands on: frozen records, SI inside, from the stages to the writers.

Records of the structure and of the damper at one speed have modules of their own and are had from here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
import numpy.typing as npt

from workflows.effects.effect import Effect
from workflows.scene.scene import Scene
from workflows.solve.damper_records import (
    BallPath,
    CutOff,
    Damping,
    Energy,
    Figures,
    Floats,
    History,
    OwnFigures,
    Pendulum,
)
from workflows.solve.quantity import Part, Quantity
from workflows.solve.structure_records import CavityMode, ErrorParts, Mode, Reduced, Theory

__all__ = [
    "SHAPES_AT_MOST",
    "BallPath",
    "CavityMode",
    "CutOff",
    "Damping",
    "Diagram",
    "Energy",
    "ErrorParts",
    "Figures",
    "Floats",
    "History",
    "Mode",
    "OwnFigures",
    "Pendulum",
    "Reduced",
    "Results",
    "SpeedPoint",
    "Surface",
    "expect",
    "rpm",
    "shown",
]

_OWN = "working"

SHAPES_AT_MOST = 20
"""Speeds whose mode shapes are kept for pictures and files."""


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
    rpm: Annotated[float, Quantity("rpm", "rotation speed")]
    radius: float
    load_g: Annotated[float, Quantity("g", "centrifugal acceleration at the damper", headline=True)]
    modes: Annotated[tuple[Mode, ...], Part(along="mode", always=True)] = ()
    reduced: Annotated[Reduced | None, Part("the structure at the damper: 1 with the ball stuck, 2 without it")] = None
    cavity_modes: Annotated[
        tuple[CavityMode, ...],
        Part(
            "a mode of the plate as the cavity feels it, its modal mass 1 kg; pairs are along the damper's axes",
            prefix="cavity_",
            along="cavity_mode",
        ),
    ] = ()
    damping: Annotated[Damping | None, Part("the ring-down of the scene's release", "damper")] = None
    working: Annotated[
        OwnFigures | None,
        Part(
            "the damper's own figures, which neither release nor damping of the structure has a part in; the tilt of"
            " the cavity's floor is counted in. Amplitudes are the structure's displacements along x at the damper, m"
        ),
    ] = None
    level: Annotated[
        Figures | None,
        Part(
            "the same figures on a floor that stays level, where the scene keeps it so; else null",
            "level_floor",
            prefix="level_",
            always=True,
            within=_OWN,
            headline=False,
        ),
    ] = None
    tilted: Annotated[CutOff | None, Part(prefix="tilted_cutoff_", inline=True, within=_OWN)] = None
    pendulum: Annotated[
        Pendulum | None,
        Part(
            "the ball in a hollow floor along the damper's axes: frequency, and that over the rotation's",
            prefix="pendulum_",
            within=_OWN,
        ),
    ] = None

    @property
    def tilt_share(
        self,
    ) -> Annotated[
        float,
        Quantity(
            "1",
            "share of the ball's drive that the tilt of the floor takes: at 1 nothing drives it",
            "floor_tilt_share",
            within=_OWN,
            headline=True,
        ),
    ]:
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


def rpm(omega: float) -> float:
    """Revolutions per minute, without the last digits that the conversion leaves behind."""
    return float(f"{omega * 30 / math.pi:.13g}")


def shown(points: tuple[SpeedPoint, ...]) -> int:
    """Which speed the pictures show: the middle one."""
    return sorted(range(len(points)), key=lambda i: points[i].rpm)[(len(points) - 1) // 2]


def expect(results: object, who: str) -> None:
    """Raise TypeError unless results are what `who` was given."""
    if not isinstance(results, Results):
        raise TypeError(f"{who} takes what run returns, got {type(results).__name__}")
