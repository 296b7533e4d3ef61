"""Modes of one plate at a few speeds, as exact as it takes to compare meshes, for little more than one solution.

Further speeds begin with the modes at the first and use its factor. Modes that no part of these leads to, for their
symmetry, would stay unseen: `complete` tells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fem.linalg.davidson import lowest_modes
from fem.linalg.lanczos import factorise
from fem.modes.real import Divergence, Modes, check_count, solve_real
from fem.modes.solve import solve_modes
from fem.statics.large_deflection import NoEquilibrium, settle, tangent
from fem.statics.linearised import linearise

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csc_array

    from fem.linalg.lanczos import Factor
    from fem.operators.assembly import Operators

    Array = NDArray[np.float64]

ROUGH = 1e-4
"""Largest residual of the modes at the first speed; the error of their frequencies is of the order of its square."""


BENT = 1e-3
"""Energy of Newton's last step to a large deflection as part of what squared frequencies need; its square is left."""


SAME = 1e-5
"""Relative difference of eigenvalues that count as the same."""


class Probed(NamedTuple):
    """Modes at one speed.

    Attributes:
        eigenvalues: (count,) in rad²/s², ascending.
        shapes: (n, count), mass-normalised.
        state: the displacement (n,) vibrated about, where the deflection is large.
    """

    eigenvalues: Array
    shapes: NDArray[Any]
    state: Array | None


def probe(
    operators: Operators, speeds: tuple[float, ...], count: int, exact: float, starts: tuple[Array | None, ...] = ()
) -> list[Probed]:
    """Find the count lowest modes at speeds in rad/s, ascending, up to the first at which the plate has none.

    exact: relative, of squared frequencies. starts: states (n,) near those of large deflections, for each speed.

    Raises:
        ValueError: as `solve_modes` does.
        Divergence, NoEquilibrium: at the first speed.
        Unresolved: the plate is too thin for its theory in double precision.
    """
    return _climb(operators, speeds, count, exact, starts, _from)


def alone(
    operators: Operators, speeds: tuple[float, ...], count: int, exact: float, starts: tuple[Array | None, ...] = ()
) -> list[Probed]:
    """The same as `probe`, every speed solved by itself."""
    return _climb(operators, speeds, count, exact, starts, _by_itself)


def _climb(
    operators: Operators,
    speeds: tuple[float, ...],
    count: int,
    exact: float,
    starts: tuple[Array | None, ...],
    further: Callable[[Operators, Modes, float, float, Array | None], Probed],
) -> list[Probed]:
    each = dict(zip(speeds, starts, strict=False))
    first = _solve(operators, speeds[0], count, exact, each.get(speeds[0]))
    found = [_kept(first)]
    for speed in speeds[1:]:
        try:
            found.append(further(operators, first, speed, exact, each.get(speed)))
        except (Divergence, NoEquilibrium):
            break
    return found


def complete(operators: Operators, speed: float, modes: Probed) -> bool:
    """Whether modes at a speed in rad/s are the lowest, none left out: by the inertia of a shifted stiffness."""
    if operators.gyroscopic is not None:
        return True
    stiffness = operators.at(speed) if modes.state is None else tangent(operators, speed, modes.state)
    shift = float(modes.eigenvalues[-1]) * (1.0 - SAME)
    below = np.count_nonzero(modes.eigenvalues < shift)
    return factorise((stiffness - shift * operators.mass).tocsc()).negative == below


def _solve(operators: Operators, speed: float, count: int, exact: float, start: Array | None) -> Modes:
    if operators.gyroscopic is not None:
        return solve_modes(operators, speed, count, start=start)
    check_count(operators, count)
    stiffness, state = linearise(operators, speed, start)
    return solve_real(operators, speed, stiffness, count, state, tolerance=min(ROUGH, exact**0.5))


def _kept(modes: Modes) -> Probed:
    return Probed(modes.eigenvalues, modes.shapes, modes.state)


def _by_itself(operators: Operators, known: Modes, speed: float, exact: float, start: Array | None) -> Probed:
    """As many modes at a speed in rad/s as are known at another, not made from these."""
    return _kept(_solve(operators, speed, known.eigenvalues.size, exact, start))


def _from(operators: Operators, known: Modes, speed: float, exact: float, start: Array | None) -> Probed:
    """Modes at a speed in rad/s from those at another, or by themselves where they differ too much."""
    if operators.gyroscopic is None:
        stiffness, start, factor = _near(operators, known, speed, exact, start)
        near = lowest_modes(stiffness, operators.mass, known.shapes, factor, exact)
        if near is not None and near[0][0] > 0.0:
            return Probed(*near, start)
    return _kept(solve_modes(operators, speed, known.eigenvalues.size, start=start))


def _near(
    operators: Operators, known: Modes, speed: float, exact: float, start: Array | None
) -> tuple[csc_array, Array | None, Factor]:
    """The stiffness (n, n) at a speed, the state it is taken about, and the factor of a similar one."""
    if not operators.effects.large_deflection:
        return operators.at(speed), None, known.factor
    state, factor = settle(operators, speed, start, BENT * exact)
    return tangent(operators, speed, state), state, factor
