"""Matrices of a plate on a rotor: everything that does not depend on the speed.

`assemble` makes them; `with_point_mass` and `with_coriolis` add to them, `with_cavity` takes metal out, `rows_at`
reads displacements at places, and `transfer` carries shapes from one mesh to another.

Each is a form, a small coefficient matrix over the fields of a theory. In the frame that turns with the rotor about the
axis n, P = I - n n^T, and at Omega = 1: mass rho U.U, softening rho U.P U, Coriolis 2 rho U.(n x U), centrifugal load
rho P X, and the geometric stiffness S_ab H_ka H_kb of a stress S (the second-order part of the Green-Lagrange strain;
in a plate it holds N:(grad w grad w), N:(grad u grad u), which carries the in-plane modes, and the rotary part).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from scipy.sparse import coo_array, csc_array, vstack

from fem.linalg import LEAST_ACROSS, Array, Factor, Solver, axes_beside, factorise
from fem.meshes.planform import PlaceError, locate, position, root
from fem.meshes.thickness import of
from fem.plate import Plate
from fem.rotor import Effects, Rotor
from fem.theory.discretisation import Discretisation, Stressed
from fem.theory.fields import gram
from fem.theory.registry import Kind, discretise, kind
from fem.theory.sections import products, strain_matrix


def elastic_stiffness(model: Discretisation) -> csc_array:
    """Return the linear elastic stiffness, N/m."""
    strains = [(layer.weight, strain_matrix(layer)) for layer in model.elastic]
    coefficients = np.sum([w * b.T @ model.stiffness @ b for w, b in strains], axis=0)
    return gram((model.gradient, coefficients), *model.extra)


def elastic_energies(model: Discretisation, shapes: Array) -> Array:
    """Twice the energies (k, k) of shapes (n, k) with one another at small strains.

    From the strains at the points: the stiffness's entries are as large as the stiffest strain makes them, and their
    rounding drowns the softest.
    """
    gradients = model.gradient.evaluate(shapes)
    energies = np.zeros((shapes.shape[1],) * 2)
    for layer in model.elastic:
        strain = np.einsum("sg,gcpk->scpk", strain_matrix(layer), gradients)
        energies += _energies(layer.weight * model.stiffness, strain, model.gradient.dx)
    for fields, coefficients in model.extra:
        energies += _energies(coefficients, fields.evaluate(shapes), fields.dx)
    return energies


def _energies(coefficients: Array, strain: Array, dx: Array) -> Array:
    """Integrals (k, k) of c_ij e_i e_j, c pointwise or the same everywhere, of strains (n, ncell, npoint, k)."""
    everywhere = np.broadcast_to(
        coefficients.reshape(*coefficients.shape, *(1,) * (4 - coefficients.ndim)), (*coefficients.shape[:2], *dx.shape)
    )
    stress = np.einsum("ijcp,cp,jcpk->icpk", everywhere, dx, strain, optimize=True)
    return np.asarray(np.tensordot(strain, stress, ((0, 1, 2), (0, 1, 2))))


def energy_densities(model: Discretisation, shapes: Array) -> Array:
    """Twice the elastic energy per volume (ncell, npoint, k) of shapes (n, k) [J/m³].

    It is the average through the thickness.
    """
    gradients = model.gradient.evaluate(shapes)
    total = np.zeros(gradients.shape[1:])
    for layer in model.elastic:
        strain = np.einsum("sg,gcpk->scpk", strain_matrix(layer), gradients)
        stress = np.einsum("st,tcpk->scpk", model.stiffness, strain)
        total += layer.weight * np.real(strain.conj() * stress).sum(axis=0)
    return total / sum(layer.weight for layer in model.elastic)


def inertia(model: Discretisation, density: float, through: Array) -> csc_array:
    """The matrix of density * U.(through U).

    Args:
        model: the discretised plate.
        density: [kg/m³].
        through: shape (3, 3): identity for the mass, P for the softening, 2 n x for Coriolis forces.
    """
    layers = [(layer.weight, layer.displacement) for layer in model.inertia]
    coefficients = density * np.sum([w * t.T @ through @ t for w, t in layers], axis=0)
    return gram((model.displacement, coefficients))


def centrifugal_load(model: Discretisation, density: float, rotor: Rotor) -> Array:
    """Load vector (dofs,) of density * P X at 1 rad/s.

    Args:
        model: the discretised plate.
        density: [kg/m³].
        rotor: spin axis and hub.
    """
    total = np.zeros((model.displacement.size, *model.points.shape[1:]))
    for layer in model.inertia:
        from_axis = model.points + (rotor.hub_radius * rotor.outwards)[:, None, None]
        from_axis[0] -= root(model.mesh)
        from_axis[2] += layer.z
        force = layer.weight * density * layer.displacement.T @ rotor.projector
        total += np.einsum("fk,kcp->fcp", force, from_axis)
    return model.displacement.load(total)


def uniform_load(model: Discretisation, density: float | Array, direction: Array) -> Array:
    """Load vector (dofs,) of a force per volume along a direction (3,), the same through the thickness.

    density: its size, one or at every point (ncell, npoint) [N/m³].
    """
    along = np.sum(
        [layer.weight * (layer.displacement.T @ direction)[:, None, None] for layer in model.inertia], axis=0
    )
    return model.displacement.load(along * density * np.ones(model.points.shape[1:]))


def geometric_stiffness(model: Discretisation, unknowns: Array) -> csc_array:
    """Return the geometric stiffness of the stress that is linear in a displacement (dofs,), N/m."""
    n, gradients = model.gradient.size, model.gradient.evaluate(unknowns)
    coefficients = np.zeros((n, n, *model.gradient.dx.shape))
    for layer in model.elastic:
        stress = np.einsum("sg,gcp->scp", model.stiffness @ strain_matrix(layer), gradients)
        second = products(layer)
        i, j = np.nonzero(second.any(axis=0))
        coefficients[i, j] += np.tensordot(layer.weight * second[:, i, j].T, stress, 1)
    return gram((model.gradient, coefficients))


class StressedBody(Protocol):
    """The elastic energy of a body at a displacement."""

    def force(self) -> Array:
        """The internal force (n,) in N."""

    def ahead(self, step: Array) -> Any:
        """The stress that a step (n,) leads to, to first order."""

    def stiffness(self, stress: Any = None) -> csc_array:
        """The tangent stiffness (n, n) in N/m, or that under another stress."""


class Body(Protocol):
    """An elastic body on a rotor, as equilibria and modes need it: a plate (`Operators`) or a solid blade."""

    @property
    def theory(self) -> str:
        """Name of its theory."""

    @property
    def effects(self) -> Effects:
        """What counts."""

    @property
    def stiffness(self) -> csc_array:
        """At rest, (n, n)."""

    @property
    def mass(self) -> csc_array:
        """Its mass, (n, n)."""

    @property
    def softening(self) -> csc_array | None:
        """What spin softening takes from the stiffness, per Omega²; None: left out."""

    @property
    def load(self) -> Array:
        """The centrifugal load (n,) per Omega²."""

    @property
    def prestress(self) -> Array | None:
        """A displacement (n,) per Omega² to begin an equilibrium with; None: rest."""

    def at(self, omega: float) -> csc_array:
        """K(Omega), (n, n), its prestress linear in Omega²."""

    def stressed(self, state: Array) -> StressedBody:
        """Its elastic energy at a displacement (n,)."""

    def factorise(self, matrix: csc_array) -> Factor:
        """Factor of a matrix over its unknowns."""

    def solver(self, matrix: csc_array) -> Solver:
        """What solves a stiffness on the way to an equilibrium: its factor, or less."""


@dataclass(frozen=True, eq=False)
class StressedPlate:
    """The parts of a plate's elastic energy at a displacement."""

    parts: tuple[Stressed, ...]

    def force(self) -> Array:
        """The internal force (n,) in N."""
        return np.asarray(np.sum([part.force() for part in self.parts], axis=0))

    def ahead(self, step: Array) -> list[Array]:
        """The stress that a step (n,) leads to, to first order."""
        return [part.ahead(step) for part in self.parts]

    def stiffness(self, stress: list[Array] | None = None) -> csc_array:
        """The tangent stiffness (n, n) in N/m, or that under another stress."""
        under = [part.stress for part in self.parts] if stress is None else stress
        return gram(*(term for part, own in zip(self.parts, under, strict=True) for term in part.terms(own)))


