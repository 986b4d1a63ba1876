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


class Vec8Type(types.Type):
    """Numba type of `<8 x double>`."""

    def __init__(self) -> None:
        super().__init__(name="Vec8")


vec8 = Vec8Type()
EIGHT = types.UniTuple(vec8, LANES)


@register_model(Vec8Type)
class _Vec8Model(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, VECTOR)


def shuffle(builder, a, b, order):
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(INT, len(order)), list(order)))


def emit_splat(builder, x):
    return shuffle(builder, builder.insert_element(ZERO, x, INT(0)), ZERO, [0] * LANES)


def declare(function: Callable[..., Any], implementation: Any) -> None:
    """Register the compiled implementation of `function`; `implementation` is a factory such as `overload` takes."""

    @wraps(implementation)
    def named(*arguments):
        compiled = implementation(*arguments)
        return compiled and variant(function)(compiled)

    overloading(function)(named)
