"""Monotonic cubic interpolation: as PCHIP of SciPy, whose import takes longer than drawing a chart."""

from __future__ import annotations

import numpy as np

from mpmcol.measure import Array


def monotonic_cubic(values: Array, x: Array) -> Array:
    """Values (n,), n > 1, at 0, 1, ..., n - 1 interpolated at x, which are between these, without new extrema.

    Cubic Hermite polynomials. Slopes are the harmonic mean of the secants at both sides, zero where these differ in
    sign; Fritsch & Butland (1984), doi:10.1137/0905021.
    """
    secants = np.diff(values)
    slopes = np.empty(len(values))
    product, total = secants[:-1] * secants[1:], secants[:-1] + secants[1:]
    slopes[1:-1] = np.where(product > 0.0, 2.0 * product / np.where(product > 0.0, total, 1.0), 0.0)
    slopes[0], slopes[-1] = _end_slope(secants[:2]), _end_slope(secants[-2:][::-1])
    k = np.minimum(x.astype(int), len(values) - 2)
    t = x - k
    return np.asarray(
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * values[k]
        + t**2 * (3.0 - 2.0 * t) * values[k + 1]
        + t * (1.0 - t) ** 2 * slopes[k]
        - t**2 * (1.0 - t) * slopes[k + 1]
    )


def _end_slope(secants: Array) -> float:
    """Slope at an end from the first two secants: of the parabola through three points, limited to keep its sign."""
    if len(secants) == 1:
        return float(secants[0])
    near, next_one = secants
    slope = 1.5 * near - 0.5 * next_one
    if slope * near <= 0.0:
        return 0.0
    if near * next_one <= 0.0 and abs(slope) > 3.0 * abs(near):
        return float(3.0 * near)
    return float(slope)
