"""What a plate takes, told by smaller ones like it: its sides, modes and effects, in few cells of the same kind.

Where the first meshes of a search are too large to be tried beforehand. Time grows with the unknowns as the matrices do
(1) and as the factor of a planar mesh does (1.5; George, SIAM J. Numer. Anal. 10 (1973) 345): two sizes tell how much
there is of each.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene.source import SceneFile
from workflows.solve import at_the_cavity, needs, plate_records, reckoned
from workflows.solve import plate_stage as plate
from workflows.stages import Stages

if TYPE_CHECKING:
    from fem import Given
    from fem.meshes.ladder import Planform
    from workflows.solve.decided import Decided
    from workflows.solve.records import Floats, SpeedPoint

_UNKNOWNS = 2000, 8000
"""Of the plates that are solved for this; the larger takes a second or two, and is left out where it would not."""

_LONGEST = 1.5
"""Seconds that the smaller takes at most where the larger is solved as well."""

_POWERS = 1.0, 1.5
_ALONE = 1.2
"""Power that is taken where one plate alone was solved."""

_SHEARED = 0.1
"""Slope of cells that stand for such as are no rectangles."""


@dataclass(frozen=True)
class Spent:
    """Seconds on so many unknowns: on matrices and modes as a search for a mesh takes them, and on all speeds."""

    unknowns: float
    search: float
    sweep: float
    points: tuple[SpeedPoint, ...]


@dataclass(frozen=True)
class Known:
    """What a plate takes: bytes, seconds at all speeds, and at the few of a small scene; what it is like at those."""

    memory: float
    seconds: float
    once: float
    points: tuple[SpeedPoint, ...]


def known(source: SceneFile, small: SceneFile, decided: Decided, model: str) -> Known:
    """What the plate of a scene takes with the meshes that a search begins with; `small`: the scene at few speeds.

    Raises:
        BadInput, NoAnswer: small plates have no modes, which says nothing of the large one.
    """
    large, modes = decided.effects["large_deflection"].on, source.scene.rotor.modes
    meshes = reckoned.searched(source, decided, model)
    spent = [_spent(small, decided, model, _UNKNOWNS[0])]
    if spent[0].search + spent[0].sweep <= _LONGEST:
        spent.append(_spent(small, decided, model, _UNKNOWNS[1]))
    alone = large or modes > plate.MODES_FOLLOWED
    each = len(source.scene.rotor.speeds) / len(small.scene.rotor.speeds) if alone else 1.0
    sizes = [one.unknowns for one in spent]
    search = sum(grown(sizes, [one.search for one in spent], unknowns) for unknowns in meshes)
    sweep = grown(sizes, [one.sweep for one in spent], meshes[-1])
    memory = needs.of_a_plate(model, max(meshes), modes, large)
    return Known(memory, search + each * sweep, search + sweep, spent[-1].points)


def grown(sizes: list[float], seconds: list[float], unknowns: float) -> float:
    """Seconds on so many unknowns, by a sum of powers with no negative part that goes through what is known."""
    from scipy.optimize import nnls

    if len(sizes) == 1:
        return float(seconds[0] * (unknowns / sizes[0]) ** _ALONE)
    shares, _ = nnls(_powers(np.array(sizes)) / np.array(seconds)[:, None], np.ones(len(sizes)))
    return float(_powers(np.array([unknowns]))[0] @ shares)


def _powers(sizes: Floats) -> Floats:
    return np.asarray(sizes[:, None] ** np.array(_POWERS))


def _spent(small: SceneFile, decided: Decided, model: str, unknowns: float) -> Spent:
    form, theory = decided.plate
    like = replace(decided, form=alike(form, model, unknowns), theory=theory)
    began = perf_counter()
    discrete = plate.discretise(small, like, Stages(visible=False))
    searched = perf_counter()
    operators = discrete.choice.operators
    diagram = plate.sweep(small, discrete)
    reduced, at_cavity = at_the_cavity.felt(small, decided.effects, operators, diagram)
    swept = perf_counter()
    points = plate_records.at_speeds(small, discrete, diagram, reduced, at_cavity)
    return Spent(operators.mass.shape[0], searched - began, swept - searched, points)


def alike(form: Planform, model: str, unknowns: float) -> Given:
    """One mesh of about so many unknowns in cells like those of a planform, over all that encloses it."""
    from fem import Given, rectangle
    from fem.theory.kirchhoff import is_rectangles

    class Alone(Given):
        """A planform without other meshes."""

        @property
        def sizes(self) -> tuple[int, ...]:
            return (1,)

    own, (length, width) = form.mesh(form.sizes[0]), form.sides
    cells = unknowns * own.t.shape[1] / needs.unknowns(model, own)
    if own.t.shape[0] == 3:
        cells *= 0.5  # of quadrilaterals, each of which becomes two triangles
    along = max(1, round((cells * length / width) ** 0.5))
    mesh = rectangle(length, width, along, max(1, round(cells / along)))
    points = mesh.p + own.p.min(axis=1, keepdims=True) - mesh.p.min(axis=1, keepdims=True)
    if own.t.shape[0] == 3:
        return Alone(type(mesh)(points, mesh.t).to_meshtri(), thickness=getattr(form, "thickness", None))
    if not is_rectangles(own):
        points[1] += _SHEARED * (points[0] - points[0].min())
    return Alone(type(mesh)(points, mesh.t), thickness=getattr(form, "thickness", None))
