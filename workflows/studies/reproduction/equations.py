"""Sections I and II: rolling and sliding, impacts, sticking, time steps, the measure of damping."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from workflows.studies.reproduction.claims import FORMULATIONS, RELEASE, SHOWN, Claim, Simulated, Verdict, judge

_CYCLES = 20


def claims(study: Simulated) -> Iterator[Claim]:
    """The claims of sections I and II."""
    yield _sliding(study)
    yield _threshold(study)
    yield from _impacts(study)
    yield _sticking(study)
    yield _steps(study)
    yield _balance(study)
    yield _energy(study)
    yield _rotation(study)


def _sliding(study: Simulated) -> Claim:
    demands = [[p.damping.largest_rolling_demand or 0.0 for p in study.points[f] if p.damping] for f in FORMULATIONS]
    friction = study.scene.damper.friction if study.scene.damper else 0.0
    return Claim(
        "S1-rolls",
        "I",
        "Under the load the particle cannot slide; it rolls.",
        "sliding friction is very high",
        max(demands[0]),
        max(demands[1]),
        judge(max(demands[1]) <= friction, partly=min(demands[1]) <= friction),
        "Friction over load that rolling without slip needs, at the speed where it needs most; at the lowest loads that"
        f" is more than the {friction:g} the paper gives for wall hits.",
    )


def _threshold(study: Simulated) -> Claim:
    from damper import ringdown

    ratios = []
    for formulation in FORMULATIONS:
        system = study.system(formulation, damping_ratio=0.0)
        square = system.stuck_frequency**2
        amplitude = system.rolling_threshold / square
        still = ringdown(system, (amplitude * (1 - 1e-9), 0.0), 3).events == 0
        moves = ringdown(system, (amplitude * (1 + 1e-6), 0.0), 3).events > 0
        ratios.append(amplitude * square / system.centrifugal_acceleration if still and moves else math.nan)
    return Claim(
        "S2-threshold",
        "II.A, cases 1 and 2",
        "The particle sticks until its inertia force exceeds the force of rolling friction, then rolls.",
        "μ_r/r = 0.1 of the load",
        ratios[0],
        ratios[1],
        judge(all(abs(ratio / 0.1 - 1) < 1e-9 for ratio in ratios)),
        "Released just below, nothing happens; just above, the ball sets off.",
    )


def _impacts(study: Simulated) -> Iterator[Claim]:
    momentum, restitution, losses, caps = zip(*(_hits(study, f) for f in FORMULATIONS), strict=True)
    where = "II.B"
    yield Claim(
        "S2-momentum",
        f"{where}, eqs. (6), (7), (10)",
        "Wall hits conserve linear momentum along both axes.",
        "0",
        momentum[0],
        momentum[1],
        judge(max(momentum) < 1e-9),
        "Largest change of momentum over the ball's, in 40 oblique hits.",
    )
    yield Claim(
        "S2-restitution",
        f"{where}, eqs. (8), (10)",
        "Hits multiply the normal relative velocity by -e.",
        "0.5",
        restitution[0],
        restitution[1],
        judge(max(abs(r - 0.5) for r in restitution) < 1e-9),
        "Speed after over before, the value farthest from e in 40 oblique hits.",
    )
    yield Claim(
        "S2-cap",
        f"{where}, eq. (11)",
        "With its sign and its cap, impact friction never adds energy.",
        "≥ 0 J",
        losses[0],
        losses[1],
        judge(min(losses) >= 0),
        f"Smallest loss in a hit; {caps[1]} of the oblique hits reach the cap, where sliding ends.",
    )


def _hits(study: Simulated, formulation: str) -> tuple[float, float, float, int]:
    """Over single oblique hits: worst momentum, restitution farthest from e, least loss, hits at the cap."""
    from damper import ringdown, sample

    base = study.system(formulation, centrifugal_acceleration=0.0, damping_ratio=0.0, stiffness=(1e-9, 1e-9))
    m2, ball, gap = base.modal_mass, base.ball_mass, base.half_gap[0]
    system = replace(base, cavity=(base.cavity[0], 1.0), sticking_ratio=0.0)
    worst, farthest, least, capped = 0.0, base.restitution, math.inf, 0
    for angle in np.linspace(0.02, 1.5, 40):
        w = (math.cos(angle), math.sin(angle))
        duration = 1.5 * gap / w[0]
        cycles = duration * system.stuck_frequency / (2 * math.pi)
        run = ringdown(system, (0.0, 0.0), cycles, ball_velocity=w, keep_events=True)
        end = sample(run, run.duration)
        after, v = end.relative_velocity[0], end.velocity[0]
        for axis in range(2):
            worst = max(worst, abs(m2 * v[axis] + ball * (v[axis] + after[axis]) - ball * w[axis]) / ball)
        ratio = -after[0] / w[0]
        if abs(ratio - base.restitution) > abs(farthest - base.restitution):
            farthest = float(ratio)
        least = min(least, run.energy.impact)
        capped += abs(after[1]) < 1e-9
    return worst, farthest, least, capped


def _sticking(study: Simulated) -> Claim:
    from damper import capacity, ringdown

    changes, fewer = [], []
    for formulation in FORMULATIONS:
        runs = [
            ringdown(study.system(formulation, sticking_ratio=epsilon), RELEASE, _CYCLES) for epsilon in (1e-2, 1e-6)
        ]
        loss = [1 - run.energy.final / run.energy.initial for run in runs]
        part = [float(capacity(run).sdc.mean()) for run in runs]
        changes.append(abs(part[0] / part[1] - 1) if loss[1] else math.nan)
        fewer.append(1 - runs[0].impacts / runs[1].impacts)
    return Claim(
        "S2-epsilon",
        "II.A",
        "Sticking below a relative velocity of ε = 0.01 changes the damping negligibly and saves many impacts.",
        "negligible error, appreciably fewer impacts",
        changes[0],
        changes[1],
        judge(max(changes) < 1e-2 and min(fewer) > 0.1, partly=max(changes) < 1e-2),
        f"Relative change of the damping against ε = 1e-6; {100 * fewer[1]:.0f} % of the impacts are saved.",
    )


def _steps(study: Simulated) -> Claim:
    from damper import capacity, ringdown, stepped_ringdown

    found, exact = [], []
    for formulation in FORMULATIONS:
        system = study.system(formulation, damping_ratio=0.0)
        exact.append(float(capacity(ringdown(system, RELEASE, _CYCLES)).sdc.mean()))
        found.append(float(stepped_ringdown(system, RELEASE, _CYCLES, 40).sdc.mean()))
    return Claim(
        "S2-steps",
        "II.B",
        "40 time steps in a vibration cycle track particle and structure accurately.",
        "accurate",
        100 * found[0],
        100 * found[1],
        judge(all(abs(f / e - 1) < 0.1 for f, e in zip(found, exact, strict=True))),
        f"Damping by the ball in % a cycle with 40 steps; exact events give {100 * exact[0]:.2g} (printed, which gains"
        f" energy) and {100 * exact[1]:.2g} (consistent). The step makes damping of its own.",
    )


def _balance(study: Simulated) -> Claim:
    shares = []
    for formulation in FORMULATIONS:
        damping = study.points[formulation][SHOWN].damping
        energy = damping.energy if damping else None
        shares.append(energy.impact / (energy.impact + energy.rolling) if energy else math.nan)
    return Claim(
        "S2-measure",
        "II.C, eq. (12)",
        "The damping capacity is the energy dissipated in the impacts of a cycle over its maximum energy.",
        "1",
        shares[0],
        shares[1],
        judge(shares[1] > 0.99, partly=shares[1] > 0.1),
        "Share of the impacts in what the ball takes at 21932 g; rolling friction takes the rest. The velocities by"
        " which the paper evaluates eq. (12) count that too, and the structure's own damping.",
    )


def _energy(study: Simulated) -> Claim:
    from damper import ringdown

    gains = []
    for formulation in FORMULATIONS:
        energy = ringdown(study.system(formulation, damping_ratio=0.0), RELEASE, _CYCLES).energy
        gains.append(100 * (energy.final / energy.initial - 1))
    return Claim(
        "S2-energy",
        "II.A, eqs. (2)-(4)",
        "Without damping of its own the structure loses energy to the ball.",
        "a loss",
        gains[0],
        gains[1],
        judge(max(gains) < 0, partly=gains[1] < 0),
        "Change of energy in %, 20 cycles at 21932 g with ζ = 0: as printed, the equations leave out the reaction of"
        " the ball's inertia and make energy.",
    )


def _rotation(study: Simulated) -> Claim:
    from damper import ringdown

    base = study.system("consistent", damping_ratio=0.0)
    losses = []
    for system in (base, replace(base, floor_friction=base.friction)):
        energy = ringdown(system, RELEASE, _CYCLES).energy
        losses.append(1 - energy.final / energy.initial)
    change = losses[1] / losses[0] - 1
    return Claim(
        "S2-rotation",
        "II.B",
        "The particle's rotation does not enter the impacts, since it is not in the plane of vibration.",
        "0",
        None,
        change,
        Verdict.NOT if abs(change) > 0.01 else Verdict.REPRODUCED,
        "Relative change of the ball's damping when the spin is kept in a hit, as the floor's finite force requires,"
        " and the ball slips until it rolls again.",
    )
