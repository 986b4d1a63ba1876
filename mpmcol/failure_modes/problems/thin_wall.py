"""A block that hits one side of a wall, while another one touches the other side."""

from __future__ import annotations

import numpy as np

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_to,
    by_id,
    elastic_body,
    joined,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.boundary import CONTACT, ROLLER, Boundary, apply_boundaries
from mpmcol.mpm.contact import make_contacts
from mpmcol.mpm.grid import grid_shape
from mpmcol.mpm.solver import Solver
from mpmcol.mpm.wall_cells import with_walls

H, SIDE, SPEED = 0.1, 0.4, 1.0  # m, m, m/s
CELLS, FACE = (24, 6), 10  # of the grid; node of the wall's face that is hit
END = 0.05  # s


def transmitted_speed(cells: int) -> float:
    """Largest speed of the block behind a wall of so many cells, over that of the one that hits it.

    0 cells: a line of nodes that are held along x. With cells, nodes of both faces have contact without friction.
    """
    low = H * FACE
    hitting = points_at(lattice((low - 0.02 - SIDE, 0.1), (low - 0.02, 0.1 + SIDE), H / 2), H / 2)
    behind = points_at(lattice((low + H * cells, 0.1), (low + H * cells + SIDE, 0.1 + SIDE), H / 2), H / 2)
    hitting.v[:, 0] = SPEED
    solver = make_solver(joined(hitting, behind), walled_grid((0.0, 0.0), H, CELLS), WEIGHTLESS, body=elastic_body())
    _add_wall(solver, cells)
    advance_to(solver, END)
    return float(np.abs(by_id(solver).v[len(hitting) :]).max()) / SPEED


def _add_wall(solver: Solver, cells: int) -> None:
    """A wall over the height of the domain."""
    nodes, columns = np.arange(grid_shape(solver.grid)[0])[:, None], np.arange(CELLS[0])[:, None]
    faces = [Boundary(ROLLER, 0, nodes == FACE, wall=0)]
    if cells:
        inside = np.broadcast_to((columns >= FACE) & (columns < FACE + cells), CELLS)
        solver.grid = with_walls(solver.grid, inside)
        faces = [Boundary(CONTACT, 0, nodes == FACE, 1, wall=0), Boundary(CONTACT, 0, nodes == FACE + cells, 0, wall=0)]
    apply_boundaries(solver.grid, faces)
    solver.contacts = make_contacts(solver.grid, faces)
