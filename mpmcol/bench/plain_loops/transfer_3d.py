"""P2G and G2P in three dimensions as plain Numba loops over separate arrays, for comparison only."""

# Compiled functions take what Numba infers.
# mypy: allow-untyped-defs
# ruff: noqa: ANN001

from __future__ import annotations

from mpmcol.bench.plain_loops.common import PlainGrid, PlainPoints
from mpmcol.mpm.boundary import WALL_GAP
from mpmcol.mpm.grid import Tiles
from mpmcol.mpm.jit import device, phase, prange
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions.quadratic import spline


@device
def _stencil(x_p, p, grid, settings):
    """First nodes, distances to them (m), weights and gradients (1/m) of point `p` along the three axes."""
    inv_h = 1.0 / grid.h
    s_x, s_y = (x_p[p, 0] - grid.origin_x) * inv_h, (x_p[p, 1] - grid.origin_y) * inv_h
    s_z = (x_p[p, 2] - grid.origin_z) * inv_h
    i, wx0, wx1, wx2, gx0, gx1, gx2 = spline(s_x, grid.n_x, settings.kernel_correction)
    j, wy0, wy1, wy2, gy0, gy1, gy2 = spline(s_y, grid.n_y, settings.kernel_correction)
    k, wz0, wz1, wz2, gz0, gz1, gz2 = spline(s_z, grid.n_z, settings.kernel_correction)
    w = ((wx0, wx1, wx2), (wy0, wy1, wy2), (wz0, wz1, wz2))
    g = ((gx0 * inv_h, gx1 * inv_h, gx2 * inv_h), (gy0 * inv_h, gy1 * inv_h, gy2 * inv_h))
    g_z = (gz0 * inv_h, gz1 * inv_h, gz2 * inv_h)
    return (i, j, k), ((i - s_x) * grid.h, (j - s_y) * grid.h, (k - s_z) * grid.h), w, (*g, g_z)


@phase
def p2g(points: PlainPoints, grid: PlainGrid, tiles: Tiles, settings: Settings) -> None:
    """Scatter mass, momentum and force, tiles of one colour in parallel.

    Reads: points. Writes: grid (m, mv, f). Eq. (13), (14), (19), (20).
    """
    x_p, v_p, L_p, s_p = points.x, points.v, points.L, points.sigma
    m_i, mv_i, f_i, h, taylor = grid.m, grid.v, grid.a, grid.h, settings.taylor
    start, grouped = tiles.start, tiles.grouped
    for group in range(len(tiles.group_start) - 1):
        for t in prange(tiles.group_start[group], tiles.group_start[group + 1]):
            for p in range(start[grouped[t]], start[grouped[t] + 1]):
                (i, j, k), (dx0, dy0, dz0), (wx, wy, wz), (gx, gy, gz) = _stencil(x_p, p, grid, settings)
                m, volume = points.m[p], points.J[p] * points.V0[p]
                for b in range(3):
                    dx = dx0 + b * h
                    for c in range(3):
                        dy = dy0 + c * h
                        for d in range(3):
                            dz = dz0 + d * h
                            w, g_x, g_y, g_z = _weights(wx[b], wy[c], wz[d], gx[b], gy[c], gz[d])
                            n = (i + b, j + c, k + d)
                            m_i[n] += w * m  # Eq. 19
                            # Eq. 20
                            l_x = L_p[p, 0] * dx + L_p[p, 1] * dy + L_p[p, 2] * dz
                            l_y = L_p[p, 3] * dx + L_p[p, 4] * dy + L_p[p, 5] * dz
                            l_z = L_p[p, 6] * dx + L_p[p, 7] * dy + L_p[p, 8] * dz
                            mv_i[n[0], n[1], n[2], 0] += w * m * (v_p[p, 0] + taylor * l_x)
                            mv_i[n[0], n[1], n[2], 1] += w * m * (v_p[p, 1] + taylor * l_y)
                            mv_i[n[0], n[1], n[2], 2] += w * m * (v_p[p, 2] + taylor * l_z)
                            # Eq. 13, 14
                            s_x = s_p[p, 0] * g_x + s_p[p, 3] * g_y + s_p[p, 5] * g_z
                            s_y = s_p[p, 3] * g_x + s_p[p, 1] * g_y + s_p[p, 4] * g_z
                            s_z = s_p[p, 5] * g_x + s_p[p, 4] * g_y + s_p[p, 2] * g_z
                            f_i[n[0], n[1], n[2], 0] += w * m * settings.gravity_x - volume * s_x
                            f_i[n[0], n[1], n[2], 1] += w * m * settings.gravity_y - volume * s_y
                            f_i[n[0], n[1], n[2], 2] += w * m * settings.gravity_z - volume * s_z


