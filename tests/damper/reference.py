"""The ball's equations from the Lagrangian, stepped densely by matrix exponentials; they share no code with `damper`.

The coordinates z = (q, s) are the structure's modes and the ball's place in its cavity. The mass matrix is assembled
from the velocities, the forces are gradients of the potentials, a stuck ball is a constraint, an impact an impulse on
s; only the paper's printed equations, which have no Lagrangian, are written as they stand. Between events all is
linear.

Every sign change of a guard between two samples is narrowed down. What this can miss, two roots within one sample, it
misses differently at another sampling: run it at two and compare.
"""

import math
import sys
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from damper import Formulation, Harmonic, Mode, ParticleDamper, RingDown

Floats = np.ndarray
Event = tuple[float, int, str]
"""Time [periods 2 pi / omega_1], axis and kind."""


CHUNK = 64
POWERS = np.arange(20.0)
PARTS = np.vander(np.arange(1, CHUNK + 1) / CHUNK, 20, increasing=True)
_PLACES, WEIGHTS = np.polynomial.legendre.leggauss(16)
NODES = np.vander([*(0.5 + 0.5 * _PLACES), 1.0], 40, increasing=True)
"""Powers of the places in an interval at which Gauss samples it, and of its end."""
KINDS = {1: "start", 2: "reversal", 3: "hit", 5: "grip"}


class Guard(NamedTuple):
    """Its event happens along an axis once the least of `rows @ x` exceeds `threshold`."""

    axis: int
    kind: str
    heading: int
    rows: Floats
    threshold: float

    def value(self, x: Floats) -> Any:
        """Rises through zero when it happens; of one state or of many."""
        return (x @ self.rows.T).min(axis=-1) - self.threshold


