"""Volumetric strain averaged over cells: what keeps its volume does not lock on a grid that has too few ways to move.

Cells are those of the last sort, pieces of the quadratic spline: the points of one stand in one row, inside one tile,
so that their sums have one order for any number of threads. With the average weighted by volume the nodes' forces stay
conjugate to the strain: the pressure that it makes is uniform in a cell (as B-bar, Hughes 1980,
doi:10.1002/nme.1620150914; for MPM Coombs et al. 2018, doi:10.1016/j.cma.2018.01.010, and over cells Mast et al. 2012,
doi:10.1016/j.jcp.2012.04.032).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.lanes import L_DIAGONAL, OPENING, RECORD_SIZE, V0, J


def make_excess(dimension: int) -> Callable[..., Any]:
    """What points swell by beyond the mean of their cell."""
    row, (xx, yy, zz) = RECORD_SIZE[dimension], L_DIAGONAL[dimension]

    @device
    @variant(dimension)
    def excess(rows: np.ndarray, cells: np.ndarray, first: int, stop: int, out: np.ndarray) -> None:
        """Write into `out` (stop - first,) a third of the rate (1/s) at which points swell beyond their cell.

        Points that are open swell as they do, and count for nothing. Reads: rows (L, J, V0, e_o), cells.
        """
        begin = first
        while begin < stop:
            volume, swelling, end = 0.0, 0.0, begin
            while end < stop and cells[end] == cells[begin]:
                o = end * row
                if rows[o + OPENING] <= 0.0:
                    own = rows[o + J] * rows[o + V0]
                    volume += own
                    swelling += own * (rows[o + xx] + rows[o + yy] + rows[o + zz])
                end += 1
            mean = swelling / volume if volume > 0.0 else 0.0
            for p in range(begin, end):
                o = p * row
                beyond = (rows[o + xx] + rows[o + yy] + rows[o + zz]) - mean
                out[p - first] = beyond * (1.0 / 3.0) if rows[o + OPENING] <= 0.0 else 0.0
            begin = end

    return excess
