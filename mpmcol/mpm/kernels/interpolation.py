"""Interpolation of nodal values and their gradients at a point, for shape functions of any width and for APIC."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.transfer_common import broadcast, grid_coordinates, store_gradient
from mpmcol.mpm.lanes import LANES, X, Y, Z
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions import ShapeFunctions
from mpmcol.mpm.simd import extract, fma, load, splat, store, transpose, vector
from mpmcol.mpm.wall_cells import beside_walls, fold_four, fold_three

GRADIENT = 4  # the stencil of an axis is a vector: four weights, then four gradients


def make_axis_stencils(dimension: int, basis: ShapeFunctions, affine: bool) -> Callable[..., Any]:
    """The stencil of a point, axis by axis; affine: the coefficients of APIC's affine matrix instead of gradients."""
    evaluate, width, flat = basis.evaluate, basis.WIDTH, dimension == 2

    @device
    @variant(dimension, basis, affine)
    def axis_stencils(record, grid, settings):
        """First nodes, their distance from the point (in cells), and the stencils of x, y, z, Eq. (7)-(8).

        Gradients are multiplied by h. The coefficients of APIC are w d / sum(w d^2) with d = (x_i - x_p) / h (Jiang et
        al. 2015, doi:10.1145/2766996).
        """
        s, bottom, top = grid_coordinates(record, grid)
        base, w0, w1, w2, w3, g0, g1, g2, g3 = evaluate(s, bottom, top, settings.kernel_correction)
        near, low, high = beside_walls(grid.wall_cells, s, base, width, settings.kernel_correction, grid)
        if near and width == 4:
            w0, w1, w2, w3 = fold_four(low, high, w0, w1, w2, w3)
            g0, g1, g2, g3 = fold_four(low, high, g0, g1, g2, g3)
        elif near and width == 3:
            w0, w1, w2 = fold_three(low, high, w0, w1, w2)
            g0, g1, g2 = fold_three(low, high, g0, g1, g2)
        d = base - s
        if affine:
            d1, d2, d3 = d + 1.0, d + 2.0, d + 3.0
            inertia = fma(w3 * d3, d3, fma(w2 * d2, d2, fma(w1 * d1, d1, w0 * d * d)))
            g0, g1, g2, g3 = w0 * d / inertia, w1 * d1 / inertia, w2 * d2 / inertia, w3 * d3 / inertia
        of_lanes = transpose(w0, w1, w2, w3, g0, g1, g2, g3)
        z = vector(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) if flat else of_lanes[Z]
        return base, d, of_lanes[X], of_lanes[Y], z

    return axis_stencils


def make_interpolate(dimension: int, basis: ShapeFunctions, affine: bool) -> Callable[..., Any]:
    """Weighted sum and gradient of nodal values; affine: APIC's matrix instead of the gradient."""
    axis_stencils, width = make_axis_stencils(dimension, basis, affine), basis.WIDTH
    flat = dimension == 2
    depth = 1 if flat else width

    @device
    @variant(dimension, basis, affine)
    def interpolate(record: Any, nodes: np.ndarray, grid: Grid, settings: Settings) -> tuple[Any, Any, Any, Any]:
        """Sum of w n over the nodes n of a point with vector 0 `record`, and its derivatives along x, y, z."""
        base, _, x, y, z = axis_stencils(record, grid, settings)
        i, j, k = int(extract(base, X)), int(extract(base, Y)), 0 if flat else int(extract(base, Z))
        mean, grad_x, grad_y, grad_z = splat(0.0), splat(0.0), splat(0.0), splat(0.0)
        for a in range(width):
            plane, plane_y, plane_z = splat(0.0), splat(0.0), splat(0.0)
            for b in range(width):
                line, line_z = splat(0.0), splat(0.0)
                for c in range(depth):
                    node = load(nodes, grid.ax[i + a] + grid.ay[j + b] + grid.az[k + c])
                    line, line_z = fma(broadcast(z, c), node, line), fma(broadcast(z, GRADIENT + c), node, line_z)
                plane = fma(broadcast(y, b), line, plane)
                plane_y = fma(broadcast(y, GRADIENT + b), line, plane_y)
                plane_z = fma(broadcast(y, b), line_z, plane_z)
            mean, grad_x = fma(broadcast(x, a), plane, mean), fma(broadcast(x, GRADIENT + a), plane, grad_x)
            grad_y, grad_z = fma(broadcast(x, a), plane_y, grad_y), fma(broadcast(x, a), plane_z, grad_z)
        inv_h = 1.0 / grid.h
        return mean, inv_h * grad_x, inv_h * grad_y, inv_h * grad_z

    return interpolate


@device
def save_columns(matrices: np.ndarray, at: int, d: int, x: Any, y: Any, z: Any) -> None:
    """Write `d` columns of a matrix as vectors from `matrices[at]` on."""
    store(matrices, at, x)
    store(matrices, at + LANES, y)
    if d == 3:
        store(matrices, at + 2 * LANES, z)


@device
def restore_columns(rows: np.ndarray, o: int, d: int, matrices: np.ndarray, at: int) -> None:
    """Write saved columns to the velocity gradient of the record that starts at `o`."""
    x, y = load(matrices, at), load(matrices, at + LANES)
    store_gradient(rows, o, d, x, y, load(matrices, at + 2 * LANES) if d == 3 else y)