class Reference:
    """Follows a ball for some periods, 2 pi / omega_1, or to the last event wanted, on construction.

    It begins from a release, one amplitude [m] for each mode; `place`: of the ball there [m]. Read `events`, `impacts`,
    and energies [J]: `initial`, `final`; `rolling` and `work` of the resistance and of the force.
    """

    def __init__(
        self,
        damper: ParticleDamper,
        release: tuple[float, ...],
        cycles: float,
        samples: int = 1024,
        harmonic: Harmonic | None = None,
        most: int = sys.maxsize,
        place: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        if damper.restitution_by_speed:
            raise ValueError("restitution_by_speed is not part of this integration")
        self.samples, self.most = samples, most
        self.rolling = self.work = 0.0
        self.damper, self.release, self.cycles, self.harmonic = damper, release, cycles, harmonic
        self.events: list[Event] = []
        self.impacts = 0
        d = damper
        modes = d.modes or (
            Mode(d.modal_mass, d.stiffness[0], (1.0, 0.0), (d.floor_tilt[0], 0.0)),
            Mode(d.modal_mass, d.stiffness[1], (0.0, 1.0), (0.0, d.floor_tilt[1])),
        )
        self.k = k = len(modes)
        self.m, self.load, self.printed = d.ball_mass, d.centrifugal_acceleration, d.formulation is Formulation.PRINTED
        self.spring, masses = (np.array([getattr(mode, name) for mode in modes]) for name in ("stiffness", "mass"))
        zeta = np.array([d.damping_ratio if mode.damping_ratio is None else mode.damping_ratio for mode in modes])
        self.dashpot = 2 * zeta * np.sqrt(self.spring * masses)
        self.stuck_dashpot = 2 * zeta * np.sqrt(self.spring * (masses + (self.m if self.printed else 0.0)))
        self.shape, self.slope, drawn = (
            np.array([getattr(mode, name) for mode in modes]).T for name in ("shape", "slope", "participation")
        )
        ride = np.hstack([self.shape, np.eye(2)])  # velocity of the ball's centre
        self.mass = self.m * ride.T @ ride
        self.mass[range(k), range(k)] += masses
        self.push = np.zeros(k + 2)
        if harmonic is not None:
            self.push[:k] = np.array(harmonic.force) @ self.shape + np.array(harmonic.modal or 0.0)
            self.push[:k] -= np.array(harmonic.base) @ drawn
            self.push -= self.m * np.array(harmonic.base) @ ride
        unit = np.eye(k + 2)
        v = [[self.potential(a + b) - self.potential(a) - self.potential(b) for b in unit] for a in unit]
        self.gradient = np.array(v)  # the potential is a quadratic form
        self.a_r = d.rolling_friction / d.ball_radius * self.load
        self.hold = self.a_r + d.break_away * self.load  # of a ball at rest, while it lies in its dent
        self.grip = (d.floor_friction or 0.0) * self.load
        self.gap = [c / 2 - d.ball_radius for c in d.cavity]
        self.rate = math.sqrt(d.stiffness[0] / (d.modal_mass + d.ball_mass))
        self.floor = 1e-9 * self.rate * float(np.abs(self.shape @ release).max())
        self.regime, self.direction = ["stuck", "stuck"], [0, 0]
        self.s, self.w, self.spin = ([start, start + 1] for start in (k, 2 * k + 2, 2 * k + 4))
        self.one, self.wave = 2 * k + 6, 2 * k + 7
        phase = 0.0 if harmonic is None else harmonic.phase
        turn = [1.0, math.cos(phase), math.sin(phase)]
        self.known: dict[tuple[object, ...], Floats] = {}
        self.x: Floats = np.concatenate([release, place, np.zeros(k + 2 + 2), turn])
        self.time, self.initial = 0.0, self.final
        for i in (0, 1) * 4:  # setting off along one axis changes what drives the other
            self.settle(i)
        self.go_on()

    def potential(self, z: Floats) -> float:
        """Of the structure, the load on the tilting and curved floor, and the spin in its plane of rotation."""
        d, q, s = self.damper, z[: self.k], z[self.k :]
        v = 0.5 * self.spring @ q**2 + self.m * self.load * (self.slope @ q) @ s
        if d.floor_radius is not None:
            v += 0.5 * self.m * self.load * sum(s[i] ** 2 / (d.floor_radius[i] - d.ball_radius) for i in range(2))
        out = self.outward(self.shape @ q + s) - self.outward(self.shape @ q)  # the rest is in the stiffness
        return float(v - 0.5 * self.m * d.rotation**2 * out - self.m * np.array(d.lateral_acceleration) @ s)

    def outward(self, at: Floats) -> float:
        """Square of the distance from the axis of rotation in x (flap) and y (chord)."""
        z, y, sine, cosine = *at, math.sin(self.damper.stagger), math.cos(self.damper.stagger)
        return float(y**2 * cosine**2 + z**2 * sine**2 - 2 * y * z * sine * cosine)

    @property
    def final(self) -> float:
        """Energy of structure and ball at present [J]."""
        z, rate, spin = np.split(self.x[: self.one], [self.k + 2, 2 * self.k + 4])
        turning = 0.0 if self.load == 0 or self.printed else 0.2 * self.m * float(spin @ spin)
        return float(0.5 * rate @ self.mass @ rate) + self.potential(z) + turning

    def accelerations(self, regime: list[str]) -> Floats:
        """Rows of z'' over x."""
        k, n, mass = self.k, self.k + 2, self.mass.copy()
        force = self.forces()
        for i in range(2):
            if regime[i] == "roll":
                mass[k + i, k + i] += 0.0 if self.load == 0 else 0.4 * self.m
                force[k + i, self.one] -= self.m * self.a_r * self.direction[i]
            elif regime[i] == "slide":
                force[k + i, self.one] -= self.m * self.grip * self.direction[i]
        free = [*range(k), *(k + i for i in range(2) if regime[i] != "stuck")]
        rows = np.zeros((n, len(self.x)))
        rows[free] = np.linalg.solve(mass[np.ix_(free, free)], force[free])
        if self.printed:
            beta = 1.0 if self.load == 0 else 2.5
            for i in range(2):
                rows[[i, k + i]] = 0.0
                held, push = regime[i] == "stuck", self.a_r * self.direction[i]
                rows[i, i], rows[i, n + i] = -self.spring[i], -(self.stuck_dashpot if held else self.dashpot)[i]
                rows[i, self.one] = 0.0 if held else self.m * push
                rows[i] /= self.damper.modal_mass + (self.m if held else 0.0)
                if not held:
                    rows[k + i] = -beta * rows[i]
                    rows[k + i, self.one] -= beta * push
        return rows

    def forces(self) -> Floats:
        """Rows of the generalised forces on z over x, without what floor and walls do to the ball."""
        n = self.k + 2
        rows = np.zeros((n, len(self.x)))
        rows[:, :n] = -self.gradient
        rows[range(self.k), range(n, n + self.k)] = -self.dashpot
        rows[:, self.wave] = self.push
        rows[self.k :, self.one] = self.m * np.array(self.damper.lateral_acceleration)
        return rows

    def pull(self, i: int) -> Floats:
        """Rows of the force on s, per unit of the ball's mass, that would hold a ball stuck."""
        regime = list(self.regime)
        regime[i] = "stuck"
        key = (i, *regime, *self.direction)
        if key not in self.known:
            self.known[key] = self.held(i, regime)
        return self.known[key]

    def held(self, i: int, regime: list[str]) -> Floats:
        """The rows of `pull`."""
        if self.printed:  # by the stuck and by the rolling law's dashpot
            rows = np.zeros((2, len(self.x)))
            rows[:, i], rows[:, self.k + 2 + i] = self.spring[i], (self.stuck_dashpot[i], self.dashpot[i])
            return rows / (self.damper.modal_mass + self.m)
        row: Floats = self.forces()[self.k + i] - self.mass[self.k + i] @ self.accelerations(regime)
        return row[None] / self.m

    def matrix(self) -> Floats:
        """A in x' = A x."""
        key = (*self.regime, *self.direction, *np.sign(self.x[self.spin]))
        if key in self.known:
            return self.known[key]
        n, a = self.k + 2, np.zeros((len(self.x), len(self.x)))
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n] = self.accelerations(self.regime)
        for i in range(2):
            if self.regime[i] == "roll":
                a[self.spin[i]] = a[self.w[i]]
            elif self.regime[i] == "slide":
                a[self.spin[i], self.one] = 2.5 * self.direction[i] * self.grip
            elif self.x[self.spin[i]] != 0.0:
                a[self.spin[i], self.one] = -2.5 * math.copysign(self.grip, self.x[self.spin[i]])
        if self.harmonic is not None:
            a[self.wave, self.wave + 1], a[self.wave + 1, self.wave] = -self.harmonic.frequency, self.harmonic.frequency
        self.known[key] = a
        return a

    def guards(self) -> list[Guard]:
        """What can end the present flight."""
        found, unit = [], np.eye(len(self.x))
        for i in range(2):
            s, w, spin, d = unit[self.s[i]], unit[self.w[i]], unit[self.spin[i]], self.direction[i]
            at, turning = self.x[self.s[i]], self.x[self.spin[i]]
            if self.regime[i] == "stuck" and turning != 0:
                side = math.copysign(1, at)
                found.append(Guard(i, "away", 0, -side * self.pull(i), side * math.copysign(self.grip, turning)))
                found.append(Guard(i, "grip", 0, -math.copysign(1, turning) * spin[None], 0.0))
            elif self.regime[i] == "stuck":
                ways = [way for way in (-1, 1) if way * at < self.gap[i]]
                found += [Guard(i, "start", way, way * self.pull(i), self.hold) for way in ways]
            elif self.regime[i] == "roll":
                found += [Guard(i, "hit", d, d * s[None], self.gap[i]), Guard(i, "reversal", 0, -d * w[None], 0.0)]
            else:
                found += [Guard(i, "hit", side, side * s[None], self.gap[i]) for side in (-1, 1)]
                found.append(Guard(i, "grip", 0, -d * (w - spin)[None], 0.0))
        return found

    def step(self) -> bool:
        """To the next event or to the end; whether it was an event."""
        period = 2 * math.pi / self.rate
        left = self.cycles * period - self.time
        if left <= 0:
            return False
        guards = self.guards()
        now = [g for g in guards if (g.kind in ("start", "away") and g.value(self.x) > 0) or self.pushed(g)]
        lag, guard, x = (0.0, now[0], self.x) if now else self.fly(self.matrix(), guards, left)
        self.x = x.copy()
        self.time += left if guard is None else lag
        if guard is not None:
            self.events.append((self.time / period, guard.axis, guard.kind))
            self.happen(guard)
        return guard is not None

    def pushed(self, guard: Guard) -> bool:
        """Whether a hit of the other wall has just pushed the ball into the wall that it was on."""
        at, rate = guard.heading * self.x[self.s[guard.axis]], guard.heading * self.x[self.w[guard.axis]]
        return bool(guard.kind == "hit" and at >= guard.threshold and rate > 0)

    def happen(self, guard: Guard) -> None:
        """Change velocities and regimes at an event."""
        i, x = guard.axis, self.x
        if guard.kind == "hit":
            self.impacts += 1
            x[self.s[i]] = guard.heading * self.gap[i]
            self.hit(i)
        elif guard.kind == "reversal":
            self.settle(i)
        elif guard.kind == "grip":
            x[self.spin[i]] = x[self.w[i]]
            if self.regime[i] != "stuck":
                self.roll(i, int(np.sign(x[self.w[i]])))
        elif guard.kind == "away":
            self.slide(i)
        else:
            self.roll(i, guard.heading)

    def roll(self, i: int, direction: int) -> None:
        """From now on, to one side; 0: stuck."""
        self.regime[i], self.direction[i] = ("roll" if direction else "stuck"), direction
        if direction:  # out of the dent, along both axes
            self.hold = self.a_r

    def slide(self, i: int) -> None:
        """From now on, to the side to which the ball's surface moves on the floor."""
        self.regime[i], self.direction[i] = "slide", 1 if self.x[self.w[i]] > self.x[self.spin[i]] else -1
        self.hold = self.a_r

    def settle(self, i: int) -> None:
        """Stuck, or off the way that the ball is driven."""
        self.x[self.w[i]] = self.x[self.spin[i]] = 0.0
        self.roll(i, 0)
        for guard in self.guards():
            if guard.axis == i and guard.value(self.x) > 0:
                self.roll(i, guard.heading)

    def impulse(self, i: int, w: float) -> float:
        """Give s_i the velocity w by an impulse on it: the floor has no time to act."""
        n = self.k + 2
        jump = np.linalg.solve(self.mass, np.eye(n)[self.k + i])
        size = (w - self.x[self.w[i]]) / jump[self.k + i]
        self.x[n : 2 * n] += size * jump
        self.x[self.w[i]] = w
        j = 1 - i
        if self.regime[j] == "stuck" and abs(self.x[self.w[j]]) <= 1e-7 * self.floor:
            self.x[self.w[j]] = 0.0  # two walls that push the ball to each other in turn: the limit of the series
        return float(size)

    def hit(self, i: int) -> None:
        """Restitution along the wall's normal, capped friction along the wall, sticking."""
        d, k, j, x = self.damper, self.k, 1 - i, self.x
        moved = x[self.w[j]]
        normal = abs(self.impulse(i, -d.restitution * x[self.w[i]]))
        if self.grip > 0:  # the ball's surface rubs up or down the wall, at most until it no longer slides there
            lift = min(d.friction * normal, 2 / 7 * self.m * abs(x[self.spin[i]]))
            x[self.spin[i]] -= math.copysign(2.5 * lift / self.m, x[self.spin[i]])
        if x[self.w[j]] != moved:
            self.after(j)
        if self.regime[j] != "stuck" and d.friction > 0:
            slides = x[self.w[j]]
            give = np.linalg.inv(self.mass)[k + j, k + j]
            spun = 0.0 if self.printed else 2.5 / self.m  # of the surface, as the ball turns about the vertical
            change = give * min(d.friction * normal, abs(slides) / (give + spun))
            left = slides - math.copysign(change, slides)
            self.impulse(j, 0.0 if abs(left) < 1e-15 * abs(slides) else left)
            if self.grip > 0 and x[self.w[j]] != x[self.spin[j]]:
                self.slide(j)
                if x[self.w[j]] == 0 and abs(x[self.s[j]]) >= self.gap[j]:
                    self.roll(j, 0)
            else:
                x[self.spin[j]] = x[self.w[j]]
                if x[self.w[j]] == 0:
                    self.settle(j)
        structure = self.shape[i] @ x[k + 2 : 2 * k + 2]
        if abs(x[self.w[i]]) <= max(d.sticking_ratio * abs(structure), self.floor):
            moved = x[self.w[j]]
            self.impulse(i, 0.0)
            self.roll(i, 0)
            if self.grip == 0:
                x[self.spin[i]] = 0.0
            if x[self.w[j]] != moved:
                self.after(j)
        else:
            self.after(i)

    def after(self, i: int) -> None:
        """The spin follows at once, or the ball slides."""
        if self.grip > 0:
            self.slide(i)
        else:
            self.x[self.spin[i]] = self.x[self.w[i]]
            self.roll(i, int(np.sign(self.x[self.w[i]])))

    def go_on(self) -> None:
        while len(self.events) < self.most and self.step():
            pass

    def fly(self, a: np.ndarray, guards: list[Guard], left: float) -> tuple[float, Guard | None, np.ndarray]:
        lag, guard, x = self.next(a, guards, left)
        if guard is None or lag >= left:
            lag, guard, x = left, None, expm(a * left) @ self.x
        self.book(a, lag, x)
        return lag, guard, x

    def next(self, a: np.ndarray, guards: list[Guard], left: float) -> tuple[float, Guard | None, np.ndarray]:
        """When the first guard's event happens, which, and the state then."""
        dt, x, t = 2 * math.pi / self.rate / self.samples, self.x, 0.0
        while t < left:
            block = np.concatenate([x[None], _powers(a.tobytes(), dt) @ x])
            happened = np.array([guard.value(block[1:]) > 0 for guard in guards])
            if happened.any():
                k = int(np.argmax(happened.any(axis=0)))
                found = [(*self.narrow(a, guards[n], block[k], dt), n) for n in np.flatnonzero(happened[:, k])]
                lag, x, n = min(found, key=lambda each: each[0])
                return t + k * dt + lag, guards[n], x
            x, t = block[-1], t + CHUNK * dt
        return left, None, x

    def narrow(self, a: np.ndarray, guard: Guard, x: np.ndarray, dt: float) -> tuple[float, np.ndarray]:
        """When a guard's event happens within dt of x, and the state then: the first of CHUNK parts, and its zero."""
        terms = _series(a, x, dt, 20)
        rows = terms @ guard.rows.T
        happened = (PARTS @ rows).min(axis=1) > guard.threshold
        k = int(np.argmax(happened)) if happened.any() else CHUNK - 1

        def value(share: float) -> float:
            return float((share**POWERS @ rows).min()) - guard.threshold

        share, high, step = k / CHUNK, (k + 1) / CHUNK, 1e-19
        if value(share) < 0 < value(high):
            share = brentq(value, share, high, xtol=1e-19, rtol=1e-15)
        while share < high and value(share) <= 0:  # it has happened
            share, step = min(share + step, high), 2 * step
        return share * dt, share**POWERS @ terms

    def book(self, a: np.ndarray, lag: float, new: np.ndarray) -> None:
        """Count what rolling resistance and force do on the way to a new state."""
        for i in range(2):
            if self.regime[i] == "roll":
                self.rolling += self.m * self.a_r * abs(new[self.s[i]] - self.x[self.s[i]])
        if self.harmonic is not None:
            pieces, x = max(1, math.ceil(lag * self.rate * 1.3)), self.x
            for _ in range(pieces):
                states = NODES @ _series(a, x, lag / pieces, 40)
                power = states[:-1, self.wave] * (states[:-1, self.k + 2 : 2 * self.k + 4] @ self.push)
                self.work += 0.5 * lag / pieces * float(WEIGHTS @ power)
                x = states[-1]


