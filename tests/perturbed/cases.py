"""The hard cases of every iterative solver in `fem`, and what is asked of each."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fem import (
    Divergence,
    Effects,
    Material,
    Operators,
    Plate,
    Rotor,
    campbell,
    critical_speed,
    displacement,
    equilibrium,
    rectangle,
    reduce_at,
    reduce_over,
    solve_modes,
)
from fem.accuracy.error_estimates import probe
from fem.linalg import rounding
from fem.statics import linearise
from tests.perturbed.changes import Problem, Units

STEEL = Material(2e11, 0.3, 7850.0)
LAG = np.pi / 2
"""Stagger at which flapping is in the plane of rotation."""

EXACT = 1e-9
"""Relative difference of two answers that counts as none, beside what rounding leaves uncertain."""


class Answer(NamedTuple):
    """Numbers in SI units and what may be uncertain of each, relatively; or how else it ended."""

    values: np.ndarray
    uncertain: np.ndarray
    ending: str = ""


@dataclass(frozen=True)
class Case:
    """A problem, what is asked of it, and how it is to end if not with an answer."""

    problem: Problem
    ask: Callable[[Operators, Units], Answer]
    ending: str = ""

    def answer(self, operators: Operators, units: Units) -> Answer:
        """What is found, or how it ended."""
        try:
            return self.ask(operators, units)
        except Divergence as ended:
            return Answer(np.array([ended.count]), np.zeros(1), type(ended).__name__)
        except (ArithmeticError, np.linalg.LinAlgError) as ended:
            return Answer(np.empty(0), np.empty(0), type(ended).__name__)


def modes(speed: float, count: int = 6, **keys: float) -> Callable[[Operators, Units], Answer]:
    """Frequencies at a speed in rad/s."""
    return lambda operators, units: _frequencies(operators, speed / units.time, count, units, **keys)


def near(distance: float, count: int = 6, **keys: float) -> Callable[[Operators, Units], Answer]:
    """Frequencies at a relative distance below the critical speed, or beyond."""

    def ask(operators: Operators, units: Units) -> Answer:
        speed = critical_speed(operators)
        found = _frequencies(operators, (1.0 - distance) * speed, count, units, **keys)
        return found._replace(uncertain=found.uncertain + _of_critical(operators, speed))

    return ask


def _of_critical(operators: Operators, speed: float) -> float:
    """What rounding leaves uncertain of a critical speed in rad/s: that of the elastic energy of the mode lost there.

    The mode is taken from a speed some way below, at which it is hardly another.
    """
    shape = solve_modes(replace(operators, gyroscopic=None), 0.9 * speed, 1).shapes
    energy = (shape.T @ (operators.stiffness @ shape))[0]
    return float(rounding(operators.stiffness, shape, energy)[0])


def _frequencies(operators: Operators, omega: float, count: int, units: Units, **keys: float) -> Answer:
    found = solve_modes(operators, omega, count, **keys)
    stiffness, _ = linearise(operators, omega, found.state)
    uncertain = rounding(stiffness, np.abs(found.shapes), found.eigenvalues)
    values = [found.frequencies_hz * units.time]
    if keys:  # damping ratios are told as well as the least certain mode
        values.append(found.damping_ratios)
        uncertain = np.append(uncertain, np.full(count, uncertain.max()))
    return Answer(np.concatenate(values), uncertain)


def critical(operators: Operators, units: Units) -> Answer:
    """The critical speed in rad/s."""
    speed = critical_speed(operators)
    uncertain = _of_critical(operators, speed) if np.isfinite(speed) else 0.0
    return Answer(np.array([speed * units.time]), np.array([uncertain]))


def sweep(top: float | None = None) -> Callable[[Operators, Units], Answer]:
    """Frequencies up to a speed in rad/s, else up to 1e-6 from the critical one, with their bounds."""

    def ask(operators: Operators, units: Units) -> Answer:
        highest = (1.0 - 1e-6) * critical_speed(operators) if top is None else top / units.time
        found = campbell(operators, highest * np.linspace(0.0, 1.0, 9), 6)
        return Answer(found.frequencies_hz.ravel() * units.time, found.bounds.ravel())

    return ask


def felt(top: float, mass: float, at: tuple[float, float] = (0.2, 0.0)) -> Callable[[Operators, Units], Answer]:
    """Frequencies that a ball's mass in kg leaves at several speeds, with their modal mass."""

    def ask(operators: Operators, units: Units) -> Answer:
        speeds = np.linspace(0.0, top, 5) / units.time
        place = at[0] * units.length, at[1] * units.length
        found = reduce_over(operators, campbell(operators, speeds, 4), place, ball_mass=mass * units.mass)
        found.append(reduce_at(operators, float(speeds[-1]), place, ball_mass=mass * units.mass))
        rates = np.array([[each.f1_hz, each.f2_hz] for each in found]) * units.time
        masses = np.array([[each.M2, each.slope] for each in found]) / np.array([units.mass, 1.0 / units.length])
        return Answer(
            np.concatenate([rates.ravel(), masses.ravel()]),
            np.repeat([1e-6, 1e-4], rates.size),  # what the diagram is asked for, and shapes that go with it
        )

    return ask


