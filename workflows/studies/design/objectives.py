"""What designs are worth, by one of two goals.

:class:`LeastDamping`: the least damping ratio over a range of amplitudes, at the speed where it is least. Where the
load holds the ball at rest within these, it is worth nothing; what is compared then is how far the cut-off lies above
the least amplitude. :class:`LeastAmplitude`: the greatest amplitude at the crossings of engine orders with modes.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from damper import (
    DampingCurve,
    Harmonic,
    ParticleDamper,
    Start,
    curve_measurement,
    damping_curve,
    forced,
    work_bound,
)
from damper.curve_measurement import SWEEPS, settled, undamped
from damper.starts import Motions, motions_of, usual_starts
from workflows.effects.definition import Effect
from workflows.progress import Stages
from workflows.scene.load import SceneFile
from workflows.scene.scene import Excitation, Scene
from workflows.solve import coupling, engine_orders, excitation
from workflows.solve.damper import QUICK, particle_damper
from workflows.solve.engine_orders import Crossing
from workflows.solve.results import Floats, SpeedPoint
from workflows.solve.structure import StructureSolver
from workflows.studies.response import without_pull
from workflows.studies.sweep.evaluate import DamperCase

BEYOND, NONE = 100.0, 200.0
"""What a design loses that exceeds a limit, and one that makes no sense."""


@dataclass(frozen=True)
class Obstacle:
    """Why a design is worth nothing.

    Attributes:
        kind: `held` (at rest, by the load), `lossless`, `useless`, `undriven`, `limit`, `weight`, `root_stress`,
            `strain`, `deflection`, `slip`, `sticks_out` (the cavity, of a solid blade); or `refused`, for what a
            scene's checks say.
        speed: that it is about [rad/s].
        value: the stress [Pa] or the friction that it takes, or how far a cavity sticks out [m].
        text: of what was refused, the name of the limit, or what is strained.
    """

    kind: str
    speed: float = math.nan
    value: float = math.nan
    text: str = ""


@dataclass(frozen=True)
class Evaluation:
    """What a design is worth.

    Attributes:
        value: what the goal is about: the least damping ratio, or the greatest amplitude [m]; 0 where there is none.
        score: what is searched for the most of.
        bound: what no ball of its mass in its room can better, at the goal's own amplitudes, speeds and forces; nan
            where there is no such figure.
        speed: at which the value is taken [rad/s]; amplitude: at which [m]; order: of the engine, 0 without.
        driven_from: largest amplitude over the speeds from which on the forces that the motion counts move a ball at
            rest [m]; at cutoff_speed [rad/s].
        cutoff: up to which it stays at rest there [m]: other forces may move it before.
        without: amplitude without any ball that the value stands beside [m]; nan where there is none.
        grows: by how much the force may grow at most before no ball is left at rest [-]; nan without a force.
        dent: the dent's part of what holds the ball at rest [-].
        mass: of all balls [kg].
        used: shares of the limits.
        endured: amplitude that the plate endures [m]; inf where it is not known.
        sticks_out: how far a cavity does, out of a structure in space [m].
        friction_needed: friction coefficient that rolling without slip requires, at the largest amplitude that the goal
            is about; nan where the scene's is enough.
        falling: the least damping ratio where the vibration falls and a ball keeps bouncing; nan for other goals.
        greatest: what the value came to at most from other starts; nan where it does not scatter.
        why: why it is worth nothing; None where it is worth something.
    """

    value: float
    score: float
    bound: float = math.nan
    speed: float = math.nan
    amplitude: float = math.nan
    cutoff: float = math.nan
    cutoff_speed: float = math.nan
    mass: float = math.nan
    used: tuple[tuple[str, float], ...] = ()
    why: Obstacle | None = None
    order: int = 0
    without: float = math.nan
    grows: float = math.nan
    dent: float = 0.0
    endured: float = math.inf
    sticks_out: float = 0.0
    friction_needed: float = math.nan
    falling: float = math.nan
    greatest: float = math.nan
    driven_from: float = math.nan

    @property
    def impossible(self) -> bool:
        """Whether it exceeds a limit, or makes no sense."""
        return self.score <= -BEYOND

    @property
    def works(self) -> bool:
        """Whether it is worth anything."""
        return self.why is None


_POINTS = 65
"""Amplitudes, evenly in their logarithm, at which the damping is looked at."""

_AGAIN = (SWEEPS - 4, SWEEPS + 4, SWEEPS + 8)
"""Sweeps by which the best design is measured again: they begin elsewhere."""

_ALIKE = 0.02
"""Relative difference of such measurements up to which a figure does not scatter."""

_NEVER = 50.0
"""What a design loses whose ball nothing drives."""


@dataclass(frozen=True)
class LeastDamping:
    """The most of the least damping ratio from a `low` amplitude at the cavity to a `high` one [m]."""

    low: float
    high: float
    speeds: tuple[float, ...]
    objective: ClassVar[str] = "least damping ratio over the amplitudes, at the speed where it is least"
    of_damping: ClassVar[bool] = True

    def screened(self, cases: list[DamperCase]) -> Evaluation | None:
        """What a damper is worth that the load holds at the least amplitude, by formula; None for any other."""
        held = self._held(cases)
        if held.driven_from < self.low:
            return None
        lost = math.log(held.driven_from / self.low) if math.isfinite(held.driven_from) else _NEVER
        return replace(held, score=-lost)

    def _held(self, cases: list[DamperCase]) -> Evaluation:
        """What is known of a damper by formula, as if the load held it."""
        begin, worst = max(((cutoff_of(each.verdict_damper), each) for each in cases), key=lambda pair: pair[0])
        return Evaluation(
            0.0,
            0.0,
            bound=min(bound_of(each.verdict_damper, self.high) for each in cases),
            speed=worst.point.omega,
            amplitude=self.low,
            cutoff=min(begin, coupling.moves_first_from(worst.verdict_damper, worst.point)),
            cutoff_speed=worst.point.omega,
            driven_from=begin,
            dent=dent_of(worst.verdict_damper),
            why=Obstacle("held"),
        )

    def worth(self, cases: list[DamperCase], *, quick: bool) -> Evaluation:
        """What a damper is worth that moves on its structure at every speed."""
        every = [(*self._measured(each, QUICK if quick else {}), each.point.omega) for each in cases]
        value, amplitude, _, speed = min(every)
        falling, why = min(each[2] for each in every), None if value > 0 else Obstacle("lossless")
        held = self._held(cases)
        return replace(held, value=value, score=value, speed=speed, amplitude=amplitude, falling=falling, why=why)

    def scattered(self, found: Evaluation, there: DamperCase) -> Evaluation:
        """What a damper is worth by further measurements too, `there` at its speed, where they scatter.

        Motion that is chaotic is another one from other starts, and takes long to settle: the least of all counts.
        """
        every = [(found.value, found.amplitude)]
        every += [self._measured(there, {"sweeps": sweeps})[:2] for sweeps in _AGAIN]
        greatest = max(every)[0]
        if greatest <= (1 + _ALIKE) * min(every)[0]:
            return found
        held = [(settled(there.verdict_damper, amplitude), amplitude) for _, amplitude in every]
        value, amplitude = min(every + [each for each in held if each[0] >= 0])
        return replace(found, value=value, score=value, amplitude=amplitude, falling=value, greatest=greatest)

    def _measured(self, case: DamperCase, how: dict[str, int]) -> tuple[float, float, float]:
        """The least damping ratio at a speed and the amplitude of that [m], and that of falling vibration."""
        figures = damping_curve(case.verdict_damper, threads=1, reach=self.high, **how)
        return *least(figures, self.low, self.high), least(figures.descending, self.low, self.high)[0]


def least(figures: DampingCurve, low: float, high: float) -> tuple[float, float]:
    """The least damping ratio between two amplitudes, and where.

    Beyond the curve's upper end it goes on as of a ball that loses the same energy in each cycle, which is less than
    the ball does.
    """
    if not figures.amplitude.size:
        return 0.0, low
    inside = figures.amplitude[(figures.amplitude > low) & (figures.amplitude < high)]
    grid = np.union1d(np.geomspace(low, high, _POINTS), inside)  # the curve steps up where a rolling ball meets a wall
    at, ratio = np.log(figures.amplitude), figures.damping_ratio
    ratios = np.interp(np.log(grid), at, ratio)
    beyond = grid > figures.amplitude[-1]
    ratios[beyond] = ratio[-1] * (figures.amplitude[-1] / grid[beyond]) ** 2
    ratios[grid <= figures.cutoff] = 0.0
    k = int(np.argmin(ratios))
    return max(float(ratios[k]), 0.0), float(grid[k])


def cutoff_of(damper: ParticleDamper) -> float:
    """Amplitude up to which the ball stays at rest in the middle of a flat floor [m]; inf where nothing drives it."""
    driven = abs(1 - damper.tilt_share[0]) >= 1e-3
    return damper.amplitude_of(damper.break_away_threshold) if driven else math.inf


def dent_of(damper: ParticleDamper) -> float:
    """The dent's part of what holds the ball at rest in the middle of a flat floor [-]."""
    held = damper.break_away_threshold
    return 1 - damper.leaving_threshold / held if held > 0 else 0.0


