"""Many points at once: scenes, structures, dampers, and the headline numbers of each, a row for every point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from workflows.errors import BadInput, SpindampError, during, one_line
from workflows.scene.scene import Scene
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage, felt
from workflows.solve.quantity import taken_over
from workflows.solve.records import OwnFigures
from workflows.studies.sweep import quantities, scenes
from workflows.studies.sweep.keys import SPEEDS
from workflows.studies.sweep.placed import QUICK, Carried, Placed, measured
from workflows.studies.sweep.plans import Plan
from workflows.studies.sweep.plates import Plates
from workflows.studies.sweep.quantities import Block, Reasons

if TYPE_CHECKING:
    from damper import ParticleDamper, Working
    from workflows.studies.sweep.quantities import Rows


def block(source: SceneFile, plan: Plan, begin: int, end: int, plates: Plates, *, quick: bool = False) -> Block:
    """The headline numbers of the points from `begin` to before `end`."""
    rows, reasons = quantities.empty(end - begin), Reasons()
    placed = list(all_placed(source, plan, begin, plates, rows, reasons))
    known: dict[ParticleDamper, Working] = {}
    for each in placed:
        with during(f"at point {begin + each.number}, {each.point.rpm:.6g} rpm"):
            _measure(rows[each.number], each, known, QUICK if quick else {})
    with during(f"at points {begin} to {end - 1}"):
        _ring_down(rows, placed)
    return Block(begin, rows, tuple(reasons.texts))


def all_placed(
    source: SceneFile, plan: Plan, begin: int, plates: Plates, rows: Rows, reasons: Reasons
) -> Iterator[Placed]:
    """The dampers of all points from `begin` on, a row for each, that have one; the others get a reason."""
    end = begin + len(rows)
    columns = plan.columns(begin, end)
    varied = [axis.key for axis in plan.axes]
    data = scenes.base(source, varied)
    others = [key for key in varied if key.name != SPEEDS]
    every = plan.speeds(begin, end)

    def values(number: int) -> tuple[Any, ...]:
        return tuple(columns[key.name][number] for key in others)

    for given, numbers in groupby(range(len(rows)), key=values):
        mine = list(numbers)
        try:
            changed = scenes.with_values(data, dict(zip(others, given, strict=True)))
            found = scenes.of_a_point(source, changed, every)
            carried = plates.carry(found)
        except SpindampError as error:
            rows["reason"][mine] = reasons.number(said(error, source))
            continue
        for number in mine:
            omega = float(columns[SPEEDS][number])
            try:
                yield place(number, found.scene, carried, omega, rows[number])
            except SpindampError as error:
                rows["reason"][number] = reasons.number(said(error, source))


def place(number: int, scene: Scene, carried: Carried, omega: float, row: Any) -> Placed:
    """The damper of a scene at a speed, the structure's numbers filled into its row.

    Raises:
        BadInput: the structure has no answer at this speed, or the damper makes no sense on it.
    """
    point = carried.points.get(omega)
    if point is None or point.reduced is None:
        raise BadInput("the plate diverges at this speed", key="[rotor] speeds")
    damper = damper_stage.particle_damper(scene, carried.effects, point)
    quantities.of_the_structure(row, point, damper.ball_mass)
    return Placed(number, scene, carried, point, damper, felt.released_at(scene, point))


def said(error: SpindampError, source: SceneFile) -> str:
    """Why a point has no answer."""
    return one_line(str(error).removeprefix(f"{source.name}: "))


def _measure(row: Any, each: Placed, known: dict[ParticleDamper, Working], how: dict[str, int]) -> None:
    figures = taken_over(OwnFigures, measured(each.judged, known, **how))
    point = replace(each.point, working=figures)
    quantities.of_the_damper(row, replace(each.results, speeds=(point,)), point)


def _ring_down(rows: Rows, placed: list[Placed]) -> None:
    """Ring all dampers down from their scenes' releases, in batches of those that can go together."""
    groups: dict[Any, list[Placed]] = {}
    for each in placed:
        groups.setdefault(_together(each), []).append(each)
    for group in groups.values():
        batch = _batch(group)
        mine = [each.number for each in group]
        filled = rows[mine]
        quantities.of_the_ring_downs(filled, batch, np.array([each.scene.rotor.gravity for each in group]))
        rows[mine] = filled


def _together(each: Placed) -> Any:
    """What the dampers of a batch have in common."""
    damper, release = each.damper, each.scene.release
    cycles = "auto" if release is None else release.cycles
    most = damper_stage.most_cycles(damper)
    return damper.formulation, damper.modes, damper.floor_friction is None, damper.floor_radius is None, most, cycles


def _batch(group: list[Placed]) -> Any:
    from damper import ringdowns
    from damper.model import PARAMETERS

    first = group[0]
    cycles = first.scene.release.cycles if first.scene.release is not None else "auto"
    released = [each.release for each in group]
    rows = np.concatenate([each.damper.parameters for each in group])
    names = [name for name in PARAMETERS.names or () if name != "printed"]
    if first.damper.floor_friction is None:
        names.remove("floor_friction")
    how: dict[str, Any] = {name: rows[name] for name in names}
    if first.damper.modes is not None:
        how["amplitudes"] = np.array([felt.amplitudes(each.damper, each.release) for each in group])
    how["max_cycles"] = damper_stage.most_cycles(first.damper)
    return ringdowns(first.damper, released, None if isinstance(cycles, str) else cycles, threads=1, **how)
