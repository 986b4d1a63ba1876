"""The background grid: a dense array of nodes in tile-major order, and the order of the points on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcol.mpm.jit import device
from mpmcol.mpm.particles import aligned_zeros

NODE = 8  # doubles in a node's record: one cache line
TILE = 4  # nodes along an edge of a tile: 16 or 64 nodes


class Grid(NamedTuple):
    """Nodes of two or three axes (n_z = 1 in two dimensions); only tiles near material are ever accessed.

    The first and the last node of an axis are on the faces of the domain. Address of node (i, j, k):
    ax[i] + ay[j] + az[k].
    """

    nodes: np.ndarray  # (n_addresses * 8,) node records
    fixed: np.ndarray  # (n_addresses,) uint8: mask of the held velocity components (`mpmcol.mpm.boundary`)
    ax: np.ndarray  # (n_x,) offset of column i in `nodes`, in doubles
    ay: np.ndarray  # (n_y,)
    az: np.ndarray  # (n_z,)
    origin_x: float  # m
    origin_y: float  # m
    origin_z: float  # m
    h: float  # node spacing, m
    n_x: int
    n_y: int
    n_z: int
    tile_doubles: int  # size of a tile in `nodes`
    # (n_addresses,) uint16 by the lowest node of a cell: its faces on walls, and whether a stencil from that node on
    # may be near one (`mpmcol.mpm.wall_cells`); None: no walls
    wall_cells: np.ndarray | None = None


class Tiles(NamedTuple):
    """Order of sorted points: tile t holds points start[t] to start[t + 1], those of the base from split[t] on.

    Before them are those of the column, by material. Points from start[n_tiles] are inactive.
    """

    start: np.ndarray  # (n_tiles + 1,)
    split: np.ndarray  # (n_tiles,)
    layers: np.ndarray  # (n_tiles, n_materials + 1) first point of each material of the column, then split
    grouped: np.ndarray  # (n_tiles,) grouped[group_start[g] : group_start[g + 1]] are tiles that share no node
    group_start: np.ndarray  # (n_groups + 1,)
    active: np.ndarray  # (n_active,) address in `nodes` of each tile that points can reach
    cells: np.ndarray  # (n_points,) uint8, equal for points of one cell and kind, which are contiguous


def share_tiles(tiles: Tiles, threads: int) -> np.ndarray:
    """Where the tiles of each thread start in `grouped`, and the end of the group, (n_groups, threads + 1).

    Threads get consecutive tiles of nearly equal numbers of points. Results do not depend on it.
    """
    points = np.concatenate(([0], np.cumsum(np.diff(tiles.start)[tiles.grouped])))  # before each position
    first, stop = tiles.group_start[:-1], tiles.group_start[1:]
    shares = np.linspace(points[first], points[stop], threads + 1, axis=-1)
    above = np.maximum(np.searchsorted(points, shares), 1)
    nearest = above - (shares - points[above - 1] < points[above] - shares)
    nearest[:, 0], nearest[:, -1] = first, stop
    return nearest


def no_tiles() -> Tiles:
    """The order of no points: kernels can be compiled with it."""
    none = np.zeros(0, np.int64)
    return Tiles(none, none, np.zeros((0, 2), np.int64), none, none, none, np.zeros(0, np.uint8))


@device
def tile_count(n_nodes: int) -> int:
    """Tiles along an axis of `n_nodes` nodes."""
    return (n_nodes + TILE - 1) // TILE


@device
def tile_coordinates(tile: int, tiles: tuple[int, int, int]) -> tuple[int, int, int]:
    """Indices of a tile along the axes, from its number."""
    return tile // (tiles[1] * tiles[2]), tile // tiles[2] % tiles[1], tile % tiles[2]


def allocate_grid(origin: tuple[float, ...], h: float, cells: tuple[int, ...]) -> Grid:
    """A grid of `cells` cells of size `h` along two or three axes, its first node at `origin`; no node is held."""
    n = [count + 1 for count in cells] + [1] * (3 - len(cells))
    tiles, tile_doubles = [tile_count(count) for count in n], TILE ** len(cells) * NODE
    across = (tiles[1] * tiles[2], tiles[2], 1)  # stride between tiles along each axis, in tiles
    within = (TILE * TILE, TILE, 1) if len(cells) == 3 else (TILE, 1, 0)  # stride inside a tile, in nodes
    ax, ay, az = (
        (np.arange(n[k]) // TILE) * (across[k] * tile_doubles) + (np.arange(n[k]) % TILE) * (within[k] * NODE)
        for k in range(3)
    )
    size = tiles[0] * across[0] * tile_doubles
    fixed = np.zeros(size // NODE, dtype=np.uint8)
    x, y, z = (*(float(x) for x in origin), 0.0)[:3]
    return Grid(aligned_zeros(size), fixed, ax, ay, az, x, y, z, float(h), n[0], n[1], n[2], tile_doubles)


def node_coordinates(grid: Grid) -> tuple[np.ndarray, ...]:
    """Coordinates of the nodes along each axis, m; the arrays broadcast to (n_x, n_y[, n_z])."""
    first = (grid.origin_x, grid.origin_y, grid.origin_z)
    axes = [x + grid.h * np.arange(n) for x, n in zip(first, grid_shape(grid), strict=False)]
    return tuple(np.meshgrid(*axes, indexing="ij", sparse=True))


def node_records(grid: Grid) -> np.ndarray:
    """Copy of the records of all nodes (n_x, n_y[, n_z], 8)."""
    blocks = node_blocks(grid, grid.nodes.reshape(-1, NODE))
    return blocks.reshape(*padded_shape(grid), NODE)[tuple(slice(n) for n in grid_shape(grid))]


def grid_shape(grid: Grid) -> tuple[int, ...]:
    """Nodes along each axis."""
    return (grid.n_x, grid.n_y, grid.n_z) if grid.n_z > 1 else (grid.n_x, grid.n_y)


def padded_shape(grid: Grid) -> tuple[int, ...]:
    """Nodes along each axis, including those that fill up the last tiles."""
    return tuple(tile_count(n) * TILE for n in grid_shape(grid))


def node_blocks(grid: Grid, flat: np.ndarray) -> np.ndarray:
    """A view of an array of addresses as (tiles_x, 4, tiles_y, 4[, tiles_z, 4], ...)."""
    tiles = [tile_count(n) for n in grid_shape(grid)]
    d = len(tiles)
    axes = [axis for k in range(d) for axis in (k, d + k)]
    blocks = flat.reshape(*tiles, *d * (TILE,), *flat.shape[1:])
    return blocks.transpose(*axes, *range(2 * d, blocks.ndim))