def bound_of(damper: ParticleDamper, amplitude: float) -> float:
    """The most that any ball of this mass in this room can do at an amplitude, as a damping ratio."""
    share = work_bound(damper, (amplitude, 0.0))
    return math.inf if share >= 1 else -math.log1p(-share) / (4 * math.pi)


_ACCURACY = 1e-2
"""To which the mean amplitude is known of motion that does not repeat itself."""

_ABOUT, _WIDTHS = 41, 3.0
"""Speeds by which a linear resonance is looked for, and how far around where it should be, in damping ratios."""

_TRIES = 8
"""How often it is looked for farther away, where the largest answer is at an end."""


@dataclass(frozen=True, eq=False)
class CrossedDamper:
    """A damper at a crossing, under the greatest of the levels.

    Attributes:
        crossing: of the order with the structure without a ball.
        system: the damper there; unloaded: the same without the ball's pull on the structure; axis: along which of
            its axes the amplitude is; harmonic: what drives it there.
        leads: whether the mode is the one that yields most along x, of which free vibration tells.
        share: what moves a ball at rest at all over what moves it by the forces that its motion counts.
        speeds: between which the order is looked at [rad/s].
    """

    crossing: Crossing
    system: ParticleDamper
    unloaded: ParticleDamper
    axis: int
    harmonic: Harmonic
    leads: bool
    share: float
    speeds: tuple[float, float]

    def at(self, omega: float) -> tuple[ParticleDamper, Harmonic]:
        """The damper and what drives it at a speed [rad/s]."""
        square = (omega / self.crossing.omega) ** 2
        stiffer = 1 + self._turns * (square - 1)
        system = self.system
        modes = system.modes
        if modes is not None:
            modes = tuple(replace(mode, stiffness=mode.stiffness * stiffer) for mode in modes)
        x, y = system.stiffness
        turned = replace(
            system,
            stiffness=(x * stiffer, y * stiffer),
            modes=modes,
            centrifugal_acceleration=system.centrifugal_acceleration * square,
            lateral_acceleration=(system.lateral_acceleration[0] * square, system.lateral_acceleration[1] * square),
            rotation=system.rotation * math.sqrt(square),
        )
        return turned, replace(self.harmonic, frequency=self.crossing.order * omega)

    def speed_of(self, frequency: float) -> float:
        """The speed at which the order meets what has a frequency at the crossing's speed, both in rad/s."""
        square = (frequency / (self.crossing.order * self.crossing.omega)) ** 2
        met = square * (1 - self._turns) / max(1 - square * self._turns, 1e-6)
        return min(max(self.crossing.omega * math.sqrt(max(met, 0.0)), self.speeds[0]), self.speeds[1])

    @property
    def _turns(self) -> float:
        """Growth of the squared frequency over that of the squared speed, both relative."""
        return min(self.crossing.turns / self.crossing.order, 0.999)

    @cached_property
    def resting_crossing(self) -> ParticleDamper:
        """The damper where the order meets the mode with the ball at rest: its load and stiffness are of that speed."""
        return self.at(self.speed_of(self.with_ball))[0]

    @property
    def force(self) -> float:
        """At the cavity along x, of the same effect on the leading mode [N]."""
        return excitation.force_at_cavity(self.system, self.harmonic)

    @cached_property
    def _mode(self) -> tuple[float, float]:
        """The mode that is crossed: its frequency [rad/s], and the cavity in it at a modal mass of 1 kg [1/kg^0.5]."""
        system, modes = self.system, self.system.modes
        if modes is None:
            return math.sqrt(system.stiffness[self.axis] / system.modal_mass), 1 / math.sqrt(system.modal_mass)
        square = (self.crossing.order * self.crossing.omega) ** 2
        mode = min(modes, key=lambda mode: abs(mode.stiffness / mode.mass - square))
        return math.sqrt(mode.stiffness / mode.mass), float(abs(mode.shape[self.axis])) / math.sqrt(mode.mass)

    @property
    def without_ball(self) -> float:
        """Frequency of the mode without the ball, at the crossing's speed, of this very plate and cavity [rad/s]."""
        return self._mode[0]

    @property
    def with_ball(self) -> float:
        """Frequency of the mode with the ball at rest in it [rad/s]."""
        return self.without_ball / math.sqrt(1 + self.system.ball_mass * self._mode[1] ** 2)

    def pendulum_resonances(self) -> list[float]:
        """Speeds at which the structure and a ball that swings in a hollow floor are in resonance [rad/s].

        (K - nu² (M + m)) (w² - nu²) = beta nu⁴ m (1 - tau)², of the mode at the cavity along its axis, w the ball's own
        frequency; all but nu goes with the speed.
        """
        system, order = self.system, self.crossing.order
        if system.floor_radius is None:
            return []
        scan = np.linspace(*self.speeds, 2000)
        square = (scan / self.crossing.omega) ** 2
        nu = order * scan
        mass = self._mode[1] ** -2
        stiffness = mass * self.without_ball**2 * (1 + self._turns * (square - 1))
        pendulum = coupling.pendulum(system, self.crossing.omega)
        own = 0.0 if pendulum is None else 2 * math.pi * pendulum.frequency_hz[self.axis]
        share = system.inertia_ratio * system.ball_mass * (1 - system.tilt_share[self.axis]) ** 2
        both = (stiffness - nu**2 * (mass + system.ball_mass)) * (own**2 * square - nu**2) - share * nu**4
        crossed = np.flatnonzero((both[:-1] < 0) != (both[1:] < 0))
        part = both[crossed] / (both[crossed] - both[crossed + 1])
        return [float(omega) for omega in scan[crossed] + part * (scan[crossed + 1] - scan[crossed])]


