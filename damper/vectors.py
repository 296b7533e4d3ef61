"""Eight numbers at a time, one or two instructions of the processor: flights are sums of products of such rows.

The compiler of the kernels does not find these by itself; where it is switched off, arrays of eight do the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numba as nb
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic, models, register_model
from numba.np.arrayobj import make_array

if TYPE_CHECKING:
    from damper.arrays import Floats

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
        """Sum up."""

        def code(context, builder, signature, values):
            sums = [builder.extract_element(values[0], _INDEX(k)) for k in (0, 4, 2, 6, 1, 5, 3, 7)]
            while len(sums) > 1:
                sums = [builder.fadd(*two) for two in zip(sums[::2], sums[1::2], strict=True)]
            return sums[0]

        return types.float64(a), code