def probed(top: float, exact: float = 1e-7) -> Callable[[Operators, Units], Answer]:
    """Frequencies at rest and at a speed in rad/s, as meshes are compared by."""

    def ask(operators: Operators, units: Units) -> Answer:
        found = probe(operators, (0.0, top / units.time), 6, exact)
        values = np.concatenate([each.eigenvalues for each in found]) * units.time**2
        return Answer(values, np.full(values.size, 3.0 * exact))

    return ask


def bent(speed: float) -> Callable[[Operators, Units], Answer]:
    """How far corners are bent at a speed in rad/s, relative to the farthest, and the frequencies then."""

    def ask(operators: Operators, units: Units) -> Answer:
        omega = speed / units.time
        moved = displacement(operators, equilibrium(operators, omega))[:, 2] / units.length
        found = _frequencies(operators, omega, 4, units)
        farthest = np.abs(moved).max(keepdims=True)
        return Answer(np.append(found.values, farthest), np.append(found.uncertain, found.uncertain.max()))

    return ask


def _plate(length: float, width: float, cells: tuple[int, int], thickness: float, nu: float = 0.3) -> Plate:
    return Plate(rectangle(length, width, *cells), thickness, Material(2e11, nu, 7850.0))


SMALL = _plate(0.2, 0.08, (6, 4), 0.004)
SQUARE_SECTION = _plate(1.0, 0.02, (20, 1), 0.02, 0.0)
INWARD = Plate(rectangle(1.0, 0.02, 30, 1).translated((-1.0, 0.0)), 0.001, Material(2e11, 0.0, 7850.0))
PRESSED = rectangle(0.2, 0.08, 6, 3).translated((-0.2, 0.0))
SOFTENED, TURNING = Effects(stress_stiffening=False), Effects(coriolis=True)
BENT = Effects(large_deflection=True)
SOFTENED_TURNING = replace(SOFTENED, coriolis=True)


