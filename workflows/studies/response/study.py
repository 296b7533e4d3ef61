"""Steady states through every crossing of an engine order with a mode, without and with the ball."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from workflows.decisions.answering import answering
from workflows.decisions.decided import Decided, decide
from workflows.errors import BadInput
from workflows.findings import worth
from workflows.scene.excitation import Excitation
from workflows.scene.file import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import damper_stage, felt, needs, plate_records
from workflows.solve import plate_stage as plate
from workflows.solve.plate_records import Discrete
from workflows.solve.records import CavityMode, Floats, Results, SpeedPoint, Surface, rpm
from workflows.stages import Stages
from workflows.studies.response import crossings, driven
from workflows.studies.response.crossings import Crossing
from workflows.wording import whole

if TYPE_CHECKING:
    import damper

SPEEDS, FEW_SPEEDS = 60, 20
"""Through a crossing; fewer where each speed of the plate is solved by itself."""

_ACROSS, _FEW_ACROSS = 61, 13
"""The same over the whole range, by which crossings are found."""

_ACCURACY = 1e-2
"""To which the mean amplitude of motion that does not repeat itself is known."""

_CYCLES = 30_000
"""Most cycles of a motion."""

_PATH_CYCLES, _PATH_SAMPLES = 3, 1500
"""Of the ball's path that is shown."""


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """The ball in its cavity over some cycles of a steady state: time (n,) [s], places (n, 2) [m]."""

    rpm: float
    force: float
    time: Floats
    structure: Floats
    ball: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Through:
    """Steady states through a crossing: s speeds, f forces, from each start.

    Attributes:
        crossing: where; axis: along which of the damper's axes the amplitude is.
        omega: (s,) [rad/s]; forces: (f,).
        states: of the damper, s * f points, the speeds one after the other.
        short: amplitude by the short way that is nearest to the mean, (s, f, starts) [m]; nan where it is not.
        least_force: from which on the ball cannot stay at rest, in the unit of the forces.
        figures: the damper's own, at the crossing; path: of the ball at the crossing under the largest force.
    """

    crossing: Crossing
    axis: int
    omega: Floats
    forces: tuple[float, ...]
    states: damper.Forced
    short: Floats
    least_force: float
    figures: damper.Working
    path: Path

    def shaped(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Values of the points as (s, f) or (s, f, starts)."""
        return values.reshape(len(self.omega), len(self.forces), *values.shape[1:])


@dataclass(frozen=True, eq=False, repr=False)
class Response:
    """All that a forced response found.

    Attributes:
        results: the structure over the whole range of speeds, as of a run.
        passed: crossings that were followed; idle: the others, each with the reason.
        strain_per_amplitude: at the root in the first bending mode [1/m]; None where it is not known.
    """

    results: Results
    excitation: Excitation
    passed: tuple[Through, ...]
    idle: tuple[tuple[Crossing, str], ...]
    strain_per_amplitude: float | None


def respond(source: SceneFile, stages: Stages | None = None) -> Response:
    """Follow a scene's steady states through its crossings; nothing is written.

    The floor of the cavity tilts and the plate moves in its own modes, whatever [effects] says: the answer is about the
    blade. Each damper has the modes that yield most along its axes, and the one that is crossed.

    Raises:
        BadInput: no damper, no excitation, no range of speeds; see also :func:`workflows.pipeline.run`.
        NoAnswer: the plate has none.
    """
    excitation = _checked(source)
    needs.check(source)
    stages = stages or Stages()
    effects = source.scene.effects.model_copy(update={"floor_tilt": True, "structural_modes": "auto"})
    if source.scene.plate is not None:
        effects = effects.model_copy(update={"structural_modes": True})
    source = source.changed(effects=effects)
    decided = decide(source, stages)
    low, high = min(source.scene.rotor.speeds), max(source.scene.rotor.speeds)
    solved = _Solved(source, decided, stages)
    points = solved.at(np.linspace(low, high, _FEW_ACROSS if solved.dear else _ACROSS))
    passed, idle = [], []
    for crossing in crossings.of_points(points, excitation.orders):
        found = _through(solved, crossing, excitation, (low, high))
        if isinstance(found, str):
            idle.append((crossing, found))
        else:
            passed.append(found)
    results = Results(
        scene=source.scene,
        effects=decided.effects,
        speeds=points,
        surface=solved.surface,
        theory=decided.theory,
        mesh_sha256=decided.mesh_sha256,
        notes=source.remarks,
        timings=stages.timings(),
    )
    return Response(results, excitation, tuple(passed), tuple(idle), worth.root_strain(results, 1.0))


def _checked(source: SceneFile) -> Excitation:
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


class _Solved:
    """The structure of a scene at whatever speeds, on one mesh."""

    def __init__(self, source: SceneFile, decided: Decided, stages: Stages) -> None:
        self.source, self.decided, self.stages = source, decided, stages
        self.discrete: Discrete | None = None
        if decided.form is not None:
            with answering(source), stages("modes"):
                self.discrete = plate.discretise(source, decided, stages)
        self.surface: Surface | None = None

    @property
    def scene(self) -> Scene:
        return self.source.scene

    @property
    def dear(self) -> bool:
        """Whether every speed of the plate is solved by itself."""
        return self.discrete is not None and plate.one_by_one(self.scene, self.discrete.choice.operators)

    def at(self, omega: Floats) -> tuple[SpeedPoint, ...]:
        """Modes and what the damper feels at speeds [rad/s]."""
        if self.discrete is None:
            return tuple(felt.known_structure(self.scene, float(speed)) for speed in omega)
        speeds = tuple(float(speed) for speed in omega)
        source = self.source.changed(rotor=self.scene.rotor.model_copy(update={"speeds": speeds}))
        points, diagram, numbers = plate.points_on(source, self.decided, self.discrete, self.stages)
        if self.surface is None:
            self.surface = plate_records.surface(self.discrete.choice.operators, diagram, numbers[:1], 1)
        return points

    def damper(self, point: SpeedPoint, only: Sequence[CavityMode] | None) -> damper.ParticleDamper:
        return damper_stage.particle_damper(self.scene, self.decided.effects, point, only)


def _through(solved: _Solved, crossing: Crossing, excitation: Excitation, speeds: tuple[float, float]) -> Through | str:
    """The steady states through a crossing, or why there is nothing to follow."""
    (at,) = solved.at(np.array([crossing.omega]))
    modes = driven.modes_of(at, driven.branch_of((at,), crossing))
    if modes is not None and (idle := driven.idle(modes, excitation)):
        return idle
    axis = 0 if modes is None else int(abs(modes[0].shape[1]) > abs(modes[0].shape[0]))
    leads = modes is None or felt.leading(at.cavity_modes, 0) is modes[0]
    omega = _speeds(solved, crossing, at, speeds)
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


def _speeds(solved: _Solved, crossing: Crossing, at: SpeedPoint, speeds: tuple[float, float]) -> Floats:
    """Speeds through the resonance without the ball, and with it at rest."""
    reduced, given = at.reduced, solved.scene.damper
    shift = 0.0 if reduced is None else 1 - reduced.f1_hz / reduced.f2_hz
    band = crossing.band(0.0 if given is None else given.damping_ratio, shift, *speeds)
    return crossings.gathered(crossing.omega, *band, FEW_SPEEDS if solved.dear else SPEEDS)


def _driven(
    solved: _Solved, crossing: Crossing, excitation: Excitation, omega: Floats
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
    solved: _Solved,
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

        return forced(dampers, harmonics, starts, probe=axis, accuracy=_ACCURACY, max_cycles=_CYCLES, progress=progress)


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


def peak(found: Through, force: int) -> tuple[int, int]:
    """Speed and start at which the mean amplitude under a force is largest, whatever the start."""
    means = np.nan_to_num(found.shaped(found.states.mean)[:, force])  # nan where a ball has no end of hits
    speed, start = np.unravel_index(int(np.argmax(means)), means.shape)
    return int(speed), int(start)
