"""P2G with quadratic shape functions in two dimensions for registers of four doubles (AVX2).

The sums of nine nodes would fill eighteen registers, more than there are. Eight points at a time therefore pass twice:
once for mass and momentum, the lower halves of the nodes, and once for force and filtered stress, the upper halves.
Each half has one kind of slope, weight times distance or gradient, so that the products of the other with zeros are
saved. Same bits as `transfer_quadratic_2d.scatter_points`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcol.mpm.grid import Grid
from mpmcol.mpm.jit import device
from mpmcol.mpm.kernels.stencils import AXIS_X, AXIS_Y, BASE, STENCILS, D, G, W, lines_of_axis, make_find_stencils
from mpmcol.mpm.kernels.stress_filter import make_filtered_stress
from mpmcol.mpm.kernels.transfer_common import prefetch_ahead
from mpmcol.mpm.kernels.transfer_quadratic_2d import add_column
from mpmcol.mpm.lanes import LANES, RECORD_SIZE, S_ZZ, V0, X_VECTOR, Y_VECTOR, J, M, X
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import extract, fma, half_vector, load_half, scratch, spread_half, store, where_positive

SIZE, BUFFER, HALF = RECORD_SIZE[2], STENCILS[2], LANES // 2
SUMS = 2 * 9 * HALF  # doubles in the sums of nine nodes, first those of their lower halves
LOWER, UPPER = 0, 9 * HALF  # where they start
NOWHERE = -1.0  # instead of the first node of a point
filtered_stress = make_filtered_stress(2)
find_with_distances = make_find_stencils(2, distances=True)


@device
def scatter_points(rows: np.ndarray, first: int, stop: int, following: int, grid: Grid, settings: Settings) -> None:
    """P2G of these points; see `transfer.make_scatter_points`."""
    # A function for the body of both loops over eight points would count references to the arrays of the grid.
    nodes, stencils, sums, zero = grid.nodes, scratch(BUFFER), scratch(SUMS), half_vector(0.0, 0.0, 0.0, 0.0)
    i, j = NOWHERE, NOWHERE
    for start in range(first, stop, LANES):
        count, before_i, before_j = min(LANES, stop - start), i, j
        find_with_distances(rows, start * SIZE, count, grid, settings, stencils)
        sum0, sum1, sum2 = _load_sums(sums, LOWER)
        for k in range(count):
            prefetch_ahead(rows, SIZE, start + k, stop, following)
            if stencils[AXIS_X + BASE + k] != i or stencils[AXIS_Y + BASE + k] != j:
                if i != NOWHERE:
                    _add_to_nodes(nodes, i, j, 0, (sum0, sum1, sum2), grid)
                sum0 = sum1 = sum2 = zero, zero, zero
                i, j = stencils[AXIS_X + BASE + k], stencils[AXIS_Y + BASE + k]
            terms = momentum_terms(rows, (start + k) * SIZE, settings)
            sum0, sum1, sum2 = _add_point(terms, stencils, k, D, sum0, sum1, sum2)
        _store_sums(sums, LOWER, sum0, sum1, sum2)

        i, j = before_i, before_j
        sum0, sum1, sum2 = _load_sums(sums, UPPER)
        for k in range(count):
            if stencils[AXIS_X + BASE + k] != i or stencils[AXIS_Y + BASE + k] != j:
                if i != NOWHERE:
                    _add_to_nodes(nodes, i, j, HALF, (sum0, sum1, sum2), grid)
                sum0 = sum1 = sum2 = zero, zero, zero
                i, j = stencils[AXIS_X + BASE + k], stencils[AXIS_Y + BASE + k]
            terms = force_terms(rows, (start + k) * SIZE, settings)
            sum0, sum1, sum2 = _add_point(terms, stencils, k, G, sum0, sum1, sum2)
        _store_sums(sums, UPPER, sum0, sum1, sum2)
    if i != NOWHERE:
        _add_to_nodes(nodes, i, j, 0, _load_sums(sums, LOWER), grid)
        _add_to_nodes(nodes, i, j, HALF, _load_sums(sums, UPPER), grid)


@device
def momentum_terms(rows: np.ndarray, o: int, settings: Settings) -> tuple[Any, Any, Any]:
    """Lower halves of what the nodes receive from a point: mass and momentum, Eq. (19), (20)."""
    m, momentum = spread_half(rows, o + M), half_vector(0.0, 1.0, 1.0, 0.0)
    at_point = m * where_positive(momentum, load_half(rows, o), half_vector(1.0, 0.0, 0.0, 0.0))
    taylor = (settings.taylor * m) * momentum
    return at_point, load_half(rows, o + X_VECTOR) * taylor, load_half(rows, o + Y_VECTOR) * taylor


@device
def force_terms(rows: np.ndarray, o: int, settings: Settings) -> tuple[Any, Any, Any]:
    """Upper halves: force and filtered stress, Eq. (13), (14)."""
    m, volume = spread_half(rows, o + M), spread_half(rows, o + J) * spread_half(rows, o + V0)
    at_point = half_vector(settings.gravity_x, settings.gravity_y, 0.0, 0.0)
    if settings.filter_rate > 0.0:
        q = extract(filtered_stress(rows, o, settings), 0)
        at_point = where_positive(half_vector(0.0, 0.0, 0.0, 1.0), q, at_point)
    at_point = m * at_point
    hoop = rows[o + S_ZZ] / rows[o + X] if settings.axisymmetric else 0.0
    at_point = at_point - half_vector(hoop, 0.0, 0.0, 0.0) * volume
    force = -volume * half_vector(1.0, 1.0, 0.0, 0.0)
    return at_point, load_half(rows, o + X_VECTOR + HALF) * force, load_half(rows, o + Y_VECTOR + HALF) * force


@device
def _add_point(terms, stencils, k, slope, sum0, sum1, sum2):
    """Add a point to the sums of its nodes: node (i, j) receives w_j P_i + w_i Q_j."""
    at_point, c_x, c_y = terms
    wx0, wx1, wx2 = _three(stencils, AXIS_X + W + k)
    wy = _three(stencils, AXIS_Y + W + k)
    sx0, sx1, sx2 = _three(stencils, AXIS_X + slope + k)
    sy0, sy1, sy2 = _three(stencils, AXIS_Y + slope + k)
    q = sy0 * c_y, sy1 * c_y, sy2 * c_y
    return (
        add_column(sum0, wx0, fma(sx0, c_x, wx0 * at_point), wy, q),
        add_column(sum1, wx1, fma(sx1, c_x, wx1 * at_point), wy, q),
        add_column(sum2, wx2, fma(sx2, c_x, wx2 * at_point), wy, q),
    )


@device
def _three(stencils, at):
    """Three numbers of a point from the buffer, each in all lanes of half a vector."""
    return spread_half(stencils, at), spread_half(stencils, at + LANES), spread_half(stencils, at + 2 * LANES)


@device
def _load_sums(sums, at):
    return _load_column(sums, at), _load_column(sums, at + 3 * HALF), _load_column(sums, at + 6 * HALF)


@device
def _store_sums(sums, at, sum0, sum1, sum2):
    _store_column(sums, at, sum0)
    _store_column(sums, at + 3 * HALF, sum1)
    _store_column(sums, at + 6 * HALF, sum2)


@device
def _load_column(sums, at):
    return load_half(sums, at), load_half(sums, at + HALF), load_half(sums, at + 2 * HALF)


@device
def _store_column(sums, at, values):
    store(sums, at, values[0])
    store(sums, at + HALF, values[1])
    store(sums, at + 2 * HALF, values[2])


@device
def _add_to_nodes(nodes, i, j, lane, sums, grid):
    """Add half of the sums of points to their nodes, from `lane` on."""
    x, y = lines_of_axis(grid.ax, i), lines_of_axis(grid.ay, j)
    _add_to_column(nodes, x[0] + lane, y, sums[0])
    _add_to_column(nodes, x[1] + lane, y, sums[1])
    _add_to_column(nodes, x[2] + lane, y, sums[2])


@device
def _add_to_column(nodes, x, y, sums):
    store(nodes, x + y[0], load_half(nodes, x + y[0]) + sums[0])
    store(nodes, x + y[1], load_half(nodes, x + y[1]) + sums[1])
    store(nodes, x + y[2], load_half(nodes, x + y[2]) + sums[2])
