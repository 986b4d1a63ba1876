"""Sorting of points by tile, kind and cell; groups of tiles without common nodes; active tiles."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mpmcol.mpm.grid import NODE, TILE, Grid, Tiles, allocate_grid, no_tiles, share_tiles, tile_count
from mpmcol.mpm.kernels.sort import BAND, sort_buffers, sort_points
from mpmcol.mpm.lanes import ID, RECORD_SIZE
from mpmcol.mpm.particles import COLUMN, Points
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.shape_functions.quadratic import base_node

H, ORIGIN = 0.1, (-0.55, -0.2, 0.3)
CELLS = {2: (45, 30), 3: (33, 25, 27)}
DIMENSIONS = pytest.mark.parametrize("d", [2, 3])


def mixed_points(d: int, seed: int = 1) -> Points:
    """Points in a part of the grid, some at walls, in random order; every record has unique values."""
    rng = np.random.default_rng(seed)
    points = Points({2: 700, 3: 3000}[d], d)
    points.rows[:] = rng.normal(size=points.rows.shape)
    points.x[:] = ORIGIN[:d] + H * rng.uniform(0.0, 0.6 * np.array(CELLS[d]), points.x.shape)
    points.x[:30, 0], points.x[30:60, d - 1] = ORIGIN[0] + 1e-9, ORIGIN[d - 1] + H * CELLS[d][d - 1] - 1e-9
    points.kind[:] = rng.uniform(size=len(points)) < 0.4
    points.rows[:, ID] = rng.permutation(len(points))
    return points


def first_nodes(points: Points, grid: Grid) -> np.ndarray:
    """First node (n, 3) of each point's stencil."""
    counts, first = (grid.n_x, grid.n_y, grid.n_z), np.zeros((len(points), 3), int)
    for axis in range(points.dimension):
        cells = (points.x[:, axis] - ORIGIN[axis]) / H
        first[:, axis] = [base_node(s, counts[axis]) for s in cells]
    return first


def sorted_points(d: int) -> tuple[Points, Points, Grid, Tiles]:
    """Points before and after the sort, on their grid."""
    before, grid = mixed_points(d), allocate_grid(ORIGIN[:d], H, CELLS[d])
    after, zeros = Points(len(before), d), sort_buffers(grid)
    after.rows[:] = before.rows
    tiles = Tiles(*sort_points(after.rows.reshape(-1), RECORD_SIZE[d], grid, *zeros, 0, 1))
    assert not any(np.any(each) for each in zeros)
    return before, after, grid, tiles


@DIMENSIONS
def test_sorting_keeps_every_record(d: int) -> None:
    before, after, _, _ = sorted_points(d)
    assert sorted(after.id) == list(range(len(after)))
    np.testing.assert_array_equal(after.rows[np.argsort(after.id)], before.rows[np.argsort(before.id)])


@DIMENSIONS
def test_points_are_sorted_by_tile_kind_and_cell(d: int) -> None:
    _, after, grid, tiles = sorted_points(d)
    node = first_nodes(after, grid)
    tile = node // TILE
    assert tiles.start[0] == 0 and tiles.start[-1] == len(after)
    own = [tuple(tile[first]) for first in tiles.start[:-1]]
    assert own == sorted(set(map(tuple, tile)))
    for t, (first, split, stop) in enumerate(zip(tiles.start, tiles.split, tiles.start[1:], strict=False)):
        assert first < stop and {tuple(each) for each in tile[first:stop]} == {own[t]}
        assert np.all(after.kind[first:split] == COLUMN) and np.all(after.kind[split:stop] != COLUMN)
        for part in (slice(first, split), slice(split, stop)):
            cells = [tuple(each) for each in node[part]]
            assert cells == sorted(cells)
            assert [cells.index(cell) for cell in cells] == [
                list(tiles.cells[part]).index(c) for c in tiles.cells[part]
            ]
        assert not set(tiles.cells[first:split]) & set(tiles.cells[split:stop])


