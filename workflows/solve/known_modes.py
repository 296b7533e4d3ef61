"""A structure in space that is known by its modes: read from files, with the damper on it at every speed asked for."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem import modal_model
from fem.modal_files import ModesFileError, Raw, in_si, joined, read
from fem.modal_model import ModalModel, ModesAtSpeed, Place, Pull
from fem.rotor import Rotor, in_rpm
from workflows.effects.definition import Effect
from workflows.errors import did_you_mean, present
from workflows.formatting import interval, percent, share, significant, turning
from workflows.scene.load import SceneFile, file_problem
from workflows.scene.materials import OSMIUM
from workflows.scene.quantities import LENGTH, MASS, unit_in_si
from workflows.scene.scene import NO_ORIGIN, KnownModes
from workflows.solve import results
from workflows.solve.coupling import modes_of, reduced_of
from workflows.solve.orientation import orientation_remarks
from workflows.solve.results import Floats, Ints, SpeedPoint

if TYPE_CHECKING:
    from fem.reduction.known_modes import Floor


@dataclass(frozen=True, eq=False)
class Seat:
    """Where the damper sits: its place, axis 1 of its cavity (3,) before what of it is along the normal, its pull.

    `normal`: of the floor (3,) at rest; None: along the load. `metal`: places in the metal where the cavity is; none
    where the mesh has it cut. `sticks_out`: how far the cavity does, out of the structure [m].

    `force`: where and in which direction (3,) a force shakes the structure; None: not elsewhere than here.
    """

    place: Place
    direction: Floats
    pull: Pull
    force: tuple[Place, Floats] | None = None
    normal: Floats | None = None
    metal: tuple[Place, ...] = ()
    sticks_out: float = 0.0

    def load(self, modes: ModesAtSpeed) -> Floats | None:
        """What a unit of the force is on the modes (count,)."""
        return None if self.force is None else self.force[0].displacement(modes.shapes) @ self.force[1]


@dataclass(frozen=True, eq=False)
class SpaceStructure:
    """A structure in space.

    Attributes:
        model: its nodes, cells, spin axis.
        modes: gives its modes at a speed [rad/s].
        seat: of the damper; None without one.
        described: in words; remarks: on what was made of it.
        sha256: of the files.
        coriolis: relative shifts of the frequencies at a speed [rad/s] by Coriolis forces, which are left out; None:
            not known.
        root_stress: mean stress over the root's section by the centrifugal pull, over Omega² [Pa s²]; None: not known.
        cut: relative shifts of the frequencies by cavities that the modes know nothing of; None: not known.
        mass: of all that the mesh has [kg]; inf: not known.
        root_strain: of a solid blade the largest strain in a mode over its root's section, by what it asks of the
            clamp; None: not known.
        density: of known modes, by the scale of their shapes [kg/m³]; None: not known, or not of known modes.
        inverse_mass: twice the energy that hits of these durations [s] along axis 1 of the damper leave, over the
            square of their impulse [1/kg]; None: not known.
    """

    model: ModalModel
    modes: Callable[[float], ModesAtSpeed]
    seat: Seat | None
    described: str
    remarks: tuple[str, ...]
    sha256: str | None
    coriolis: Callable[[float], Floats] | None = None
    root_stress: float | None = None
    cut: Callable[[ModesAtSpeed], Floats] | None = None
    mass: float = math.inf
    root_strain: Callable[[ModesAtSpeed, int], float | None] | None = None
    density: float | None = None
    inverse_mass: Callable[[Sequence[float]], Floats] | None = None

    def points(self, source: SceneFile, effects: dict[str, Effect]) -> tuple[SpeedPoint, ...]:
        """The structure at the speeds of a scene, as its damper meets it.

        Raises:
            BadInput: no mode moves the damper's place along axis 1 of its cavity; balls heavier than the blade.
            Divergence: the ball's pull takes the stiffness of a mode.
        """
        return tuple(self._point(source, effects, omega) for omega in source.scene.rotor.speeds)

    def _point(self, source: SceneFile, effects: dict[str, Effect], omega: float) -> SpeedPoint:
        from fem.reduction.known_modes import NoMotion, reduced_modes

        scene, modes = source.scene, self.modes(omega)
        names = _families(self.model, modes)
        turned = None if self.coriolis is None else self.coriolis(omega)
        left_out = effects["large_deflection"].left_out
        bent = None if left_out is None else left_out.at(np.array([omega]), len(names))[0]
        cut = None if self.cut is None else self.cut(modes)
        stress = None if self.root_stress is None else omega**2 * self.root_stress
        displaced, untwist = (None, None) if modes.static is None else modal_model.deflection(self.model, modes.static)
        records = _modes(modes, names[: scene.rotor.modes], bent, turned, cut)
        static = {"root_stress": stress, "static_displacement": displaced, "tip_rotation": untwist}
        point = SpeedPoint.at(omega, self.radius, scene.rotor.gravity, records, **static)
        damper = scene.damper
        if damper is None or self.seat is None:
            return point
        with source.blaming("[damper] direction", None, NoMotion):
            floor = self.floor(modes)
            pull, load = self.seat.pull, self.seat.load(modes)
            reduced, every = reduced_modes(
                modes, floor, pull, ball_mass=damper.balls, mass_ratio=damper.mass_ratio, load=load
            )
        if (balls := float(reduced.M1 - reduced.M2)) >= self.mass:
            weights = f"would weigh {significant(balls)} kg, and the blade weighs {significant(self.mass)} kg"
            problem = f"balls of this ratio {weights}: expected less"
            raise source.wrong(problem, "[damper] mass_ratio", damper.mass_ratio)
        lifts = every.shape[0, 0]
        leads = int(np.argmax(lifts**2 / every.stiffness[0]))
        strain = _largest_strain(self.model, modes, leads)
        if strain is not None and self.root_strain is not None:
            strain = max(strain, self.root_strain(modes, leads) or 0.0)
        return replace(
            point,
            radius=floor.radius,
            load_g=omega**2 * floor.radius / scene.rotor.gravity,
            reduced=reduced_of(reduced),
            cavity_modes=modes_of(every, 0, "pushed") if effects["structural_modes"].on else (),
            stagger=floor.stagger(self.model.axis),
            lean=(float(floor.lean[0]), float(floor.lean[1])),
            sticks_out=self.seat.sticks_out,
            root_strain=None if strain is None else strain / abs(float(lifts[leads])),
        )

    @property
    def radius(self) -> float:
        """The damper's distance from the axis, or that of what is farthest out [m]."""
        points = self.model.points if self.seat is None else self.seat.place.point[None]
        return float(np.linalg.norm(self.model.load(points), axis=1).max())

    def seat_at(self, omega: float) -> results.SeatDescription | None:
        """How the damper lies at a speed [rad/s]; None without one."""
        if self.seat is None:
            return None
        modes = self.modes(omega)
        floor, names = self.floor(modes), _families(self.model, modes)
        still = np.abs(floor.moved) <= results.STILL * np.abs(floor.moved).max()
        moved, at = np.where(still, np.nan, floor.moved), self.seat.place
        masses, tilts = moved**-2, floor.slope / moved
        figures = ([tuple(results.known(pair)) for pair in each.T] for each in (masses, masses * modes.squares, tilts))
        every = tuple(map(results.ModeAtSeat, range(1, len(names) + 1), names, modes.frequencies_hz.tolist(), *figures))
        pull = (floor.pressing * floor.normal + floor.lean @ floor.axes) / floor.radius
        vectors = (at.point, pull, floor.normal, *floor.axes)
        place, load, normal, *axes = (tuple((vector + 0.0).tolist()) for vector in vectors)
        return results.SeatDescription(place, at.how, load, normal, tuple(axes), every)

    def floor(self, modes: ModesAtSpeed) -> Floor:
        """The cavity's floor at a speed.

        Raises:
            NoMotion: the load there gives it no axes.
        """
        from fem.reduction.known_modes import floor

        seat = present(self.seat)
        return floor(self.model, seat.place, modes, seat.direction, seat.normal)

    def surface(self, speeds: Sequence[float], count: int) -> results.Surface:
        """Its surface, or where it has no cells a mark at each node, with mode shapes of some of the speeds."""
        shown = results.speeds_with_shapes(len(speeds))
        shapes = np.array([self.modes(speeds[k]).shapes[:count] for k in shown])
        surface, used = results.skin(self.model.points, self.model.cells)
        if used.size:
            shapes = shapes[:, :, used]
            held = modal_model.held(shapes)[surface.outline].all(axis=1)
            surface = replace(surface, root=surface.outline[held])
        else:
            marks = _MARK * self.model.size * _TETRAHEDRON
            triangles = (4 * np.arange(len(self.model.points))[:, None, None] + _SIDES).reshape(-1, 3)
            points, shapes = (self.model.points[:, None] + marks).reshape(-1, 3), np.repeat(shapes, 4, axis=2)
            surface = replace(surface, points=points, cells=("triangle", triangles))
        mark = None if self.seat is None else self.seat.place.point
        axis, origin = self.model.axis, self.model.origin
        return replace(surface, shapes=shapes, at=shown, frame=self._drawing(), mark=mark, axis=axis, origin=origin)

    def _drawing(self) -> Floats:
        """Axes (3, 3) of pictures: along the load, across it, and along axis 1 of the cavity or the spin axis."""
        from fem.reduction.known_modes import frame

        if self.seat is not None:
            floor = self.floor(self.modes(self.model.speeds[0].omega))
            return np.array([floor.normal, floor.axes[1], floor.axes[0]])
        load = self.model.load(self.model.points).mean(axis=0)
        largest = float(np.linalg.norm(load))
        normal = (
            load / largest
            if largest > results.STILL * self.model.size
            else np.eye(3)[int(self.model.axis[0] ** 2 > 0.5)]
        )
        axes = frame(normal, self.model.axis)
        return np.array([normal, axes[1], axes[0]])


