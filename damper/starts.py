"""Motions under a harmonic force at their start: initial states, and the linear response, with and without the ball.

Amplitudes are complex: a coordinate of amplitude z moves as the real part of z exp(i frequency t).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from damper.equations import forces_on, structures_by
from damper.model import break_away_threshold, half_gap, lateral_pull, number, resting_place, rim_threshold
from damper.motion import flights, kinds, prepare
from damper.state import BATCHES, DRIVEN, GOES_ON, MARGIN, TRACE, zeros

if TYPE_CHECKING:
    from collections.abc import Sequence

    from damper.equations import Structures, Systems
    from damper.model import Floats, Harmonic, Parameters, ParticleDamper, Records
    from damper.motion import Flights

Complex = npt.NDArray[np.complexfloating]

_LOSSLESS = 1e-14
"""Loss factor that keeps the answer of a structure without damping finite."""


_MEMORY = 8.0
"""Decay times of the structure's own motion in a window: exp(-16) of it is left at its end."""

_SHORTEST = 256
"""Cycles of a window."""

_HIGHEST = 1e3
"""Largest amplification of a static force that motions begin with, where the structure has next to no damping."""


class Start(StrEnum):
    """Where a motion begins: steady states may exist side by side.

    ``UP``: at rest, in its dent or where the load draws it, as when the force is raised slowly; where it can stay, it
    does. ``DOWN``: with the amplitude of the linear answer and the ball in motion. ``RANDOM``: anywhere between, by the
    number of the point. ``RESONANT``: with the amplitude that the structure alone has at its resonance, in the phase of
    that, and the ball in motion: a ball may keep up large motions off the resonance, most of all in a hollow floor.
    """

    UP = "up"
    DOWN = "down"
    RANDOM = "random"
    RESONANT = "resonant"


def usual_starts(damper: ParticleDamper) -> tuple[Start, ...]:
    """The starts by which steady states are found: on a flat floor no other state was found from resonance."""
    return tuple(Start) if damper.floor_radius is not None else (Start.UP, Start.DOWN, Start.RANDOM)


@dataclass(frozen=True, eq=False)
class Motions:
    """Runs of n motions, dtype `damper.state.DRIVEN`, and what is known of their linear answers, of length n too.

    `flows`: the terms of their flights, of which their systems name theirs.
    """

    runs: Records
    flows: Floats
    linear: Complex
    without: Complex
    moves_from: Floats
    power: Floats


def moves_from(damper: ParticleDamper, harmonics: Sequence[Harmonic]) -> Floats:
    """Factors by which harmonics may grow until the ball cannot stay at rest.

    Args:
        damper: what is driven.
        harmonics: what drives it, n of them.

    Returns:
        Factors of shape (n,) [-]; inf where the ball cannot move. Along either axis of the cavity.
    """
    if not harmonics:
        raise ValueError("harmonics must be at least one")
    rows, f = _driven(damper, harmonics)
    return _moves_from(rows, locked(f.systems).drive)


def _driven(damper: ParticleDamper, harmonics: Sequence[Harmonic]) -> tuple[Parameters, Flights]:
    """A damper's rows and its equations, one for each harmonic."""
    rows = np.repeat(damper.parameters, len(harmonics))
    kinds(damper, rows[:1], harmonics[0])
    return rows, flights(damper, rows, prepare(rows, np.zeros((len(rows), 5, 2)), 1.0, 1.0), tuple(harmonics))


