"""Flights between events: in closed form, or as power series.

In closed form the structure is a damped oscillator about a constant offset, u = offset + exp(-decay tau) (a C + b S)
with C = cos(omega tau) and S = sin(omega tau) / omega, which stays accurate as damping nears its critical value and
omega zero; the ball follows as s = s0 + w0 tau - beta (u - u0 - v0 tau) + f tau**2 / 2: rolling, with beta of its
inertia and f of the rolling resistance; slipping, with beta = 1 and f of the sliding friction.

Linear flights are taken in steps, on which every coordinate is a power series of `damper.state.TERMS` terms. `expand`
makes the series of a group from its state, `travel` moves the group on and books the work by Lobatto's rule. Series
are computed eight numbers at a time (`load`, `store`, `fill`, `times`, `add_times`, `total`): vectors for the
compiler, arrays in plain Python.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numba as nb
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.cgutils import get_or_insert_function
from numba.extending import intrinsic, models, register_model
from numba.np.arrayobj import make_array
from numpy.polynomial import legendre

from damper.compiled import fused, kernel
from damper.state import ROLLING, SLIPPING, STUCK, TERMS

if TYPE_CHECKING:
    from damper.model import Floats, Record, Records


_SHORT = 0.1
"""Phase angle below which differences are summed as a series, since u - u0 - v0 tau would cancel."""
_TERMS = 10
_NODES = tuple(float(0.5 * (1.0 + x)) for x in np.polynomial.legendre.leggauss(5)[0])
_WEIGHTS = tuple(float(0.5 * w) for w in np.polynomial.legendre.leggauss(5)[1])
_RECIPROCALS = tuple(1.0 / max(k, 1) for k in range(_TERMS + 2))


@kernel
def begin(axis: Record, laws: Records, ball: Record, time: float) -> None:
    """Start a flight from the state in `axis`: the constants of its closed form."""
    law = laws[axis.regime]
    axis.start = time
    axis.beta, axis.f, push = 0.0, 0.0, 0.0
    if axis.regime == ROLLING:
        axis.beta, axis.f = ball.inertia_ratio, -axis.direction * ball.relative_push
        push = axis.direction * ball.push
    elif axis.regime == SLIPPING:
        axis.beta, axis.f = 1.0, -axis.direction * ball.grip
        push = -ball.mass * axis.f
    axis.offset = push / law.stiffness
    axis.a = axis.u - axis.offset
    axis.b = axis.v + law.decay * axis.a


@kernel
def wave(law: Record, tau: float) -> tuple[float, float]:
    """C and S: the cosine, and the sine over the frequency [s]."""
    angle = law.frequency * tau
    return math.cos(angle), math.sin(angle) / law.frequency


@kernel
def structure(axis: Record, law: Record, tau: float) -> tuple[float, float, float]:
    """Displacement, velocity and acceleration of the structure, to the rounding of its amplitude about the offset.

    A heavy ball pushes the offset far out: just after the start, `increments` are better.
    """
    c, s = wave(law, tau)
    e = math.exp(-law.decay * tau) if law.decay > 0.0 else 1.0
    p = e * (axis.a * c + axis.b * s)
    v = e * (axis.b * c - law.frequency * law.frequency * axis.a * s) - law.decay * p
    acceleration = -2 * law.decay * v - law.square * p
    return axis.offset + p, v, acceleration


@kernel
def velocity(axis: Record, law: Record, tau: float) -> tuple[float, float]:
    """Velocity and acceleration of the structure."""
    if tau == 0.0:
        return axis.v, -2 * law.decay * axis.v - law.square * (axis.u - axis.offset)
    _, dv, acceleration = increments(axis, law, tau)
    return axis.v + dv, acceleration


@kernel
def increments(axis: Record, law: Record, tau: float) -> tuple[float, float, float]:
    """U - u0 - v0 tau, v - v0 and the acceleration, without cancellation however small tau is."""
    if law.frequency * tau > _SHORT or law.decay * tau > _SHORT:
        u, v, acceleration = structure(axis, law, tau)
        return u - axis.u - axis.v * tau, v - axis.v, acceleration
    square = law.square
    first = axis.v
    second = -2 * law.decay * axis.v - square * (axis.u - axis.offset)
    du = dv = ddv = 0.0
    power = 1.0  # tau**k / k!
    for k in range(_TERMS):
        ddv += second * power
        power *= tau * _RECIPROCALS[k + 1]
        dv += second * power
        du += second * power * tau * _RECIPROCALS[k + 2]
        first, second = second, -2 * law.decay * second - square * first
    return du, dv, ddv


@kernel
def relative(axis: Record, law: Record, tau: float) -> tuple[float, float, float, float]:
    """Position, velocity, acceleration and jerk of a moving ball relative to the structure."""
    du, dv, acceleration = increments(axis, law, tau)
    jerk = -2.0 * law.decay * acceleration - law.square * (axis.v + dv)
    return (
        axis.s + axis.w * tau - axis.beta * du + 0.5 * axis.f * tau * tau,
        axis.w - axis.beta * dv + axis.f * tau,
        axis.f - axis.beta * acceleration,
        -axis.beta * jerk,
    )


@kernel
def first_extremum(axis: Record, law: Record, order: int) -> float:
    """First tau > 0 at which derivative `order` + 1 of u vanishes (order 2: acceleration is extreme)."""
    p, q = axis.a, axis.b
    for _ in range(order + 1):
        p, q = q - law.decay * p, -law.frequency * law.frequency * p - law.decay * q
    if p == 0.0 and q == 0.0:
        return np.inf
    angle = math.atan2(law.frequency * p, -q) if p > 0.0 else math.atan2(-law.frequency * p, q)
    return (angle if angle > 0.0 else math.pi) / law.frequency


@kernel
def viscous_loss(axis: Record, law: Record, tau: float) -> float:
    """Work of the structure's dashpot over a flight of length tau, c * integral of v**2 [J]."""
    if law.damping == 0.0:
        return 0.0
    if law.frequency * tau <= _SHORT and law.decay * tau <= _SHORT:  # the closed form would cancel: by Gauss
        square = 0.0
        for k in range(5):
            square += _WEIGHTS[k] * (axis.v + increments(axis, law, _NODES[k] * tau)[1]) ** 2
        return float(law.damping * tau * square)
    alpha, c, s = law.decay, *wave(law, tau)
    e = math.exp(-2 * alpha * tau)
    gone = -math.expm1(-2 * alpha * tau)
    # integrals of exp(-2 alpha t) times C S and S^2; that of C^2 is what 1 leaves over omega^2 S^2
    mixed = (1.0 - e * (2 * alpha * s * c + c * c - (law.frequency * s) ** 2)) / (4 * law.square)
    sines = (gone - 2 * e * alpha * s * (alpha * s + c)) / (4 * alpha * law.square)
    cosines = 0.5 * gone / alpha - law.frequency**2 * sines
    fall = alpha * axis.v + law.square * axis.a  # v = exp(-alpha t) (v0 C - fall S)
    return law.damping * (axis.v * axis.v * cosines - 2 * axis.v * fall * mixed + fall * fall * sines)