_MARK = 0.006
"""Half of what a node's mark measures, in sizes of the structure."""

_TETRAHEDRON = np.array([(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)])
_SIDES = np.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])


def _modes(modes: ModesAtSpeed, families: Sequence[str], *left_out: Floats | None) -> tuple[results.Mode, ...]:
    """Modes as results have them; their errors are those of the file, where it has some, and of interpolation.

    left_out: what large deflection, Coriolis forces and cavities would move, each relative, (modes,).
    """
    count = len(families)

    def each(values: Floats | Ints | None, missing: float | None = None) -> list[Any]:
        return [missing] * count if values is None else values[:count].tolist()

    exact, between = [0.0] * count, each(modes.interpolation, math.nan)
    errors = map(results.ErrorParts, each(modes.errors), exact, between, exact, *map(each, left_out))
    branches = range(count) if modes.tracks is None else each(modes.tracks)
    return tuple(map(results.Mode, each(modes.frequencies_hz), families, errors, each(modes.damping_ratios), branches))


def space_structure(source: SceneFile) -> SpaceStructure:
    """The structure of a scene that names files of modes, with the scene's damper on it.

    Raises:
        BadInput: a file, its units, its speeds or the damper's place is no good; the message says what would be right.
    """
    known = present(source.scene.known)
    stamps = [_stamp(source, name) for name in known.files.values()]
    speeds = source.scene.rotor.speeds if None in known.files else ()
    rotor = source.scene.rotor.model_copy(update={"speeds": speeds}).model_dump_json(exclude_unset=True)
    structure = _structure(Request(f"{source.folder} {source.name} {known!r} {rotor} {stamps}", source))
    for omega in source.scene.rotor.speeds:
        structure.modes(omega)
    seat, seated = seat_of(source, structure.model, structure.modes(min(source.scene.rotor.speeds)))
    between = _interpolation_remarks(source, structure.model, seat)
    return replace(structure, seat=seat, remarks=(*structure.remarks, *seated, *between))


