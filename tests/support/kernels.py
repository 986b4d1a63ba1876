"""Compile the kernels of the default tests: `python -m tests.support.kernels DIMENSION`.

Variants of one dimension share most of the functions that they call. One process that compiles all of them compiles
these functions once.
"""

from __future__ import annotations

import sys

from mpmcol.sweep.compile_cache import compile_kernels

OTHER = ("method.stress_order=musl", "method.transfer=apic", "method.basis=cubic", "method.volumetric_strain=cell")
VARIANTS: dict[str, list[tuple[str, tuple[str, ...]]]] = {
    "2": [
        ("quickstart", ("stages.equilibrate.law=elastic",)),
        ("quickstart", ("method.basis=linear",)),
        ("quickstart", ("method.transfer=apic",)),
        ("quickstart", ("method.stress_order=usf",)),
        ("quickstart", OTHER),
        ("lube-channel-dense", ()),
    ],
    "3": [
        ("lube-quarter", ()),
        ("lube-quarter", ("method.basis=linear", "stages.equilibrate.law=mohr-coulomb")),
    ],
}

if __name__ == "__main__":
    for source, overrides in VARIANTS[sys.argv[1]]:
        compile_kernels(source, overrides)
