"""Quadratic B-spline, Eq. 17-18, with its correction beside walls that stand on grid nodes."""

from __future__ import annotations

from mpmcol.jit import device


@device
def base_node(s: float, n: int) -> int:
    """First of the three nodes whose spline reaches grid coordinate `s` = (x - origin) / h, kept in the grid."""
    return min(max(int(s - 0.5), 0), n - 3)


@device
def spline(s: float, n: int, correction: bool) -> tuple[int, float, float, float, float, float, float]:
    """First node, three weights and three gradients (times h) at grid coordinate `s` of an axis of `n` nodes.

    Eq. 17-18. In the half cell beside a wall the kernel correction (doi:10.1016/j.cma.2022.115720) reduces
    exactly to the linear hats on the two nodes next to the point, which join the spline with equal slope;
    without correction the spline is cut off at the wall.
    """
    if s < 0.5:
        if correction:
            return 0, 1.0 - s, s, 0.0, -1.0, 1.0, 0.0
        return 0, 0.75 - s * s, 0.5 * (0.5 + s) ** 2, 0.0, -2.0 * s, 0.5 + s, 0.0
    xi = (n - 1) - s
    if xi < 0.5:
        if correction:
            return n - 3, 0.0, xi, 1.0 - xi, 0.0, -1.0, 1.0
        return n - 3, 0.0, 0.5 * (0.5 + xi) ** 2, 0.75 - xi * xi, 0.0, -(0.5 + xi), 2.0 * xi
    base = base_node(s, n)
    r = s - (base + 1)
    left, right = 0.5 - r, 0.5 + r
    return base, 0.5 * left * left, 0.75 - r * r, 0.5 * right * right, -left, -2.0 * r, right
