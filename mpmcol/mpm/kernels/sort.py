"""Points in order of tiles, so that tiles of one group can be scattered in parallel and memory is read in line.

The first node of a point's quadratic stencil decides its tile. A point may travel up to one cell before the next sort
(half a cell with the cubic basis): its stencil then still keeps clear of every other tile of the same colour, and of
all nodes but those of its tile and the tiles beside it. Works in two and three dimensions.
"""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.grid import TILE, Grid, tile_coordinates, tile_count
from mpmcol.mpm.jit import device, kernel, prange
from mpmcol.mpm.kernels.deactivation import hold_nodes, mark_active
from mpmcol.mpm.lanes import KIND, X, Y, Z
from mpmcol.mpm.shape_functions.quadratic import base_node
from mpmcol.mpm.simd import LANES, load, store

BAND = 512  # tiles: their nodes are half a megabyte in two dimensions, two in three


@kernel
def sort_points(rows: np.ndarray, row: int, grid: Grid, count: np.ndarray, mark: np.ndarray, margin: int):
    """Put the records in `rows`, of `row` doubles each, in order of tile, kind and cell; returns the arrays of `Tiles`.

    Tiles more than `margin` tiles from the column are inactive: their points come last (margin 0: all are active).
    Reads: rows. Writes: rows, fixed if `margin` > 0, count (n_tiles,) and mark (n_tiles,) as scratch, zero on entry and
    on return. Eq. (19)-(20) are sums over points in this order.
    """
    n = len(rows) // row
    tiles = tile_count(grid.n_x), tile_count(grid.n_y), tile_count(grid.n_z)
    buckets = TILE**3 if grid.n_z > 1 else TILE**2
    tile_of, bucket_of = np.empty(n, np.int32), np.empty(n, np.uint8)
    for p in prange(n):
        tile_of[p], bucket_of[p] = _place(rows, p * row, grid, tiles, buckets)
    if margin > 0:
        mark_active(np.unique(tile_of[bucket_of < buckets]), margin, tiles, mark)
    occupied, n_active = _occupied(tile_of, count, margin, mark)
    start = _starts(occupied, count)
    by_tile = np.empty(n, np.int32)
    for p in range(n):
        by_tile[count[tile_of[p]]] = p
        count[tile_of[p]] += 1
    order, split = tile_of, np.empty(len(occupied), np.int64)  # nobody reads the tiles of points any more
    cells = np.empty(n, np.uint8)
    for t in prange(len(occupied)):
        split[t] = _order_tile(by_tile, bucket_of, buckets, start[t], start[t + 1], order, cells)
        count[occupied[t]] = 0
    _permute(rows, row, order)
    grouped, group_start = _group(occupied[:n_active], tiles)
    active = _reachable(occupied[:n_active], grid, tiles, mark)
    if margin > 0:
        hold_nodes(active, occupied[n_active:], grid, tiles, mark)
    return start[: n_active + 1], split[:n_active], grouped, group_start, active, cells


