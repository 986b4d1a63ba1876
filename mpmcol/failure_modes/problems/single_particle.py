"""Stability of a single elastic particle in the solver; the theory is in `mpmcol.setup.stability_limit`."""

from __future__ import annotations

import numpy as np

from mpmcol.errors import NumericalFailure
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    WEIGHTLESS,
    E,
    advance_steps,
    elastic_body,
    lattice,
    make_solver,
    points_at,
)
from mpmcol.mpm.boundary import apply_boundaries, face
from mpmcol.mpm.grid import allocate_grid
from mpmcol.mpm.settings import Scheme
from mpmcol.setup.stability_limit import NODES, TRANSFER_COEFFICIENTS, SingleParticle, single_particle_limit

CELLS = NODES - 1
STEPS = 200
AMPLITUDE = 1e-9  # initial strain, so small that the response is linear
GROWN = 10.0  # a mode 1 % above its limit grows by e^0.28 per step; below the limit no mode grows tenfold


def growth(point: SingleParticle, cfl: float, neighbours: int = 0) -> float:
    """Largest stress after STEPS steps over the initial stress; infinite if the solver stops.

    neighbours: further points along each axis, half a cell apart; they form a body, which the theory omits.
    """
    d = len(point.position)
    offsets = lattice((0.0,) * d, (0.5 * (1 + neighbours),) * d, 0.5) - 0.25
    x = np.array([point.position]) + offsets
    points = points_at(x, 0.5, density=DENSITY, axisymmetric=point.axisymmetric)
    body = elastic_body(DENSITY, E, point.nu)
    modulus = body.wave_speed2 * DENSITY
    start = AMPLITUDE * modulus * np.random.default_rng(5).uniform(0.5, 1.0, (len(x), 6))
    points.sigma = start
    grid = allocate_grid((0.0,) * d, 1.0, (CELLS,) * d)
    apply_boundaries(grid, (face(grid, kind, axis, 0) for axis, kind in enumerate(point.faces)))
    taylor, flip = TRANSFER_COEFFICIENTS[point.transfer]
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


def largest_stable_step(point: SingleParticle) -> float:
    """Largest stable dt c_p / h by bisection in the solver, to 0.5 %."""
    low, high = 0.5 * single_particle_limit(point), 1.5 * single_particle_limit(point)
    while high - low > 0.005 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if growth(point, middle) < GROWN else (low, middle)
    return 0.5 * (low + high)
