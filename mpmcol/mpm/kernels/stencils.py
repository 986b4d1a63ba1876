"""Stencils of eight points at a time, with quadratic shape functions.

The transfers take weights and gradients from a buffer, one number per point and node line, because a vector of equal
numbers is loaded from memory without the shuffle that a lane of another vector needs.

Blocks of the buffer, one per axis, with a vector of eight points each:

    BASE            first node, as a real number
    W, W + 8, ..    weights of three nodes, Eq. (17)
    G, G + 8, ..    their gradients, 1/m, Eq. (18)
    D, D + 8, ..    weight times distance of the node from the point, m; only if asked for

and, after them, one for each point that may be beside a wall (see `wall_cells`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcol.mpm.grid import NODE, Grid
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.kernels.transfer_common import quadratic_stencil
from mpmcol.mpm.lanes import LANES, RECORD_SIZE, X, Y, Z
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions.quadratic import spline_lanes
from mpmcol.mpm.simd import element, extract, fma, load, splat, spread, store, strided
from mpmcol.mpm.wall_cells import AROUND_WALL, NEAR_WALL

BASE, W, G, D, BLOCK = 0, LANES, 4 * LANES, 7 * LANES, 10 * LANES
AXIS_X, AXIS_Y, AXIS_Z = 0, BLOCK, 2 * BLOCK
NEAR = {2: 2 * BLOCK, 3: 3 * BLOCK}
STENCILS = {2: 2 * BLOCK + LANES, 3: 3 * BLOCK + LANES}  # doubles in a buffer


def make_find_stencils(dimension: int, distances: bool) -> Callable[..., None]:
    """The stencils of eight points, with the dimension, and whether to write distances, frozen in."""
    size, marks = RECORD_SIZE[dimension], NEAR[dimension]

    @device
    @variant(dimension, distances)
    def find_stencils(rows, o, count, grid, settings, stencils):
        """Write the stencils of `count` <= 8 points, the first of whose records starts at `o`, Eq. (17)-(18)."""
        correction = settings.kernel_correction
        x, y = strided(rows, o + X, size), strided(rows, o + Y, size)
        _store_axis(x, grid.origin_x, grid.n_x, grid.h, correction, distances, stencils, AXIS_X)
        _store_axis(y, grid.origin_y, grid.n_y, grid.h, correction, distances, stencils, AXIS_Y)
        if dimension == 3:
            z = strided(rows, o + Z, size)
            _store_axis(z, grid.origin_z, grid.n_z, grid.h, correction, distances, stencils, AXIS_Z)
        fold_at_walls(grid.wall_cells, rows, o, count, grid, settings, stencils)

    @device
    @variant(dimension, distances)
    def fold_at_walls(wall_cells, rows, o, count, grid, settings, stencils):
        """Replace the stencils of points beside walls in the domain, and mark the points that may be."""
        if wall_cells is None:
            return
        store(stencils, marks, splat(0.0))
        if first_mask(wall_cells, grid, stencils, 0) & AROUND_WALL:
            fold_points(wall_cells, rows, o, count, grid, settings, stencils)

    @device
    @variant(dimension, distances)
    def fold_points(wall_cells, rows, o, count, grid, settings, stencils):
        for k in range(count):
            if first_mask(wall_cells, grid, stencils, k) & NEAR_WALL:
                stencils[marks + k] = 1.0
                _store_point(load(rows, o + k * size), dimension, distances, grid, settings, stencils, k)

    @device
    @variant(dimension)
    def first_mask(wall_cells, grid, stencils, k):
        """Mask of the first node of point number `k`."""
        address = grid.ax[int(stencils[AXIS_X + k])] + grid.ay[int(stencils[AXIS_Y + k])]
        if dimension == 3:
            address += grid.az[int(stencils[AXIS_Z + k])]
        return wall_cells[address // NODE]

    return find_stencils


@device
def _store_axis(
    x: Any, origin: float, n: int, h: float, correction: bool, distances: bool, stencils: np.ndarray, at: int
) -> None:
    """Write the block of an axis of `n` nodes for eight coordinates `x`, m."""
    inv_h = 1.0 / h
    s = (x - origin) * inv_h
    base, w0, w1, w2, g0, g1, g2 = spline_lanes(s, splat(0.5), splat(n - 1.5), correction)
    store(stencils, at + BASE, base)
    _store_three(stencils, at + W, w0, w1, w2)
    _store_three(stencils, at + G, g0 * inv_h, g1 * inv_h, g2 * inv_h)
    if distances:
        d = (base - s) * h
        _store_three(stencils, at + D, w0 * d, w1 * (d + h), w2 * (d + 2.0 * h))


@device
def _store_three(stencils: np.ndarray, at: int, a: Any, b: Any, c: Any) -> None:
    store(stencils, at, a)
    store(stencils, at + LANES, b)
    store(stencils, at + 2 * LANES, c)


@device
def _store_point(
    record: Any, d: int, distances: bool, grid: Grid, settings: Settings, stencils: np.ndarray, k: int
) -> None:
    """Write the stencil of one point, number `k` of the eight, from vector 0 of its record."""
    _, s, base, w0, w1, w2, g0, g1, g2 = quadratic_stencil(record, grid, settings)
    inv_h = 1.0 / grid.h
    d0 = (base - s) * grid.h
    for axis in range(d):
        at, lane = axis * BLOCK + k, X + axis
        stencils[at + W], stencils[at + W + LANES] = extract(w0, lane), extract(w1, lane)
        stencils[at + W + 2 * LANES] = extract(w2, lane)
        stencils[at + G], stencils[at + G + LANES] = extract(g0, lane) * inv_h, extract(g1, lane) * inv_h
        stencils[at + G + 2 * LANES] = extract(g2, lane) * inv_h
        if distances:
            stencils[at + D] = extract(w0 * d0, lane)
            stencils[at + D + LANES] = extract(w1 * (d0 + grid.h), lane)
            stencils[at + D + 2 * LANES] = extract(w2 * (d0 + 2.0 * grid.h), lane)


@device
def lines_of_axis(lines: np.ndarray, base: float) -> tuple[int, int, int]:
    """Offsets of three node lines of an axis in `nodes`, from the first of them."""
    first = int(base)
    return element(lines, first), element(lines, first + 1), element(lines, first + 2)


@device
def three(stencils: np.ndarray, at: int) -> tuple[Any, Any, Any]:
    """Three numbers of a point from the buffer, each in all lanes."""
    return spread(stencils, at), spread(stencils, at + LANES), spread(stencils, at + 2 * LANES)


@device
def weighted_sum(w: tuple[Any, Any, Any], values: tuple[Any, Any, Any]) -> Any:
    """Weighted sum of three nodes, or lines, or planes."""
    return fma(w[2], values[2], fma(w[1], values[1], w[0] * values[0]))
