"""The Campbell diagram: frequencies over speed, and modes followed through crossings.

With a linear prestress every speed is answered by a reduced basis (`fem.sweep.reduced_basis`) with a bound on the error
of every frequency. With large deflection the modes are solved speed by speed, each from the state before; so they are
for many modes at few speeds. `follow` pairs the modes of neighbouring speeds by their likeness, through crossings and
veerings.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.assembly import Operators
from fem.linalg import CONVERGED, Array, Ints, rounding
from fem.modal_model import FAMILIES
from fem.modes import (
    Divergence,
    Modes,
    check_count,
    check_damping,
    critical_speed,
    energy_shares,
    solve_modes,
)
from fem.statics import NoEquilibrium, tangent
from fem.sweep.laws import check_diagram
from fem.sweep.reduced_basis import Question, ReducedBasis, Swept, answer, answer_again

CLEAR = 0.7
"""Likeness from which a pair counts as the same mode; no second one can then exceed 0.3."""


COUPLED = 1e-3
"""Coupling, relative to a mode's stiffness, from which modes that change places count as veering: about the gap that
they keep, relative to their frequency."""


@dataclass(frozen=True)
class Veering:
    """An ambiguous pairing of modes between two neighbouring speeds.

    Attributes:
        modes: numbers (from 0, by frequency at the first of the two speeds) of the modes concerned.
        likeness: the best pair's MAC for each.
    """

    step: int
    modes: tuple[int, ...]
    likeness: tuple[float, ...]


def follow(alike: Array, wanted: int, coupling: Callable[[int], Array]) -> tuple[Ints, tuple[Veering, ...]]:
    """Follow modes from speed to speed by their likeness.

    Args:
        alike: modal assurance criterion (MAC) of the q modes at each of k speeds with those at the next, (k - 1, q, q).
        wanted: number of modes to follow.
        coupling: gives, for a step, how strongly its change of speed couples the modes before it, (wanted, q), relative
            to the stiffness of the first of each two.

    Returns:
        Branches (k, wanted): the branch of each mode, numbered by frequency at the first speed. And the ambiguous
        pairings.
    """
    steps, q, _ = alike.shape
    straight = np.einsum("kii->ki", alike)[:, :wanted].min(axis=1) >= CLEAR
    branches = np.empty((steps + 1, q), dtype=np.int64)
    branches[0] = np.arange(q)
    veerings = []
    for step in range(steps):
        if straight[step]:
            branches[step + 1] = branches[step]
            continue
        pair, unclear = _pair(alike[step], wanted)
        branches[step + 1, pair] = branches[step]
        passed = np.argwhere(np.triu(pair[:wanted, None] > pair, 1))
        if passed.size:
            coupled = passed[coupling(step)[tuple(passed.T)] > COUPLED]
            unclear = np.union1d(unclear, coupled[coupled < wanted])
        if unclear.size:
            likeness = alike[step].max(axis=1)[unclear]
            veerings.append(Veering(step, tuple(unclear.tolist()), tuple(likeness.tolist())))
    return branches[:, :wanted], tuple(veerings)


def _pair(alike: Array, wanted: int) -> tuple[Ints, Ints]:
    """The partner of each mode at the next speed, and the wanted modes whose partner is not clear."""
    pair = alike.argmax(axis=1)
    if np.unique(pair).size < pair.size:  # two modes compete for a partner
        from scipy.optimize import linear_sum_assignment  # takes a tenth of all that a run imports

        pair = linear_sum_assignment(-alike)[1]
    sure = alike[np.arange(len(pair)), pair] >= CLEAR
    return pair.astype(np.int64), np.flatnonzero(~sure[:wanted])


SHY = 1e-9
"""Relative distance from the critical speed within which a speed counts as critical."""


FEW = 12
"""Modes up to which a reduced basis is cheaper than solving as many speeds one by one; beyond, its bounds are dear."""


MOST_MENDED = 50
"""Speeds of a part that are solved by themselves at most, where bounds of a reduced basis stay above the tolerance."""


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes over speed, as a Campbell diagram shows them.

    Attributes:
        omega: (k,) speeds in rad/s, ascending, below the critical one.
        frequencies_hz: (k, count), ascending at each speed.
        bounds: (k, count), on their relative error against the full model.
        damping_ratios: (k, count).
        branches: (k, count), which mode of the first speed each one continues.
        shares: (k, 5, count), see `fem.modes`.
        veerings: where this is ambiguous.
        diverged: the speeds asked for that lie at or beyond the critical one.
        parts: what the shapes are made from.
    """

    omega: Array
    frequencies_hz: Array
    bounds: Array
    damping_ratios: Array
    branches: Ints
    shares: Array
    veerings: tuple[Veering, ...]
    diverged: Array
    parts: tuple[Swept, ...] = field(repr=False)

    def shapes(self, number: int) -> NDArray[Any]:
        """Mass-normalised shapes (n, count) at the speed of an index; complex with Coriolis forces."""
        places = [(part, k) for part in self.parts for k in range(part.rates.shape[0])]
        if not -len(places) <= number < len(places):
            raise IndexError(f"there are only {len(places)} speeds")
        part, k = places[number]
        return np.asarray(part.basis @ part.vectors[k][:, : self.frequencies_hz.shape[1]])

    @property
    def bases(self) -> tuple[ReducedBasis, ...]:
        """The reduced bases used, by which `campbell` may answer other speeds of the same plate."""
        return tuple(part.reduced for part in self.parts if part.reduced is not None)

    @property
    def sizes(self) -> tuple[int, ...]:
        """Vectors in each reduced basis used."""
        return tuple(basis.size for basis in self.bases)

    @property
    def states(self) -> list[Array | None]:
        """Static displacement (n,) [m] at each speed, where the deflection is large."""
        return [part.state for part in self.parts for _ in range(part.rates.shape[0])]

    @cached_property
    def families(self) -> list[list[str]]:
        """The family of every mode at every speed."""
        return [[FAMILIES[k] for k in row] for row in self.shares.argmax(axis=1)]


