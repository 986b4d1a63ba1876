"""Separating sand: layers that are thrown apart and settle again."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import PLAIN, advance_to, by_id, lattice, make_solver, points_at, walled_grid
from mpmcol.mpm.boundary import hold_components
from mpmcol.mpm.grid import node_coordinates
from mpmcol.mpm.particles import COLUMN, Points
from mpmcol.mpm.solver import Solver

H = 0.02


def solver_in_box(points: Points, width: int, opening_strain: bool) -> Solver:
    """A solver for sand in a smooth box, `width` cells wide."""
    grid = walled_grid((0.0, 0.0), H, (width + 6, 100))
    x, y = node_coordinates(grid)
    hold_components(grid, (x < 0.5 * H) | (x > (width - 0.5) * H), y < 0.5 * H)
    return make_solver(points, grid, PLAIN._replace(alpha_d=0.1, opening_strain=opening_strain))


class Deposit(NamedTuple):
    """State of the settled layers, and the history of their area."""

    height: float  # of the layers of points, over the initial height
    area: float  # sum of V over the initial sum
    gross_area: float  # area including the gaps represented by the opening strain
    largest_J: float
    largest_opening: float  # largest opening strain of the history
    times: np.ndarray  # s
    areas: np.ndarray  # at these times


@cache
def stacked_layers(opening_strain: bool, layers: int = 16, width: int = 4) -> Deposit:
    """A stack whose layers are thrown apart vertically, fall, and settle on the floor."""
    x = lattice((0.0, 4 * H), (width * H, (4 + layers) * H), H / 2)
    points = points_at(x, H / 2, kind=COLUMN)
    points.v[:, 1] = 6.0 * (x[:, 1] - x[:, 1].mean())
    solver, largest_opening = solver_in_box(points, width, opening_strain), 0.0
    start = points.V0.sum()
    times, areas = 0.03 * np.arange(1, 51), []
    for time in times:
        advance_to(solver, time)
        largest_opening = max(largest_opening, solver.points.opening.max())
        areas.append(solver.points.V.sum() / start)
    last = by_id(solver)
    height = np.ptp(last.x[:, 1]) / np.ptp(x[:, 1])
    gross = last.V @ (1.0 + last.opening) / start
    return Deposit(height, areas[-1], gross, last.J.max(), largest_opening, times, np.array(areas))
