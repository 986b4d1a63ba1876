"""Points to grid and grid to points in three dimensions: twenty-seven nodes a point."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol import state
from mpmcol.basis import spline
from mpmcol.grid import Grid
from mpmcol.jit import device
from mpmcol.kernels.transfer import WALL_GAP, forces, momenta, move, power, store_column
from mpmcol.simd import fma, load, splat, store, vector
from mpmcol.state import V0, J, M, Settings, X, Y, Z

ROW = state.ROW[3]


@device
def limits(grid: Grid, settings: Settings) -> tuple[Any, Any]:
    """Least and largest position of a point: WALL_GAP h inside the grid."""
    gap, far = WALL_GAP * grid.h, np.inf
    x, y, z = grid.origin_x, grid.origin_y, grid.origin_z
    x_end, y_end, z_end = x + (grid.n_x - 1) * grid.h, y + (grid.n_y - 1) * grid.h, z + (grid.n_z - 1) * grid.h
    return (
        vector(-far, -far, -far, -far, x + gap, y + gap, z + gap, -far),
        vector(far, far, far, far, x_end - gap, y_end - gap, z_end - gap, far),
    )


@device
def scatter(rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings) -> None:
    """Add one point, whose record starts at `o`, to its twenty-seven nodes."""
    h, inv_h, correct = grid.h, 1.0 / grid.h, settings.kernel_correction
    s_x, s_y = (rows[o + X] - grid.origin_x) * inv_h, (rows[o + Y] - grid.origin_y) * inv_h
    s_z = (rows[o + Z] - grid.origin_z) * inv_h
    i, wx0, wx1, wx2, gx0, gx1, gx2 = spline(s_x, grid.n_x, correct)
    j, wy0, wy1, wy2, gy0, gy1, gy2 = spline(s_y, grid.n_y, correct)
    k, wz0, wz1, wz2, gz0, gz1, gz2 = spline(s_z, grid.n_z, correct)
    dx, dy, dz = (i - s_x) * h, (j - s_y) * h, (k - s_z) * h
    m, volume = rows[o + M], rows[o + J] * rows[o + V0]

    # Eq. 19, 20, 14: mass, momentum at the point, weight
    momentum = splat(m) * momenta(3)
    weight = vector(m, 0.0, 0.0, 0.0, m * settings.gravity_x, m * settings.gravity_y, m * settings.gravity_z, 0.0)
    at_point = fma(load(rows, o), momentum, weight)
    # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
    taylor, force = settings.taylor * momentum, (-volume * inv_h) * forces(3)
    row_x, row_y, row_z = load(rows, o + 8), load(rows, o + 16), load(rows, o + 24)
    a_x, f_x, a_y, f_y, a_z, f_z = (
        row_x * taylor,
        row_x * force,
        row_y * taylor,
        row_y * force,
        row_z * taylor,
        row_z * force,
    )

    # node (i, j, k) receives w_j w_k P_i + w_i (w_k Q_j + w_j R_k)
    p0 = fma(splat(wx0), fma(splat(dx), a_x, at_point), splat(gx0) * f_x)
    p1 = fma(splat(wx1), fma(splat(dx + h), a_x, at_point), splat(gx1) * f_x)
    p2 = fma(splat(wx2), fma(splat(dx + 2.0 * h), a_x, at_point), splat(gx2) * f_x)
    r0 = fma(splat(wz0 * dz), a_z, splat(gz0) * f_z)
    r1 = fma(splat(wz1 * (dz + h)), a_z, splat(gz1) * f_z)
    r2 = fma(splat(wz2 * (dz + 2.0 * h)), a_z, splat(gz2) * f_z)
    w = splat(wx0), splat(wx1), splat(wx2)
    x_lines = grid.ax[i], grid.ax[i + 1], grid.ax[i + 2]
    z_lines = grid.az[k], grid.az[k + 1], grid.az[k + 2]
    p, r, wz = (p0, p1, p2), (r0, r1, r2), (wz0, wz1, wz2)
    _add_plane(nodes, grid.ay[j], x_lines, z_lines, w, wy0, wz, p, fma(splat(wy0 * dy), a_y, splat(gy0) * f_y), r)
    q1 = fma(splat(wy1 * (dy + h)), a_y, splat(gy1) * f_y)
    _add_plane(nodes, grid.ay[j + 1], x_lines, z_lines, w, wy1, wz, p, q1, r)
    q2 = fma(splat(wy2 * (dy + 2.0 * h)), a_y, splat(gy2) * f_y)
    _add_plane(nodes, grid.ay[j + 2], x_lines, z_lines, w, wy2, wz, p, q2, r)


@device
def _add_plane(nodes, y, x_lines, z_lines, w, wy, wz, p, q, r):
    """Add one point to nine nodes of equal y."""
    _add_line(nodes, y + z_lines[0], x_lines, w, wy * wz[0], p, fma(splat(wz[0]), q, splat(wy) * r[0]))
    _add_line(nodes, y + z_lines[1], x_lines, w, wy * wz[1], p, fma(splat(wz[1]), q, splat(wy) * r[1]))
    _add_line(nodes, y + z_lines[2], x_lines, w, wy * wz[2], p, fma(splat(wz[2]), q, splat(wy) * r[2]))


@device
def _add_line(nodes, o, x_lines, w, w_yz, p, t):
    """Add one point to three nodes of equal y and z."""
    w_yz = splat(w_yz)
    store(nodes, o + x_lines[0], fma(w_yz, p[0], fma(w[0], t, load(nodes, o + x_lines[0]))))
    store(nodes, o + x_lines[1], fma(w_yz, p[1], fma(w[1], t, load(nodes, o + x_lines[1]))))
    store(nodes, o + x_lines[2], fma(w_yz, p[2], fma(w[2], t, load(nodes, o + x_lines[2]))))


@device
def gather(
    rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings, bounds: tuple[Any, Any], dt: float
) -> tuple[Any, Any]:
    """Update velocity, position and velocity gradient of one point from its twenty-seven nodes.

    Returns two vectors that count in lanes 4 to 6: its displacement, and the work of its old stress on the motion of
    the nodes, J. Eq. (26)-(28), with the shares of FLIP and PIC and the position rule that the settings name.
    """
    inv_h, correct = 1.0 / grid.h, settings.kernel_correction
    i, wx0, wx1, wx2, gx0, gx1, gx2 = spline((rows[o + X] - grid.origin_x) * inv_h, grid.n_x, correct)
    j, wy0, wy1, wy2, gy0, gy1, gy2 = spline((rows[o + Y] - grid.origin_y) * inv_h, grid.n_y, correct)
    k, wz0, wz1, wz2, gz0, gz1, gz2 = spline((rows[o + Z] - grid.origin_z) * inv_h, grid.n_z, correct)
    y_lines, z_lines = (grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]), (grid.az[k], grid.az[k + 1], grid.az[k + 2])
    wy, gy = (splat(wy0), splat(wy1), splat(wy2)), (splat(gy0), splat(gy1), splat(gy2))
    wz, gz = (splat(wz0), splat(wz1), splat(wz2)), (splat(gz0), splat(gz1), splat(gz2))
    sum0, y0, z0 = _across(nodes, grid.ax[i], y_lines, z_lines, wy, gy, wz, gz)
    sum1, y1, z1 = _across(nodes, grid.ax[i + 1], y_lines, z_lines, wy, gy, wz, gz)
    sum2, y2, z2 = _across(nodes, grid.ax[i + 2], y_lines, z_lines, wy, gy, wz, gz)

    wx = splat(wx0), splat(wx1), splat(wx2)
    mean = _along(wx, sum0, sum1, sum2)
    grad_x = inv_h * _along((splat(gx0), splat(gx1), splat(gx2)), sum0, sum1, sum2)
    grad_y, grad_z = inv_h * _along(wx, y0, y1, y2), inv_h * _along(wx, z0, z1, z2)

    work = power(load(rows, o + 8), grad_x, dt) + power(load(rows, o + 16), grad_y, dt)
    work = (dt * rows[o + J] * rows[o + V0]) * (work + power(load(rows, o + 24), grad_z, dt))
    record, step = move(load(rows, o), mean, 3, bounds, settings, dt)
    store(rows, o, record)
    store_column(rows, o + 8, 3, grad_x)
    store_column(rows, o + 16, 3, grad_y)
    store_column(rows, o + 24, 3, grad_z)
    return step, work


@device
def _along(w, a, b, c):
    """Weighted sum of three nodes, or lines, or planes."""
    return fma(w[2], c, fma(w[1], b, w[0] * a))


@device
def _across(nodes, x, y_lines, z_lines, wy, gy, wz, gz):
    """Weighted sum of nine nodes of equal x, and its slopes along y and z."""
    sum0, slope0 = _along_z(nodes, x + y_lines[0], z_lines, wz, gz)
    sum1, slope1 = _along_z(nodes, x + y_lines[1], z_lines, wz, gz)
    sum2, slope2 = _along_z(nodes, x + y_lines[2], z_lines, wz, gz)
    return _along(wy, sum0, sum1, sum2), _along(gy, sum0, sum1, sum2), _along(wy, slope0, slope1, slope2)


@device
def _along_z(nodes, o, z_lines, wz, gz):
    """Weighted sum and slope of three nodes of equal x and y."""
    n0, n1, n2 = load(nodes, o + z_lines[0]), load(nodes, o + z_lines[1]), load(nodes, o + z_lines[2])
    return _along(wz, n0, n1, n2), _along(gz, n0, n1, n2)
