"""Flights between events, as power series.

Flights are taken in steps, on which every coordinate is a power series, kept as its first `damper.state.TERMS`
derivatives at the start, a step being the unit of time. `expand` makes the series of a group from its state, `travel`
moves the group on and books the work of dashpots and forces by Gauss' rule, `spend` what the floor takes. Series are
computed eight numbers at a time (`load`, `store`, `fill`, `times`, `add_times`, `total`): vectors for the compiler,
arrays in plain Python.

A ball that slips keeps its spin after a wall hit and slides until it rolls again. Sliding friction (grip = mu Omega² R
per unit of mass) slows the contact; rolling resistance, which has no say in where a sliding contact goes, is left out
until the ball rolls. A slipping ball can meet either wall, and one that the friction presses against a wall spins there
until its spin is spent or the structure pulls the wall away.
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

from damper.compiled import fused, inlined
from damper.state import INVERSE, ROLLING, SLIPPING, SPIN_UP, STUCK, TERMS

if TYPE_CHECKING:
    from damper.model import Floats, Record


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

    def tail(row: Floats, k: int) -> Floats:
        """The last eight of a series, k places on: zeros come after them."""
        return np.append(row[-WIDTH:][k:], np.zeros(k))

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
    def tail(_, row, k):
        """Shift zeros in; of all shifts, once k is known, one is left."""

        def code(context, builder, signature, values):
            last = builder.load(
                _place(context, builder, row, (values[0], ir.Constant(ir.IntType(64), TERMS - WIDTH))), align=8
            )
            result, zeros = last, ir.Constant(_VECTOR, [0.0] * WIDTH)
            for shift in range(1, 5):
                parts = ir.Constant(ir.VectorType(_INDEX, WIDTH), list(range(shift, shift + WIDTH)))
                here = builder.icmp_signed("==", values[1], values[1].type(shift))
                result = builder.select(here, builder.shuffle_vector(last, zeros, parts), result)
            return result

        return _EIGHT(row, types.intp), code

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
    terms, sources = flow[regimes(g, it)], gather(g, it.motion.start[g], it)
    if sources == 5:  # one mode along an axis: the compiler unrolls what it knows
        _fill_series(g, it, terms, 5)
    else:
        _fill_series(g, it, terms, sources)


@fused
def _fill_series(g: int, it: Record, terms: Floats, sources: int) -> None:
    """All series of a group that its regimes ask for."""
    system, axes = it.system, it.axes
    first, last, count = system.first[g], system.last[g], system.high[g] - system.low[g]
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


_FROM = np.array([np.arange(WIDTH) >= k for k in range(7)], float)
"""Row k leaves out a series' terms before the k-th."""


@fused
def _monomials(x: float) -> tuple[Floats, Floats, Floats]:
    """x^k / k!, what the k-th derivative at 0 adds at x."""
    power, square = powers(x), x * x
    eighth = square * square * square * square
    return (
        times(power, load(INVERSE, 0)),
        times(power, times(load(INVERSE, 8), fill(eighth))),
        times(power, times(load(INVERSE, 16), fill(eighth * eighth))),
    )


@fused
def derivatives(c: Floats, x: float) -> tuple[float, float, float, float]:
    """What a series gains from 0 to x, and its first three derivatives there; the compiler drops what is not used."""
    low, middle, high = _monomials(x)
    gain = times(times(load(c, 0), load(_FROM[1], 0)), low)
    return (
        total(add_times(add_times(gain, load(c, 8), middle), load(c, 16), high)),
        total(add_times(add_times(times(load(c, 1), low), load(c, 9), middle), tail(c, 1), high)),
        total(add_times(add_times(times(load(c, 2), low), load(c, 10), middle), tail(c, 2), high)),
        total(add_times(add_times(times(load(c, 3), low), load(c, 11), middle), tail(c, 3), high)),
    )


@fused
def sizes(c: Floats, order: int, first: int, x: float) -> float:
    """Sum of the sizes at x of the terms of a derivative of a series, from the first one on that counts."""
    low, middle, high = _monomials(x)
    terms = times(positive(load(c, order)), times(low, load(_FROM[first], 0)))
    terms = add_times(terms, positive(load(c, 8 + order)), middle)
    return total(add_times(terms, positive(tail(c, order)), high))


