"""Compiled implementations of the operations: intrinsics and overloads; those of arrays are in `access.py`."""

# Numba adds the first argument of an intrinsic.
# mypy: disable-error-code="call-arg"

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from mpmcol.mpm.simd import access as access  # registers its implementations with Numba
from mpmcol.mpm.simd.vec8 import (
    HALF,
    HALF_VECTOR,
    INT,
    ZERO,
    VectorType,
    declare,
    emit_splat,
    overloading,
    shuffle,
    vec4,
    vec8,
    zero_of,
)
from mpmcol.mpm.simd.vectors import (
    LANES,
    SWAPPED,
    any_positive,
    extract,
    floor,
    fma,
    half_vector,
    maximum,
    reduce_max,
    reduce_sum,
    splat,
    sqrt,
    swap_halves,
    vector,
    where_positive,
)


@intrinsic
def _vector(typingctx, x0, x1, x2, x3, x4, x5, x6, x7):
    def codegen(context, builder, signature, args):
        value = ZERO
        for position, number in enumerate(args):
            value = builder.insert_element(value, number, INT(position))
        return value

    return vec8(*[types.float64] * LANES), codegen


@intrinsic
def _half_vector(typingctx, x0, x1, x2, x3):
    def codegen(context, builder, signature, args):
        value = zero_of(HALF_VECTOR)
        for position, number in enumerate(args):
            value = builder.insert_element(value, number, INT(position))
        return value

    return vec4(*[types.float64] * HALF), codegen


@intrinsic
def _extract(typingctx, value, index):
    def codegen(context, builder, signature, args):
        return builder.extract_element(args[0], context.cast(builder, args[1], signature.args[1], types.int32))

    return types.float64(value, index), codegen


def _call(builder, name, *args):
    kind = args[0].type
    function = ir.FunctionType(kind, [kind] * len(args))
    return builder.call(cgutils.get_or_insert_function(builder.module, function, f"{name}.v{kind.count}f64"), args)


def _is_positive(builder, a):
    return builder.fcmp_ordered(">", a, zero_of(a.type))


def _emit_any(builder, a):
    mask = ir.IntType(a.type.count)
    return builder.icmp_unsigned("!=", builder.bitcast(_is_positive(builder, a), mask), mask(0))


def _emit_maximum(builder, a, b):
    return builder.select(builder.fcmp_ordered(">", a, b), a, b)


def _emit_reduce_max(builder, a):
    for width in (4, 2, 1):
        a = _emit_maximum(builder, a, shuffle(builder, a, a, [(k + width) % LANES for k in range(LANES)]))
    return builder.extract_element(a, INT(0))


def _emit_reduce_sum(builder, a):
    for width in (4, 2, 1):
        a = builder.fadd(a, shuffle(builder, a, a, [(k + width) % LANES for k in range(LANES)]))
    return builder.extract_element(a, INT(0))


def _unary(emit: Callable[..., Any], result: Any = None) -> Any:
    """An intrinsic of one vector from the function that emits its instructions."""

    @intrinsic
    def operation(typingctx, a):
        return (result or a)(a), lambda context, builder, signature, args: emit(builder, *args)

    return operation


def _has_vector(*arguments):
    return any(isinstance(each, VectorType) for each in arguments)


def _kind_of(*arguments):
    """Type of the vectors among the arguments."""
    return next(each for each in arguments if isinstance(each, VectorType))


def _of_vectors(emit):
    """Code generator of an operation on vectors of one kind, or on vectors and numbers, which fill all lanes."""

    def codegen(context, builder, signature, args):
        kind = context.get_value_type(_kind_of(*signature.args))

        def widened(given, value):
            if _has_vector(given):
                return value
            return emit_splat(builder, context.cast(builder, value, given, types.float64), kind)

        return emit(builder, *map(widened, signature.args, args))

    return codegen


def _binary(emit: Callable[..., Any]) -> Any:
    """An intrinsic of two vectors, or of a vector and a number."""

    @intrinsic
    def operation(typingctx, a, b):
        return _kind_of(a, b)(a, b), _of_vectors(emit)

    return operation


