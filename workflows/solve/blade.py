"""A solid blade of a scene: its mesh, root and spin axis read and checked, its matrices and modes over speeds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from importlib.metadata import version
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

import fem
from fem.linalg import has_pardiso
from fem.modal_model import ModalModel, ModesAtSpeed
from workflows.effects.definition import AT_REST, Called, LeftOut
from workflows.errors import present
from workflows.formatting import beside, listed, percent, share, significant, span, turning
from workflows.progress import LOG
from workflows.scene.load import SceneFile
from workflows.scene.plate import Material
from workflows.scene.quantities import LENGTH, MASS, unit_in_si
from workflows.scene.scene import RootRadius, Scene
from workflows.solve import known_modes, limits, resources
from workflows.solve.known_modes import Request, Seat, SpaceStructure, about_spin_axis, seat_of, space_structure
from workflows.solve.orientation import orientation_remarks
from workflows.solve.results import Floats

if TYPE_CHECKING:
    from fem.solid.assembly import SolidOperators
    from fem.solid.blade import Blade
    from fem.solid.sweep import SolvedBlade


def space_of(source: SceneFile, *, slowest: bool = False) -> SpaceStructure | None:
    """The structure in space of a scene: its blade, or what is known by its modes; None without one.

    slowest: a blade at its lowest speed alone, by the effects that all speeds of the scene call for.

    Raises:
        BadInput, Divergence, NoEquilibrium: see `blade_structure` and `known_modes.space_structure`.
    """
    if source.scene.blade is not None:
        structure = blade_structure(_at_lowest_speed(source) if slowest else source)
    elif source.scene.in_space:
        structure = space_structure(source)
    else:
        return None
    return replace(structure, remarks=(*structure.remarks, *_too_fast(structure, max(source.scene.rotor.speeds))))


def _at_lowest_speed(source: SceneFile) -> SceneFile:
    """A scene with a blade at its lowest speed, with the effects that all of its speeds call for."""
    lowest, large = min(source.scene.rotor.speeds), source.scene.effects.large_deflection
    large = bool(deflection(source).called) if large == "auto" else large
    return source.changed(rotor={"speeds": (lowest,)}, effects={"large_deflection": large})


def _too_fast(structure: SpaceStructure, omega: float) -> tuple[str, ...]:
    """A remark where the load at a speed [rad/s] tears the root of any blade metal.

    Of known modes, whose root's section is not known, a bar of constant section between their radii stands for them.
    """
    radii = np.linalg.norm(structure.model.load(structure.model.points), axis=1)
    tip, inner = float(radii.max()), float(radii.min())
    if structure.density is None:
        stress = omega**2 * (structure.root_stress or 0.0)
        table, pulls, left_out = "blade", "pulls at the root", ""
    else:
        stress = omega**2 * 0.5 * structure.density * (tip**2 - inner**2)
        table, pulls = "structure", "would pull at the root of a bar of constant section"
        left_out = " Verdicts do not include the root stress of known modes."
    if stress <= limits.STRONGEST:
        return ()
    return (
        f"At {turning(omega)} the tip moves at {significant(omega * tip)} m/s, and the load {pulls} by"
        f" {significant(1e-6 * stress)} MPa on average, more than any blade metal bears"
        f" ({1e-6 * limits.STRONGEST:g} MPa): are [{table}] unit, [rotor] origin and speeds right?{left_out}",
    )


def blade_structure(source: SceneFile) -> SpaceStructure:
    """The structure of a scene with a [blade], with the scene's damper on it.

    Raises:
        BadInput: the mesh, its root or the damper's place is no good; it needs more memory than there is.
        Divergence, NoEquilibrium: it has no stable state at the highest speed.
    """
    scene, key = source.scene, _key(source)
    solved = _solved(Request(f"{key} {scene.effects.large_deflection}", source))
    model = solved.model
    _check_balls(source, solved.operators)
    seat, remarks = seat_of(source, model, solved.at(min(scene.rotor.speeds)), solved.pull)
    stress = root_stress(solved.operators)
    return SpaceStructure(
        model=model,
        modes=solved.at,
        seat=seat,
        described=in_words(source, solved.operators.blade),
        remarks=(*_remarks(source, solved.operators, stress), *remarks),
        sha256=source.files_sha256,
        coriolis=solved.coriolis_shifts,
        root_stress=stress,
        root_strain=None if stress is None else solved.root_strain,
        cut=_cavities(scene, seat, solved.operators.blade.material),
        mass=float(solved.operators.masses.sum()),
        inverse_mass=None if seat is None else partial(_inverse_mass, solved, seat),
    )


def _inverse_mass(solved: SolvedBlade, seat: Seat, durations: Sequence[float]) -> Floats:
    """Twice the energy that hits along axis 1 of a damper leave in a blade, over the square of their impulse [1/kg]."""
    from fem.reduction.known_modes import floor
    from fem.reduction.pulse import inverse_mass

    operators, at = solved.operators, seat.place
    axis = floor(solved.model, at, solved.model.speeds[0], seat.direction, seat.normal).axes[0]
    return inverse_mass(operators, operators.force_at(at, axis), np.array(durations))


def _check_balls(source: SceneFile, operators: SolidOperators) -> None:
    """Refuse balls that are heavier than the blade that carries them, and cavities that are larger.

    Their number is at fault, or where ten would be too many the size of one.
    """
    damper, blade = source.scene.damper, float(operators.masses.sum())
    if damper is None:
        return
    space, many = blade / operators.blade.material.density, damper.count > 1
    if damper.balls is not None and damper.balls >= blade:
        balls = f"{damper.count} {'balls' if many else 'ball'} of radius {1e3 * damper.radius:.6g} mm"
        problem = f"{balls} would weigh {significant(damper.balls)} kg, and the blade weighs {significant(blade)} kg"
    elif many and damper.cut >= space:
        problem = (
            f"the cavities would take {significant(1e6 * damper.cut)} cm³ of a blade of {significant(1e6 * space)} cm³"
        )
        if 10 * damper.cut >= damper.count * space:
            raise source.wrong(f"{problem}: expected less", "[damper] cavity", damper.cavity)
    else:
        return
    raise source.wrong(f"{problem}: expected less", f"[damper] {'count' if many else 'radius'}")


def _cavities(scene: Scene, seat: Seat | None, material: fem.Material) -> Callable[[ModesAtSpeed], Floats] | None:
    """What gives the shifts by cavities that the mesh does not have; None where it has them, or they do not count."""
    from fem.reduction.known_modes import cavity_shifts

    damper = scene.damper
    if damper is None or seat is None or not seat.metal or scene.effects.cavity_mass is False:
        return None
    return lambda modes: cavity_shifts(modes, seat.pull, material, damper.cut, damper.weakens, seat.metal)


def root_stress(operators: SolidOperators) -> float | None:
    """Mean stress over the root's section by the pull of what it holds, over Omega² [Pa s²]; None without faces."""
    blade, section = operators.blade, operators.blade.section
    if not blade.has_section:
        return None
    pull = operators.masses[blade.hung] @ blade.arms[blade.hung]
    return float(abs(pull @ section)) / float(section @ section)