def crossing_objective(
    scene: Scene, effects: dict[str, Effect], point: SpeedPoint, crossing: Crossing, low: float, high: float
) -> CrossedDamper | None:
    """The damper of a scene at a crossing, on the structure there.

    None where nothing drives the mode or the cavity does not move in it. `low`, `high`: speeds looked at [rad/s].
    """
    forcing = scene.excitation
    modes, axis, leads = excitation.modes_at_crossing(point, crossing)
    if forcing is None or excitation.idle_structure(modes, forcing):
        return None
    followed = excitation.modes_followed(scene, point, modes)
    system = particle_damper(scene, effects, point, followed)
    bare = without_pull(system, scene, point, followed)
    harmonic = excitation.harmonic_of(system, crossing, point, forcing, max(forcing.levels))
    share = coupling.resting_share(system, point) if axis == 0 else 1.0
    return CrossedDamper(crossing, system, bare, axis, harmonic, leads, share, (low, high))


@dataclass(frozen=True)
class Linear:
    """The linear answers about a crossing, each at the speed where it is greatest.

    Attributes:
        without: amplitude without the ball [m], at `alone` [rad/s]; resting: with the ball at rest [m]; grows: by how
            much the force may grow until the ball cannot stay at rest.
        least: amplitude below which no ball of this mass in this room can bring it [m].
    """

    without: float
    alone: float
    resting: float
    grows: float
    least: float