@dataclass(frozen=True, eq=False)
class Operators:
    """A plate's matrices over its n free unknowns, SI units; Omega in rad/s. They are read-only.

    K(Omega) = stiffness + Omega² (geometric - softening). What an effect leaves out is None.

    Attributes:
        gyroscopic: G, the Coriolis force is -Omega G times the velocity.
        load: the centrifugal load (n,) per Omega², zero where nothing asks for it.
        prestress: the displacement (n,) it causes, per Omega².
        pulled: what the point mass's load adds to geometric, None without it.
        cavity: places (k, 2) in m at each of which it takes so much metal in kg out; None without one.
    """

    plate: Plate
    rotor: Rotor
    effects: Effects
    model: Discretisation
    stiffness: csc_array
    mass: csc_array
    geometric: csc_array | None
    softening: csc_array | None
    gyroscopic: csc_array | None
    load: Array
    prestress: Array | None
    pulled: csc_array | None = None
    cavity: tuple[Array, float] | None = None
    _places: dict[tuple[float, float], AtPlace] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        for matrix in (self.stiffness, self.mass, self.geometric, self.softening, self.gyroscopic, self.pulled):
            if matrix is not None:
                matrix.data.flags.writeable = False
        for vector in (self.load, self.prestress):
            if vector is not None:
                vector.flags.writeable = False

    @cached_property
    def spinning(self) -> csc_array:
        """What Omega² multiplies in K(Omega), (n, n)."""
        total = csc_array(self.stiffness.shape) if self.geometric is None else self.geometric
        return total if self.softening is None else csc_array(total - self.softening)

    @cached_property
    def without_coriolis(self) -> Operators:
        """The same without Coriolis forces."""
        return self if self.gyroscopic is None else replace(self, gyroscopic=None)

    def at_place(self, at: tuple[float, float]) -> AtPlace:
        """The plate at a place (x, y) in m; made once."""
        x, y = map(float, at)
        if (x, y) not in self._places:
            self._places[x, y] = AtPlace(self, (x, y))
        return self._places[x, y]

    @property
    def theory(self) -> str:
        """The plate's."""
        return self.model.theory

    @property
    def points(self) -> list[tuple[Array, float]]:
        """Places (k, 2) in m, and the mass in kg at each of them: the plate's point mass, and the metal of a cavity."""
        plate, masses = self.plate, []
        if plate.tip_mass > 0.0 and plate.tip_at is not None:
            masses.append((np.array([plate.tip_at]), plate.tip_mass))
        if self.cavity is not None:
            masses.append((self.cavity[0], -self.cavity[1]))
        return masses

    def stressed(self, state: Array) -> StressedPlate:
        """The elastic energy at a displacement (n,)."""
        return StressedPlate(tuple(energy.at(state) for energy in self.model.energies))

    def factorise(self, matrix: csc_array) -> Factor:
        """Factor of a matrix over the unknowns."""
        return factorise(matrix)

    def solver(self, matrix: csc_array) -> Factor:
        """The same: a plate's factors are cheap."""
        return self.factorise(matrix)

    def from_axis(self, at: tuple[float, float]) -> Array:
        """A place (x, y) in m in the mesh's coordinates, (3,) in m from a point of the spin axis."""
        along = np.array([at[0] - root(self.plate.mesh), at[1], 0.0])
        return np.asarray(self.rotor.hub_radius * self.rotor.outwards + along)

    def radius(self, x: float, y: float = 0.0) -> float:
        """Distance [m] of a place (x, y) [m] from the spin axis."""
        return float(np.linalg.norm(np.cross(self.rotor.axis, self.from_axis((x, y)))))

    def at(self, omega: float) -> csc_array:
        """K(Omega), (n, n), its prestress linear in Omega²; `tangent` has that of a large deflection."""
        if self.geometric is None and self.softening is None:
            return self.stiffness
        total: csc_array = (self.stiffness + omega**2 * self.spinning).tocsc()
        return total