@device
def _weights(wx, wy, wz, gx, gy, gz):
    """Weight and gradient of a node."""
    return wx * wy * wz, gx * wy * wz, wx * gy * wz, wx * wy * gz


@phase
def g2p(points: PlainPoints, grid: PlainGrid, tiles: Tiles, settings: Settings, dt: float) -> None:
    """Velocity, velocity gradient and position of all points.

    Reads: grid (v, a). Writes: points (v, L, x). Eq. (26)-(28).
    """
    x_p, v_p, L_p, v_i, a_i, start = points.x, points.v, points.L, grid.v, grid.a, tiles.start
    share, gap, correction = settings.flip_fraction, WALL_GAP * grid.h, settings.position_factor * dt
    low = (grid.origin_x + gap, grid.origin_y + gap, grid.origin_z + gap)
    size = ((grid.n_x - 1) * grid.h, (grid.n_y - 1) * grid.h, (grid.n_z - 1) * grid.h)
    for t in prange(len(start) - 1):
        for p in range(start[t], start[t + 1]):
            (i, j, k), _, (wx, wy, wz), (gx, gy, gz) = _stencil(x_p, p, grid, settings)
            sv_x, sv_y, sv_z, sa_x, sa_y, sa_z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            l_xx, l_xy, l_xz, l_yx, l_yy, l_yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            l_zx, l_zy, l_zz = 0.0, 0.0, 0.0
            for b in range(3):
                for c in range(3):
                    for d in range(3):
                        w, g_x, g_y, g_z = _weights(wx[b], wy[c], wz[d], gx[b], gy[c], gz[d])
                        n0, n1, n2 = i + b, j + c, k + d
                        v_x, v_y, v_z = v_i[n0, n1, n2, 0], v_i[n0, n1, n2, 1], v_i[n0, n1, n2, 2]
                        sv_x += w * v_x
                        sv_y += w * v_y
                        sv_z += w * v_z
                        sa_x += w * a_i[n0, n1, n2, 0]
                        sa_y += w * a_i[n0, n1, n2, 1]
                        sa_z += w * a_i[n0, n1, n2, 2]
                        l_xx += g_x * v_x
                        l_xy += g_y * v_x
                        l_xz += g_z * v_x
                        l_yx += g_x * v_y
                        l_yy += g_y * v_y
                        l_yz += g_z * v_y
                        l_zx += g_x * v_z
                        l_zy += g_y * v_z
                        l_zz += g_z * v_z
            L_p[p, 0], L_p[p, 1], L_p[p, 2] = l_xx, l_xy, l_xz  # Eq. 28
            L_p[p, 3], L_p[p, 4], L_p[p, 5] = l_yx, l_yy, l_yz
            L_p[p, 6], L_p[p, 7], L_p[p, 8] = l_zx, l_zy, l_zz
            sv, sa = (sv_x, sv_y, sv_z), (sa_x, sa_y, sa_z)
            for axis in range(3):
                v_p[p, axis] = (1.0 - share) * sv[axis] + share * (v_p[p, axis] + dt * sa[axis])  # Eq. 26
                x = x_p[p, axis] + dt * (sv[axis] - correction * sa[axis])  # Eq. 27
                x_p[p, axis] = min(max(x, low[axis]), low[axis] + size[axis] - 2.0 * gap)
