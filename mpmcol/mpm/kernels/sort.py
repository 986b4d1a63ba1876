"""Counting sort of points by tile, so that tiles of one group can be scattered in parallel and memory is contiguous.

The first node of a point's quadratic stencil determines its tile. A point may travel up to one cell before the next
sort (half a cell with cubic shape functions): its stencil then overlaps no stencil of another tile of the same colour,
and no nodes beyond those of its tile and the neighbouring tiles. Works in two and three dimensions.
"""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.grid import TILE, Grid, tile_coordinates, tile_count
from mpmcol.mpm.jit import device, kernel, prange
from mpmcol.mpm.kernels.deactivation import hold_nodes, mark_active
from mpmcol.mpm.lanes import KIND, X, Y, Z
from mpmcol.mpm.particles import BASE
from mpmcol.mpm.shape_functions.quadratic import base_node
from mpmcol.mpm.simd import LANES, load, store

BAND = 512  # tiles; their nodes take 0.5 MiB in two dimensions, 2 MiB in three


@kernel
def sort_points(
    rows: np.ndarray, size: int, grid: Grid, count: np.ndarray, mark: np.ndarray, margin: int, materials: int
):
    """Sort the records in `rows`, of `size` doubles each, by tile, kind and cell; returns the arrays of `Tiles`.

    materials: number of those of the column; the points of the base follow those of all of them.

    Tiles more than `margin` tiles from the column are inactive: their points come last (margin 0: all are active).
    Reads: rows. Writes: rows, fixed if `margin` > 0, count (n_tiles,) and mark (n_tiles,) as scratch, zero on entry and
    on return. Eq. (19)-(20) are sums over points in this order.
    """
    n = len(rows) // size
    tiles = tile_count(grid.n_x), tile_count(grid.n_y), tile_count(grid.n_z)
    buckets = TILE**3 if grid.n_z > 1 else TILE**2
    tile_of, bucket_of = np.empty(n, np.int32), np.empty(n, np.uint8)
    for p in prange(n):
        tile_of[p], bucket_of[p] = _locate(rows, p * size, grid, tiles, buckets, materials)
    if margin > 0:
        mark_active(tile_of, bucket_of, materials * buckets, margin, tiles, mark)
    occupied, n_active = _occupied(tile_of, count, margin, mark)
    start = _starts(occupied, count)
    by_tile = np.empty(n, np.int32)
    for p in range(n):
        by_tile[count[tile_of[p]]] = p
        count[tile_of[p]] += 1
    order = tile_of  # reuses its memory
    layers = np.empty((len(occupied), materials + 1), np.int64)
    cells = np.empty(n, np.uint8)
    for t in prange(len(occupied)):
        _sort_tile(by_tile, bucket_of, buckets, start[t], start[t + 1], order, cells, layers[t])
        count[occupied[t]] = 0
    _permute(rows, size, order)
    grouped, group_start = _group(occupied[:n_active], tiles)
    active = _reachable(occupied[:n_active], grid, tiles, mark)
    if margin > 0:
        hold_nodes(active, occupied[n_active:], grid, tiles, mark)
    split = layers[:n_active, materials].copy()
    return start[: n_active + 1], split, layers[:n_active], grouped, group_start, active, cells