def assemble(plate: Plate, rotor: Rotor, effects: Effects, theory: str = "mindlin") -> Operators:
    """Matrices of a plate on a rotor; the prestress is solved once, at 1 rad/s.

    Args:
        plate: mesh, thickness, material, masses and root.
        rotor: spin axis, hub and angles.
        effects: which effects of spinning count.
        theory: name in `fem.theory.registry.THEORIES`.

    Raises:
        ValueError: an unknown theory, or one that the mesh does not allow.
    """
    model = discretise(plate, theory, effects.rotary_inertia)
    density = plate.material.density
    stiffness = elastic_stiffness(model)
    load = np.zeros(model.dofs)
    prestress = geometric = softening = gyroscopic = held = None
    if effects.stress_stiffening:
        load = centrifugal_load(model, density, rotor)
        held = _held(model, stiffness)
        prestress, geometric = _stiffening(model, held, load)
    if effects.spin_softening:
        softening = inertia(model, density, rotor.projector)
    if effects.coriolis:
        gyroscopic = inertia(model, density, 2.0 * rotor.spin)
    mass = inertia(model, density, np.eye(3))
    operators = Operators(
        plate, rotor, effects, model, stiffness, mass, geometric, softening, gyroscopic, load, prestress
    )
    for places, each in operators.points:
        operators = with_masses(operators, places, each, held)
    return operators


