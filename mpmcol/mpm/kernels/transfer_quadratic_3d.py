"""Transfer of a point with quadratic shape functions in three dimensions: twenty-seven nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.stress_filter import make_filtered_stress
from mpmcol.mpm.kernels.transfer_common import (
    broadcast,
    force_mask,
    momentum_mask,
    quadratic_stencil,
    update_point,
)
from mpmcol.mpm.lanes import V0, X_VECTOR, Y_VECTOR, Z_VECTOR, J, M, X, Y, Z
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import extract, fma, load, splat, store, vector

filtered_stress = make_filtered_stress(3)


@device
def scatter(rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings) -> None:
    """Add one point, whose record starts at `o`, to its twenty-seven nodes."""
    h, inv_h, record = grid.h, 1.0 / grid.h, load(rows, o)
    _, s, base, w0, w1, w2, g0, g1, g2 = quadratic_stencil(record, grid, settings)
    i, j, k = int(extract(base, X)), int(extract(base, Y)), int(extract(base, Z))
    d0 = (base - s) * h
    d1, d2 = d0 + h, d0 + 2.0 * h
    wd0, wd1, wd2 = w0 * d0, w1 * d1, w2 * d2
    m, volume = rows[o + M], rows[o + J] * rows[o + V0]

    # Eq. 19, 20, 14: mass, momentum at the point, weight
    momentum = splat(m) * momentum_mask(3)
    q = filtered_stress(rows, o, settings)
    weight = vector(m, 0.0, 0.0, 0.0, m * settings.gravity_x, m * settings.gravity_y, m * settings.gravity_z, m * q)
    at_point = fma(record, momentum, weight)
    # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
    taylor, force = settings.taylor * momentum, (-volume * inv_h) * force_mask(3)
    column_x, column_y, column_z = load(rows, o + X_VECTOR), load(rows, o + Y_VECTOR), load(rows, o + Z_VECTOR)
    a_x, a_y, a_z = column_x * taylor, column_y * taylor, column_z * taylor
    f_x, f_y, f_z = column_x * force, column_y * force, column_z * force

    # node (i, j, k) receives w_j w_k P_i + w_i (w_k Q_j + w_j R_k)
    w, wz = _broadcast_each(w0, w1, w2, X), _broadcast_each(w0, w1, w2, Z)
    p0 = fma(w[0], fma(broadcast(d0, X), a_x, at_point), broadcast(g0, X) * f_x)
    p1 = fma(w[1], fma(broadcast(d1, X), a_x, at_point), broadcast(g1, X) * f_x)
    p2 = fma(w[2], fma(broadcast(d2, X), a_x, at_point), broadcast(g2, X) * f_x)
    r0 = fma(broadcast(wd0, Z), a_z, broadcast(g0, Z) * f_z)
    r1 = fma(broadcast(wd1, Z), a_z, broadcast(g1, Z) * f_z)
    r2 = fma(broadcast(wd2, Z), a_z, broadcast(g2, Z) * f_z)
    x_lines = grid.ax[i], grid.ax[i + 1], grid.ax[i + 2]
    z_lines = grid.az[k], grid.az[k + 1], grid.az[k + 2]
    p, r = (p0, p1, p2), (r0, r1, r2)
    q0 = fma(broadcast(wd0, Y), a_y, broadcast(g0, Y) * f_y)
    _add_plane(nodes, grid.ay[j], x_lines, z_lines, w, broadcast(w0, Y), wz, p, q0, r)
    q1 = fma(broadcast(wd1, Y), a_y, broadcast(g1, Y) * f_y)
    _add_plane(nodes, grid.ay[j + 1], x_lines, z_lines, w, broadcast(w1, Y), wz, p, q1, r)
    q2 = fma(broadcast(wd2, Y), a_y, broadcast(g2, Y) * f_y)
    _add_plane(nodes, grid.ay[j + 2], x_lines, z_lines, w, broadcast(w2, Y), wz, p, q2, r)


@device
def _add_plane(nodes, y, x_lines, z_lines, w, wy, wz, p, q, r):
    """Add one point to nine nodes of equal y."""
    _add_line(nodes, y + z_lines[0], x_lines, w, wy * wz[0], p, fma(wz[0], q, wy * r[0]))
    _add_line(nodes, y + z_lines[1], x_lines, w, wy * wz[1], p, fma(wz[1], q, wy * r[1]))
    _add_line(nodes, y + z_lines[2], x_lines, w, wy * wz[2], p, fma(wz[2], q, wy * r[2]))


@device
def _add_line(nodes, o, x_lines, w, w_yz, p, t):
    """Add one point to three nodes of equal y and z."""
    store(nodes, o + x_lines[0], fma(w_yz, p[0], fma(w[0], t, load(nodes, o + x_lines[0]))))
    store(nodes, o + x_lines[1], fma(w_yz, p[1], fma(w[1], t, load(nodes, o + x_lines[1]))))
    store(nodes, o + x_lines[2], fma(w_yz, p[2], fma(w[2], t, load(nodes, o + x_lines[2]))))


@device
def gather(
    rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings, limits: tuple[Any, Any], dt: float
) -> tuple[Any, Any, float]:
    """Update velocity, position and velocity gradient of one point from its twenty-seven nodes.

    Eq. (26)-(28); returns as `update_point`.
    """
    inv_h, old = 1.0 / grid.h, load(rows, o)
    near, _, base, w0, w1, w2, g0, g1, g2 = quadratic_stencil(old, grid, settings)
    i, j, k = int(extract(base, X)), int(extract(base, Y)), int(extract(base, Z))
    y_lines, z_lines = (grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]), (grid.az[k], grid.az[k + 1], grid.az[k + 2])
    wy, wz = _broadcast_each(w0, w1, w2, Y), _broadcast_each(w0, w1, w2, Z)
    gy, gz = _broadcast_each(g0, g1, g2, Y), _broadcast_each(g0, g1, g2, Z)
    sum0, y0, z0 = _across(nodes, grid.ax[i], y_lines, z_lines, wy, gy, wz, gz)
    sum1, y1, z1 = _across(nodes, grid.ax[i + 1], y_lines, z_lines, wy, gy, wz, gz)
    sum2, y2, z2 = _across(nodes, grid.ax[i + 2], y_lines, z_lines, wy, gy, wz, gz)

    wx, gx = _broadcast_each(w0, w1, w2, X), _broadcast_each(g0, g1, g2, X)
    mean = _along(wx, sum0, sum1, sum2)
    grad_x = inv_h * _along(gx, sum0, sum1, sum2)
    grad_y, grad_z = inv_h * _along(wx, y0, y1, y2), inv_h * _along(wx, z0, z1, z2)

    return update_point(rows, o, near, old, mean, (grad_x, grad_y, grad_z), 3, limits, grid, settings, dt)


@device
def _broadcast_each(a, b, c, index):
    """`broadcast` of three vectors."""
    return broadcast(a, index), broadcast(b, index), broadcast(c, index)


@device
def _along(w, a, b, c):
    """Weighted sum of three nodes, or lines, or planes."""
    return fma(w[2], c, fma(w[1], b, w[0] * a))


@device
def _across(nodes, x, y_lines, z_lines, wy, gy, wz, gz):
    """Weighted sum of nine nodes of equal x, and its derivatives along y and z."""
    sum0, slope0 = _along_z(nodes, x + y_lines[0], z_lines, wz, gz)
    sum1, slope1 = _along_z(nodes, x + y_lines[1], z_lines, wz, gz)
    sum2, slope2 = _along_z(nodes, x + y_lines[2], z_lines, wz, gz)
    return _along(wy, sum0, sum1, sum2), _along(gy, sum0, sum1, sum2), _along(wy, slope0, slope1, slope2)


@device
def _along_z(nodes, o, z_lines, wz, gz):
    """Weighted sum and derivative along z of three nodes of equal x and y."""
    n0, n1, n2 = load(nodes, o + z_lines[0]), load(nodes, o + z_lines[1]), load(nodes, o + z_lines[2])
    return _along(wz, n0, n1, n2), _along(gz, n0, n1, n2)