WIDTH = 8


class _Eight(types.Type):
    """What the compiler takes for eight numbers."""

    def __init__(self) -> None:
        super().__init__("Eight")


_EIGHT: Any = _Eight()
_VECTOR, _INDEX = ir.VectorType(ir.DoubleType(), WIDTH), ir.IntType(32)


class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, _VECTOR)


register_model(_Eight)(_Model)


def _place(context: Any, builder: Any, row: Any, values: Any) -> Any:
    """Pointer to eight neighbours in a row, from the place values[1] on."""
    data = make_array(row)(context, builder, value=values[0]).data
    return builder.bitcast(builder.gep(data, [values[1]]), _VECTOR.as_pointer())


if TYPE_CHECKING or nb.config.DISABLE_JIT:

    def load(row: Floats, k: int) -> Floats:
        """Eight neighbours in a row, from place k on."""
        return row[k : k + WIDTH].copy()

    def store(row: Floats, k: int, eight: Floats) -> None:
        """Put eight numbers into a row, from place k on."""
        row[k : k + WIDTH] = eight

    def fill(x: float) -> Floats:
        """Eight times the same number."""
        return np.full(WIDTH, x)

    def times(a: Floats, b: Floats) -> Floats:
        """Products."""
        return a * b

    def add_times(c: Floats, a: Floats, b: Floats) -> Floats:
        """Sums c + a b, fused where the processor can."""
        return c + a * b

    def total(a: Floats) -> float:
        """Sum of the eight."""
        return float(((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7])))

    def positive(a: Floats) -> Floats:
        """Absolute values."""
        return np.abs(a)

    def powers(x: float) -> Floats:
        """From the zeroth to the seventh."""
        power = np.array([1.0, x] * 4)
        power[[2, 3, 6, 7]] *= x * x
        power[4:] *= (x * x) * (x * x)
        return power

