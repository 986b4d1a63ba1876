"""Linear hats: two nodes an axis, whole up to walls that stand on grid nodes. Points ring as they cross cells."""

from __future__ import annotations

from typing import Any

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import larger, round_down, splat, where_positive

WIDTH = 2
TRAVEL = 1.0
STIFFNESS = float("inf")  # 1 / (xi (1 - xi)) at a distance xi from a node: no bound for a point alone


@device
def padded(s: Any, bottom: Any, top: Any, correction: bool) -> tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]:
    """First node, two weights and two gradients (times h), padded with zeros; nothing needs a correction."""
    cell = larger(round_down(s), splat(0.0))
    cell = where_positive(cell - (top - 0.5), top - 0.5, cell)
    r, nothing = s - cell, splat(0.0)
    return cell, 1.0 - r, r, nothing, nothing, splat(-1.0), splat(1.0), nothing, nothing
