"""The curves that the report draws and the CSV files hold: made once, used by both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workflows import wording
from workflows.solve.records import Floats, Results, SpeedPoint

ERRORS = "frequency_errors"
"""The file of all frequencies with their errors, beside the curves."""

FILES = r"(frequency_errors|campbell_\w+_\d+|((velocity|ball|displacement)_[xy]|sdc|damping_ratio)_[\d.e+]+rpm)\.csv"
"""What the files of curves are called, as a regular expression: which there are is known at the end of a run only."""


_STILL = 1e-9
"""Part of the largest motion along either axis that counts as none."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve: `name` is its file, `label` what a legend says; columns carry name and unit."""

    name: str
    label: str
    x_column: str
    y_column: str
    x: Floats
    y: Floats


@dataclass(frozen=True)
class Branch:
    """A mode followed over the speeds: its family, number there, and (speed, mode) of the run that it consists of."""

    family: str
    number: int
    places: tuple[tuple[int, int], ...]

    @property
    def label(self) -> str:
        """What a legend says."""
        return f"{self.family} {self.number}"


def branches(results: Results) -> list[Branch]:
    """The modes followed over ascending speeds, each named by its family at the lowest speed it is seen at."""
    tracks: dict[int, list[tuple[int, int]]] = {}
    for at, point in sorted(enumerate(results.speeds), key=lambda each: each[1].rpm):
        for place, mode in enumerate(point.modes):
            tracks.setdefault(mode.branch, []).append((at, place))
    names = _names(results.speeds)
    return [Branch(*names[branch], tuple(track)) for branch, track in tracks.items()]


def labels(points: Sequence[SpeedPoint]) -> dict[int, str]:
    """What a legend calls the branches of some points, by their number."""
    return {branch: f"{family} {number}" for branch, (family, number) in _names(points).items()}


def _names(points: Sequence[SpeedPoint]) -> dict[int, tuple[str, int]]:
    """Family of each branch at the lowest speed it is seen at, and its number there."""
    names: dict[int, tuple[str, int]] = {}
    for mode in (mode for point in sorted(points, key=lambda each: each.rpm) for mode in point.modes):
        if mode.branch not in names:
            names[mode.branch] = mode.family, 1 + sum(family == mode.family for family, _ in names.values())
    return names


def campbell(results: Results) -> list[Curve]:
    """Frequency over speed, one curve for each branch."""
    found = []
    for branch in branches(results):
        points = [(results.speeds[at].rpm, results.speeds[at].modes[place].frequency_hz) for at, place in branch.places]
        rpm, frequency = np.array(points).T
        name = f"campbell_{_slug(branch.family)}_{branch.number}"
        found.append(Curve(name, branch.label, "speed_rpm", "frequency_hz", rpm, frequency))
    return found


def velocity(point: SpeedPoint) -> list[Curve]:
    """The structure's velocity over time along x, and along y if it moves that way (the paper's Fig. 2)."""
    damping = point.damping
    if damping is None or damping.history is None:
        return []
    tag, found = speed_tag(point), []
    for axis, along in zip("xy", damping.history.velocity.T, strict=True):
        if along.any():
            name = f"velocity_{axis}_{tag}"
            found.append(Curve(name, f"along {axis}", "time_s", "velocity_m_s", damping.history.t, along))
    return found


def ball_path(point: SpeedPoint) -> list[Curve]:
    """The ball in its cavity, and the structure, over the stretch of time kept, along the axes that either moves on."""
    path = None if point.damping is None else point.damping.path
    if path is None:
        return []
    tag, found = speed_tag(point), []
    for name, column, motion in (
        ("ball", "position_m", path.ball),
        ("displacement", "displacement_m", path.structure),
    ):
        for i in moving(motion):
            label = f"axis {i + 1}"
            found.append(Curve(f"{name}_{'xy'[i]}_{tag}", label, "time_s", column, path.t, motion[:, i]))
    return found


def moving(motion: Floats) -> list[int]:
    """The axes, from 0, along which something (n, 2) moves."""
    reach = np.abs(motion).max(axis=0)
    return [i for i in range(2) if reach[i] > _STILL * reach.max()]


def capacity(results: Results) -> list[Curve]:
    """Specific damping capacity over the amplitude of the acceleration, a curve per load (Fig. 3)."""
    curves = []
    for point in results.speeds:
        damping = point.damping
        if damping is not None and (known := np.isfinite(damping.sdc)).any():
            label = f"{wording.amount(point.load_g)} g"
            name = f"sdc_{speed_tag(point)}"
            curves.append(Curve(name, label, "amplitude_g", "sdc", damping.amplitude_g[known], damping.sdc[known]))
    return curves


def damping_ratio(results: Results) -> list[Curve]:
    """The ball's equivalent damping ratio over the amplitude, tilt of the floor counted in, a curve per load."""
    curves = []
    for point in results.speeds:
        figures = point.working
        if figures is not None and figures.amplitude.size:
            label = f"{wording.amount(point.load_g)} g"
            name = f"damping_ratio_{speed_tag(point)}"
            curves.append(Curve(name, label, "amplitude_m", "damping_ratio", figures.amplitude, figures.damping_ratio))
    return curves


def every(results: Results) -> list[Curve]:
    """All curves of a run."""
    history = [curve for point in results.speeds for curve in velocity(point) + ball_path(point)]
    return campbell(results) + history + capacity(results) + damping_ratio(results)


def speed_tag(point: SpeedPoint) -> str:
    """A rotation speed as part of a file name: 10000rpm, 12.5rpm."""
    return f"{point.rpm:.13g}rpm"


def _slug(text: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in text)