def with_point_mass(operators: Operators, at: tuple[float, float], mass: float) -> Operators:
    """The same plate with a point mass stuck to it.

    Like all mass it has inertia, pulls outwards on the plate, and softens.

    Args:
        operators: of the plate.
        at: place (x, y) [m].
        mass: [kg].

    Raises:
        ValueError: a place off the plate, or a mass that is negative or not finite.
    """
    if not (np.isfinite(mass) and mass >= 0.0):
        raise ValueError(f"mass must be zero or more kg, got {mass!r}")
    return with_masses(operators, np.array([at]), mass)


def with_masses(operators: Operators, places: Array, mass: float, held: Factor | None = None) -> Operators:
    """The same plate with an equal point mass at each of several places.

    Args:
        operators: of the plate.
        places: shape (k, 2) [m].
        mass: of each [kg]; it may be negative.
        held: see `_held`, if known.
    """
    model, rotor = operators.model, operators.rotor
    rows = rows_at(model, places)
    changed: dict[str, Any] = {"mass": operators.mass + mass * _through(rows, np.eye(3))}
    if operators.prestress is not None and operators.geometric is not None:
        load = mass * (rows.T @ np.concatenate([rotor.projector @ operators.from_axis((x, y)) for x, y in places]))
        prestress, geometric = _stiffening(model, held or _held(model, operators.stiffness), load)
        changed["load"] = operators.load + load
        changed["prestress"] = operators.prestress + prestress
        changed["geometric"] = operators.geometric + geometric
        changed["pulled"] = geometric
    if operators.softening is not None:
        changed["softening"] = operators.softening + mass * _through(rows, rotor.projector)
    if operators.gyroscopic is not None:
        changed["gyroscopic"] = operators.gyroscopic + mass * _through(rows, 2.0 * rotor.spin)
    return replace(operators, **changed)


POINTS = 32
"""Places at which a cavity takes its metal out: they reproduce its extent."""

MOST_EMPTIED = 0.5
"""Share of the thickness that cavities take around their place at most: the mass of a plate stays positive definite."""


def with_cavity(operators: Operators, at: tuple[float, float], volume: float, depth: float) -> Operators:
    """The same plate without the mass of the metal that cavities take out.

    Like all mass it has inertia, pulls outwards on the plate and softens. The stiffness stays
    (`fem.accuracy.neglected_effects.cut`).

    Args:
        operators: of the plate.
        at: place (x, y) of the cavities [m].
        volume: of all cavities [m³].
        depth: of a cavity through the thickness [m].

    Raises:
        PlaceError: off the plate, or where the plate has no room for them.
    """
    places = footprint(operators, at, volume, depth)
    mass = operators.plate.material.density * volume / len(places)
    return replace(with_masses(operators, places, -mass), pulled=operators.pulled, cavity=(places, mass))