@device
def _place(rows, o, grid, tiles, buckets):
    """Tile of a point and its bucket in the tile: column points cell by cell, then base points."""
    i = base_node((rows[o + X] - grid.origin_x) / grid.h, grid.n_x)
    j = base_node((rows[o + Y] - grid.origin_y) / grid.h, grid.n_y)
    k = base_node((rows[o + Z] - grid.origin_z) / grid.h, grid.n_z) if grid.n_z > 1 else 0
    tile = ((i // TILE) * tiles[1] + j // TILE) * tiles[2] + k // TILE
    cell = (i % TILE) * TILE + j % TILE
    if grid.n_z > 1:
        cell = cell * TILE + k % TILE
    return tile, int(rows[o + KIND]) * buckets + cell


@device
def _occupied(tile_of, count, margin, mark):
    """Occupied tiles in order, inactive tiles last, and the number of active ones; `count` counts points.

    If there is a margin, the tiles in `mark` are active; it is zero again on return.
    """
    for tile in tile_of:
        count[tile] += 1
    occupied = np.flatnonzero(count)
    if margin == 0:
        return occupied, len(occupied)
    is_active = mark[occupied] > 0
    mark[:] = 0
    return np.concatenate((occupied[is_active], occupied[~is_active])), np.sum(is_active)


@device
def _starts(occupied, count):
    """Where the points of each tile start; `count` becomes each tile's next free place."""
    start = np.zeros(len(occupied) + 1, np.int64)
    for t in range(len(occupied)):
        start[t + 1] = start[t] + count[occupied[t]]
        count[occupied[t]] = start[t]
    return start


@device
def _order_tile(by_tile, bucket_of, buckets, start, stop, order, cells):
    """Counting sort of one tile's points by bucket, which `cells` keeps; returns where the base's points begin."""
    place = np.zeros(2 * buckets + 1, np.int64)
    for k in range(start, stop):
        place[bucket_of[by_tile[k]] + 1] += 1
    place[0] = start
    for bucket in range(2 * buckets):
        place[bucket + 1] += place[bucket]
    split = place[buckets]
    for k in range(start, stop):
        bucket = bucket_of[by_tile[k]]
        order[place[bucket]], cells[place[bucket]] = by_tile[k], bucket
        place[bucket] += 1
    return split


@device
def _permute(rows, row, order):
    """Bring record order[p] to place p for all p, cycle by cycle and without a second copy; uses up `order`."""
    held = np.empty(row)
    for first in range(len(order)):
        source = order[first]
        if source < 0 or source == first:
            continue
        held[:] = rows[first * row : (first + 1) * row]
        target = np.int64(first)
        while source != first:
            for lane in range(0, row, LANES):
                store(rows, target * row + lane, load(rows, source * row + lane))
            order[target] = -1
            target = np.int64(source)
            source = order[target]
        rows[target * row : (target + 1) * row] = held
        order[target] = -1


@device
def _group(occupied, tiles):
    """Tiles grouped by band, and in it by colour, the parity of their coordinates; and where each group starts.

    The nodes of a band stay in the caches from colour to colour.
    """
    colours, n = 8 if tiles[2] > 1 else 4, len(occupied)
    grouped, group_start = np.empty(n, np.int64), np.zeros(colours * (n // BAND + 1) + 1, np.int64)
    k, group, first = 0, 0, 0
    while first < n:
        stop = _band_end(occupied, tiles, first)
        for colour in range(colours):
            for t in range(first, stop):
                x, y, z = tile_coordinates(occupied[t], tiles)
                if x % 2 + 2 * (y % 2) + 4 * (z % 2) == colour:
                    grouped[k] = t
                    k += 1
            group += 1
            group_start[group] = k
        first = stop
    return grouped, group_start[: group + 1]


@device
def _band_end(occupied, tiles, first):
    """End of the band that starts at `first`: whole layers of equal x, BAND tiles or more, none too few left over."""
    n = len(occupied)
    if n - first < 2 * BAND:
        return n
    stop = first + BAND
    while stop < n and tile_coordinates(occupied[stop], tiles)[0] == tile_coordinates(occupied[stop - 1], tiles)[0]:
        stop += 1
    return stop


@device
def _reachable(occupied, grid, tiles, mark):
    """Addresses of the tiles whose nodes a point can touch before the next sort."""
    around = 27 if tiles[2] > 1 else 9
    active, found = np.empty(around * len(occupied), np.int64), 0
    for tile in occupied:
        x, y, z = tile_coordinates(tile, tiles)
        for tx in range(max(x - 1, 0), min(x + 2, tiles[0])):
            for ty in range(max(y - 1, 0), min(y + 2, tiles[1])):
                for tz in range(max(z - 1, 0), min(z + 2, tiles[2])):
                    address = grid.ax[tx * TILE] + grid.ay[ty * TILE] + grid.az[tz * TILE]
                    if mark[address // grid.tile_doubles] == 0:
                        mark[address // grid.tile_doubles] = 1
                        active[found] = address
                        found += 1
    for t in range(found):
        mark[active[t] // grid.tile_doubles] = 0
    return np.sort(active[:found])


def scratch(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """The `count` and `mark` arrays of `sort_points` for this grid."""
    tiles = tile_count(grid.n_x) * tile_count(grid.n_y) * tile_count(grid.n_z)
    return np.zeros(tiles, np.int64), np.zeros(tiles, np.uint8)