def stencils(points: Points, grid: Grid, basis: str) -> np.ndarray:
    """First node (n, 3) of each point's stencil for these shape functions."""
    counts, first = (grid.n_x, grid.n_y, grid.n_z), np.zeros((len(points), 3), int)
    for axis in range(points.dimension):
        cells = (points.x[:, [axis]] - ORIGIN[axis]) / H
        first[:, axis] = SHAPE_FUNCTIONS[basis].evaluate(cells, 0.5, counts[axis] - 1.5, True)[0][:, 0]
    return first


def touched(points: Points, grid: Grid, seed: int, basis: str = "quadratic", travel: float | None = None) -> np.ndarray:
    """Addresses (n, width ** d) of the nodes of all stencils, each point moved by less than `travel` cells an axis."""
    d, moved, travel = (
        points.dimension,
        Points(len(points), points.dimension),
        travel or SHAPE_FUNCTIONS[basis].TRAVEL_LIMIT,
    )
    step = travel * np.random.default_rng(seed).choice([-0.999, -0.5, 0.0, 0.5, 0.999], points.x.shape)
    low, high = np.array(ORIGIN[:d]), np.array(ORIGIN[:d]) + H * np.array(CELLS[d])
    moved.x[:] = np.clip(points.x + H * step, low + 1e-9, high - 1e-9)
    i, j, k = stencils(moved, grid, basis).T
    reach = range(SHAPE_FUNCTIONS[basis].WIDTH)
    columns = [
        grid.ax[i + a] + grid.ay[j + b] + (grid.az[k + c] if d == 3 else 0)
        for a in reach for b in reach for c in (reach if d == 3 else (0,))
    ]  # fmt: skip
    return np.stack(columns, axis=1)


every_basis = pytest.mark.parametrize("basis", list(SHAPE_FUNCTIONS))


