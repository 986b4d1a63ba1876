"""A vector of eight doubles as a Numba type, so that kernels read like formulas and compile to packed code.

LLVM splits the vectors by itself on machines whose registers are narrower. Every function has a plain Python body
(`vectors.py`) that works on NumPy arrays of eight numbers, the twin that runs under NUMBA_DISABLE_JIT=1, and a compiled
one (`compiled.py`). `root`, `where_positive` and `any_positive` take single numbers too, as do the operators, so that a
formula written with them serves both.
"""

from mpmcol.mpm.simd import compiled as compiled  # declares to Numba what the names below compile to
from mpmcol.mpm.simd.vectors import (
    LANES,
    any_positive,
    fma,
    lane,
    larger,
    largest_lane,
    load,
    prefetch,
    root,
    round_down,
    splat,
    store,
    sum_lanes,
    swap_halves,
    transpose,
    vector,
    where_positive,
)

__all__ = [
    "LANES",
    "any_positive",
    "fma",
    "lane",
    "larger",
    "largest_lane",
    "load",
    "prefetch",
    "root",
    "round_down",
    "splat",
    "store",
    "sum_lanes",
    "swap_halves",
    "transpose",
    "vector",
    "where_positive",
]