else:

    @intrinsic
    def load(_, row, k):
        """Load eight."""

        def code(context, builder, signature, values):
            return builder.load(_place(context, builder, row, values), align=8)

        return _EIGHT(row, types.intp), code

    @intrinsic
    def store(_, row, k, eight):
        """Store eight."""

        def code(context, builder, signature, values):
            builder.store(values[2], _place(context, builder, row, values), align=8)
            return context.get_dummy_value()

        return types.void(row, types.intp, eight), code

    @intrinsic
    def fill(_, x):
        """Repeat a number."""

        def code(context, builder, signature, values):
            nothing = ir.Constant(_VECTOR, ir.Undefined)
            one = builder.insert_element(nothing, values[0], _INDEX(0))
            return builder.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(_INDEX, WIDTH), [0] * WIDTH))

        return _EIGHT(types.float64), code

    @intrinsic
    def times(_, a, b):
        """Multiply."""

        def code(context, builder, signature, values):
            return builder.fmul(*values)

        return _EIGHT(a, b), code

    @intrinsic
    def add_times(_, c, a, b):
        """Multiply and add."""

        def code(context, builder, signature, values):
            return builder.fadd(values[0], builder.fmul(*values[1:], flags=["contract"]), flags=["contract"])

        return _EIGHT(c, a, b), code

    @intrinsic
    def total(_, a):
        """Sum up: halves onto each other."""

        def code(context, builder, signature, values):
            (each,) = values
            for half in (4, 2, 1):
                nothing = ir.Constant(ir.VectorType(ir.DoubleType(), 2 * half), ir.Undefined)
                low, high = (
                    builder.shuffle_vector(each, nothing, ir.Constant(ir.VectorType(_INDEX, half), list(places)))
                    for places in (range(half), range(half, 2 * half))
                )
                each = builder.fadd(low, high)
            return builder.extract_element(each, _INDEX(0))

        return types.float64(a), code

    @intrinsic
    def positive(_, a):
        """Take absolute values."""

        def code(context, builder, signature, values):
            name = f"llvm.fabs.v{WIDTH}f64"
            of_vectors = get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), name)
            return builder.call(of_vectors, values)

        return _EIGHT(a), code

    @intrinsic
    def powers(_, x):
        """Multiply by the first, the second and the fourth power where they are part."""

        def code(context, builder, signature, values):
            (power,) = values
            nothing, result = ir.Constant(_VECTOR, ir.Undefined), ir.Constant(_VECTOR, [1.0] * WIDTH)
            for bit in range(3):
                two = builder.insert_element(nothing, ir.Constant(ir.DoubleType(), 1.0), _INDEX(0))
                two = builder.insert_element(two, power, _INDEX(1))
                parts = ir.Constant(ir.VectorType(_INDEX, WIDTH), [k >> bit & 1 for k in range(WIDTH)])
                result = builder.fmul(result, builder.shuffle_vector(two, nothing, parts))
                power = builder.fmul(power, power)
            return result

        return _EIGHT(types.float64), code


@fused
def expand(g: int, it: Record, flow: Floats) -> None:
    """The series of a group from its state on."""
    system, axes, terms = it.system, it.axes, flow[regimes(g, it)]
    first, last, count = system.first[g], system.last[g], system.high[g] - system.low[g]
    sources = gather(g, it.motion.start[g], it)
    c, source, series = it.motion.series[g], it.motion.source, count + last - first
    for lane in range(count if system.cavity[first] == 0 else series):
        _combine(c[lane], terms[lane], source, sources)
    for i in range(first, last):
        if axes[i].regime == STUCK:
            _combine(c[series + i - first], terms[series + i - first], source, sources)
    if system.frequency > 0.0:
        for lane in range(series + last - first, series + last - first + 2):
            _combine(c[lane], terms[lane], source, sources)


@fused
def regimes(g: int, it: Record) -> int:
    """Which flow a group's regimes ask for."""
    if it.system.groups == 1:
        return int(3 * it.axes[0].regime + it.axes[1].regime)
    return int(3 * g + it.axes[g].regime)


@fused
def gather(g: int, time: float, it: Record) -> int:
    """What a group's flight begins with at a time, from its state and regimes; returns how many sources count."""
    system, motion = it.system, it.motion
    low, count, span, source = system.low[g], system.high[g] - system.low[g], system.span[g], motion.source
    for m in range(count):
        source[m], source[count + m] = motion.z[low + m], motion.rate[low + m] * span
    sources = 2 * count
    for i in range(system.first[g], system.last[g]):
        source[sources] = _resisting(it.axes[i], it.ball) - system.lateral[i]
        sources += 1
    if system.frequency > 0.0:
        angle = system.frequency * time + system.phase
        source[sources], source[sources + 1] = math.cos(angle), math.sin(angle)
        sources += 2
    return int(sources)