def campbell(
    operators: Operators,
    omega: Array,
    count: int = 6,
    *,
    tolerance: float = 1e-6,
    damping_ratio: float = 0.0,
    states: tuple[tuple[float, Array], ...] = (),
    bases: Iterable[ReducedBasis] = (),
    progress: Callable[[int], None] | None = None,
) -> Campbell:
    """The lowest modes of a plate at many speeds, each frequency with a bound on its error.

    What was achieved is in `bounds`: they exceed the tolerance where rounding or the largest basis forbids it, and are
    inf where nothing can be shown.

    Args:
        operators: of the plate.
        omega: speeds (k,) [rad/s].
        count: number of modes.
        tolerance: relative, of each frequency.
        damping_ratio: as in `solve_modes`, to first order [-].
        states: known static displacements (n,) [m] with their speeds [rad/s], where the deflection is large.
        bases: of another diagram of these operators; the first that answers all speeds within the tolerance is taken.
        progress: is called with the number of speeds done, where each is solved by itself.

    Raises:
        ValueError: for no speeds or a count, tolerance or ratio out of range.
        Divergence: when every speed is at or beyond the critical one, NoEquilibrium.
        Unresolved: for a plate too thin for the theory.
        LawViolation: a frequency is impossible: see `fem.sweep.laws`.
    """
    requested = np.unique(np.asarray(omega, dtype=float))
    if requested.size == 0 or not np.isfinite(requested).all() or requested[0] < 0.0:
        raise ValueError("campbell needs at least one speed, finite and not negative")
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance must lie between 0 and 1, got {tolerance!r}")
    check_count(operators, count)
    check_damping(damping_ratio)
    question = Question(operators, count, tolerance, damping_ratio)
    if again := answer_again(question, requested, bases):
        parts = [again]
    elif operators.effects.large_deflection or hardly_any(requested.size, count):
        parts = _speed_by_speed(question, requested, dict(states), progress)
    else:
        parts = [piece for part in _below_critical(question, requested) for piece in _mended(question, part)]
    below = requested[: sum(part.rates.shape[0] for part in parts)]
    branches, veerings = follow(_likeness(operators, parts), count, lambda step: _coupling(operators, parts, step))
    diagram = Campbell(
        omega=below,
        frequencies_hz=np.vstack([part.rates for part in parts]) / (2.0 * np.pi),
        bounds=np.vstack([part.bounds for part in parts]),
        damping_ratios=np.vstack([part.damping for part in parts]),
        branches=branches,
        shares=np.concatenate([part.shares for part in parts]),
        veerings=veerings,
        diverged=requested[below.size :],
        parts=tuple(parts),
    )
    check_diagram(operators, diagram, damping_ratio)
    return diagram


def without_coriolis(operators: Operators, diagram: Campbell, least: int = 1) -> tuple[Operators, Campbell]:
    """A plate and its diagram, of so many modes at least, without Coriolis forces: the modes are real."""
    if operators.gyroscopic is None:
        return operators, diagram
    operators, count = operators.without_coriolis, max(least, diagram.frequencies_hz.shape[1])
    pairs = zip(map(float, diagram.omega), diagram.states, strict=True)
    states = tuple((omega, state) for omega, state in pairs if state is not None)
    bases = [basis.without_coriolis for basis in diagram.bases]
    return operators, campbell(operators, diagram.omega, count, states=states, bases=bases)


def hardly_any(speeds: int, count: int) -> bool:
    """Whether so few speeds are asked for that each is best solved by itself."""
    return speeds == 1 or (count > FEW and speeds <= count)