def linear(crossed: CrossedDamper) -> Linear:
    """Linear answers, and the least amplitude that is conceivable.

    Whatever the ball does, the structure's answer at the frequency nu of the force is that with the ball at rest, and
    that to the ball's own way in the cavity, m nu² (1 - tau) s. No way of at most half a clearance d has a larger part
    at nu than the square wave's, (4 / pi) d: of the amplitude with the ball at rest, as much as a force of
    (4 / pi) m nu² d |1 - tau| at the cavity gives is all that it can take away.
    """
    bare = replace(crossed, system=crossed.unloaded)
    _, _, alone, most = _largest(bare, bare.without_ball, "without")
    omega, harmonics, answers, k = _largest(crossed, crossed.with_ball, "linear")
    resting, nu, axis = float(np.abs(answers.linear[k])), harmonics[k].frequency, crossed.axis
    unit = Harmonic(nu, force=(1.0, 0.0) if axis == 0 else (0.0, 1.0))
    receptance = float(np.abs(_answers(crossed, omega, [unit]).linear[0]))
    system = crossed.system
    threshold = 4 / math.pi * system.ball_mass * nu**2 * system.half_gap[axis] * abs(1 - system.tilt_share[axis])
    without = float(np.abs(alone.without[most]))
    met = bare.speed_of(bare.without_ball)
    least = max(resting - receptance * threshold, 0.0)
    return Linear(without, met, resting, crossed.share * float(answers.moves_from[k]), least)