@fused
def _resisting(axis: Record, ball: Record) -> float:
    """What resists the motion of the ball along an axis, in the direction of that motion or sliding [m/s²]."""
    if axis.regime == ROLLING:
        return float(axis.direction * ball.threshold)
    return float(axis.direction * ball.grip) if axis.regime == SLIPPING else 0.0


@fused
def _combine(c: Floats, terms: Floats, source: Floats, sources: int) -> None:
    """A series from its sources."""
    x = fill(source[0])
    one, two, three = times(load(terms[0], 0), x), times(load(terms[0], 8), x), times(load(terms[0], 16), x)
    for j in range(1, sources):
        x, row = fill(source[j]), terms[j]
        one, two = add_times(one, load(row, 0), x), add_times(two, load(row, 8), x)
        three = add_times(three, load(row, 16), x)
    store(c, 0, one)
    store(c, 8, two)
    store(c, 16, three)


NTH = np.arange(TERMS + 0.0)
_FACTORS = np.array([NTH > 0, NTH, NTH * (NTH - 1), NTH * (NTH - 1) * (NTH - 2)])
"""Factors of the terms of a series: in what it gains from its start on, and in its first three derivatives."""

_LAST = TERMS - WIDTH
_LEFT = np.array(
    [
        np.append(row[m : m + _LAST], np.where(_LAST + m > NTH, 0.0, row)[_LAST:])
        for m, row in zip((1, 1, 2, 3), _FACTORS, strict=True)
    ]
)
"""The same from the first term on that does not vanish; the last row of eight has the last terms."""


@fused
def _summed(c: Floats, which: int, x: float) -> float:
    """Sum of a series' terms times their factors, the powers of x that all of them have left out."""
    square = x * x
    fourth = square * square
    eighth = fourth * fourth
    first = max(which, 1)
    last = eighth * fourth * (x if first == 3 else square)
    if first == 1:
        last *= x
    terms = times(load(c, first), load(_LEFT[which], 0))
    terms = add_times(terms, times(load(c, first + WIDTH), load(_LEFT[which], WIDTH)), fill(eighth))
    terms = add_times(terms, times(load(c, _LAST), load(_LEFT[which], _LAST)), fill(last))
    return total(times(terms, powers(x)))


@fused
def increment(c: Floats, x: float) -> tuple[float, float]:
    """What a series gains from 0 to x, and its slope there."""
    return x * _summed(c, 0, x), _summed(c, 1, x)


@fused
def rates(c: Floats, x: float) -> tuple[float, float]:
    """First and second derivative of a series."""
    return _summed(c, 1, x), _summed(c, 2, x)


ALL, SECOND, THIRD, FOURTH, REST = range(5)
"""What `sizes` bounds: a series, its derivatives times powers of x, its terms from the third on."""

_SIZES = np.array([NTH >= 0, *_FACTORS[2:], _FACTORS[3] * (NTH - 3), NTH > 2])


@fused
def sizes(c: Floats, which: int, x: float) -> float:
    """Sum of the sizes of a series' terms at x, each times its factor."""
    low, middle, high = positive(load(c, 0)), positive(load(c, 8)), positive(load(c, 16))
    return total(times(_horner(low, middle, high, _SIZES[which], fill(_eighth(x))), powers(x)))


@fused
def places(c: Floats, x: float) -> tuple[float, float, float]:
    """What a series gains from 0 to x, its slope there times x and its second derivative times x²."""
    power, eighth = powers(x), fill(_eighth(x))
    low, middle, high = load(c, 0), load(c, 8), load(c, 16)
    return (
        total(times(_horner(low, middle, high, _FACTORS[0], eighth), power)),
        total(times(_horner(low, middle, high, _FACTORS[1], eighth), power)),
        total(times(_horner(low, middle, high, _FACTORS[2], eighth), power)),
    )


@fused
def _eighth(x: float) -> float:
    fourth = (x * x) * (x * x)
    return fourth * fourth


@fused
def _horner(low: Floats, middle: Floats, high: Floats, factors: Floats, eighth: Floats) -> Floats:
    """Rows of eight terms, times their factors, as a polynomial in the eighth power."""
    beyond = add_times(times(middle, load(factors, 8)), times(high, load(factors, 16)), eighth)
    return add_times(times(low, load(factors, 0)), beyond, eighth)


