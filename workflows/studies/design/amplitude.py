"""The goal of a scene with [excitation]: the least of the greatest amplitude at the crossings.

Under the greatest of the forces, over all crossings of the engine orders with modes that they drive: the mean amplitude
of the steady state, from whatever start and at whatever speed it is greatest. While a search looks around, the balance
of free vibration stands for a ball that the load holds well; all others are followed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from workflows.errors import BadInput
from workflows.progress import Stages
from workflows.results import crossings
from workflows.results.crossings import Crossing
from workflows.scene.excitation import Excitation
from workflows.scene.source import SceneFile
from workflows.studies.design import balance, crossed
from workflows.studies.design.crossed import Crossed, Linear
from workflows.studies.design.scored import Scored
from workflows.studies.response.peaks import HELPS
from workflows.studies.response.solved import Solved
from workflows.studies.sweep.placed import Placed
from workflows.wording import whole

_ASIDE = (-0.8, -0.4, 0.0, 0.4, 0.8)
"""Speeds about a resonance, in damping ratios of it."""

_CYCLES, _FEW_CYCLES = 10_000, 4000
"""Most cycles of a motion, and where a percent does not count."""

_ACROSS = 9
"""Speeds over the whole range at which a ball in a hollow floor is looked at besides."""

_NEVER = 50.0
"""What a design loses whose ball nothing drives."""


@dataclass(frozen=True)
class LeastAmplitude:
    """The least of the greatest amplitude at the crossings.

    Attributes:
        excitation: what shakes the structure.
        met: the crossings of its orders with modes that it drives.
        ends: the lowest and the highest speed of the scene [rad/s].
        reference: greatest amplitude without a ball [m].
    """

    excitation: Excitation
    met: tuple[Crossing, ...]
    ends: tuple[float, float]
    reference: float
    said: ClassVar[str] = "greatest amplitude at the crossings"

    @property
    def speeds(self) -> tuple[float, ...]:
        """Of the crossings [rad/s], each once."""
        return tuple(sorted({crossing.omega for crossing in self.met}))

    def worth(self, placed: list[Placed], *, quick: bool) -> Scored:
        """What a damper is worth that is placed on its structure at every crossing."""
        found = []
        for each in placed:
            for crossing in self.met:
                if crossing.omega == each.point.omega:
                    found += self._at(each, crossing, quick=quick)
        if not found:
            return Scored(0.0, -_NEVER, why="nothing drives the damper's place at the crossings")
        value, at, lines = max(found, key=lambda one: one[0])
        without = max(one[2].without for one in found)
        held = min(math.log(max(lines.grows, 1.0)), _NEVER)
        why = "" if value <= HELPS * without else _why(lines)
        return Scored(
            value,
            math.log(self.reference / value) - held,
            bound=max(one[2].least for one in found),
            speed=at.crossing.omega,
            amplitude=value,
            cutoff=lines.resting * lines.grows,
            why=why,
            order=at.crossing.order,
            without=without,
            grows=lines.grows,
        )

    def _at(self, placed: Placed, crossing: Crossing, *, quick: bool) -> list[tuple[float, Crossed, Linear]]:
        here = crossed.of(placed.scene, placed.carried.effects, placed.point, crossing, *self.ends)
        if here is None:
            return []
        lines = crossed.linear(here)
        if here.leads and balance.speaks(here.system):
            return [(balance.amplitude(here, lines.resting, quick=quick), here, lines)]
        return [(followed(here, lines, quick=quick), here, lines)]


def _why(lines: Linear) -> str:
    return "the load holds the ball at rest" if lines.grows >= 1 else "the ball does not help"


def followed(here: Crossed, lines: Linear, *, quick: bool) -> float:
    """The greatest mean amplitude of the steady states about a crossing [m]."""
    from damper import Start

    starts = (Start.UP, Start.DOWN) if quick else tuple(Start)
    states = here.follow(_speeds(here, quick=quick), starts, _FEW_CYCLES if quick else _CYCLES)
    means = np.where(np.isnan(states.mean), np.abs(states.linear)[:, None], states.mean)
    return float(means.max())


def _speeds(here: Crossed, *, quick: bool) -> list[float]:
    """Speeds at which the steady states are looked at: the resonances of all that the ball may do."""
    zeta = max(here.system.damping_ratio, 1e-4)
    aside = _ASIDE[::2] if quick else _ASIDE
    middles = here.swinging()
    hollow = here.system.floor_radius is not None
    if here.leads and not (quick and hollow):
        middles += [here.speed_of(turns) for _, turns in here.backbone.answers(here.force)]
    found = {here.speed_of(here.stuck), here.crossing.omega}
    found |= {middle * (1 + zeta * part) for middle in middles for part in aside}
    if hollow:
        found |= set(np.linspace(*here.speeds, _ACROSS // 2 if quick else _ACROSS).tolist())
    low, high = here.speeds
    return sorted({min(max(omega, low), high) for omega in found})


def of(source: SceneFile, stages: Stages) -> LeastAmplitude:
    """The goal of a scene as its forced response is computed.

    Raises:
        BadInput: what `response` needs is missing, the structure has no damping, or no order meets a mode it drives.
    """
    excitation, given = source.scene.excitation, source.scene.damper
    if excitation is None or given is None:
        raise ValueError("the scene has no [excitation]")
    if given.damping_ratio == 0:
        problem = "without damping of its own a structure has no amplitude at resonance: expected more, such as 0.001"
        raise BadInput(problem, file=source.name, key="[damper] damping_ratio", value=0)
    solved = Solved(source, stages)
    speeds = source.scene.rotor.speeds
    low, high = min(speeds), max(speeds)
    met = crossings.of_points(solved.across(), excitation.orders)
    if not met:
        raise crossings.unmet(solved.across(), excitation.orders, source.name)
    alone = []
    for crossing in met:
        (point,) = solved.at(np.array([crossing.omega]))
        here = crossed.of(source.scene, solved.decided.effects, point, crossing, low, high)
        alone += [] if here is None else [crossed.linear(here).without]
    if not alone:
        problem = (
            f"none of these orders drives a mode at the damper's place between {whole(low * 30 / math.pi)} and"
            f" {whole(high * 30 / math.pi)} rpm"
        )
        raise BadInput(problem, file=source.name, key="[excitation] orders", value=list(excitation.orders))
    return LeastAmplitude(excitation, tuple(met), (low, high), max(alone))
