"""Compiled implementations of the operations: a Numba type for LLVM's `<8 x double>`, intrinsics and overloads."""

# Numba adds the first argument of an intrinsic.
# mypy: disable-error-code="call-arg"

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import partial, wraps
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, models, overload, register_model

from mpmcol.mpm.jit import CALLED_BY_KERNELS, variant
from mpmcol.mpm.simd.vectors import (
    LANES,
    SWAPPED,
    any_positive,
    element,
    extract,
    floor,
    fma,
    load,
    load_eight,
    maximum,
    prefetch,
    reduce_max,
    reduce_sum,
    scratch,
    splat,
    spread,
    sqrt,
    store,
    store_eight,
    strided,
    swap_halves,
    transpose,
    vector,
    where_positive,
)

_overload = partial(overload, jit_options=CALLED_BY_KERNELS)
_DOUBLE = ir.DoubleType()
_INT = ir.IntType(32)
_LONG = ir.IntType(64)
_BYTE = ir.IntType(8)
_CACHE_LINE = 64  # bytes
_VECTOR = ir.VectorType(_DOUBLE, LANES)
_HALF = LANES // 2
_HALF_VECTOR = ir.VectorType(_DOUBLE, _HALF)
_ZERO = ir.Constant(_VECTOR, [0.0] * LANES)


class Vec8Type(types.Type):
    """Numba type of `<8 x double>`."""

    def __init__(self) -> None:
        super().__init__(name="Vec8")


vec8 = Vec8Type()
_EIGHT = types.UniTuple(vec8, LANES)


@register_model(Vec8Type)
class _Vec8Model(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, _VECTOR)