def _key(source: SceneFile, *others: str) -> str:
    """What a blade's structure depends on, but for some keys of its rotor, and its effects."""
    scene = source.scene
    rotor = scene.rotor.model_dump_json(exclude={"gravity", *others})
    return f"{source.mesh} {source.files_sha256} {scene.blade!r} {scene.material!r} {rotor} {scene.accuracy!r}"


def _matrices(source: SceneFile) -> SolidOperators:
    """The matrices of a blade, whatever its speeds."""
    operators = _assembled(Request(_key(source, "speeds", "modes"), source))
    resources.check_blade(source, 3 * operators.nodes)
    return operators


@lru_cache(maxsize=2)
def _assembled(request: Request) -> SolidOperators:
    """The matrices of a blade, without large deflection."""
    from fem.solid.assembly import assemble_solid

    blade = blade_of(request.source)
    LOG.info("blade: %s", in_words(request.source, blade))
    return assemble_solid(blade, fem.Effects(coriolis=True))


def deflection(source: SceneFile) -> Called:
    """Whether a blade calls for large deflection: whether that moves a frequency by more than may be left out.

    Raises:
        BadInput: the mesh or its root is no good; it needs more memory than there is.
    """
    return _deflection(Request(_key(source), source))[0]


@lru_cache(maxsize=4)
def _deflection(request: Request) -> tuple[Called, SolidOperators]:
    """The same, with the matrices without large deflection, and what is known there."""
    from fem.solid.sweep import deflection_shifts

    source = request.source
    scene, omega = source.scene, max(source.scene.rotor.speeds)
    operators = _matrices(source).with_deflection(large=False)
    if omega == 0.0:
        return AT_REST, operators
    shifts, at = deflection_shifts(operators, omega, scene.rotor.modes), f"at {turning(omega)}"
    if shifts is None:
        return Called(True, f"{at} the load bends or untwists the blade too much for a linear prestress"), operators
    called = bool(shifts.max() > scene.budget.rough_shift)
    why = (
        f"{at} it moves frequencies by at most about {beside(100 * shifts.max(), 10 * scene.accuracy.frequency)} %,"
        f" {'more' if called else 'less'} than a tenth of the {significant(100 * scene.accuracy.frequency)} % requested"
    )
    return Called(called, why, LeftOut(np.array([omega]), shifts[None])), operators


