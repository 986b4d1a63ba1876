"""Monotonic clock of the system, readable from compiled code; a call of Python would take microseconds."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, overload

_CLOCK_ID = getattr(time, "CLOCK_MONOTONIC", 1)
_LONG = ir.IntType(64)


@intrinsic
def _seconds(typingctx: Any) -> Any:
    """clock_gettime(CLOCK_MONOTONIC) of the C library, as seconds."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        spec = cgutils.alloca_once(builder, ir.ArrayType(_LONG, 2))  # struct timespec: seconds, nanoseconds
        kind = ir.FunctionType(ir.IntType(32), [ir.IntType(32), spec.type])
        function = cgutils.get_or_insert_function(builder.module, kind, "clock_gettime")
        builder.call(function, [ir.IntType(32)(_CLOCK_ID), spec])
        whole, nano = (builder.sitofp(builder.extract_value(builder.load(spec), k), ir.DoubleType()) for k in (0, 1))
        return builder.fadd(whole, builder.fmul(nano, ir.DoubleType()(1e-9)))

    return types.float64(), codegen


def seconds() -> float:
    """Time since an arbitrary start, s."""
    return time.monotonic()


@overload(seconds)
def _seconds_overload() -> Callable[[], float]:
    return lambda: _seconds()  # type: ignore[call-arg]
