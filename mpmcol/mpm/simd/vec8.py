"""Numba type of a vector of eight doubles, and what the files with compiled operations share."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, wraps
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import models, overload, register_model

from mpmcol.mpm.jit import CALLED_BY_KERNELS, variant
from mpmcol.mpm.simd.vectors import LANES

overloading = partial(overload, jit_options=CALLED_BY_KERNELS)
DOUBLE = ir.DoubleType()
INT = ir.IntType(32)
VECTOR = ir.VectorType(DOUBLE, LANES)
ZERO = ir.Constant(VECTOR, [0.0] * LANES)
HALF = LANES // 2
HALF_VECTOR = ir.VectorType(DOUBLE, HALF)


class VectorType(types.Type):
    """Numba type of a vector of doubles."""

    def __init__(self, lanes: int) -> None:
        super().__init__(name=f"Vec{lanes}")
        self.lanes = lanes


vec8, vec4 = VectorType(LANES), VectorType(HALF)
EIGHT = types.UniTuple(vec8, LANES)


@register_model(VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, ir.VectorType(DOUBLE, numba_type.lanes))


def shuffle(builder, a, b, order):
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(INT, len(order)), list(order)))


def zero_of(kind):
    """Zero in all lanes of a vector type of LLVM."""
    return ir.Constant(kind, [0.0] * kind.count)


def emit_splat(builder, x, kind=VECTOR):
    zero = zero_of(kind)
    return shuffle(builder, builder.insert_element(zero, x, INT(0)), zero, [0] * kind.count)


def declare(function: Callable[..., Any], implementation: Any) -> None:
    """Register the compiled implementation of `function`; `implementation` is a factory such as `overload` takes."""

    @wraps(implementation)
    def named(*arguments):
        compiled = implementation(*arguments)
        return compiled and variant(function)(compiled)

    overloading(function)(named)
