"""A grid that is periodic along x, for layers of infinite length.

The address table of the grid repeats every PERIOD nodes: points outside the first period act on its nodes. Tiles with
the same nodes have the same colour, so this requires one thread.
"""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.boundary import hold_components
from mpmcol.mpm.grid import TILE, Grid, allocate_grid, node_coordinates, tile_count
from mpmcol.mpm.solver import Solver

PERIOD = 8  # cells


def periodic_grid(spacing: float, cells_up: int, periods: int = 40) -> Grid:
    """A grid with a no-slip floor; periods: its length, in which the points stay."""
    grid = allocate_grid((0.0, 0.0), spacing, (periods * PERIOD, cells_up))
    grid.ax[:] = grid.ax[np.arange(grid.n_x) % PERIOD]
    _, y = node_coordinates(grid)
    floor = y < 0.5 * spacing
    hold_components(grid, floor, floor)
    return grid


class PeriodicSolver(Solver):
    """Solver that clears and updates each tile once, though points of several periods act on it."""

    def sort(self) -> None:
        super().sort()
        assert self.tiles is not None
        x, y = np.divmod(self.tiles.active // self.grid.tile_doubles, tile_count(self.grid.n_y))
        self.set_tiles(self.tiles._replace(active=np.unique(self.grid.ax[TILE * x] + self.grid.ay[TILE * y])))