@lru_cache(maxsize=2)
def _solved(request: Request) -> SolvedBlade:
    """The blade at the speeds of a scene, kept for other dampers on it."""
    from fem.solid.sweep import SolvedBlade

    source = request.source
    scene, large = source.scene, source.scene.effects.large_deflection
    if large is True:
        operators = _matrices(source).with_deflection(large=True)
    else:
        called, operators = _deflection(Request(_key(source), source))
        operators = operators.with_deflection(large=True) if large == "auto" and called.called else operators
    speeds = np.array(scene.rotor.speeds)
    return SolvedBlade(operators, speeds, scene.rotor.modes, max(scene.budget.basis, _FINEST))


def forget() -> None:
    """Let blades be solved anew, which is what a run takes."""
    _deflection.cache_clear()
    _solved.cache_clear()


_FINEST = 2e-4
"""Least relative error of frequencies between solved speeds that is asked for."""


def blade_of(source: SceneFile) -> Blade:
    """The blade of a scene.

    Raises:
        BadInput: the mesh or its root is no good; it needs more memory than there is.
    """
    from fem.meshes.volume import SizeError, read_volume
    from fem.solid.blade import Blade, root_at, up_to

    path, spec, material = present(source.mesh), present(source.scene.blade), present(source.scene.material)
    of_mesh = source.blaming("[blade] mesh", spec.mesh, fem.MeshError)
    with of_mesh, source.blaming("[blade] unit", spec.unit, SizeError):
        mesh = read_volume(path, unit_in_si(spec.unit, LENGTH), spec.size)
    resources.check_blade(source, 3 * len(mesh.points))
    plain = ModalModel(mesh.points, (), np.array([0.0, 0.0, 1.0]), np.zeros(3))
    about = about_spin_axis(source, plain)
    stuff = fem.Material(material.youngs_modulus, material.poissons_ratio, material.density)
    written = {"radius": spec.root.radius} if isinstance(spec.root, RootRadius) else spec.root
    with source.blaming("[blade] root", written, fem.MeshError):
        if isinstance(spec.root, RootRadius):
            root = up_to(mesh, about.axis, about.origin, spec.root.radius)
        elif spec.root is not None and spec.root_radius is None:
            root = known_modes.named_set(source, mesh.sets, spec.root, "[blade] root", " or a radius such as '100 mm'")
        else:
            root = root_at(mesh, about.axis, about.origin, spec.root_radius)
        blade = Blade(mesh, stuff, root, about.axis, about.origin)
    _check_sides(source, blade)
    return blade


def _check_sides(source: SceneFile, blade: Blade) -> None:
    """Refuse a spin axis that passes between a blade's root, where that is on one side of it, and its tip."""
    arms = blade.arms
    outwards = arms[blade.root].mean(axis=0)
    tip = arms[np.linalg.norm(arms, axis=1).argmax()]
    if (arms[blade.root] @ outwards).min() > 0.0 > tip @ outwards:
        root, reach = (significant(1e3 * float(np.linalg.norm(arm))) for arm in (outwards, tip))
        text = f"the spin axis passes between the root, {root} mm away, and the tip, {reach} mm away on its other side"
        point = "hub_radius" if source.scene.rotor.origin is None else "origin"
        raise source.wrong(f"{text}: expected both on one side", f"[rotor] {point}", getattr(source.scene.rotor, point))


def in_words(source: SceneFile, blade: Blade) -> str:
    """The mesh of a blade: what it is made of, its extents, what of it is held; who solves it, where not SuperLU."""
    cells = " and ".join(f"{len(nodes)} {kind}" for kind, nodes in blade.mesh.cells)
    unknowns = 3 * (len(blade.mesh.points) - blade.held.size)
    name = present(source.scene.blade).mesh
    by = ", solved by PARDISO" if has_pardiso() else ""
    x, y, z = (significant(1e3 * side) for side in np.ptp(blade.mesh.points, axis=0))
    radii = 1e3 * np.linalg.norm(blade.arms, axis=1)
    whole, root = (span(float(each.min()), float(each.max()), 3) for each in (radii, radii[blade.root]))
    extents = f"{x} × {y} × {z} mm along x, y and z, at radii of {whole} mm, its root at {root} mm"
    return f"{cells} cells of {name}, {extents}, {unknowns} unknowns, {blade.held.size} nodes clamped{by}"


