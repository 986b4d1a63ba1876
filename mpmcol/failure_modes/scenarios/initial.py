"""Initial stress outside the yield surface."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.scenario import Scenario, Theory, failing, passing
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


def lost_stress(ratio: float) -> float:
    """Fraction of the vertical stress lost in the first step, without motion, if sigma_h = ratio * sigma_v."""
    points = points_at(lattice((0.0, 0.0), (4 * H, 4 * H), H / 2), H / 2, COLUMN)
    points.sigma = np.broadcast_to(-LOAD * np.array([ratio, 1.0, ratio, 0.0, 0.0, 0.0]), (len(points), 6))
    grid = walled_grid((0.0, 0.0), H, (8, 8), rollers="left bottom")
    solver = make_solver(points, grid, WEIGHTLESS._replace(cfl=1e-6))  # a step too short for any strain
    advance_steps(solver, 1)
    inner = np.all(solver.points.x < 2 * H, axis=1)
    return float(1.0 + solver.points.sigma[inner, 1].mean() / LOAD)


SCENARIOS = (
    Scenario(
        name="initial-stress",
        mechanism="A column brought to equilibrium as elastic receives the strength of sand at release: the stress "
        "outside the yield surface is lost within one step, and the column drops.",
        metric="fraction of the vertical stress lost in the first step",
        bound=0.01,
        source="chosen here: 1 %; in equilibrium no stress is lost",
        remedy="stages.equilibrate.law = the law of the column (default), or initial_stress = k0 with K between K_a "
        "and 1 / K_a",
        trials=(
            failing("elastic, free-standing: K = 0", partial(lost_stress, 0.0)),
            failing("elastic behind the gate: K = nu / (1 - nu)", partial(lost_stress, NU / (1.0 - NU))),
            passing("mohr-coulomb: K = K_a", partial(lost_stress, K_ACTIVE), default=True),
        ),
        theory=(
            Theory(
                "fraction lost by diag(0, -1, 0)",
                2.0 * K_ACTIVE / (1.0 + 2.0 * K_ACTIVE),
                partial(lost_stress, 0.0),
                "derived here: return at constant mean stress, 2 K_a / (1 + 2 K_a) (README.md, initial stress)",
            ),
        ),
    ),
)
