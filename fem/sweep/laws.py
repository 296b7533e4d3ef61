"""Laws that frequencies over speed obey before they are published, whatever computed them.

With a linear prestress K(Omega) = K_0 + Omega² K_1. The sum of the lowest eigenvalues, however many, is then concave
in Omega²: it is the least trace over all subspaces of that dimension (Ky Fan), and every trace is linear in Omega². So
it lies above its chords and below its tangents, whose slopes are Rayleigh's quotients of K_1. Southwell's theorem is
such a chord: the lowest eigenvalue is at least the sum of the lowest ones of K_0 and of Omega² K_1. With a large
deflection the stiffness is not linear in Omega², and with Coriolis forces the eigenvalues are not those of K alone;
what remains are the quotients of each mode, w² x'Mx = x'Kx + w x'(i Omega G)x.
"""

from typing import Any

import numpy as np

from fem.assembly import Operators
from fem.linalg import Array, quadratic_forms
from fem.rotor import in_rpm
from fem.statics import linearise

EXACT = 1e-6
"""Relative error of an eigenvalue beyond its own bound, and of the quotients that it is compared with."""


ROUNDING = 1e-12
"""Relative, of figures that a product of others gives."""


class LawViolation(Exception):
    """A frequency violates a law: a defect of the program or of a library beneath it."""


def check_diagram(operators: Operators, diagram: Any, damping_ratio: float) -> None:
    """Check frequencies over speed against the laws that they obey.

    Args:
        operators: matrices of the plate.
        diagram: a `fem.Campbell`.
        damping_ratio: of its modes [-].

    Raises:
        LawViolation: a frequency is impossible.
    """
    values = (2.0 * np.pi * diagram.frequencies_hz) ** 2
    slack = (EXACT + 2.0 * diagram.bounds) * values
    lowered = np.where(values < np.inf, -np.sign(diagram.frequencies_hz) * values, np.inf)
    require("every frequency is positive and finite", lowered, -np.finfo(float).tiny, diagram.omega)
    require("frequencies ascend", values[:, :-1] - values[:, 1:], slack[:, 1:], diagram.omega)
    turning, bent = operators.gyroscopic is not None, operators.effects.large_deflection
    if turning and damping_ratio > 0.0:
        return
    last = diagram.omega.size - 1
    ends = [last] if bent else sorted({0, last})  # about a bent state a stiffness has to be assembled for it
    rises = [_check_quotients(operators, diagram, k, values[k], slack[k]) for k in ends]
    if turning or bent:
        return
    squares, sums, slack = diagram.omega**2, values.cumsum(axis=1), slack.cumsum(axis=1)
    for k, rise in zip(ends, rises, strict=True):
        tangent = sums[k] + (squares - squares[k])[:, None] * rise.cumsum()
        require("eigenvalues lie below their tangents", sums - tangent, slack + slack[k], diagram.omega)
    if squares.size > 2:
        share = ((squares[1:-1] - squares[:-2]) / (squares[2:] - squares[:-2]))[:, None]
        chord = (1.0 - share) * sums[:-2] + share * sums[2:]
        allowed = slack[1:-1] + np.maximum(slack[:-2], slack[2:])
        require("eigenvalues lie above their chords", chord - sums[1:-1], allowed, diagram.omega[1:-1])


def _check_quotients(operators: Operators, diagram: Any, number: int, values: Array, slack: Array) -> Array:
    """Compare eigenvalues (count,) with their shapes' quotients at a speed; returns those of K_1, (count,)."""
    omega, shapes = float(diagram.omega[number]), diagram.shapes(number)[:, : values.size]
    mass, rise = quadratic_forms(operators.mass, shapes), quadratic_forms(operators.spinning, shapes)
    if operators.effects.large_deflection:
        stiffness = quadratic_forms(linearise(operators, omega, state=diagram.states[number])[0], shapes)
    else:
        stiffness = quadratic_forms(operators.stiffness, shapes) + omega**2 * rise
    if operators.gyroscopic is not None:
        turned = np.einsum("nk,nk->k", shapes.conj(), operators.gyroscopic @ shapes)
        stiffness = stiffness - omega * np.sqrt(values) * turned.imag
    require("shapes have a modal mass of 1", abs(mass - 1.0), np.full(values.size, EXACT), diagram.omega[[number]])
    require("eigenvalues are Rayleigh's quotients", abs(stiffness - values), slack, diagram.omega[[number]])
    return rise


def check_reduced(reduced: Any) -> None:
    """Check K = M (2 pi f)² of a `fem.Reduced`, with the ball stuck and without it.

    Raises:
        LawViolation: mass, stiffness and frequency do not belong together.
    """
    pairs = {"K1 is M1 (2 pi f1)²": (reduced.K1, reduced.M1 * (2.0 * np.pi * reduced.f1_hz) ** 2)}
    pairs["K2 is M2 (2 pi f2)²"] = reduced.K2, reduced.M2 * (2.0 * np.pi * reduced.f2_hz) ** 2
    pairs["M1 is M2 with the ball"] = reduced.M1, reduced.M2 + reduced.ball_mass
    for law, (value, other) in pairs.items():
        if not abs(value - other) <= ROUNDING * other:
            raise LawViolation(f"{law}, but they are {value:.6g} and {other:.6g}")


def require(law: str, excess: Array, allowed: Array | float, omega: Array) -> None:
    """Require an excess to be a number within what is allowed.

    Args:
        law: its statement, for the message.
        excess: shape (k, count) [rad²/s²].
        allowed: of the same shape, or a number [rad²/s²].
        omega: speeds (k,) [rad/s].

    Raises:
        LawViolation: an excess is too large or not a number.
    """
    holds = np.atleast_2d(excess <= allowed)
    if not holds.all():
        row, mode = (int(k) for k in np.argwhere(~holds)[0])
        value, most = (
            float(np.broadcast_to(np.atleast_2d(each), holds.shape)[row, mode]) for each in (excess, allowed)
        )
        raise LawViolation(
            f"{law}, but mode {mode + 1} at {in_rpm(omega[row]):.6g} rpm misses that by {value:.6g},"
            f" beyond the bound of {most:.6g}"
        )
