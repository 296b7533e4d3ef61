"""From modes over speed to the records that a run hands on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.effects.left_out import LeftOut
from workflows.effects.table import NAMES
from workflows.scene import plate_mesh
from workflows.scene.source import SceneFile
from workflows.solve.records import (
    SHAPES_AT_MOST,
    CavityMode,
    Diagram,
    ErrorParts,
    Floats,
    Mode,
    Reduced,
    SpeedPoint,
    Surface,
    rpm,
)
from workflows.solve.structure_records import Theory

if TYPE_CHECKING:
    import fem

_EFFECTS = tuple(name for name in NAMES if name in ErrorParts.__annotations__)
"""Parts of an error that are what an effect left out would move."""

SMOOTH, _PARTS = 900, 4
"""Points up to which pictures look between those of a coarse mesh, and parts of a side of its cells at most."""

_NOTHING = 1e-7
"""Part of a shape's largest displacement below which there is rounding alone."""

_BITS = 15
"""Of a shape's largest displacement in pictures, which have 16 with its sign."""


@dataclass(frozen=True, eq=False)
class Discrete:
    """Matrices on the mesh chosen, and how it was chosen.

    `layers`: the error that the layers of a solid leave. `left_out`: what effects left out would move, by name.
    """

    choice: fem.Choice
    theory: Theory
    mesh: str
    layers: float
    left_out: dict[str, LeftOut] = field(default_factory=dict)


def at_speeds(
    source: SceneFile,
    discrete: Discrete,
    diagram: fem.Campbell,
    reduced: list[Reduced | None],
    at_cavity: list[tuple[CavityMode, ...]],
) -> tuple[SpeedPoint, ...]:
    """Modes and what the damper feels at the scene's own speeds, as far as the sweep has them."""
    numbers = [int((diagram.omega == omega).argmax()) for omega in source.scene.rotor.speeds if omega in diagram.omega]
    return points(source, discrete, diagram, numbers, reduced, at_cavity)


def points(
    source: SceneFile,
    discrete: Discrete,
    diagram: fem.Campbell,
    numbers: list[int],
    reduced: list[Reduced | None],
    at_cavity: list[tuple[CavityMode, ...]],
) -> tuple[SpeedPoint, ...]:
    """Modes and what the damper feels at the speeds of these numbers in the sweep."""
    from fem.accuracy.theory_selection import over_speeds

    rotor, operators = source.scene.rotor, discrete.choice.operators
    radius = operators.radius(*plate_mesh.place(source, operators.plate.mesh))
    families, theory = diagram.families, over_speeds(operators, diagram)
    found = []
    for number in numbers:
        omega = float(diagram.omega[number])
        found.append(
            SpeedPoint(
                omega=omega,
                rpm=rpm(omega),
                radius=radius,
                load_g=omega**2 * radius / rotor.gravity,
                modes=_modes(discrete, diagram, number, families[number][: rotor.modes], theory[number]),
                reduced=reduced[number],
                cavity_modes=at_cavity[number],
            )
        )
    return tuple(found)


def _modes(
    discrete: Discrete, diagram: fem.Campbell, number: int, families: list[str], theory: Floats
) -> tuple[Mode, ...]:
    omega, count = float(diagram.omega[number]), len(families)
    turning = discrete.choice.operators.gyroscopic is not None and omega > 0
    errors = _errors(discrete, omega, diagram.bounds[number, :count], theory[:count])
    return tuple(
        Mode(
            frequency_hz=float(diagram.frequencies_hz[number, k]),
            family=family,
            error_parts=errors[k],
            damping_ratio=float(diagram.damping_ratios[number, k]) if turning else None,
            branch=int(diagram.branches[number, k]),
        )
        for k, family in enumerate(families)
    )


def _errors(discrete: Discrete, omega: float, bounds: Floats, theory: Floats) -> list[ErrorParts]:
    """The parts of each mode's error at a speed [rad/s]."""
    mesh = discrete.choice.errors_at(omega)
    left_out = {name: found.at(omega, bounds.size) for name, found in discrete.left_out.items()}
    return [
        ErrorParts(
            mesh=float(mesh[k]) if np.isfinite(mesh[k]) else None,
            layers=discrete.layers,
            basis=float(bounds[k]),
            theory=float(theory[k]),
            **{name: _share(left_out.get(name), k) for name in _EFFECTS},
        )
        for k in range(bounds.size)
    ]


def _share(shifts: Floats | None, k: int) -> float | None:
    return None if shifts is None or not np.isfinite(shifts[k]) else float(shifts[k])


