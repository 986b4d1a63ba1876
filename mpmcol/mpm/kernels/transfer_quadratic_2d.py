"""Transfers with quadratic shape functions in plane strain and axisymmetry: nine nodes.

Successive points often have the same nodes. Their sums stay in registers until a point has others.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.stencils import (
    AXIS_X,
    AXIS_Y,
    BASE,
    NEAR,
    STENCILS,
    D,
    G,
    W,
    lines_of_axis,
    make_find_stencils,
    three,
    weighted_sum,
)
from mpmcol.mpm.kernels.stress_filter import make_filtered_stress
from mpmcol.mpm.kernels.transfer_common import (
    point_terms,
    point_update,
    prefetch_ahead,
    unit_mass,
    update_point,
)
from mpmcol.mpm.lanes import LANES, RECORD_SIZE, X_VECTOR, Y_VECTOR, Q
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import extract, fma, load, maximum, scratch, splat, store

SIZE, BUFFER, NEAR_2D = RECORD_SIZE[2], STENCILS[2], NEAR[2]
NOWHERE = -1.0  # instead of the first node of a point
filtered_stress = make_filtered_stress(2)
find_stencils, find_with_distances = make_find_stencils(2, distances=False), make_find_stencils(2, distances=True)


@device
def scatter_points(rows: np.ndarray, first: int, stop: int, following: int, grid: Grid, settings: Settings) -> None:
    """P2G of these points; see `transfer.make_scatter_points`."""
    nodes, unit, zero = grid.nodes, unit_mass(2, settings), splat(0.0)
    stencils = scratch(BUFFER)
    sum0 = sum1 = sum2 = zero, zero, zero  # three columns of nodes of equal x
    i, j = NOWHERE, NOWHERE
    for start in range(first, stop, LANES):
        count = min(LANES, stop - start)
        find_with_distances(rows, start * SIZE, count, grid, settings, stencils)
        for k in range(count):
            prefetch_ahead(rows, SIZE, start + k, stop, following)
            if stencils[AXIS_X + BASE + k] != i or stencils[AXIS_Y + BASE + k] != j:
                if i != NOWHERE:
                    _add_to_nodes(nodes, i, j, sum0, sum1, sum2, grid)
                sum0 = sum1 = sum2 = zero, zero, zero
                i, j = stencils[AXIS_X + BASE + k], stencils[AXIS_Y + BASE + k]
            sum0, sum1, sum2 = _add_point(rows, (start + k) * SIZE, stencils, k, unit, sum0, sum1, sum2, settings)
    if i != NOWHERE:
        _add_to_nodes(nodes, i, j, sum0, sum1, sum2, grid)


@device
def _add_point(rows, o, stencils, k, unit, sum0, sum1, sum2, settings):
    """Add a point to the sums of its nodes, Eq. (13), (14), (19), (20)."""
    at_point, taylor, force = point_terms(rows, o, 2, unit, filtered_stress(rows, o, settings), settings)
    column_x, column_y = load(rows, o + X_VECTOR), load(rows, o + Y_VECTOR)
    a_x, f_x, a_y, f_y = column_x * taylor, column_x * force, column_y * taylor, column_y * force

    # node (i, j) receives w_j P_i + w_i Q_j
    wx0, wx1, wx2 = three(stencils, AXIS_X + W + k)
    wy = three(stencils, AXIS_Y + W + k)
    dx0, dx1, dx2 = three(stencils, AXIS_X + D + k)
    dy0, dy1, dy2 = three(stencils, AXIS_Y + D + k)
    gx0, gx1, gx2 = three(stencils, AXIS_X + G + k)
    gy0, gy1, gy2 = three(stencils, AXIS_Y + G + k)
    q = fma(gy0, f_y, dy0 * a_y), fma(gy1, f_y, dy1 * a_y), fma(gy2, f_y, dy2 * a_y)
    return (
        add_column(sum0, wx0, fma(gx0, f_x, fma(dx0, a_x, wx0 * at_point)), wy, q),
        add_column(sum1, wx1, fma(gx1, f_x, fma(dx1, a_x, wx1 * at_point)), wy, q),
        add_column(sum2, wx2, fma(gx2, f_x, fma(dx2, a_x, wx2 * at_point)), wy, q),
    )


@device
def add_column(sums, wx, p, wy, q):
    """Add a point to the sums of three nodes of equal x."""
    return (
        fma(wy[0], p, fma(wx, q[0], sums[0])),
        fma(wy[1], p, fma(wx, q[1], sums[1])),
        fma(wy[2], p, fma(wx, q[2], sums[2])),
    )


@device
def _add_to_nodes(nodes, i, j, sum0, sum1, sum2, grid):
    """Add sums of points to their nodes."""
    x, y = lines_of_axis(grid.ax, i), lines_of_axis(grid.ay, j)
    _add_to_column(nodes, x[0], y, sum0)
    _add_to_column(nodes, x[1], y, sum1)
    _add_to_column(nodes, x[2], y, sum2)


@device
def _add_to_column(nodes, x, y, sums):
    store(nodes, x + y[0], load(nodes, x + y[0]) + sums[0])
    store(nodes, x + y[1], load(nodes, x + y[1]) + sums[1])
    store(nodes, x + y[2], load(nodes, x + y[2]) + sums[2])


@device
def move_points(
    rows: np.ndarray,
    first: int,
    stop: int,
    following: int,
    grid: Grid,
    settings: Settings,
    dt: float,
    averages: np.ndarray,
) -> tuple[Any, Any]:
    """G2P of these points; see `transfer.make_move_points`."""
    nodes, factors, zero = grid.nodes, point_update(2, grid, settings, dt), splat(0.0)
    stencils, travel, limit_work = scratch(BUFFER), zero, zero
    column0 = column1 = column2 = zero, zero, zero  # of nodes of equal x
    i, j = NOWHERE, NOWHERE
    for start in range(first, stop, LANES):
        count = min(LANES, stop - start)
        find_stencils(rows, start * SIZE, count, grid, settings, stencils)
        for k in range(count):
            prefetch_ahead(rows, SIZE, start + k, stop, following)
            if stencils[AXIS_X + BASE + k] != i or stencils[AXIS_Y + BASE + k] != j:
                i, j = stencils[AXIS_X + BASE + k], stencils[AXIS_Y + BASE + k]
                column0, column1, column2 = _load_nodes(nodes, i, j, grid)
            wy, gy = three(stencils, AXIS_Y + W + k), three(stencils, AXIS_Y + G + k)
            wx, gx = three(stencils, AXIS_X + W + k), three(stencils, AXIS_X + G + k)
            sums = weighted_sum(wy, column0), weighted_sum(wy, column1), weighted_sum(wy, column2)
            mean, slopes = (
                weighted_sum(wx, sums),
                (weighted_sum(gy, column0), weighted_sum(gy, column1), weighted_sum(gy, column2)),
            )
            grad_x, grad_y = weighted_sum(gx, sums), weighted_sum(wx, slopes)
            near = stencils[NEAR_2D + k] > 0.0
            o = (start + k) * SIZE
            displacement, work = update_point(rows, o, near, mean, (grad_x, grad_y, grad_y), 2, factors, grid, settings)
            averages[start + k - first] = extract(mean, Q)
            travel, limit_work = maximum(travel, abs(displacement)), limit_work + work
    return travel, limit_work


@device
def _load_nodes(nodes, i, j, grid):
    """Three columns of nodes of equal x."""
    x, y = lines_of_axis(grid.ax, i), lines_of_axis(grid.ay, j)
    return _load_column(nodes, x[0], y), _load_column(nodes, x[1], y), _load_column(nodes, x[2], y)


@device
def _load_column(nodes, x, y):
    return load(nodes, x + y[0]), load(nodes, x + y[1]), load(nodes, x + y[2])
