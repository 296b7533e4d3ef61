"""Static equilibrium of the spinning plate, and the stiffness about it.

The strains are the theory's own (`fem.theory.sections`, `fem.theory.finite_rotation`). The centrifugal load is that of
the displaced mass when softening is counted. Newton's method starts from the stretched plate or from the state at a
neighbouring speed, and takes the load in parts when that is too far. A thin plate that bends is stretched by far too
much in a step that is linear, and the stiffness under that stress leads astray: each step's stiffness is therefore
under the stress that the step before led to, to first order (Magisano, Leonetti and Garcea, Comput. Methods Appl.
Mech. Engrg 313 (2017) 986). `linearise` gives the stiffness that modes at a speed vibrate with, of either deflection.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from fem.assembly import Body, Operators, StressedBody, assemble
from fem.linalg import Array, Factor, SingularMatrix, Solver, lanczos, less, rounding
from fem.plate import ElasticRoot
from fem.rotor import in_rpm

LOST = 0.1
"""What rounding may leave uncertain of the lowest frequency at rest, by an estimate that is some twenty times what is
measured (strips of h/L = 1e-4, W/L = 0.01 against thin-plate theory, 0.05 to 0.19: errors of 2e-3 to 6e-3)."""


ROUGH = 1e-3
"""Residual of the mode at rest: the error of its frequency is of the order of the square."""


class Unresolved(ArithmeticError):
    """Rounding has eaten up the stiffness: in double precision the theory has no answer.

    The plate is too thin, or stands on springs so soft that it is all but loose.

    Attributes:
        uncertain: what is left uncertain of the lowest frequency at rest, relatively; infinite where it has none.
        loose: the root, where it is that which is too soft.
    """

    def __init__(self, theory: str, uncertain: float, loose: ElasticRoot | None = None) -> None:
        left = f"rounding may be {100 * uncertain:.2g} % of" if uncertain < 1.0 else "rounding leaves no digits of"
        thin = (
            f"too thin for theory {theory!r} in double precision: {left} the lowest frequency at rest; "
            "of the theories, kirchhoff loses the fewest digits and solid the most"
        )
        soft = f"too soft in double precision: the plate is almost free, and {left} its lowest frequency at rest"
        super().__init__(thin if loose is None else soft)
        self.uncertain = uncertain
        self.loose = loose


def check_speed(omega: float) -> None:
    """Raise ValueError unless omega is one finite speed in rad/s."""
    if np.ndim(omega) != 0 or not np.isfinite(omega):
        raise ValueError(f"omega must be one finite speed in rad/s, got {omega!r}")


def positive(operators: Body, stiffness: csc_array) -> Factor | None:
    """Factor of a stiffness (n, n); None where it is not positive."""
    try:
        factor = operators.factorise(stiffness)
    except SingularMatrix:
        return None
    return None if factor.negative else factor


def check_rest(operators: Body) -> float:
    """Raise Unresolved unless the plate at rest has a lowest frequency that rounding leaves; its square in rad²/s².

    At rest the stiffness is positive by construction: what is not so there, or is not there, is rounding.
    """
    uncertain, lowest = _uncertain(operators)
    if uncertain <= LOST:
        return lowest
    loose = None
    if isinstance(operators, Operators) and operators.plate.elastic_root is not None:
        fixed = replace(operators.plate, elastic_root=None)
        clamped = assemble(fixed, operators.rotor, operators.effects, operators.theory)
        loose = operators.plate.elastic_root if _uncertain(clamped)[0] <= LOST else None
    raise Unresolved(operators.theory, uncertain, loose)


def _uncertain(operators: Body) -> tuple[float, float]:
    """What rounding leaves uncertain of the lowest frequency at rest, relatively, and its square: infinite without."""
    factor = positive(operators, operators.stiffness)
    if factor is None:
        return np.inf, np.inf
    value, shape = lanczos(factor, operators.mass, 1, ROUGH)
    return float(rounding(operators.stiffness, shape, value)[0]), float(value[0])


ITERATIONS = 25
"""Newton steps before the load is taken in smaller parts."""

BALANCED = 1e-14
"""Energy of the last Newton step relative to that of the load; what is then left is of the order of its square."""

ON_THE_WAY = 1e-4
"""The same while the load is not yet whole."""

STALLED = 1e-10
"""Energy from which a step that gains nothing on the one before counts as rounding."""

ROUNDED = 1e-20
"""The same of one with a known factor: a new factor would find no more than rounding either."""

STILL_GOOD = 0.01
"""Energy of a step with a known factor, relative to that of the step before, up to which the factor is still good."""

CLOSE = 1e-3
"""Energy of a step, relative to that of the load, up to which its factor is used again."""

SMALLEST_PART = 1e-4
"""Smallest part of the load that is tried before giving up."""

WILD = 3
"""Newton steps after which energies must fall; before, a plate bent too far at first is pulled back by its stretch."""


class NoEquilibrium(ArithmeticError):
    """Newton's method found no static equilibrium at a speed omega (rad/s), even in small steps."""

    def __init__(self, omega: float) -> None:
        super().__init__(f"no static equilibrium was found at {in_rpm(omega):.6g} rpm")
        self.omega = omega


