"""Points to grid and grid to points in the plane and in axisymmetry: nine nodes a point."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm import lanes
from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.transfer_common import forces, momenta, move, power, spread, stencil, store_column
from mpmcol.mpm.lanes import S_ZZ, V0, J, M, X, Y
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import extract, fma, load, splat, store, vector

RECORD_SIZE = lanes.RECORD_SIZE[2]


@device
def scatter(rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings) -> None:
    """Add one point, whose record starts at `o`, to its nine nodes."""
    h, inv_h = grid.h, 1.0 / grid.h
    record = load(rows, o)
    s, base, w0, w1, w2, g0, g1, g2 = stencil(record, grid, settings)
    i, j = int(extract(base, X)), int(extract(base, Y))
    d = (base - s) * h
    wx0, wx1, wx2 = spread(w0, X), spread(w1, X), spread(w2, X)
    wy0, wy1, wy2 = spread(w0, Y), spread(w1, Y), spread(w2, Y)
    m, volume = rows[o + M], rows[o + J] * rows[o + V0]
    hoop = volume * rows[o + S_ZZ] / rows[o + X] if settings.axisymmetric else 0.0

    # Eq. 19, 20, 14: mass, momentum at the point, weight (and the hoop stress of axisymmetry)
    momentum = splat(m) * momenta(2)
    weight = vector(m, 0.0, 0.0, 0.0, m * settings.gravity_x - hoop, m * settings.gravity_y, 0.0, 0.0)
    at_point = fma(record, momentum, weight)
    # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
    taylor, force = settings.taylor * momentum, (-volume * inv_h) * forces(2)
    row_x, row_y = load(rows, o + 8), load(rows, o + 16)
    a_x, f_x, a_y, f_y = row_x * taylor, row_x * force, row_y * taylor, row_y * force

    # node (i, j) receives w_j P_i + w_i Q_j
    p0 = fma(wx0, fma(spread(d, X), a_x, at_point), spread(g0, X) * f_x)
    p1 = fma(wx1, fma(spread(d + h, X), a_x, at_point), spread(g1, X) * f_x)
    p2 = fma(wx2, fma(spread(d + 2.0 * h, X), a_x, at_point), spread(g2, X) * f_x)
    q0 = fma(spread(w0 * d, Y), a_y, spread(g0, Y) * f_y)
    q1 = fma(spread(w1 * (d + h), Y), a_y, spread(g1, Y) * f_y)
    q2 = fma(spread(w2 * (d + 2.0 * h), Y), a_y, spread(g2, Y) * f_y)

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
    rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings, bounds: tuple[Any, Any], dt: float
) -> tuple[Any, Any]:
    """Update velocity, position and velocity gradient of one point from its nine nodes.

    Returns two vectors that count in lanes 4 to 6: its displacement, and the work of its old stress on the motion
    of the nodes, with gravity's on it where a wall holds it, J. Eq. (26)-(28), with the shares of FLIP and PIC and
    the position rule that the settings name.
    """
    inv_h = 1.0 / grid.h
    old = load(rows, o)
    _, base, w0, w1, w2, g0, g1, g2 = stencil(old, grid, settings)
    i, j = int(extract(base, X)), int(extract(base, Y))
    wx0, wx1, wx2 = spread(w0, X), spread(w1, X), spread(w2, X)
    wy0, wy1, wy2 = spread(w0, Y), spread(w1, Y), spread(w2, Y)
    gy0, gy1, gy2 = spread(g0, Y), spread(g1, Y), spread(g2, Y)
    y0, y1, y2 = grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]
    sum0, slope0 = _along_y(nodes, grid.ax[i], y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2)
    sum1, slope1 = _along_y(nodes, grid.ax[i + 1], y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2)
    sum2, slope2 = _along_y(nodes, grid.ax[i + 2], y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2)

    mean = fma(wx2, sum2, fma(wx1, sum1, wx0 * sum0))
    grad_x = inv_h * fma(spread(g2, X), sum2, fma(spread(g1, X), sum1, spread(g0, X) * sum0))
    grad_y = inv_h * fma(wx2, slope2, fma(wx1, slope1, wx0 * slope0))

    work = power(load(rows, o + 8), grad_x, dt) + power(load(rows, o + 16), grad_y, dt)
    l_zz = 0.0
    if settings.axisymmetric:  # v_r / r belongs to the old position
        l_zz = extract(mean, 1) / rows[o + X]
        hoop = (l_zz - 0.5 * dt * extract(mean, 4) / rows[o + X]) * rows[o + S_ZZ]
        work = work + vector(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, hoop, 0.0)
    work = (dt * rows[o + J] * rows[o + V0]) * work
    record, step, lifted = move(old, mean, 2, bounds, settings, dt)
    store(rows, o, record)
    store_column(rows, o + 8, 2, grad_x)
    store_column(rows, o + 16, 2, grad_y)
    rows[o + 11] = l_zz
    return step, work + lifted


@device
def _along_y(nodes, a, y0, y1, y2, wy0, wy1, wy2, gy0, gy1, gy2):
    """Weighted sum and slope of three nodes of equal x."""
    n0, n1, n2 = load(nodes, a + y0), load(nodes, a + y1), load(nodes, a + y2)
    value = fma(wy2, n2, fma(wy1, n1, wy0 * n0))
    slope = fma(gy2, n2, fma(gy1, n1, gy0 * n0))
    return value, slope