def _largest(crossed: CrossedDamper, resonance: float, answer: str) -> tuple[float, list[Harmonic], Motions, int]:
    """Linear answers about a resonance, and which of them is the largest: not the first nor the last where possible.

    The structure is that at the speed where the order meets the resonance. Where no speed does, the one that comes
    nearest is taken.

    Returns:
        Speed of the structure [rad/s], what drives it, the answers, and the number of the largest.
    """
    low, high = crossed.speeds
    around = _WIDTHS * max(crossed.system.damping_ratio, 1e-4) * np.linspace(-1.0, 1.0, _ABOUT)
    for _ in range(_TRIES):
        omega = crossed.speed_of(resonance)
        if not low < omega < high:
            harmonics = [crossed.at(omega)[1]]
        else:
            met = crossed.crossing.order * omega
            harmonics = [replace(crossed.harmonic, frequency=float(met * (1 + x))) for x in around]
        answers = _answers(crossed, omega, harmonics)
        k = int(np.argmax(np.abs(getattr(answers, answer))))
        if len(harmonics) == 1 or 0 < k < len(harmonics) - 1:
            break
        resonance *= 1 + float(around[k])
    return omega, harmonics, answers, k


def _answers(crossed: CrossedDamper, omega: float, harmonics: list[Harmonic]) -> Motions:
    return motions_of(crossed.at(omega)[0], harmonics, (Start.UP,), crossed.axis, 0, 256)


_SCAN = 2000
"""Amplitudes looked through."""


def amplitude(here: CrossedDamper, resting: float, *, quick: bool) -> float:
    """The greatest amplitude at a crossing, which is `resting` with the ball at rest [m]."""
    system = here.resting_crossing
    own = here.force / (2 * resting * system.stiffness[0])
    figures = damping_curve(system, threads=1, reach=2 * resting, **(QUICK if quick else {}))
    if resting <= figures.cutoff:
        return resting
    return max(hitting(figures.descending, own, resting), rolling(system, own, resting))


def hitting(figures: DampingCurve, own: float, resting: float) -> float:
    """The greatest amplitude with a ball that hits the walls [m]; `own`: damping ratio with the ball at rest."""
    if not figures.amplitude.size:
        return resting
    scan = np.geomspace(resting * own / (own + figures.peak), resting, _SCAN)
    ratio = figures.at(scan)
    ratio *= np.minimum(1.0, figures.amplitude[-1] / scan) ** (4 / 3)
    ratio[scan <= figures.cutoff] = 0.0
    return _greatest(scan, ratio, own, resting)


def rolling(system: ParticleDamper, own: float, resting: float) -> float:
    """The greatest amplitude with a ball that rolls to and fro and reaches no wall [m].

    In a cycle it goes four times as far as `reach` says, and loses 4 m f / beta times that. Where it would reach a wall
    at resonance, it rolls at speeds beside it, up to the amplitude at which it grazes the wall, or at which the load
    has drawn it to one.
    """
    omega, beta = system.stuck_frequency, system.inertia_ratio
    drive = beta * abs(1 - system.tilt_share[0]) * omega**2  # per amplitude
    resistance = beta * system.rolling_threshold
    if drive * resting <= resistance:
        return 0.0
    scan = np.geomspace(resistance / drive, resting, _SCAN)
    reach = scan * drive / omega**2 * reaches(resistance / (drive * scan))
    lost = 4 * reach * system.ball_mass * system.rolling_threshold
    amplitude = _greatest(scan, lost / (2 * math.pi * system.stiffness[0] * scan**2), own, resting)
    last = float(np.interp(system.half_gap[0], reach, scan))
    if system.restoring[0, 0] < 0:  # the load draws it to a wall
        last = min(last, curve_measurement.rolling(undamped(system), float(scan[0]), 1).last)
    return min(amplitude, last)