def footprint(operators: Operators, at: tuple[float, float], volume: float, depth: float) -> Array:
    """Places spread evenly over the part of a plate that cavities take up.

    Args:
        operators: of the plate.
        at: place (x, y) of the cavities [m].
        volume: of all cavities [m³].
        depth: of a cavity through the thickness [m].

    Returns:
        Shape (k, 2) [m].

    Raises:
        PlaceError: off the plate, or where the plate has no room for them.
    """
    plate, mesh = operators.plate, operators.model.mesh
    locate(mesh, at)
    pitch = np.sqrt(volume / (min(depth, MOST_EMPTIED * plate.thickness_at(at)) * POINTS))
    steps = np.arange(-POINTS, POINTS) + 0.5
    offsets = pitch * np.array(np.meshgrid(steps, steps)).reshape(2, -1).T
    places: list[Array] = []
    for offset in offsets[np.hypot(*offsets.T).argsort(kind="stable")]:
        try:
            locate(mesh, (at[0] + offset[0], at[1] + offset[1]))
        except PlaceError:
            continue
        places.append(at + offset)
        if len(places) == POINTS:
            return np.array(places)
    raise PlaceError(f"the plate has no room around {position(at)} m for cavities of {1e9 * volume:.6g} mm³ together")


def with_coriolis(operators: Operators) -> Operators:
    """Count the Coriolis forces in, those of the plate's own point mass too."""
    through = 2.0 * operators.rotor.spin
    gyroscopic = inertia(operators.model, operators.plate.material.density, through)
    for places, mass in operators.points:
        gyroscopic = gyroscopic + mass * _through(rows_at(operators.model, places), through)
    return replace(operators, effects=replace(operators.effects, coriolis=True), gyroscopic=gyroscopic)


def rows_at(model: Discretisation, places: Array, derivative: tuple[int, ...] = ()) -> csc_array:
    """Rows that read the displacement, or a derivative of it, at places.

    Args:
        model: the discretised plate.
        places: shape (k, 2) [m].
        derivative: numbers of the coordinates to differentiate by; none: the displacement.

    Returns:
        Sparse, shape (3 k, n): u, v and w from the unknowns, place after place.
    """
    located = [locate(model.mesh, (x, y)) for x, y in places]
    cells, reference = np.array([cell for cell, _ in located]), np.column_stack([at for _, at in located])
    rows, columns, weights = [], [], []
    for k, space in enumerate(model.spaces):
        weight, dofs = space.probe(cells, reference, derivative)
        place, function = np.nonzero(dofs >= 0)
        rows.append(3 * place + k)
        columns.append(dofs[place, function])
        weights.append(weight[place, function])
    where = (np.concatenate(rows), np.concatenate(columns))
    return coo_array((np.concatenate(weights), where), shape=(3 * len(places), model.dofs)).tocsc()


def motion_rows(model: Discretisation, places: Array) -> list[csc_array]:
    """Rows (3 k, n) that read the displacement at places (k, 2), its derivative by x, and that by y."""
    return [rows_at(model, places, derivative) for derivative in ((), (0,), (1,))]


@dataclass(frozen=True, eq=False)
class AtPlace:
    """A plate at a place: the rows that read its motion there, and what a ball there adds to it.

    Attributes:
        operators: of the plate; at: place (x, y) [m].
    """

    operators: Operators
    at: tuple[float, float]

    @cached_property
    def rows(self) -> list[csc_array]:
        """Rows (3, n) for u, v and w, for their derivatives by x, and for those by y."""
        return motion_rows(self.operators.model, np.array([self.at]))

    @cached_property
    def axes(self) -> Array:
        """Of a floor that faces the load, on the spin axis the tip (3, 3): through the thickness, across, and outwards.

        Raises:
            PlaceError: the load is along the plate's normal.
        """
        pull = self.operators.rotor.projector @ self.operators.from_axis(self.at)
        normal = pull / np.linalg.norm(pull) if pull.any() else np.eye(3)[0]
        axes, angle = axes_beside(normal, np.eye(3)[2])
        if angle < LEAST_ACROSS:
            raise PlaceError(f"hardly any load lies in the plate's plane at {position(self.at)} m")
        return np.vstack([axes, normal])

    def pull(self, shape: Array) -> float:
        """What the load of 1 kg adds to the stiffness of a shape (n,), over Omega²."""
        return float(shape @ (self.ball[0] @ shape))

    @cached_property
    def floor(self) -> csc_array:
        """Rows (4, n) for the place's displacement along the floor's two axes, and for the slopes of the floor there.

        The floor bends and turns with the material: through the thickness by -w_x and -w_y.
        """
        moved, along, across = self.rows
        *axes, normal = self.axes
        turned = csc_array(normal[None, :2]) @ vstack([along[[2]], across[[2]]])
        slopes = [each[2] * turned - csc_array(normal[None]) @ (each[0] * along + each[1] * across) for each in axes]
        return csc_array(vstack([csc_array(self.axes[:2]) @ moved, *slopes]))

    @cached_property
    def flap(self) -> Array:
        """Rows (2, n) for the displacement along the floor's first axis, and the slope there."""
        return np.asarray(self.floor[[0, 2]].toarray())

    @cached_property
    def ball(self) -> tuple[csc_array, csc_array]:
        """What 1 kg adds to `spinning` and to the mass, both (n, n)."""
        heavy = with_point_mass(self.operators, self.at, 1.0)
        return (heavy.spinning - self.operators.spinning).tocsc(), (heavy.mass - self.operators.mass).tocsc()