_PLACES, _SHARES = (0.5 * each for each in legendre.leggauss(WIDTH))
_ORDER = np.arange(TERMS)[:, None]
_VALUES = (0.5 + _PLACES) ** _ORDER
"""Of a series' terms: its values at the points of Gauss' rule."""
_SLOPES = _ORDER * (0.5 + _PLACES) ** np.maximum(_ORDER - 1, 0)


@fused
def travel(g: int, x: float, it: Record) -> None:
    """Bring a group's coordinates x steps on, and book the work."""
    system, motion = it.system, it.motion
    low, high, c, scaled = system.low[g], system.high[g], motion.series[g], motion.scaled
    dashpots = system.dashpot[0 if it.axes[system.first[g]].regime == STUCK else 1]
    if x == 0.0:
        motion.gain[low:high] = 0.0
        return
    squares = fill(0.0)
    for m in range(low, high):
        series, dashpot = c[m - low], dashpots[m]
        motion.gain[m], rate, _, _ = derivatives(series, x)
        motion.z[m] += motion.gain[m]
        motion.rate[m] = rate / system.span[g]  # times an inverse it would drift, the same way at each event
        if dashpot != 0.0:
            _terms(series, x, scaled)
            at = _at_points(scaled, _SLOPES)
            squares = add_times(squares, times(at, at), fill(dashpot))
    it.books.structure += total(times(squares, load(_SHARES, 0))) / (x * system.span[g])
    if system.frequency > 0.0:
        wave = high - low + 2 * (system.last[g] - system.first[g])
        _terms(c[wave], x, scaled)
        harmonic = _at_points(scaled, _VALUES)
        _terms(c[wave + 1], x, scaled)
        it.books.work += total(times(times(_at_points(scaled, _SLOPES), harmonic), load(_SHARES, 0)))


@fused
def _terms(c: Floats, x: float, scaled: Floats) -> None:
    """Terms of a series at x."""
    low, middle, high = _monomials(x)
    store(scaled, 0, times(load(c, 0), low))
    store(scaled, 8, times(load(c, 8), middle))
    store(scaled, 16, times(load(c, 16), high))


@fused
def _at_points(scaled: Floats, table: Floats) -> Floats:
    """A series by its terms, at the points of the rule."""
    one, two = times(load(table[0], 0), fill(scaled[0])), times(load(table[1], 0), fill(scaled[1]))
    three, four = times(load(table[2], 0), fill(scaled[2])), times(load(table[3], 0), fill(scaled[3]))
    for k in range(4, TERMS, 4):
        one = add_times(one, load(table[k], 0), fill(scaled[k]))
        two = add_times(two, load(table[k + 1], 0), fill(scaled[k + 1]))
        three = add_times(three, load(table[k + 2], 0), fill(scaled[k + 2]))
        four = add_times(four, load(table[k + 3], 0), fill(scaled[k + 3]))
    return add_times(add_times(one, two, fill(1.0)), add_times(three, four, fill(1.0)), fill(1.0))


@inlined
def spend(axis: Record, path: float, tau: float, ball: Record, books: Record) -> None:
    """Spin after a flight of length tau on which the ball went by `path`, and what the floor took on it.

    A ball pressed against a wall spins down to rest.
    """
    if axis.regime == ROLLING:
        books.rolling += ball.mass * ball.threshold * abs(path)
        axis.spin = axis.w
    elif axis.regime == SLIPPING:
        f = -axis.direction * ball.grip
        slid = path - axis.spin * tau + 0.5 * SPIN_UP * f * tau * tau
        books.slip += ball.mass * ball.grip * abs(slid)
        axis.spin -= SPIN_UP * f * tau
    elif axis.spin != 0.0:
        spin = math.copysign(max(abs(axis.spin) - SPIN_UP * ball.grip * tau, 0.0), axis.spin)
        books.slip += 0.5 * ball.spin_mass * (axis.spin - spin) * (axis.spin + spin)
        axis.spin = spin
