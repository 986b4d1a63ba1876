"""A smooth slope on which an elastic block slides: gravity that is turned, or steps of cells in a grid that is not."""

from __future__ import annotations

from math import atan, cos, degrees, sin

import numpy as np

from mpmcol.failure_modes.toolkit import PLAIN, G, advance_to, elastic_body, lattice, make_solver, points_at
from mpmcol.mpm.boundary import CONTACT, Boundary, apply_boundaries, face
from mpmcol.mpm.contact import make_contacts
from mpmcol.mpm.grid import Grid, allocate_grid, grid_shape
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.wall_cells import with_walls

H, TREAD, STEPS = 0.05, 4, 10  # m; cells of a step of one cell of height; number of steps
SLOPE = atan(1.0 / TREAD)
SLOPE_DEG = degrees(SLOPE)
LENGTH, HEIGHT = 16 * H, 4 * H  # of the block, m
CELLS = (TREAD * STEPS + 8, STEPS + 14)
END = 0.1  # s: it slides by a cell


def acceleration(with_steps: bool) -> float:
    """Mean acceleration of the block along the slope over g sin(slope), from rest."""
    solver, along = _on_steps() if with_steps else _with_turned_gravity()
    advance_to(solver, END)
    points = solver.points
    speed = np.average(points.v @ along, weights=points.m)
    return float(speed / (G * sin(SLOPE) * solver.time))


def _with_turned_gravity() -> tuple[Solver, np.ndarray]:
    """The grid is aligned with the slope, as with geometry.slope_deg."""
    grid = allocate_grid((0.0, 0.0), H, CELLS)
    block = lattice((4 * H, 0.0), (4 * H + LENGTH, HEIGHT), H / 2)
    gravity = PLAIN._replace(gravity_x=G * sin(SLOPE), gravity_y=-G * cos(SLOPE))
    return _solver(block, grid, [face(grid, CONTACT, 1, 0)], gravity), np.array([1.0, 0.0])


def _on_steps() -> tuple[Solver, np.ndarray]:
    """The grid is aligned with gravity; the block lies on the edges of steps that descend along x."""
    grid = allocate_grid((0.0, 0.0), H, CELLS)
    (columns, rows), (x, y) = _indices(CELLS), _indices(grid_shape(grid))
    tops = STEPS - np.arange(CELLS[0]) // TREAD  # cells below the surface of each column of cells
    inside = np.broadcast_to(rows < np.maximum(tops, 0)[columns], CELLS)
    left, right = (np.pad(np.maximum(tops, 0), pad, mode="edge") for pad in ((1, 0), (0, 1)))  # of each line of nodes
    faces = [
        Boundary(CONTACT, 1, y == np.maximum(left, right)[x], wall=0),
        Boundary(CONTACT, 1, (y == right[x]) & (right < left)[x], wall=0),
        Boundary(CONTACT, 0, (y >= right[x]) & (y <= left[x]) & (right < left)[x], wall=0),
    ]
    along, up = np.array([cos(SLOPE), -sin(SLOPE)]), np.array([sin(SLOPE), cos(SLOPE)])
    edge = np.array([TREAD * H, STEPS * H])  # of the first step
    block = lattice((0.0, 0.0), (LENGTH, HEIGHT), H / 2)
    placed = edge + block[:, :1] * along + block[:, 1:] * up
    return _solver(placed, with_walls(grid, inside), faces, PLAIN), along


def _indices(shape: tuple[int, ...]) -> tuple[np.ndarray, ...]:
    return tuple(np.indices(shape, sparse=True))


def _solver(block: np.ndarray, grid: Grid, faces: list[Boundary], settings: Settings) -> Solver:
    walls = [each._replace(wall=0) for each in faces]
    apply_boundaries(grid, walls)
    solver = make_solver(points_at(block, H / 2), grid, settings, body=elastic_body())
    solver.contacts = make_contacts(grid, walls)
    return solver
