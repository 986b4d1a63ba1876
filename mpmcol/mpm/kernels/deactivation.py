"""Deactivation of base tiles outside the influence of the column.

Points of inactive tiles keep their state and exchange nothing with the nodes. The nodes in their support are held at
rest, so that active points beside them do not see a free surface; the energy ledger stays complete.
"""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.boundary import BOUNDARY_BITS, INACTIVE_BITS
from mpmcol.mpm.grid import NODE, TILE, Grid, tile_coordinates
from mpmcol.mpm.jit import device

NEAR_COLUMN, WITH_COLUMN = np.uint8(1), np.uint8(2)  # marks of active tiles


@device
def mark_active(
    tile_of: np.ndarray,
    bucket_of: np.ndarray,
    buckets: int,
    margin: int,
    tiles: tuple[int, int, int],
    mark: np.ndarray,
) -> None:
    """Mark all tiles at most `margin` tiles from those that hold points of the column: in a bucket below `buckets`.

    A column point travels one cell at most before the next sort, so with a margin of one tile no held node lies in its
    support.
    """
    for p in range(len(tile_of)):
        if bucket_of[p] < buckets:
            mark[tile_of[p]] = WITH_COLUMN
    for tile in range(len(mark)):
        if mark[tile] != WITH_COLUMN:
            continue
        x, y, z = tile_coordinates(tile, tiles)
        for tx in range(max(x - margin, 0), min(x + margin + 1, tiles[0])):
            for ty in range(max(y - margin, 0), min(y + margin + 1, tiles[1])):
                for tz in range(max(z - margin, 0), min(z + margin + 1, tiles[2])):
                    near = (tx * tiles[1] + ty) * tiles[2] + tz
                    mark[near] = max(mark[near], NEAR_COLUMN)


@device
def hold_nodes(
    active: np.ndarray, inactive: np.ndarray, grid: Grid, tiles: tuple[int, int, int], mark: np.ndarray
) -> None:
    """Hold the nodes of the `active` tiles that lie in the support of points of `inactive` tiles; free the others.

    Reads: ax, ay, az. Writes: fixed, mark as scratch (zero on entry and on return).
    """
    fixed = grid.fixed
    for tile in inactive:
        mark[tile] = 1
    for address in active:
        x, y, z = tile_coordinates(address // grid.tile_doubles, tiles)
        for i in range(x * TILE, min((x + 1) * TILE, grid.n_x)):
            for j in range(y * TILE, min((y + 1) * TILE, grid.n_y)):
                for k in range(z * TILE, min((z + 1) * TILE, grid.n_z)):
                    node = (grid.ax[i] + grid.ay[j] + grid.az[k]) // NODE
                    held = INACTIVE_BITS if _is_touched(i, j, k, tiles, mark) else 0
                    fixed[node] = (fixed[node] & BOUNDARY_BITS) | held
    for tile in inactive:
        mark[tile] = 0


@device
def _is_touched(i, j, k, tiles, mark):
    """Whether a node lies in the support of points of a marked tile.

    With any shape functions, nodes 4 t - 1 to 4 t + 6 along an axis are in the support of points of tile t, so that
    the tiles to check are (i + 1) // 4 and the one before.
    """
    x, y, z = (i + 1) // TILE, (j + 1) // TILE, (k + 1) // TILE
    for tx in range(max(x - 1, 0), min(x + 1, tiles[0])):
        for ty in range(max(y - 1, 0), min(y + 1, tiles[1])):
            for tz in range(max(z - 1, 0), min(z + 1, tiles[2])):
                if mark[(tx * tiles[1] + ty) * tiles[2] + tz] > 0:
                    return True
    return False
