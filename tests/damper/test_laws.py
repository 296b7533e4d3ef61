"""Every law lets sound figures pass, and none that violates it."""

import math
import pickle
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from damper import (
    Formulation,
    Harmonic,
    LawViolation,
    Mode,
    ParticleDamper,
    RingDown,
    Start,
    capacity,
    curve_measurement,
    curves,
    damping_curve,
    engine,
    forced,
    laws,
    ringdown,
    ringdowns,
    self_check,
    steady_state,
    work_bound,
)
from damper.curves import DampingCurve, at_bin
from damper.equations import structures_by
from damper.laws import bounds_of
from damper.motion import APART
from damper.state import HIT, RUB, STUCK, TIRED
from tests.benchmarks.broken_kernels import ROOT, breaks
from tests.compiler import needs_compiler
from tests.damper.scenes import paper
from tests.damper.test_linear import scene

DAMPER = paper()
RELEASE = (20e-3, 5e-3)
MOTION = ringdown(DAMPER, RELEASE, 20, keep_events=True)
EXTREMES = laws.Extremes(
    np.array([APART]), np.array([DAMPER.half_gap]), np.array([MOTION.peak_velocities.max()]), 0.0, False
)
Figures = tuple[ParticleDamper, RingDown, laws.Extremes]


def energy(**changes: float) -> Callable[[Figures], Figures]:
    """Shares of the initial energy, added to the books."""

    def change(figures: Figures) -> Figures:
        damper, run, extremes = figures
        books = run.energy
        moved = {name: getattr(books, name) + share * books.initial for name, share in changes.items()}
        return damper, replace(run, energy=replace(books, **moved)), extremes

    return change


def reached(name: str, factor: float) -> Callable[[Figures], Figures]:
    return lambda f: (f[0], f[1], f[2]._replace(**{name: factor * getattr(f[2], name)}))


def narrow(figures: Figures) -> Figures:
    """The same losses in a cavity a hundredth as long and wide."""
    damper, run, extremes = figures
    damper = replace(damper, cavity=tuple(2 * damper.ball_radius + 0.02 * gap for gap in damper.half_gap))
    return damper, replace(run, damper=damper), extremes._replace(excursion=0 * extremes.excursion)


VIOLATIONS = {
    "every figure is finite": energy(impact=math.nan),
    "energy gained from impact": energy(impact=-0.01, final=0.01),
    "energy gained from rolling": energy(rolling=-0.01, final=0.01),
    "energy balance closes": energy(final=1e-7),
    "excursion beyond the wall": reached("excursion", 1 + 1e-4),
    "every hit is an event": lambda f: (f[0], replace(f[1], impacts=f[1].events + 1), f[2]),
    "no velocity exceeds": reached("velocity", 1.01),
    "at most the work of its drive": narrow,
}


@pytest.mark.parametrize("said", VIOLATIONS)
def test_impossible_ring_downs(said: str) -> None:
    sound: Figures = DAMPER, MOTION, EXTREMES
    laws.check_ringdowns(DAMPER, DAMPER.parameters, *sound[1:])
    damper, *wrong = VIOLATIONS[said](sound)
    with pytest.raises(LawViolation, match=said):
        laws.check_ringdowns(damper, damper.parameters, *wrong)


def test_what_the_broken_kernels_break_is_there() -> None:
    for each in breaks():
        for file, right, _ in each.changes:
            assert right in (ROOT / file).read_text(encoding="utf-8"), (each.name, file)


def test_the_printed_equations_have_no_books() -> None:
    damper = replace(DAMPER, formulation=Formulation.PRINTED)
    run = ringdown(damper, RELEASE, 20)
    assert abs(run.energy.residual) > 0.01 * run.energy.initial
    with pytest.raises(LawViolation, match="stays in its cavity"):
        laws.check_ringdowns(damper, damper.parameters, run, reached("excursion", 1.01)((damper, run, EXTREMES))[2])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"duration": MOTION.duration * 1.01}, "ends in time"),
        ({"duration": MOTION.duration * 0.99}, "completes its cycles"),
        ({"peak_times": MOTION.peak_times[::-1]}, "time runs forwards"),
        ({"peak_times": MOTION.peak_times + MOTION.duration}, "time of the last record"),
        ({"rows": MOTION.rows[::-1]}, "time runs forwards"),
    ],
)
def test_impossible_times(changes: dict[str, Any], said: str) -> None:
    laws.check_times(MOTION, MOTION.duration)
    with pytest.raises(LawViolation, match=said):
        laws.check_times(replace(MOTION, **changes), MOTION.duration)