@DIMENSIONS
@every_basis
def test_active_tiles_hold_every_node_that_points_can_reach(basis: str, d: int) -> None:
    _, after, grid, tiles = sorted_points(d)
    assert np.all(np.diff(tiles.active) > 0) and np.all(tiles.active % grid.tile_doubles == 0)
    for seed in range(20):
        reached = np.unique(touched(after, grid, seed, basis) // grid.tile_doubles * grid.tile_doubles)
        assert np.all(np.isin(reached, tiles.active))


@DIMENSIONS
@pytest.mark.parametrize("threads", [1, 2, 3, 16, 500])
def test_threads_share_the_tiles_of_a_group_by_their_points(threads: int, d: int) -> None:
    _, _, _, tiles = sorted_points(d)
    shares, points = share_tiles(tiles, threads), np.diff(tiles.start)[tiles.grouped]
    assert shares.shape == (len(tiles.group_start) - 1, threads + 1)
    for share, (first, stop) in zip(shares, pairwise(tiles.group_start), strict=True):
        assert share[0] == first and share[-1] == stop and np.all(np.diff(share) >= 0)
        found = [points[a:b].sum() for a, b in pairwise(share)]
        mean = points[first:stop].sum() / threads
        assert np.abs(np.array(found) - mean).max() <= points[first:stop].max()


def test_no_tiles_are_shared() -> None:
    assert share_tiles(no_tiles(), 2).shape == (0, 3)


def test_only_tiles_next_to_points_are_active() -> None:
    """A single point activates its own tile and the adjacent ones."""
    for d, expected in ((2, 9), (3, 27)):
        grid, point = allocate_grid((0.0,) * d, H, (40,) * d), Points(1, d)
        point.x[:] = 2.0 * H * TILE + 2.0 * H
        active = Tiles(*sort_points(point.rows.reshape(-1), RECORD_SIZE[d], grid, *sort_buffers(grid), 0, 1)).active
        assert len(active) == expected
        assert grid.ax[8] + grid.ay[8] + (grid.az[8] if d == 3 else 0) in active


def nodes_of_tiles(basis: str, d: int, travel: float | None = None) -> tuple[Tiles, list[set[int]]]:
    """Tiles and the addresses that the points of each can reach."""
    _, after, grid, tiles = sorted_points(d)
    nodes: list[set[int]] = [set() for _ in tiles.split]
    for seed in range(20):
        addresses = touched(after, grid, seed, basis, travel)
        for t in range(len(tiles.split)):
            nodes[t] |= set(np.unique(addresses[tiles.start[t] : tiles.start[t + 1]]).tolist())
    return tiles, nodes


@DIMENSIONS
@every_basis
def test_tiles_of_a_group_have_no_common_node(basis: str, d: int) -> None:
    tiles, nodes = nodes_of_tiles(basis, d)
    assert sorted(tiles.grouped) == list(range(len(tiles.split)))
    assert len(tiles.group_start) == 2**d + 1 and tiles.group_start[-1] == len(tiles.split)
    shared_by_groups = set()
    for first, stop in pairwise(tiles.group_start):
        own = [nodes[t] for t in tiles.grouped[first:stop]]
        assert len(own) > 1
        assert len(set().union(*own)) == sum(map(len, own))
        shared_by_groups |= set().union(*own)
    assert len(shared_by_groups) < sum(map(len, nodes))  # tiles of different groups do share nodes


@DIMENSIONS
def test_cubic_stencils_of_a_group_overlap_if_points_travel_a_whole_cell(d: int) -> None:
    tiles, nodes = nodes_of_tiles("cubic", d, travel=1.0)
    groups = [[nodes[t] for t in tiles.grouped[first:stop]] for first, stop in pairwise(tiles.group_start)]
    assert any(len(set().union(*own)) < sum(map(len, own)) for own in groups)


@DIMENSIONS
def test_many_tiles_are_grouped_in_bands(d: int) -> None:
    """Bands are whole layers of tiles across x, of BAND tiles or more; a group is one colour of one band."""
    tiles_an_axis = {2: 64, 3: 16}[d]
    grid = allocate_grid((0.0,) * d, H, (tiles_an_axis * TILE - 1,) * d)
    axis = H * TILE * (np.arange(tiles_an_axis) + 0.25)
    centres = np.stack(np.meshgrid(*(axis,) * d, indexing="ij"), axis=-1).reshape(-1, d)
    points = Points(len(centres), d)
    points.x[:] = centres
    tiles = Tiles(*sort_points(points.rows.reshape(-1), RECORD_SIZE[d], grid, *sort_buffers(grid), 0, 1))
    position = (points.x / (H * TILE)).astype(int)
    assert sorted(tiles.grouped) == list(range(len(centres)))
    layers = [position[tiles.grouped[first:stop]] for first, stop in pairwise(tiles.group_start)]
    bands = [np.concatenate(layers[k : k + 2**d]) for k in range(0, len(layers), 2**d)]
    assert len(bands) == len(centres) // BAND
    assert all(len(set(map(tuple, group % 2))) == 1 for group in layers)
    spans = [(band[:, 0].min(), band[:, 0].max()) for band in bands]
    assert all(len(band) >= BAND for band in bands)
    assert all(before[1] < after[0] for before, after in pairwise(spans))


@DIMENSIONS
def test_node_addresses_are_unique(d: int) -> None:
    grid = allocate_grid(ORIGIN[:d], H, CELLS[d])
    address = grid.ax[:, None, None] + grid.ay[:, None] + grid.az
    assert len(np.unique(address)) == address.size == grid.n_x * grid.n_y * grid.n_z
    assert address.min() == 0 and address.max() < len(grid.nodes) and np.all(address % NODE == 0)
    tiles = [tile_count(n) for n in (grid.n_x, grid.n_y, grid.n_z)]
    assert len(grid.nodes) == np.prod(tiles) * grid.tile_doubles
