"""Physical laws that every result must obey before it is returned.

Each follows from the equations of motion for all dampers that it is applied to, so that a violation is a defect: of the
kernels, or of what compiled them. Tolerances are some thousand times the rounding seen in 10⁴ random dampers.
"""

from __future__ import annotations

import math
import sys
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from damper.curves import BINS, TINY
from damper.equations import structures_by
from damper.model import alike, half_gap, lateral_pull
from damper.motion import COUPLED, Outcome, RingDown, kinds
from damper.state import HIT, LOCKED, PERIODIC, RUB, STUCK, TIRED

if TYPE_CHECKING:
    from damper.curves import DampingCurve
    from damper.equations import Structures
    from damper.model import Floats, Integers, Parameters, ParticleDamper, Records
    from damper.starts import Motions


class Bounds(NamedTuple):
    """Bounds on n dampers; T and V are the kinetic and elastic energy of the structure.

    Attributes:
        ball: mass m, shape (n,) [kg].
        gap: half the clearance along each axis, shape (n, 2) [m].
        depth: least potential energy of structure and ball, with its sign changed, shape (n,) [J].
        mobility: the cavity's speed is at most sqrt(2 mobility T), shape (n,) [1/kg].
        flexibility: its displacement is at most sqrt(2 flexibility V), shape (n, 2) [m/N].
        drive: abs(B q') is at most drive sqrt(2 T), shape (n, 2).
        hold: abs(B q) is at most hold sqrt(2 V), shape (n, 2).
        damped: abs(B q') is at most damped times the root of the dashpots' power; inf without dashpots, shape (n, 2).
        skew: abs(A), which couples the axes, shape (n,) [1/s²].
        bowl: abs(m s (D - N) s / 2 - m s a) at most, a the lateral acceleration, shape (n,) [J].
        pull: abs(m E s) at most, shape (n, k) [N].
    """

    ball: Floats
    gap: Floats
    depth: Floats
    mobility: Floats
    flexibility: Floats
    drive: Floats
    hold: Floats
    damped: Floats
    skew: Floats
    bowl: Floats
    pull: Floats

    def speed(self, energy: Floats) -> Floats:
        """Largest sqrt(2 T), and sqrt(2 V), at a total energy, both of shape (n, …) [J^0.5]."""
        depth = self.depth.reshape(-1, *(1,) * (energy.ndim - 1))
        return np.asarray(np.sqrt(np.maximum(2 * (energy + depth), 0.0)))

    def work(self, speed: Floats, time: Floats | float, path: Floats | float = np.inf) -> Floats:
        """Largest L at such a speed, without the terms in `bowl`, the ball's own energy and the dashpots.

        Args:
            speed: see `speed`, shape (n,).
            time: for which it lasts [s].
            path: bound on the integral of abs(B q') along each axis, if known, shape (n, 2) [m/s²].
        """
        speed, time = speed[:, None], np.asarray(time).reshape(-1, 1)
        along = np.fmin(path, self.drive * speed * time) + 2 * self.hold * speed
        across = self.skew[:, None] * np.sqrt(1 / self.ball + self.mobility)[:, None] * speed * time
        return np.asarray(self.ball * (self.gap * (along + across)).sum(axis=1))

    def dashpot_work(self, structures: Structures, speed: Floats, time: Floats | float) -> Floats:
        """Largest integral of m s' Gamma Phi M⁻¹ C q' in L, for one mode an axis, shape (n,) [J].

        The structure's equation times s gives
        M1 ∫ s' u' dt + m ∫ s'² dt = [M1 s u' + m s s'] + ∫ s (c u' + K u + m E s) dt.
        """
        speed, time, ball = speed[:, None], np.asarray(time).reshape(-1, 1), self.ball[:, None]
        mass, stuck = structures.mass, structures.mass + ball
        ends = 2 * speed * (stuck / np.sqrt(mass) + np.sqrt(ball * stuck / mass))
        forces = speed * (structures.dashpot / np.sqrt(mass) + np.sqrt(structures.spring)) + self.pull
        return np.asarray((ball * structures.dashpot / stuck**2 * self.gap * (ends + time * forces)).sum(axis=1))


