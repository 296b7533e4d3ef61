"""The plate's stages: mesh, prestress, modes at every speed, reduction to what the damper feels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workflows import effects as rules
from workflows import plate_mesh
from workflows.effects import Effect, Theory
from workflows.errors import BadInput, NoAnswer
from workflows.records import Floats, Mode, Reduced, SpeedPoint, Surface
from workflows.ringdowns import rpm
from workflows.scene_file import SceneFile
from workflows.stages import Stages

if TYPE_CHECKING:
    import fem

_SHAPES_AT_MOST = 20
"""Speeds whose mode shapes are kept for pictures and files."""


@dataclass(frozen=True, eq=False)
class PlateAnswer:
    """The plate, solved at every speed."""

    points: tuple[SpeedPoint, ...]
    surface: Surface | None
    theory: Theory
    mesh: str


@dataclass(frozen=True, eq=False)
class _Discrete:
    """Matrices on the mesh chosen, and those on another by which errors are estimated."""

    operators: fem.Operators
    other: fem.Operators
    theory: Theory
    mesh: str


def solve(source: SceneFile, effects: dict[str, Effect], stages: Stages, *, shapes: bool = True) -> PlateAnswer:
    """Solve the plate of a scene at all its speeds; with `shapes` its surface and mode shapes are kept.

    Raises:
        BadInput: the mesh, the theory or a place on the plate is no good.
        NoAnswer: the plate diverges at one of the speeds.
    """
    from fem import Divergence

    try:
        discrete = _discretise(source, effects, stages)
        every = _modes(source, discrete.operators, stages)
        reduced = _reduce(source, discrete.operators, every, stages)
    except Divergence as error:
        raise NoAnswer(f"{source.name}: {error}") from error
    except (RuntimeError, FloatingPointError, np.linalg.LinAlgError) as error:  # SuperLU: "Factor is exactly singular"
        raise NoAnswer(f"{source.name}: the plate's equations have no solution in floating point: {error}") from error
    with stages("modes"):
        points = _points(source, discrete, every, reduced)
        surface = _surface(discrete.operators, every) if shapes else None
    return PlateAnswer(points, surface, discrete.theory, discrete.mesh)


def _discretise(source: SceneFile, effects: dict[str, Effect], stages: Stages) -> _Discrete:
    """Matrices on the cheapest mesh whose estimated error meets the accuracy asked for, or on the finest."""
    from fem import Effects, MeshError, Rotor, assemble, companion

    scene, theory = source.scene, rules.theory(source.scene, source.name)
    if theory is None:
        raise ValueError("the scene has no plate")
    names = ("stress_stiffening", "spin_softening", "coriolis", "large_deflection", "rotary_inertia")
    switches = Effects(**{name: effects[name].on for name in names})
    rotor, speeds = Rotor(scene.rotor.hub_radius, scene.rotor.stagger), scene.rotor.speeds
    for cells in plate_mesh.ladder(source):
        try:
            with stages("mesh"):
                plate, described = plate_mesh.build(source, cells)
            with stages("prestress"):
                operators = assemble(plate, rotor, switches, theory.name)
        except MeshError as error:
            raise BadInput(str(error), file=source.name, key="[plate]") from error
        except ValueError as error:
            raise plate_mesh.off_the_plate(source, error) from error
        with stages("modes"):
            other = companion(operators)
            estimate = max(_first_error(operators, other, omega) for omega in {min(speeds), max(speeds)})
        if estimate <= scene.accuracy.frequency:
            break
    return _Discrete(operators, other, theory, described)


def _first_error(operators: fem.Operators, other: fem.Operators, omega: float) -> float:
    from fem import estimate_error, solve_modes

    return float(estimate_error(operators, solve_modes(operators, omega, 2), other)[0])


def _modes(source: SceneFile, operators: fem.Operators, stages: Stages) -> list[fem.Modes]:
    from fem import solve_modes

    found = []
    with stages("modes", len(source.scene.rotor.speeds)) as step:
        for omega in source.scene.rotor.speeds:
            found.append(solve_modes(operators, omega, source.scene.rotor.modes))
            step.advance(f"{rpm(omega):.0f} rpm")
    return found


def _reduce(
    source: SceneFile, operators: fem.Operators, every: list[fem.Modes], stages: Stages
) -> list[Reduced | None]:
    """What the damper feels at each speed; nothing without a damper."""
    from fem import reduce_at

    damper = source.scene.damper
    if damper is None:
        return [None] * len(every)
    at = plate_mesh.place(source, operators.plate.mesh)
    found: list[Reduced | None] = []
    with stages("reduction", len(every)) as step:
        for modes in every:
            # With few modes asked for, bending may not be among them: fem then looks for it itself.
            known = modes if modes.eigenvalues.size >= 4 else None
            try:
                r = reduce_at(
                    operators, modes.omega, at, ball_mass=damper.mass, mass_ratio=damper.mass_ratio, modes=known
                )
            except ValueError as error:
                raise plate_mesh.off_the_plate(source, error) from error
            found.append(Reduced(r.f1_hz, r.M1, r.K1, r.f2_hz, r.M2, r.K2, r.floor_tilt))
            step.advance(f"{rpm(modes.omega):.0f} rpm")
    return found


def _points(
    source: SceneFile, discrete: _Discrete, every: list[fem.Modes], reduced: list[Reduced | None]
) -> tuple[SpeedPoint, ...]:
    from fem import estimate_error, families

    rotor, operators = source.scene.rotor, discrete.operators
    radius = rotor.hub_radius + plate_mesh.place(source, operators.plate.mesh)[0]
    points = []
    for modes, parameters in zip(every, reduced, strict=True):
        errors = estimate_error(operators, modes, discrete.other)
        rows = zip(modes.frequencies_hz, families(operators, modes), errors, strict=True)
        ratios = modes.damping_ratios if np.iscomplexobj(modes.shapes) else [None] * len(errors)
        points.append(
            SpeedPoint(
                omega=modes.omega,
                rpm=rpm(modes.omega),
                radius=radius,
                load_g=modes.omega**2 * radius / rotor.gravity,
                modes=tuple(
                    Mode(float(f), family, float(error), None if ratio is None else float(ratio))
                    for (f, family, error), ratio in zip(rows, ratios, strict=True)
                ),
                reduced=parameters,
            )
        )
    return tuple(points)


def _surface(operators: fem.Operators, every: list[fem.Modes]) -> Surface:
    from fem import displacement

    kept = _kept(len(every))
    shapes = displacement(operators, np.hstack([_upright(every[number].shapes) for number in kept]))
    mesh = operators.plate.mesh
    points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
    kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
    return Surface(points, (kind, np.asarray(mesh.t.T)), shapes.reshape(len(kept), -1, *shapes.shape[1:]), kept)


def _upright(shapes: Floats) -> Floats:
    """Complex shapes at the phase at which their largest unknown peaks; real ones as they are."""
    if not np.iscomplexobj(shapes):
        return shapes
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    return np.asarray((shapes * (np.abs(largest) / largest)).real)


def _kept(count: int) -> tuple[int, ...]:
    """Which speeds keep their shapes: all, or evenly chosen ones with both ends."""
    if count <= _SHAPES_AT_MOST:
        return tuple(range(count))
    return tuple(np.unique(np.linspace(0, count - 1, _SHAPES_AT_MOST).round().astype(int)).tolist())
