"""A single elastic point on the kernels: the largest stable time step (theory: `mpmcol.setup.stability_limit`)."""

from __future__ import annotations

import numpy as np

from mpmcol.errors import NumericalFailure
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    SIDES,
    WEIGHTLESS,
    E,
    advance_steps,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.settings import Scheme
from mpmcol.setup.stability_limit import NODES, SMOOTH, STICKING, TRANSFERS, LonePoint, one_point_bound

CELLS = NODES - 1
STEPS = 200
AMPLITUDE = 1e-9  # of the first strain: all stays linear
GROWN = 10.0  # a mode 1 % above its bound grows by e^0.28 a step; within it nothing grows tenfold


def growth(point: LonePoint, cfl: float, neighbours: int = 0) -> float:
    """Largest stress after STEPS steps over that at the start, infinite if the solver gives up.

    neighbours: points in line with it along each axis, half a cell apart: a body, which theory leaves out.
    """
    d = len(point.place)
    away = lattice((0.0,) * d, (0.5 * (1 + neighbours),) * d, 0.5) - 0.25
    x = np.array([point.place]) + away
    points = points_at(x, 0.5, density=DENSITY, axisymmetric=point.axisymmetric)
    body = elastic_body(DENSITY, E, point.nu)
    modulus = body.wave_speed2 * DENSITY
    start = AMPLITUDE * modulus * np.random.default_rng(5).uniform(0.5, 1.0, (len(x), 6))
    points.sigma = start
    low = {kind: " ".join(s[0] for s, w in zip(SIDES, point.walls, strict=False) if w == kind) for kind in point.walls}
    grid = walled_grid((0.0,) * d, 1.0, (CELLS,) * d, low.get(SMOOTH, ""), low.get(STICKING, ""))
    taylor, flip = TRANSFERS[point.transfer]
    settings = WEIGHTLESS._replace(
        cfl=cfl, axisymmetric=point.axisymmetric, axis_gap=0.0, taylor=taylor, kernel_correction=point.correction,
        flip_fraction=flip * point.flip_fraction,
    )  # fmt: skip
    solver = make_solver(
        points, grid, settings, body=body, scheme=Scheme(affine=point.transfer == "apic", basis=point.basis)
    )
    try:
        advance_steps(solver, STEPS)
    except NumericalFailure:
        return float("inf")
    return float(np.abs(solver.points.sigma).max() / np.abs(start).max())


def largest_stable_step(point: LonePoint) -> float:
    """Bisection for the largest stable dt c / h on the kernels, within half a per cent of itself."""
    low, high = 0.5 * one_point_bound(point), 1.5 * one_point_bound(point)
    while high - low > 0.005 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if growth(point, middle) < GROWN else (low, middle)
    return 0.5 * (low + high)
