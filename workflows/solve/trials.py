"""The search for a plate's mesh and its sweep over speeds, tried on coarse meshes as far as a few seconds go."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from workflows.scene.source import SceneFile
from workflows.solve import at_the_cavity, likeness, plate_records
from workflows.solve import plate_stage as plate
from workflows.solve.answering import answering
from workflows.solve.decided import Decided
from workflows.solve.fill import NOTHING, fill
from workflows.solve.price import Part, timed
from workflows.solve.records import SpeedPoint
from workflows.stages import Stages

if TYPE_CHECKING:
    from workflows.solve.plate_records import Discrete

FIRST, LARGEST, PATIENCE = 6000.0, 80_000.0, 3.0
"""Unknowns of the meshes tried at once and at most: one after the other, as long as the next should take no more
seconds than that."""

_GROWTH = 1.3
"""Power of the unknowns that the work grows with, where it is only to be known whether a mesh takes long."""

PROBED = 5
"""Speeds at which the damper is tried."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A search that ends with a coarse mesh, and what is done on that; the search alone where that would take long."""

    discrete: Discrete
    search: Part
    sweep: Part | None = None
    reduction: Part | None = None
    points: tuple[SpeedPoint, ...] | None = None

    @property
    def unknowns(self) -> float:
        """Of its mesh."""
        return float(self.discrete.choice.operators.mass.shape[0])

    @property
    def next(self) -> float:
        """Unknowns of the mesh that the search would go on with; infinite where it has ended."""
        following = self.discrete.choice.following
        return np.inf if following is None else self.unknowns * (following / self.discrete.choice.size) ** 2

    def foreseen(self, unknowns: float) -> float:
        """Seconds that a trial with more unknowns would take, roughly."""
        parts = [part for part in (self.search, self.sweep, self.reduction) if part is not None]
        always = sum(part.projecting for part in parts)
        return always + (sum(part.seconds for part in parts) - always) * float((unknowns / self.unknowns) ** _GROWTH)


def alike(small: SceneFile, decided: Decided, model: str) -> list[Trial]:
    """Small plates like that of the scene; the second, which tells how it grows, may take twice the patience."""
    trials: list[Trial] = []
    for unknowns in likeness.UNKNOWNS:
        if not trials or _foreseen(trials, unknowns) <= 2.0 * PATIENCE:
            trials.append(tried(small, likeness.like(decided, model, unknowns), model, 0.0))
    return trials


def followed(small: SceneFile, decided: Decided, trials: list[Trial]) -> list[Trial]:
    """The search of the scene one mesh further each time, and its sweep as far as patience goes.

    The search, whose end is what is most in doubt, may take twice that. trials: of plates like it, which are kept.
    """
    model, own, most = plate.model(small, decided), list[Trial](), FIRST
    while True:
        swept = not trials + own or _foreseen(trials + own, most) <= PATIENCE
        own.append(tried(small, decided, model, most, swept))
        last, most = own[-1], own[-1].next
        if most > LARGEST or last.search.seconds * (most / last.unknowns) ** _GROWTH > 2.0 * PATIENCE:
            return trials + own


def _foreseen(trials: list[Trial], unknowns: float) -> float:
    """Seconds of a trial with more unknowns, roughly, by the last that was swept."""
    last = next(trial for trial in reversed(trials) if trial.sweep is not None)
    return last.foreseen(unknowns)


def tried(small: SceneFile, decided: Decided, model: str, until: float, swept: bool = True) -> Trial:
    """Solve the plate on the meshes before those of so many unknowns."""
    (form, _), quiet = decided.plate, Stages(visible=False)
    with answering(small):
        discrete, searched = timed(lambda: plate.discretise(small, decided, quiet, until=until))
        choice = discrete.choice
        sizes = [size for size, _ in choice.tried] or [choice.size]
        on = [fill(model, form.mesh(size)) for size in sizes]
        trial = Trial(discrete, searched(sum(on, NOTHING)))
        if not swept:
            return trial
        diagram, sweeping = timed(lambda: plate.sweep(small, discrete))
        found, reducing = timed(lambda: at_the_cavity.felt(small, decided.effects, choice.operators, diagram))
        last = fill(model, form.mesh(choice.size))
        points = plate_records.at_speeds(some(small, PROBED), discrete, diagram, *found)
    return replace(trial, sweep=sweeping(last), reduction=reducing(last), points=points)


def some(source: SceneFile, most: int) -> SceneFile:
    """The scene at no more than so many of its speeds, the lowest and the highest among them."""
    speeds = sorted(source.scene.rotor.speeds)
    if len(speeds) <= most:
        return source
    few = tuple(speeds[round(k * (len(speeds) - 1) / (most - 1))] for k in range(most))
    rotor = source.scene.rotor.model_copy(update={"speeds": few})
    return replace(source, scene=source.scene.model_copy(update={"rotor": rotor}))
