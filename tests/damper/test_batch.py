"""Batches give what single runs give."""

import dataclasses

import numpy as np
import pytest

from damper import Formulation, Mode, capacity, ringdown, ringdowns
from damper.state import COUNTED
from tests.compiler import COMPILED, needs_compiler
from tests.damper.scenes import paper

N = 150 if COMPILED else 3
RNG = np.random.default_rng(5)
VARIED = {
    "restitution": RNG.uniform(0, 1, N),
    "ball_mass": 10 ** RNG.uniform(-4, -1, N),
    "rolling_friction": RNG.uniform(0.2e-4, 2e-4, N),
    "cavity": RNG.uniform(2.05e-3, 5e-3, (N, 2)),
    "damping_ratio": RNG.choice([0.003, 0.02], N),
}
RELEASE = RNG.uniform(2e-3, 30e-3, (N, 2))


@pytest.mark.parametrize("cycles", [pytest.param(None, marks=needs_compiler), 7])
def test_batch_equals_single_runs_bit_for_bit(cycles: float | None) -> None:
    base = paper()
    batch = ringdowns(base, RELEASE, cycles, **VARIED)
    for k in range(N):
        one = {name: v[k].item() if v.ndim == 1 else tuple(v[k].tolist()) for name, v in VARIED.items()}
        run = ringdown(dataclasses.replace(base, **one), tuple(RELEASE[k]), cycles)
        damping = capacity(run)
        for counter in COUNTED:
            assert getattr(batch, counter)[k] == getattr(run, counter), counter
        assert batch.outcome[k] == run.outcome
        assert (batch.initial[k], batch.final[k]) == (run.energy.initial, run.energy.final)
        for book in ("structure", "rolling", "impact"):
            assert getattr(batch, book)[k] == getattr(run.energy, book), book
        assert batch.peak_sdc[k] == damping.sdc.max(initial=0.0)
        assert batch.cutoff[k] == damping.cutoff or (np.isnan(batch.cutoff[k]) and damping.cutoff is None)
        assert batch.largest_rolling_demand[k] == run.largest_rolling_demand


def test_threads_do_not_matter() -> None:
    base = paper(formulation=Formulation.PRINTED)
    one, *others = (vars(ringdowns(base, RELEASE, 5, threads=threads, **VARIED)) for threads in (1, 2, 5))
    for other in others:
        np.testing.assert_equal(other, one)


def test_progress_counts_to_the_end() -> None:
    calls: list[int] = []
    ringdowns(paper(), RELEASE, 3, progress=calls.append)
    assert calls[-1] == N
    assert calls == sorted(calls)


def test_interrupt_ends_the_call() -> None:
    def stop(done: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ringdowns(paper(), RELEASE, 3, progress=stop)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"restitution": np.full(N, 1.2)}, "restitution must be between 0 and 1, got 1.2"),
        ({"restitution": np.zeros(2)}, f"restitution must have {N} values"),
        ({"colour": np.zeros(N)}, "colour is not a field"),
        ({"cavity": np.full(N, 1e-3)}, "cavity must be at least the ball's diameter"),
    ],
)
def test_bad_input(changes: dict[str, np.ndarray], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ringdowns(paper(), RELEASE, 3, **changes)


def test_empty_batch() -> None:
    assert len(ringdowns(paper(), np.zeros((0, 2)), 3).impacts) == 0


def test_amplitudes_of_modes_are_as_in_a_ring_down() -> None:
    """A batch in which the modes start by themselves: bit for bit what single ring-downs give."""
    modes = (Mode(1.0, 4e6, (2.0, 0.0), (3.0, 0.0)), Mode(1.0, 9e7, (1.5, 0.5)))
    base = paper()
    damper = dataclasses.replace(base, modes=modes, damping_ratio=1e-3, modal_mass=0.25, stiffness=(1e6, 1e6))
    start = np.array([[1e-2, 0.0], [1e-2, 1e-3], [5e-3, 5e-3]])
    batch = ringdowns(damper, np.zeros((3, 2)), 10, amplitudes=start, threads=2)
    for k, amplitudes in enumerate(start):
        alone = ringdown(damper, (0.0, 0.0), 10, amplitudes=tuple(amplitudes))
        assert batch.events[k] == alone.events > 0
        assert batch.final[k] == alone.energy.final
        assert batch.initial[k] == alone.energy.initial
    with pytest.raises(ValueError, match="amplitudes must be"):
        ringdowns(base, np.zeros((3, 2)), 10, amplitudes=start)
