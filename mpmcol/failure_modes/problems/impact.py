"""A thin sheet thrown onto a plate with Coulomb friction, and the impulses of the impact."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import WEIGHTLESS, advance_steps, elastic_body, lattice, make_solver, points_at
from mpmcol.mpm.boundary import CONTACT, apply_boundaries, face
from mpmcol.mpm.contact import make_contacts, wall_impulses
from mpmcol.mpm.grid import allocate_grid, node_records
from mpmcol.mpm.lanes import AY, VY, M
from mpmcol.mpm.solver import Solver

H, LENGTH, MU = 0.1, 0.4, 0.3  # m, m
SPEED = (10.0, -2.0)  # m/s: it slides during the whole impact
STEPS = 600  # until it has left the plate


class Impact(NamedTuple):
    """Impulses on the plate, N s/m."""

    tangential: float  # of friction
    normal: float
    of_acceleration: float  # the part of the normal impulse that is left if the momentum of the nodes is ignored


@cache
def impact(rows: int) -> Impact:
    """Throw a sheet of so many rows of points, without weight, and add up the impulses until it has rebounded."""
    solver, of_acceleration = _thrown_sheet(rows), 0.0
    previous = wall_impulses(solver.contacts, 1)[0, 1]
    for _ in range(STEPS):
        dt = solver.dt
        advance_steps(solver, 1)
        total = wall_impulses(solver.contacts, 1)[0, 1]
        of_acceleration += _without_momentum(solver, dt, total - previous)
        previous = total
    assert solver.points.v[:, 1].min() > 0.0, "the sheet is still on the plate"
    x, y, _ = wall_impulses(solver.contacts, 1)[0]
    return Impact(float(x), float(-y), float(of_acceleration))


def _without_momentum(solver: Solver, dt: float, impulse: float) -> float:
    """Normal impulse of the forces in a step: without the momentum of the nodes that move into the plate."""
    nodes = node_records(solver.grid)[:, 0]
    before = nodes[:, VY] - dt * nodes[:, AY]
    pressed = (nodes[:, M] > 0.0) & (nodes[:, VY] == 0.0)
    return float(-impulse - np.sum(nodes[pressed, M] * np.maximum(-before[pressed], 0.0)))


def _thrown_sheet(rows: int) -> Solver:
    points = points_at(lattice((1.0, 2 * H), (1.0 + LENGTH, 2 * H + rows * H / 2), H / 2), H / 2)
    points.v[:] = SPEED
    grid = allocate_grid((0.0, 0.0), H, (60, 20))
    floor = face(grid, CONTACT, 1, 0)._replace(wall=0, friction=MU)
    apply_boundaries(grid, [floor])
    solver = make_solver(points, grid, WEIGHTLESS, body=elastic_body())
    solver.contacts = make_contacts(grid, [floor])
    return solver