@fused
def third(c: Floats, x: float) -> float:
    """Third derivative of a series."""
    return _summed(c, 3, x)


_POINTS = 8


def lobatto() -> tuple[Floats, Floats]:
    """Points and weights of Lobatto's rule on [0, 1].

    Points inside are roots of the Jacobi polynomial of weight 1 - x², which are the eigenvalues of a symmetric matrix
    (G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221) and so float64 whatever the version of numpy.
    """
    k = np.arange(1, _POINTS - 2)
    inside = np.linalg.eigvalsh(np.diag(np.sqrt(k * (k + 2) / ((2 * k + 1) * (2 * k + 3))), -1), UPLO="L")
    points = np.array([-1.0, *(0.5 * (inside - inside[::-1])), 1.0])
    weights = 2.0 / (_POINTS * (_POINTS - 1) * legendre.legval(points, np.eye(_POINTS)[-1]) ** 2)
    return 0.5 * (1.0 + points), 0.5 * weights


_PLACES, _SHARES = lobatto()
_ORDER = np.arange(TERMS)[:, None]

_SLOPES = _ORDER * _PLACES ** np.maximum(_ORDER - 1, 0)
_SLOPES[:, 0] = _ORDER[:, 0] > 0
"""Of a scaled series: what it gains, then its slopes at all points but the first, where it has its second term."""

_VALUES = _PLACES**_ORDER

_POINT_WEIGHTS = _SHARES * (np.arange(_POINTS) > 0)
_FIRST = float(_SHARES[0])


@fused
def travel(g: int, x: float, it: Record) -> None:
    """Bring a group's coordinates x steps on, and book the work."""
    system, motion = it.system, it.motion
    low, high, c, scaled = system.low[g], system.high[g], motion.series[g], motion.scaled
    if x == 0.0:
        for m in range(low, high):
            motion.gain[m] = 0.0
        return
    one, eighth = powers(x), fill(_eighth(x))
    two = times(one, eighth)
    three = times(two, eighth)
    time, squares, first = x * system.span[g], fill(0.0), 0.0
    for m in range(low, high):
        series, dashpot = c[m - low], system.dashpot[m]
        if dashpot == 0.0:
            motion.gain[m], rate = increment(series, x)
            motion.z[m] += motion.gain[m]
            motion.rate[m] = rate / system.span[g]
            continue
        _scale(series, one, two, three, scaled)
        at = _at_points(scaled, _SLOPES)
        squares, first = add_times(squares, times(at, at), fill(dashpot)), first + dashpot * scaled[1] * scaled[1]
        store(scaled, 0, at)
        motion.gain[m] = scaled[0]
        motion.z[m] += scaled[0]
        motion.rate[m] = scaled[WIDTH - 1] / time
    it.books.structure += (total(times(squares, load(_POINT_WEIGHTS, 0))) + _FIRST * first) / time
    if system.frequency > 0.0:
        wave = high - low + 2 * (system.last[g] - system.first[g])
        _scale(c[wave], one, two, three, scaled)
        harmonic = _at_points(scaled, _VALUES)
        _scale(c[wave + 1], one, two, three, scaled)
        power = times(_at_points(scaled, _SLOPES), load(_POINT_WEIGHTS, 0))
        it.books.work += total(times(power, harmonic)) + _FIRST * scaled[1] * c[wave, 0]


@fused
def _scale(c: Floats, one: Floats, two: Floats, three: Floats, scaled: Floats) -> None:
    """A series times powers."""
    store(scaled, 0, times(load(c, 0), one))
    store(scaled, 8, times(load(c, 8), two))
    store(scaled, 16, times(load(c, 16), three))


@fused
def _at_points(scaled: Floats, table: Floats) -> Floats:
    """A scaled series at the points of the rule."""
    one, two = times(load(table[0], 0), fill(scaled[0])), times(load(table[1], 0), fill(scaled[1]))
    three, four = times(load(table[2], 0), fill(scaled[2])), times(load(table[3], 0), fill(scaled[3]))
    for k in range(4, TERMS, 4):
        one = add_times(one, load(table[k], 0), fill(scaled[k]))
        two = add_times(two, load(table[k + 1], 0), fill(scaled[k + 1]))
        three = add_times(three, load(table[k + 2], 0), fill(scaled[k + 2]))
        four = add_times(four, load(table[k + 3], 0), fill(scaled[k + 3]))
    return add_times(add_times(one, two, fill(1.0)), add_times(three, four, fill(1.0)), fill(1.0))
