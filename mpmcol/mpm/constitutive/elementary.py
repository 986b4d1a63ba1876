"""Elementary functions as polynomials, for numbers or vectors; the results are equal bit for bit on all machines."""

from __future__ import annotations

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import sqrt, where_positive

_HALVINGS = 6
_LARGEST = 40.0  # exp(-40) is less than round-off of one


@device
def decay(x):
    """exp(-x) for x >= 0, to 5e-15: a Taylor series of x / 64, squared six times."""
    y = where_positive(x - _LARGEST, _LARGEST, x) * (-1.0 / 2**_HALVINGS)
    value = 1.0 + y * (1.0 / 9.0)
    for n in range(8, 0, -1):
        value = 1.0 + y * value * (1.0 / n)
    for _ in range(_HALVINGS):
        value = value * value
    return value


@device
def sine(x):
    """sin(x) for 0 <= x <= pi / 2, to round-off: a Taylor series."""
    square = x * x
    value = 1.0 - square * (1.0 / (22 * 23))
    for n in range(20, 0, -2):
        value = 1.0 - square * value * (1.0 / (n * (n + 1)))
    return x * value


@device
def cotangent(sin_x):
    """cot(x) from sin(x), for 0 < x <= pi / 2."""
    return sqrt(1.0 - sin_x * sin_x) / sin_x
