"""Compile the kernels of the default tests: `python -m tests.support.kernels first` and `second`, at the same time.

Variants share most of the functions that they call. Two processes that compile all variants take half the time of one
for each variant, because they compile these functions once.
"""

from __future__ import annotations

import sys

from mpmcol.bench.cases import make_solver
from mpmcol.bench.measure import vector_steps
from mpmcol.sweep.compile_cache import compile_kernels
from tests.support.sand_column import OTHER_SCHEME

OTHER = (
    f"method.stress_order={OTHER_SCHEME.stress_order}",
    f"method.transfer={'apic' if OTHER_SCHEME.affine else 'taylor-flip'}",
    f"method.basis={OTHER_SCHEME.basis}",
    f"method.volumetric_strain={OTHER_SCHEME.volumetric_strain}",
)
VARIANTS: dict[str, list[tuple[str, tuple[str, ...]]]] = {
    "first": [
        ("coarse-channel", ("stages.equilibrate.law=elastic",)),
        ("coarse-channel", ("method.basis=linear",)),
        ("coarse-channel", ("method.transfer=apic",)),
        ("coarse-channel", ("method.stress_order=usf",)),
        ("granular-bed", ()),
    ],
    "second": [
        ("lube-quarter", ()),
        ("lube-quarter", ("method.basis=linear", "stages.equilibrate.law=mohr-coulomb")),
        ("lube-channel-dense", ()),
        ("coarse-channel", OTHER),
    ],
}

if __name__ == "__main__":
    for source, overrides in VARIANTS[sys.argv[1]]:
        compile_kernels(source, overrides)
    if sys.argv[1] == "first":
        solver = make_solver("plane", 2000)
        solver.sort()
        vector_steps(solver, 1)