_SPEEDS = 64
"""Speeds at which modes are kept, with what is seen of them, for other dampers."""


_largest_strain = lru_cache(_SPEEDS)(modal_model.largest_strain)
_families = lru_cache(_SPEEDS)(modal_model.families)


@dataclass(frozen=True)
class Request:
    """A scene, the same as another where what its structure depends on is."""

    key: str
    source: SceneFile = field(compare=False)


@lru_cache(maxsize=8)
def _structure(request: Request) -> SpaceStructure:
    """The structure of a scene without its damper, kept for other dampers."""
    source = request.source
    known = present(source.scene.known)
    model, remarks, sha256 = _model(source, known)
    names = ", ".join(dict.fromkeys(known.files.values()))
    described = f"{len(model.points)} nodes, {sum(len(cells) for _, cells in model.cells)} cells of {names}"
    fits = modal_model.densities(model, model.speeds[0])
    density = None if fits is None else _density(fits)
    if density is not None:
        described += f", of {significant(density)} kg/m³ by the scale of their modes"
    root = np.flatnonzero(modal_model.held(model.speeds[0].shapes))
    remarks += orientation_remarks(model, model.weights, root, "structure")
    count = min(source.scene.rotor.modes, *(modes.frequencies_hz.size for modes in model.speeds))

    @lru_cache(_SPEEDS)
    def modes_at(omega: float) -> ModesAtSpeed:
        _check_speed(source, model, omega)
        try:
            return modal_model.chosen(model.at(omega), np.arange(count))
        except modal_model.BadSpeeds as error:
            below = f"{names}: the squared frequencies between its speeds fall below 0 at {in_rpm(error.omega):.6g} rpm"
            problem = f"{below}: expected shapes that belong to their frequencies, or closer speeds"
            raise source.wrong(problem, "[structure] modes") from error

    return SpaceStructure(model, modes_at, None, described, tuple(remarks), sha256, density=density)


def _model(source: SceneFile, known: KnownModes) -> tuple[ModalModel, list[str], str]:
    """The structure in m and kg about the scene's axis; remarks; the digest of the files."""
    models, remarks, digests, turns = [], list[str](), list[str](), True
    for omega, name in known.files.items():
        raw, sha256 = _read(source, name)
        digests.append(sha256)
        turns = turns and raw.turns
        model = _in_si(source, known, name, raw)
        if not raw.turns and not source.scene.rotor.has_origin:
            raise source.wrong(NO_ORIGIN.format("file"), "[rotor] origin")
        if omega is not None and len(model.speeds) > 1:
            problem = f"{name} has its own speeds: give it alone, modes = '{name}'"
            raise source.wrong(problem, "[structure] modes")
        if omega is None and np.isnan(model.speeds[0].omega):
            omega = _only_speed(source, name)
            remarks.append(f"{name} does not state the speed of its modes: that of the scene is assumed.")
        if omega is not None:
            model = replace(model, speeds=(replace(model.speeds[0], omega=omega),))
        models.append(model)
        remarks += _uneven_density(name, model, solved=raw.solved)
        remarks += _copies(source, name, model)
    with source.blaming("[structure] modes", None, ModesFileError):
        model = joined(models)
    remarks += _contradictions(known, models)
    whole = digests[0] if len(digests) == 1 else hashlib.sha256("".join(digests).encode()).hexdigest()
    return about_spin_axis(source, model, turns=turns), remarks, whole