def _below_critical(question: Question, omega: Array) -> list[Swept]:
    """Answer the speeds (k,) below the critical one.

    Raises:
        Divergence: when there are none.
    """
    try:
        return answer(question, omega)
    except Divergence:
        below = omega[omega < (1.0 - SHY) * critical_speed(question.operators)]
        if below.size in (0, omega.size):
            raise
        return answer(question, below)


def _mended(question: Question, part: Swept) -> list[Swept]:
    """A part of the answer, in which speeds that no basis answered well enough are solved by themselves, if few."""
    if part.met.all() or np.count_nonzero(~part.met) > MOST_MENDED:
        return [part]
    pieces: list[Swept] = []
    for rows in np.split(np.arange(part.omega.size), np.flatnonzero(np.diff(part.met)) + 1):
        if part.met[rows[0]]:
            pieces.append(part.only(rows))
        else:
            pieces += _speed_by_speed(question, part.omega[rows], {}, None)
    return pieces


def _speed_by_speed(
    question: Question, omega: Array, known: dict[float, Array], progress: Callable[[int], None] | None
) -> list[Swept]:
    """Solve each speed (k,) in full until one diverges, its static state known or from those before."""
    parts: list[Swept] = []
    path: list[tuple[float, Array]] = []
    for speed in map(float, omega):
        try:
            own = {"start": _ahead(path, speed), "state": known.get(speed)}
            ratio = question.damping_ratio
            modes = solve_modes(question.operators, speed, question.count + 1, damping_ratio=ratio, **own)
        except (Divergence, NoEquilibrium):
            if not parts:
                raise
            break
        if modes.state is not None:
            path = [*path[-1:], (speed**2, modes.state)]
        parts.append(_alone(question, speed, modes))
        if progress is not None:
            progress(len(parts))
    return parts


def _alone(question: Question, speed: float, modes: Modes) -> Swept:
    """One speed's own modes, of which one more than asked for are known, as an answer of a basis that is theirs."""
    operators, count = question.operators, question.count
    shapes, values = modes.shapes[:, :count], modes.eigenvalues[:count]
    return Swept(
        omega=np.array([speed]),
        rates=np.sqrt(values)[None],
        bounds=CONVERGED + rounding(operators.at(speed), np.abs(shapes), values)[None],
        damping=modes.damping_ratios[None, :count],
        shares=energy_shares(operators, shapes)[None],
        vectors=np.eye(modes.shapes.shape[1])[None],
        basis=modes.shapes,
        reduced=None,
        met=np.ones(1, dtype=bool),
        state=modes.state,
    )


def _ahead(path: list[tuple[float, Array]], speed: float) -> Array | None:
    """Where the last one or two states, each with its Omega², lead to at a speed in rad/s."""
    if len(path) < 2:
        return path[-1][1] if path else None
    (before, first), (now, second) = path
    return second + (speed**2 - now) / (now - before) * (second - first)


def _likeness(operators: Operators, parts: list[Swept]) -> Array:
    """MAC (k - 1, q, q) between the modes at each speed and those at the next."""
    q = min(part.vectors.shape[2] for part in parts)
    steps = []
    for here, following in zip(parts, [*parts[1:], None], strict=True):
        vectors = here.vectors[:, :, :q]
        mass = here.basis.conj().T @ (operators.mass @ here.basis)
        steps.append(np.swapaxes(vectors[:-1].conj(), 1, 2) @ mass @ vectors[1:])
        if following is not None:
            cross = here.basis.conj().T @ (operators.mass @ following.basis)
            steps.append((vectors[-1].conj().T @ cross @ following.vectors[0, :, :q])[None])
    return np.asarray(np.abs(np.concatenate(steps)) ** 2)


def _coupling(operators: Operators, parts: list[Swept], step: int) -> Array:
    """What a step's change of speed does between the modes (count, q) before it, relative to each one's stiffness."""
    ends = [(part, row) for part in parts for row in range(part.omega.size)][step : step + 2]
    (here, row), (there, following) = ends
    slow, fast = here.omega[row], there.omega[following]
    shapes = here.basis @ here.vectors[row]
    rates = here.rates[row][:, None]
    if here.state is not None and there.state is not None:
        moved = (tangent(operators, fast, there.state) - tangent(operators, slow, here.state)) @ shapes
    else:
        moved = (fast**2 - slow**2) * (operators.spinning @ shapes)
    coupled = shapes[:, : rates.size].conj().T @ moved
    if operators.gyroscopic is not None:
        turned = shapes[:, : rates.size].conj().T @ (operators.gyroscopic @ shapes)
        coupled = coupled + 1j * (fast - slow) * rates * turned
    return np.asarray(np.abs(coupled) / rates**2)
