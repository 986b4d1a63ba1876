"""Compiled access to arrays: vectors, transposed vectors and single numbers, without tests of the index."""

# Numba adds the first argument of an intrinsic.
# mypy: disable-error-code="call-arg"

from __future__ import annotations

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from mpmcol.mpm.simd.vec8 import (
    DOUBLE,
    EIGHT,
    HALF,
    HALF_VECTOR,
    INT,
    VECTOR,
    ZERO,
    declare,
    emit_splat,
    overloading,
    shuffle,
    vec4,
    vec8,
)
from mpmcol.mpm.simd.vectors import (
    LANES,
    element,
    load,
    load_eight,
    load_half,
    prefetch,
    scratch,
    spread,
    spread_half,
    store,
    store_eight,
    strided,
    transpose,
)

_LONG = ir.IntType(64)
_BYTE = ir.IntType(8)
_CACHE_LINE = 64  # bytes


def _pointer(context, builder, array_type, array, index, kind=VECTOR):
    """Address of `array[index]` as a pointer to eight doubles; no bounds check, no wrap-around."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), kind.as_pointer())


def _load_of(result):
    """An intrinsic that loads consecutive doubles."""

    @intrinsic
    def operation(typingctx, array, index):
        def codegen(context, builder, signature, args):
            position = context.cast(builder, args[1], signature.args[1], types.intp)
            kind = context.get_value_type(result)
            return builder.load(_pointer(context, builder, signature.args[0], args[0], position, kind), align=8)

        return result(array, index), codegen

    return operation


def _spread_of(result):
    """An intrinsic that loads one double into all lanes."""

    @intrinsic
    def operation(typingctx, array, index):
        def codegen(context, builder, signature, args):
            position = context.cast(builder, args[1], signature.args[1], types.intp)
            number = builder.load(_pointer(context, builder, signature.args[0], args[0], position, DOUBLE))
            return emit_splat(builder, number, context.get_value_type(result))

        return result(array, index), codegen

    return operation


_load, _load_half, _spread, _spread_half = _load_of(vec8), _load_of(vec4), _spread_of(vec8), _spread_of(vec4)


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
        value = ZERO
        for k in range(LANES):
            address = _pointer(context, builder, signature.args[0], args[0], position, DOUBLE)
            value = builder.insert_element(value, builder.load(address), INT(k))
            position = builder.add(position, step)
        return value

    return vec8(array, index, stride), codegen


@intrinsic(prefer_literal=True)
def _scratch(typingctx, size):
    count = size.literal_value
    array_type = types.Array(types.float64, 1, "C")

    def codegen(context, builder, signature, args):
        # An aligned variable aligns the stack: registers that LLVM saves on it then cross no cache lines.
        allocated = cgutils.alloca_once(builder, ir.ArrayType(DOUBLE, count))
        allocated.align = _CACHE_LINE
        data = builder.bitcast(allocated, DOUBLE.as_pointer())
        array = context.make_array(array_type)(context, builder)
        shape, strides = (cgutils.pack_array(builder, [_LONG(each)]) for each in (count, 8))
        context.populate_array(array, data=data, shape=shape, strides=strides, itemsize=_LONG(8), meminfo=None)
        return array._getvalue()

    return array_type(size), codegen


@intrinsic
def _store(typingctx, array, index, value):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        pointer = _pointer(context, builder, signature.args[0], args[0], position, args[2].type)
        builder.store(args[2], pointer, align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen


@intrinsic
def _prefetch(typingctx, array, index):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        address = _pointer(context, builder, signature.args[0], args[0], position, _BYTE)
        kind = ir.FunctionType(ir.VoidType(), [address.type, INT, INT, INT])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0i8")
        builder.call(function, [address, INT(0), INT(3), INT(1)])  # for reading, into all caches, data
        return context.get_dummy_value()

    return types.void(array, index), codegen


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
                    rows[r], rows[r + step] = shuffle(builder, *pair, low), shuffle(builder, *pair, high)
        return context.make_tuple(builder, EIGHT, rows)

    return EIGHT(*[vec8] * LANES), codegen


@intrinsic
def _load_eight(typingctx, array, index, stride):
    """Halves of the vectors are loaded apart: they meet in registers without a shuffle."""

    def codegen(context, builder, signature, args):
        first, step = (context.cast(builder, args[k], signature.args[k], types.intp) for k in (1, 2))
        lanes = []
        for half in (0, HALF):
            quarters = []
            for k in range(LANES):
                offset = builder.add(builder.mul(step, _LONG(k)), _LONG(half))
                position = builder.add(first, offset)
                quarters.append(
                    builder.load(_pointer(context, builder, signature.args[0], args[0], position, HALF_VECTOR), align=8)
                )
            rows = [shuffle(builder, quarters[k], quarters[k + HALF], range(LANES)) for k in range(HALF)]
            lanes += _transpose_halves(builder, rows)
        return context.make_tuple(builder, EIGHT, lanes)

    return EIGHT(array, index, stride), codegen


@intrinsic
def _store_eight(typingctx, array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7):
    def codegen(context, builder, signature, args):
        first, step = (context.cast(builder, args[k], signature.args[k], types.intp) for k in (1, 2))
        for half in (0, HALF):
            rows = _transpose_halves(builder, args[3 + half : 3 + half + HALF])
            for k in range(LANES):
                offset = builder.add(builder.mul(step, _LONG(k)), _LONG(half))
                part = range(0, HALF) if k < HALF else range(HALF, LANES)
                value = shuffle(builder, rows[k % HALF], rows[k % HALF], part)
                position = builder.add(first, offset)
                builder.store(
                    value, _pointer(context, builder, signature.args[0], args[0], position, HALF_VECTOR), align=8
                )
        return context.get_dummy_value()

    return types.void(array, index, stride, *[vec8] * LANES), codegen


def _transpose_halves(builder, rows):
    """Transpose four vectors in each half: lane k (or 4 + k) of all four becomes the half of vector k."""
    pairs = [
        shuffle(
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
    return [shuffle(builder, *pair, order) for order in (low, high) for pair in (even, odd)]


declare(load, lambda array, index: lambda array, index: _load(array, index))
declare(load_half, lambda array, index: lambda array, index: _load_half(array, index))
declare(spread_half, lambda array, index: lambda array, index: _spread_half(array, index))
declare(element, lambda array, index: lambda array, index: _element(array, index))
declare(strided, lambda array, index, stride: lambda array, index, stride: _strided(array, index, stride))
declare(spread, lambda array, index: lambda array, index: _spread(array, index))
declare(prefetch, lambda array, index: lambda array, index: _prefetch(array, index))
declare(store, lambda array, index, value: lambda array, index, value: _store(array, index, value))


@overloading(load_eight)
def _load_eight_overload(array, index, stride):
    return lambda array, index, stride: _load_eight(array, index, stride)


@overloading(store_eight)
def _store_eight_overload(array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7):
    return lambda array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7: _store_eight(
        array, index, stride, r0, r1, r2, r3, r4, r5, r6, r7
    )


@overloading(transpose)
def _transpose_overload(r0, r1, r2, r3, r4, r5, r6, r7):
    return lambda r0, r1, r2, r3, r4, r5, r6, r7: _transpose(r0, r1, r2, r3, r4, r5, r6, r7)


@overloading(scratch, prefer_literal=True)
def _scratch_overload(size):
    return lambda size: _scratch(size)