def _copies(source: SceneFile, name: str, model: ModalModel) -> Iterator[str]:
    """Remarks on modes that move all nodes alike at nearly one frequency: a copy would count twice.

    Raises:
        BadInput: two modes are the same.
    """
    for modes in model.speeds:
        flat, hertz = modes.shapes.reshape(len(modes.shapes), -1), modes.frequencies_hz
        sizes = np.maximum(np.linalg.norm(flat, axis=1), np.finfo(float).tiny)
        mac = (flat @ flat.T / np.outer(sizes, sizes)) ** 2
        for one, other in zip(*np.nonzero(np.triu(mac > _COPY, 1)), strict=True):
            apart = abs(float(hertz[other] / hertz[one]) - 1)
            which = f"modes {one + 1} and {other + 1}"
            if apart < _SAME and abs(sizes[other] / sizes[one] - 1) < _SAME:
                raise source.wrong(f"{name}: {which} are the same: leave one out", "[structure] modes")
            if apart < _CLOSE:
                ends = " and ".join(significant(float(hertz[k]), 5) for k in (one, other))
                alike = f"{which} ({ends} Hz) move all its nodes alike"
                yield f"{name}: {alike}: if one is a copy of the other, it counts twice."


_COPY, _SAME, _CLOSE = 1 - 1e-4, 1e-6, 0.01
"""MAC of modes that move all nodes alike; relative differences of frequencies and sizes: of the same, of close ones."""


def _contradictions(known: KnownModes, models: Sequence[ModalModel]) -> Iterator[str]:
    """What files by speed say that does not go with these speeds, or with each other."""
    names = list(known.files.values())
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            yield f"{name} is given for {names.count(name)} speeds: its modes are assumed not to change between them."
    for (omega, name), model in zip(known.files.items(), models, strict=True):
        static = model.speeds[0].static
        if omega == 0.0 and static is not None and static.any():
            yield f"{name} is given for 0 rpm, but holds a static displacement: does it belong to another speed?"
    unloaded = {each.omega for model in models for each in model.speeds if each.omega > 0.0 and each.static is None}
    if unloaded:
        where = f"The modes at {turning(min(unloaded))} hold" if len(unloaded) == 1 else "Modes at speed hold"
        yield f"{where} no static displacement: place and floor of the damper are those at rest."
    counts = [modes.frequencies_hz.size for model in models for modes in model.speeds]
    if min(counts) < max(counts):
        yield f"The files hold {min(counts)} to {max(counts)} modes; the first {min(counts)}, common to all, are used."


@lru_cache(maxsize=8)
def _file(path: Path, stamp: tuple[int, int]) -> tuple[Raw, str]:
    """A file that is read again and again, as long as it stays the same."""
    return read(path), hashlib.sha256(path.read_bytes()).hexdigest()


def _stamp(source: SceneFile, name: str) -> tuple[int, int]:
    """Time and size of a file, once it is seen to be one.

    Raises:
        BadInput: it is none.
    """
    path = source.folder / name
    if problem := file_problem(path, "file of modes"):
        raise source.wrong(problem, "[structure] modes", name)
    status = path.stat()
    return status.st_mtime_ns, status.st_size


def _read(source: SceneFile, name: str) -> tuple[Raw, str]:
    try:
        return _file(source.folder / name, _stamp(source, name))
    except (ModesFileError, OSError, MemoryError) as error:
        problem = "larger than the available memory" if isinstance(error, MemoryError) else str(error)
        raise source.wrong(problem, "[structure] modes", name) from error


def _only_speed(source: SceneFile, name: str) -> float:
    speeds = source.scene.rotor.speeds
    if len(speeds) > 1:
        problem = (
            f"{name} holds the modes of one speed, and {len(speeds)} are requested: expected that one speed, or files"
            f" for several, such as {{ '0 rpm' = '{name}', '{in_rpm(max(speeds)):.6g} rpm' = … }}"
        )
        raise source.wrong(problem, "[structure] modes")
    return speeds[0]


_METRIC = (("m", "kg"), ("mm", "t"), ("mm", "kg"), ("mm", "g"), ("m", "t"), ("cm", "g"))
_SYSTEMS = (*_METRIC, ("in", "lb"), ("in", "lbf*s^2/in"))
"""Units that files have, by which one that does not fit may be meant."""

_USUAL = (500.0, 20000.0)
"""Densities [kg/m³] of what blades are made of."""

_LIGHTEST = 100.0
"""Density [kg/m³] below which nothing that spins is made; steel in pounds for slinches has 20."""

_LARGE = 20.0
"""Size [m] beyond which a structure is more likely one in mm."""

_UNLIKE = 2.0
"""Ratio of densities that the modes of a structure imply from which on their shapes are not normalised to mass."""


_NORMALISED = "expected shapes of modal mass 1, or their modal masses"


