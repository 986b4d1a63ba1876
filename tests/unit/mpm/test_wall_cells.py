"""Masks of cells beside walls, and the marks of nodes from which a stencil may be near a wall."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.mpm.grid import NODE, TILE, Grid, allocate_grid, grid_shape
from mpmcol.mpm.kernels.transfer_common import grid_coordinates
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import vector
from mpmcol.mpm.wall_cells import AROUND_WALL, IN_WALL, NEAR_WALL, with_walls

CELLS, H = (14, 11, 12), 0.5
BOXES = {  # first and last cell along each axis, exclusive
    "inside": ((5, 0, 4), (7, 4, 7)),
    "end wall": ((11, 0, 0), (14, 11, 12)),
    "at the far corner": ((10, 0, 9), (14, 3, 12)),
}
DIMENSIONS = pytest.mark.parametrize("d", [2, 3])


def masks(d: int, box: str) -> tuple[Grid, np.ndarray, np.ndarray]:
    """A grid with a box, its cells inside, and the masks of its cells (n_x - 1, n_y - 1[, n_z - 1])."""
    grid = allocate_grid((0.0,) * d, H, CELLS[:d])
    inside = np.zeros(CELLS[:d], bool)
    inside[tuple(slice(first, last) for first, last in zip(*BOXES[box], strict=True))[:d]] = True
    grid = with_walls(grid, inside)
    address = (grid.ax[:, None, None] + grid.ay[:, None] + grid.az).reshape(grid_shape(grid)) // NODE
    assert grid.wall_cells is not None
    return grid, inside, grid.wall_cells[address][(slice(-1),) * d]


def beside(inside: np.ndarray, cell: tuple[int, ...]) -> bool:
    """Whether a cell is in a wall, or touches one in a face, an edge or a corner."""
    return bool(inside[tuple(slice(max(i - 1, 0), i + 2) for i in cell)].any())


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("basis", SHAPE_FUNCTIONS)
@DIMENSIONS
def test_the_first_node_of_every_stencil_beside_a_wall_is_marked(d: int, basis: str, box: str) -> None:
    grid, inside, mask = masks(d, box)
    for s in np.random.default_rng(1).uniform(0.0, CELLS[:d], (1500, d)):
        x = vector(*(0.0,) * 4, *(H * np.append(s, 0.0)[:3]), 0.0)
        base, *_ = SHAPE_FUNCTIONS[basis].evaluate(*grid_coordinates(x, grid), True)
        first = tuple(int(base[4 + axis]) for axis in range(d))
        if beside(inside, tuple(s.astype(int))):
            assert mask[first] & NEAR_WALL


@DIMENSIONS
def test_nodes_away_from_walls_are_not_marked(d: int) -> None:
    """A mark before a wall is at most two cells from it; one behind a wall, at most one."""
    _, inside, mask = masks(d, "inside")
    for cell in np.ndindex(*inside.shape):
        near = inside[tuple(slice(max(i - 1, 0), i + 3) for i in cell)].any()
        assert bool(mask[cell] & NEAR_WALL) == near


@DIMENSIONS
def test_faces_of_cells_are_those_on_walls(d: int) -> None:
    _, inside, mask = masks(d, "inside")
    np.testing.assert_array_equal(mask & IN_WALL > 0, inside)
    for cell in np.ndindex(*inside.shape):
        for axis, side in np.ndindex(d, 2):
            other = np.array(cell) + (2 * side - 1) * (np.arange(d) == axis)
            exists = (other >= 0).all() and (other < inside.shape).all()
            expected = exists and inside[tuple(other)] and not inside[cell]
            assert bool(mask[cell] & 1 << (2 * axis + side)) == bool(expected)


@pytest.mark.parametrize("box", BOXES)
@DIMENSIONS
def test_where_a_point_of_a_tile_may_be_near_a_wall_the_first_nodes_of_all_say_so(d: int, box: str) -> None:
    """Sorted first nodes of a tile are TILE - 1 apart at most, and two points may each have moved by one node since."""
    _, _, mask = masks(d, box)
    apart = TILE - 1 + 2
    for cell in np.ndindex(*mask.shape):
        around = mask[tuple(slice(max(i - apart, 0), i + apart + 1) for i in cell)]
        assert bool(mask[cell] & AROUND_WALL) == bool((around & NEAR_WALL).any())
