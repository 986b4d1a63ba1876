"""Points in order of tiles, so that tiles of one colour can be scattered in parallel and memory is read in line.

The first node of a point's stencil decides its tile. A point may travel up to one cell before the next sort: its
stencil then still keeps clear of every other tile of the same colour.
"""

from __future__ import annotations

import numpy as np

from mpmcol.basis import base_node
from mpmcol.jit import device, kernel, prange
from mpmcol.state import KIND, NODE, ROW, TILE, TILE_DOUBLES, TILE_NODES, Grid, X, Y, tile_count

_BUCKETS = 2 * TILE_NODES  # column points cell by cell, then base points


@kernel
def sort_points(rows: np.ndarray, ordered: np.ndarray, grid: Grid, count: np.ndarray, mark: np.ndarray):
    """Copy `rows` to `ordered` by tile, kind and cell; returns the arrays of `Tiles`.

    Reads: rows. Writes: ordered, count (n_tiles,) and mark (n_tiles,) as scratch, zero on entry and on return.
    Eq. (19)-(20) are sums over points in this order.
    """
    n = len(rows) // ROW
    tiles_y = tile_count(grid.n_y)
    tile_of, bucket_of = np.empty(n, np.int64), np.empty(n, np.int8)
    for p in prange(n):
        tile_of[p], bucket_of[p] = _place(rows, p * ROW, grid, tiles_y)
    occupied, start = _count(tile_of, count)
    by_tile = np.empty(n, np.int64)
    for p in range(n):
        by_tile[count[tile_of[p]]] = p
        count[tile_of[p]] += 1
    order, split = np.empty(n, np.int64), np.empty(len(occupied), np.int64)
    for t in prange(len(occupied)):
        split[t] = _order_tile(by_tile, bucket_of, start[t], start[t + 1], order)
        count[occupied[t]] = 0
    for p in prange(n):
        source, target = order[p] * ROW, p * ROW
        ordered[target : target + ROW] = rows[source : source + ROW]
    by_colour, colour_start = _colour(occupied, tiles_y)
    return start, split, by_colour, colour_start, _reachable(occupied, grid, tiles_y, mark)


@device
def _place(rows, o, grid, tiles_y):
    """Tile of a point and its bucket in the tile."""
    i = base_node((rows[o + X] - grid.origin_x) / grid.h, grid.n_x)
    j = base_node((rows[o + Y] - grid.origin_y) / grid.h, grid.n_y)
    bucket = int(rows[o + KIND]) * TILE_NODES + (i % TILE) * TILE + j % TILE
    return (i // TILE) * tiles_y + j // TILE, bucket


@device
def _count(tile_of, count):
    """Occupied tiles in order and where their points start; `count` becomes each tile's next free place."""
    for tile in tile_of:
        count[tile] += 1
    occupied = np.flatnonzero(count)
    start = np.zeros(len(occupied) + 1, np.int64)
    for t in range(len(occupied)):
        start[t + 1] = start[t] + count[occupied[t]]
        count[occupied[t]] = start[t]
    return occupied, start


@device
def _order_tile(by_tile, bucket_of, start, stop, order):
    """Counting sort of one tile's points by bucket; returns where the base's points begin."""
    place = np.zeros(_BUCKETS + 1, np.int64)
    for k in range(start, stop):
        place[bucket_of[by_tile[k]] + 1] += 1
    place[0] = start
    for bucket in range(_BUCKETS):
        place[bucket + 1] += place[bucket]
    split = place[TILE_NODES]
    for k in range(start, stop):
        bucket = bucket_of[by_tile[k]]
        order[place[bucket]] = by_tile[k]
        place[bucket] += 1
    return split


@device
def _colour(occupied, tiles_y):
    """Tiles grouped by the parity of their two coordinates, and where each of the four groups starts."""
    by_colour, colour_start = np.empty(len(occupied), np.int64), np.zeros(5, np.int64)
    k = 0
    for colour in range(4):
        for t in range(len(occupied)):
            if (occupied[t] // tiles_y) % 2 + 2 * (occupied[t] % tiles_y % 2) == colour:
                by_colour[k] = t
                k += 1
        colour_start[colour + 1] = k
    return by_colour, colour_start


@device
def _reachable(occupied, grid, tiles_y, mark):
    """Addresses of the tiles whose nodes a point can touch before the next sort."""
    active, k = np.empty(9 * len(occupied), np.int64), 0
    for tile in occupied:
        for tx in range(max(tile // tiles_y - 1, 0), tile // tiles_y + 2):
            for ty in range(max(tile % tiles_y - 1, 0), tile % tiles_y + 2):
                if tx * TILE < grid.n_x and ty * TILE < grid.n_y:
                    address = grid.ax[tx * TILE] + grid.ay[ty * TILE]
                    if mark[address // TILE_DOUBLES] == 0:
                        mark[address // TILE_DOUBLES] = 1
                        active[k] = address
                        k += 1
    for t in range(k):
        mark[active[t] // TILE_DOUBLES] = 0
    return active[:k].copy()


def scratch(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """The `count` and `mark` arrays of `sort_points` for this grid."""
    tiles = tile_count(grid.n_x) * tile_count(grid.n_y)
    return np.zeros(tiles, np.int64), np.zeros(len(grid.nodes) // (TILE_NODES * NODE), np.uint8)