def test_impossible_hits() -> None:
    laws.check_hits(MOTION, MOTION.rows)
    hits = (MOTION.rows["kind"] == HIT) & (MOTION.rows["w"] != 0)
    for name, value, said in (
        ("w_before", 1.001 * MOTION.rows["w_before"][hits], "leaves e times the speed"),
        ("regime", STUCK, "stuck ball has no speed"),
    ):
        wrong = MOTION.rows.copy()
        wrong[name][hits] = value
        with pytest.raises(LawViolation, match=said):
            laws.check_hits(MOTION, wrong)
    rubs = MOTION.rows[hits][:1].copy()
    rubs["kind"], rubs["w"] = RUB, 1.001 * rubs["w_before"]
    with pytest.raises(LawViolation, match="wall friction slows the ball"):
        laws.check_hits(MOTION, rubs)


@needs_compiler
@pytest.mark.parametrize("tilt", [(0.0, 0.0), (6.0, 0.0)])
def test_a_ball_said_to_rest_that_is_driven_off(tilt: tuple[float, float], monkeypatch: pytest.MonkeyPatch) -> None:
    damper, seen = replace(DAMPER, floor_tilt=tilt, damping_ratio=0.01), []
    monkeypatch.setattr(laws, "check_rest", lambda runs: seen.append(runs.copy()))
    assert ringdown(damper, RELEASE).rested
    monkeypatch.undo()
    runs = seen[0]  # a self-check may have come after it
    laws.check_rest(runs)
    for name in ("z", "rate"):
        runs["motion"][name] *= 2
    with pytest.raises(LawViolation, match="holds a ball at rest"):
        laws.check_rest(runs)


@needs_compiler
def test_cut_off_of_a_ring_down_and_of_the_sweeps() -> None:
    """The velocity maximum after the last motion is just below what the sweeps' cut-off gives, not above."""
    damper = replace(DAMPER, damping_ratio=1e-3)
    run, amplitude = ringdown(damper, (16e-3, 0.0)), damping_curve(damper, sweeps=2, stay=4).cutoff
    found = capacity(run)
    assert found.cutoff == pytest.approx(amplitude * damper.stuck_frequency**2, rel=0.02)
    laws.check_cutoff(damper, 0.999 * amplitude * damper.stuck_frequency)
    with pytest.raises(LawViolation, match="rests below the cut-off"):
        laws.check_cutoff(damper, math.sqrt(2) * 1.01 * amplitude * damper.stuck_frequency)  # both axes may move
    early = replace(run, last_motion=0.5 * run.peak_times[1])
    with pytest.raises(LawViolation, match="rests below the cut-off"):
        capacity(early)


def test_the_bound_on_the_work_is_that_of_a_cycle() -> None:
    """At the speed of a sinusoid it is pi / 2 times the work bound to leading order, and the tilt takes its share."""
    for damper in (replace(DAMPER, ball_mass=1e-6), replace(DAMPER, ball_mass=1e-6, floor_tilt=(6.0, 0.0))):
        bounds = bounds_of(damper.parameters, structures_by(damper, damper.parameters))
        energies, amplitude = np.array([0.5 * damper.stiffness[0] * 1e-4**2]), 1e-4
        period, speed = 2 * math.pi / damper.stuck_frequency, bounds.speed(energies)
        ends = bounds.work(speed, 0.0)
        along_y = replace(damper, cavity=(2 * damper.ball_radius, damper.cavity[1]))
        other = bounds_of(along_y.parameters, structures_by(along_y, along_y.parameters))
        cycle = bounds.work(speed, period) - ends - (other.work(speed, period) - other.work(speed, 0.0))
        expected = 0.5 * math.pi * work_bound(damper, (amplitude, 0.0)) * energies
        np.testing.assert_allclose(cycle, expected, rtol=1e-4)


SWEPT = replace(DAMPER, damping_ratio=0.0)


@pytest.fixture(scope="module")
def energies() -> np.ndarray:
    seen = []
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(laws, "check_sweeps", lambda damper, energies, excursion: seen.append(energies.copy()))
        damping_curve(SWEPT, sweeps=2, stay=4)
    return seen[-1]


@needs_compiler
@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda e: e.__setitem__((0, 3, 0), math.nan), "every figure is finite"),
        (lambda e: e.__setitem__((0, 3, 3), math.nan), "every figure is finite"),
        (lambda e: e.__setitem__((0, 3, 3), 1.001 * e[0, 3, 3]), "energy balance closes"),
    ],
)
def test_impossible_sweeps(energies: np.ndarray, change: Callable[[np.ndarray], object], said: str) -> None:
    inside = np.array([DAMPER.half_gap] * 2)
    laws.check_sweeps(SWEPT, energies, inside)
    wrong = energies.copy()
    change(wrong)
    with pytest.raises(LawViolation, match=said):
        laws.check_sweeps(SWEPT, wrong, inside)