def _through(rows: csc_array, matrix: Array) -> csc_array:
    each = np.kron(np.eye(rows.shape[0] // 3), matrix)
    return csc_array(rows.T @ csc_array(each) @ rows)


def _held(model: Discretisation, stiffness: csc_array) -> Factor:
    """Factor of the stiffness of the unknowns that a linear prestress may move."""
    return factorise(stiffness[model.membrane][:, model.membrane].tocsc())


def _stiffening(model: Discretisation, factor: Factor, load: Array) -> tuple[Array, csc_array]:
    """Solve for the displacement of a load and the geometric stiffness of its stress."""
    displacement = np.zeros(model.dofs)
    displacement[model.membrane] = factor.solve(load[model.membrane])
    return displacement, geometric_stiffness(model, displacement)


FIELDS = ((0, ()), (1, ()), (2, ()), (2, (0,)), (2, (1,)))
"""u, v, w and the slopes of w, which the rotations of a thin plate are."""

AT_ONCE = 500
"""Points looked up together: neighbours, which have few cells to choose from."""


def transfer(state: Array, known: Operators, target: Operators) -> Array | None:
    """A displacement that is known on one mesh, carried to another.

    It is the nearest in the mean square of u, v, w, and of the rotations times the thickness.

    Args:
        state: unknowns on the known mesh, shape (m,).
        known: operators on that mesh.
        target: operators on the other.

    Returns:
        Shape (n,); None for solids, and where a point is not found in the known mesh.
    """
    model = target.model
    if kind(model.theory) is Kind.SOLID:
        return None
    points = model.points[:2].reshape(2, -1)
    padded = np.append(state, 0.0)  # the clamped unknowns, numbered -1
    try:
        pieces = [_fields(padded, known, points[:, k : k + AT_ONCE]) for k in range(0, points.shape[1], AT_ONCE)]
    except Exception:  # scikit-fem's search tolerates next to no rounding, and raises what it likes
        return None
    values = np.concatenate(pieces, axis=1).reshape(len(FIELDS), *model.points.shape[1:])
    thickness = of(target.plate.thickness, model.points[:2])
    weigh = np.ones(len(FIELDS))
    if isinstance(thickness, float):
        weigh[3:] = thickness**2
    else:  # the model's rotations are in parts of it (`fem.theory.sections`)
        values[3:] *= thickness
    matrix = gram((model.displacement, np.diag(weigh)))
    return factorise(matrix).solve(model.displacement.load(weigh[:, None, None] * values))


def _fields(padded: Array, known: Operators, points: Array) -> Array:
    """FIELDS (5, k) of a state, with a zero behind it, at points (2, k) in m."""
    mesh = known.model.mesh
    mapping = mesh.mapping()
    cells = mesh.element_finder(mapping=mapping)(*points)
    reference = mapping.invF(points[:, :, None], tind=cells)[:, :, 0]
    values = []
    for number, derivative in FIELDS:
        weights, unknowns = known.model.spaces[number].probe(cells, reference, derivative)
        values.append((weights * padded[unknowns]).sum(axis=1))
    return np.array(values)
