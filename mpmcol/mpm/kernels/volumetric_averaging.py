"""Cell-averaged volumetric strain, to avoid volumetric locking (B-bar).

The average is weighted by volume, so that the nodal forces stay conjugate to the strain: the pressure due to it is
uniform in a cell (Hughes 1980, doi:10.1002/nme.1620150914; for MPM Coombs et al. 2018, doi:10.1016/j.cma.2018.01.010;
over cells Mast et al. 2012, doi:10.1016/j.jcp.2012.04.032). Cells are those of the last sort, the pieces of the
quadratic spline. The points of a cell are contiguous and inside one tile, so that their sums have the same order for
any number of threads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.lanes import L_DIAGONAL, OPENING, RECORD_SIZE, V0, J


def make_volumetric_excess(dimension: int) -> Callable[..., Any]:
    """Volumetric strain rate of points in excess of the mean of their cell."""
    size, (xx, yy, zz) = RECORD_SIZE[dimension], L_DIAGONAL[dimension]

    @device
    @variant(dimension)
    def volumetric_excess(rows: np.ndarray, cells: np.ndarray, first: int, stop: int, out: np.ndarray) -> None:
        """Write to `out` (stop - first,) a third of the excess volumetric strain rate (1/s) of each point.

        Open points have none, and do not contribute to the mean. Reads: rows (L, J, V0, e_o), cells.
        """
        begin = first
        while begin < stop:
            volume, rate, end = 0.0, 0.0, begin
            while end < stop and cells[end] == cells[begin]:
                o = end * size
                if rows[o + OPENING] <= 0.0:
                    V_p = rows[o + J] * rows[o + V0]
                    volume += V_p
                    rate += V_p * (rows[o + xx] + rows[o + yy] + rows[o + zz])
                end += 1
            mean = rate / volume if volume > 0.0 else 0.0
            for p in range(begin, end):
                o = p * size
                excess = (rows[o + xx] + rows[o + yy] + rows[o + zz]) - mean
                out[p - first] = excess * (1.0 / 3.0) if rows[o + OPENING] <= 0.0 else 0.0
            begin = end

    return volumetric_excess