def equilibrium(operators: Body, omega: float, start: Array | None = None) -> Array:
    """The displacement at which a plate rests at a speed.

    It is stable where one is found on the way up from rest; otherwise it may be unstable, which its modes then show.

    Args:
        operators: of the plate or blade.
        omega: speed [rad/s].
        start: displacement (n,) [m] at a neighbouring speed, if known.

    Returns:
        Shape (n,) [m].

    Raises:
        NoEquilibrium: none was found, even in small steps.
        Unresolved: the plate is too thin for its theory.
        ValueError: a speed that is not one finite number, or a start that is not (n,).
    """
    return settle(operators, omega, start)[0]


def settle(
    operators: Body, omega: float, start: Array | None = None, converged: float = BALANCED
) -> tuple[Array, Solver]:
    """As `equilibrium`, with the factor of a stiffness near that of the state.

    Args:
        operators: of the plate or blade.
        omega: speed [rad/s].
        start: displacement (n,) [m] at a neighbouring speed, if known.
        converged: energy of the last Newton step relative to that of the load; the remaining error is of the order of
            its square.
    """
    check_speed(omega)
    if start is not None and np.shape(start) != operators.load.shape:
        raise ValueError(f"start must be of shape {operators.load.shape}, got {np.shape(start)}")
    target = omega**2
    if start is not None and (equilibrium := newton(operators, target, start, converged=converged)) is not None:
        return equilibrium
    state, reached, part = np.zeros(operators.load.size), 0.0, 1.0
    while True:
        attempt = min(1.0, reached + part)
        begin = state
        if operators.prestress is not None:
            begin = state + (attempt - reached) * target * operators.prestress
        equilibrium = newton(operators, attempt * target, begin, converged=converged if attempt == 1.0 else ON_THE_WAY)
        if equilibrium is not None and attempt == 1.0:
            return equilibrium
        if equilibrium is not None:
            state, reached, part = equilibrium[0], attempt, 2.0 * part
            continue
        part *= 0.25
        if part < SMALLEST_PART:
            equilibrium = newton(operators, target, state, unstable=True)
            if equilibrium is None:
                check_rest(operators)
                raise NoEquilibrium(omega)
            return equilibrium


def tangent(operators: Body, omega: float, state: Array) -> csc_array:
    """Stiffness about a state, spin softening included.

    Args:
        operators: of the plate or blade.
        omega: speed [rad/s].
        state: displacement, shape (n,) [m].

    Returns:
        Shape (n, n).
    """
    return _stiffness(operators, omega**2, operators.stressed(state))


