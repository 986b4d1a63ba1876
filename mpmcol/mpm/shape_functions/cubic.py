"""Cubic B-spline: four nodes an axis, at least; beside walls it takes the node outside for a linear continuation.

The value of the node outside is twice that on the wall less the next one, so its weight goes to these two (as the
modified splines of Steffen, Kirby & Berzins 2008, doi:10.1002/nme.2360, it keeps constants and linear fields). The same
rule gives the quadratic spline the hats of its kernel correction.
"""

from __future__ import annotations

from typing import Any

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import larger, round_down, splat, where_positive

WIDTH = 4
TRAVEL = 0.5  # farther, and stencils of two tiles of one colour could meet
STIFFNESS = 3.14


@device
def padded(s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]:
    """First node, four weights and four gradients (times h); without correction the spline is cut off at walls."""
    last = top - 0.5  # the cell beside the upper wall, and the first node of a stencil cannot lie beyond last - 2
    cell = larger(round_down(s), splat(0.0))
    cell = where_positive(cell - last, last, cell)
    base = larger(cell - 1.0, splat(0.0))
    base = where_positive(base - (last - 2.0), last - 2.0, base)
    r = s - cell
    q = 1.0 - r
    w0, w3 = q * q * q * (1.0 / 6.0), r * r * r * (1.0 / 6.0)
    w1, w2 = 2.0 / 3.0 + r * r * (0.5 * r - 1.0), 2.0 / 3.0 + q * q * (0.5 * q - 1.0)
    g0, g1, g2, g3 = -0.5 * q * q, r * (1.5 * r - 2.0), q * (2.0 - 1.5 * q), 0.5 * r * r
    below, above = (bottom + 0.5) - s, s - last
    w0, w1, w2, w3 = _inside(below, above, correction, w0, w1, w2, w3)
    g0, g1, g2, g3 = _inside(below, above, correction, g0, g1, g2, g3)
    return base, w0, w1, w2, w3, g0, g1, g2, g3


@device
def _inside(below: Any, above: Any, correction: bool, a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any, Any, Any]:
    """Weights (or gradients) of the four nodes inside the grid: one of these lies outside in the cells beside walls."""
    lost = 1.0 if correction else 0.0
    low_a, low_b = b + (2.0 * lost) * a, c - lost * a
    high_d, high_c = c + (2.0 * lost) * d, b - lost * d
    return (
        where_positive(below, low_a, where_positive(above, 0.0, a)),
        where_positive(below, low_b, where_positive(above, a, b)),
        where_positive(below, d, where_positive(above, high_c, c)),
        where_positive(below, 0.0, where_positive(above, high_d, d)),
    )