def _series(a: np.ndarray, x: np.ndarray, span: float, count: int) -> np.ndarray:
    """Taylor's series of exp(A t) x in powers of t / span."""
    terms = [x]
    for k in range(1, count):
        terms.append(a @ terms[-1] * (span / k))
    return np.array(terms)


@lru_cache(maxsize=1024)
def _powers(matrix: bytes, dt: float) -> np.ndarray:
    """exp(A k dt) for k = 1 … CHUNK."""
    n = math.isqrt(len(matrix) // 8)
    step = expm(np.frombuffer(matrix).reshape(n, n) * dt)
    out = np.empty((CHUNK, n, n))
    out[0] = step
    for k in range(1, CHUNK):
        out[k] = out[k - 1] @ step
    return out


def events(run: RingDown) -> list[Event]:
    """Those of a ring-down, as a `Reference` lists them."""
    period = 2 * math.pi / run.damper.stuck_frequency
    names = {**KINDS, "pulled from a wall": "away"}
    return [
        (
            r["time"] / period,
            int(r["axis"]),
            names["pulled from a wall" if r["kind"] == 1 and r["regime"] == 2 else r["kind"]],
        )
        for r in run.rows
        if r["kind"] in KINDS
    ]


def agreed(a: list[Event], b: list[Event], tolerance: float = 1e-9) -> int:
    """How many events of two runs are the same, from the first one on."""
    for k, (p, q) in enumerate(zip(a, b, strict=False)):
        if p[1:] != q[1:] or not abs(p[0] - q[0]) < tolerance:
            return k
    return min(len(a), len(b))
