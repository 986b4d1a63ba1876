"""The step of `kernels.cycle_2d` as plain Numba loops over separate arrays, for comparison only.

Same physics, same order of points, same coloured tiles, so that it is parallel and gives the same numbers to
round-off; but one array per quantity, scalars, and no vectors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcol import state as lanes
from mpmcol.basis import spline
from mpmcol.jit import phase, prange
from mpmcol.kernels.grid_2d import MASS_FLOOR
from mpmcol.kernels.transfer_2d import WALL_GAP
from mpmcol.state import TILE, TILE_DOUBLES, Grid, Settings, Tiles, tile_count


class PlainPoints(NamedTuple):
    """One C-contiguous array per quantity of the points, in the order of `Tiles`."""

    x: np.ndarray  # (n, 2)
    v: np.ndarray  # (n, 2)
    L: np.ndarray  # (n, 5): xx xy yx yy zz
    sigma: np.ndarray  # (n, 4): xx yy zz xy
    m: np.ndarray  # (n,)
    V0: np.ndarray  # (n,)
    J: np.ndarray  # (n,)
    opening: np.ndarray  # (n,)
    history: np.ndarray  # (n, 2)


class PlainGrid(NamedTuple):
    """Dense arrays of nodes, padded to whole tiles."""

    m: np.ndarray  # (n_x, n_y)
    v: np.ndarray  # (n_x, n_y, 2): momentum, then velocity
    a: np.ndarray  # (n_x, n_y, 2): force, then acceleration
    fixed: np.ndarray  # (n_x, n_y) uint8: bit 0 fixes v_x, bit 1 fixes v_y
    first: np.ndarray  # (n_active, 2) first node of each active tile
    origin_x: float
    origin_y: float
    h: float
    n_x: int
    n_y: int


def plain_points(rows: np.ndarray) -> PlainPoints:
    """The records of `Points.rows` (n, 24) as separate arrays; a copy."""

    def copy(*columns: int) -> np.ndarray:
        return np.ascontiguousarray(rows[:, columns].squeeze())

    return PlainPoints(
        copy(lanes.X, lanes.Y),
        copy(lanes.VX, lanes.VY),
        copy(lanes.LXX, lanes.LXY, lanes.LYX, lanes.LYY, lanes.LZZ),
        copy(lanes.SXX, lanes.SYY, lanes.SZZ, lanes.SXY),
        copy(lanes.M),
        copy(lanes.V0),
        copy(lanes.J),
        copy(lanes.OPENING),
        copy(lanes.Q0, lanes.Q1),
    )


def plain_grid(grid: Grid, tiles: Tiles) -> PlainGrid:
    """A dense grid with the walls and active tiles of `grid`."""
    tiles_x, tiles_y = tile_count(grid.n_x), tile_count(grid.n_y)
    shape = (tiles_x * TILE, tiles_y * TILE)
    fixed = grid.fixed.reshape(tiles_x, tiles_y, TILE, TILE).swapaxes(1, 2).reshape(shape)
    first = TILE * np.stack(np.divmod(tiles.active // TILE_DOUBLES, tiles_y), axis=1)
    return PlainGrid(
        np.zeros(shape), np.zeros((*shape, 2)), np.zeros((*shape, 2)), fixed, first,
        grid.origin_x, grid.origin_y, grid.h, grid.n_x, grid.n_y,
    )  # fmt: skip


@phase
def clear(grid: PlainGrid) -> None:
    """Set the nodes of all active tiles to zero.

    Reads: first. Writes: m, v, a. Eq. (19)-(20), initial values.
    """
    m_i, v_i, a_i, first = grid.m, grid.v, grid.a, grid.first
    for k in prange(len(first)):
        for i in range(first[k, 0], first[k, 0] + TILE):
            for j in range(first[k, 1], first[k, 1] + TILE):
                m_i[i, j] = 0.0
                for c in range(2):
                    v_i[i, j, c] = a_i[i, j, c] = 0.0


@phase
def p2g(points: PlainPoints, grid: PlainGrid, tiles: Tiles, settings: Settings) -> None:
    """Scatter mass, momentum and force, tiles of one colour in parallel.

    Reads: points. Writes: grid (m, mv, f). Eq. (13), (14), (19), (20).
    """
    x_p, v_p, L_p, sigma_p, m_p, V0_p, J_p = (
        points.x, points.v, points.L, points.sigma, points.m, points.V0, points.J,
    )  # fmt: skip
    m_i, mv_i, f_i, h, inv_h = grid.m, grid.v, grid.a, grid.h, 1.0 / grid.h
    start, by_colour = tiles.start, tiles.by_colour
    for colour in range(4):
        for k in prange(tiles.colour_start[colour], tiles.colour_start[colour + 1]):
            for p in range(start[by_colour[k]], start[by_colour[k] + 1]):
                s_x, s_y = (x_p[p, 0] - grid.origin_x) * inv_h, (x_p[p, 1] - grid.origin_y) * inv_h
                i, wx0, wx1, wx2, gx0, gx1, gx2 = spline(s_x, grid.n_x, settings.kernel_correction)
                j, wy0, wy1, wy2, gy0, gy1, gy2 = spline(s_y, grid.n_y, settings.kernel_correction)
                wx = (wx0, wx1, wx2)
                gx = (gx0, gx1, gx2)
                wy = (wy0, wy1, wy2)
                gy = (gy0, gy1, gy2)
                m, volume, taylor = m_p[p], J_p[p] * V0_p[p], settings.taylor
                hoop = volume * sigma_p[p, 2] / x_p[p, 0] if settings.axisymmetric else 0.0
                body_x, body_y = m * settings.gravity_x - hoop, m * settings.gravity_y
                for b in range(3):
                    dx = (i + b - s_x) * h
                    for c in range(3):
                        dy = (j + c - s_y) * h
                        w = wx[b] * wy[c]
                        g_x = gx[b] * wy[c] * inv_h
                        g_y = wx[b] * gy[c] * inv_h
                        m_i[i + b, j + c] += w * m  # Eq. 19
                        # Eq. 20
                        mv_i[i + b, j + c, 0] += w * m * (v_p[p, 0] + taylor * (L_p[p, 0] * dx + L_p[p, 1] * dy))
                        mv_i[i + b, j + c, 1] += w * m * (v_p[p, 1] + taylor * (L_p[p, 2] * dx + L_p[p, 3] * dy))
                        # Eq. 13, 14
                        f_i[i + b, j + c, 0] += w * body_x - volume * (sigma_p[p, 0] * g_x + sigma_p[p, 3] * g_y)
                        f_i[i + b, j + c, 1] += w * body_y - volume * (sigma_p[p, 3] * g_x + sigma_p[p, 1] * g_y)


@phase
def update_grid(grid: PlainGrid, settings: Settings, smallest_mass: float, dt: float, report: np.ndarray) -> None:
    """Momentum to velocity, acceleration with damping, explicit update, walls.

    Reads: grid (m, mv, f), fixed. Writes: grid (v, a), report (n_active, 6). Eq. (21)-(24).
    """
    m_i, v_i, a_i, fixed, first = grid.m, grid.v, grid.a, grid.fixed, grid.first
    floor = MASS_FLOOR * smallest_mass
    for k in prange(len(first)):
        before, after, damping, walls, unbalanced, weight = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(first[k, 0], first[k, 0] + TILE):
            for j in range(first[k, 1], first[k, 1] + TILE):
                m = m_i[i, j]
                for c in range(2):
                    if m <= floor:
                        v_i[i, j, c] = a_i[i, j, c] = 0.0
                        continue
                    raw, f = v_i[i, j, c] / m, a_i[i, j, c]  # Eq. 21
                    before += 0.5 * m * raw * raw
                    if fixed[i, j] & (1 << c):
                        walls += 0.5 * m * raw * raw
                        v_i[i, j, c] = 0.0
                        a_i[i, j, c] = -raw / dt if settings.wall_impulse else 0.0
                        continue
                    drag = settings.alpha_d * abs(f) * ((raw > 0.0) - (raw < 0.0))
                    a = (f - drag) / m  # Eq. 22, 23
                    v = raw + dt * a  # Eq. 24
                    v_i[i, j, c], a_i[i, j, c] = v, a
                    after += 0.5 * m * v * v
                    damping += 0.5 * dt * drag * (raw + v)
                    unbalanced += abs(f)
                if m > floor:
                    weight += m * (abs(settings.gravity_x) + abs(settings.gravity_y))
        report[k, 0], report[k, 1], report[k, 2] = before, after, damping
        report[k, 3], report[k, 4], report[k, 5] = walls, unbalanced, weight


@phase
def g2p(points: PlainPoints, grid: PlainGrid, tiles: Tiles, settings: Settings, dt: float) -> None:
    """Velocity, velocity gradient and position of all points.

    Reads: grid (v, a). Writes: points (v, L, x). Eq. (26)-(28).
    """
    x_p, v_p, L_p, v_i, a_i, start = points.x, points.v, points.L, grid.v, grid.a, tiles.start
    h, inv_h, share, gap = grid.h, 1.0 / grid.h, settings.flip_fraction, WALL_GAP * grid.h
    right, top = grid.origin_x + (grid.n_x - 1) * h - gap, grid.origin_y + (grid.n_y - 1) * h - gap
    correction = settings.position_factor * dt
    for t in prange(len(start) - 1):
        for p in range(start[t], start[t + 1]):
            s_x, s_y = (x_p[p, 0] - grid.origin_x) * inv_h, (x_p[p, 1] - grid.origin_y) * inv_h
            i, wx0, wx1, wx2, gx0, gx1, gx2 = spline(s_x, grid.n_x, settings.kernel_correction)
            j, wy0, wy1, wy2, gy0, gy1, gy2 = spline(s_y, grid.n_y, settings.kernel_correction)
            wx = (wx0, wx1, wx2)
            gx = (gx0, gx1, gx2)
            wy = (wy0, wy1, wy2)
            gy = (gy0, gy1, gy2)
            sv_x, sv_y, sa_x, sa_y, l_xx, l_xy, l_yx, l_yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for b in range(3):
                for c in range(3):
                    w = wx[b] * wy[c]
                    g_x = gx[b] * wy[c] * inv_h
                    g_y = wx[b] * gy[c] * inv_h
                    v_x, v_y = v_i[i + b, j + c, 0], v_i[i + b, j + c, 1]
                    sv_x += w * v_x
                    sv_y += w * v_y
                    sa_x += w * a_i[i + b, j + c, 0]
                    sa_y += w * a_i[i + b, j + c, 1]
                    l_xx += g_x * v_x
                    l_xy += g_y * v_x
                    l_yx += g_x * v_y
                    l_yy += g_y * v_y
            v_p[p, 0] = (1.0 - share) * sv_x + share * (v_p[p, 0] + dt * sa_x)  # Eq. 26
            v_p[p, 1] = (1.0 - share) * sv_y + share * (v_p[p, 1] + dt * sa_y)
            L_p[p, 0], L_p[p, 1], L_p[p, 2], L_p[p, 3] = l_xx, l_xy, l_yx, l_yy  # Eq. 28
            L_p[p, 4] = sv_x / x_p[p, 0] if settings.axisymmetric else 0.0
            x, y = x_p[p, 0] + dt * (sv_x - correction * sa_x), x_p[p, 1] + dt * (sv_y - correction * sa_y)
            x_p[p, 0] = min(max(x, grid.origin_x + gap), right)  # Eq. 27
            x_p[p, 1] = min(max(y, grid.origin_y + gap), top)
