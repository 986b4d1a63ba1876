"""Points to grid and grid to points in the plane and in axisymmetry."""

from __future__ import annotations

import numpy as np

from mpmcol.basis import spline
from mpmcol.jit import device, phase, prange
from mpmcol.simd import fma, lane, load, splat, store, swap_halves, vector
from mpmcol.state import (
    LXX,
    LXY,
    LYX,
    LYY,
    LZZ,
    ROW,
    SZZ,
    TILE_DOUBLES,
    V0,
    VX,
    VY,
    Grid,
    J,
    M,
    Settings,
    Tiles,
    X,
    Y,
)  # fmt: skip

WALL_GAP = 0.1  # in h: a point closer to a wall would be stiffer than the default time step bears


@phase
def clear(grid: Grid, tiles: Tiles) -> None:
    """Set the nodes of all active tiles to zero.

    Reads: active. Writes: nodes. Eq. (19)-(20), initial values.
    """
    nodes, active = grid.nodes, tiles.active
    for k in prange(len(active)):
        first = active[k]
        nodes[first : first + TILE_DOUBLES] = 0.0


@phase
def p2g(rows: np.ndarray, grid: Grid, tiles: Tiles, settings: Settings) -> None:
    """Scatter mass, momentum and force, tiles of one colour in parallel, each node summed in a fixed order.

    Reads: rows. Writes: nodes (m, mv, f). Eq. (13), (14), (19), (20).
    """
    nodes, start, by_colour = grid.nodes, tiles.start, tiles.by_colour
    for colour in range(4):
        first, stop = tiles.colour_start[colour], tiles.colour_start[colour + 1]
        for k in prange(first, stop):
            tile = by_colour[k]
            for p in range(start[tile], start[tile + 1]):
                _scatter(rows, p * ROW, nodes, grid, settings)


