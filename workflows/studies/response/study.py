"""Steady states through every crossing of an engine order with a mode, without and with the ball."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from workflows.errors import BadInput, during
from workflows.findings import worth
from workflows.progress import Stages
from workflows.results import crossings
from workflows.results.crossings import Crossing
from workflows.scene.excitation import Excitation
from workflows.scene.source import SceneFile
from workflows.solve import damper_stage, felt, resources
from workflows.solve.records import Floats, Results, SpeedPoint, rpm
from workflows.studies.response import band, driven
from workflows.studies.response.records import Path, Response, Through
from workflows.studies.response.solved import Solved, shaken
from workflows.wording import whole

if TYPE_CHECKING:
    import damper

SPEEDS, FEW_SPEEDS = 60, 20
"""Through a crossing; fewer where each speed of the plate is solved by itself."""

_ACCURACY = 1e-2
"""To which the mean amplitude of motion that does not repeat itself is known."""

MOST_CYCLES = 30_000
"""Most cycles of a motion."""

_PATH_CYCLES, _PATH_SAMPLES = 3, 1500
"""Of the ball's path that is shown."""


def respond(source: SceneFile, stages: Stages | None = None) -> Response:
    """Follow a scene's steady states through its crossings; nothing is written.

    The floor of the cavity tilts and the plate moves in its own modes, whatever [effects] says: the answer is about the
    blade. Each damper has the modes that yield most along its axes, and the one that is crossed.

    Raises:
        BadInput: no damper, no excitation, no range of speeds, no order that crosses a mode within it; see also
            :func:`workflows.pipeline.run`.
        NoAnswer: the plate has none.
    """
    excitation = checked(source)
    resources.check(source)
    stages = stages or Stages()
    source = shaken(source)
    solved = Solved(source, stages)
    points = solved.across()
    met = crossings.of_points(points, excitation.orders)
    if not met:
        raise crossings.unmet(points, excitation.orders, source.name)
    passed, idle = [], []
    for crossing in met:
        with during(f"order {crossing.order} at {whole(crossing.rpm)} rpm"):
            found = _through(solved, crossing, excitation)
        if isinstance(found, str):
            idle.append((crossing, found))
        else:
            passed.append(found)
    results = Results(
        scene=source.scene,
        effects=solved.decided.effects,
        speeds=points,
        surface=solved.surface,
        theory=solved.decided.theory,
        mesh_sha256=solved.decided.mesh_sha256,
        notes=source.remarks,
        timings=stages.timings(),
    )
    return Response(results, excitation, tuple(passed), tuple(idle), worth.root_strain(results, 1.0))


def checked(source: SceneFile) -> Excitation:
    """What shakes a scene.

    Raises:
        BadInput: no damper, no excitation, no range of speeds.
    """
    scene = source.scene
    if scene.damper is None:
        raise BadInput("the table is missing: response needs a damper", file=source.name, key="[damper]")
    if scene.excitation is None:
        problem = 'the table is missing: response needs it, such as orders = [2, 3] and force = ["1 N", "10 N"]'
        raise BadInput(problem, file=source.name, key="[excitation]")
    if scene.damper.formulation == "printed":
        problem = "the printed equations know no force: expected 'consistent'"
        raise BadInput(problem, file=source.name, key="[damper] formulation", value="printed")
    if len(scene.rotor.speeds) < 2:
        problem = "expected two speeds at least: crossings are looked for from the lowest to the highest"
        raise BadInput(problem, file=source.name, key="[rotor] speeds")
    return scene.excitation


