"""Irregular points under a uniform stress: what few points a cell make of it."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.scenario import Scene, Theory, Trial
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
JITTER = 0.3  # of the points' spacing, to each side: what a flow leaves of a lattice
SHORT = 1e-3  # cfl: a step in which nothing moves


def false_acceleration(per_axis: int) -> float:
    """Rms of the nodes' acceleration by a uniform pressure, which is to be zero, over sigma / rho h."""
    spacing, length = H / per_axis, CELLS * H
    x = lattice((0.0, 0.0), (length, length), spacing)
    points = points_at(x + spacing * np.random.default_rng(3).uniform(-JITTER, JITTER, x.shape), spacing)
    points.sigma = np.broadcast_to(-PRESSURE * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]), (len(x), 6))
    grid = walled_grid((0.0, 0.0), H, (CELLS, CELLS), rollers="left right bottom top")
    solver = make_solver(points, grid, WEIGHTLESS._replace(cfl=SHORT))
    advance_steps(solver, 1)
    inner = node_records(grid)[3:-3, 3:-3, 4:6]
    return float(np.sqrt(np.mean(inner**2)) * DENSITY * H / PRESSURE)


def expected(points_per_cell: int) -> float:
    """To first order in the jitter: variances of the points' places times the integral of second derivatives squared.

    Of the quadratic spline the integrals of w''^2, w'^2 and w^2 are 6, 1 and 11/20: 6 * 11/20 + 1 = 43/10.
    """
    return float(np.sqrt(43.0 / 30.0) * JITTER / points_per_cell)


SCENES = (
    Scene(
        name="points-per-cell",
        mechanism="Points that a flow has strewn about are a poor quadrature: a uniform stress pushes the nodes "
        "hither and "
        "thither.",
        sign="rms of the nodes' false acceleration, over sigma / rho h",
        unit="",
        bound=0.2,
        source="between one and four points: the noise falls as 1 / points per cell in the plane",
        remedy="grid.points_per_cell = 4 in two dimensions, the default, 8 in three",
        trials=(
            Trial("1 point per cell", False, partial(false_acceleration, 1)),
            Trial("4 points per cell", True, partial(false_acceleration, 2), default=True),
            Trial("9 points per cell", True, partial(false_acceleration, 3)),
        ),
        theory=(
            Theory(
                "4 points: false acceleration", expected(4), partial(false_acceleration, 2), "first order in the jitter"
            ),
            Theory(
                "9 points: false acceleration", expected(9), partial(false_acceleration, 3), "first order in the jitter"
            ),
        ),
    ),
)
