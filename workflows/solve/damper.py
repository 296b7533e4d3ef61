"""The damper at the speeds of a run: ring-downs, the ball's path, the damper's own figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain, starmap
from typing import Any

import numpy as np

import damper
from damper import damping_curve
from damper.curve_measurement import falling
from damper.laws import EXACT, require
from workflows.effects.definition import Effect
from workflows.effects.selection import EFFECTS
from workflows.errors import BadInput, during, present
from workflows.formatting import turning
from workflows.progress import Stages
from workflows.scene.scene import Scene
from workflows.solve import coupling, limits, results
from workflows.solve.results import CavityMode, Floats, OwnFigures, SpeedPoint, copy_fields

CYCLES = 8
"""Vibration cycles from the ball's first motion on."""

_A_CYCLE = 60
"""Times a cycle: a straight line between two departs from a swing by 0.14 % of its amplitude at most."""

EVENTS_AT_MOST = 1000
"""Events after which the stretch ends, where a ball chatters."""

KINDS = ("release", "start", "reversal", "hit", "rub", "grip")
"""Names of the kinds of event by their numbers in `damper.state`."""


def ball_path(motion: damper.RingDown) -> results.BallPath | None:
    """The ball's way in the first cycles in which it moves, from a ring-down with its events; None if it never does."""
    rows = motion.rows
    if rows is None or motion.last_motion is None:
        return None
    period = 2 * math.pi / motion.damper.stuck_frequency
    moving = np.flatnonzero(rows["regime"] != 0)
    begin = max(0.0, float(rows["time"][moving[0]]) - period / 4) if moving.size else 0.0
    end = min(motion.duration, begin + CYCLES * period)
    inside = np.flatnonzero((rows["time"] >= begin) & (rows["time"] <= end))
    if len(inside) > EVENTS_AT_MOST:
        inside = inside[:EVENTS_AT_MOST]
        end = float(rows["time"][inside[-1]])
    count = max(2, math.ceil((end - begin) / period * _A_CYCLE) + 1)
    events: Floats = rows["time"][inside]
    times = np.union1d(np.linspace(begin, end, count), events)
    samples = damper.sample(motion, times)
    at, kinds = np.searchsorted(times, events), tuple(KINDS[kind] for kind in rows["kind"][inside].tolist())
    axes = rows["axis"][inside].astype(np.int64)
    return results.BallPath(times, samples.relative_position, samples.displacement, samples.regime, at, kinds, axes)


_RESOLVING = 1e-3
"""Damping ratio at which a cycle resolves a cut-off to 0.6 %."""

_MOST_CYCLES, _MOST_LINEAR_CYCLES = 100_000, 10_000
"""Caps on cycles where a ball does not come to rest: on level floors, and on others, which are dearer."""

_SAMPLES_PER_CYCLE = 40
_SAMPLES_AT_MOST = 4000
_KEPT_AT_MOST = 200_000
"""Events of a ring-down that are kept: of a ball that goes on for ever all of them fill the memory."""


def simulate(
    scene: Scene, effects: dict[str, Effect], points: tuple[SpeedPoint, ...], stages: Stages, shown: int
) -> tuple[SpeedPoint, ...]:
    """Ring down and measure the damper at every speed; the point number `shown` keeps its time history."""
    with stages("damper", len(points)) as step:
        done = []
        for number, point in enumerate(points):
            speed = turning(point.omega)
            with during(f"at {speed}"):
                done.append(_simulated(scene, effects, point, keep=number == shown))
            step.advance(speed)
    return tuple(done)


