"""Transfer of a point with quadratic shape functions in plane strain and axisymmetry: nine nodes."""

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
from mpmcol.mpm.lanes import S_ZZ, V0, X_VECTOR, Y_VECTOR, J, M, X, Y
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import extract, fma, load, splat, store, vector

filtered_stress = make_filtered_stress(2)


@device
def scatter(rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings) -> None:
    """Add one point, whose record starts at `o`, to its nine nodes."""
    h, inv_h = grid.h, 1.0 / grid.h
    record = load(rows, o)
    _, s, base, w0, w1, w2, g0, g1, g2 = quadratic_stencil(record, grid, settings)
    i, j = int(extract(base, X)), int(extract(base, Y))
    d = (base - s) * h
    wx0, wx1, wx2 = broadcast(w0, X), broadcast(w1, X), broadcast(w2, X)
    wy0, wy1, wy2 = broadcast(w0, Y), broadcast(w1, Y), broadcast(w2, Y)
    m, volume = rows[o + M], rows[o + J] * rows[o + V0]
    hoop = volume * rows[o + S_ZZ] / rows[o + X] if settings.axisymmetric else 0.0

    # Eq. 19, 20, 14: mass, momentum at the point, weight (and the hoop stress of axisymmetry)
    momentum = splat(m) * momentum_mask(2)
    q = filtered_stress(rows, o, settings)
    weight = vector(m, 0.0, 0.0, 0.0, m * settings.gravity_x - hoop, m * settings.gravity_y, 0.0, m * q)
    at_point = fma(record, momentum, weight)
    # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
    taylor, force = settings.taylor * momentum, (-volume * inv_h) * force_mask(2)
    column_x, column_y = load(rows, o + X_VECTOR), load(rows, o + Y_VECTOR)
    a_x, f_x, a_y, f_y = column_x * taylor, column_x * force, column_y * taylor, column_y * force

    # node (i, j) receives w_j P_i + w_i Q_j
    p0 = fma(wx0, fma(broadcast(d, X), a_x, at_point), broadcast(g0, X) * f_x)
    p1 = fma(wx1, fma(broadcast(d + h, X), a_x, at_point), broadcast(g1, X) * f_x)
    p2 = fma(wx2, fma(broadcast(d + 2.0 * h, X), a_x, at_point), broadcast(g2, X) * f_x)
    q0 = fma(broadcast(w0 * d, Y), a_y, broadcast(g0, Y) * f_y)
    q1 = fma(broadcast(w1 * (d + h), Y), a_y, broadcast(g1, Y) * f_y)
    q2 = fma(broadcast(w2 * (d + 2.0 * h), Y), a_y, broadcast(g2, Y) * f_y)

    y0, y1, y2 = grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]
    _add_column(nodes, grid.ax[i], y0, y1, y2, p0, wx0, wy0, wy1, wy2, q0, q1, q2)
    _add_column(nodes, grid.ax[i + 1], y0, y1, y2, p1, wx1, wy0, wy1, wy2, q0, q1, q2)
    _add_column(nodes, grid.ax[i + 2], y0, y1, y2, p2, wx2, wy0, wy1, wy2, q0, q1, q2)


@device
def _add_column(nodes, a, y0, y1, y2, p, wx, wy0, wy1, wy2, q0, q1, q2):
    """Add one point to three nodes of equal x."""
    store(nodes, a + y0, fma(wy0, p, fma(wx, q0, load(nodes, a + y0))))
    store(nodes, a + y1, fma(wy1, p, fma(wx, q1, load(nodes, a + y1))))
    store(nodes, a + y2, fma(wy2, p, fma(wx, q2, load(nodes, a + y2))))


@device
def gather(
    rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings, limits: tuple[Any, Any], dt: float
) -> tuple[Any, Any, float]:
    """Update velocity, position and velocity gradient of one point from its nine nodes.

    Eq. (26)-(28); returns as `update_point`.
    """
    inv_h = 1.0 / grid.h
    old = load(rows, o)
    near, _, base, w0, w1, w2, g0, g1, g2 = quadratic_stencil(old, grid, settings)
    i, j = int(extract(base, X)), int(extract(base, Y))
    wx0, wx1, wx2 = broadcast(w0, X), broadcast(w1, X), broadcast(w2, X)
    wy0, wy1, wy2 = broadcast(w0, Y), broadcast(w1, Y), broadcast(w2, Y)
    gy0, gy1, gy2 = broadcast(g0, Y), broadcast(g1, Y), broadcast(g2, Y)
    y0, y1, y2 = grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]
    sum0, slope0 = _along_y(nodes, grid.ax[i], y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2)
    sum1, slope1 = _along_y(nodes, grid.ax[i + 1], y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2)
    sum2, slope2 = _along_y(nodes, grid.ax[i + 2], y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2)

    mean = fma(wx2, sum2, fma(wx1, sum1, wx0 * sum0))
    grad_x = inv_h * fma(broadcast(g2, X), sum2, fma(broadcast(g1, X), sum1, broadcast(g0, X) * sum0))
    grad_y = inv_h * fma(wx2, slope2, fma(wx1, slope1, wx0 * slope0))

    return update_point(rows, o, near, old, mean, (grad_x, grad_y, grad_y), 2, limits, grid, settings, dt)


@device
def _along_y(nodes, a, y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2):
    """Weighted sum and derivative along y of three nodes of equal x."""
    n0, n1, n2 = load(nodes, a + y0), load(nodes, a + y1), load(nodes, a + y2)
    value = fma(wy2, n2, fma(wy1, n1, wy0 * n0))
    slope = fma(gy2, n2, fma(gy1, n1, gy0 * n0))
    return value, slope