def surface(operators: fem.Operators, diagram: fem.Campbell, numbers: list[int], count: int) -> Surface:
    """The mid-surface with the shapes of some of the speeds of these numbers."""
    from fem import displacement

    kept = _kept(len(numbers))
    unknowns = np.hstack([_upright(diagram.shapes(numbers[k])[:, :count]) for k in kept])
    shapes = np.array(displacement(operators, unknowns))
    shapes[np.abs(shapes) < _NOTHING * np.abs(shapes).max(axis=(1, 2), keepdims=True)] = 0.0
    found = _shaped(operators, operators.plate.mesh, shapes, kept)
    return replace(found, finer=_finer(operators, unknowns, kept))


def _shaped(operators: fem.Operators, mesh: Any, shapes: Any, kept: tuple[int, ...]) -> Surface:
    """A mesh with displacements (shapes, n, 3), as many at each of the speeds kept."""
    by_speed = shapes.reshape(len(kept), -1, *shapes.shape[1:])
    behind = -by_speed.imag if np.iscomplexobj(by_speed) else None
    thickness = _thickness(operators.plate, mesh)
    return replace(bare(mesh), shapes=by_speed.real, at=kept, thickness=thickness, behind=behind)


def _finer(operators: fem.Operators, unknowns: Floats, kept: tuple[int, ...]) -> Surface | None:
    """The surface with each side of a cell in as many parts as `SMOOTH` points allow; None where that is one.

    For pictures: no more digits than these show.
    """
    from fem.output import between

    mesh = operators.model.mesh
    points = mesh.t.shape[1] if mesh.t.shape[0] == 4 else mesh.t.shape[1] / 2
    parts = min(int(np.sqrt(SMOOTH / points)), _PARTS)
    if parts < 2:
        return None
    found = between(operators, unknowns, parts)
    largest = np.abs(found.displacement).max(axis=(1, 2), keepdims=True)
    step = np.ldexp(1.0, np.frexp(largest)[1] - _BITS)
    shapes = np.round(found.displacement / step) * step + 0.0  # which has no -0
    small = shapes.astype(np.complex64 if np.iscomplexobj(shapes) else np.float32)
    return replace(_shaped(operators, found.mesh, small, kept), lines=found.lines)


def bare(mesh: Any) -> Surface:
    """A mesh's mid-surface, without shapes."""
    from fem.meshes.planform import root_facets

    points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
    kind = "quad" if mesh.t.shape[0] == 4 else "triangle"
    outline, root = (np.asarray(mesh.facets[:, found].T) for found in (mesh.boundary_facets(), root_facets(mesh)))
    return Surface(points, (kind, np.asarray(mesh.t.T)), outline, root, np.zeros((0, 0, len(points), 3)), ())


def _thickness(plate: fem.Plate, mesh: Any) -> Floats | None:
    """The thickness [m] at a mesh's points, (n,), where it varies."""
    if isinstance(plate.thickness, float | int):
        return None
    found = np.zeros(mesh.p.shape[1])
    found[mesh.t.T] = plate.thickness.at(mesh.p[:, mesh.t.T])
    return found


def diagram_of(discrete: Discrete, diagram: fem.Campbell, count: int, asked: tuple[float, ...]) -> Diagram:
    """What else the sweep found: its bound, veerings among the modes shown, speeds lost to divergence."""
    from fem import critical_speed

    operators, families = discrete.choice.operators, diagram.families
    known = set(diagram.omega.tolist())
    lost = tuple(sorted(rpm(omega) for omega in asked if omega not in known))
    linear = not operators.effects.large_deflection
    veerings = []
    for veering in diagram.veerings:
        low, high = (rpm(float(omega)) for omega in diagram.omega[veering.step : veering.step + 2])
        names = [families[veering.step][k] for k in veering.modes if k < count]
        veerings.append((low, high, tuple(names)))
    return Diagram(
        mesh=discrete.mesh,
        bound=float(diagram.bounds[:, :count].max()),
        bases=diagram.sizes,
        veerings=tuple(veering for veering in veerings if veering[2]),
        lost=lost,
        critical=rpm(critical_speed(operators)) if lost and linear else None,
    )


def _upright(shapes: Floats) -> Floats:
    """Complex shapes turned to the phase at which their largest unknown peaks; real ones as they are."""
    if not np.iscomplexobj(shapes):
        return shapes
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    return np.asarray(shapes * (np.abs(largest) / largest))


def _kept(count: int) -> tuple[int, ...]:
    """Which speeds keep their shapes: all, or evenly chosen ones with both ends."""
    if count <= SHAPES_AT_MOST:
        return tuple(range(count))
    return tuple(np.unique(np.linspace(0, count - 1, SHAPES_AT_MOST).round().astype(int)).tolist())
