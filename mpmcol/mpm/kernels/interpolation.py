"""Sums over the nodes around a point, for a basis of any width and for slopes other than its gradients."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.transfer_common import places, spread, store_column
from mpmcol.mpm.lanes import X, Y, Z
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions import ShapeFunctions
from mpmcol.mpm.simd import LANES, extract, fma, load, splat, store, transpose, vector

SLOPE = 4  # lane of the first slope: the weights of an axis stand in lanes 0 to 3 of a vector, its slopes behind them


def make_lines(dimension: int, basis: ShapeFunctions, affine: bool) -> Callable[..., Any]:
    """The stencil of a point, axis by axis; slopes are gradients (times h), or those of APIC's affine matrix."""
    evaluate, flat = basis.evaluate, dimension == 2

    @device
    @variant(dimension, basis, affine)
    def lines(record, grid, settings):
        """First nodes and their distance from the point (in cells), and weights and slopes of x, y, z, Eq. (17)-(18).

        APIC's slopes are w d / sum(w d^2) with d = (x_i - x_p) / h (Jiang et al. 2015, doi:10.1145/2766996).
        """
        s, bottom, top = places(record, grid)
        base, w0, w1, w2, w3, g0, g1, g2, g3 = evaluate(s, bottom, top, settings.kernel_correction)
        d = base - s
        if affine:
            d1, d2, d3 = d + 1.0, d + 2.0, d + 3.0
            inertia = fma(w3 * d3, d3, fma(w2 * d2, d2, fma(w1 * d1, d1, w0 * d * d)))
            g0, g1, g2, g3 = w0 * d / inertia, w1 * d1 / inertia, w2 * d2 / inertia, w3 * d3 / inertia
        of_lanes = transpose(w0, w1, w2, w3, g0, g1, g2, g3)
        z = vector(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) if flat else of_lanes[Z]
        return base, d, of_lanes[X], of_lanes[Y], z

    return lines


def make_sums(dimension: int, basis: ShapeFunctions, affine: bool) -> Callable[..., Any]:
    """Weighted sum and slopes of the nodes around a point."""
    lines, width, flat = make_lines(dimension, basis, affine), basis.WIDTH, dimension == 2
    depth = 1 if flat else width

    @device
    @variant(dimension, basis, affine)
    def sums(record: Any, nodes: np.ndarray, grid: Grid, settings: Settings) -> tuple[Any, Any, Any, Any]:
        """Sum of w n over the nodes n of the point whose record starts with this row, and slopes along x, y, z."""
        base, _, x, y, z = lines(record, grid, settings)
        i, j, k = int(extract(base, X)), int(extract(base, Y)), 0 if flat else int(extract(base, Z))
        mean, slope_x, slope_y, slope_z = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
        for a in range(width):
            plane, plane_y, plane_z = splat(0.0), splat(0.0), splat(0.0)
            for b in range(width):
                row, row_z = splat(0.0), splat(0.0)
                for c in range(depth):
                    node = load(nodes, grid.ax[i + a] + grid.ay[j + b] + grid.az[k + c])
                    row, row_z = fma(spread(z, c), node, row), fma(spread(z, SLOPE + c), node, row_z)
                plane = fma(spread(y, b), row, plane)
                plane_y, plane_z = fma(spread(y, SLOPE + b), row, plane_y), fma(spread(y, b), row_z, plane_z)
            mean, slope_x = fma(spread(x, a), plane, mean), fma(spread(x, SLOPE + a), plane, slope_x)
            slope_y, slope_z = fma(spread(x, a), plane_y, slope_y), fma(spread(x, a), plane_z, slope_z)
        inv_h = 1.0 / grid.h
        return mean, inv_h * slope_x, inv_h * slope_y, inv_h * slope_z

    return sums


@device
def keep_columns(matrix: np.ndarray, at: int, d: int, x: Any, y: Any, z: Any) -> None:
    """Write the `d` columns of a matrix as vectors from `matrix[at]` on."""
    store(matrix, at, x)
    store(matrix, at + LANES, y)
    if d == 3:
        store(matrix, at + 2 * LANES, z)


@device
def set_columns(rows: np.ndarray, o: int, d: int, x: Any, y: Any, z: Any) -> None:
    """Write the `d` columns of a matrix into the lanes of the velocity gradient of the record at `o`."""
    store_column(rows, o + LANES, d, x)
    store_column(rows, o + 2 * LANES, d, y)
    if d == 3:
        store_column(rows, o + 3 * LANES, d, z)


@device
def restore_columns(rows: np.ndarray, o: int, d: int, matrix: np.ndarray, at: int) -> None:
    """Bring columns that were kept into the lanes of the velocity gradient of the record at `o`."""
    x, y = load(matrix, at), load(matrix, at + LANES)
    set_columns(rows, o, d, x, y, load(matrix, at + 2 * LANES) if d == 3 else y)
