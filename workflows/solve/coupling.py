"""The structure at the cavity: from a speed point to the arguments of a `damper.ParticleDamper`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np

import fem
from damper import Mode, ParticleDamper
from damper.state import MODES
from workflows.effects.definition import Effect
from workflows.errors import BadInput, present
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve.results import STILL, CavityMode, Pendulum, Reduced, SpeedPoint, copy_fields, leading_mode


def known_structure(scene: Scene, omega: float) -> SpeedPoint:
    """The speed point of a scene without a plate: its frequency and mass are given (K1 = K2 = M1 ω1²)."""
    structure, rotor = present(scene.given), scene.rotor
    m2, f1 = structure.mass, structure.frequency[0]
    m1 = m2 + ball_mass(scene, m2)
    stiffness = m1 * (2 * math.pi * f1) ** 2
    f2 = math.sqrt(stiffness / m2) / (2 * math.pi)
    reduced = Reduced(f1, m1, stiffness, f2, m2, stiffness, structure.floor_tilt[0])
    return SpeedPoint.at(omega, present(rotor.radius), rotor.gravity, reduced=reduced)


def with_forced_effects(source: SceneFile) -> SceneFile:
    """The scene as its forced response is computed, whatever its [effects]: the answer is about the blade.

    The floor of the cavity tilts, and a plate moves in its own modes.
    """
    given = source.scene.given
    tilted: bool | str = "auto" if given is not None and given.level else True
    return source.changed(effects={"floor_tilt": tilted, "structural_modes": True if given is None else "auto"})


def ball_mass(scene: Scene, m2: float) -> float:
    """Mass of all balls together [kg] at an effective mass M2."""
    spec = present(scene.damper)
    return spec.balls if spec.balls is not None else (spec.mass_ratio or 0.0) * m2


def structure(
    scene: Scene, effects: dict[str, Effect], point: SpeedPoint, only: Sequence[CavityMode] | None = None
) -> dict[str, Any]:
    """Mass, springs, tilt and modes of the structure, and the spin that draws the ball outwards in its plane.

    `only`: the plate's modes to take; None: as many as the accuracy needs.

    Without modes of its own the stiffness is K1: the ball, rolling or not, presses on the cavity's floor and stiffens
    the plate.
    """
    reduced, tilted = present(point.reduced), effects["floor_tilt"].on
    hollow = scene.damper is not None and scene.damper.floor_radius is not None
    turning: dict[str, Any] = {}
    if scene.given is None and (tilted or hollow):
        turning = {"rotation": point.omega, "stagger": point.stagger}
    if effects["structural_modes"].on and point.cavity_modes:
        modes = damper_modes(scene, point) if only is None else only
        return _of_modes(scene, point, modes, tilts=tilted) | turning
    stiffness, tilt = (reduced.K1, reduced.K1), (reduced.floor_tilt,) * 2
    if scene.given is not None:
        first, second = scene.given.frequency
        stiffness, tilt = (reduced.K1, reduced.K1 * (second / first) ** 2), scene.given.floor_tilt
    tilt = tilt if tilted else (0.0, 0.0)
    return {"modal_mass": reduced.M2, "stiffness": stiffness, "floor_tilt": tilt, **turning}


def _of_modes(scene: Scene, point: SpeedPoint, modes: Sequence[CavityMode], *, tilts: bool) -> dict[str, Any]:
    """The structure of several modes; mass and stiffness are those of the mode that yields most along each axis."""
    first, across = leading_mode(modes, 0), leading_mode(modes, 1)
    if first is None:
        raise ValueError("none of the modes moves the cavity along the bending direction")
    mass = first.shape[0] ** -2
    ball = ball_mass(scene, present(point.reduced).M2)
    own = first.stiffness * mass
    return {
        "modal_mass": mass,
        "stiffness": (own, own if across is None else (mass + ball) * across.square(ball, 1)),
        "modes": tuple(Mode(1.0, m.stiffness, m.shape, m.slope if tilts else (0.0, 0.0), drawn=m.drawn) for m in modes),
    }


def damper_modes(
    scene: Scene, point: SpeedPoint, crossed: CavityMode | None = None, *, every: bool = True
) -> tuple[CavityMode, ...]:
    """As few of the plate's modes as `accuracy.damping` needs, ascending.

    Those that yield most along either axis, the one that an order crosses, and with `every` the others that a hit feeds
    enough: by `Budget.scattered`, the heaviest first as far as there is room.
    """
    modes = point.cavity_modes
    if point.reduced is None or not modes:
        return ()
    leaders = {each.number for each in (*(leading_mode(modes, axis) for axis in range(2)), crossed) if each is not None}
    ball, most = ball_mass(scene, point.reduced.M2), scene.budget.scattered
    others = sorted((m for m in modes if m.number not in leaders), key=lambda m: -math.hypot(*m.shape))
    needed = [m for m in others if every and ball * math.hypot(*m.shape) ** 2 > most]
    numbers = leaders | {m.number for m in needed[: MODES - len(leaders)]}
    return tuple(_on_axis(m) for m in modes if m.number in numbers)


def _on_axis(mode: CavityMode) -> CavityMode:
    """The mode without the displacements and slopes that symmetry forbids and rounding leaves."""
    still = [abs(part) <= STILL * math.hypot(*mode.shape) for part in mode.shape]
    x, y = (0.0 if none else part for none, part in zip(still, mode.shape, strict=True))
    a, b = (0.0 if none else part for none, part in zip(still, mode.slope, strict=True))
    return replace(mode, shape=(x, y), slope=(a, b))


def pendulum(damper: ParticleDamper, omega: float) -> Pendulum | None:
    """Frequencies of a ball that swings in a hollow floor, at small amplitudes; None on a flat one.

    omega_s² = beta (G / rho - Omega² P), P the axis' share in the plane of rotation.
    """
    if damper.floor_radius is None or (damper.rotation == 0.0 and damper.centrifugal_acceleration == 0.0):
        return None
    sides = (math.sin(damper.stagger) ** 2, math.cos(damper.stagger) ** 2)
    parts = []
    for radius, side in zip(damper.floor_radius, sides, strict=True):
        pull = damper.centrifugal_acceleration / (radius - damper.ball_radius) - damper.rotation**2 * side
        parts.append(math.sqrt(max(damper.inertia_ratio * pull, 0.0)) / (2 * math.pi))
    x, y = parts
    turns = omega / (2 * math.pi)
    return Pendulum((x, y), (x / turns, y / turns) if turns > 0 else (math.nan, math.nan))


def shortening(point: SpeedPoint) -> float:
    """By how much the damper's place comes nearer to the axis, over half the square of its displacement [1/m].

    A pull through a place at R - c u²/2 stiffens the structure by Omega² (R c - outwards²) a kilogram.
    """
    reduced = point.reduced
    if reduced is None or point.omega == 0 or reduced.pull == 0:
        return 0.0
    return (reduced.pull + point.outwards**2) / point.radius


def resting_share(system: ParticleDamper, point: SpeedPoint) -> float:
    """What moves a ball at rest at all over what moves it along x by the forces that its motion counts."""
    first = moves_first_from(system, point)
    return first / system.amplitude_of(system.break_away_threshold) if first < math.inf else 1.0


def moves_first_from(system: ParticleDamper, point: SpeedPoint) -> float:
    """Amplitude along x [m] from which on a resting ball moves before its counted motion begins; inf: it does not.

    Coriolis forces grow with the square of the amplitude, and move it in any case where 2 c Omega omega u u' reaches
    twice what holds it. A ball at a wall is held by that as well: there none of it counts.
    """
    alone = system.amplitude_of(system.break_away_threshold)
    turn, omega, load = system.rotation, system.swing_frequency, system.centrifugal_acceleration
    hold, nearer = system.rolling_threshold + system.break_away * load, shortening(point)
    most = math.sqrt(2 * hold / (turn * omega * abs(nearer))) if turn * nearer != 0 else math.inf
    most = min(alone, most)
    if turn == 0 or system.half_gap[0] == 0 or not 0 < most < math.inf or any(system.lateral_pull):
        return math.inf
    low, high = 0.0, most
    for _ in range(2):
        amplitude = np.linspace(low, high, 16)
        excess = load * grip_needed(system, point, amplitude) - hold
        first = int(np.argmax(excess > 1e-6 * hold))
        if first == 0:
            return math.inf
        low, high = amplitude[first - 1 : first + 1]
    begin = float(np.interp(0.0, excess[first - 1 : first + 1], (low, high)))
    return begin if begin < _NOTABLE * alone else math.inf


def grip_needed(system: ParticleDamper, point: SpeedPoint, amplitude: np.ndarray) -> np.ndarray:
    """Force along the floor that a ball at rest needs, over that on the floor, at amplitudes (n,) along x [m]; (n,).

    A vibration u along the leading mode's shape s moves the place by s u along the floor and by c u²/2 towards the
    axis. The ball is driven by -s u'', by the pull outwards in the plane of rotation, e, and along e by the Coriolis
    acceleration of the shortening, 2 Omega c u u'. It is pressed by the load less c Omega² u²/2, by the shortening's
    acceleration, c (u'² + u u''), and by the Coriolis acceleration 2 Omega (s e) u'; a floor that tilts turns each of
    the two a little into the other.
    """
    turn, omega, load = system.rotation, system.swing_frequency, system.centrifugal_acceleration
    nearer = shortening(point)
    outwards = np.array([math.sin(system.stagger), -math.cos(system.stagger)])
    shape, slope = np.array([1.0, 0.0]), np.array([system.floor_tilt[0], 0.0])
    if system.modes is not None:
        mode = system.modes[system.leading(0)]
        shape, slope = np.array(mode.shape) / mode.shape[0], np.array(mode.slope) / mode.shape[0]
    chord, phase = float(shape @ outwards), np.linspace(-math.pi / 2, math.pi / 2, 101)[:, None]
    u, velocity = amplitude * np.cos(phase), -omega * amplitude * np.sin(phase)
    pressed = load + 2 * turn * chord * velocity + nearer * (velocity**2 - (omega**2 + turn**2 / 2) * u**2)
    force, along = pressed, []
    for s, e, tilt in zip(shape, outwards, slope, strict=True):
        driven = (omega**2 * s + turn**2 * chord * e) * u + 2 * turn * nearer * e * u * velocity
        cosine, sine = np.cos(tilt * u), np.sin(tilt * u)
        along.append(driven * cosine - pressed * sine)
        force = force * cosine + driven * sine
    return np.asarray((np.hypot(*along) / np.maximum(force, 1e-9 * load)).max(axis=0))


_NOTABLE = 0.99
"""Share of the amplitude that moves a ball along x below which it counts that something moves it before."""


OUT_OF_REACH = 1e3
"""Amplitude [m] from which on a ball that would move there counts as one that never does."""

_LET_GO = 1.5
"""A scene that says nothing lets the structure go at so many times the amplitude above which the ball moves."""


def release_displacement(scene: Scene, point: SpeedPoint, system: ParticleDamper) -> tuple[float, float]:
    """Displacements [m] at which the structure is let go; accelerations are turned by ω1 with the ball stuck.

    Where the scene says nothing: by where the ball begins to roll; one that rolls from the start, or never, by where
    it would reach a wall.

    Raises:
        BadInput: a release across, where no mode of the plate that was looked for moves the cavity so.
    """
    release, squares = present(scene.release), _squares(scene, point)
    if release.displacement is not None:
        start = release.displacement
    elif release.acceleration is not None:
        start = release.acceleration[0] / squares[0], release.acceleration[1] / squares[1]
    elif release.ratio is not None:
        start = release.ratio * point.omega**2 * point.radius / squares[0], 0.0
    else:
        begin = system.amplitude_of(system.break_away_threshold)
        freely = (system.half_gap[0] or system.ball_radius) / system.inertia_ratio
        start = _LET_GO * (begin if 0 < begin < OUT_OF_REACH else freely), 0.0
    if start[1] != 0.0 and point.cavity_modes and leading_mode(point.cavity_modes, 1) is None:
        problem = "none of these modes moves the cavity across, as the release does: request more"
        raise BadInput(problem, key="[rotor] modes", value=scene.rotor.modes)
    return start


def amplitudes(system: ParticleDamper, release: tuple[float, float]) -> tuple[float, ...] | None:
    """Amplitudes of the modes at a release: the leading ones displace the cavity so, the others rest. None without any.

    A ball is judged by what it takes from the vibration let go, not by what a pull at its cavity sets ringing besides.
    """
    if system.modes is None:
        return None
    first, across = (system.leading(axis) for axis in range(2))
    values = [0.0] * len(system.modes)
    a, b = system.modes[first].shape, system.modes[across].shape
    determinant = a[0] * b[1] - a[1] * b[0]
    if first == across or determinant == 0.0:
        values[first] = release[0] / a[0]
    else:
        values[first] = (release[0] * b[1] - release[1] * b[0]) / determinant
        values[across] = (release[1] * a[0] - release[0] * a[1]) / determinant
    return tuple(values)


def _squares(scene: Scene, point: SpeedPoint) -> tuple[float, float]:
    """Squared circular frequencies along the damper's axes with the ball stuck [1/s²]."""
    reduced = present(point.reduced)
    first = (2 * math.pi * reduced.f1_hz) ** 2
    if scene.given is not None:
        return first, (2 * math.pi * scene.given.frequency[1]) ** 2
    across = leading_mode(point.cavity_modes, 1)
    return first, first if across is None else across.square(reduced.M1 - reduced.M2, 1)


def with_ball(source: SceneFile, plate: fem.Reduction) -> list[Reduced]:
    """The structure that the damper of a scene meets at each speed, on a plate that may carry others."""
    damper = present(source.scene.damper)
    with _place_errors(source):
        reduced = plate.with_ball(ball_mass=damper.balls, mass_ratio=damper.mass_ratio)
    return list(map(reduced_of, reduced))


def reduction(source: SceneFile, operators: fem.Operators, diagram: fem.Campbell) -> fem.Reduction:
    """The plate at the damper's place, for balls of any mass.

    Raises:
        BadInput: the damper's place, or too few modes to find the bending mode among.
    """
    with _place_errors(source):
        return fem.Reduction(operators, diagram, plate_mesh.place(source, operators.plate.mesh))


@contextmanager
def _place_errors(source: SceneFile) -> Iterator[None]:
    """What is wrong with a damper's place, or with the modes it is reduced to, in the scene's words."""
    try:
        with plate_mesh.placed(source):
            yield
    except fem.NoFlapMode as error:
        modes = source.scene.rotor.modes
        raise source.wrong(f"{error}: request more modes", "[rotor] modes", modes) from error


def cavity_modes(plate: fem.Reduction, reduced: list[Reduced]) -> list[tuple[CavityMode, ...]]:
    """The modes at each speed of the diagram as the cavity feels them."""
    balls = [each.M1 - each.M2 for each in reduced]
    reduction = fem.modes_at(plate.operators, plate.diagram, plate.at, np.array(balls))
    return [modes_of(reduction, n, "pressed") for n in range(len(reduction.stiffness))]


def modes_of(reduction: Any, n: int, force: str) -> tuple[CavityMode, ...]:
    """The modes that `fem` finds at a cavity, at its nth speed; force: what of a `CavityMode` its `pressed` is."""
    pairs = (map(tuple, getattr(reduction, name)[n].T.tolist()) for name in ("shape", "slope", "drawn"))
    every = zip(count(1), reduction.stiffness[n].tolist(), *pairs)
    forces = reduction.pressed[n].tolist()
    return tuple(CavityMode(*each, **{force: push}) for each, push in zip(every, forces, strict=True))


def reduced_of(reduction: Any) -> Reduced:
    """The structure that `fem` finds at a damper's place."""
    return copy_fields(Reduced, reduction, floor_tilt=reduction.slope)