def _in_si(source: SceneFile, known: KnownModes, name: str, raw: Raw) -> ModalModel:
    """The model of a file in m and kg, once its units and the scale of its shapes make sense.

    Raises:
        BadInput: they do not; the message asks for those that would.
    """
    for key in ("unit", "mass_unit"):
        own, unit_given = getattr(raw, key), getattr(known, key)
        if own is not None and unit_given is not None and own != unit_given:
            problem = f"{name} has '{own}': leave this out, or correct the file"
            raise source.wrong(problem, f"[structure] {key}", unit_given)
    try:
        model = in_si(raw, *known.scale(raw.unit, raw.mass_unit))
    except ValueError as error:
        problem = f"{name}: unit '{raw.unit}' or mass_unit '{raw.mass_unit}' is not a unit: {error}"
        raise source.wrong(problem, "[structure] modes") from error
    largest = np.concatenate([np.abs(modes.shapes).max(axis=(1, 2)) for modes in raw.model.speeds])
    if largest.size > 1 and np.ptp(largest) <= 1e-5 * largest.max():
        problem = f"the largest displacement of every mode is {largest[0]:g}: its shapes are not normalised to mass"
        raise source.wrong(f"{name}: {problem}; {_NORMALISED}", "[structure] modes")
    try:
        fits = [modal_model.densities(model, modes) for modes in model.speeds]
    except modal_model.BadCells as error:
        raise source.wrong(f"{name}: {error}", "[structure] modes") from error
    if any(each is None for each in fits):
        _without_density(source, known, name, raw, model)
        return model
    every = np.concatenate([each for each in fits if each is not None])
    known_fits = ((modes, fit) for modes, fit in zip(model.speeds, fits, strict=True) if fit is not None)
    if every.max() > _UNLIKE * every.min() and (
        not raw.solved or any(modal_model.uneven_stiffness(model, *each) for each in known_fits)
    ):
        ends = f"from {significant(float(every.min()))} to {significant(float(every.max()))} kg/m^3"
        problem = f"its shapes are not normalised to mass: for modal masses of 1 the modes would need densities {ends}"
        raise source.wrong(f"{name}: {problem}: {_NORMALISED}", "[structure] modes")
    density = _density(every)
    if not _LIGHTEST <= density <= OSMIUM or model.size > _LARGE:
        raise source.wrong(_units(name, raw, model.size, density), "[structure] unit, mass_unit")
    return model


def _density(fits: Floats) -> float:
    """That of a structure by those that its modes imply [kg/m³]: point masses add to them."""
    return float(fits.min() if fits.max() > _UNLIKE * fits.min() else np.median(fits))


def _uneven_mass(model: ModalModel, *, solved: bool) -> bool:
    """Whether modes imply different densities since the mass is not uniform, and not by the scale of their shapes.

    They are not orthogonal in a uniform mass; or are so by symmetry, were normalised by a solver, and have one modulus.
    """
    modes = model.speeds[0]
    fits = modal_model.densities(model, modes)
    if fits is None or modal_model.uneven_mass(model, modes) > _MIXED:
        return fits is not None
    return solved and not modal_model.uneven_stiffness(model, modes, fits)


def _units(name: str, raw: Raw, size: float, density: float) -> str:
    """What is wrong with the units of a file, and which would make sense."""
    plain = in_si(raw, 1.0, 1.0)
    own = modal_model.densities(plain, plain.speeds[0])
    fitting = []
    for unit, mass_unit in _SYSTEMS:
        length, mass = unit_in_si(unit, LENGTH), unit_in_si(mass_unit, MASS)
        there = 0.0 if own is None else float(np.median(own)) * mass / length**3
        if _USUAL[0] <= there <= _USUAL[1] and plain.size * length <= _LARGE:
            fitting.append(f"unit = '{unit}', mass_unit = '{mass_unit}' ({significant(there)} kg/m^3)")
    meant = f": {' or '.join(fitting)}?" if fitting else ": say what they are"
    return (
        f"in these units {name} describes a structure {significant(size)} m large of {significant(density)} kg/m^3,"
        f" by the scale of its shapes{meant}"
    )


def _without_density(source: SceneFile, known: KnownModes, name: str, raw: Raw, model: ModalModel) -> None:
    """Of a structure without volumes the units have to be said, and it cannot weigh more than it is large.

    Raises:
        BadInput: they are not said; the structure is too large, or too heavy.
    """
    key = "[structure] unit, mass_unit"
    if (known.unit or raw.unit) is None or (known.mass_unit or raw.mass_unit) is None:
        problem = f"missing: {name} has no solid elements by which the units of its shapes could be checked"
        raise source.wrong(problem, key)
    if model.size > _LARGE:
        problem = f"{name} would describe a structure {significant(model.size)} m large: was another unit meant?"
        raise source.wrong(problem, key)
    least = min(float((np.linalg.norm(modes.shapes, axis=2).max(axis=1) ** -2.0).min()) for modes in model.speeds)
    most = OSMIUM * (model.size / 3.0**0.5) ** 3
    if least > most:
        heavy = f"{name} would have an effective mass of {significant(least)} kg where it moves most"
        block = f"its nodes span a block of {significant(most)} kg at most"
        nodes = "If not, nodes further away are missing (of the root, for example)"
        raise source.wrong(f"{heavy}, and {block}: was another unit meant? {nodes}", key)