def motions_of(
    damper: ParticleDamper,
    harmonics: Sequence[Harmonic],
    starts: Sequence[Start],
    probe: Sequence[float] | int,
    first: int,
    longest: int,
) -> Motions:
    """One damper under several harmonics, numbered from `first` on, each from every start."""
    rows, f = _driven(damper, harmonics)
    answer, order = locked(f.systems), f.systems.order
    weights = _weights(damper, rows, probe)
    runs = zeros(len(rows), DRIVEN)
    runs["run"] = f.runs
    runs["envelope"], z, cavity = _traces(f.systems, answer, rows, weights[order], longest)
    resonant = np.pad(at_resonance(structures_by(damper, rows), harmonics), ((0, 0), (0, 2)))
    begun = _Answers(z, cavity, resonant[:, order])
    runs["run"]["ball"]["sticking_floor"] = 1e-9 * f.systems.equations.frequency * cavity.max(axis=1)
    parts = {
        "runs": runs,
        "linear": (answer.z * weights[order]).sum(axis=1),
        "without": without_ball(structures_by(damper, rows), harmonics) @ weights[:-2],
        "moves_from": _moves_from(rows, answer.drive),
        "power": np.stack([answer.power_in, answer.power_lost], axis=1),
    }
    repeated = {name: np.repeat(part, len(starts), axis=0) for name, part in parts.items()}
    all_starts = Motions(flows=f.systems.flows, **repeated)
    for column, start in enumerate(starts):
        _begin(start, slice(column, None, len(starts)), all_starts, begun, resting_place(rows, undented=True), first)
    return all_starts


def together(groups: Sequence[Motions]) -> Motions:
    """All motions of several dampers."""
    room = np.max([group.flows.shape[1:] for group in groups], axis=0)
    flows, first = zeros((sum(len(group.flows) for group in groups), *room)), 0
    for group in groups:
        here = (slice(first, first + len(group.flows)), *map(slice, group.flows.shape[1:]))
        flows[here], group.runs["run"]["system"]["flow"] = group.flows, group.runs["run"]["system"]["flow"] + first
        first += len(group.flows)
    names = [f.name for f in fields(Motions) if f.name != "flows"]
    rest = {name: np.concatenate([getattr(each, name) for each in groups]) for name in names}
    return Motions(flows=flows, **rest)


class _Answers(NamedTuple):
    """What starts are measured by: the linear answers, capped, of the coordinates (n, N) and the cavity (n, 2) [m].

    `resonant`: answers of the coordinates (n, N) at the resonance of the mode that moves most without the ball.
    """

    z: Complex
    cavity: Floats
    resonant: Complex


def _weights(damper: ParticleDamper, rows: Parameters, probe: Sequence[float] | int) -> Floats:
    """The probe's weights of the coordinates (q, s)."""
    shape = structures_by(damper, rows[:1]).shape[0]
    if isinstance(probe, int | np.integer):
        if probe not in (0, 1):
            raise ValueError(f"probe must be 0, along x, or 1, along y, or weights of the modes, got {probe}")
        return np.concatenate([shape[int(probe)], [0.0, 0.0]])
    weights = np.array([number("probe", weight) for weight in probe])
    if weights.shape != shape[0].shape:
        raise ValueError(f"probe must be {shape.shape[1]} weights, one for each mode, got {len(weights)}")
    return np.concatenate([weights, [0.0, 0.0]])


def _traces(
    all_of: Systems, answer: Locked, rows: Parameters, probe: Floats, longest: int
) -> tuple[Records, Complex, Floats]:
    """Records of the motions to come, and the linear answers, capped, that they begin with: see `_Answers`."""
    systems, (n, size) = all_of.constants, answer.z.shape
    nu, spring = systems["frequency"], np.einsum("nii->ni", systems["spring"][:, :size, :size]).copy()
    np.put_along_axis(spring, systems["place"], 0.0, axis=1)
    energy = (spring * np.abs(answer.z) ** 2).sum(axis=1)
    if not (energy > 0).all():
        raise ValueError("a harmonic exerts no force on any mode")
    with np.errstate(divide="ignore", invalid="ignore"):
        static = np.where(spring > 0, systems["power"][:, :size] ** 2 / spring, 0.0).sum(axis=1)
        cap = np.minimum(1.0, _HIGHEST * np.sqrt(static / energy))
        scale = np.where(spring > 0, np.sqrt(energy[:, None] / spring), 0.0) * cap[:, None]
    z = answer.z * cap[:, None]
    cavity = np.abs(systems["mode_shape"][:, :, :size] @ z[..., None])[..., 0]
    room = np.minimum(np.linalg.norm(cavity, axis=1)[:, None], half_gap(rows))
    np.put_along_axis(scale, systems["place"], room, axis=1)
    traces = np.zeros(n, TRACE)
    traces["probe"][:, :size], traces["scale"][:, :size] = probe, scale
    traces["still"][:, 0, :size], traces["still"][:, 1, :size] = answer.z.real, -nu[:, None] * answer.z.imag
    traces["drive"], traces["period"] = answer.drive, 2 * math.pi / nu
    traces["patience"] = _patience(forgets(all_of), traces["period"], longest)
    return traces, z, cavity


