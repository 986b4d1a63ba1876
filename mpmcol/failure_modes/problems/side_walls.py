"""A block that slides slowly between the side walls of a channel, which press on it."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from mpmcol.failure_modes.toolkit import (
    DENSITY,
    WEIGHTLESS,
    advance_steps,
    elastic_body,
    lattice,
    make_solver,
    points_at,
)
from mpmcol.mpm.grid import allocate_grid
from mpmcol.mpm.particles import BASE, COLUMN
from mpmcol.mpm.solver import Solver

H, WIDTH, PRESSURE, MU = 0.1, 0.2, 1e4, 0.4  # m, m, Pa
DECELERATION = 2.0 * MU * PRESSURE / (WIDTH * DENSITY)  # m/s2
STOP_STEPS = 10.5  # steps in which the block stops: the last step has less momentum than the impulse of a whole one
STEPS = 40


class Slide(NamedTuple):
    """The block after STEPS steps, and at half the time of its stop."""

    speed: float  # largest, over the initial one
    deceleration: float  # mean, m/s2


@cache
def slide(limited: bool) -> Slide:
    """Let the block slide until it should have stopped; `limited`: by an impulse that at most stops each point."""
    solver = _block(limited)
    dt = solver.dt
    start = STOP_STEPS * DECELERATION * dt
    solver.points.v[:, 0] = start
    deceleration = 0.0
    for step in range(STEPS):
        advance_steps(solver, 1)
        if not limited:
            solver.points.v[:, 0] -= DECELERATION * dt * np.sign(solver.points.v[:, 0])
        if step + 1 == STOP_STEPS // 2:
            deceleration = (start - float(solver.points.v[:, 0].mean())) / solver.time
    return Slide(float(np.abs(solver.points.v).max()) / start, deceleration)


def _block(limited: bool) -> Solver:
    """A weightless block with a stress across the channel only, which moves without deformation."""
    points = points_at(lattice((0.4, 0.3), (0.8, 0.7), H / 2), H / 2, kind=COLUMN)
    stress = np.zeros((len(points), 6))
    stress[:, 2] = -PRESSURE
    points.sigma = stress
    solver = make_solver(points, allocate_grid((0.0, 0.0), H, (20, 12)), WEIGHTLESS, body=elastic_body())
    solver.bodies = (solver.bodies[BASE], solver.bodies[BASE])  # an elastic one of kind COLUMN, which side walls slow
    if limited:
        solver.contacts = solver.contacts._replace(side_friction=2.0 * MU / WIDTH)
    return solver
