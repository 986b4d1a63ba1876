"""Whether a register holds a whole vector: the only place where the code depends on the instruction set.

Kernels may have a form for registers of four doubles (AVX2), which gives the same bits. It is taken where the features
of the processor are known and AVX-512 is not among them.
"""

from __future__ import annotations

from numba.core.registry import cpu_target


def holds_vector(features: str) -> bool:
    """Whether registers hold eight doubles, from the features as LLVM lists them; taken as true if there is no list."""
    return not features or "+avx512f" in features.split(",")


WHOLE = holds_vector(cpu_target.target_context.codegen().magic_tuple()[2])
