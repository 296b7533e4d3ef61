"""What a plate takes, reckoned without solving it: from what others took, and from how fast this machine is.

Work grows as a power of the unknowns between that of the matrices (1) and that of the factor, which is 1.5 for a planar
mesh (George, SIAM J. Numer. Anal. 10 (1973) 345).
"""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING

from fem.theory.kind import Kind, kind
from workflows.effects.effect import Effect
from workflows.scene.source import SceneFile
from workflows.solve import needs
from workflows.solve import plate_stage as plate

if TYPE_CHECKING:
    from fem.meshes.ladder import Planform
    from workflows.solve.decided import Decided

_GROWTH = {"kirchhoff": 1.3, "mindlin": 1.3, "solid": 1.5}

_PRICE = {"kirchhoff": 1.7e-6, "mindlin": 1.7e-6, "solid": 8e-7, "solid/4": 1.9e-6, "solid/6": 2.5e-6}
"""Seconds that matrices and six modes at two speeds took for one unknown, to be grown by the power above."""

_DEFLECTED, _TURNING = 8.0, 6.0
"""By how much large deflection and Coriolis forces make modes dearer."""

_REFERENCE = 4, 0.1
"""Size of a mesh of the paper's plate, and the seconds that its modes took on the machine where prices were taken."""

_ROUGH, _TIGHT = 3e-3, 1e-4
"""Accuracies from which on the first meshes are fine enough: of bricks, and of all other cells."""

_USUAL, _USUALLY = 12_000, 1e-3
"""Unknowns of most meshes for six modes, and the accuracy up to which that is so; they grow with its root."""


def usual_unknowns(source: SceneFile, decided: Decided, model: str) -> float:
    """Unknowns of the mesh that a search may end with."""
    (form, _), scene = decided.plate, source.scene
    first = first_unknowns(source, form, model)
    if kind(model) is Kind.SOLID:
        return max(searched(source, decided, model))
    finer = 4.0 * first if source.mesh is not None and len(form.sizes) > 2 else first
    finer_still = max(_USUALLY / scene.accuracy.frequency, 1.0) ** 0.5
    return max(finer, _USUAL * max(scene.rotor.modes / 6, 1.0) * float(finer_still))


def first_unknowns(source: SceneFile, form: Planform, model: str) -> float:
    """Unknowns of the finer of the two meshes that a search begins with, or of the only one."""
    from fem.accuracy.choose_mesh import first_pair, has_pair

    coarsest = needs.unknowns(model, form.mesh(form.sizes[0]))
    if not has_pair(form, coarsest, model):
        return coarsest
    return needs.unknowns(model, form.mesh(first_pair(form, source.scene.rotor.modes)[1]))


def searched(source: SceneFile, decided: Decided, model: str) -> list[float]:
    """Unknowns of the meshes that a search should solve, the last of them that which it ends with."""
    form, _ = decided.plate
    return [needs.unknowns(model, form.mesh(size)) for size in sizes_searched(source, decided, model)]


def sizes_searched(source: SceneFile, decided: Decided, model: str) -> list[int]:
    """Their sizes in the ladder of the planform.

    Of bricks all that may be tried, for all but rough accuracies; of others one beyond the first two, for tight ones.
    """
    from fem.accuracy.choose_mesh import MOST_UNKNOWNS, STEP, first_pair, has_pair

    form, _ = decided.plate
    coarsest = needs.unknowns(model, form.mesh(form.sizes[0]))
    if not has_pair(form, coarsest, model):
        return [form.sizes[0]]
    sizes = list(first_pair(form, source.scene.rotor.modes))
    bricks = kind(model) is Kind.SOLID
    if source.scene.accuracy.frequency >= (_ROUGH if bricks else _TIGHT):
        return sizes
    fit = needs.most_unknowns(source, form, model, decided.effects["large_deflection"].on)
    most = min(MOST_UNKNOWNS[model.partition("/")[0]], fit)
    each = needs.unknowns(model, form.mesh(sizes[-1])) / sizes[-1] ** 2
    while finer := [size for size in form.sizes if sizes[-1] < size <= STEP * sizes[-1] and each * size**2 <= most]:
        sizes.append(finer[-1])
        if not bricks:
            break
    return sizes


def reckon(
    source: SceneFile, effects: dict[str, Effect], model: str, unknowns: float, slowness: float
) -> tuple[float, float]:
    """Bytes and seconds of a plate whose first meshes are large: the search is taken to end with the finer of them."""
    scene, large = source.scene, effects["large_deflection"].on
    name = model.partition("/")[0]
    once = slowness * _PRICE.get(model, _PRICE[name]) * unknowns ** _GROWTH[name] * max(scene.rotor.modes / 6, 1.0)
    each = once * (_DEFLECTED if large else 1.0)
    alone = large or scene.rotor.modes > plate.MODES_FOLLOWED
    turning = _TURNING if effects["coriolis"].on else 1.0
    speeds = len(scene.rotor.speeds) if alone else 1
    return needs.of_a_plate(model, unknowns, scene.rotor.modes, large), each * (1.0 + speeds * turning)


def pace() -> float:
    """How slow this machine is against the one that prices were taken on."""
    from fem import Effects, Material, Plate, Rectangle, Rotor, assemble
    from fem.accuracy.probing import probe

    size, usual = _REFERENCE
    for _ in range(2):  # the first loads
        began = perf_counter()
        mesh = Rectangle(0.2, 0.08).mesh(size)
        operators = assemble(Plate(mesh, 0.003, Material(114e9, 0.33, 4430.0)), Rotor(0.1, 0.5), Effects())
        probe(operators, (10.0, 600.0), 6, 1e-6)
        spent = perf_counter() - began
    return spent / usual
