"""Quadratic B-spline, Eq. 17-18, with the kernel correction beside walls, which are on grid nodes."""

from __future__ import annotations

from typing import Any

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import any_positive, floor, maximum, splat, where_positive

WIDTH = 3
TRAVEL_LIMIT = 1.0
STIFFNESS = 6.0


@device
def base_node(s: float, n: int) -> int:
    """First of the three nodes of the stencil at grid coordinate `s` = (x - origin) / h; all three are in the grid."""
    return min(max(int(s - 0.5), 0), n - 3)


@device
def spline(s: float, n: int, correction: bool) -> tuple[int, float, float, float, float, float, float]:
    """First node, three weights and three gradients (times h) at grid coordinate `s` of an axis of `n` nodes.

    Eq. 17-18. In the half cell beside a wall the kernel correction (doi:10.1016/j.cma.2022.115720) reduces exactly to
    the linear shape functions of the two nodes next to the point, which join the spline with equal slope. Without
    correction the spline is truncated at the wall.
    """
    if s < 0.5:
        if correction:
            return 0, 1.0 - s, s, 0.0, -1.0, 1.0, 0.0
        return 0, 0.75 - s * s, 0.5 * (0.5 + s) * (0.5 + s), 0.0, -2.0 * s, 0.5 + s, 0.0
    xi = (n - 1) - s
    if xi < 0.5:
        if correction:
            return n - 3, 0.0, xi, 1.0 - xi, 0.0, -1.0, 1.0
        return n - 3, 0.0, 0.5 * (0.5 + xi) * (0.5 + xi), 0.75 - xi * xi, 0.0, -(0.5 + xi), 2.0 * xi
    base = base_node(s, n)
    r = s - (base + 1)
    left, right = 0.5 - r, 0.5 + r
    return base, 0.5 * left * left, 0.75 - r * r, 0.5 * right * right, -left, -2.0 * r, right


@device
def spline_lanes(s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, Any, Any, Any, Any, Any, Any]:
    """`spline` of all lanes of a vector, bit for bit; the first node is returned as a real number.

    bottom, top: 0.5 and n - 1.5, where the half cells beside the walls end; minus and plus infinity in lanes without a
    coordinate.
    """
    base = maximum(floor(s - 0.5), splat(0.0))
    base = where_positive(base - (top - 1.5), top - 1.5, base)
    r = s - (base + 1.0)
    left, right = 0.5 - r, 0.5 + r
    w0, w1, w2, g0, g1, g2 = 0.5 * left * left, 0.75 - r * r, 0.5 * right * right, -left, -2.0 * r, right
    below, above = bottom - s, s - top
    if any_positive(maximum(below, above)):  # few points are beside a wall
        near, far, near_slope, far_slope = _beside_wall(s, correction)
        w0, w1, w2 = where_positive(below, near, w0), where_positive(below, far, w1), where_positive(below, 0.0, w2)
        g0, g1 = where_positive(below, near_slope, g0), where_positive(below, far_slope, g1)
        g2 = where_positive(below, 0.0, g2)
        near, far, near_slope, far_slope = _beside_wall((top + 0.5) - s, correction)
        w0, w1, w2 = where_positive(above, 0.0, w0), where_positive(above, far, w1), where_positive(above, near, w2)
        g0, g1 = where_positive(above, 0.0, g0), where_positive(above, -far_slope, g1)
        g2 = where_positive(above, -near_slope, g2)
    return base, w0, w1, w2, g0, g1, g2


@device
def evaluate(s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]:
    """See `ShapeFunctions.evaluate`."""
    base, w0, w1, w2, g0, g1, g2 = spline_lanes(s, bottom, top, correction)
    return base, w0, w1, w2, splat(0.0), g0, g1, g2, splat(0.0)


@device
def _beside_wall(xi: Any, correction: bool) -> tuple[Any, Any, Any, Any]:
    """Weights of the node on the wall and the next node at distance `xi` from the wall, and their gradients."""
    if correction:
        return 1.0 - xi, xi, splat(-1.0), splat(1.0)
    right = 0.5 + xi
    return 0.75 - xi * xi, 0.5 * right * right, -2.0 * xi, right