def _patience(rate: float, period: Floats, longest: int) -> Floats:
    """Cycles of the first window: a multiple of the batches in it, and half of what is allowed at most."""
    remembered = np.inf if rate == 0 else _MEMORY / (rate * period)
    cycles = np.minimum(np.where(np.isfinite(remembered), np.maximum(remembered, _SHORTEST), _SHORTEST), longest / 2)
    return np.asarray(np.maximum(np.ceil(cycles / BATCHES), 1) * BATCHES)


def _begin(start: Start, here: slice, m: Motions, begun: _Answers, rest: Floats, first: int) -> None:
    """Put motions into the states of a start; `rest`: where their balls rest at first, shape (n, 2) [m]."""
    runs = m.runs[here]
    systems, motions = runs["run"]["system"], runs["run"]["motion"]
    frequency, gap = systems["frequency"][:, None], runs["run"]["axes"]["half_gap"]
    n, size = begun.z.shape
    z, s, w = np.zeros((n, size), complex), np.zeros((n, 2)), np.zeros((n, 2))
    if start is Start.UP:
        s = rest
        runs["envelope"]["verdict"] = (m.moves_from[here] >= 1) & (systems["damped"] > 0)
    elif start is Start.DOWN:
        z, w = begun.z, frequency * begun.cavity
    elif start is Start.RESONANT:
        z = begun.resonant
        w = -frequency * (systems["mode_shape"][:, :, :size] @ z.imag[..., None])[..., 0]
    else:
        draws = np.array([np.random.default_rng([first + k, 1]).uniform(-1, 1, 6) for k in range(n)])
        z = begun.z * (0.5 + 0.5 * draws[:, :1]) * np.exp(1j * math.pi * draws[:, 1:2])
        s, w = draws[:, 2:4] * gap, draws[:, 4:] * frequency * begun.cavity
    motions["z"][:, :size], motions["rate"][:, :size] = z.real, -frequency * z.imag
    np.put_along_axis(motions["z"], systems["place"], s, axis=1)
    np.put_along_axis(motions["rate"], systems["place"], w, axis=1)
    runs["run"]["axes"]["spin"] = w


def go_on(m: Motions, states: Floats) -> None:
    """Put motions into the states (n, 2, N) in which others have ended, their balls rolling."""
    run = m.runs["run"]
    motion, place, gap = run["motion"], run["system"]["place"], run["axes"]["half_gap"]
    motion["z"], motion["rate"] = states[:, 0], states[:, 1]
    inside = np.clip(np.take_along_axis(motion["z"], place, axis=1), -gap, gap)
    np.put_along_axis(motion["z"], place, inside, axis=1)
    run["axes"]["spin"] = np.take_along_axis(motion["rate"], place, axis=1)
    m.runs["envelope"]["verdict"] = GOES_ON


class Locked(NamedTuple):
    """The linear answers of n systems of the same damper while the ball is at rest in the middle of its cavity.

    Attributes:
        z: of the coordinates, shape (n, N).
        drive: largest drive of the ball along x and y, shape (n, 2) [m/s^2].
        power_in, power_lost: of the force and of the dashpots, shape (n,) [W].
    """

    z: Complex
    drive: Floats
    power_in: Floats
    power_lost: Floats


