"""The plate as the damper feels it at every speed of a Campbell diagram, for the price of a few.

The plate with the ball stuck to it is a matrix family of its own, affine in Omega² and in the ball's mass. Its flap
modes at a few speeds, solved in full, span a small space in which every other speed is answered (Rayleigh and Ritz).
Speeds are added until the ones halfway between them come out right.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import eigh

from fem.linalg.davidson import most_alike
from fem.linalg.lanczos import rounding
from fem.operators.assembly import with_point_mass
from fem.reduction.at_one_speed import (
    SEARCHED,
    Reduced,
    become,
    check_mass,
    flap_index,
    flap_modes,
    flap_rows,
    reduce_at,
    reduced,
    searched,
)
from fem.sweep.diagram import campbell
from fem.sweep.laws import EXACT, require

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem.operators.assembly import Operators
    from fem.sweep.diagram import Campbell

    Array = NDArray[np.float64]

ALONE, LIGHT = 1.5, 0.1
"""Least ratio of the second eigenvalue to the lowest, and most that a ball may add to the mass and stiffness of a mode,
for the lowest mode to stay the lowest when the ball sticks."""

RIGHT = 1e-9
"""Relative error of a squared frequency at a speed between two known ones that counts as none."""

ROUNDED = 1e-7
"""One up to which it is rounding, if twice as many speeds have not halved it."""


def reduce_over(
    operators: Operators,
    diagram: Campbell,
    at: tuple[float, float],
    *,
    ball_mass: float | None = None,
    mass_ratio: float | None = None,
) -> list[Reduced]:
    """Reduced parameters at = (x, y) in m at every speed of a diagram of at least 4 modes; else as `reduce_at`."""
    check_mass(ball_mass, mass_ratio)
    return Reduction(operators, diagram, at).with_ball(ball_mass=ball_mass, mass_ratio=mass_ratio)


class Reduction:
    """A plate at a place and at every speed of a diagram, to be reduced with balls of any mass.

    What the ball has no part in is done once. Raises as `reduce_over` does.
    """

    def __init__(self, operators: Operators, diagram: Campbell, at: tuple[float, float]) -> None:
        self._bent = operators.effects.large_deflection
        if operators.gyroscopic is not None and not self._bent:
            operators = replace(operators, gyroscopic=None)
            diagram = campbell(operators, diagram.omega, max(SEARCHED, diagram.frequencies_hz.shape[1]))
        self._operators, self._diagram, self._at = operators, diagram, at
        if self._bent:
            return
        self._indices = [flap_index(names) for names in diagram.families]
        self._family = _Family(operators, at, diagram, self._indices)
        self._free, motions = self._family.follow(np.zeros(diagram.omega.size))
        self._modes = flap_modes(operators, at, motions)

    def with_ball(self, *, ball_mass: float | None = None, mass_ratio: float | None = None) -> list[Reduced]:
        """Reduced parameters for a ball_mass in kg or as m_p / M2, at every speed."""
        check_mass(ball_mass, mass_ratio)
        operators, diagram, at = self._operators, self._diagram, self._at
        if self._bent:
            pairs = zip(map(float, diagram.omega), diagram.states, strict=True)
            return [
                reduce_at(operators, modes.omega, at, ball_mass=ball_mass, mass_ratio=mass_ratio, modes=modes)
                for modes in (searched(operators, omega, state) for omega, state in pairs)
            ]
        ratio = mass_ratio or 0.0
        masses = np.array([mode.mass * ratio if ball_mass is None else ball_mass for mode in self._modes])
        stuck = self._family.follow(masses)[0] if masses.any() else self._free
        self._family.check(stuck, masses)
        every = zip(map(float, diagram.omega), self._indices, self._modes, masses, self._free, stuck, strict=True)
        return [
            reduced(omega**2 * operators.pull(at), index, mode, float(mass), float(free), float(held))
            for omega, index, mode, mass, free, held in every
        ]


def _between(squares: Array, nodes: list[int]) -> list[int]:
    """Which speed lies halfway, in Omega², between each two neighbours among nodes that are not next to each other."""
    halfway = []
    for low, high in pairwise(nodes):
        inside = np.arange(low + 1, high)
        if inside.size:
            halfway.append(int(inside[np.abs(squares[inside] - 0.5 * (squares[low] + squares[high])).argmin()]))
    return halfway


class _Family:
    """The plate with balls stuck to it: K(Omega) + Omega² m K_a and M + m M_a, of 1 kg at the damper's place."""

    def __init__(self, operators: Operators, at: tuple[float, float], diagram: Campbell, indices: list[int]) -> None:
        heavy = with_point_mass(operators, at, 1.0)
        self._operators = operators
        self._spinning = (heavy.spinning - operators.spinning).tocsc()
        self._mass = (heavy.mass - operators.mass).tocsc()
        self._at = at
        self._motion = flap_rows(operators, at)
        self._diagram, self._indices = diagram, indices

    def follow(self, masses: Array) -> tuple[Array, Array]:
        """Squared frequencies (k,) of the flap mode with masses (k,) in kg; w and w_x (2, k).

        Raises:
            Divergence: past the critical speed.
        """
        omega = self._diagram.omega
        fresh = {k: self.solved(k, masses[k]) for k in {0, omega.size - 1}}
        known: dict[int, tuple[float, Array]] = {}
        before = np.inf
        while True:
            known |= fresh
            nodes = sorted(known)
            solved = np.column_stack([known[k][1] for k in nodes])
            flaps = np.column_stack([self._diagram.shapes(k)[:, self._indices[k]] for k in nodes])
            values, motions = self._ritz(np.column_stack([solved, flaps]), masses)
            values[nodes], motions[:, nodes] = [known[k][0] for k in nodes], self._motion @ solved
            fresh = {k: self.solved(k, masses[k]) for k in _between(omega**2, nodes)}
            right = max(RIGHT, 4.0 * self._rounding(values[nodes], solved))
            wrong = max((abs(values[k] / value - 1.0) for k, (value, _) in fresh.items()), default=0.0)
            if wrong <= right or 0.5 * before < wrong <= ROUNDED:
                return values, motions
            before = wrong

    def check(self, stuck: Array, masses: Array) -> None:
        """Check squared frequencies (k,) with balls of masses (k,) stuck, at the lowest speed and at the highest.

        Where the flap mode is the lowest, stands alone and is hardly changed by the ball, it stays the lowest.

        Raises:
            LawViolation: it exceeds Rayleigh's quotient of its shape without the ball.
        """
        law = "a stuck ball leaves the lowest eigenvalue below Rayleigh's quotient"
        for k in {0, masses.size - 1}:
            omega, free = self._diagram.omega[[k]], (2.0 * np.pi * self._diagram.frequencies_hz[k]) ** 2
            shape = self._diagram.shapes(k)[:, self._indices[k]]
            heavier, stiffer = (masses[k] * (shape @ (each @ shape)) for each in (self._mass, self._spinning))
            stiffer *= omega**2 / free[0]
            if self._indices[k] == 0 and free[1] > ALONE * free[0] and max(heavier, abs(stiffer)) < LIGHT:
                slack = (EXACT + 2.0 * self._diagram.bounds[k, 0]) * free[0]
                require(law, stuck[[k]] - free[0] * (1.0 + stiffer) / (1.0 + heavier), slack, omega)

    def _rounding(self, values: Array, shapes: Array) -> float:
        """What double precision leaves uncertain of some squared frequencies (k,) with shapes (n, k), relatively."""
        stiffness = self._operators.at(float(self._diagram.omega[-1]))
        return 2.0 * float(rounding(stiffness, shapes, values).max())

    def solved(self, k: int, mass: float) -> tuple[float, Array]:
        """The squared frequency at speed number k and its shape (n,), by the full matrices."""
        omega = float(self._diagram.omega[k])
        stiffness = self._operators.at(omega) + omega**2 * mass * self._spinning
        heavy = self._operators.mass + mass * self._mass
        stuck = stiffness.tocsc(), heavy.tocsc()
        return become(self._operators, omega, stuck, self._diagram.shapes(k), self._indices[k], self._at)

    def _ritz(self, span: Array, masses: Array) -> tuple[Array, Array]:
        """Squared frequencies (k,) at all speeds, and w and w_x (2, k), within a span (n, r)."""
        basis = np.linalg.qr(span)[0]
        operators = self._operators
        still, spinning, mass, more_spinning, more_mass = (
            basis.T @ (matrix @ basis)
            for matrix in (operators.stiffness, operators.spinning, operators.mass, self._spinning, self._mass)
        )
        wanted = self._flaps_in(basis)
        values, parts = np.empty(masses.size), np.empty((basis.shape[1], masses.size))
        for k, (omega, ball) in enumerate(zip(self._diagram.omega, masses, strict=True)):
            stiffness = still + omega**2 * (spinning + ball * more_spinning)
            every, vectors = eigh(stiffness, mass + ball * more_mass)
            alike = most_alike(wanted[k], mass, vectors)
            values[k], parts[:, k] = every[alike], vectors[:, alike]
        return values, self._motion @ basis @ parts

    def _flaps_in(self, basis: Array) -> Array:
        """Products (k, r) in the mass of the flap modes without balls and a basis (n, r)."""
        heavy = self._operators.mass @ basis
        rows, first = [], 0
        for part in self._diagram.parts:
            small = part.basis.T @ heavy
            flaps = self._indices[first : first + len(part.vectors)]
            rows += [vectors[:, flap] @ small for vectors, flap in zip(part.vectors, flaps, strict=True)]
            first += len(part.vectors)
        return np.array(rows)