@needs_compiler
def test_a_sweep_that_takes_too_much(energies: np.ndarray) -> None:
    """Twenty times what the ball takes, in books that close; and a ball beyond its wall."""
    inside, wrong = np.array([DAMPER.half_gap] * 2), energies.copy()
    wrong[..., 1] -= 19 * (wrong[..., 0] - wrong[..., 1])
    wrong[..., 3] *= np.where(wrong[..., 3] > 0, 20, 1)
    with pytest.raises(LawViolation, match=r"energy taken \[J\].* in a sweep"):
        laws.check_sweeps(SWEPT, wrong, inside)
    with pytest.raises(LawViolation, match="excursion beyond the wall"):
        laws.check_sweeps(SWEPT, energies, 1.0001 * inside)


@needs_compiler
def test_impossible_damping_ratios() -> None:
    curve = damping_curve(DAMPER, sweeps=2, stay=30)
    laws.check_curve(DAMPER, curve)
    for ratio, said in ((curve.damping_ratio + 1.0, "less than critically"), (-curve.damping_ratio, "every loss")):
        with pytest.raises(LawViolation, match=f"{said}.* at an amplitude of "):
            laws.check_curve(DAMPER, replace(curve, damping_ratio=ratio))
    with pytest.raises(LawViolation, match="amplitudes ascend"):
        laws.check_curve(DAMPER, replace(curve, amplitude=curve.amplitude[::-1]))
    laws.check_curve(
        replace(DAMPER, formulation=Formulation.PRINTED), replace(curve, damping_ratio=-curve.damping_ratio)
    )


def halved(curve: Callable[..., Any]) -> Callable[..., Any]:
    def wrong(*given: Any) -> tuple[Any, Any]:
        amplitude, ratio = curve(*given)
        return amplitude, 0.5 * ratio

    return wrong


def one_bin_off(half: Callable[..., float]) -> Callable[..., float]:
    def wrong(amplitude: Any, ratio: Any, best: int, step: int) -> float:
        end = half(amplitude, ratio, best, step)
        return float(amplitude[min(np.argmin(abs(amplitude - end)) + step, len(amplitude) - 1)])

    return wrong


