"""Cubic B-spline: four nodes per axis. Beside walls, linear extrapolation replaces the node outside the grid.

The value of the node outside is twice that on the wall minus that of the next node, so its weight is distributed to
these two. Like the modified splines of Steffen, Kirby & Berzins (2008, doi:10.1002/nme.2360) this reproduces constant
and linear fields. The same rule turns the quadratic spline into the linear functions of its kernel correction.
"""

from __future__ import annotations

from typing import Any

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import floor, maximum, splat, where_positive

WIDTH = 4
TRAVEL_LIMIT = 0.5  # beyond it, stencils of two tiles of one colour could overlap
STIFFNESS = 3.14


@device
def evaluate(s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]:
    """See `ShapeFunctions.evaluate`; without correction the spline is truncated at walls."""
    last = top - 0.5  # the cell beside the upper wall; the first node of a stencil is at most last - 2
    cell = maximum(floor(s), splat(0.0))
    cell = where_positive(cell - last, last, cell)
    base = maximum(cell - 1.0, splat(0.0))
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
    """Weights (or gradients) of four nodes inside the grid; in the cells beside walls one of a to d lies outside."""
    share = 1.0 if correction else 0.0
    low_a, low_b = b + (2.0 * share) * a, c - share * a
    high_d, high_c = c + (2.0 * share) * d, b - share * d
    return (
        where_positive(below, low_a, where_positive(above, 0.0, a)),
        where_positive(below, low_b, where_positive(above, a, b)),
        where_positive(below, d, where_positive(above, high_c, c)),
        where_positive(below, 0.0, where_positive(above, high_d, d)),
    )
