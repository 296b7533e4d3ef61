"""The ball's equations integrated by SciPy's `solve_ivp`: independently, sharing no line with `damper`."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

import damper
from workflows.solve.results import Floats

Integrator = Literal["RK45", "DOP853", "LSODA", "Radau"]

_CREEP = 1e-9
"""Relative speed, in omega_1 times the release, below which a hit ends on the wall: near a turning point the paper's
criterion alone never fires."""

_MOST_EVENTS = 20_000

_KNOWN = (
    *("modal_mass", "stiffness", "ball_mass", "ball_radius", "cavity", "centrifugal_acceleration", "restitution"),
    *("friction", "rolling_friction", "damping_ratio", "sticking_ratio", "formulation", "stagger"),
)
"""Fields of a damper that the equations here know, or that a ring-down on a level floor does not depend on."""


@dataclass(frozen=True)
class PeerResult:
    """What `solve_ivp` found: wall hits, evaluations of the equations of motion, and energies [J].

    structure: what the structure's own dashpot took.
    """

    initial: float
    final: float
    structure: float
    impacts: int
    evaluations: int


def integrate(
    damper: damper.ParticleDamper, release: tuple[float, float], cycles: float, method: Integrator, rtol: float
) -> PeerResult:
    """Follow a ring-down for some vibration cycles.

    Raises:
        ValueError: a field of the damper that this integration does not know differs from its default.
        ArithmeticError: the integrator gives up, or events without end.
    """
    for name, default in unknown(damper).items():
        if getattr(damper, name) != default:
            raise ValueError(f"{name} is not part of this integration")
    return _Integration(damper, release, method, rtol).run(2 * math.pi * cycles)


def unknown(damper: damper.ParticleDamper) -> dict[str, Any]:
    """Fields of a damper that this integration does not know, with their defaults."""
    return {field.name: field.default for field in fields(damper) if field.name not in _KNOWN}


class _Integration:
    """Time in 1/omega_1, length in the larger release, mass in M2."""

    def __init__(
        self, damper: damper.ParticleDamper, release: tuple[float, float], method: Integrator, rtol: float
    ) -> None:
        self.length, self.rate = max(map(abs, release)), damper.stuck_frequency
        self.method, self.rtol = method, rtol
        self.m = damper.ball_mass / damper.modal_mass
        self.energy_unit = damper.modal_mass * (self.rate * self.length) ** 2
        self.k = [k / damper.modal_mass / self.rate**2 for k in damper.stiffness]
        self.gap = [gap / self.length for gap in damper.half_gap]
        self.resistance = damper.rolling_threshold / (self.rate**2 * self.length)
        self.printed, self.beta, self.damper = damper.formulation == "printed", damper.inertia_ratio, damper
        self.spin = damper.spin_mass / damper.modal_mass
        self.y: Floats = np.zeros(9)
        self.y[[0, 4]] = [displacement / self.length for displacement in release]
        self.moves = [0, 0]
        self.impacts = self.evaluations = 0

    def run(self, end: float) -> PeerResult:
        initial, t = self.energy(), 0.0
        for axis in (0, 1):
            self.settle(axis)
        for _ in range(_MOST_EVENTS):
            t, happened = self.fly(t, end)
            if not happened:
                return PeerResult(initial, self.energy(), self.energy_unit * self.y[8], self.impacts, self.evaluations)
            for axis, kind in happened:
                self.resolve(axis, kind)
        raise ArithmeticError(f"more than {_MOST_EVENTS} events")

    def dashpot(self, axis: int, stuck: bool) -> float:
        """The c of eq. (1): in the printed equations it follows the mass that moves."""
        return 2 * self.damper.damping_ratio * math.sqrt(self.k[axis] * (1 + self.m if stuck and self.printed else 1))

    def acceleration(self, axis: int, u: float, v: float, moves: int) -> float:
        """That of the structure, the ball stuck (0) or rolling to one side."""
        restoring = self.k[axis] * u + self.dashpot(axis, moves == 0) * v
        if moves == 0:
            return -restoring / (1 + self.m)
        push = self.m * self.resistance * moves
        if self.printed:
            return push - restoring
        return (self.beta * push - restoring) / (1 + (1 - self.beta) * self.m)

    def motion(self, _: float, y: Floats) -> Floats:
        self.evaluations += 1
        rates = np.zeros(9)
        for axis, moves in enumerate(self.moves):
            u, v, _, w = y[4 * axis : 4 * axis + 4]
            a = self.acceleration(axis, u, v, moves)
            relative = 0.0 if moves == 0 else -self.beta * (a + self.resistance * moves)
            rates[4 * axis : 4 * axis + 4] = v, a, (w if moves else 0.0), relative
            rates[8] += self.dashpot(axis, moves == 0) * v**2
        return rates

    def fly(self, t: float, end: float) -> tuple[float, list[tuple[int, str]]]:
        """Integrate to the next event or the end; events of both axes at one instant come together."""
        from scipy.integrate import solve_ivp

        watched = [(axis, kind) for axis in (0, 1) for kind in self.kinds(axis)]
        due = [(axis, kind) for axis, kind in watched if kind != "turn" and self.value(axis, kind, self.y) >= 0]
        if due:
            return t, due[:1]
        solved: Any = solve_ivp(
            self.motion,
            (t, end),
            self.y,
            self.method,
            rtol=self.rtol,
            atol=1e-4 * self.rtol,
            events=[self.watch(axis, kind) for axis, kind in watched],
        )
        if solved.status < 0:
            raise ArithmeticError(solved.message)
        self.y = solved.y[:, -1]
        happened = [key for key, times in zip(watched, solved.t_events, strict=True) if len(times)]
        return float(solved.t[-1]), happened

    def kinds(self, axis: int) -> tuple[str, ...]:
        """What can end the present motion of an axis."""
        if self.moves[axis]:
            return "hit", "turn"
        side = self.side(axis)
        return tuple(kind for kind, way in (("up", 1), ("down", -1)) if way != side)

    def side(self, axis: int) -> int:
        """The wall that a stuck ball rests on, 0 for none."""
        s = self.y[4 * axis + 2]
        return int(np.sign(s)) if abs(s) >= self.gap[axis] * (1 - 1e-12) else 0

    def value(self, axis: int, kind: str, y: Floats) -> float:
        """Rises through zero when it happens."""
        u, v, s, w = y[4 * axis : 4 * axis + 4]
        moves = self.moves[axis]
        if kind == "hit":
            return float(moves * s - self.gap[axis])
        if kind == "turn":
            return float(-moves * w)
        way = 1 if kind == "up" else -1
        drives = ((self.k[axis] * u + self.dashpot(axis, stuck) * v) / (1 + self.m) for stuck in (True, False))
        return float(min(way * drive for drive in drives) - self.resistance)

    def watch(self, axis: int, kind: str) -> Callable[[float, Floats], float]:
        def event(_: float, y: Floats) -> float:
            return self.value(axis, kind, y)

        event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
        return event

    def resolve(self, axis: int, kind: str) -> None:
        if kind == "hit":
            self.hit(axis)
        elif kind == "turn":
            self.settle(axis)
        else:
            self.moves[axis] = 1 if kind == "up" else -1

    def settle(self, axis: int) -> None:
        """The ball has stopped relative to the structure: it stays, or rolls the other way."""
        self.y[4 * axis + 3] = 0.0
        self.moves[axis] = 0
        for kind in self.kinds(axis):
            if self.value(axis, kind, self.y) > 0:
                self.moves[axis] = 1 if kind == "up" else -1
                return

    def hit(self, axis: int) -> None:
        """Restitution along the wall's normal, capped friction along the wall."""
        self.impacts += 1
        m, side = self.m, self.moves[axis]
        v, w = self.y[[4 * axis + 1, 4 * axis + 3]]
        impulse = m / (1 + m) * (1 + self.damper.restitution) * w
        v, w = v + impulse, -self.damper.restitution * w
        self.y[[4 * axis + 1, 4 * axis + 2, 4 * axis + 3]] = v, side * self.gap[axis], w
        self.moves[axis] = -side
        if abs(w) <= max(self.damper.sticking_ratio * abs(v), _CREEP):
            self.y[4 * axis + 1], self.y[4 * axis + 3], self.moves[axis] = v + m / (1 + m) * w, 0.0, 0
        other = 1 - axis
        slide = self.y[4 * other + 3]
        if self.moves[other] and self.damper.friction > 0 and slide != 0:
            most = abs(slide) * m / (1 + m if self.printed else 3.5 + m)  # the ball turns about the vertical, too
            tangential = math.copysign(min(self.damper.friction * abs(impulse), most), slide)
            self.y[4 * other + 1] += tangential
            self.y[4 * other + 3] -= tangential * (1 + m) / m
            if self.printed and self.damper.friction * abs(impulse) >= most:
                self.settle(other)

    def energy(self) -> float:
        total = 0.0
        for axis in (0, 1):
            u, v, _, w = self.y[4 * axis : 4 * axis + 4]
            total += self.k[axis] * u**2 + v**2 + self.m * (v + w) ** 2 + self.spin * w**2
        return 0.5 * total * self.energy_unit
