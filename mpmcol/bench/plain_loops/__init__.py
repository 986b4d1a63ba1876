"""The step in plain Numba loops, the reference that the vector kernels are timed against."""
