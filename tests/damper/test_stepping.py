"""The paper's fixed-step algorithm: it tends to the exact events, and how slowly."""

import numpy as np
import pytest

from damper import Formulation, ringdown, sample, stepped_ringdown
from tests.compiler import needs_compiler
from tests.damper.scenes import paper

RELEASE = (20e-3, 5e-3)


@needs_compiler
@pytest.mark.parametrize("formulation", list(Formulation))
def test_first_order(formulation: Formulation) -> None:
    """Events noticed at the end of a step are late by half a step on average: the error falls with the step."""
    damper = paper(formulation=formulation)
    run = ringdown(damper, RELEASE, 20)
    exact = run.energy.final / run.energy.initial
    errors = []
    steps = [2560, 5120, 10240, 20480, 40960]
    for n in steps:
        stepped = stepped_ringdown(damper, RELEASE, 20, n)
        errors.append(abs(stepped.final / stepped.initial - exact))
    rate = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert 0.7 < rate < 1.3
    assert errors[-1] < min(errors[0] / 8, 2e-4)


@pytest.mark.parametrize(
    ("formulation", "restitution"),
    [(Formulation.CONSISTENT, 0.0), (Formulation.CONSISTENT, 0.5), (Formulation.PRINTED, 0.0)],
)
def test_fine_steps_follow_the_exact_motion(formulation: Formulation, restitution: float) -> None:
    """Hits, reversals and sticking over a cycle, each noticed at most a step late."""
    damper = paper(formulation=formulation, ball_mass=0.2, restitution=restitution, friction=0.1)
    release = (20e-3, 12e-3)
    stepped = stepped_ringdown(damper, release, 1, 4000)
    run = ringdown(damper, release, 1, keep_events=True)
    exact = sample(run, np.minimum(stepped.time, run.duration)).velocity
    assert stepped.impacts == run.impacts > 3
    assert stepped.initial == run.energy.initial
    assert np.abs(stepped.velocity - exact).mean() < 1e-3 * np.abs(exact).max()
    assert stepped.final == pytest.approx(run.energy.final, rel=5e-4)
    assert stepped.peak_velocities == pytest.approx(np.hypot(*exact[1:].T).max(), rel=5e-4)


def test_forty_steps_make_damping_of_their_own() -> None:
    """At the paper's 40 steps a cycle the printed equations seem to damp, where they really gain energy."""
    damper = paper(formulation=Formulation.PRINTED)
    exact = ringdown(damper, RELEASE, 20).energy
    stepped = stepped_ringdown(damper, RELEASE, 20, 40)
    assert exact.final > exact.initial
    assert stepped.final < 0.7 * stepped.initial


def test_structure_alone_is_exact_at_any_step() -> None:
    damper = paper(centrifugal_acceleration=1e9, damping_ratio=0.02)
    run = ringdown(damper, RELEASE, 5)
    for n in (3, 40):
        stepped = stepped_ringdown(damper, RELEASE, 5, n)
        assert stepped.impacts == 0
        assert stepped.final == pytest.approx(run.energy.final, rel=1e-12)
        assert stepped.structure == pytest.approx(stepped.initial - stepped.final, rel=0.1 if n == 3 else 1e-5)
