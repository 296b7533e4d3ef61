"""The equations of `workflows.studies.work_precision.integration`, stepped densely with matrix exponentials.

Every sign change of a guard between two samples is narrowed down. What this can miss, two roots within one sample, it
misses differently at another sampling: run it at two and compare.
"""

import math
import sys
from functools import lru_cache

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from damper import Harmonic, ParticleDamper, RingDown
from workflows.studies.work_precision.integration import Event, Guard, Integration

CHUNK = 64
POWERS = np.arange(20.0)
PARTS = np.vander(np.arange(1, CHUNK + 1) / CHUNK, 20, increasing=True)
_PLACES, WEIGHTS = np.polynomial.legendre.leggauss(16)
NODES = np.vander([*(0.5 + 0.5 * _PLACES), 1.0], 40, increasing=True)
"""Powers of the places in an interval at which Gauss samples it, and of its end."""
KINDS = {1: "start", 2: "reversal", 3: "hit", 5: "grip"}


class Reference(Integration):
    """Runs on construction, until the end or the last event wanted; read `rolling` and `work`, too."""

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
        self.samples, self.most = samples, most
        self.rolling = self.work = 0.0
        super().__init__(damper, release, cycles, harmonic=harmonic, place=place)

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
    assert run.rows is not None
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