def bounds_of(rows: Parameters, structures: Structures) -> Bounds:
    """Bounds of dampers on structures."""
    gap, ball = half_gap(rows), rows["ball_mass"][:, None, None]
    pull, curve = structures.pull, structures.curve
    mass, spring, dashpot = (each[:, None, :] for each in (structures.mass, structures.spring, structures.dashpot))
    per_force = structures.shape / mass
    compliance = per_force @ structures.shape.transpose(0, 2, 1)
    gamma = np.linalg.inv(np.eye(2) + ball * compliance)
    drive = gamma @ (per_force * spring) - pull
    turned = ball * gamma @ per_force @ pull.transpose(0, 2, 1)
    even = 0.5 * (turned + turned.transpose(0, 2, 1))
    sag = ball**2 * (pull / spring) @ pull.transpose(0, 2, 1) - ball * curve
    corner = 0.5 * gap[:, :, None] * gap[:, None, :]
    leaning = rows["ball_mass"] * (np.abs(lateral_pull(rows)) * gap).sum(axis=1)
    (x, xy), y = compliance[:, 0].T, compliance[:, 1, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        damped = np.where(drive == 0, 0.0, drive**2 / dashpot).sum(axis=2)
    return Bounds(
        ball=rows["ball_mass"],
        gap=gap,
        depth=leaning + (corner * np.where(np.eye(2) > 0, np.maximum(sag, 0.0), np.abs(sag))).sum(axis=(1, 2)),
        mobility=0.5 * (x + y) + np.hypot(0.5 * (x - y), xy),
        flexibility=(structures.shape**2 / spring).sum(axis=2),
        drive=np.sqrt((drive**2 / mass).sum(axis=2)),
        hold=np.sqrt((drive**2 / spring).sum(axis=2)),
        damped=np.sqrt(damped),
        skew=0.5 * np.abs(turned[:, 0, 1] - turned[:, 1, 0]),
        bowl=leaning + (corner * ball * np.abs(curve - even)).sum(axis=(1, 2)),
        pull=(ball * np.abs(pull.transpose(0, 2, 1)) @ gap[:, :, None])[..., 0],
    )


BOOKS, ROUNDING = 1e-6, 1e-9
"""Share of the energy that went through, and of the energy that was there, which the books may leave unexplained."""

ASIDE = 1e-5
"""Share of a curve's peak that its samples may lose beside the window of a ratio, as next to the cut-off."""

EXACT = 1e-9
"""Rounding of figures, relative."""

NOT_REACHED = -1.0
"""Stands for the losses of a cycle that a sweep did not reach."""

_FINITE, _CLOSED, _INSIDE = "every figure is finite", "the energy balance closes", "the ball stays in its cavity"
_LOSSES, _WORK = "every loss removes energy", "the ball dissipates at most the work of its drive along its cavity"


class LawViolation(Exception):
    """A figure that violates a law: a defect of the program or of what it rests on.

    Attributes:
        law: the law, as a statement.
        figure: the quantity and its unit.
        value: what it is.
        bound: the largest value that it may have.
        where: the motion.
    """

    def __init__(self, law: str, figure: str, value: float, bound: float, where: str = "") -> None:
        super().__init__(law, figure, value, bound, where)
        self.law, self.figure, self.value, self.bound, self.where = law, figure, value, bound, where

    def __str__(self) -> str:
        place = f" in {self.where}" if self.where else ""
        return f"{self.law}, but {self.figure} is {self.value:.6g}, beyond the bound of {self.bound:.6g}{place}"


def require(law: str, figure: str, value: Any, bound: Any, where: Any = "") -> None:
    """Require every value to be a number within its bound.

    Args:
        law: see `LawViolation`.
        figure: see there.
        value: a number or an array.
        bound: of the same shape, or one for all.
        where: the motion, or a function that names it for an index.

    Raises:
        LawViolation: a value exceeds its bound, or is nan.
    """
    holds = value <= bound
    if np.all(holds):
        return
    index = tuple(int(k) for k in np.argwhere(~np.asarray(holds))[0])
    worst, most = (float(np.broadcast_to(each, np.shape(holds))[index]) for each in (value, bound))
    raise LawViolation(law, figure, worst, most, where(index) if callable(where) else where)


class Extremes(NamedTuple):
    """What n ring-downs reached.

    Attributes:
        kind: see `damper.motion.kinds`, shape (n,).
        excursion: largest distance of the ball from the middle of its cavity, shape (n, 2) [m].
        velocity: largest velocity maximum, shape (n,) [m/s].
        ball_energy: energy of the ball's own motion at the release [J].
        driven: whether a harmonic force acted.
    """

    kind: Integers
    excursion: Floats
    velocity: Floats
    ball_energy: float
    driven: bool


def check_ringdowns(damper: ParticleDamper, rows: Parameters, run: Any, extremes: Extremes) -> None:
    """Check the energies and extremes of ring-downs.

    Where modes couple the axes and the ball does not slip, its spin follows a hit along the other axis at once: it may
    then gain energy, which the books enter as a negative impact loss. The printed equations do not conserve energy.

    Args:
        damper: the damper that they share.
        rows: their own parameters, shape (n,).
        run: a `RingDown`, or a `Batch` of n.
        extremes: what they reached.

    Raises:
        LawViolation: a figure is impossible.
    """
    books = run.energy if isinstance(run, RingDown) else run
    structures, bounds = _bounds(damper, rows)
    losses = {name: getattr(books, name) for name in ("structure", "rolling", "impact", "slip")}
    through = sum(abs(loss) for loss in losses.values()) + abs(books.work)
    present = abs(books.initial) + abs(books.final) + bounds.depth + rows["modal_mass"] * extremes.velocity**2
    rounding, consistent = ROUNDING * (present + through), ~rows["printed"]
    count = len(extremes.kind)

    def where(index: tuple[int, ...]) -> str:
        return f"ring-down {index[0] + 1} of {count}" if count > 1 else "a ring-down"

    require(_FINITE, "energy [J]", present + through + 0 * run.duration, sys.float_info.max, where)
    spins = consistent & (rows["floor_friction"] == 0) & (rows["centrifugal_acceleration"] > 0)
    for name, loss in losses.items():
        exempt = spins & (extremes.kind == COUPLED) & (name == "impact")
        require(_LOSSES, f"energy gained from {name} [J]", -loss, np.where(exempt, np.inf, rounding), where)
    unexplained = np.where(consistent, abs(books.residual), 0.0)
    require(_CLOSED, "unexplained energy [J]", unexplained, BOOKS * through + rounding, where)
    amplitude = np.sqrt(2 * bounds.flexibility * (present + through)[:, None])
    outside = extremes.excursion - bounds.gap
    require(_INSIDE, "excursion beyond the wall [m]", outside, EXACT * (bounds.gap + amplitude), where)
    require("every hit is an event", "number of hits", run.impacts, run.events, where)
    if extremes.driven:
        return
    speed, ball = bounds.speed(books.initial + 0 * present), rows["ball_mass"]
    # Where they stand for the energy T + V of all modes: the ball may pull the structure beyond where it rests.
    pulled = np.sqrt((bounds.pull**2 / structures.spring).sum(axis=1))
    riding = np.sqrt((1 + ball * bounds.mobility) / (rows["modal_mass"] + ball)) * (speed + pulled)
    most = np.where(consistent, np.maximum(np.sqrt(bounds.mobility) * speed, riding) * (1 + EXACT), np.inf)
    require("no velocity exceeds that of the total energy", "velocity maximum [m/s]", extremes.velocity, most, where)
    if damper.modes is not None and structures.dashpot.any():
        return  # the last term of the bound on the work has no bound there
    with np.errstate(invalid="ignore"):
        path = bounds.damped * np.sqrt(run.duration * losses["structure"] + 0 * present)[:, None]
    most = bounds.work(speed, run.duration, np.where(path > 0, path, np.inf)) + extremes.ball_energy + 2 * bounds.bowl
    if damper.modes is None:
        most = most + bounds.dashpot_work(structures, speed, run.duration)
    taken = losses["rolling"] + losses["impact"] + losses["slip"]
    require(_WORK, "energy taken [J]", taken, np.where(consistent, most + rounding, np.inf), where)


def check_times(run: RingDown, longest: float) -> None:
    """Check the clock of a ring-down that lasts at most so long [s].

    Raises:
        LawViolation: time runs backwards, or a run ends at the wrong time.
    """
    require("a run ends in time", "duration [s]", run.duration, longest * (1 + EXACT))
    if run.outcome is Outcome.CYCLES_DONE:
        require("a run completes its cycles", "time left [s]", longest - run.duration, EXACT * longest)
    capped, law = run.outcome is Outcome.EVENT_CAP, "time runs forwards"
    resolved = EXACT * (run.duration + 2 * np.pi / run.damper.stuck_frequency)
    times = [run.peak_times] if run.rows is None else [run.peak_times, run.rows["time"]]
    for each in times:
        require(law, "step back in time [s]", each[:-1] - each[1:], resolved)
        if len(each) and not capped:
            require(law, "time of the last record [s]", each[-1], run.duration * (1 + EXACT))


def check_hits(run: RingDown, rows: Records) -> None:
    """Check restitution and wall friction, event by event, where the axes are not coupled.

    Raises:
        LawViolation: an event does not obey its law.
    """
    w, before, kind = abs(rows["w"]), abs(rows["w_before"]), rows["kind"]
    rests, after = rows["regime"] == STUCK, -rows["w"] * np.sign(rows["w_before"])  # along the way back

    def where(index: tuple[int, ...]) -> str:
        return f"a ring-down at {rows['time'][index[0]]:.6g} s"

    from damper.impacts import restitution_of

    e = restitution_of(run.damper.parameters, np.asarray(before, np.float64))
    error = np.where((kind == HIT) & ~rests, abs(after - e * before), 0.0)
    require("a hit leaves e times the speed", "error of the speed [m/s]", error, EXACT * before, where)
    require("wall friction slows the ball", "speed [m/s]", np.where(kind == RUB, w, 0.0), before, where)
    require("a stuck ball has no speed", "speed [m/s]", np.where(rests, w, 0.0), 0.0, where)


def check_rest(runs: Records) -> None:
    """Check that balls said to rest for good are never driven off again.

    Args:
        runs: at their ends, dtype `damper.state.FLYING`.

    Raises:
        LawViolation: the drive to come exceeds the rolling threshold.
    """
    runs = runs[np.isfinite(runs["clock"]["rest"]) & (runs["clock"]["trembles"] == 0)]
    if len(runs):
        drive = _drive_in_modes(runs)
        most = runs["ball"]["hold"][:, None] * (1 + EXACT)
        require("the load holds a ball at rest", "drive [m/s²]", drive, most, "a ring-down")


def _decay(zeta: Any) -> Any:
    """Amplitude by energy over the next crest, at most."""
    with np.errstate(divide="ignore", over="ignore"):  # next to critical damping there is no bound
        return np.exp(math.pi * zeta / np.sqrt(1 - zeta**2)) / np.sqrt(1 - zeta)


def _drive_in_modes(runs: Records) -> Floats:
    """Largest drive to come, away from the walls that balls rest on, shape (n, 2) [m/s²]."""
    system, state = runs["system"], runs["motion"]
    parts = [
        np.einsum("nij,nj->ni", system[name], state[each]) for name, each in (("deflection", "z"), ("swing", "rate"))
    ]
    swing = (system["reach"] * np.hypot(*parts)[:, None]).sum(axis=2)
    bias = system["lateral"] + (system["bias"] * state["z"][:, None]).sum(axis=2)
    place, gap = np.take_along_axis(state["z"], system["place"], axis=1), runs["axes"]["half_gap"]
    forward, back = (np.where(d * place < gap, d * bias + swing, 0.0) for d in (-1, 1))
    return cast("Floats", np.maximum(forward, back))


def check_cutoff(damper: ParticleDamper, velocity: float) -> None:
    """Check the first velocity maximum after the ball's last motion [m/s].

    Where one mode moves each axis, abs(omega² - E) A is at most the rolling threshold, plus the floor's slope where the
    ball rests: A is at most the cut-off of `damping_curve`. The cut-off of a ring-down belongs to the cycle
    before, whose decay is its resolution. A ball that keeps bouncing may have a much lower one.

    Raises:
        LawViolation: it exceeds what the load can hold.
    """
    rows, (structures, bounds) = damper.parameters, _bounds(damper, damper.parameters)
    if damper.modes is not None or damper.formulation == "printed" or kinds(damper, rows)[0] == COUPLED:
        return
    pull, curve = (np.diag(each[0]) for each in (structures.pull, structures.curve))
    omega = np.sqrt(structures.spring[0] / damper.stuck_mass)
    slope = abs(curve - damper.ball_mass * pull**2 / structures.spring[0]) * bounds.gap[0]
    with np.errstate(divide="ignore"):
        most = (damper.rolling_threshold + np.abs(damper.lateral_pull) + slope) / _drive_of_amplitude(damper)
    amplitude = np.where(bounds.gap[0] > 0, most, np.inf)
    most = math.hypot(*(omega * amplitude)) * float(_decay(damper.damping_ratio)) * (1 + BOOKS)
    require("a ball rests below the cut-off", "velocity maximum after its last motion [m/s]", velocity, most)


def _drive_of_amplitude(damper: ParticleDamper) -> Floats:
    """Drive along x and y of a ball at rest in the middle, abs(omega² - E), for one mode an axis, shape (2,) [1/s²]."""
    structures = _bounds(damper, damper.parameters)[0]
    pull = np.diag(structures.pull[0])
    return np.asarray(abs(structures.spring[0] / damper.stuck_mass - pull))


def check_rest_amplitude(damper: ParticleDamper, amplitude: float) -> None:
    """Check the cut-off of `damping_curve` [m]: there the drive that `check_cutoff` bounds is the rolling threshold.

    Raises:
        LawViolation: it is another.
    """
    if damper.modes is None:
        threshold = damper.leaving_threshold
        error = abs(_drive_of_amplitude(damper)[0] * amplitude - threshold)
        law = "at its cut-off a ball is driven by the rolling threshold"
        require(law, "error of the drive [m/s²]", error, EXACT * threshold)


def check_sweeps(damper: ParticleDamper, energies: Floats, excursion: Floats) -> None:
    """Check sweeps through the amplitudes of a structure without damping of its own.

    Args:
        damper: what was swept.
        energies: see `damper.engine.Ramp`; the losses are `NOT_REACHED` for a cycle that was not reached.
        excursion: see `Extremes`.

    Raises:
        LawViolation: an energy is impossible, or a ball left its cavity.
    """
    reached = energies[..., 3] != NOT_REACHED
    swing, left, before, lost, fed = (np.where(reached, each, 0.0) for each in np.moveaxis(energies, 2, 0))
    present = swing + abs(before)

    def where(index: tuple[int, ...]) -> str:
        amplitude = math.sqrt(2 * max(float(swing[(*index, 0)[:2]]), 0.0) / damper.stiffness[0])
        return f"a sweep {'at' if len(index) > 1 else 'from'} an amplitude of {amplitude:.3g} m"

    require(_FINITE, "energy [J]", present + abs(left) + abs(lost), sys.float_info.max, where)
    bounds = _bounds(damper, damper.parameters)[1]
    outside, amplitude = excursion - bounds.gap, np.sqrt(2 * bounds.flexibility * present.max(axis=1)[:, None])
    require(_INSIDE, "excursion beyond the wall [m]", outside, EXACT * (bounds.gap + amplitude), where)
    if damper.formulation == "printed":
        return
    taken, rounding = swing - left - fed, ROUNDING * (present + bounds.depth)
    require(_CLOSED, "unexplained energy [J]", abs(taken - lost), BOOKS * abs(lost) + rounding, where)
    speed = np.where(reached, bounds.speed(before), 0.0).sum(axis=1)
    most = bounds.work(speed, 2 * math.pi / damper.stuck_frequency) + 2 * bounds.bowl + rounding.sum(axis=1)
    require(_WORK, "energy taken [J]", taken.sum(axis=1), most, where)


def check_curve(damper: ParticleDamper, curve: DampingCurve) -> None:
    """Check the damping ratio over amplitude.

    Raises:
        LawViolation: a ratio is not below 1, or below 0 although the ball cannot feed the vibration.
    """
    amplitude, ratio = curve.amplitude, curve.damping_ratio

    def where(index: tuple[int, ...]) -> str:
        return f"a sweep at an amplitude of {amplitude[index[0]]:.3g} m"

    require("what vibrates is damped less than critically", "damping ratio", ratio, 1 - EXACT, where)
    spins = damper.floor_friction is None and damper.centrifugal_acceleration > 0
    if damper.formulation != "printed" and not (spins and kinds(damper, damper.parameters)[0] == COUPLED):
        bounds = _bounds(damper, damper.parameters)[1]
        ball = bounds.depth[0] + bounds.bowl[0]  # its energy may exceed the structure's, whose loss is a difference
        share = damper.ball_mass / damper.modal_mass + ball / (0.5 * damper.stiffness[0] * amplitude**2)
        rounding = TINY * (1 + share)
        require(_LOSSES, "negative damping ratio", -ratio, rounding, where)
    require("amplitudes ascend", "amplitude [m]", amplitude[:-1], amplitude[1:], where)


def check_readings(curve: DampingCurve, samples: Floats) -> None:
    """Check what is read off a damping curve, and its ratios by the samples that they are means of.

    Args:
        curve: the curve and its figures.
        samples: see `curve_measurement.samples_of`.

    Raises:
        LawViolation: a figure is not what it is said to be.
    """
    place, ratio, half = np.log(curve.amplitude), curve.damping_ratio, 0.5 * curve.peak
    error = abs(curve.peak - np.interp(math.log(curve.peak_amplitude), place, ratio))
    require("the peak is the damping ratio at its amplitude", "its error", error, BOOKS * curve.peak)
    inside = (curve.amplitude > curve.half[0]) & (curve.amplitude < curve.half[1])
    law, figure = "the range ends where half the peak is left", "error of the damping ratio"
    require(law, figure, np.where(inside, half - ratio, 0.0), BOOKS * half)
    for end, last in zip(curve.half, (0, -1), strict=True):
        if end != curve.amplitude[last]:
            require(law, figure, abs(np.interp(math.log(end), place, ratio) - half), BOOKS * half)
    before, after = samples[:, 0], samples[:, 1]
    order = np.argsort(before + after)
    middle, lost = 0.5 * (before + after)[order], (before - after)[order] / (2 * math.pi)
    reach = math.log(2) / BINS + 0.5 * abs(before - after).max()
    near = np.column_stack([np.searchsorted(middle, place - reach), np.searchsorted(middle, place + reach)]).ravel()
    least, most = (each.reduceat(np.append(lost, lost[-1]), near)[::2] for each in (np.minimum, np.maximum))
    law, aside = "a mean lies between the extremes", TINY + ASIDE * curve.peak
    require(law, "damping ratio", ratio, most + EXACT * abs(most) + aside)
    lasts = curve.descending.amplitude.min(initial=math.inf)
    rests = (ratio == 0) & (curve.amplitude < lasts)  # see `curves.grown`
    require(law, "negative damping ratio", -ratio, np.where(rests, 0.0, -least + EXACT * abs(least) + aside))


def check_steady_states(m: Motions, figures: dict[str, Any]) -> None:
    """Check motions under a harmonic force.

    In a cycle of length T in which the probe u covers 2 a, a force F cos(nu t + phi) along it puts in at most 4 F a,
    and F times the drift of u; dashpots take c times the integral of u'², at least (4 a)² c / T where the motion
    repeats itself every cycle, and (2 a)² c / T in any case (Cauchy and Schwarz).

    Args:
        m: the motions, n of them.
        figures: fields of `damper.Forced`, each of shape (n,).

    Raises:
        LawViolation: a figure is impossible.
    """
    run, trace = m.runs["run"], m.runs["envelope"]
    system, gap, period, verdict = run["system"], run["axes"]["half_gap"], trace["period"], trace["verdict"]
    ended, locked, periodic = verdict != TIRED, verdict == LOCKED, verdict == PERIODIC
    repeats = periodic & (m.runs["window"]["impacts"] > 0)  # a ball that hits nothing may creep all the while
    least, mean, rms, most = (np.where(ended, figures[name], 0.0) for name in ("least", "mean", "rms", "greatest"))
    put_in, lost, stored = (np.where(ended, figures[name], 0.0) for name in ("power_in", "power_lost", "stored"))

    def where(index: tuple[int, ...]) -> str:
        k = index[0]
        return f"a {figures['regime'][k]} motion at {2 * math.pi / period[k]:.6g} rad/s, {k + 1} of {len(mean)}"

    through = abs(put_in) + abs(lost) + abs(stored)
    require(_FINITE, "power [W] and amplitude [m]", through + most, sys.float_info.max, where)
    swing = run["ball"]["host_mass"] * rms**2 + run["ball"]["mass"] * (run["axes"]["excursion"] ** 2).sum(axis=1)
    rounding = ROUNDING * swing * (2 * math.pi / period) ** 2 / period
    unexplained = abs(put_in - lost - stored)
    require(_CLOSED, "unexplained power [W]", unexplained, BOOKS * through + rounding, where)
    require(_LOSSES, "power gained [W]", -lost, rounding, where)
    outside = run["axes"]["excursion"] - gap
    require(_INSIDE, "excursion beyond the wall [m]", outside, EXACT * (gap + most[:, None]), where)
    for low, high in ((least, mean), (mean, rms), (rms, most)):
        require("means lie between the extremes", "amplitude [m]", low, high * (1 + EXACT), where)
    probe, force = trace["probe"], system["power"]
    height = abs((force * probe).sum(axis=1) / (probe**2).sum(axis=1))
    along = (abs(abs(force) - height[:, None] * abs(probe)) <= EXACT * height[:, None]).all(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        cycles = np.where(repeats | locked, np.inf, m.runs["window"]["cycles"])
        power = np.where(along, height * (4 * mean + 2 * most / cycles) / period, np.inf)
        compliance = np.where(probe == 0, 0.0, probe**2 / system["dashpot"][:, 0]).sum(axis=1)
        ways = np.where(locked | (repeats & (figures["repeats"] == 1)), 4.0, 2.0)
        amplitude = np.where(compliance < np.inf, np.sqrt(lost * compliance) * period / ways, np.inf)
    power = np.where(np.isnan(power), np.inf, power)  # nothing is known of a motion that took all its events
    require("a force works along its displacement", "power put in [W]", put_in, power * (1 + BOOKS) + rounding, where)
    floor = EXACT * (most + run["axes"]["excursion"].max(axis=1))
    require("the power lost bounds the amplitude", "rms amplitude [m]", rms, amplitude * (1 + BOOKS) + floor, where)


@lru_cache(maxsize=64)
def _own_bounds(damper: ParticleDamper) -> tuple[Structures, Bounds]:
    structures = structures_by(damper, damper.parameters)
    return structures, bounds_of(damper.parameters, structures)


def _bounds(damper: ParticleDamper, rows: Parameters) -> tuple[Structures, Bounds]:
    """Structures and bounds, one for each row, or one for all where they are equal."""
    if rows is damper.parameters or (alike(rows) and rows[:1].tobytes() == damper.parameters.tobytes()):
        return _own_bounds(damper)
    structures = structures_by(damper, rows)
    return structures, bounds_of(rows, structures)
