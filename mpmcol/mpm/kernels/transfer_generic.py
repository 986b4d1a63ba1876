"""Transfers point by point, for shape functions of any width, in two and three dimensions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.interpolation import GRADIENT, make_axis_stencils, make_interpolate
from mpmcol.mpm.kernels.stress_filter import make_filtered_stress
from mpmcol.mpm.kernels.transfer_common import (
    broadcast,
    point_terms,
    point_update,
    prefetch_ahead,
    unit_mass,
    update_point,
)
from mpmcol.mpm.lanes import RECORD_SIZE, X_VECTOR, Y_VECTOR, Z_VECTOR, Q, X, Y, Z
from mpmcol.mpm.shape_functions import ShapeFunctions
from mpmcol.mpm.simd import extract, fma, load, maximum, splat, store


def make_scatter_points(dimension: int, basis: ShapeFunctions) -> Callable[..., None]:
    """P2G of a range of points."""
    scatter, size = _make_scatter(dimension, basis), RECORD_SIZE[dimension]

    @device
    @variant(dimension, basis)
    def scatter_points(rows, first, stop, following, grid, settings):
        """See `transfer.make_scatter_points`."""
        nodes, unit = grid.nodes, unit_mass(dimension, settings)
        for p in range(first, stop):
            prefetch_ahead(rows, size, p, stop, following)
            scatter(rows, p * size, unit, nodes, grid, settings)

    return scatter_points


def _make_scatter(dimension: int, basis: ShapeFunctions) -> Callable[..., Any]:
    """P2G of one point."""
    axis_stencils, width, flat = make_axis_stencils(dimension, basis, affine=False), basis.WIDTH, dimension == 2
    depth, filtered_stress = 1 if flat else width, make_filtered_stress(dimension)

    @device
    @variant(dimension, basis)
    def scatter(rows, o, unit, nodes, grid, settings):
        """Add one point, whose record starts at `o`, to its nodes."""
        h, inv_h = grid.h, 1.0 / grid.h
        base, d, x, y, z = axis_stencils(load(rows, o), grid, settings)
        i, j, k = int(extract(base, X)), int(extract(base, Y)), 0 if flat else int(extract(base, Z))
        d_x, d_y, d_z = extract(d, X), extract(d, Y), extract(d, Z)
        at_point, taylor, force = point_terms(rows, o, dimension, unit, filtered_stress(rows, o, settings), settings)
        taylor, force = h * taylor, inv_h * force
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


def make_move_points(dimension: int, basis: ShapeFunctions) -> Callable[..., Any]:
    """G2P of a range of points."""
    interpolate, size = make_interpolate(dimension, basis, affine=False), RECORD_SIZE[dimension]

    @device
    @variant(dimension, basis)
    def move_points(rows, first, stop, following, grid, settings, dt, averages):
        """See `transfer.make_move_points`."""
        nodes, factors, zero = grid.nodes, point_update(dimension, grid, settings, dt), splat(0.0)
        travel, limit_work = zero, zero
        for p in range(first, stop):
            prefetch_ahead(rows, size, p, stop, following)
            mean, x, y, z = interpolate(load(rows, p * size), nodes, grid, settings)
            displacement, work = update_point(rows, p * size, True, mean, (x, y, z), dimension, factors, grid, settings)
            averages[p - first] = extract(mean, Q)
            travel, limit_work = maximum(travel, abs(displacement)), limit_work + work
        return travel, limit_work

    return move_points
