"""A vector of eight doubles as a Numba type, so that kernels read like formulas and compile to packed code.

LLVM splits the vectors by itself on machines whose registers are narrower. Every function here has a plain
Python body that works on NumPy arrays of eight numbers: the twin that runs under NUMBA_DISABLE_JIT=1.
"""

from __future__ import annotations

import operator

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, models, overload, register_model

LANES = 8
_DOUBLE = ir.DoubleType()
_INT = ir.IntType(32)
_VECTOR = ir.VectorType(_DOUBLE, LANES)
_SWAPPED = [0, 4, 5, 6, 1, 2, 3, 7]


class Vec8Type(types.Type):
    """Numba type of `<8 x double>`."""

    def __init__(self) -> None:
        super().__init__(name="Vec8")


vec8 = Vec8Type()


@register_model(Vec8Type)
class _Vec8Model(models.PrimitiveModel):
    def __init__(self, manager, numba_type):
        super().__init__(manager, numba_type, _VECTOR)


def _pointer(context, builder, array_type, array, index):
    """Address of `array[index]` as a pointer to eight doubles; no bounds check, no wrap-around."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), _VECTOR.as_pointer())


@intrinsic
def _load(typingctx, array, index):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        return builder.load(_pointer(context, builder, signature.args[0], args[0], position), align=8)

    return vec8(array, index), codegen


@intrinsic
def _store(typingctx, array, index, value):
    def codegen(context, builder, signature, args):
        position = context.cast(builder, args[1], signature.args[1], types.intp)
        builder.store(args[2], _pointer(context, builder, signature.args[0], args[0], position), align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), codegen


@intrinsic
def _vector(typingctx, x0, x1, x2, x3, x4, x5, x6, x7):
    def codegen(context, builder, signature, args):
        value = cgutils.get_null_value(_VECTOR)
        for lane, number in enumerate(args):
            value = builder.insert_element(value, number, _INT(lane))
        return value

    return vec8(*[types.float64] * LANES), codegen


@intrinsic
def _splat(typingctx, x):
    def codegen(context, builder, signature, args):
        first = builder.insert_element(cgutils.get_null_value(_VECTOR), args[0], _INT(0))
        return builder.shuffle_vector(first, first, ir.Constant(ir.VectorType(_INT, LANES), [0] * LANES))

    return vec8(types.float64), codegen


@intrinsic
def _lane(typingctx, value, index):
    def codegen(context, builder, signature, args):
        return builder.extract_element(args[0], context.cast(builder, args[1], signature.args[1], types.int32))

    return types.float64(vec8, index), codegen


@intrinsic
def _swap_halves(typingctx, a):
    def codegen(context, builder, signature, args):
        order = ir.Constant(ir.VectorType(_INT, LANES), _SWAPPED)
        return builder.shuffle_vector(args[0], args[0], order)

    return vec8(vec8), codegen


@intrinsic
def _fma(typingctx, a, b, c):
    def codegen(context, builder, signature, args):
        signature_llvm = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
        return builder.call(cgutils.get_or_insert_function(builder.module, signature_llvm, "llvm.fma.v8f64"), args)

    return vec8(vec8, vec8, vec8), codegen


@intrinsic
def _add(typingctx, a, b):
    def codegen(context, builder, signature, args):
        return builder.fadd(*args)

    return vec8(vec8, vec8), codegen


@intrinsic
def _mul(typingctx, a, b):
    def codegen(context, builder, signature, args):
        return builder.fmul(*args)

    return vec8(vec8, vec8), codegen


def load(array: np.ndarray, index: int) -> np.ndarray:
    """Eight consecutive doubles of a flat array, starting at `index`."""
    return array[index : index + LANES].copy()


def store(array: np.ndarray, index: int, value: np.ndarray) -> None:
    """Write eight doubles to a flat array, starting at `index`."""
    array[index : index + LANES] = value


def splat(x: float) -> np.ndarray:
    """The same number in all lanes."""
    return np.full(LANES, x)


def vector(x0: float, x1: float, x2: float, x3: float, x4: float, x5: float, x6: float, x7: float) -> np.ndarray:
    """A vector from its eight lanes."""
    return np.array([x0, x1, x2, x3, x4, x5, x6, x7], dtype=np.float64)


def lane(value: np.ndarray, index: int) -> float:
    """One lane of a vector."""
    return value[index]


def swap_halves(value: np.ndarray) -> np.ndarray:
    """Lanes 1 to 3 (momentum, velocity) and 4 to 6 (force, acceleration) exchanged."""
    return value[_SWAPPED]


def fma(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """a * b + c, rounded once where it is compiled."""
    return a * b + c


@overload(load)
def _load_overload(array, index):
    return lambda array, index: _load(array, index)


@overload(store)
def _store_overload(array, index, value):
    return lambda array, index, value: _store(array, index, value)


@overload(splat)
def _splat_overload(x):
    return lambda x: _splat(float(x))


@overload(vector)
def _vector_overload(x0, x1, x2, x3, x4, x5, x6, x7):
    return lambda x0, x1, x2, x3, x4, x5, x6, x7: _vector(
        float(x0), float(x1), float(x2), float(x3), float(x4), float(x5), float(x6), float(x7)
    )


@overload(lane)
def _lane_overload(value, index):
    return lambda value, index: _lane(value, index)


@overload(swap_halves)
def _swap_halves_overload(value):
    return lambda value: _swap_halves(value)


@overload(fma)
def _fma_overload(a, b, c):
    if a == b == c == vec8:
        return lambda a, b, c: _fma(a, b, c)
    return None


@overload(operator.add)
def _add_overload(a, b):
    if a == b == vec8:
        return lambda a, b: _add(a, b)
    return None


@overload(operator.mul)
def _mul_overload(a, b):
    if a == b == vec8:
        return lambda a, b: _mul(a, b)
    return None
