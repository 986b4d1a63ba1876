"""Benchmark of the kernels (`mpmcol bench`): cases, plain loops for comparison, timing, report."""
