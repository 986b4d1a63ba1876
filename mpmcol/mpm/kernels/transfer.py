"""Transfers between points and grid: which implementation serves which shape functions, and P2G over all points.

Quadratic shape functions have transfers written out node by node (`transfer_quadratic_2d`, `transfer_quadratic_3d`),
all others share one for any width (`transfer_generic`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.grid import Grid, Tiles
from mpmcol.mpm.jit import phase, prange, subroutine, variant
from mpmcol.mpm.kernels import transfer_quadratic_2d, transfer_quadratic_3d
from mpmcol.mpm.kernels.transfer_common import PREFETCH_DISTANCE, prefetch_record
from mpmcol.mpm.kernels.transfer_generic import make_gather, make_scatter
from mpmcol.mpm.lanes import RECORD_SIZE
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS

QUADRATIC = {2: transfer_quadratic_2d, 3: transfer_quadratic_3d}


class Transfer(NamedTuple):
    """Transfer of one point for a dimension and shape functions.

    scatter(rows, o, nodes, grid, settings) adds the point whose record starts at `o` to its nodes.
    gather(rows, o, nodes, grid, settings, limits, dt) updates its velocity, position and velocity gradient from its
    nodes; see `transfer_common.update_point` for what it returns.
    """

    scatter: Callable[..., Any]
    gather: Callable[..., Any]


@cache
def make_transfer(dimension: int, basis: str) -> Transfer:
    """The transfer of a point in `dimension` dimensions with the shape functions named `basis`."""
    quadratic = QUADRATIC[dimension]
    if basis == "quadratic":
        return Transfer(quadratic.scatter, quadratic.gather)
    shape_functions = SHAPE_FUNCTIONS[basis]
    return Transfer(make_scatter(dimension, shape_functions), make_gather(dimension, shape_functions))


@cache
def make_p2g(dimension: int, basis: str) -> Callable[..., None]:
    """P2G over all points, with the transfer of a point frozen in."""
    scatter_points = make_scatter_points(dimension, basis)

    @phase
    @variant(dimension, basis)
    def p2g(rows: np.ndarray, grid: Grid, tiles: Tiles, settings: Settings) -> None:
        """Scatter mass, momentum and force; tiles of one group in parallel, each node summed in a fixed order.

        Reads: rows. Writes: nodes (m, mv, f, m q). Eq. (13), (14), (19), (20).
        """
        start, grouped, group_start = tiles.start, tiles.grouped, tiles.group_start
        for group in range(len(group_start) - 1):
            for k in prange(group_start[group], group_start[group + 1]):
                tile, following = grouped[k], grouped[min(k + 1, len(grouped) - 1)]
                scatter_points(rows, start[tile], start[tile + 1], start[following], grid, settings)

    return p2g


@cache
def make_scatter_points(dimension: int, basis: str) -> Callable[..., None]:
    """P2G over a range of points, with the transfer of a point frozen in."""
    scatter, size = make_transfer(dimension, basis).scatter, RECORD_SIZE[dimension]

    @subroutine
    @variant(dimension, basis)
    def scatter_points(rows: np.ndarray, first: int, stop: int, following: int, grid: Grid, settings: Settings) -> None:
        """Scatter mass, momentum and force of these points; `following` is the point after them, to be prefetched.

        Reads: rows. Writes: nodes (m, mv, f, m q). Eq. (13), (14), (19), (20).
        """
        nodes, jump = grid.nodes, following - stop
        for p in range(first, stop):
            ahead = p + PREFETCH_DISTANCE
            prefetch_record(rows, size, ahead if ahead < stop else ahead + jump)
            scatter(rows, p * size, nodes, grid, settings)

    return scatter_points
