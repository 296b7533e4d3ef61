"""Hits on a wall: how long they last, and what they scatter into modes of the structure that are not simulated."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from damper.contact import hit_time
from fem.reduction.pulse import spectrum
from workflows.errors import present
from workflows.scene.damper import Damper
from workflows.solve import coupling, limits
from workflows.solve.damper import verdict_damper
from workflows.solve.results import HitFigures, Results, SpeedPoint
from workflows.solve.structure import StructureState


class _Hit(NamedTuple):
    """Of one ball [kg], at a speed [m/s]: how long it lasts, and the flight between two [s]."""

    ball: float
    speed: float
    duration: float
    flight: float


def with_hits(results: Results, state: StructureState) -> Results:
    """The same results with what hits are at the speeds at which the damper does something.

    As far as the materials of ball and wall are known.
    """
    hits = {k: hit for k, point in enumerate(results.speeds) if (hit := _hit(results, point)) is not None}
    if not hits or state.solver is None:
        return results
    whole = state.solver.inverse_mass([hit.duration for hit in hits.values()])
    points = list(results.speeds)
    for number, (k, hit) in enumerate(hits.items()):
        found = _figures(state, points[k], hit, None if whole is None else float(whole[number]))
        points[k] = replace(points[k], hits=found)
    return replace(results, speeds=tuple(points))


def _hit(results: Results, point: SpeedPoint) -> _Hit | None:
    """A hit at the amplitude A of the largest damping; None where there is none, or its materials are not known.

    A ball crosses its clearance d in half a period, or, where it leaves a wall as this begins to slow down and rolls by
    (5/7) |1 - tau| A omega³ t³ / 6, in less; it hits at the mean speed of that.
    """
    damper, made_of, best = results.scene.damper, limits.solids(results.scene), limits.best(results, point)
    if damper is None or made_of is None or best is None or point.reduced is None:
        return None
    if best.amplitude < _reaches(damper, point):
        return None
    omega, ball = 2 * math.pi * point.reduced.f1_hz, (point.reduced.M1 - point.reduced.M2) / damper.count
    gap, jerk = damper.cavity[0] - 2 * damper.radius, 5 / 7 * abs(1 - point.tilt_share) * best.amplitude * omega**3
    flight = min(math.pi / omega, (6 * gap / jerk) ** (1 / 3))
    return _Hit(ball, gap / flight, hit_time(gap / flight, ball, damper.radius, *made_of), flight)


_DRIFTS = 0.2
"""Amplitude at which a ball that drifts reaches a wall, over that at which one that rolls about the middle does."""


def _reaches(damper: Damper, point: SpeedPoint) -> float:
    """Amplitude [m] below which growing vibration has a ball that rolls, or rests, without a hit."""
    figures, left = present(point.damping_curve), abs(1 - point.tilt_share)
    if figures.ways_differ:
        return 0.97 * figures.folds[1]
    return _DRIFTS * 7 / 5 * (damper.cavity[0] / 2 - damper.radius) / left if left > 0 else math.inf


def _figures(state: StructureState, point: SpeedPoint, hit: _Hit, whole: float | None) -> HitFigures:
    """What a hit is, and takes of a ball's kinetic energy.

    `whole`: twice the energy that a pulse as long leaves in all modes, over the square of its impulse [1/kg]; None: not
    known. The impulse is (1 + e) v / (1 / m + whole).
    """
    from damper.impacts import restitution_of

    scene, reduced = state.source.scene, present(point.reduced)
    system = verdict_damper(scene, state.effects, point)
    e = float(restitution_of(system.parameters, np.array([hit.speed]))[0])
    braked = present(scene.damper).friction * point.omega**2 * point.pressing
    sliding = 2 / 7 * (1 + e) * hit.speed / braked if braked > 0 else None
    figures = HitFigures(hit.duration, hit.flight, sliding, None, 1 - e**2)
    if whole is None:
        return figures
    modes = [(math.sqrt(each.stiffness), each.shape[0]) for each in coupling.damper_modes(scene, point)]
    simulated = modes if system.modes is not None else [(2 * math.pi * reduced.f2_hz, reduced.M2**-0.5)]
    rates, lifts = np.array(simulated).T
    left = whole - float(((spectrum(rates, hit.duration) * lifts) ** 2).sum())
    impulse = (1 + e) / (1 + hit.ball * whole)
    return replace(figures, scattered=hit.ball * max(left, 0.0) * impulse**2)
