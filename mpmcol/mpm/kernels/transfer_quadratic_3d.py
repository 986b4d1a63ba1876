"""Transfers with quadratic shape functions in three dimensions: twenty-seven nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.stencils import (
    AXIS_X,
    AXIS_Y,
    AXIS_Z,
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
from mpmcol.mpm.lanes import LANES, RECORD_SIZE, X_VECTOR, Y_VECTOR, Z_VECTOR, Q
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import extract, fma, load, maximum, scratch, splat, store

SIZE, BUFFER, NEAR_3D = RECORD_SIZE[3], STENCILS[3], NEAR[3]
filtered_stress = make_filtered_stress(3)
find_stencils, find_with_distances = make_find_stencils(3, distances=False), make_find_stencils(3, distances=True)


@device
def scatter_points(rows: np.ndarray, first: int, stop: int, following: int, grid: Grid, settings: Settings) -> None:
    """P2G of these points; see `transfer.make_scatter_points`."""
    nodes, unit, stencils = grid.nodes, unit_mass(3, settings), scratch(BUFFER)
    for start in range(first, stop, LANES):
        count = min(LANES, stop - start)
        find_with_distances(rows, start * SIZE, count, grid, settings, stencils)
        for k in range(count):
            prefetch_ahead(rows, SIZE, start + k, stop, following)
            _add_point(rows, (start + k) * SIZE, stencils, k, unit, nodes, grid, settings)


@device
def _add_point(rows, o, stencils, k, unit, nodes, grid, settings):
    """Add a point to its nodes, Eq. (13), (14), (19), (20)."""
    at_point, taylor, force = point_terms(rows, o, 3, unit, filtered_stress(rows, o, settings), settings)
    column_x, column_y, column_z = load(rows, o + X_VECTOR), load(rows, o + Y_VECTOR), load(rows, o + Z_VECTOR)
    x, y, z = _lines(stencils, k, grid)

    # node (i, j, k) receives w_j w_k P_i + w_i (w_k Q_j + w_j R_k)
    wx, wy, wz = three(stencils, AXIS_X + W + k), three(stencils, AXIS_Y + W + k), three(stencils, AXIS_Z + W + k)
    px, py, pz = (
        _terms(stencils, AXIS_X + k, column_x * taylor, column_x * force),
        _terms(stencils, AXIS_Y + k, column_y * taylor, column_y * force),
        _terms(stencils, AXIS_Z + k, column_z * taylor, column_z * force),
    )
    p = fma(wx[0], at_point, px[0]), fma(wx[1], at_point, px[1]), fma(wx[2], at_point, px[2])
    _add_plane(nodes, y[0], x, z, wx, wy[0], wz, p, py[0], pz)
    _add_plane(nodes, y[1], x, z, wx, wy[1], wz, p, py[1], pz)
    _add_plane(nodes, y[2], x, z, wx, wy[2], wz, p, py[2], pz)


@device
def _lines(stencils, k, grid):
    """Offsets of the node lines of a point along x, y and z."""
    return (
        lines_of_axis(grid.ax, stencils[AXIS_X + BASE + k]),
        lines_of_axis(grid.ay, stencils[AXIS_Y + BASE + k]),
        lines_of_axis(grid.az, stencils[AXIS_Z + BASE + k]),
    )


@device
def _terms(stencils, at, a, f):
    """Terms with weight times distance and with the gradient along an axis, for its three nodes."""
    d, g = three(stencils, at + D), three(stencils, at + G)
    return fma(g[0], f, d[0] * a), fma(g[1], f, d[1] * a), fma(g[2], f, d[2] * a)


@device
def _add_plane(nodes, y, x, z, wx, wy, wz, p, q, r):
    """Add one point to nine nodes of equal y."""
    _add_line(nodes, y + z[0], x, wx, wy * wz[0], p, fma(wz[0], q, wy * r[0]))
    _add_line(nodes, y + z[1], x, wx, wy * wz[1], p, fma(wz[1], q, wy * r[1]))
    _add_line(nodes, y + z[2], x, wx, wy * wz[2], p, fma(wz[2], q, wy * r[2]))


@device
def _add_line(nodes, o, x, wx, w_yz, p, t):
    """Add one point to three nodes of equal y and z."""
    store(nodes, o + x[0], fma(w_yz, p[0], fma(wx[0], t, load(nodes, o + x[0]))))
    store(nodes, o + x[1], fma(w_yz, p[1], fma(wx[1], t, load(nodes, o + x[1]))))
    store(nodes, o + x[2], fma(w_yz, p[2], fma(wx[2], t, load(nodes, o + x[2]))))


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
    nodes, factors, zero = grid.nodes, point_update(3, grid, settings, dt), splat(0.0)
    stencils, travel, limit_work = scratch(BUFFER), zero, zero
    for start in range(first, stop, LANES):
        count = min(LANES, stop - start)
        find_stencils(rows, start * SIZE, count, grid, settings, stencils)
        for k in range(count):
            prefetch_ahead(rows, SIZE, start + k, stop, following)
            x, y, z = _lines(stencils, k, grid)
            wy, gy = three(stencils, AXIS_Y + W + k), three(stencils, AXIS_Y + G + k)
            wz, gz = three(stencils, AXIS_Z + W + k), three(stencils, AXIS_Z + G + k)
            sum0, y0, z0 = _across(nodes, x[0], y, z, wy, gy, wz, gz)
            sum1, y1, z1 = _across(nodes, x[1], y, z, wy, gy, wz, gz)
            sum2, y2, z2 = _across(nodes, x[2], y, z, wy, gy, wz, gz)
            wx, gx = three(stencils, AXIS_X + W + k), three(stencils, AXIS_X + G + k)
            mean, grad_x = weighted_sum(wx, (sum0, sum1, sum2)), weighted_sum(gx, (sum0, sum1, sum2))
            gradient = grad_x, weighted_sum(wx, (y0, y1, y2)), weighted_sum(wx, (z0, z1, z2))
            near = stencils[NEAR_3D + k] > 0.0
            displacement, work = update_point(
                rows, (start + k) * SIZE, near, mean, gradient, 3, factors, grid, settings
            )
            averages[start + k - first] = extract(mean, Q)
            travel, limit_work = maximum(travel, abs(displacement)), limit_work + work
    return travel, limit_work


@device
def _across(nodes, x, y, z, wy, gy, wz, gz):
    """Weighted sum of nine nodes of equal x, and its derivatives along y and z."""
    sum0, slope0 = _along_z(nodes, x + y[0], z, wz, gz)
    sum1, slope1 = _along_z(nodes, x + y[1], z, wz, gz)
    sum2, slope2 = _along_z(nodes, x + y[2], z, wz, gz)
    sums, slopes = (sum0, sum1, sum2), (slope0, slope1, slope2)
    return weighted_sum(wy, sums), weighted_sum(gy, sums), weighted_sum(wy, slopes)


@device
def _along_z(nodes, o, z, wz, gz):
    """Weighted sum and derivative along z of three nodes of equal x and y."""
    values = load(nodes, o + z[0]), load(nodes, o + z[1]), load(nodes, o + z[2])
    return weighted_sum(wz, values), weighted_sum(gz, values)
