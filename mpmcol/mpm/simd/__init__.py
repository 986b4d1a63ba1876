"""Vectors of eight doubles as a Numba type: kernels read like formulas and compile to SIMD instructions.

LLVM splits the vectors on machines with narrower registers. Every function has a plain Python implementation on NumPy
arrays of eight numbers (`vectors.py`), which runs under NUMBA_DISABLE_JIT=1, and a compiled one (`compiled.py`).
`sqrt`, `where_positive`, `any_positive` and the operators also take single numbers, so that one formula serves both.
"""

from mpmcol.mpm.simd import compiled as compiled  # registers the compiled implementations with Numba
from mpmcol.mpm.simd.vectors import (
    LANES,
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

__all__ = [
    "LANES",
    "any_positive",
    "element",
    "extract",
    "floor",
    "fma",
    "load",
    "load_eight",
    "maximum",
    "prefetch",
    "reduce_max",
    "reduce_sum",
    "scratch",
    "splat",
    "spread",
    "sqrt",
    "store",
    "store_eight",
    "strided",
    "swap_halves",
    "transpose",
    "vector",
    "where_positive",
]