def newton(
    operators: Body, load: float, state: Array, unstable: bool = False, converged: float = BALANCED
) -> tuple[Array, Solver] | None:
    """Equilibrium near a state, by Newton's method, with the last factor used.

    Close to the end a factor is used again as long as that brings the energy down at once; conjugate gradients, which
    cost as much again, are not used. Unless an unstable equilibrium will do, the iteration is given up as soon as it
    leaves the stable branch; smaller parts of the load do not leave it.

    Args:
        operators: of the plate or blade.
        load: factor of the unit load.
        state: displacement to begin with, shape (n,) [m].
        unstable: whether an unstable equilibrium will do.
        converged: as for `settle`.

    Returns:
        None where there is none.
    """
    before, ahead = np.inf, None
    for number in range(ITERATIONS):
        stressed = operators.stressed(state)
        residual = unbalanced(operators, load, state, stressed)
        if not np.isfinite(residual).all():  # further than the theory reaches
            return None
        factor = operators.solver(_stiffness(operators, load, stressed, ahead))
        step = factor.solve(residual)
        if factor.negative and number == 0 and not state.any():  # softening is ahead of the stress that will hold it
            ahead = stressed.ahead(operators.solver(stressed.stiffness()).solve(residual))
            factor = operators.solver(_stiffness(operators, load, stressed, ahead))
            step = factor.solve(residual)
        if factor.negative and not unstable:
            return None
        if not np.isfinite(step).all():
            return None
        state = state + step
        work = float(abs(load * operators.load @ state))
        energy = float(abs(step @ residual))
        if energy <= converged * work or (0.1 * before <= energy <= STALLED * work):
            return state, factor
        if number >= WILD and energy > before and not unstable:
            return None
        before = energy
        further, settled = state, False
        if energy <= CLOSE * work and isinstance(factor, Factor):
            enough = max(converged**2, ROUNDED) * work, ROUNDED * work
            further, settled = _again(operators, load, state, factor, energy, enough)
        if settled:
            return further, factor
        ahead = stressed.ahead(step) if further is state else None
        state = further
    return None


def _again(
    operators: Body, load: float, state: Array, factor: Solver, energy: float, enough: tuple[float, float]
) -> tuple[Array, bool]:
    """Steps with a factor that is known, while each has but a small part of the energy of the one before.

    What is left after one falls only by as much again: it ends at the square of what Newton's step ends at, or at
    rounding. energy: of the step before. enough: energies of a step that ends it, and of one that may end it without
    having come down. Returns the state and whether it has come so far.
    """
    while True:
        residual = unbalanced(operators, load, state, operators.stressed(state))
        step = factor.solve(residual)
        following = float(abs(step @ residual))
        if not following <= STILL_GOOD * energy:
            return state, following <= enough[1]
        state, energy = state + step, following
        if energy <= enough[0]:
            return state, True


def unbalanced(operators: Body, load: float, state: Array, stressed: StressedBody) -> Array:
    """The force that is not balanced at a state.

    Args:
        operators: of the plate or blade.
        load: factor of the unit load.
        state: displacement, shape (n,) [m].
        stressed: the body in this state.

    Returns:
        Shape (n,) [N].
    """
    residual = load * operators.load - stressed.force()
    if operators.softening is not None:
        residual += load * (operators.softening @ state)
    return np.asarray(residual)


def _stiffness(operators: Body, load: float, stressed: StressedBody, stress: Any = None) -> csc_array:
    """Tangent stiffness (n, n) under its stress, or another, under load times the unit load."""
    stiffness = stressed.stiffness(stress)
    if operators.softening is not None:
        stiffness = less(stiffness, load, operators.softening)
    return stiffness


def linearise(
    operators: Body, omega: float, start: Array | None = None, state: Array | None = None
) -> tuple[csc_array, Array | None]:
    """The stiffness at a speed, and the state about which it is taken if the deflection is large.

    Args:
        operators: of the plate or blade.
        omega: speed [rad/s].
        start: static displacement (n,) [m] at a neighbouring speed, from which a large deflection is sought.
        state: static displacement (n,) [m] at this speed, if known.

    Returns:
        Stiffness (n, n), and the state (n,) or None.

    Raises:
        ValueError: a speed that is not one finite number.
    """
    check_speed(omega)
    if not operators.effects.large_deflection:
        return operators.at(omega), None
    if omega == 0.0:
        return operators.stiffness, np.zeros_like(operators.load)
    if state is None:
        state = equilibrium(operators, omega, start)
    return tangent(operators, omega, state), state