def _cases() -> dict[str, Case]:
    made: dict[str, Case] = {}
    falling = Problem(SMALL, Rotor(stagger=LAG), SOFTENED)
    turning = replace(falling, effects=SOFTENED_TURNING)
    for distance in (1e-3, 1e-6, 1e-9, 1e-10):
        made[f"modes {distance:g} from the critical speed"] = Case(falling, near(distance))
        made[f"complex modes {distance:g} from the critical speed"] = Case(turning, near(distance))
    made["damped modes 1e-06 from the critical speed"] = Case(turning, near(1e-6, damping_ratio=0.01))
    for distance in (1e-3, 1e-6):
        made[f"{distance:g} beyond the critical speed"] = Case(falling, near(-distance), "Divergence")
        made[f"complex, {distance:g} beyond the critical speed"] = Case(turning, near(-distance), "Divergence")
    made["sweep up to 1e-6 from the critical speed"] = Case(falling, sweep())
    made["complex sweep up to 1e-6 from the critical speed"] = Case(turning, sweep())

    pairs = Problem(SQUARE_SECTION, Rotor(), Effects(), "solid")
    made["double modes"] = Case(pairs, modes(0.0))
    made["pairs of modes at speed"] = Case(pairs, modes(30.0, 8))
    made["complex pairs of modes"] = Case(replace(pairs, effects=TURNING), modes(30.0))
    thin = _plate(1.0, 1.0, (6, 6), 1e-5)
    for theory in ("kirchhoff", "mindlin"):
        made[f"thin, {theory}"] = Case(Problem(thin, Rotor(), Effects(), theory), modes(0.0))
        made[f"thin and complex, {theory}"] = Case(Problem(thin, Rotor(0.1, 0.5), TURNING, theory), modes(3.0))
    made["thin, solid"] = Case(Problem(replace(thin, thickness=1e-4), Rotor(), Effects(), "solid"), modes(0.0))
    strip = _plate(1.0, 0.01, (30, 1), 1e-3)
    made["thirty modes of a strip"] = Case(Problem(strip, Rotor(), Effects()), modes(20.0, 30))
    made["thirty complex modes of a strip"] = Case(Problem(strip, Rotor(0.1, 0.5), TURNING), modes(20.0, 30))
    membrane = Problem(_plate(1.0, 0.02, (30, 1), 1e-4, 0.0), Rotor(), Effects())
    made["a membrane"] = Case(membrane, modes(50.0))
    made["a complex membrane"] = Case(replace(membrane, rotor=Rotor(stagger=0.5), effects=TURNING), modes(50.0))
    bob = Problem(replace(SMALL, tip_mass=5e5, tip_at=(0.2, 0.0)), Rotor(), Effects())
    made["a mass of a million plates"] = Case(bob, modes(0.0))
    made["a mass of a million plates, complex"] = Case(replace(bob, effects=TURNING), modes(0.5))
    made["hardly spinning"] = Case(Problem(SMALL, Rotor(0.1, 0.5), TURNING), modes(1e-12))
    floating = Problem(SMALL, Rotor(), replace(SOFTENED_TURNING, spin_softening=False))
    made["Coriolis far beyond elasticity"] = Case(floating, modes(5e4))
    made["no rotary inertia"] = Case(
        Problem(SMALL, Rotor(0.1, 0.2), replace(TURNING, rotary_inertia=False)), modes(1e3)
    )
    made["an inward beam, almost buckling"] = Case(Problem(INWARD, Rotor(-1.0), Effects()), near(1e-6, 4))

    for name, plate, rotor, effects in (
        ("strip in its plane", _plate(1.0, 0.02, (12, 2), 0.001), Rotor(), Effects()),
        ("far above the first frequency", SMALL, Rotor(stagger=LAG), Effects()),
        ("of a short and wide plate", _plate(0.02, 1.0, (2, 12), 0.001), Rotor(), Effects()),
        ("of a strip that has none", _plate(1.0, 0.02, (24, 4), 0.001), Rotor(), Effects()),
        ("of an inward beam", INWARD, Rotor(-1.0), Effects()),
    ):
        made[f"critical speed {name}"] = Case(Problem(plate, rotor, effects), critical)

    fast, blade = Effects(), _plate(0.2, 0.08, (8, 4), 0.004)
    made["sweep"] = Case(Problem(blade, Rotor(0.2, 0.6), fast), sweep(1800.0))
    made["complex sweep"] = Case(Problem(blade, Rotor(0.1, 0.6), TURNING), sweep(1250.0))
    heavy = replace(blade, tip_mass=500.0, tip_at=(0.2, 0.0))
    made["sweep that no basis answers"] = Case(Problem(heavy, Rotor(0.1, 0.5), fast), sweep(16.2))
    made["felt by a heavy ball"] = Case(Problem(blade, Rotor(0.1, 0.5), fast), felt(1800.0, 2.0))
    made["felt by a ball without weight"] = Case(Problem(blade, Rotor(0.1, 0.5), fast), felt(1800.0, 1e-9))
    made["probing at three times the first frequency"] = Case(
        Problem(_plate(0.2, 0.1, (6, 3), 0.002), Rotor(0.1, 0.3), fast), probed(2094.0)
    )
    made["probing, bent"] = Case(Problem(_plate(0.2, 0.1, (6, 3), 0.002), Rotor(0.1, 0.3), BENT), probed(600.0))

    square = _plate(0.2, 0.2, (4, 4), 0.002)
    made["a square twisted by its load"] = Case(Problem(square, Rotor(0.0, np.pi / 4), BENT), bent(419.0))
    strip = _plate(0.2, 0.08, (8, 4), 0.001)
    made["a thin strip untwists"] = Case(Problem(strip, Rotor(0.1, 0.7), BENT), bent(419.0))
    pressed = Plate(PRESSED, 1e-3, STEEL)
    made["pressed beyond equilibrium"] = Case(Problem(pressed, Rotor(-0.2, 0.7), BENT), bent(3e4), "NoEquilibrium")
    made["pressed until it is unstable"] = Case(
        Problem(replace(pressed, thickness=1e-4), Rotor(-0.2, LAG), BENT), bent(100.0), "Divergence"
    )
    return made


CASES = _cases()
