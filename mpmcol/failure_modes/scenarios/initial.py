"""Stress at the start that the sand cannot bear."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.scenario import Scene, Theory, Trial
from mpmcol.failure_modes.toolkit import (
    K_ACTIVE,
    NU,
    WEIGHTLESS,
    advance_steps,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.particles import COLUMN

H, LOAD = 0.1, 1e4  # m, Pa


def lost_at_once(ratio: float) -> float:
    """Share of the vertical stress that a first step without motion takes from sand of this horizontal one."""
    points = points_at(lattice((0.0, 0.0), (4 * H, 4 * H), H / 2), H / 2, COLUMN)
    points.sigma = np.broadcast_to(-LOAD * np.array([ratio, 1.0, ratio, 0.0, 0.0, 0.0]), (len(points), 6))
    grid = walled_grid((0.0, 0.0), H, (8, 8), rollers="left bottom")
    solver = make_solver(points, grid, WEIGHTLESS._replace(cfl=1e-6))  # too short a step for any strain
    advance_steps(solver, 1)
    inner = np.all(solver.points.x < 2 * H, axis=1)
    return float(1.0 + solver.points.sigma[inner, 1].mean() / LOAD)


SCENES = (
    Scene(
        name="initial-stress",
        mechanism="A column brought to rest as elastic gets the sand's strength at the release: what it cannot bear "
        "is gone "
        "within one step, and the column drops.",
        sign="share of the vertical stress lost in the first step",
        unit="",
        bound=0.01,
        source="equilibrium before the release",
        remedy="stages.equilibrate.law = the sand's own, the default, or initial_stress = k0 with K between K_a and 1 "
        "/ K_a",
        trials=(
            Trial("elastic, free-standing: K = 0", False, partial(lost_at_once, 0.0)),
            Trial("elastic behind the gate: K = nu / (1 - nu)", False, partial(lost_at_once, NU / (1.0 - NU))),
            Trial("the sand's own law: K = K_a", True, partial(lost_at_once, K_ACTIVE), default=True),
        ),
        theory=(
            Theory("lost by diag(0, -1, 0)", 0.371, partial(lost_at_once, 0.0), "return at constant p (physics 0, 8)"),
        ),
    ),
)