def reaches(friction: Floats) -> Floats:
    """How far to either side a mass with dry friction goes on a shaken floor, over what it would without friction.

    Den Hartog (Trans. ASME 53, 1931), `friction` over the largest drive: sqrt(1 - (pi f / 2)²) while it never stops;
    from 1 / sqrt(1 + (pi / 2)²) on it waits at each end, sets off where the drive is f, and stops a while later.
    """
    begin = np.arcsin(np.minimum(friction, 1.0))
    low, high = math.pi - begin, math.pi + begin
    for _ in range(50):
        middle = 0.5 * (low + high)
        moving = np.cos(begin) - np.cos(middle) > friction * (middle - begin)
        low, high = np.where(moving, middle, low), np.where(moving, high, middle)
    turned = low - begin
    way = np.cos(begin) * turned - np.sin(low) + np.sin(begin) - 0.5 * friction * turned**2
    waits = friction * math.hypot(1.0, 0.5 * math.pi) > 1
    return np.where(waits, 0.5 * way, np.sqrt(np.maximum(1 - (0.5 * math.pi * friction) ** 2, 0.0)))


def _greatest(scan: Floats, ratio: Floats, own: float, resting: float) -> float:
    """The greatest of the amplitudes that a force does not only keep up but would raise further."""
    raised = np.flatnonzero(scan * (own + ratio) <= own * resting * (1 + 1e-12))
    return float(scan[raised[-1]]) if raised.size else float(scan[0])


ASIDE = (-0.8, -0.4, 0.0, 0.4, 0.8)
"""Speeds about a resonance, in damping ratios of it."""

_CYCLES, _FEW_CYCLES = 10_000, 4000
"""Most cycles of a motion, and where a percent does not count."""

_BESIDE = 1.2
"""Amplitude of a motion over that of its part at the frequency of the force, at most."""

_ACROSS = 9
"""Speeds over the whole range at which a ball in a hollow floor is looked at besides."""


@dataclass(frozen=True)
class LeastAmplitude:
    """The least of the greatest amplitude at the crossings.

    Attributes:
        excitation: what shakes the structure.
        crossings: of its orders with modes that it drives.
        ends: the lowest and the highest speed of the scene [rad/s].
        reference: greatest amplitude without a ball [m].
    """

    excitation: Excitation
    crossings: tuple[Crossing, ...]
    ends: tuple[float, float]
    reference: float
    objective: ClassVar[str] = "greatest amplitude at the crossings"
    of_damping: ClassVar[bool] = False

    @property
    def speeds(self) -> tuple[float, ...]:
        """Of the crossings [rad/s], each once."""
        return tuple(sorted({crossing.omega for crossing in self.crossings}))

    def screened(self, _: list[DamperCase]) -> Evaluation | None:
        """None: no formula says what a damper is worth."""
        return None

    def worth(self, cases: list[DamperCase], *, quick: bool) -> Evaluation:
        """What a damper is worth that is placed on its structure at every crossing."""
        here = [
            crossing_objective(each.scene, each.state.effects, each.point, crossing, *self.ends)
            for each in cases
            for crossing in self.crossings
            if crossing.omega == each.point.omega
        ]
        every = [(each, linear(each)) for each in here if each is not None]
        if not every:
            return Evaluation(0.0, -_NEVER, why=Obstacle("undriven"))
        value, (at, lines) = 0.0, every[0]
        for one, its in sorted(every, key=lambda pair: _at_most(*pair), reverse=True):
            if _at_most(one, its) <= value:
                break
            reached = _reached(one, its, quick=quick)
            if reached > value:
                value, at, lines = reached, one, its
        without = max(its.without for _, its in every)
        growth = min(math.log(max(lines.grows, 1.0)), _NEVER)
        obstacle = Obstacle("held" if lines.grows >= 1 else "useless")
        return Evaluation(
            value,
            math.log(self.reference / value) - growth,
            bound=max(its.least for _, its in every),
            speed=lines.alone,
            amplitude=value,
            cutoff=lines.resting * lines.grows,
            why=None if value <= excitation.HELPS * without else obstacle,
            order=at.crossing.order,
            without=without,
            grows=lines.grows,
            dent=dent_of(at.system),
        )