_UNEVEN = 1.05
"""Ratio of densities from which on it is said."""

_MIXED = 0.05
"""Cosine between modes by the volume from which on their mass is not uniform: 0.02 by C3D8R, 0.1 with two materials."""


def _uneven_density(name: str, model: ModalModel, *, solved: bool) -> Iterator[str]:
    """A remark where the mass that the shapes say the structure has is not that of one density."""
    fits = modal_model.densities(model, model.speeds[0])
    if fits is not None and fits.max() > _UNEVEN * fits.min():
        why = (
            "parts of different density, or point masses. What follows from the mass of its cells, such as the motion"
            " by an acceleration of the root, is approximate"
            if _uneven_mass(model, solved=solved)
            else "parts of different density, or shapes that are not normalised to mass"
        )
        yield (
            f"By its shapes {name} has densities from {significant(float(fits.min()))} to"
            f" {significant(float(fits.max()))} kg/m³, mode by mode: {why}."
        )


def about_spin_axis(source: SceneFile, model: ModalModel, *, turns: bool = False) -> ModalModel:
    """The model about the scene's axis, with forces by the root's motion.

    turns: axis and point on it are the file's where the scene does not give them.
    """
    rotor = source.scene.rotor
    axis_given = rotor.model_fields_set
    axis, origin = model.axis, model.origin
    own = Rotor(rotor.hub_radius, rotor.stagger, rotor.precone)
    if rotor.axis is not None:
        axis = np.array(rotor.axis) / np.linalg.norm(rotor.axis)
    elif axis_given & {"stagger", "precone"} or (axis_given & {"origin", "hub_radius"} and not turns):
        axis = own.axis
    if rotor.origin is not None:
        origin = np.array(rotor.origin)
    elif "hub_radius" in axis_given or (axis_given & {"axis", "stagger", "precone"} and not turns):
        origin = np.array([model.points[:, 0].min(), 0.0, 0.0]) - rotor.hub_radius * own.outwards
    speeds = tuple(
        modes if modes.drawn is not None else replace(modes, drawn=modal_model.drawn_by(model, modes))
        for modes in model.speeds
    )
    return replace(model, axis=axis, origin=origin, speeds=speeds)


_ALIKE = 0.7
"""Modal assurance criterion from which on a mode is followed from one speed to the next."""


def _check_speed(source: SceneFile, model: ModalModel, omega: float) -> None:
    """A speed lies among those known, and the modes are followed where it lies between two.

    Raises:
        BadInput: it does not, or they cannot be.
    """
    known = model.omegas
    slack, key = modal_model.SAME_SPEED * max(float(known.max()), 1.0), "[rotor] speeds"
    if not known.min() - slack <= omega <= known.max() + slack:
        have = interval(f"{in_rpm(known.min()):.6g}", f"{in_rpm(known.max()):.6g}", before="from ", alone="at ")
        problem = f"the modes are known {have} rpm: expected a speed there, not {in_rpm(omega):.6g} rpm"
        raise source.wrong(problem, key)
    lost = np.flatnonzero(model.likeness[: source.scene.rotor.modes] < _ALIKE)
    if np.abs(known - omega).min() > slack and lost.size:
        number = int(lost[0]) + 1
        problem = (
            f"mode {number} cannot be followed from one speed of the files to the next (MAC"
            f" {model.likeness[lost[0]]:.2f}), and {in_rpm(omega):.6g} rpm lies between them: expected files at"
            f" speeds closer together{f', or [rotor] modes = {number - 1}' if number > 1 else ''}"
        )
        raise source.wrong(problem, key)


def _interpolation_remarks(source: SceneFile, model: ModalModel, seat: Seat | None) -> list[str]:
    """What is said of speeds between those of the files."""
    known = model.omegas
    between = [omega for omega in source.scene.rotor.speeds if np.abs(known - omega).min() > 1e-9 * known.max()]
    if not between and (source.scene.excitation is None or known.size != 2):  # orders meet modes between the speeds
        return []
    remark = f"Between the {known.size} speeds of the files the modes are interpolated in the square of the speed"
    if known.size < 3:
        return [f"{remark}: with only two speeds the error of this is unknown."]
    count = source.scene.rotor.modes
    changes, masses = [], []
    for omega in between:
        modes, rough = model.at(omega), model.at(omega, fewer=True)
        changes.append(float(np.abs(rough.frequencies_hz / modes.frequencies_hz - 1.0)[:count].max()))
        if seat is not None:
            one, other = (np.linalg.norm(seat.place.displacement(each.shapes[:1])) for each in (modes, rough))
            masses.append(float(abs((one / other) ** 2 - 1.0)))
    remark += f": leaving out the nearest one changes frequencies by up to {percent(max(changes))} %"
    if masses:
        remark += f" and the effective mass at the damper in the first mode by up to {percent(max(masses))} %"
    return [f"{remark}."]


