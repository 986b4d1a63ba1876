"""An elastic column at rest under its own weight between rollers, whose stress is known exactly."""

from __future__ import annotations

from functools import cache

import numpy as np

from mpmcol.failure_modes.toolkit import (
    DENSITY,
    PLAIN,
    G,
    advance_to,
    by_id,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.kernels.loop import L_UNBALANCED
from mpmcol.mpm.particles import Points
from mpmcol.mpm.settings import PAPER, Scheme, Settings

HEIGHT = 1.0
WEIGHT = DENSITY * G * HEIGHT
DAMPED = PLAIN._replace(alpha_d=0.5)


@cache
def settled_column(
    cells: int, d: int, scheme: Scheme = PAPER, young: float = 1e8, settings: Settings = DAMPED, per_axis: int = 2
) -> tuple[Points, np.ndarray, float]:
    """Points of an elastic column at rest, their initial heights, and the unbalanced force over the weight.

    per_axis: points along each edge of a cell.
    """
    h, spacing, body = HEIGHT / cells, HEIGHT / cells / per_axis, elastic_body(youngs_modulus=young)
    wide = 3 if scheme.basis == "cubic" else 2
    x = lattice((0.0,) * d, (wide * h, HEIGHT, wide * h)[:d], spacing)
    grid = walled_grid((0.0,) * d, h, (wide, cells + 3, wide)[:d], rollers="left right bottom back front")
    solver = make_solver(points_at(x, spacing), grid, settings, body=body, scheme=scheme)
    advance_to(solver, 30.0 * 4.0 * HEIGHT / np.sqrt(body.wave_speed2))
    return by_id(solver), x[:, 1], float(solver.ledger[L_UNBALANCED])


def exact_stress(initial_height: np.ndarray) -> np.ndarray:
    """-rho0 g (H - Z) with the initial height Z; also exact at finite strain."""
    return -DENSITY * G * (HEIGHT - initial_height)


def stress_error(points: Points, initial_height: np.ndarray) -> float:
    """Mean absolute stress error, sum |s_p - s_exact| V_p / (rho g H V)."""
    error = np.abs(points.sigma[:, 1] - exact_stress(initial_height))
    return float(error @ points.V / (WEIGHT * points.V.sum()))
