"""Transfers between points and grid: which implementation serves which shape functions, and P2G over all points.

Quadratic shape functions have transfers written out node by node (`transfer_quadratic_2d`, `transfer_quadratic_3d`),
all others share one for any width (`transfer_generic`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from mpmcol.mpm.grid import Grid, Tiles
from mpmcol.mpm.jit import device, phase, prange, subroutine, variant
from mpmcol.mpm.kernels import scatter_halves_2d, transfer_generic, transfer_quadratic_2d, transfer_quadratic_3d
from mpmcol.mpm.kernels.interpolation import make_interpolate, save_columns
from mpmcol.mpm.lanes import LANES, RECORD_SIZE, X, Y, Z
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import extract, load
from mpmcol.mpm.simd.registers import WHOLE

QUADRATIC = {2: transfer_quadratic_2d, 3: transfer_quadratic_3d}
SCATTER = {  # with quadratic shape functions
    2: transfer_quadratic_2d.scatter_points if WHOLE else scatter_halves_2d.scatter_points,
    3: transfer_quadratic_3d.scatter_points,
}


@cache
def make_p2g(dimension: int, basis: str) -> Callable[..., None]:
    """P2G over all points, with the dimension and the shape functions frozen in."""
    scatter_points = make_scatter_points(dimension, basis)

    @phase
    @variant(dimension, basis)
    def p2g(rows: np.ndarray, grid: Grid, tiles: Tiles, shares: np.ndarray, settings: Settings) -> None:
        """Scatter mass, momentum and force; tiles of one group in parallel, each node summed in a fixed order.

        Reads: rows, shares. Writes: nodes (m, mv, f, m q). Eq. (13), (14), (19), (20).
        """
        start, grouped = tiles.start, tiles.grouped
        for group in range(len(shares)):
            for thread in prange(shares.shape[1] - 1):
                for k in range(shares[group, thread], shares[group, thread + 1]):
                    tile, following = grouped[k], grouped[min(k + 1, len(grouped) - 1)]
                    scatter_points(rows, start[tile], start[tile + 1], start[following], grid, settings)

    return p2g


@cache
def make_scatter_points(dimension: int, basis: str) -> Callable[..., None]:
    """P2G over a range of points, with the dimension and the shape functions frozen in."""
    if basis == "quadratic":
        scatter = SCATTER[dimension]
    else:
        scatter = transfer_generic.make_scatter_points(dimension, SHAPE_FUNCTIONS[basis])

    @subroutine
    @variant(dimension, basis)
    def scatter_points(rows: np.ndarray, first: int, stop: int, following: int, grid: Grid, settings: Settings) -> None:
        """Scatter mass, momentum and force of these points; `following` is the point after them, to be prefetched.

        Reads: rows. Writes: nodes (m, mv, f, m q). Eq. (13), (14), (19), (20).
        """
        scatter(rows, first, stop, following, grid, settings)

    return scatter_points


@cache
def make_move_points(dimension: int, basis: str, affine: bool) -> Callable[..., tuple[float, float]]:
    """G2P over a range of points, with the dimension, the shape functions and APIC (`affine`) frozen in."""
    if basis == "quadratic":
        move = QUADRATIC[dimension].move_points
    else:
        move = transfer_generic.make_move_points(dimension, SHAPE_FUNCTIONS[basis])
    size, matrix_size = RECORD_SIZE[dimension], dimension * LANES
    interpolate = make_interpolate(dimension, SHAPE_FUNCTIONS[basis], affine)

    @subroutine
    @variant(dimension, basis, affine)
    def move_points(rows, first, stop, following, grid, settings, dt, averages, matrices):
        """Move these points; returns the largest travel (in cells) and the work of gravity where limits stop them (J).

        following: the point after them, to be prefetched. Reads: nodes (v~, a). Writes: rows, averages of the filtered
        stress (Pa), and with APIC its matrices, which the velocity gradients would overwrite. Eq. (26)-(28).
        """
        if affine:
            for p in range(first, stop):
                _, x, y, z = interpolate(load(rows, p * size), grid.nodes, grid, settings)
                save_columns(matrices, matrix_size * (p - first), dimension, x, y, z)
        travel, limit_work = move(rows, first, stop, following, grid, settings, dt, averages)
        return largest_axis(travel) / grid.h, sum_axes(limit_work)

    return move_points


@device
def largest_axis(value):
    """Largest of the lanes X, Y, Z."""
    return max(extract(value, X), extract(value, Y), extract(value, Z))


@device
def sum_axes(value):
    """Sum of the lanes X, Y, Z."""
    return extract(value, X) + extract(value, Y) + extract(value, Z)