@needs_compiler
@pytest.mark.parametrize(
    ("name", "broken", "law", "figure"),
    [
        ("_points", halved, "a mean lies between the extremes", "peak"),
        ("_half", one_bin_off, "the range ends where half the peak is left", "half above"),
    ],
)
def test_a_curve_read_wrongly(
    name: str, broken: Callable[..., Any], law: str, figure: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A law knows, and so does the self-check without it."""
    damping_curve(DAMPER, sweeps=2, stay=30)
    monkeypatch.setattr(curves, name, broken(getattr(curves, name)))
    with pytest.raises(LawViolation, match=law):
        damping_curve(DAMPER, sweeps=2, stay=30)
    monkeypatch.setattr(laws, "check_readings", lambda *_: None)
    wrong = [line.figure for line in self_check.lines("curves", damping_curve) if line.error > self_check.EXACT]
    assert wrong.count(figure) == len(self_check.FAMILIES["curves"])


@needs_compiler
def test_a_damping_ratio_of_rounding_breaks_no_law() -> None:
    """A ball that loses nothing: samples one last bit below zero, and their mean two."""
    curve = damping_curve(DAMPER, sweeps=2, stay=30)
    samples = curve_measurement.samples_of(DAMPER, 0.5 * curve.amplitude[0], 2 * curve.amplitude[-1], 8, 300, 1)
    low = 0.01 * curve.amplitude[0]
    before = math.log(low) + np.linspace(-0.05, 0.05, 20)
    idle = np.column_stack([before, np.nextafter(before, 0), np.zeros(20)])
    samples = np.vstack([samples, idle])
    for share, holds in ((-2.0, True), (-1e11, False)):
        place = np.append(low, curve.amplitude)
        ratio = np.append(share * np.spacing(abs(math.log(low))) / (2 * math.pi), curve.damping_ratio)
        with nullcontext() if holds else pytest.raises(LawViolation, match="a mean lies between the extremes"):
            laws.check_readings(replace(curve, amplitude=place, damping_ratio=ratio), samples)


@needs_compiler
def test_nothing_is_promised_where_no_loss_lasts_and_that_breaks_no_law() -> None:
    """Of 60 balls of 1 mm in a fan blade at 1500 rpm, which rotation draws to a wall where the sweeps down leave them.

    Below that the sweeps up lose something on their way there, which the curve does not count. A zero elsewhere is
    refused.
    """
    flap = Mode(1.0, 446977.0, (-3.11227, -1.2e-4), (-24.1265, 2.04617))
    twist = Mode(1.0, 6.3136e6, (1.57064, -1.80976), (65.0592, -27.3614))
    damper = replace(
        ParticleDamper(0.10324, (46145.6, 652842.0), 2.46615e-4, 5e-4, (1.8e-3,) * 2, 7899.57, 0.6, 0.2, 1e-6),
        rotation=157.08,
        stagger=0.798578,
        modes=(flap, twist),
    )
    curve = damping_curve(damper, sweeps=4, stay=60, reach=5e-4)
    rests = curve.amplitude < curve.descending.amplitude[0]
    assert rests.sum() > 2
    assert not curve.damping_ratio[rests].any()
    at = np.geomspace(1e-3, 4e-3, 25)
    lost = np.interp(at, [1e-3, 1.5e-3, 2e-3, 4e-3], [1e-4, 1e-3, 8e-4, 1e-4])
    above = DampingCurve(at[3:], lost[3:], 0.0, 0.0, 0.0, (0.0, 0.0), 0.0, 0.0)
    samples = np.column_stack([np.log(at) + math.pi * lost, np.log(at) - math.pi * lost, np.zeros(25)])
    for zeros, holds in ((at < at[3], True), (at > at[-2], False)):
        read = at_bin(replace(above, amplitude=at, damping_ratio=np.where(zeros, 0.0, lost), from_above=above), 7)
        with nullcontext() if holds else pytest.raises(LawViolation, match="negative damping ratio is -0"):
            laws.check_readings(read, samples)


@needs_compiler
def test_a_cutoff_that_the_load_does_not_have(monkeypatch: pytest.MonkeyPatch) -> None:
    """Were the tilt to push the ball where it pulls."""
    damper, right = replace(DAMPER, floor_tilt=(6.0, 0.0)), ParticleDamper.tilt_share
    damping_curve(damper, sweeps=2, stay=30)
    monkeypatch.setattr(ParticleDamper, "tilt_share", property(lambda d: tuple(-share for share in right.fget(d))))
    with pytest.raises(LawViolation, match="at its cut-off a ball is driven by the rolling threshold"):
        damping_curve(damper, sweeps=2, stay=30)
    monkeypatch.setattr(laws, "check_rest_amplitude", lambda *_: None)
    wrong = {line.figure for line in self_check.lines("curves", damping_curve) if line.error > self_check.EXACT}
    assert "cut-off" in wrong


DRIVEN = replace(DAMPER, damping_ratio=0.02)
PUSH = Harmonic(DRIVEN.stuck_frequency, (3e3, 0.0))


@needs_compiler
@pytest.mark.parametrize(
    ("name", "factor", "said"),
    [
        ("power_lost", 1.00001, "energy balance closes"),
        ("power_lost", math.nan, "every figure is finite"),
        ("mean", 1.1, "means lie between"),
        ("least", 1.1, "means lie between"),
        (("least", "mean", "rms", "greatest"), 0.7, "works along its displacement"),
        (("least", "mean", "rms", "greatest"), 1.2, "the power lost bounds the amplitude"),
        (("power_in", "power_lost", "stored"), 1.5, "works along its displacement"),
        (("power_in", "power_lost", "stored"), -1.0, "every loss removes energy"),
    ],
)
def test_impossible_steady_states(
    name: str | tuple[str, ...], factor: float, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    names, summary = (name,) if isinstance(name, str) else name, steady_state.summary

    def wrong(*given: Any) -> dict[str, Any]:
        figures = summary(*given)
        return figures | {each: factor * figures[each] for each in names}

    assert forced(DRIVEN, [PUSH]).mean.all()
    monkeypatch.setattr(steady_state, "summary", wrong)
    with pytest.raises(LawViolation, match=f"{said}.* motion at "):
        forced(DRIVEN, [PUSH])


@needs_compiler
def test_a_motion_that_was_given_up_has_no_books(monkeypatch: pytest.MonkeyPatch) -> None:
    summary = steady_state.summary

    def tired(m: Any, divergence: Any) -> dict[str, Any]:
        m.runs["envelope"]["verdict"] = TIRED
        return summary(m, divergence)

    monkeypatch.setattr(steady_state, "summary", tired)
    assert np.isnan(forced(DRIVEN, [PUSH]).power_in).all()


@needs_compiler
def test_wrong_energies_leave_no_public_call(monkeypatch: pytest.MonkeyPatch) -> None:
    right, each = engine.run_block, np.ones(1)

    def run_block(block: tuple[int, int], runs: Any, *others: Any) -> None:
        right(block, runs, *others)
        if block[1] == len(runs):
            runs["books"]["final"] *= 1 + 1e-6 * each

    monkeypatch.setattr(engine, "run_block", run_block)
    with pytest.raises(LawViolation, match=r"energy balance closes.* in a ring-down$"):
        ringdown(DAMPER, RELEASE, 20)
    each = np.arange(3)
    with pytest.raises(LawViolation, match="in ring-down 2 of 3"):
        ringdowns(DAMPER, [RELEASE] * 3, 20)


@needs_compiler
@pytest.mark.parametrize("seed", range(8))
def test_random_dampers_obey(seed: int) -> None:
    """Sweeps and steady states of dampers of every kind; ring-downs of as many are in other tests."""
    damper, _, harmonic = scene(seed)
    damping_curve(damper, sweeps=2, stay=6)
    push = harmonic or Harmonic(damper.stuck_frequency, (0.05, 0.0))
    forced(replace(damper, damping_ratio=max(damper.damping_ratio, 0.02)), [push], [Start.DOWN], max_cycles=256)


def test_spin_that_follows_a_hit_along_the_other_axis_is_no_violation() -> None:
    """Where a mode moves the cavity along both axes and nothing slips, hits feed the spin: a loss below zero."""
    skew = (Mode(1.0, 1.0, (1.0, 0.8)), Mode(1.0, 3.0, (0.3, 1.0)))
    damper = ParticleDamper(1.0, (1.0, 1.0), 0.3, 1.0, (2.4, 2.4), 1.0, 1.0, modes=skew)
    books = ringdown(damper, (0.0, 0.0), 3, amplitudes=(1.0, 0.4)).energy
    assert books.impact < 0
    assert abs(books.residual) < 1e-12 * books.initial


def test_a_ball_on_a_slope_pulls_the_structure_beyond_where_it_rests() -> None:
    """Its potential energy on the tilting floor feeds the vibration: energies T + V above that of the release."""
    damper = ParticleDamper(
        4.0987, (19130.5, 57388.9), 0.18893, 6.1195e-4, (3.6522e-3, 8.5087e-3), 44058.6, 0.9, 0.0, 0.0, 0.001,
        floor_tilt=(0.15896, 0.15896),
    )  # fmt: skip
    angle = np.linspace(0.0, 2 * math.pi, 60)
    release = 1.7e-4 * np.column_stack([np.cos(angle), np.sin(angle)])
    run = ringdowns(damper, release, 25)
    through = run.structure + run.rolling + run.impact
    assert np.abs(run.residual).max() < 1e-12 * through.max()


def test_rounding_of_a_ball_whose_energy_exceeds_that_of_the_structure_is_no_violation() -> None:
    """At small amplitudes the ball's energy in its hollow is thousands of times the vibration's."""
    gap, radius, floor = (1.927e-4, 1.054e-4), 0.07681, 0.2504
    damper = ParticleDamper(
        935.39, (6.5363e11, 2.3592e12), 172.74, radius, (2 * radius + gap[0], 2 * radius + gap[1]), 3.3283e8, 0.98649,
        0.0364, floor_radius=(floor, floor),
    )  # fmt: skip
    curve = damping_curve(damper, sweeps=4, stay=20)
    ball = damper.ball_mass * damper.centrifugal_acceleration * (gap[0] / 2) ** 2 / (2 * (floor - radius))
    share = ball / (0.5 * damper.stiffness[0] * curve.amplitude**2)
    assert share.max() > 1e3
    laws.check_curve(damper, replace(curve, damping_ratio=-1e-14 * share))
    with pytest.raises(LawViolation, match="removes energy"):
        laws.check_curve(damper, replace(curve, damping_ratio=-1e-10 * share))


def test_a_violation_says_all_and_travels() -> None:
    error = LawViolation("the books close", "energy [J]", 2.0, 1e-3, "a sweep")
    error.add_note("at 3000 rpm")
    there = pickle.loads(pickle.dumps(error))
    assert str(there) == "the books close, but energy [J] is 2, beyond the bound of 0.001 in a sweep"
    assert there.__notes__ == ["at 3000 rpm"]
    with pytest.raises(LawViolation, match="nan"):
        laws.require("a law", "figure", math.nan, 1.0)
