"""Cells beside walls that stand in the domain: shape functions and positions of points next to them.

A wall consists of whole cells. Each cell next to one has a mask with the faces that are on walls. There the weights of
nodes inside the wall are distributed as beside the faces of the domain, where this gives the kernel correction: the
value of the node inside the wall is extrapolated, twice that on the wall minus that of the next node, so that a
quadratic spline becomes the linear shape functions of the half cell. Cells that touch a wall in an edge only keep their
splines. Forces and friction of such walls are those of their nodes (`mpmcol.mpm.contact`).

A node from which the stencil of a point in such a cell may start is marked, and so are, with another bit, the nodes
around it: where no wall is near, one mask is looked up for eight points.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from mpmcol.mpm.boundary import keep_within
from mpmcol.mpm.grid import NODE, TILE, Grid, grid_shape, node_blocks, padded_shape
from mpmcol.mpm.jit import device
from mpmcol.mpm.lanes import X, Y, Z
from mpmcol.mpm.simd import extract, splat, vector, where_positive

# bits of a cell: 2 axis + side for a face on a wall, which is below the cell along the axis (side 0) or above it; a
# cell of the wall. Bit of its lowest node: a stencil from this node on may be that of a point beside a wall or an edge
NEAR_WALL, IN_WALL = 0b01000000, 0b10000000
AROUND_WALL = 0b100000000  # the same for the stencils of all points of a tile if that of one of them starts here
# nodes with NEAR_WALL before and behind a cell of a wall: a point is at most one cell from it, and the first node of
# its stencil at most one cell before its cell (two for cubic shape functions in the last cell of the grid, beyond which
# is no wall)
BEFORE, BEHIND = 2, 1
# first nodes of the points of a tile differ by TILE - 1 when sorted, and each moves by one at most until the next sort
APART = TILE + 1


def with_walls(grid: Grid, inside: np.ndarray) -> Grid:
    """The grid with walls in some of its cells, boolean (n_x - 1, n_y - 1[, n_z - 1])."""
    near, padded = _extended(inside, BEFORE, BEHIND), np.pad(inside, 1)
    masks = np.zeros(padded_shape(grid), np.uint16)
    cells = masks[tuple(slice(n - 1) for n in grid_shape(grid))]
    cells[inside] |= IN_WALL
    cells[near] |= NEAR_WALL
    cells[_extended(near, APART, APART)] |= AROUND_WALL
    for axis, side in product(range(inside.ndim), (0, 1)):
        neighbour = np.roll(padded, 1 - 2 * side, axis)[(slice(1, -1),) * inside.ndim]
        cells[neighbour & ~inside] |= 1 << (2 * axis + side)
    flat = np.zeros(len(grid.fixed), np.uint16)
    blocks = node_blocks(grid, flat)
    blocks[:] = masks.reshape(blocks.shape)
    return grid._replace(wall_cells=flat)


def _extended(cells: np.ndarray, before: int, behind: int) -> np.ndarray:
    """`cells` (boolean) and those up to `before` cells before and `behind` cells behind them along all axes."""
    for axis in range(cells.ndim):
        padded = np.pad(cells, [(behind, before) if k == axis else (0, 0) for k in range(cells.ndim)])
        cells = np.any(sliding_window_view(padded, before + behind + 1, axis), axis=-1)
    return cells


@device
def mask_at(wall_cells: np.ndarray, s: Any, grid: Grid) -> int:
    """Mask of the cell at grid coordinates `s`, or of a node."""
    k = int(extract(s, Z)) if grid.n_z > 1 else 0
    return wall_cells[(grid.ax[int(extract(s, X))] + grid.ay[int(extract(s, Y))] + grid.az[k]) // NODE]


@device
def _faces(mask: int, side: int) -> Any:
    """One in the lanes of the axes along which the face of a side of the cell is on a wall."""
    faces = mask >> side
    return vector(0.0, 0.0, 0.0, 0.0, faces & 1, (faces >> 2) & 1, (faces >> 4) & 1, 0.0)


@device
def beside_walls(
    wall_cells: np.ndarray | None, s: Any, base: Any, width: int, correction: bool, grid: Grid
) -> tuple[bool, Any, Any]:
    """Whether a point may be beside a wall, and one in the lanes of the axes along which its stencil has nodes inside.

    s: grid coordinates. base, width: first node of the stencil (as a real number), number of nodes. Returns the axes
    along which the first node is inside, and those along which the last one is. Without `correction` all are used.
    """
    if wall_cells is None:
        return False, base, base
    if not mask_at(wall_cells, base, grid) & NEAR_WALL:
        return False, base, base
    zero = splat(0.0)
    if not correction:
        return True, zero, zero
    mask, first = mask_at(wall_cells, s, grid), s - base  # distance from the first node, in cells
    low = where_positive(first - 1.0, _faces(mask, 0), zero)
    high = where_positive((width - 2) - first, _faces(mask, 1), zero)  # the last node is width - 1 from the first
    return True, low, high


@device
def fold_three(low: Any, high: Any, a: Any, b: Any, c: Any) -> tuple[Any, Any, Any]:
    """Weights (or gradients) of three nodes, of which the first or the last may be inside a wall."""
    outside = low * a + high * c
    return a - outside, b + 2.0 * outside, c - outside


@device
def fold_four(low: Any, high: Any, a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any, Any, Any]:
    """The same for four nodes."""
    first, last = low * a, high * d
    return a - first, b + 2.0 * first - last, c - first + 2.0 * last, d - last


@device
def keep_out_of_walls(wall_cells: np.ndarray | None, near: bool, old: Any, new: Any, gap: float, grid: Grid) -> Any:
    """A vector with position lanes, moved out of walls and `gap` (m) away from those beside the old position.

    near: whether the old position may be beside a wall. A point that would enter a wall over an edge stays in its
    vertical row of cells.
    """
    if wall_cells is None:
        return new
    if not near:
        return new
    origin, inv_h = _coordinates(grid.origin_x, grid.origin_y, grid.origin_z), 1.0 / grid.h
    s = (old - origin) * inv_h
    mask = mask_at(wall_cells, s, grid)
    if mask == 0:
        return new
    flat, inf = grid.n_z == 1, splat(np.inf)
    cell = _coordinates(int(extract(s, X)), int(extract(s, Y)), 0 if flat else int(extract(s, Z)))
    low, high = origin + grid.h * cell + gap, origin + grid.h * (cell + 1.0) - gap
    new = keep_within(new, (where_positive(_faces(mask, 0), low, -inf), where_positive(_faces(mask, 1), high, inf)))
    if mask_at(wall_cells, (new - origin) * inv_h, grid) & IN_WALL:
        horizontal = _coordinates(1.0, 0.0, 0.0 if flat else 1.0)
        new = keep_within(new, (where_positive(horizontal, low, -inf), where_positive(horizontal, high, inf)))
    return new


@device
def _coordinates(x: float, y: float, z: float) -> Any:
    """A vector with x, y, z in the lanes of the coordinates."""
    return vector(0.0, 0.0, 0.0, 0.0, x, y, z, 0.0)
