"""The ladder over speeds: the reduced basis against every speed by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workflows.progress import Step
from workflows.solve.records import Floats
from workflows.studies.costs.ladder import Ladder, Picked, measure
from workflows.wording import whole

if TYPE_CHECKING:
    import fem

_TIMED_SPEEDS = 5
"""Speeds solved by themselves; what all would take is reckoned from them."""

SPEEDS = 1000
_TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)


def speeds(operators: fem.Operators, top: float, count: int, step: Step) -> tuple[Ladder, Picked]:
    """A thousand speeds from rest to the highest: from a reduced basis, or each by itself."""
    from fem import campbell, solve_modes

    omega = np.linspace(0.0, top, SPEEDS) if top > 0 else np.zeros(1)
    tried = omega[np.unique(np.linspace(0, omega.size - 1, _TIMED_SPEEDS + 2).round().astype(int)[1:-1])]
    direct = np.array([solve_modes(operators, float(w), count).frequencies_hz for w in tried])

    def judge(diagram: fem.Campbell) -> tuple[int | None, float]:
        at = np.searchsorted(diagram.omega, tried)
        return max(diagram.sizes, default=None), float(np.abs(diagram.frequencies_hz[at] / direct - 1.0).max())

    rows = []
    for tolerance in _TOLERANCES:
        step.advance(f"reduced basis, {tolerance:g}")
        rows.append(
            measure(
                "reduced basis",
                f"bound below {tolerance:g}",
                lambda tolerance=tolerance: campbell(operators, omega, count, tolerance=tolerance),  # type: ignore[misc]
                judge,
            )
        )
    step.advance("each speed by itself")
    alone = measure(
        "each speed by itself",
        f"{tried.size} of {omega.size} timed",
        lambda: np.array([solve_modes(operators, float(w), count).frequencies_hz for w in tried]),
        lambda found: (operators.mass.shape[0], float(np.abs(found / direct - 1.0).max())),
        share=omega.size / tried.size,
    )
    ladder = Ladder(
        "speeds",
        f"largest relative error of {count} frequencies at {omega.size} speeds up to {whole(top * 30 / np.pi)} rpm",
        f"modes solved for at {tried.size} of the speeds on the same mesh, good to rounding",
        (*rows, alone),
    )
    return ladder, _chosen_basis(operators, omega, tried, direct, count)


def _chosen_basis(operators: fem.Operators, omega: Floats, tried: Floats, direct: Floats, count: int) -> Picked:
    from fem import campbell

    diagram = campbell(operators, omega, count)
    at = np.searchsorted(diagram.omega, tried)
    error = float(np.abs(diagram.frequencies_hz[at] / direct - 1.0).max())
    sizes = " and ".join(map(str, diagram.sizes))
    return Picked("reduced basis", f"{sizes} vectors", float(diagram.bounds.max()), error)
