"""The ball's equations on a level floor, integrated by SciPy's `solve_ivp`; they share no code with `damper`.

Along each axis the structure's displacement q and the ball's place s in its cavity; an impact is an impulse between the
two. The tests have the equations of all floors, modes and forces (`tests/damper/reference.py`).
"""

import math
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any, Literal

import numpy as np

from damper import Formulation, ParticleDamper
from workflows.solve.results import Floats

Integrator = Literal["RK45", "DOP853", "LSODA", "Radau"]

LEVEL = ("break_away", "floor_tilt", "floor_radius", "lateral_acceleration", "rotation", "modes")
"""Fields of a damper that keep the default here: the paper's fixed steps know no other value either."""

_DEFAULT = (*LEVEL, "floor_friction", "restitution_by_speed")

_MOST_EVENTS = 20_000


class Integration:
    """Follows a ball for some periods, 2 pi / omega_1, from a release [m] along both axes.

    Read `impacts`, `evaluations` of the equations; energies [J]: `initial`, `final`, and `structure`, what the
    structure's own dashpots took.

    Raises:
        ValueError: a field of the damper is not part of this integration.
        ArithmeticError: the integrator gives up, or events without end.
    """

    def __init__(
        self,
        damper: ParticleDamper,
        release: tuple[float, float],
        cycles: float,
        method: Integrator,
        rtol: float,
    ) -> None:
        for field in fields(damper):
            if field.name in _DEFAULT and getattr(damper, field.name) != field.default:
                raise ValueError(f"{field.name} is not part of this integration")
        self.damper = d = damper
        self.printed = d.formulation is Formulation.PRINTED
        self.free, self.m, self.load = d.modal_mass, d.ball_mass, d.centrifugal_acceleration
        self.spring = np.array(d.stiffness)
        damped = 2 * d.damping_ratio * np.sqrt(self.spring)
        self.stuck_mass = self.free + self.m
        self.dashpot = damped * math.sqrt(self.free)
        self.stuck_dashpot = damped * math.sqrt(self.stuck_mass) if self.printed else self.dashpot
        # A rolling ball follows by beta: of the acceleration of a solid sphere 5/7, without a floor all; printed: 5/2.
        self.beta = 1.0 if self.load == 0 else 5 / 2 if self.printed else 5 / 7
        self.rolling_mass = self.free + (0.0 if self.printed else self.m * (1 - self.beta))
        self.resistance = d.rolling_friction / d.ball_radius * self.load
        self.drag = self.resistance * self.m * (1.0 if self.printed else self.beta)
        self.gap = np.array(d.cavity) / 2 - d.ball_radius
        rate = math.sqrt(d.stiffness[0] / self.stuck_mass)
        self.least_speed = 1e-9 * rate * max(map(abs, release))
        length, speed = max(map(abs, release)), max(map(abs, release)) * rate
        self.how: dict[str, Any] = {"method": method, "rtol": rtol}
        self.how["atol"] = 1e-4 * rtol * np.repeat([length, speed, self.free * speed**2], [4, 4, 1])
        self.impacts = self.evaluations = 0
        self.structure = 0.0
        self.direction = np.zeros(2, dtype=int)
        """In which the ball rolls along each axis; 0: stuck."""
        self.y: Floats = np.array([*release, *[0.0] * 7])
        """q, s, q', s' along both axes, and the energy that the dashpots took."""
        self.initial = self.final
        for axis in (0, 1):
            self.settle(axis)
        self.follow(cycles * 2 * math.pi / rate)

    @property
    def final(self) -> float:
        """Energy of structure and ball at present [J]."""
        q, _, v, w = self.y[:8].reshape(4, 2)
        spin = 0.0 if self.load == 0 or self.printed else 0.2 * self.m
        kinetic = 0.5 * self.free * v @ v + 0.5 * self.m * (v + w) @ (v + w) + spin * w @ w
        return float(kinetic + 0.5 * self.spring @ q**2)

    def motion(self) -> Callable[[float, Floats], Floats]:
        """Rates of the state until the next event."""
        rolls = self.direction != 0
        dashpot = np.where(rolls, self.dashpot, self.stuck_dashpot)
        mass = np.where(rolls, self.rolling_mass, self.stuck_mass)
        matrix, constant = np.zeros((9, 9)), np.zeros(9)
        matrix[:4, 4:8] = np.eye(4)
        matrix[4:6, :2], matrix[4:6, 4:6] = np.diag(-self.spring / mass), np.diag(-dashpot / mass)
        constant[4:6] = self.drag * self.direction / mass
        follows = np.where(rolls, -self.beta, 0.0)
        matrix[6:8] = follows[:, None] * matrix[4:6]
        constant[6:8] = follows * (constant[4:6] + self.resistance * self.direction)

        def rates(_: float, y: Floats) -> Floats:
            self.evaluations += 1
            changed: Floats = matrix @ y + constant
            changed[8] = dashpot @ y[4:6] ** 2
            return changed

        return rates

    def guards(self) -> list[tuple[Callable[[Floats], float], Callable[[], None]]]:
        """What can end the present flight: what rises through zero when it happens, and what happens then."""
        found: list[tuple[Callable[[Floats], float], Callable[[], None]]] = []
        for i, way in enumerate(self.direction.tolist()):
            if way == 0:
                found += [(partial(self.drive, i, side), partial(self.roll, i, side)) for side in (-1, 1)]
            else:
                found.append((partial(self.overlap, i, way), partial(self.hit, i, way)))
                found.append((partial(self.return_speed, i, way), partial(self.settle, i)))
        return found

    def overlap(self, i: int, way: int, y: Floats) -> float:
        """Of ball and wall."""
        return float(way * y[2 + i] - self.gap[i])

    def return_speed(self, i: int, way: int, y: Floats) -> float:
        """Of the ball, back from where it rolls."""
        return float(-way * y[6 + i])

    def drive(self, i: int, way: int, y: Floats) -> float:
        """By which the floor fails to hold a stuck ball, by the stuck and by the rolling law's dashpot."""
        pulls = (self.spring[i] * y[i] + dashpot[i] * y[4 + i] for dashpot in (self.stuck_dashpot, self.dashpot))
        held = way * self.y[2 + i] >= self.gap[i]
        return -1.0 if held else min(way * pull for pull in pulls) / self.stuck_mass - self.resistance

    def follow(self, end: float) -> None:
        """From event to event until a time [s]."""
        from scipy.integrate import solve_ivp

        time, events = 0.0, 0
        while time < end:
            guards = self.guards()
            now = [happen for value, happen in guards if value(self.y) > 0]
            if not now:
                watched = [_watched(value) for value, _ in guards]
                solved: Any = solve_ivp(self.motion(), (0.0, end - time), self.y, events=watched, **self.how)
                if solved.status < 0:
                    raise ArithmeticError(solved.message)
                self.y = solved.y[:, -1].copy()
                self.structure = float(self.y[8])
                time += float(solved.t[-1])
                now = [happen for (_, happen), times in zip(guards, solved.t_events, strict=True) if len(times)]
                if not now:
                    return
            now[0]()
            events += 1
            if events > _MOST_EVENTS:
                raise ArithmeticError(f"more than {_MOST_EVENTS} events")

    def roll(self, i: int, way: int) -> None:
        """From now on."""
        self.direction[i] = way

    def settle(self, i: int) -> None:
        """Stuck, or off the way that the ball is driven."""
        self.y[6 + i] = self.direction[i] = 0
        for way in (-1, 1):
            if self.drive(i, way, self.y) > 0:
                self.roll(i, way)

    def impulse(self, i: int, w: float) -> float:
        """Give s_i' the value w by an impulse between ball and structure: the floor has no time to act."""
        size = (w - self.y[6 + i]) / (1 / self.free + 1 / self.m)
        self.y[4 + i] -= size / self.free
        self.y[6 + i] = w
        return float(size)

    def hit(self, i: int, way: int) -> None:
        """Restitution along the wall's normal, capped friction along the wall, sticking."""
        d, j, y = self.damper, 1 - i, self.y
        self.impacts += 1
        y[2 + i] = way * self.gap[i]
        normal = abs(self.impulse(i, -d.restitution * y[6 + i]))
        if self.direction[j] != 0 and d.friction > 0:
            slides, give = y[6 + j], 1 / self.free + 1 / self.m
            spun = 0.0 if self.printed else 2.5 / self.m  # of the surface, as the ball turns about the vertical
            left = slides - math.copysign(give * min(d.friction * normal, abs(slides) / (give + spun)), slides)
            self.impulse(j, 0.0 if abs(left) < 1e-15 * abs(slides) else left)
            if y[6 + j] == 0:
                self.settle(j)
        if abs(y[6 + i]) <= max(d.sticking_ratio * abs(y[4 + i]), self.least_speed):
            self.impulse(i, 0.0)
        self.direction[i] = np.sign(y[6 + i])


def _watched(value: Callable[[Floats], float]) -> Any:
    """An event of `solve_ivp` that ends it where a value rises through zero."""

    def event(_: float, y: Floats) -> float:
        return value(y)

    event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
    return event