def _pointer(context, builder, array_type, array, index, kind=_VECTOR):
    """Address of `array[index]` as a pointer to eight doubles; no bounds check, no wrap-around."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), kind.as_pointer())


@intrinsic
def _load(typingctx, array, index):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        return builder.load(_pointer(context, builder, signature.args[0], args[0], position), align=8)

    return vec8(array, index), codegen


@intrinsic
def _element(typingctx, array, index):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        kind = context.get_value_type(array.dtype)
        return builder.load(_pointer(context, builder, signature.args[0], args[0], position, kind))

    return array.dtype(array, index), codegen


@intrinsic
def _strided(typingctx, array, index, stride):
    def codegen(context, builder, signature, args):
        position, step = (context.cast(builder, args[k], signature.args[k], types.intp) for k in (1, 2))
        value = _ZERO
        for k in range(LANES):
            address = _pointer(context, builder, signature.args[0], args[0], position, _DOUBLE)
            value = builder.insert_element(value, builder.load(address), _INT(k))
            position = builder.add(position, step)
        return value

    return vec8(array, index, stride), codegen


@intrinsic
def _spread(typingctx, array, index):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        return _emit_splat(
            builder, builder.load(_pointer(context, builder, signature.args[0], args[0], position, _DOUBLE))
        )

    return vec8(array, index), codegen


@intrinsic(prefer_literal=True)
def _scratch(typingctx, size):
    count = size.literal_value
    array_type = types.Array(types.float64, 1, "C")

    def codegen(context, builder, signature, args):
        allocated = cgutils.alloca_once(builder, ir.ArrayType(_DOUBLE, count + LANES))
        address = builder.add(builder.ptrtoint(allocated, _LONG), _LONG(_CACHE_LINE - 1))
        data = builder.inttoptr(builder.and_(address, _LONG(-_CACHE_LINE)), _DOUBLE.as_pointer())
        array = context.make_array(array_type)(context, builder)
        shape, strides = (cgutils.pack_array(builder, [_LONG(each)]) for each in (count, 8))
        context.populate_array(array, data=data, shape=shape, strides=strides, itemsize=_LONG(8), meminfo=None)
        return array._getvalue()

    return array_type(size), codegen


@intrinsic
def _store(typingctx, array, index, value):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        builder.store(args[2], _pointer(context, builder, signature.args[0], args[0], position), align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen


@intrinsic
def _prefetch(typingctx, array, index):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        address = _pointer(context, builder, signature.args[0], args[0], position, _BYTE)
        kind = ir.FunctionType(ir.VoidType(), [address.type, _INT, _INT, _INT])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0i8")
        builder.call(function, [address, _INT(0), _INT(3), _INT(1)])  # for reading, into all caches, data
        return context.get_dummy_value()

    return types.void(array, index), codegen


@intrinsic
def _vector(typingctx, x0, x1, x2, x3, x4, x5, x6, x7):
    def codegen(context, builder, signature, args):
        value = _ZERO
        for position, number in enumerate(args):
            value = builder.insert_element(value, number, _INT(position))
        return value

    return vec8(*[types.float64] * LANES), codegen


@intrinsic
def _extract(typingctx, value, index):
    def codegen(context, builder, signature, args):
        return builder.extract_element(args[0], context.cast(builder, args[1], signature.args[1], types.int32))

    return types.float64(vec8, index), codegen


@intrinsic
def _transpose(typingctx, r0, r1, r2, r3, r4, r5, r6, r7):
    def codegen(context, builder, signature, args):
        rows = list(args)
        for step in (1, 2, 4):  # exchange blocks of 1, 2, 4 lanes between rows that far apart
            low = [k if not k & step else LANES + k - step for k in range(LANES)]
            high = [k + step if not k & step else LANES + k for k in range(LANES)]
            for r in range(LANES):
                if not r & step:
                    pair = rows[r], rows[r + step]
                    rows[r], rows[r + step] = _shuffle(builder, *pair, low), _shuffle(builder, *pair, high)
        return context.make_tuple(builder, _EIGHT, rows)

    return _EIGHT(*[vec8] * LANES), codegen


@intrinsic
def _load_eight(typingctx, array, index, stride):
    """Halves of the vectors are loaded apart: they meet in registers without a shuffle."""

    def codegen(context, builder, signature, args):
        first, step = (context.cast(builder, args[k], signature.args[k], types.intp) for k in (1, 2))
        lanes = []
        for half in (0, _HALF):
            quarters = []
            for k in range(LANES):
                offset = builder.add(builder.mul(step, _LONG(k)), _LONG(half))
                position = builder.add(first, offset)
                quarters.append(
                    builder.load(
                        _pointer(context, builder, signature.args[0], args[0], position, _HALF_VECTOR), align=8
                    )
                )
            rows = [_shuffle(builder, quarters[k], quarters[k + _HALF], range(LANES)) for k in range(_HALF)]
            lanes += _transpose_halves(builder, rows)
        return context.make_tuple(builder, _EIGHT, lanes)

    return _EIGHT(array, index, stride), codegen


@intrinsic
def _store_eight(typingctx, array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7):
    def codegen(context, builder, signature, args):
        first, step = (context.cast(builder, args[k], signature.args[k], types.intp) for k in (1, 2))
        for half in (0, _HALF):
            rows = _transpose_halves(builder, args[3 + half : 3 + half + _HALF])
            for k in range(LANES):
                offset = builder.add(builder.mul(step, _LONG(k)), _LONG(half))
                part = range(0, _HALF) if k < _HALF else range(_HALF, LANES)
                value = _shuffle(builder, rows[k % _HALF], rows[k % _HALF], part)
                position = builder.add(first, offset)
                builder.store(
                    value, _pointer(context, builder, signature.args[0], args[0], position, _HALF_VECTOR), align=8
                )
        return context.get_dummy_value()

    return types.void(array, index, stride, *[vec8] * LANES), codegen


def _transpose_halves(builder, rows):
    """Transpose four vectors in each half: lane k (or 4 + k) of all four becomes the half of vector k."""
    pairs = [
        _shuffle(
            builder,
            rows[k],
            rows[k + 1],
            [odd, LANES + odd, 2 + odd, LANES + 2 + odd, 4 + odd, LANES + 4 + odd, 6 + odd, LANES + 6 + odd],
        )
        for odd in (0, 1)
        for k in (0, 2)
    ]
    low, high = [0, 1, 8, 9, 4, 5, 12, 13], [2, 3, 10, 11, 6, 7, 14, 15]
    even, odd = pairs[:2], pairs[2:]
    return [_shuffle(builder, *pair, order) for order in (low, high) for pair in (even, odd)]


def _shuffle(builder, a, b, order):
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(_INT, len(order)), list(order)))


def _call(builder, name, *args):
    function = ir.FunctionType(_VECTOR, [_VECTOR] * len(args))
    return builder.call(cgutils.get_or_insert_function(builder.module, function, name), args)


def _is_positive(builder, a):
    return builder.fcmp_ordered(">", a, _ZERO)


def _emit_splat(builder, x):
    return _shuffle(builder, builder.insert_element(_ZERO, x, _INT(0)), _ZERO, [0] * LANES)


def _emit_any(builder, a):
    mask = ir.IntType(LANES)
    return builder.icmp_unsigned("!=", builder.bitcast(_is_positive(builder, a), mask), mask(0))


def _emit_maximum(builder, a, b):
    return builder.select(builder.fcmp_ordered(">", a, b), a, b)


def _emit_reduce_max(builder, a):
    for width in (4, 2, 1):
        a = _emit_maximum(builder, a, _shuffle(builder, a, a, [(k + width) % LANES for k in range(LANES)]))
    return builder.extract_element(a, _INT(0))


def _emit_reduce_sum(builder, a):
    for width in (4, 2, 1):
        a = builder.fadd(a, _shuffle(builder, a, a, [(k + width) % LANES for k in range(LANES)]))
    return builder.extract_element(a, _INT(0))


def _unary(emit: Callable[..., Any], result: Any = vec8, argument: Any = vec8) -> Any:
    """An intrinsic of one vector (or number) from the function that emits its instructions."""

    @intrinsic
    def operation(typingctx, a):
        return result(argument), lambda context, builder, signature, args: emit(builder, *args)

    return operation


def _binary(emit: Callable[..., Any]) -> Any:
    """An intrinsic of two vectors."""

    @intrinsic
    def operation(typingctx, a, b):
        return vec8(vec8, vec8), lambda context, builder, signature, args: emit(builder, *args)

    return operation


def _ternary(emit: Callable[..., Any]) -> Any:
    """An intrinsic of three vectors."""

    @intrinsic
    def operation(typingctx, a, b, c):
        return vec8(vec8, vec8, vec8), lambda context, builder, signature, args: emit(builder, *args)

    return operation


_splat = _unary(_emit_splat, argument=types.float64)
_swap_halves = _unary(lambda builder, a: _shuffle(builder, a, a, SWAPPED))
_sqrt = _unary(lambda builder, a: _call(builder, "llvm.sqrt.v8f64", a))
_floor = _unary(lambda builder, a: _call(builder, "llvm.floor.v8f64", a))
_magnitude = _unary(lambda builder, a: _call(builder, "llvm.fabs.v8f64", a))
_negative = _unary(lambda builder, a: builder.fneg(a))
_any_positive = _unary(_emit_any, result=types.boolean)
_maximum = _binary(_emit_maximum)
_reduce_max = _unary(_emit_reduce_max, result=types.float64)
_reduce_sum = _unary(_emit_reduce_sum, result=types.float64)
_fma = _ternary(lambda builder, a, b, c: _call(builder, "llvm.fma.v8f64", a, b, c))
_select = _ternary(lambda builder, c, a, b: builder.select(_is_positive(builder, c), a, b))
_ARITHMETIC = {
    operator.add: _binary(lambda builder, a, b: builder.fadd(a, b)),
    operator.sub: _binary(lambda builder, a, b: builder.fsub(a, b)),
    operator.mul: _binary(lambda builder, a, b: builder.fmul(a, b)),
    operator.truediv: _binary(lambda builder, a, b: builder.fdiv(a, b)),
}


def _wide(x: Any) -> Any:
    """A vector unchanged, or a number in all lanes."""
    raise NotImplementedError


@_overload(_wide)
def _wide_overload(x):
    return (lambda x: x) if x == vec8 else (lambda x: _splat(float(x)))


def _declare(function: Callable[..., Any], implementation: Any) -> None:
    """Register the compiled implementation of `function`; `implementation` is a factory such as `overload` takes."""

    @wraps(implementation)
    def named(*arguments):
        compiled = implementation(*arguments)
        return compiled and variant(function)(compiled)

    _overload(function)(named)


def _declare_arithmetic(operation: Callable[..., Any], operation8: Any) -> None:
    """An operator of two vectors, or of a vector and a number."""

    def typed(a, b):
        return (lambda a, b: operation8(_wide(a), _wide(b))) if vec8 in (a, b) else None

    _declare(operation, typed)


for _operation, _operation8 in _ARITHMETIC.items():
    _declare_arithmetic(_operation, _operation8)
_declare(operator.neg, lambda a: (lambda a: _negative(a)) if a == vec8 else None)
_declare(abs, lambda a: (lambda a: _magnitude(a)) if a == vec8 else None)
_declare(load, lambda array, index: lambda array, index: _load(array, index))
_declare(element, lambda array, index: lambda array, index: _element(array, index))
_declare(strided, lambda array, index, stride: lambda array, index, stride: _strided(array, index, stride))
_declare(spread, lambda array, index: lambda array, index: _spread(array, index))
_declare(prefetch, lambda array, index: lambda array, index: _prefetch(array, index))
_declare(store, lambda array, index, value: lambda array, index, value: _store(array, index, value))
_declare(splat, lambda x: lambda x: _splat(float(x)))
_declare(extract, lambda value, index: lambda value, index: _extract(value, index))
_declare(swap_halves, lambda value: lambda value: _swap_halves(value))
_declare(fma, lambda a, b, c: lambda a, b, c: _fma(a, b, c))
_declare(floor, lambda a: lambda a: _floor(a))
_declare(maximum, lambda a, b: lambda a, b: _maximum(a, b))
_declare(reduce_max, lambda a: lambda a: _reduce_max(a))
_declare(reduce_sum, lambda a: lambda a: _reduce_sum(a))


@_overload(vector)
def _vector_overload(x0, x1, x2, x3, x4, x5, x6, x7):
    return lambda x0, x1, x2, x3, x4, x5, x6, x7: _vector(
        float(x0), float(x1), float(x2), float(x3), float(x4), float(x5), float(x6), float(x7)
    )


@_overload(load_eight)
def _load_eight_overload(array, index, stride):
    return lambda array, index, stride: _load_eight(array, index, stride)


@_overload(store_eight)
def _store_eight_overload(array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7):
    return lambda array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7: _store_eight(
        array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7
    )


@_overload(transpose)
def _transpose_overload(r0, r1, r2, r3, r4, r5, r6, r7):
    return lambda r0, r1, r2, r3, r4, r5, r6, r7: _transpose(r0, r1, r2, r3, r4, r5, r6, r7)


@_overload(scratch, prefer_literal=True)
def _scratch_overload(size):
    return lambda size: _scratch(size)


@_overload(sqrt)
def _root_overload(a):
    return (lambda a: _sqrt(a)) if a == vec8 else (lambda a: np.sqrt(a))


@_overload(where_positive)
def _where_overload(condition, a, b):
    if condition == vec8:
        return lambda condition, a, b: _select(condition, _wide(a), _wide(b))
    return lambda condition, a, b: a if condition > 0.0 else b


@_overload(any_positive)
def _any_overload(condition):
    return (lambda condition: _any_positive(condition)) if condition == vec8 else (lambda condition: condition > 0.0)