def _remarks(source: SceneFile, operators: SolidOperators, stress: float | None) -> Iterator[str]:
    """Remarks on a blade's mesh, root and spin axis; `stress`: see `root_stress`."""
    spec, blade = present(source.scene.blade), operators.blade
    if spec.size is not None:
        yield f"{spec.mesh} is geometry: Gmsh {version('gmsh')} meshed it by cells of {1e3 * spec.size:.6g} mm."
    elif blade.mesh.first_order:
        softer = [kind for kind in blade.mesh.deck.elements if kind.startswith("C3D8") and {*kind[4:]} & {*"IR"}]
        solved = f", and its {listed(softer)} are solved here as C3D8" if softer else ""
        yield (
            f"The mesh is of first order{solved}: such cells are far too stiff in bending (they lock), and the errors"
            " of frequencies are large. Mesh the blade with second-order cells (tetrahedra of 10 nodes, hexahedra of"
            " 20)."
        )
    yield from _unused(source, blade)
    radii, along = np.linalg.norm(blade.arms, axis=1), blade.arms @ blade.arms.mean(axis=0)
    inboard = np.setdiff1d(blade.held, blade.root)
    if inboard.size:
        volumes = [
            (each.weights[np.isin(each.nodes, inboard).any(axis=1)].sum(), each.weights.sum())
            for each in operators.cells
        ]
        inner, whole = np.sum(volumes, axis=0)
        yield (
            f"{share(inner / whole, 2)} % of the mesh is cut off from the blade by its"
            " root, on the side of the axis, and is clamped with it: the modes are those of the rest."
        )
    about = ModalModel(blade.mesh.points, (), blade.axis, blade.origin)
    yield from orientation_remarks(about, operators.masses, blade.root, "blade", inboard)
    covered = min(float(np.ptp(each[blade.root]) / np.ptp(each)) for each in (radii, along))
    if covered > _TALL:
        yield (
            f"The root covers {percent(covered, 0)} % of the blade's radial extent: is it the end that the rotor holds?"
        )
    if stress is None:
        yield (
            "The mean stress at the root is not known, since the vector areas of its outer faces cancel:"
            " whether the load tears the root is not checked."
        )


def _unused(source: SceneFile, blade: Blade) -> Iterator[str]:
    """A remark on what a deck says of its model and the blade has not: elements, constraints, supports, material."""
    deck, mesh, spec, material = blade.mesh.deck, blade.mesh, present(source.scene.blade), source.scene.material
    parts = [
        f"{deck.elements[kind]} {kind} ({lost} {'are' if ' ' in lost else 'is'} missing)"
        for kind, lost in deck.missing().items()
    ]
    parts += [f"{key} ({count})" for key, count in deck.unused().items()]
    sets = {name.upper(): nodes for name, nodes in mesh.sets.items()}
    supports = {name: sets[name.upper()] for name in deck.held if name.upper() in sets}
    if mesh.labels is not None:
        numbers = [int(name) for name in deck.held if name.isdigit()]
        supports["by number"] = np.flatnonzero(np.isin(mesh.labels, numbers))
    for name, rows in supports.items():
        if free := np.setdiff1d(rows, blade.held).size:
            card = "BOUNDARY" if "BOUNDARY" in deck.keywords else "SPC"
            parts.append(f"{card} on {free} node{'s' * (free > 1)} not clamped here ({name})")
    names = list(deck.used or deck.materials)
    if len(names) > 1:
        parts.append(f"the materials {listed(names)}")
    elif names and (other := _other_material(deck.materials.get(names[0]), present(material), spec.unit)):
        parts.append(f"a material of {other}")
    if parts:
        unused = f"{spec.mesh} has more that is not used: {'; '.join(parts)}"
        yield f"{unused}. The blade is solved without this, of the scene's [material] alone."


def _other_material(values: Sequence[float | None] | None, material: Material, unit: str | None) -> str | None:
    """E, ρ and ν of a deck in words; None where they are the scene's.

    values: E, ν and ρ in the deck's units, of which those of mass and time are not known: the nearest are taken.
    """
    modulus, ratio, density = values or (None, None, None)
    length, masses = unit_in_si(unit, LENGTH), ("lbf*s^2/in",) if unit == "in" else ("kg", "t", "g")
    options = (
        {
            "GPa": (1e-9 * (modulus or 0.0) * mass / length / time**2, 1e-9 * material.youngs_modulus),
            "kg/m³": ((density or 0.0) * mass / length**3, material.density),
        }
        for mass, time in product((unit_in_si(each, MASS) for each in masses), (1.0, 1e-3))
    )
    known = [{name: pair for name, pair in option.items() if pair[0] > 0.0} for option in options]
    nearest = min(known, key=lambda each: sum(abs(math.log(one / other)) for one, other in each.values()))
    alike = all(abs(one / other - 1.0) <= _SAME for one, other in nearest.values())
    if alike and (ratio is None or abs(ratio - material.poissons_ratio) <= _SAME):
        return None
    texts = [f"{significant(one, 4)} {name}" for name, (one, _) in nearest.items()]
    return ", ".join(texts if ratio is None else [*texts, f"ν = {significant(ratio)}"])


_SAME = 0.01
"""Relative difference of moduli and densities, and difference of Poisson's ratios, up to which they are the same."""

_TALL = 0.2
"""Part of a blade's radial extent above which a root that covers it is remarked."""
