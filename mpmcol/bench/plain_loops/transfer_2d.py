"""P2G and G2P in two dimensions as plain Numba loops over separate arrays, for comparison only."""

from __future__ import annotations

from mpmcol.bench.plain_loops.common import PlainGrid, PlainPoints
from mpmcol.mpm.boundary import WALL_GAP
from mpmcol.mpm.grid import Tiles
from mpmcol.mpm.jit import phase, prange
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions.quadratic import spline


@phase
def p2g(points: PlainPoints, grid: PlainGrid, tiles: Tiles, settings: Settings) -> None:
    """Scatter mass, momentum and force, tiles of one colour in parallel.

    Reads: points. Writes: grid (m, mv, f). Eq. (13), (14), (19), (20).
    """
    x_p, v_p, L_p, sigma_p, m_p, V0_p, J_p = (
        points.x, points.v, points.L, points.sigma, points.m, points.V0, points.J,
    )  # fmt: skip
    m_i, mv_i, f_i, h, inv_h = grid.m, grid.v, grid.a, grid.h, 1.0 / grid.h
    start, grouped = tiles.start, tiles.grouped
    for group in range(len(tiles.group_start) - 1):
        for k in prange(tiles.group_start[group], tiles.group_start[group + 1]):
            for p in range(start[grouped[k]], start[grouped[k] + 1]):
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
                        m_i[i + b, j + c, 0] += w * m  # Eq. 19
                        # Eq. 20
                        mv_i[i + b, j + c, 0, 0] += w * m * (v_p[p, 0] + taylor * (L_p[p, 0] * dx + L_p[p, 1] * dy))
                        mv_i[i + b, j + c, 0, 1] += w * m * (v_p[p, 1] + taylor * (L_p[p, 2] * dx + L_p[p, 3] * dy))
                        # Eq. 13, 14
                        f_i[i + b, j + c, 0, 0] += w * body_x - volume * (sigma_p[p, 0] * g_x + sigma_p[p, 3] * g_y)
                        f_i[i + b, j + c, 0, 1] += w * body_y - volume * (sigma_p[p, 3] * g_x + sigma_p[p, 1] * g_y)


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
                    v_x, v_y = v_i[i + b, j + c, 0, 0], v_i[i + b, j + c, 0, 1]
                    sv_x += w * v_x
                    sv_y += w * v_y
                    sa_x += w * a_i[i + b, j + c, 0, 0]
                    sa_y += w * a_i[i + b, j + c, 0, 1]
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