def _ternary(emit: Callable[..., Any]) -> Any:
    """An intrinsic of three vectors, or of vectors and numbers."""

    @intrinsic
    def operation(typingctx, a, b, c):
        return _kind_of(a, b, c)(a, b, c), _of_vectors(emit)

    return operation


@intrinsic
def _splat(typingctx, x):
    return vec8(types.float64), lambda context, builder, signature, args: emit_splat(builder, *args)


_swap_halves = _unary(lambda builder, a: shuffle(builder, a, a, SWAPPED))
_sqrt = _unary(lambda builder, a: _call(builder, "llvm.sqrt", a))
_floor = _unary(lambda builder, a: _call(builder, "llvm.floor", a))
_magnitude = _unary(lambda builder, a: _call(builder, "llvm.fabs", a))
_negative = _unary(lambda builder, a: builder.fneg(a))
_any_positive = _unary(_emit_any, result=types.boolean)
_maximum = _binary(_emit_maximum)
_reduce_max = _unary(_emit_reduce_max, result=types.float64)
_reduce_sum = _unary(_emit_reduce_sum, result=types.float64)
_fma = _ternary(lambda builder, a, b, c: _call(builder, "llvm.fma", a, b, c))
_select = _ternary(lambda builder, c, a, b: builder.select(_is_positive(builder, c), a, b))
_ARITHMETIC = {
    operator.add: _binary(lambda builder, a, b: builder.fadd(a, b)),
    operator.sub: _binary(lambda builder, a, b: builder.fsub(a, b)),
    operator.mul: _binary(lambda builder, a, b: builder.fmul(a, b)),
    operator.truediv: _binary(lambda builder, a, b: builder.fdiv(a, b)),
}


def _declare_arithmetic(operation: Callable[..., Any], emitted: Any) -> None:
    """An operator of two vectors, or of a vector and a number."""

    def typed(a, b):
        return (lambda a, b: emitted(a, b)) if _has_vector(a, b) else None

    declare(operation, typed)


for _operation, _emitted in _ARITHMETIC.items():
    _declare_arithmetic(_operation, _emitted)
declare(operator.neg, lambda a: (lambda a: _negative(a)) if _has_vector(a) else None)
declare(abs, lambda a: (lambda a: _magnitude(a)) if _has_vector(a) else None)
declare(splat, lambda x: lambda x: _splat(float(x)))
declare(extract, lambda value, index: lambda value, index: _extract(value, index))
declare(swap_halves, lambda value: lambda value: _swap_halves(value))
declare(fma, lambda a, b, c: lambda a, b, c: _fma(a, b, c))
declare(floor, lambda a: lambda a: _floor(a))
declare(maximum, lambda a, b: lambda a, b: _maximum(a, b))
declare(reduce_max, lambda a: lambda a: _reduce_max(a))
declare(reduce_sum, lambda a: lambda a: _reduce_sum(a))


@overloading(vector)
def _vector_overload(x0, x1, x2, x3, x4, x5, x6, x7):
    return lambda x0, x1, x2, x3, x4, x5, x6, x7: _vector(
        float(x0), float(x1), float(x2), float(x3), float(x4), float(x5), float(x6), float(x7)
    )


@overloading(half_vector)
def _half_vector_overload(x0, x1, x2, x3):
    return lambda x0, x1, x2, x3: _half_vector(float(x0), float(x1), float(x2), float(x3))


@overloading(sqrt)
def _root_overload(a):
    return (lambda a: _sqrt(a)) if _has_vector(a) else (lambda a: np.sqrt(a))


@overloading(where_positive)
def _where_overload(condition, a, b):
    if _has_vector(condition):
        return lambda condition, a, b: _select(condition, a, b)
    return lambda condition, a, b: a if condition > 0.0 else b


@overloading(any_positive)
def _any_overload(condition):
    return (
        (lambda condition: _any_positive(condition)) if _has_vector(condition) else (lambda condition: condition > 0.0)
    )