def seat_of(
    source: SceneFile, model: ModalModel, modes: ModesAtSpeed, pull_at: Callable[[Place], Pull] | None = None
) -> tuple[Seat | None, tuple[str, ...]]:
    """Where the damper of a scene, if there is one, sits on a structure in space, with remarks.

    modes: at the scene's lowest speed; the first gives axis 1 of a cavity that has no direction. pull_at: gives the
    ball's pull at a place; None: it follows from the modes alone.

    Raises:
        BadInput: the place is not on the structure, or does not move; its slopes are not those of its displacements; a
            cavity lies for the most part outside a blade.
    """
    from fem.reduction.known_modes import NoMotion, bending_direction, floor

    damper = source.scene.damper
    if damper is None:
        return None, ()
    at = _place(source, model, damper.at, "[damper] at")
    if np.abs(at.displacement(modes.shapes)).max() <= results.STILL * np.abs(modes.shapes).max():
        raise source.wrong("this place is clamped: no mode moves it", "[damper] at", damper.at)
    try:
        wanted = damper.direction
        direction = bending_direction(model, at, modes) if wanted is None else np.array(wanted, dtype=np.float64)
        normal = None if damper.normal is None else np.array(damper.normal, dtype=np.float64)
        seen = floor(model, at, modes, direction, normal)
    except NoMotion as error:
        given = {"normal": damper.normal, "direction": damper.direction, "at": damper.at}
        key = next(key for key in (error.about, "normal", "at") if given[key] is not None)
        raise source.wrong(str(error), f"[damper] {key}", given[key]) from error
    if max(damper.cavity) >= model.size:
        problem = f"larger than the structure, whose nodes span {1e3 * model.size:.6g} mm: was another unit meant?"
        raise source.wrong(problem, "[damper] cavity", damper.cavity)
    remarks = []
    if at.distance > _OFF * model.size:
        there = ", ".join(f"{1e3 * each:.6g}" for each in at.point)
        remarks.append(
            f"The damper is placed at the nearest point of the structure to the requested place, ({there}) mm,"
            f" {significant(1e3 * at.distance)} mm from it."
        )
    metal, sticks_out, misfit = _fit(source, model, at, seen)
    remarks += misfit
    leads = int(np.argmax(seen.moved[0] ** 2 / modes.squares))  # most of what moves along axis 1
    lift, slope, spread = (float(each[0, leads]) for each in (seen.moved, seen.slope, seen.spread))
    if modes.rotations is not None:
        other = float(floor(model, at, replace(modes, rotations=None), direction, normal).slope[0, leads])
        if max(abs(slope), abs(other)) > _UNLIKE_TURNS * min(abs(slope), abs(other)):
            tilts = f"tilt the floor by {significant(slope / lift)} 1/m over the displacement"
            others = f"their displacements by {significant(other / lift)} 1/m"
            problem = f"in mode {leads + 1} the nodes' rotations {tilts}, and {others}"
            raise source.wrong(f"{problem}: expected rotations in rad of the same shapes", "[structure] modes")
    effective = abs(lift) ** -2.0 if lift else math.inf
    if source.scene.blade is None and (damper.balls or 0.0) > effective:
        remarks.append(
            f"The balls weigh {significant(damper.balls)} kg, more than the effective mass M2 of mode {leads + 1} at"
            f" the damper, {significant(effective)} kg: is [structure] mass_unit right?"
        )
    if abs(spread) > _UNSURE * abs(slope) and abs(lift) > 0.0:
        remarks.append(
            f"The slope of the floor in mode {leads + 1}, {significant(slope / lift)} 1/m over the displacement, is"
            f" uncertain by {share(abs(spread / slope), 2)} %: it is {at.how}."
        )
    shaken, force = source.scene.excitation, None
    if shaken is not None and shaken.at is not None and shaken.direction is not None:
        along = np.array(shaken.direction, dtype=np.float64)
        force = _place(source, model, shaken.at, "[excitation] at"), along / np.linalg.norm(along)
    pull = _pull(model, at) if pull_at is None else pull_at(at)
    if pull.strays > _STRAYS * model.size:
        remarks.append(
            f"The straight line from the root to the damper's place lies up to {significant(1e3 * pull.strays, 2)} mm"
            " outside the structure: how the ball's pull stiffens it, by the shortening of that line, is a rough"
            " estimate (a solid blade, [blade], is stiffened by the stress in its metal)."
        )
    return Seat(at, direction, pull, force, normal, metal, sticks_out), tuple(remarks)


