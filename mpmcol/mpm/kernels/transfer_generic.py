"""Transfer of a point for shape functions of any width, in two and three dimensions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.interpolation import GRADIENT, make_axis_stencils, make_interpolate
from mpmcol.mpm.kernels.stress_filter import make_filtered_stress
from mpmcol.mpm.kernels.transfer_common import broadcast, force_mask, momentum_mask, update_point
from mpmcol.mpm.lanes import S_ZZ, V0, X_VECTOR, Y_VECTOR, Z_VECTOR, J, M, X, Y, Z
from mpmcol.mpm.shape_functions import ShapeFunctions
from mpmcol.mpm.simd import extract, fma, load, splat, store, vector


def make_scatter(dimension: int, basis: ShapeFunctions) -> Callable[..., Any]:
    """P2G of one point."""
    axis_stencils, width, flat = make_axis_stencils(dimension, basis, affine=False), basis.WIDTH, dimension == 2
    depth, filtered_stress = 1 if flat else width, make_filtered_stress(dimension)

    @device
    @variant(dimension, basis)
    def scatter(rows, o, nodes, grid, settings):
        """Add one point, whose record starts at `o`, to its nodes."""
        h, inv_h, record = grid.h, 1.0 / grid.h, load(rows, o)
        base, d, x, y, z = axis_stencils(record, grid, settings)
        i, j, k = int(extract(base, X)), int(extract(base, Y)), 0 if flat else int(extract(base, Z))
        d_x, d_y, d_z = extract(d, X), extract(d, Y), extract(d, Z)
        m, volume = rows[o + M], rows[o + J] * rows[o + V0]
        hoop = volume * rows[o + S_ZZ] / rows[o + X] if flat and settings.axisymmetric else 0.0

        # Eq. 19, 20, 14: mass, momentum at the point, weight (and the hoop stress of axisymmetry)
        momentum = splat(m) * momentum_mask(dimension)
        q = filtered_stress(rows, o, settings)
        f_x, f_y, f_z = m * settings.gravity_x - hoop, m * settings.gravity_y, m * settings.gravity_z
        at_point = fma(record, momentum, vector(m, 0.0, 0.0, 0.0, f_x, f_y, 0.0 if flat else f_z, m * q))
        # Eq. 20: m L (x_i - x_p); Eq. 13: -V sigma . grad w
        taylor, force = (settings.taylor * h) * momentum, (-volume * inv_h) * force_mask(dimension)
        column_x, column_y = load(rows, o + X_VECTOR), load(rows, o + Y_VECTOR)
        column_z = column_y if flat else load(rows, o + Z_VECTOR)

        # node (i, j, k) receives w_j w_k P_i + w_i (w_k Q_j + w_j R_k)
        for a in range(width):
            w_x = broadcast(x, a)
            p = fma(
                w_x, fma(splat(d_x + a), column_x * taylor, at_point), broadcast(x, GRADIENT + a) * (column_x * force)
            )
            for b in range(width):
                w_y = broadcast(y, b)
                q = fma(w_y * splat(d_y + b), column_y * taylor, broadcast(y, GRADIENT + b) * (column_y * force))
                for c in range(depth):
                    w_z = broadcast(z, c)
                    t = w_z * q
                    if not flat:
                        r = fma(
                            w_z * splat(d_z + c), column_z * taylor, broadcast(z, GRADIENT + c) * (column_z * force)
                        )
                        t = fma(w_y, r, t)
                    node = grid.ax[i + a] + grid.ay[j + b] + grid.az[k + c]
                    store(nodes, node, fma(w_y * w_z, p, fma(w_x, t, load(nodes, node))))

    return scatter


def make_gather(dimension: int, basis: ShapeFunctions) -> Callable[..., Any]:
    """G2P of one point."""
    interpolate = make_interpolate(dimension, basis, affine=False)

    @device
    @variant(dimension, basis)
    def gather(rows, o, nodes, grid, settings, limits, dt):
        """Update velocity, position and velocity gradient of one point from its nodes; returns as `update_point`."""
        old = load(rows, o)
        mean, x, y, z = interpolate(old, nodes, grid, settings)
        return update_point(rows, o, True, old, mean, (x, y, z), dimension, limits, grid, settings, dt)

    return gather