def _balanced(here: CrossedDamper) -> bool:
    """Whether the balance of free vibration answers for a damper."""
    return here.leads and excitation.is_well_held(here.resting_crossing)


def _at_most(here: CrossedDamper, lines: Linear) -> float:
    """What the amplitude at a crossing cannot exceed, so that it is not computed where another crossing has more [m].

    By the balance that is the amplitude with the ball at rest. Otherwise a force F at a frequency nu puts in pi F A in
    each cycle, of which the dashpot c takes pi c nu A²: A is at most F / (c nu), the amplitude with the ball at rest in
    the ratio of the frequencies. What is not sinusoidal adds no more than _BESIDE says.
    """
    if _balanced(here):
        return lines.resting
    slowest = min(_speeds(here, quick=False))
    return _BESIDE * lines.resting * max(here.speed_of(here.with_ball) / slowest, 1.0)


def _reached(here: CrossedDamper, lines: Linear, *, quick: bool) -> float:
    """The greatest amplitude at a crossing [m]."""
    if _balanced(here):
        return amplitude(here, lines.resting, quick=quick)
    return followed(here, quick=quick)


def followed(here: CrossedDamper, *, quick: bool) -> float:
    """The greatest mean amplitude of the steady states about a crossing [m]."""
    dampers, harmonics = zip(*map(here.at, _speeds(here, quick=quick)), strict=True)
    starts = [each for each in usual_starts(here.system) if each is not Start.RANDOM or not quick]
    how: dict[str, Any] = {"probe": here.axis, "accuracy": _ACCURACY, "threads": 1}
    states = forced(dampers, harmonics, starts, max_cycles=_FEW_CYCLES if quick else _CYCLES, **how)
    means = np.where(np.isnan(states.mean), np.abs(states.linear)[:, None], states.mean)
    return float(means.max())


def _speeds(here: CrossedDamper, *, quick: bool) -> list[float]:
    """Speeds at which the steady states are looked at: the resonances of all that the ball may do."""
    zeta = max(here.system.damping_ratio, 1e-4)
    aside = ASIDE[::2] if quick else ASIDE
    middles = here.pendulum_resonances()
    hollow = here.system.floor_radius is not None
    if here.leads and not (quick and hollow):
        free = excitation.free_vibration(here.system, threads=1)
        middles += [here.speed_of(turns) for _, turns in free.answers(here.force)]
    speeds = {here.speed_of(here.with_ball), here.speed_of(here.without_ball)}
    speeds |= {middle * (1 + zeta * part) for middle in middles for part in aside}
    if hollow:
        speeds |= set(np.linspace(*here.speeds, _ACROSS // 2 if quick else _ACROSS).tolist())
    low, high = here.speeds
    return sorted({min(max(omega, low), high) for omega in speeds})


def amplitude_objective(source: SceneFile, stages: Stages) -> LeastAmplitude:
    """The goal of a scene as its forced response is computed.

    Raises:
        BadInput: what `response` needs is missing, or no order meets a mode it drives.
    """
    forcing = source.scene.excitation
    assert forcing is not None
    solver = StructureSolver(source, stages)
    points = excitation.over_speed_range(solver).points
    speeds = source.scene.rotor.speeds
    low, high = min(speeds), max(speeds)
    crossings = engine_orders.of_points(points, forcing.orders)
    if not crossings:
        raise engine_orders.no_crossing(points, forcing.orders, source.name)
    alone = []
    for crossing in crossings:
        (point,) = solver.at([crossing.omega]).points
        here = crossing_objective(source.scene, solver.choice.effects, point, crossing, low, high)
        alone += [] if here is None else [linear(here).without]
    if not alone:
        raise engine_orders.no_crossing(points, forcing.orders, source.name, driven=False)
    return LeastAmplitude(forcing, tuple(crossings), (low, high), max(alone))