def _simulated(scene: Scene, effects: dict[str, Effect], point: SpeedPoint, *, keep: bool) -> SpeedPoint:
    """The ring-down of the scene, and the figures of the damper on a floor that tilts whether the scene's does or not.

    A verdict speaks of the blade. The printed equations know no tilt, and there is none without a load.
    """
    system = particle_damper(scene, effects, point)
    damping = _one(scene, system, point, keep=keep)
    tilting = _tilting(scene, effects, point)
    judged = system if tilting is None or scene.is_printed else tilting
    more: dict[str, Any] = {"pendulum": coupling.pendulum(system, point.omega)}
    if tilting is not None:
        level = None if judged is system else copy_fields(results.Figures, falling(system))
        g, ratio = _cutoff(tilting, point)
        more |= {"level": level, "tilted_cutoff_g": g, "tilted_cutoff_ratio": ratio}
    curve, first = damping_curve(judged, least=limits.least_amplitude(point)), coupling.moves_first_from(judged, point)
    return replace(point, damper=damping, damping_curve=OwnFigures.of(curve, point.tilt_share, first, **more))


def verdict_damper(scene: Scene, effects: dict[str, Effect], point: SpeedPoint) -> damper.ParticleDamper:
    """The damper that the figures of a verdict are those of: on a floor that tilts."""
    tilting = None if scene.is_printed else _tilting(scene, effects, point)
    return tilting or particle_damper(scene, effects, point)


QUICK = {"sweeps": 4, "stay": 60}
"""Sweeps of a damping curve in about half of the time."""


def most_cycles(system: damper.ParticleDamper) -> int:
    """Cap on the cycles of a ring-down whose ball does not come to rest."""
    return _MOST_CYCLES if system.level and system.modes is None else _MOST_LINEAR_CYCLES


def _tilting(scene: Scene, effects: dict[str, Effect], point: SpeedPoint) -> damper.ParticleDamper | None:
    """The damper on a tilting floor, with equations that know it; None where the scene's own is that."""
    if effects["floor_tilt"].on or point.tilt_share == 0.0 or scene.damper is None:
        return None
    consistent = scene.changed(damper={"formulation": "consistent"})
    return particle_damper(consistent, effects | {"floor_tilt": Effect(True, "")}, point)


def _cutoff(system: damper.ParticleDamper, point: SpeedPoint) -> tuple[float, float]:
    """Cut-off over g and over the load of a ring-down so slow that it is resolved; nan where nothing drives the ball.

    It begins at twice the amplitude at which the ball begins to move.
    """
    begin = system.amplitude_of(system.leaving_threshold)
    if not begin < coupling.OUT_OF_REACH:
        return math.nan, math.nan
    moving = replace(system, damping_ratio=_RESOLVING, break_away=0.0)
    motion = damper.ringdown(moving, (2 * begin, 0.0), progress=_look_up)
    cutoff, load = damper.capacity(motion).cutoff, point.omega**2 * point.radius
    return (math.nan, math.nan) if cutoff is None else (cutoff * point.load_g / load, cutoff / load)


def particle_damper(
    scene: Scene, effects: dict[str, Effect], point: SpeedPoint, only: Sequence[CavityMode] | None = None
) -> damper.ParticleDamper:
    """The damper of a scene on the structure of a speed point; `only`: see `coupling.structure`.

    Raises:
        BadInput: a value without physical sense.
        LawViolation: with the ball at rest the structure has another frequency than the point.
    """
    spec, reduced = present(scene.damper), present(point.reduced)
    terms = (kind.arguments(spec, point.omega, effects[name].on).items() for name, kind in EFFECTS.items())
    try:
        system = copy_fields(
            damper.ParticleDamper,
            spec,
            **coupling.structure(scene, effects, point, only),
            ball_mass=coupling.ball_mass(scene, reduced.M2),
            ball_radius=spec.radius,
            centrifugal_acceleration=point.omega**2 * point.pressing,
            lateral_acceleration=(point.omega**2 * point.lean[0], point.omega**2 * point.lean[1]),
            formulation=damper.Formulation(spec.formulation),
            **dict(chain.from_iterable(terms)) | _of_contact(scene, effects, point),
        )
    except ValueError as error:
        name = str(error).partition(" ")[0]
        of_structure = scene.given is not None and name in type(scene.given).model_fields
        raise BadInput(str(error), key=f"[structure] {name}" if of_structure else "[damper]") from error
    if system.modes is None:
        error_hz = abs(system.stuck_frequency / (2 * math.pi) - reduced.f1_hz)
        require("f1 is that of K1 and M1", "error of f1 [Hz]", error_hz, EXACT * reduced.f1_hz)
    return system