def _through(solved: Solved, crossing: Crossing, excitation: Excitation) -> Through | str:
    """The steady states through a crossing, or why there is nothing to follow."""
    (at,) = solved.at(np.array([crossing.omega]))
    modes = driven.modes_of(at, driven.branch_of((at,), crossing))
    if modes is not None and (idle := driven.idle(modes, excitation)):
        return idle
    axis = 0 if modes is None else int(abs(modes[0].shape[1]) > abs(modes[0].shape[0]))
    leads = modes is None or felt.leading(at.cavity_modes, 0) is modes[0]
    omega = _speeds(solved, crossing, at)
    dampers, harmonics = _driven(solved, crossing, excitation, omega)
    states = _followed(solved, crossing, dampers, harmonics, axis)
    forces = len(excitation.levels)
    shape, levels = (len(omega), forces), np.tile(excitation.levels, len(omega))
    middle = dampers[len(omega) // 2 * forces]
    top = int(np.argmax(np.nan_to_num(states.mean).max(axis=1)))
    with solved.stages("damper"):
        short = _short(middle, dampers, harmonics, states, speaks=axis == 0 and leads)
        return Through(
            crossing=crossing,
            axis=axis,
            omega=omega,
            forces=excitation.levels,
            states=states,
            short=short.reshape(*shape, -1),
            least_force=float((levels * states.moves_from).min()),
            figures=damper_stage.figures(middle),
            path=_path(dampers[top], harmonics[top], float(omega[top // forces]), float(levels[top])),
        )


def _speeds(solved: Solved, crossing: Crossing, at: SpeedPoint) -> Floats:
    """Speeds through the resonance without the ball, and with it at rest."""
    reduced, given, speeds = at.reduced, solved.scene.damper, solved.scene.rotor.speeds
    shift = 0.0 if reduced is None else 1 - reduced.f1_hz / reduced.f2_hz
    zeta = 0.0 if given is None else given.damping_ratio
    ends = band.band(crossing, zeta, shift, (min(speeds), max(speeds)))
    return band.gathered(crossing.omega, *ends, FEW_SPEEDS if solved.dear else SPEEDS)


def _driven(
    solved: Solved, crossing: Crossing, excitation: Excitation, omega: Floats
) -> tuple[list[damper.ParticleDamper], list[damper.Harmonic]]:
    """Dampers and what drives them, each speed with all forces after the other."""
    dampers, harmonics, points = [], [], solved.at(omega)
    branch = driven.branch_of(points, crossing)
    for point in points:
        own = driven.modes_of(point, branch)
        system = solved.damper(point, None if own is None else driven.kept(point, own))
        dampers += [system] * len(excitation.levels)
        harmonics += [driven.harmonic_of(system, crossing, point, excitation, level) for level in excitation.levels]
    return dampers, harmonics


def _followed(
    solved: Solved,
    crossing: Crossing,
    dampers: list[damper.ParticleDamper],
    harmonics: list[damper.Harmonic],
    axis: int,
) -> damper.Forced:
    """The steady states, with progress for a person who waits."""
    from damper import Start, forced

    starts = tuple(Start)
    with solved.stages("damper", len(dampers) * len(starts)) as step:
        done = 0

        def progress(number: int) -> None:
            nonlocal done
            for _ in range(number - done):
                step.advance(f"order {crossing.order} at {whole(crossing.rpm)} rpm")
            done = number

        return forced(
            dampers, harmonics, starts, probe=axis, accuracy=_ACCURACY, max_cycles=MOST_CYCLES, progress=progress
        )


def _short(
    middle: damper.ParticleDamper,
    dampers: list[damper.ParticleDamper],
    harmonics: list[damper.Harmonic],
    states: damper.Forced,
    *,
    speaks: bool,
) -> Floats:
    """Amplitudes by the short way, nearest to the means; nan where it does not speak of the mode that is crossed.

    That is so where another yields more along x. One measurement at the crossing serves all of it: frequencies scale
    with the structure's own, forces with its stiffness.
    """
    from damper import backbone

    short = np.full(states.mean.shape, np.nan)
    if not speaks:
        return short
    found = backbone(middle)
    for n, (system, harmonic) in enumerate(zip(dampers, harmonics, strict=True)):
        force = driven.at_cavity(system, harmonic) * middle.stiffness[0] / system.stiffness[0]
        nu = harmonic.frequency * middle.stuck_frequency / system.stuck_frequency
        amplitudes = np.array([amplitude for amplitude, _ in found.answers(force, nu)])
        if amplitudes.size:
            off = np.abs(np.log(amplitudes[:, None] / states.mean[n]))
            short[n] = amplitudes[np.argmin(off, axis=0)]
    return short


def _path(system: damper.ParticleDamper, harmonic: damper.Harmonic, omega: float, force: float) -> Path:
    """The ball's path under a force, once the structure has forgotten where it began."""
    from damper import ringdown, sample

    period, own = 2 * math.pi / harmonic.frequency, 2 * math.pi / system.stuck_frequency
    settle = min(int(2 / (2 * math.pi * max(system.damping_ratio, 1e-4))) + 50, 3000)
    cycles = (settle + _PATH_CYCLES) * period / own
    start = None if system.modes is None else (0.0,) * len(system.modes)
    run = ringdown(system, (0.0, 0.0), cycles, harmonic=harmonic, amplitudes=start, keep_events=True)
    times = np.linspace(settle * period, run.duration * (1 - 1e-9), _PATH_SAMPLES)
    history = sample(run, times)
    return Path(rpm(omega), force, times - times[0], history.displacement, np.asarray(history.relative_position))
