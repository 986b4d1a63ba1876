"""Quadrature error of irregularly placed material points."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.scenario import Scenario, Theory, failing, passing
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    WEIGHTLESS,
    advance_steps,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.grid import node_records

H, CELLS, PRESSURE = 0.1, 20, 1e4
JITTER = 0.3  # largest displacement from the lattice over the point spacing, as after a flow
SHORT = 1e-3  # cfl: a step without motion
FIRST_ORDER = "derived here: first order in the displacement from the lattice (README.md, quadrature error)"


def spurious_acceleration(per_axis: int) -> float:
    """Rms nodal acceleration under a uniform pressure, exactly zero, over p / (rho h)."""
    spacing, length = H / per_axis, CELLS * H
    x = lattice((0.0, 0.0), (length, length), spacing)
    points = points_at(x + spacing * np.random.default_rng(3).uniform(-JITTER, JITTER, x.shape), spacing)
    points.sigma = np.broadcast_to(-PRESSURE * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]), (len(x), 6))
    grid = walled_grid((0.0, 0.0), H, (CELLS, CELLS), rollers="left right bottom top")
    solver = make_solver(points, grid, WEIGHTLESS._replace(cfl=SHORT))
    advance_steps(solver, 1)
    inner = node_records(grid)[3:-3, 3:-3, 4:6]
    return float(np.sqrt(np.mean(inner**2)) * DENSITY * H / PRESSURE)


def expected_acceleration(points_per_cell: int) -> float:
    """The same to first order in the displacement from the lattice; see README.md, quadrature error."""
    return float(np.sqrt(43.0 / 30.0) * JITTER / points_per_cell)


SCENARIOS = (
    Scenario(
        name="points-per-cell",
        mechanism="Material points that a flow has displaced from their lattice are a poor quadrature: a uniform "
        "stress accelerates the nodes.",
        metric="rms of the spurious nodal acceleration, over sigma / (rho h)",
        bound=0.2,
        source="chosen here, between one and four points per cell; Steffen et al. 2008, doi:10.1002/nme.2360, on "
        "quadrature errors",
        remedy="grid.points_per_cell = 4 in 2D (default), 8 in 3D",
        trials=(
            failing("1 point per cell", partial(spurious_acceleration, 1)),
            passing("4 points per cell", partial(spurious_acceleration, 2), default=True),
            passing("9 points per cell", partial(spurious_acceleration, 3)),
        ),
        theory=tuple(
            Theory(
                f"{per_axis**2} points per cell: spurious acceleration",
                expected_acceleration(per_axis**2),
                partial(spurious_acceleration, per_axis),
                FIRST_ORDER,
            )
            for per_axis in (2, 3)
        ),
    ),
)
