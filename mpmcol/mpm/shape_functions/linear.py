"""Linear shape functions: two nodes per axis. They need no correction at walls; points that cross cells cause noise."""

from __future__ import annotations

from typing import Any

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import floor, maximum, splat, where_positive

WIDTH = 2
TRAVEL_LIMIT = 1.0
STIFFNESS = float("inf")  # 1 / (xi (1 - xi)) at a distance xi from a node: unbounded


@device
def evaluate(s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]:
    """See `ShapeFunctions.evaluate`; the correction has no effect."""
    cell = maximum(floor(s), splat(0.0))
    cell = where_positive(cell - (top - 0.5), top - 0.5, cell)
    r, zero = s - cell, splat(0.0)
    return cell, 1.0 - r, r, zero, zero, splat(-1.0), splat(1.0), zero, zero