def _of_contact(scene: Scene, effects: dict[str, Effect], point: SpeedPoint) -> dict[str, Any]:
    """What follows from ball and floor for a damper: its law of impact, and rolling by hysteresis.

    Raises:
        BadInput: their materials are not known.
    """
    spec, reduced, made_of = present(scene.damper), present(point.reduced), limits.solids(scene)
    hits = spec.hits((reduced.M1 - reduced.M2) / spec.count, made_of)
    if spec.rolling_friction == "auto":
        if made_of is None:
            problem = "requires named materials of ball and floor: expected ball_material and floor_material"
            raise BadInput(problem, key="[damper] rolling_friction", value="auto")
        hits["rolling_friction"] = limits.lever(scene, point) if effects["rolling_resistance"].on else 0.0
    return hits | ({"break_away": limits.rim_slope(scene, point)} if effects["indentation"].on else {})


def _one(scene: Scene, system: damper.ParticleDamper, point: SpeedPoint, *, keep: bool) -> results.Damping:
    release = coupling.release_displacement(scene, point, system)
    how: dict[str, Any] = {"amplitudes": coupling.amplitudes(system, release), "max_cycles": most_cycles(system)}
    ring_down = partial(damper.ringdown, system, release, scene.stop_cycles, **how, progress=_look_up)
    kept = ring_down(keep_events=True, max_events=_KEPT_AT_MOST) if keep else None
    motion = ring_down() if kept is None or kept.outcome is damper.Outcome.EVENT_CAP else kept
    energy, gravity = damper.capacity(motion), scene.rotor.gravity
    best = int(np.nanargmax(energy.sdc)) if np.isfinite(energy.sdc).any() else None
    cutoff = None if energy.cutoff is None else energy.cutoff / gravity
    left = () if motion.modal_energies is None else motion.modal_energies.tolist()
    numbers = (mode.number for mode in coupling.damper_modes(scene, point)) if left else ()
    return copy_fields(
        results.Damping,
        motion,
        outcome=str(motion.outcome),
        stopped=motion.last_motion if motion.rested else None,
        ball_mass=system.ball_mass,
        release=release,
        intrinsic_sdc=energy.intrinsic_sdc,
        peak_sdc=None if best is None else float(energy.sdc[best]),
        peak_sdc_at_g=None if best is None else float(energy.amplitude[best]) / gravity,
        cutoff_g=cutoff,
        cutoff_ratio=cutoff / point.load_g if cutoff is not None and point.load_g > 0 else None,
        amplitude_g=energy.amplitude / gravity,
        sdc=energy.sdc,
        peak_velocity=energy.peak_velocity,
        energy=copy_fields(results.Energy, motion.energy),
        modal_energies=tuple(starmap(results.ModalEnergy, zip(numbers, left, strict=True))),
        history=None if kept is None else _history(kept),
        path=None if kept is None else ball_path(kept),
    )


def _history(motion: damper.RingDown) -> results.History:
    period = 2 * math.pi / motion.damper.stuck_frequency
    end = min(motion.duration, _SAMPLES_AT_MOST / _SAMPLES_PER_CYCLE * period)
    count = max(2, math.ceil(end / period * _SAMPLES_PER_CYCLE) + 1)
    samples = damper.sample(motion, np.linspace(0.0, end, count))
    return results.History(samples.time, samples.velocity)


def _look_up(_: float) -> None:
    """Called now and then from inside a ring-down, so that Ctrl-C is heard."""
