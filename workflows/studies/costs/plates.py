"""Ladders of the plate: every theory on every mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from workflows.progress import Step
from workflows.solve.records import Floats
from workflows.studies.costs.ladder import Ladder, Rung, measure
from workflows.wording import fixed, significant, whole

if TYPE_CHECKING:
    import fem
    from fem.meshes.mesh_sequence import Planform

SOLID_AT_MOST = 40_000
"""Unknowns of a solid that are still tried."""

FINEST = {"kirchhoff": 12, "mindlin": 16, "solid": 6}
"""The finest size from which the limit of each theory is extrapolated."""

WITH_THEORY = "plate, with the error of the theory"
"""The stage in which all theories are held against the solid."""


@dataclass(frozen=True)
class Method:
    """A way to solve a plate: theory or theory/element, cells, what tables call it, the finest size it is tried on."""

    model: str
    name: str
    finest: int
    cells: Literal["graded", "even", "triangles"] = "graded"

    @property
    def theory(self) -> str:
        """Without the element or the number of layers."""
        return self.model.partition("/")[0]


METHODS = (
    Method("kirchhoff/bfs", "thin plate, BFS rectangles", 12),
    Method("kirchhoff/argyris", "thin plate, Argyris triangles", 8, "triangles"),
    Method("kirchhoff/morley", "thin plate, Morley triangles", 10, "triangles"),
    Method("mindlin", "Mindlin, Q2 rectangles", 12),
    Method("mindlin", "Mindlin, P2 triangles", 8, "triangles"),
    Method("mindlin", "Mindlin, Q2 on even cells", 12, "even"),
    Method("solid/2", "solid, 2 layers of bricks", 5),
    Method("solid/4", "solid, 4 layers of bricks", 4),
)
"""What is tried on the planform's ladder of meshes."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A plate to be solved for some modes at one speed [rad/s], without Coriolis forces and large deflection."""

    form: Planform
    plate: Callable[[Any], fem.Plate]
    rotor: fem.Rotor
    effects: fem.Effects
    omega: float
    count: int

    def operators(self, method: Method, size: int) -> fem.Operators:
        """Matrices of a method on a mesh of the planform's ladder."""
        from fem import assemble

        mesh = self._even(size) if method.cells == "even" else self.form.mesh(size)
        if method.cells == "triangles" and mesh.t.shape[0] == 4:
            mesh = mesh.to_meshtri()
        return assemble(self.plate(mesh), self.rotor, self.effects, method.model)

    def solve(self, method: Method, size: int) -> tuple[int, Floats]:
        """Unknowns, and frequencies (count,) in Hz."""
        from fem import solve_modes

        operators = self.operators(method, size)
        return operators.mass.shape[0], solve_modes(operators, self.omega, self.count).frequencies_hz

    def _even(self, size: int) -> Any:
        from fem import Rectangle, rectangle

        if not isinstance(self.form, Rectangle):
            raise ValueError("the mesh is a file's")
        return rectangle(*self.form.sides, *self.form.cells(size))


def sizes(problem: Problem, finest: int) -> list[int]:
    """The meshes on which a method is tried: of a file's mesh, itself and one finer."""
    from fem import Rectangle

    every = problem.form.sizes if isinstance(problem.form, Rectangle) else problem.form.sizes[:2]
    return [size for size in every if size <= finest]


def limits(problem: Problem, step: Step) -> dict[str, tuple[Floats, float]]:
    """The limit of each theory, extrapolated from the two finest meshes, and how far it can be trusted, relatively."""
    found = {}
    for method in (_thin(problem), Method("mindlin", "Mindlin", FINEST["mindlin"]), _bricks(4)):
        theory, pair = method.theory, _finest(problem, method)
        step.advance(f"limit of {theory}")
        if len(pair) < 2:
            continue
        (_, before), (_, last) = (problem.solve(method, size) for size in pair)
        growth = (pair[1] / pair[0]) ** min(problem.form.orders)
        limit = last + (last - before) / (growth - 1.0)
        if theory == "solid":
            limit = limit * _more_layers(problem, pair[0])
        found[theory] = limit, float(np.abs(limit / last - 1.0).max())
    return found


