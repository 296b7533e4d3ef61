"""A slow reference for the ring-down, written from the equations of motion and sharing no code with the engine.

Each axis is the linear system x' = A x for x = (u, v, s, w, 1, spin), with one A per regime; x is stepped densely with
matrix exponentials, every sign change of an event function between two samples is narrowed down. What it can miss, two
roots within one sample, it misses differently at another sampling: run it at two and compare.

Units: time in 1/omega_1 and length in the largest release, so that all numbers are of order one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from scipy.linalg import expm

from damper import Formulation, ParticleDamper

CHUNK = 64


@dataclass
class Axis:
    stiffness: float
    gap: float
    x: np.ndarray  # u, v, s, w, 1, spin
    direction: int = 0
    slips: bool = False
    start: float = 0.0
    next: float = math.inf
    kind: str = ""
    heading: int = 0


@dataclass
class Reference:
    """Runs `cycles` periods on construction; read `events` (time, axis, kind), `impacts`, `final`, `initial`."""

    damper: ParticleDamper
    release: tuple[float, float]
    cycles: float
    samples: int = 1024
    events: list[tuple[float, int, str]] = field(default_factory=list)
    impacts: int = 0
    rolling: float = 0.0

    def __post_init__(self) -> None:
        d = self.damper
        self.length = max(map(abs, self.release))
        self.rate = math.sqrt(d.stiffness[0] / (d.modal_mass + d.ball_mass))
        self.beta = (
            1.0 if d.centrifugal_acceleration == 0 else (5 / 7 if d.formulation is Formulation.CONSISTENT else 5 / 2)
        )
        self.printed = d.formulation is Formulation.PRINTED
        self.m, self.big = d.ball_mass / d.modal_mass, 1.0  # masses in units of M2
        self.total = self.m + self.big
        self.threshold = d.rolling_friction / d.ball_radius * d.centrifugal_acceleration / (self.length * self.rate**2)
        self.grip = (d.floor_friction or 0.0) * d.centrifugal_acceleration / (self.length * self.rate**2)
        scale = d.modal_mass * self.rate**2
        self.axes = [
            Axis(
                d.stiffness[i] / scale,
                (d.cavity[i] / 2 - d.ball_radius) / self.length,
                np.array([self.release[i] / self.length, 0.0, 0.0, 0.0, 1.0, 0.0]),
            )
            for i in range(2)
        ]
        self.initial = self.energy()
        self.run()
        self.final = self.energy()

    # equations of motion -------------------------------------------------------------------------------------

    def dashpot(self, axis: Axis, *, stuck: bool) -> float:
        mass = self.total if stuck and self.printed else self.big
        return 2 * self.damper.damping_ratio * math.sqrt(axis.stiffness * mass)

    def matrix(self, axis: Axis) -> np.ndarray:
        a = np.zeros((6, 6))
        a[0, 1] = 1.0
        if axis.direction == 0:
            a[1, 0], a[1, 1] = -axis.stiffness / self.total, -self.dashpot(axis, stuck=True) / self.total
            if axis.x[5] != 0.0:  # pressed against a wall, spinning
                a[5, 4] = -2.5 * math.copysign(self.grip, axis.x[5])
            return a
        if axis.slips:
            friction = -axis.direction * self.grip  # on the ball, per unit of its mass
            a[1] = [
                -axis.stiffness / self.big,
                -self.dashpot(axis, stuck=False) / self.big,
                0,
                0,
                -self.m * friction / self.big,
                0,
            ]
            a[2, 3] = 1.0
            a[3] = -a[1]
            a[3, 4] += friction
            a[5, 4] = -2.5 * friction
            return a
        sigma = -axis.direction
        if self.printed:
            mass, force = self.big, -self.m * self.threshold * sigma
        else:
            mass, force = self.big + (1 - self.beta) * self.m, -self.beta * self.m * self.threshold * sigma
        a[1] = [-axis.stiffness / mass, -self.dashpot(axis, stuck=False) / mass, 0, 0, force / mass, 0]
        a[2, 3] = 1.0
        a[3] = -self.beta * a[1]
        a[3, 4] += self.beta * self.threshold * sigma
        a[5] = a[3]  # rolling, the spin is the relative velocity
        return a

    # event functions: positive means it has happened ---------------------------------------------------------

    def drives(self, axis: Axis, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """-acceleration by the stuck law and by the rolling law (where rolling would just begin)."""
        u, v = x[..., 0], x[..., 1]
        return tuple((axis.stiffness * u + self.dashpot(axis, stuck=stuck) * v) / self.total for stuck in (True, False))

    def tests(self, axis: Axis, x: np.ndarray) -> dict[str, np.ndarray]:
        if axis.slips:
            return {
                "hit+": x[..., 2] - axis.gap,
                "hit-": -x[..., 2] - axis.gap,
                "grip": -axis.direction * (x[..., 3] - x[..., 5]),
            }
        if axis.direction == 0 and axis.x[5] != 0.0:
            side = math.copysign(1.0, axis.x[2])
            acceleration = -self.drives(axis, x)[0]
            push = math.copysign(self.grip, axis.x[5])
            return {"away": side * (acceleration - push), "grip": -math.copysign(1.0, axis.x[5]) * x[..., 5]}
        if axis.direction != 0:
            return {
                "hit": axis.direction * x[..., 2] - axis.gap,
                "reversal": -axis.direction * x[..., 3],
            }
        stuck, rolling = self.drives(axis, x)
        found = {}
        for d in (-1, 1):
            if d * axis.x[2] < axis.gap:
                found[f"start{d:+d}"] = np.minimum(d * stuck, d * rolling) - self.threshold
        return found

    # detection -----------------------------------------------------------------------------------------------

    def schedule(self, axis: Axis) -> None:
        a = self.matrix(axis)
        dt = 2 * math.pi / self.samples
        powers = _powers(a.tobytes(), dt)
        x, t0 = axis.x, 0.0
        end = 2 * math.pi * self.cycles - axis.start
        previous = self.tests(axis, x)
        # just after a start or a rebound the function that fired is zero: it must first move away
        if axis.direction == 0:
            for kind, value in previous.items():
                if value > 0 and kind != "grip":
                    return self.plan(axis, 0.0, kind)
        elif not axis.slips and previous["hit"] >= 0:
            return self.plan(axis, 0.0, "hit")
        while t0 < end:
            block = powers @ x
            values = self.tests(axis, block)
            best: tuple[float, str] = (math.inf, "")
            for kind, f in values.items():
                k = int(np.argmax(f > 0)) if (f > 0).any() else -1
                if k >= 0:
                    base = x if k == 0 else block[k - 1]
                    lag = self.narrow(axis, a, base, dt, kind)
                    best = min(best, (t0 + k * dt + lag, kind))
            if best[0] < math.inf:
                return self.plan(axis, *best)
            x, t0 = block[-1], t0 + CHUNK * dt
        return self.plan(axis, math.inf, "")

    def plan(self, axis: Axis, lag: float, kind: str) -> None:
        axis.next, axis.kind = axis.start + lag, kind

    def narrow(self, axis: Axis, a: np.ndarray, base: np.ndarray, dt: float, kind: str) -> float:
        """When the first sign change within dt of base happens: its interval cut into CHUNK parts, again and again."""
        low = 0.0
        while dt > 4e-16 * max(low, 1e-3):
            dt /= CHUNK
            block = _powers(a.tobytes(), dt) @ base
            happened = self.tests(axis, block)[kind] > 0
            k = int(np.argmax(happened)) if happened.any() else CHUNK - 1
            low, base = low + k * dt, base if k == 0 else block[k - 1]
        return low + dt

    # resolution ----------------------------------------------------------------------------------------------

    def fly(self, axis: Axis, time: float) -> None:
        new = expm(self.matrix(axis) * (time - axis.start)) @ axis.x
        if axis.direction != 0:
            self.rolling += self.m * self.threshold * abs(new[2] - axis.x[2])
        axis.x, axis.start = new, time

    def settle(self, axis: Axis) -> None:
        axis.x[3] = axis.x[5] = 0.0
        axis.direction, axis.slips = 0, False
        for kind, value in self.tests(axis, axis.x).items():
            if value > 0:
                axis.direction = int(kind.removeprefix("start"))
                return

    def slip(self, axis: Axis) -> None:
        axis.slips = True
        axis.direction = int(math.copysign(1.0, axis.x[3] - axis.x[5]))

    def hit(self, axis: Axis, other: Axis, time: float) -> None:
        d, m, big = self.damper, self.m, self.big
        mbar = m * big / (m + big)
        side = math.copysign(1.0, axis.x[2])
        axis.x[2] = side * axis.gap
        u_n, p_n = axis.x[1], axis.x[1] + axis.x[3]
        closing = u_n - p_n
        axis.x[1] = u_n - mbar * (1 + d.restitution) * closing / big
        axis.x[3] = p_n + mbar * (1 + d.restitution) * closing / m - axis.x[1]
        axis.direction, axis.slips = int(-side), False
        if self.grip > 0:  # the ball's surface rubs up or down the wall, at most until it no longer slides there
            lift = min(d.friction * mbar * (1 + d.restitution) * abs(closing) / m, 2 / 7 * abs(axis.x[5]))
            axis.x[5] -= math.copysign(2.5 * lift, axis.x[5])
        floor = 1e-9
        if abs(axis.x[3]) <= max(d.sticking_ratio * abs(axis.x[1]), floor):
            common = (big * axis.x[1] + m * (axis.x[1] + axis.x[3])) / (m + big)
            axis.x[1], axis.x[3], axis.direction = common, 0.0, 0
        elif self.grip > 0:
            self.slip(axis)
        if self.grip == 0:
            axis.x[5] = axis.x[3]
        if other.direction != 0 and d.friction > 0:
            self.fly(other, time)
            u_t, p_t = other.x[1], other.x[1] + other.x[3]
            slide = u_t - p_t
            if slide != 0 and closing != 0:
                cap = abs(slide / (closing * (1 + d.restitution)))
                mu = math.copysign(min(d.friction, cap), slide / closing)
                other.x[1] = u_t - mu * mbar * (1 + d.restitution) * closing / big
                other.x[3] = p_t + mu * mbar * (1 + d.restitution) * closing / m - other.x[1]
                if self.grip == 0:
                    other.x[5] = other.x[3]
                if d.friction >= cap:
                    other.x[3] = 0.0
                if self.grip > 0 and other.x[3] != other.x[5]:
                    self.slip(other)
                elif d.friction >= cap:
                    self.settle(other)
            self.schedule(other)

    def run(self) -> None:
        end = 2 * math.pi * self.cycles
        for axis in self.axes:
            self.settle(axis)
            self.schedule(axis)
        while True:
            i = 0 if self.axes[0].next <= self.axes[1].next else 1
            axis, other = self.axes[i], self.axes[1 - i]
            time, kind = axis.next, axis.kind
            if time >= end:
                break
            self.events.append((time / (2 * math.pi), i, kind.split("+")[0].split("-")[0]))
            self.fly(axis, time)
            if kind.startswith("hit"):
                self.impacts += 1
                self.hit(axis, other, time)
            elif kind == "reversal":
                self.settle(axis)
            elif kind == "away":
                self.slip(axis)
            elif kind == "grip":
                axis.x[5] = axis.x[3]
                axis.slips = False
                axis.direction = int(np.sign(axis.x[3]))
            else:
                axis.direction = int(kind.removeprefix("start"))
            self.schedule(axis)
        for axis in self.axes:
            self.fly(axis, end)

    def energy(self) -> float:
        spin = 0.0 if self.printed or self.beta == 1.0 else 0.4 * self.m
        return sum(
            0.5 * a.stiffness * a.x[0] ** 2
            + 0.5 * self.big * a.x[1] ** 2
            + 0.5 * self.m * (a.x[1] + a.x[3]) ** 2
            + 0.5 * spin * a.x[5] ** 2
            for a in self.axes
        )


@lru_cache(maxsize=1024)
def _powers(matrix: bytes, dt: float) -> np.ndarray:
    """exp(A k dt) for k = 1 … CHUNK."""
    step = expm(np.frombuffer(matrix).reshape(6, 6) * dt)
    out = np.empty((CHUNK, 6, 6))
    out[0] = step
    for k in range(1, CHUNK):
        out[k] = out[k - 1] @ step
    return out