@device
def _scatter(rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings) -> None:
    """Add one point, whose record starts at `o`, to its nine nodes."""
    inv_h = 1.0 / grid.h
    s_x, s_y = (rows[o + X] - grid.origin_x) * inv_h, (rows[o + Y] - grid.origin_y) * inv_h
    i, wx0, wx1, wx2, gx0, gx1, gx2 = spline(s_x, grid.n_x, settings.kernel_correction)
    j, wy0, wy1, wy2, gy0, gy1, gy2 = spline(s_y, grid.n_y, settings.kernel_correction)
    dx, dy = (i - s_x) * grid.h, (j - s_y) * grid.h
    m, volume = rows[o + M], rows[o + J] * rows[o + V0]
    hoop = volume * rows[o + SZZ] / rows[o + X] if settings.axisymmetric else 0.0

    # Eq. 19, 20, 14: mass, momentum at the point, weight (and the hoop stress of axisymmetry)
    momentum = splat(m) * vector(0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    at_point = fma(
        load(rows, o),
        momentum,
        vector(m, 0.0, 0.0, 0.0, m * settings.gravity_x - hoop, m * settings.gravity_y, 0.0, 0.0),
    )
    # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
    taylor = splat(settings.taylor) * momentum
    force = splat(-volume * inv_h) * vector(0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    row_x, row_y = load(rows, o + 8), load(rows, o + 16)
    a_x, f_x, a_y, f_y = row_x * taylor, row_x * force, row_y * taylor, row_y * force

    # node (i, j) receives w_j P_i + w_i Q_j
    p0 = fma(splat(wx0), fma(splat(dx), a_x, at_point), splat(gx0) * f_x)
    p1 = fma(splat(wx1), fma(splat(dx + grid.h), a_x, at_point), splat(gx1) * f_x)
    p2 = fma(splat(wx2), fma(splat(dx + 2.0 * grid.h), a_x, at_point), splat(gx2) * f_x)
    q0 = fma(splat(wy0 * dy), a_y, splat(gy0) * f_y)
    q1 = fma(splat(wy1 * (dy + grid.h)), a_y, splat(gy1) * f_y)
    q2 = fma(splat(wy2 * (dy + 2.0 * grid.h)), a_y, splat(gy2) * f_y)

    y0, y1, y2 = grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]
    _add_column(nodes, grid.ax[i], y0, y1, y2, p0, wx0, wy0, wy1, wy2, q0, q1, q2)
    _add_column(nodes, grid.ax[i + 1], y0, y1, y2, p1, wx1, wy0, wy1, wy2, q0, q1, q2)
    _add_column(nodes, grid.ax[i + 2], y0, y1, y2, p2, wx2, wy0, wy1, wy2, q0, q1, q2)


@device
def _add_column(nodes, a, y0, y1, y2, p, wx, wy0, wy1, wy2, q0, q1, q2):
    """Add one point to three nodes of equal x."""
    store(nodes, a + y0, fma(splat(wy0), p, fma(splat(wx), q0, load(nodes, a + y0))))
    store(nodes, a + y1, fma(splat(wy1), p, fma(splat(wx), q1, load(nodes, a + y1))))
    store(nodes, a + y2, fma(splat(wy2), p, fma(splat(wx), q2, load(nodes, a + y2))))


@device
def gather(
    rows: np.ndarray, o: int, nodes: np.ndarray, grid: Grid, settings: Settings, dt: float
) -> tuple[float, float]:
    """Update velocity, position and velocity gradient of one point from its nine nodes.

    Returns its travel in h and the work of its old stress on the motion of the nodes, J.

    Eq. (26)-(28), with the shares of FLIP and PIC and the position rule that the settings name.
    """
    inv_h = 1.0 / grid.h
    s_x, s_y = (rows[o + X] - grid.origin_x) * inv_h, (rows[o + Y] - grid.origin_y) * inv_h
    i, wx0, wx1, wx2, gx0, gx1, gx2 = spline(s_x, grid.n_x, settings.kernel_correction)
    j, wy0, wy1, wy2, gy0, gy1, gy2 = spline(s_y, grid.n_y, settings.kernel_correction)
    y0, y1, y2 = grid.ay[j], grid.ay[j + 1], grid.ay[j + 2]
    n0, n1, n2 = _rows_of(nodes, grid.ax[i], y0, y1, y2)
    sum0, slope0 = _along_y(n0, n1, n2, wy0, wy1, wy2, gy0, gy1, gy2)
    n0, n1, n2 = _rows_of(nodes, grid.ax[i + 1], y0, y1, y2)
    sum1, slope1 = _along_y(n0, n1, n2, wy0, wy1, wy2, gy0, gy1, gy2)
    n0, n1, n2 = _rows_of(nodes, grid.ax[i + 2], y0, y1, y2)
    sum2, slope2 = _along_y(n0, n1, n2, wy0, wy1, wy2, gy0, gy1, gy2)

    mean = fma(splat(wx2), sum2, fma(splat(wx1), sum1, splat(wx0) * sum0))
    grad_x = fma(splat(gx2), sum2, fma(splat(gx1), sum1, splat(gx0) * sum0))
    grad_y = fma(splat(wx2), slope2, fma(splat(wx1), slope1, splat(wx0) * slope0))
    grad_x, grad_y = grad_x * splat(inv_h), grad_y * splat(inv_h)
    work = _work_on_nodes(rows, o, mean, grad_x, grad_y, settings, dt)
    return _move(rows, o, mean, grad_x, grad_y, settings, dt) * inv_h, work


@device
def _rows_of(nodes, a, y0, y1, y2):
    """Three node records of equal x."""
    return load(nodes, a + y0), load(nodes, a + y1), load(nodes, a + y2)


@device
def _along_y(n0, n1, n2, wy0, wy1, wy2, gy0, gy1, gy2):
    """Weighted sum and slope of three nodes of equal x."""
    value = fma(splat(wy2), n2, fma(splat(wy1), n1, splat(wy0) * n0))
    slope = fma(splat(gy2), n2, fma(splat(gy1), n1, splat(gy0) * n0))
    return value, slope


@device
def _work_on_nodes(rows, o, mean, grad_x, grad_y, settings, dt):
    """V sigma : grad(v + v~) / 2 dt, what the internal force of this step takes from the nodes."""
    half = splat(-0.5 * dt)  # v~ and a stand in lanes 1, 2 and 4, 5, the columns of sigma in 4, 5
    l_x, l_y = fma(half, grad_x, swap_halves(grad_x)), fma(half, grad_y, swap_halves(grad_y))
    power = fma(load(rows, o + 8), l_x, load(rows, o + 16) * l_y)
    hoop = (lane(mean, 1) - 0.5 * dt * lane(mean, 4)) / rows[o + X] * rows[o + SZZ] if settings.axisymmetric else 0.0
    return dt * rows[o + J] * rows[o + V0] * (lane(power, 4) + lane(power, 5) + hoop)


@device
def _move(rows, o, mean, grad_x, grad_y, settings, dt):
    """Write back one point; returns the larger component of its displacement, m."""
    share = settings.flip_fraction
    sv_x, sv_y, sa_x, sa_y = lane(mean, 1), lane(mean, 2), lane(mean, 4), lane(mean, 5)
    # Eq. 26 and its PIC counterpart
    rows[o + VX] = (1.0 - share) * sv_x + share * (rows[o + VX] + dt * sa_x)
    rows[o + VY] = (1.0 - share) * sv_y + share * (rows[o + VY] + dt * sa_y)
    # Eq. 28; v_r / r belongs to the old position
    rows[o + LXX], rows[o + LYX] = lane(grad_x, 1), lane(grad_x, 2)
    rows[o + LXY], rows[o + LYY] = lane(grad_y, 1), lane(grad_y, 2)
    rows[o + LZZ] = sv_x / rows[o + X] if settings.axisymmetric else 0.0
    # Eq. 27
    correction = settings.position_factor * dt
    step_x, step_y = dt * (sv_x - correction * sa_x), dt * (sv_y - correction * sa_y)
    rows[o + X] += step_x
    rows[o + Y] += step_y
    return max(abs(step_x), abs(step_y))


@device
def keep_off_walls(rows: np.ndarray, o: int, grid: Grid, settings: Settings) -> None:
    """Hold a point WALL_GAP h inside the grid, and `settings.axis_gap` h from an axis, where it is stiffer yet."""
    h = grid.h
    left = settings.axis_gap if settings.axisymmetric else WALL_GAP
    rows[o + X] = min(max(rows[o + X], grid.origin_x + left * h), grid.origin_x + (grid.n_x - 1 - WALL_GAP) * h)
    rows[o + Y] = min(max(rows[o + Y], grid.origin_y + WALL_GAP * h), grid.origin_y + (grid.n_y - 1 - WALL_GAP) * h)