def locked(systems: Systems) -> Locked:
    """Solve for the structure's answers, the ball stuck; their coordinates are in the systems' order."""
    of, damped = systems.equations, systems.constants["damped"]
    stiffness, damping, force = of.stiffness[:, 0], of.damping[:, 0], of.force[:, 0]
    nu, size = of.frequency, stiffness.shape[1]
    turn = np.exp(1j * of.phase)[:, None]
    loss = 1j * np.where(damped, 0.0, _LOSSLESS) * nu**2
    matrix = stiffness + 1j * nu[:, None, None] * damping - (nu**2 - loss)[:, None, None] * np.eye(size)
    z = np.linalg.solve(matrix, (force * turn)[..., None])[..., 0]
    rate = (1j * nu[:, None] * z)[:, systems.order]
    pushed, moved = (nu**2)[:, None, None] * of.shape, z[..., None]
    drive = np.abs(((pushed - of.pull) @ moved)[..., 0] + of.sway * turn)
    parts = ((abs(pushed) + abs(of.pull)) @ abs(moved))[..., 0] + abs(of.sway * turn)
    drive[drive < _ROUNDED * parts] = 0.0
    power_in = 0.5 * np.real(of.power[:, systems.order] * turn * rate.conj()).sum(axis=1)
    power_lost = 0.5 * (systems.constants["dashpot"][:, 0, :size] * np.abs(rate) ** 2).sum(axis=1)
    return Locked(z[:, systems.order], drive, power_in, power_lost)


def without_ball(structures: Structures, harmonics: Sequence[Harmonic]) -> Complex:
    """Amplitudes of the modes of the structure alone, shape (n, k)."""
    nu = np.array([harmonic.frequency for harmonic in harmonics])[:, None]
    turn = np.exp(1j * np.array([harmonic.phase for harmonic in harmonics]))[:, None]
    damping = np.where(structures.dashpot > 0, structures.dashpot, _LOSSLESS * structures.mass * nu)
    return np.asarray(
        forces_on(structures, harmonics) * turn / (structures.spring - structures.mass * nu**2 + 1j * nu * damping)
    )


def at_resonance(structures: Structures, harmonics: Sequence[Harmonic]) -> Complex:
    """The same at the resonance of the mode that moves most, alone, shape (n, k); capped where it is hardly damped."""
    moved = np.abs(without_ball(structures, harmonics)) * np.linalg.norm(structures.shape, axis=1)
    most = moved.argmax(axis=1)[:, None]
    turn = np.exp(1j * np.array([harmonic.phase for harmonic in harmonics]))[:, None]
    omega = np.sqrt(structures.spring / structures.mass)
    damping = np.maximum(structures.dashpot, structures.spring / (_HIGHEST * omega))
    answers = forces_on(structures, harmonics) * turn / (1j * omega * damping)
    return np.asarray(np.where(np.arange(answers.shape[1]) == most, answers, 0.0))


def _moves_from(rows: Parameters, drive: Floats) -> Floats:
    """By how much a harmonic may grow until the ball cannot stay at rest, shape (n,); inf where it cannot move."""
    left = break_away_threshold(rows, undented=True)
    rounding = _ROUNDED * (rim_threshold(rows)[:, None] + np.abs(lateral_pull(rows)))
    threshold = MARGIN * np.where(half_gap(rows) > 0, np.maximum(left, 0.0), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(drive > 0, threshold / drive, np.where((left < -rounding) & (threshold == 0), 0.0, np.inf))
    return np.asarray(factor.min(axis=1))


_ROUNDED = 1e-12
"""Share of its parts up to which the ball's drive is what rounding leaves, as where the floor's tilt cancels it."""


def forgets(systems: Systems) -> float:
    """Decay rate of what the structure's own motion leaves longest, the ball stuck; 0 without damping [1/s]."""
    modes = systems.equations.stiffness.shape[-1] - 2
    k, d = (each[0, 0, :modes, :modes] for each in (systems.equations.stiffness, systems.equations.damping))
    roots = np.linalg.eigvals(np.block([[np.zeros_like(k), np.eye(len(k))], [-k, -d]]))
    return max(0.0, float(-roots.real.max())) if systems.constants["damped"][0] else 0.0