@device
def _locate(rows, o, grid, tiles, buckets, materials):
    """Tile of a point and its bucket in the tile: cells of each material of the column, then cells of the base."""
    i = base_node((rows[o + X] - grid.origin_x) / grid.h, grid.n_x)
    j = base_node((rows[o + Y] - grid.origin_y) / grid.h, grid.n_y)
    k = base_node((rows[o + Z] - grid.origin_z) / grid.h, grid.n_z) if grid.n_z > 1 else 0
    tile = ((i // TILE) * tiles[1] + j // TILE) * tiles[2] + k // TILE
    cell = (i % TILE) * TILE + j % TILE
    if grid.n_z > 1:
        cell = cell * TILE + k % TILE
    kind = int(rows[o + KIND])
    place = materials if kind == BASE else max(kind - 1, 0)
    return tile, place * buckets + cell


@device
def _occupied(tile_of, count, margin, mark):
    """Occupied tiles in order, inactive tiles last, and the number of active ones; `count` counts points.

    If there is a margin, the tiles in `mark` are active; it is zero again on return.
    """
    n = 0
    for tile in tile_of:
        n += count[tile] == 0
        count[tile] += 1
    occupied, n_active = np.empty(n, np.int64), 0
    for tile in range(len(count)):
        if count[tile] > 0 and (margin == 0 or mark[tile] > 0):
            occupied[n_active] = tile
            n_active += 1
    if margin > 0:
        t = n_active
        for tile in range(len(count)):
            if count[tile] > 0 and mark[tile] == 0:
                occupied[t] = tile
                t += 1
            mark[tile] = 0
    return occupied, n_active


@device
def _starts(occupied, count):
    """First point of each tile; `count` becomes the next free position of each tile."""
    start = np.zeros(len(occupied) + 1, np.int64)
    for t in range(len(occupied)):
        start[t + 1] = start[t] + count[occupied[t]]
        count[occupied[t]] = start[t]
    return start


@device
def _sort_tile(by_tile, bucket_of, buckets, start, stop, order, cells, layers):
    """Counting sort of the points of a tile by bucket, stored in `cells`; `layers` receives where materials start."""
    position = np.zeros(len(layers) * buckets + 1, np.int64)
    for k in range(start, stop):
        position[bucket_of[by_tile[k]] + 1] += 1
    position[0] = start
    for bucket in range(len(layers) * buckets):
        position[bucket + 1] += position[bucket]
    for k in range(len(layers)):
        layers[k] = position[k * buckets]
    for k in range(start, stop):
        bucket = bucket_of[by_tile[k]]
        order[position[bucket]], cells[position[bucket]] = by_tile[k], bucket
        position[bucket] += 1


@device
def _permute(rows, size, order):
    """Move record order[p] to position p for all p, in place, cycle by cycle; overwrites `order`."""
    held = np.empty(size)
    for first in range(len(order)):
        source = order[first]
        if source < 0 or source == first:
            continue
        _copy_record(held, 0, rows, first, size)
        target = np.int64(first)
        while source != first:
            _copy_record(rows, target, rows, np.int64(source), size)
            order[target] = -1
            target = np.int64(source)
            source = order[target]
        _copy_record(rows, target, held, 0, size)
        order[target] = -1


@device
def _copy_record(to, target, rows, source, size):
    for o in range(0, size, LANES):
        store(to, target * size + o, load(rows, source * size + o))


@device
def _group(occupied, tiles):
    """Tiles grouped by band, and in each band by colour (parity of the coordinates); and where each group starts.

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
    """End of the band from `first` on: whole layers of equal x, at least BAND tiles in this band and the rest."""
    n = len(occupied)
    if n - first < 2 * BAND:
        return n
    stop = first + BAND
    while stop < n and tile_coordinates(occupied[stop], tiles)[0] == tile_coordinates(occupied[stop - 1], tiles)[0]:
        stop += 1
    return stop


@device
def _reachable(occupied, grid, tiles, mark):
    """Addresses, in order, of the tiles whose nodes points can reach before the next sort."""
    found = 0
    for tile in occupied:
        x, y, z = tile_coordinates(tile, tiles)
        for tx in range(max(x - 1, 0), min(x + 2, tiles[0])):
            for ty in range(max(y - 1, 0), min(y + 2, tiles[1])):
                for tz in range(max(z - 1, 0), min(z + 2, tiles[2])):
                    position = (grid.ax[tx * TILE] + grid.ay[ty * TILE] + grid.az[tz * TILE]) // grid.tile_doubles
                    found += mark[position] == 0
                    mark[position] = 1
    active, t = np.empty(found, np.int64), 0
    for position in range(len(mark)):
        if mark[position] > 0:
            active[t] = position * grid.tile_doubles
            t += 1
            mark[position] = 0
    return active


def sort_buffers(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """The `count` and `mark` arrays of `sort_points` for this grid."""
    tiles = tile_count(grid.n_x) * tile_count(grid.n_y) * tile_count(grid.n_z)
    return np.zeros(tiles, np.int64), np.zeros(tiles, np.uint8)