def _fit(source: SceneFile, model: ModalModel, at: Place, seen: Floor) -> tuple[tuple[Place, ...], float, list[str]]:
    """Places in the metal where the cavity is, how far its box sticks out of it [m], and a remark on that.

    The box stands on the floor. Where metal surrounds a hollow, the mesh has the cavity cut: then its corners count.

    Raises:
        BadInput: it lies for the most part outside a blade.
    """
    damper = present(source.scene.damper)
    sides = np.array([*damper.cavity, 2 * damper.radius])

    def in_space(grid: Floats) -> Floats:
        return np.asarray(at.point - damper.radius * seen.normal + (grid * sides) @ np.vstack([seen.axes, seen.normal]))

    def metal(*, cut: bool) -> tuple[Place, ...]:
        """By Gauss' rule, as far as they are inside: the mean over them is that of a quadratic over the box."""
        gauss = in_space(ends[corners] / math.sqrt(3))
        off = None if cut else modal_model.outside(model, gauss)
        if off is None:
            return ()
        return tuple(modal_model.place(model, point) for point in gauss[off < slack]) or (at,)

    ends, slack = np.array(list(product((-0.5, 0.0, 0.5), repeat=3))), _STICKS * sides.min()
    points, corners = in_space(ends), (ends != 0.0).all(axis=1)
    off = modal_model.outside(model, points)
    if off is None or off.max() < slack:
        return metal(cut=off is None), 0.0, []
    inner = modal_model.outside(model, in_space(np.array(list(product(_PARTS, repeat=3)))))
    filled = 0.0 if inner is None else float((inner < slack).mean())
    hollow = off[len(ends) // 2] >= slack and (filled < _NO_METAL or off[corners].max() < _SURROUNDED * sides.min())
    off = np.where(corners | (not hollow), off, 0.0)
    if (far := float(off.max())) < slack:
        return metal(cut=hollow), 0.0, []
    box = f"box of {' x '.join(significant(1e3 * each) for each in sides)} mm on the floor"
    there = ", ".join(f"{each:.4g}" for each in 1e3 * points[off.argmax()])
    sticks_out = f"sticks out of the structure by up to {significant(1e3 * far, 2)} mm, near ({there}) mm"
    if source.scene.blade is not None and not hollow and filled < _MOST:
        problem = (
            f"the {box} {sticks_out}, and only {significant(100 * filled, 2)} % of it is in metal: expected a smaller"
            " cavity, a place (at) further inside, or a mesh that includes the cavity and its housing"
        )
        raise source.wrong(problem, "[damper] cavity", damper.cavity)
    remark = f"Unless the mesh has the cavity cut or housed, it does not fit: its {box} {sticks_out}."
    return metal(cut=hollow), far, [remark]


_STICKS = 0.01
"""Part of its smallest side by which a cavity may stick out of the structure."""

_PARTS = tuple((np.arange(6) + 0.5) / 6 - 0.5)
"""Middles of the parts of a cavity's side, over the side, at which there may be metal."""

_NO_METAL, _MOST = 0.1, 0.45
"""Parts of a cavity's box in metal: below, the mesh has no metal there; below, a blade has no room for the cavity."""

_SURROUNDED = 0.25
"""Part of its smallest side by which the corners of a cavity that the mesh has cut may lie off the metal."""

_STRAYS = 0.01
"""Distance from the structure, relative to its size, from which on a line leaves it."""

_OFF = 1e-4
"""Distance from the place asked for, relative to the structure, from which on it is said."""

_UNLIKE_TURNS = 10.0
"""Ratio of slopes by rotations and by displacements from which on they are not those of one shape."""

_UNSURE = 0.02
"""Relative uncertainty of a slope from which on it is said."""


def _place(source: SceneFile, model: ModalModel, at: tuple[float, ...] | str | int | None, key: str) -> Place:
    """The place on the structure that a key asks for.

    Raises:
        BadInput: there is none.
    """
    with source.blaming(key, at, modal_model.OffTheStructure):
        return _placed(model, tuple(_point(source, model, at, key).tolist()))


@lru_cache(maxsize=4)
def _placed(model: ModalModel, point: tuple[float, ...]) -> Place:
    """The place nearest to a point, the same for all dampers there."""
    return modal_model.place(model, np.array(point))


_pull = lru_cache(maxsize=4)(modal_model.pull)


def named_set(source: SceneFile, sets: Mapping[str, Ints], name: str, key: str, beside: str = "") -> Ints:
    """Nodes of a set that a scene names, in capital or small letters, which are the same in Abaqus and CalculiX.

    beside: what may stand there instead.

    Raises:
        BadInput: there is no such set.
    """
    alike = [each for each in sets if each.lower() == name.lower()]
    if len(alike) > 1:
        raise source.wrong(
            f"the file has {' and '.join(alike)}, which differ only in case: merge these sets", key, name
        )
    if not alike:
        there = f"expected a set of nodes in the file ({', '.join(sets)})" if sets else "the file has no sets of nodes"
        raise source.wrong(f"{there}{beside}{did_you_mean(name, sets)}", key, name)
    return sets[alike[0]]


def _point(source: SceneFile, model: ModalModel, at: tuple[float, ...] | str | int | None, key: str) -> Floats:
    """The point that `at` means: itself, a node, or the middle of a set of nodes."""
    if isinstance(at, tuple):
        return np.array(at, dtype=np.float64)
    if isinstance(at, str):
        return np.asarray(model.points[named_set(source, model.sets, at, key)].mean(axis=0))
    if source.scene.blade is not None and model.labels is None:
        problem = "the numbers of the nodes are not known from this file: expected three lengths, or a set of nodes"
        raise source.wrong(problem, key, at)
    labels = np.arange(1, len(model.points) + 1) if model.labels is None else model.labels
    rows = np.flatnonzero(labels == at)
    if not rows.size:
        problem = f"no such node: expected a number from {labels.min()} to {labels.max()}"
        raise source.wrong(problem, key, at)
    return np.asarray(model.points[int(rows[0])])
