"""Changes that leave a problem the same but for rounding."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any
from unittest import mock

import numpy as np
from scipy.sparse import tril

from fem import Material, Operators, Plate, Rotor, assemble
from fem.theory.discretisation import Discretisation
from fem.theory.fields import Block, Fields

EPS = float(np.finfo(float).eps)
SPREAD = 3.0
"""Units are changed by up to so many powers of ten."""


@dataclass(frozen=True)
class Units:
    """How many of the units used go into a metre, a kilogram and a second."""

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0


SI = Units()


@dataclass(frozen=True)
class Problem:
    """A plate on a rotor in SI units, and the theory it is in."""

    plate: Plate
    rotor: Rotor
    effects: Any
    theory: str = "mindlin"

    def build(self, units: Units = SI) -> Operators:
        """Its matrices in other units."""
        plate, length, mass, time = self.plate, units.length, units.mass, units.time
        material = Material(
            plate.material.youngs_modulus * mass / (length * time**2),
            plate.material.poissons_ratio,
            plate.material.density * mass / length**3,
        )
        at = None if plate.tip_at is None else (plate.tip_at[0] * length, plate.tip_at[1] * length)
        mesh = type(plate.mesh)(plate.mesh.p * length, plate.mesh.t)
        scaled = Plate(mesh, plate.thickness * length, material, plate.tip_mass * mass, at)
        rotor = Rotor(self.rotor.hub_radius * length, self.rotor.stagger, self.rotor.precone)
        return assemble(scaled, rotor, self.effects, self.theory)


@contextmanager
def bits(_: Problem, operators: Operators, rng: np.random.Generator) -> Iterator[tuple[Operators, Units]]:
    """Every number of the matrices, and of the tables that they are made from, changed by its last bit or not."""

    def changed(values: np.ndarray) -> np.ndarray:
        return np.asarray(values * (1.0 + EPS * rng.integers(-1, 2, values.shape)))

    def alike(matrix: Any, sign: float = 1.0) -> Any:
        lower = tril(matrix).tocsc()
        lower.data = changed(lower.data)
        return (lower + sign * tril(lower, -1).T).tocsc()

    yield _matrices(operators, alike, changed, lambda fields: _tables(fields, changed)), SI


@contextmanager
def order(_: Problem, operators: Operators, rng: np.random.Generator) -> Iterator[tuple[Operators, Units]]:
    """The unknowns in another order."""
    old = rng.permutation(operators.mass.shape[0])  # unknown number k was old[k]
    new = np.append(np.argsort(old), -1)  # the last for what is clamped

    def numbered(fields: Fields) -> Fields:
        return replace(fields, blocks=tuple(Block(b.table, new[b.dofs]) for b in fields.blocks))

    moved = _matrices(
        operators, lambda matrix, _=1.0: matrix[old][:, old].tocsc(), lambda vector: vector[old], numbered
    )
    model = moved.model
    spaces = tuple(replace(space, dofs=new[space.dofs]) for space in model.spaces)
    held = np.sort(new[model.membrane])
    yield replace(moved, model=replace(model, spaces=spaces, membrane=held)), SI


@contextmanager
def units(problem: Problem, _: Operators, rng: np.random.Generator) -> Iterator[tuple[Operators, Units]]:
    """Other units of length, mass and time."""
    other = Units(*(10.0 ** rng.uniform(-SPREAD, SPREAD, 3)))
    yield problem.build(other), other


@contextmanager
def start(_: Problem, operators: Operators, rng: np.random.Generator) -> Iterator[tuple[Operators, Units]]:
    """Other vectors to start from."""
    with mock.patch("fem.linalg.SEED", int(rng.integers(1, 2**31))):
        yield operators, SI


KINDS: dict[str, Callable[..., Any]] = {"bits": bits, "order": order, "units": units, "start": start}


def _matrices(
    operators: Operators,
    matrix: Callable[..., Any],
    vector: Callable[[np.ndarray], np.ndarray],
    fields: Callable[[Fields], Fields],
) -> Operators:
    """The operators with every matrix, vector and field replaced."""

    def sorted_matrix(old: Any, sign: float = 1.0) -> Any:
        new = matrix(old, sign)
        new.sort_indices()  # matrices are read-only afterwards
        return new

    made: dict[str, Any] = {}
    for name in ("stiffness", "mass", "geometric", "softening"):
        old = getattr(operators, name)
        made[name] = None if old is None else sorted_matrix(old)
    if operators.gyroscopic is not None:
        made["gyroscopic"] = sorted_matrix(operators.gyroscopic, -1.0)
    made["load"] = vector(operators.load)
    made["prestress"] = None if operators.prestress is None else vector(operators.prestress)
    return replace(operators, **made, model=_fields(operators.model, fields))


def _fields(model: Discretisation, change: Callable[[Fields], Fields]) -> Discretisation:
    extra = tuple((change(fields), c) for fields, c in model.extra)
    energies = tuple(
        replace(energy, **{name: change(held) for name, held in vars(energy).items() if isinstance(held, Fields)})
        for energy in model.energies
    )
    return replace(
        model,
        displacement=change(model.displacement),
        gradient=change(model.gradient),
        extra=extra,
        energies=energies,
    )


def _tables(fields: Fields, changed: Callable[[np.ndarray], np.ndarray]) -> Fields:
    return replace(fields, blocks=tuple(Block(changed(b.table), b.dofs) for b in fields.blocks))
