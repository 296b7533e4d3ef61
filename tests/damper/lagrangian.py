"""Structure and ball integrated densely from the Lagrangian, sharing no code with the engine.

The coordinates are the structure's modes q and the ball's place s in its cavity. The mass matrix is assembled from the
velocities, the forces are gradients of the potentials, a stuck ball is a constraint, an impact an impulse on s; DOP853
takes the steps and finds the events. Two of its step lengths differ in what either of them gets wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from damper import Harmonic, Mode, ParticleDamper

TIGHT = 1e-13


@dataclass
class Lagrangian:
    """Runs until `end` on construction; read `events` (time, axis, kind), `final`, `initial` and `work`."""

    damper: ParticleDamper
    release: np.ndarray  # amplitudes of the modes
    end: float
    harmonic: Harmonic | None = None
    step: float = math.inf
    most: int = 200
    place: tuple[float, float] = (0.0, 0.0)  # of the ball at the release
    events: list[tuple[float, int, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        d = self.damper
        modes = d.modes or (
            Mode(d.modal_mass, d.stiffness[0], (1.0, 0.0), (d.floor_tilt[0], 0.0)),
            Mode(d.modal_mass, d.stiffness[1], (0.0, 1.0), (0.0, d.floor_tilt[1])),
        )
        self.k = len(modes)
        self.m, self.load = d.ball_mass, d.centrifugal_acceleration
        self.spring = np.array([mode.stiffness for mode in modes])
        masses = np.array([mode.mass for mode in modes])
        zeta = [d.damping_ratio if mode.damping_ratio is None else mode.damping_ratio for mode in modes]
        self.dashpot = 2 * np.array(zeta) * np.sqrt(self.spring * masses)
        self.shape = np.array([mode.shape for mode in modes]).T
        self.slope = np.array([mode.slope for mode in modes]).T
        self.drawn = np.array([mode.participation for mode in modes]).T
        ride = np.hstack([self.shape, np.eye(2)])  # velocity of the ball's centre
        self.mass = self.m * ride.T @ ride
        self.mass[range(self.k), range(self.k)] += masses
        self.ride = ride
        self.a_r = d.rolling_friction / d.ball_radius * self.load
        self.grip = (d.floor_friction or 0.0) * self.load
        self.gap = [c / 2 - d.ball_radius for c in d.cavity]
        self.floor = 1e-9 * d.stuck_frequency * float(np.abs(self.shape @ self.release).max())
        self.regime, self.direction = ["stuck", "stuck"], [0, 0]
        self.y = np.concatenate([self.release, self.place, np.zeros(self.k + 2 + 2 + 1)])
        self.time = 0.0
        self.initial = self.energy()
        self.run()
        self.final, self.work = self.energy(), self.y[-1]

    # equations of motion -----------------------------------------------------------------------------------

    def parts(self, y: np.ndarray) -> tuple[np.ndarray, ...]:
        k = self.k
        return y[:k], y[k : k + 2], y[k + 2 : 2 * k + 2], y[2 * k + 2 : 2 * k + 4], y[2 * k + 4 : 2 * k + 6]

    def potential(self, q: np.ndarray, s: np.ndarray) -> float:
        """Of the structure, the load on the tilting and curved floor, and the spin in its plane of rotation."""
        d, u, tilt = self.damper, self.shape @ q, self.slope @ q
        v = 0.5 * self.spring @ q**2 + self.m * self.load * tilt @ s
        if d.floor_radius is not None:
            v += 0.5 * self.m * self.load * sum(s[i] ** 2 / (d.floor_radius[i] - d.ball_radius) for i in range(2))
        out = self.outward(u + s) - self.outward(u)  # what it does to a ball in its place is in the stiffness
        return float(v - 0.5 * self.m * d.rotation**2 * out)

    def outward(self, at: np.ndarray) -> float:
        """Square of the distance from the axis of rotation in x (flap) and y (chord)."""
        z, y, sine, cosine = *at, math.sin(self.damper.stagger), math.cos(self.damper.stagger)
        return float(y**2 * cosine**2 + z**2 * sine**2 - 2 * y * z * sine * cosine)

    def forces(self, t: float, y: np.ndarray) -> np.ndarray:
        """Generalised forces on (q, s), without what the floor and the walls do to the ball."""
        q, s, qd, _, _ = self.parts(y)
        z = np.concatenate([q, s])
        out = -self.gradient @ z
        out[: self.k] -= self.dashpot * qd
        return out + self.push(t)

    @property
    def gradient(self) -> np.ndarray:
        """Hessian of the potential, by its values: it is a quadratic form."""
        if not hasattr(self, "_hessian"):
            n, k = self.k + 2, self.k
            unit = np.eye(n)

            def v(z: np.ndarray) -> float:
                return self.potential(z[:k], z[k:])

            self._hessian = np.array(
                [[v(unit[i] + unit[j]) - v(unit[i]) - v(unit[j]) for j in range(n)] for i in range(n)]
            )
        return self._hessian

    def push(self, t: float) -> np.ndarray:
        """Of the harmonic."""
        h, out = self.harmonic, np.zeros(self.k + 2)
        if h is not None:
            out[: self.k] = np.array(h.force) @ self.shape - np.array(h.base) @ self.drawn + np.array(h.modal or 0.0)
            out -= self.m * np.array(h.base) @ self.ride
            out *= math.cos(h.frequency * t + h.phase)
        return out

    def accelerations(self, t: float, y: np.ndarray, regime: list[str]) -> np.ndarray:
        """(q'', s'')"""
        k, mass, force = self.k, self.mass.copy(), self.forces(t, y)
        for i in range(2):
            if regime[i] == "roll":
                mass[k + i, k + i] += 0.0 if self.load == 0 else 0.4 * self.m
                force[k + i] -= self.m * self.a_r * self.direction[i]
            elif regime[i] == "slide":
                force[k + i] -= self.m * self.grip * self.direction[i]
        free = [*range(k), *(k + i for i in range(2) if regime[i] != "stuck")]
        out = np.zeros(k + 2)
        out[free] = np.linalg.solve(mass[np.ix_(free, free)], force[free])
        return out

    def pull(self, t: float, y: np.ndarray, i: int) -> float:
        """Force on s, per unit of the ball's mass, that holds a ball stuck: the constraint's."""
        regime = list(self.regime)
        regime[i] = "stuck"
        z = self.accelerations(t, y, regime)
        return float(self.forces(t, y)[self.k + i] - self.mass[self.k + i] @ z) / self.m

    def rhs(self, t: float, y: np.ndarray) -> np.ndarray:
        k = self.k
        _, _, qd, sd, spin = self.parts(y)
        a = self.accelerations(t, y, self.regime)
        turn = np.zeros(2)
        for i in range(2):
            if self.regime[i] == "roll":
                turn[i] = a[k + i]
            elif self.regime[i] == "slide":
                turn[i] = 2.5 * self.direction[i] * self.grip
            elif spin[i] != 0.0:
                turn[i] = -2.5 * math.copysign(self.grip, self.spun[i])
        power = self.push(t) @ np.concatenate([qd, sd])
        return np.concatenate([qd, sd, a, turn, [power]])

    # events ------------------------------------------------------------------------------------------------

    def guards(self) -> list[tuple[int, str, int, object]]:
        """(axis, kind, heading, function that rises through zero)"""
        found = []
        for i in range(2):
            s, w, spin, d = self.k + i, 2 * self.k + 2 + i, 2 * self.k + 4 + i, self.direction[i]
            if self.regime[i] == "stuck" and self.y[spin] != 0:
                side = math.copysign(1, self.y[s])
                hold, way = side * math.copysign(self.grip, self.y[spin]), math.copysign(1, self.y[spin])
                found.append((i, "away", 0, lambda t, y, i=i, side=side, hold=hold: -side * self.pull(t, y, i) - hold))
                found.append((i, "grip", 0, lambda t, y, way=way, spin=spin: -way * y[spin]))
            elif self.regime[i] == "stuck":
                for d in (-1, 1):
                    if d * self.y[s] < self.gap[i]:
                        found.append((i, "start", d, lambda t, y, i=i, d=d: d * self.pull(t, y, i) - self.a_r))
            elif self.regime[i] == "roll":
                found.append((i, "hit", d, lambda t, y, i=i, s=s, d=d: d * y[s] - self.gap[i]))
                found.append((i, "reversal", 0, lambda t, y, w=w, d=d: -d * y[w]))
            else:
                found += [
                    (i, "hit", side, lambda t, y, i=i, s=s, side=side: side * y[s] - self.gap[i]) for side in (-1, 1)
                ]
                found.append((i, "grip", 0, lambda t, y, w=w, spin=spin, d=d: -d * (y[w] - y[spin])))
        return found

    def run(self) -> None:
        for i in (0, 1) * 4:  # setting off along one axis changes what drives the other
            self.settle(i)
        self.go_on()

    def go_on(self) -> None:
        scale = max(float(np.abs(self.release).max()), 1e-3)
        while self.time < self.end and len(self.events) < self.most:
            guards = self.guards()
            self.spun = self.parts(self.y)[4].copy()
            now = [g for g in guards if g[1] in ("start", "away") and g[3](self.time, self.y) > 0]
            if now:
                self.happen(*now[0][:3])
                continue
            functions = [g[3] for g in guards]
            for f in functions:
                f.terminal, f.direction = True, 1.0
            flight = self.flight(functions, scale, self.step)
            step = 0.01
            while self.at_once(flight, guards) and step > 1e-7:  # it left the wall and came back within a step
                flight, step = self.flight(functions, scale, step), 0.1 * step
            which = [n for n, times in enumerate(flight.t_events) if len(times)]
            self.time, self.y = float(flight.t[-1]), flight.y[:, -1].copy()
            if flight.status == 1:
                self.happen(*guards[which[0]][:3])

    def flight(self, functions: list, scale: float, step: float):
        return solve_ivp(
            self.rhs, (self.time, self.end), self.y, "DOP853", rtol=TIGHT, atol=TIGHT * 1e-2 * scale,
            events=functions, max_step=step, first_step=min(step, 1e-3, self.end - self.time),
        )  # fmt: skip

    def at_once(self, flight, guards: list) -> bool:
        """Whether the event found is a hit that the ball moves away from."""
        hits = [g for g, times in zip(guards, flight.t_events, strict=True) if len(times) and g[1] == "hit"]
        return bool(hits) and flight.t[-1] - self.time < 1e-9 and self.y[2 * self.k + 2 + hits[0][0]] * hits[0][2] < 0

    def happen(self, i: int, kind: str, heading: int) -> None:
        self.events.append((self.time, i, kind))
        k = self.k
        if kind == "hit":
            self.y[k + i] = heading * self.gap[i]
            self.hit(i, heading)
        elif kind == "reversal":
            self.y[2 * k + 2 + i] = self.y[2 * k + 4 + i] = 0.0
            self.settle(i)
        elif kind == "grip":
            self.y[2 * k + 4 + i] = self.y[2 * k + 2 + i]
            if self.regime[i] != "stuck":
                self.roll(i, int(np.sign(self.y[2 * k + 2 + i])))
        elif kind == "away":
            self.slide(i)
        else:
            self.roll(i, heading)

    def roll(self, i: int, direction: int) -> None:
        self.regime[i], self.direction[i] = ("roll" if direction else "stuck"), direction

    def slide(self, i: int) -> None:
        k = self.k
        self.regime[i], self.direction[i] = "slide", 1 if self.y[2 * k + 2 + i] > self.y[2 * k + 4 + i] else -1

    def settle(self, i: int) -> None:
        self.roll(i, 0)
        for d in (-1, 1):
            if d * self.y[self.k + i] < self.gap[i] and d * self.pull(self.time, self.y, i) > self.a_r:
                self.roll(i, d)

    def impulse(self, i: int, w: float) -> float:
        """Give s_i the velocity w by an impulse on it: the floor has no time to act."""
        k = self.k
        jump = np.linalg.solve(self.mass, np.eye(k + 2)[k + i])
        size = (w - self.y[2 * k + 2 + i]) / jump[k + i]
        self.y[k + 2 : 2 * k + 4] += size * jump
        self.y[2 * k + 2 + i] = w
        return float(size)

    def hit(self, i: int, side: int) -> None:
        d, k, j = self.damper, self.k, 1 - i
        w, spin = 2 * k + 2, 2 * k + 4
        moved = self.y[w + j]
        normal = self.impulse(i, -d.restitution * self.y[w + i])
        if self.grip > 0:  # the ball's surface rubs up or down the wall, at most until it no longer slides there
            lift = min(d.friction * abs(normal), 2 / 7 * self.m * abs(self.y[spin + i]))
            self.y[spin + i] -= math.copysign(2.5 * lift / self.m, self.y[spin + i])
        if self.y[w + j] != moved:
            self.after(j)
        if self.regime[j] != "stuck" and d.friction > 0:
            way, slides = math.copysign(1, self.y[w + j]), abs(self.y[w + j])
            change = d.friction * abs(normal) * np.linalg.inv(self.mass)[k + j, k + j]
            self.impulse(j, 0.0 if change >= slides else self.y[w + j] - way * change)
            if self.grip > 0 and self.y[w + j] != self.y[spin + j]:
                self.slide(j)
                if self.y[w + j] == 0 and abs(self.y[k + j]) >= self.gap[j]:
                    self.roll(j, 0)
            else:
                self.y[spin + j] = self.y[w + j]
                if change >= slides:
                    self.settle(j)
        structure = self.shape[i] @ self.y[k + 2 : 2 * k + 2]
        if abs(self.y[w + i]) <= max(d.sticking_ratio * abs(structure), self.floor):
            moved = self.y[w + j]
            self.impulse(i, 0.0)
            self.roll(i, 0)
            if self.grip == 0:
                self.y[spin + i] = 0.0
            if self.y[w + j] != moved:
                self.after(j)
        else:
            self.after(i)

    def after(self, i: int) -> None:
        """The spin follows at once, or the ball slides."""
        k = self.k
        if self.grip > 0:
            self.slide(i)
        else:
            self.y[2 * k + 4 + i] = self.y[2 * k + 2 + i]
            self.roll(i, int(np.sign(self.y[2 * k + 2 + i])))

    def energy(self) -> float:
        q, s, qd, sd, spin = self.parts(self.y)
        v = np.concatenate([qd, sd])
        turning = 0.0 if self.load == 0 else 0.2 * self.m * float(spin @ spin)
        return float(0.5 * v @ self.mass @ v) + self.potential(q, s) + turning