def ladders(problem: Problem, step: Step) -> tuple[list[Ladder], dict[str, tuple[Floats, float]]]:
    """Error against the limit of the row's own theory, and against the solid: that of the theory comes on top."""
    known = limits(problem, step)
    own, solid = [], []
    for method in METHODS:
        limit, trust = known.get(method.theory, (None, None))
        for size in sizes(problem, method.finest):
            step.advance(f"{method.name}, {size}")
            row, frequencies = _row(problem, method, size, limit)
            own.append(replace(row, uncertainty=trust))
            if "solid" in known and frequencies is not None:
                error = float(np.abs(frequencies / known["solid"][0] - 1.0).max())
                solid.append(replace(row, error=error, uncertainty=known["solid"][1]))
            else:
                solid.append(row)
    where = f"{problem.count} frequencies at {whole(problem.omega * 30 / np.pi)} rpm"
    trusts = ", ".join(f"{theory} to {significant(error, 1)}" for theory, (_, error) in known.items())
    ours = Ladder(
        "plate",
        f"largest relative error of the mesh in {where}",
        f"limit of each row's own theory, extrapolated from the two finest meshes ({trusts})",
        tuple(own),
    )
    if "solid" not in known:
        return [ours], known
    theirs = Ladder(
        WITH_THEORY,
        f"largest relative error in {where}, mesh and theory together",
        f"limit of solid bricks, good to about {significant(known['solid'][1], 1)}",
        tuple(solid),
    )
    return [ours, theirs], known


def _row(problem: Problem, method: Method, size: int, limit: Floats | None) -> tuple[Rung, Floats | None]:
    found: list[Floats] = []

    def judge(solved: tuple[int, Floats]) -> tuple[int | None, float]:
        found.append(solved[1])
        if limit is None:
            raise ValueError("there is no reference: the mesh is too large for a finer one")
        return solved[0], float(np.abs(solved[1] / limit - 1.0).max())

    if method.theory == "solid" and _unknowns(problem, method, size) > SOLID_AT_MOST:
        reason = f"too slow: {fixed(_unknowns(problem, method, size))} unknowns"
        return Rung(method.name, _setting(problem, size), failed=reason), None
    if method.theory == "mindlin" and method.cells == "graded" and problem.form.mesh(1).t.shape[0] == 3:
        return Rung(method.name, _setting(problem, size), failed="the mesh is of triangles"), None
    row = measure(method.name, _setting(problem, size), lambda: problem.solve(method, size), judge)
    return row, found[0] if found else None


def _setting(problem: Problem, size: int) -> str:
    from fem import Rectangle

    if isinstance(problem.form, Rectangle):
        return "{} × {}".format(*problem.form.cells(size))
    return "the file's mesh" if size == 1 else f"each edge split in {size}"


def _thin(problem: Problem) -> Method:
    from fem import Rectangle

    return Method(
        "kirchhoff/bfs" if isinstance(problem.form, Rectangle) else "kirchhoff", "thin plate", FINEST["kirchhoff"]
    )


def _bricks(layers: int) -> Method:
    return Method(f"solid/{layers}", "solid", FINEST["solid"])


def _finest(problem: Problem, method: Method) -> list[int]:
    """The two sizes from which a limit is extrapolated."""
    from fem import Rectangle

    most = method.finest
    if not isinstance(problem.form, Rectangle):
        most = 4 if method.theory == "mindlin" else 2
    tried = [size for size in problem.form.sizes if size <= most]
    if method.theory == "solid":
        tried = [size for size in tried if _unknowns(problem, method, size) <= SOLID_AT_MOST]
    return tried[-3::2] if len(tried) > 2 and isinstance(problem.form, Rectangle) else tried[-2:]


def _more_layers(problem: Problem, size: int) -> Floats:
    """Factor from four layers of bricks to six, on a coarse mesh: the mesh's error falls out."""
    coarse = next(s for s in reversed(problem.form.sizes) if s <= max(1, size // 2))
    (_, four), (_, six) = (problem.solve(_bricks(layers), coarse) for layers in (4, 6))
    return np.asarray(six / four)


def _unknowns(problem: Problem, method: Method, size: int) -> int:
    """About how many unknowns a solid has."""
    mesh = problem.form.mesh(1)
    cells = mesh.t.shape[1] * size**2 * (3 if mesh.t.shape[0] == 3 else 1)
    return int(cells * 4 * (2 * int(method.model.partition("/")[2]) + 1) * 3)
