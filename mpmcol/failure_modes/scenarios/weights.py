"""Cell-crossing noise of linear shape functions, and B-splines truncated at walls."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.column import DAMPED, exact_stress, settled_column, stress_error
from mpmcol.failure_modes.scenario import Observation, Scenario, failing, passing
from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_steps,
    advance_to,
    by_id,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.grid import node_records
from mpmcol.mpm.settings import PAPER, Scheme, Settings

CELLS, SOFT = 10, 3e5  # SOFT, Pa: the column settles by 4 % of its height, or 0.4 cells
FRAME, WAVE = 6.5, 0.5  # m/s: velocity of the block, a tenth of the wave speed, and amplitude of its vibration
TRUNCATED = DAMPED._replace(kernel_correction=False)
TRUNCATED_TPIC = TRUNCATED._replace(flip_fraction=0.0)


def column_error(scheme: Scheme, young: float, settings: Settings) -> Observation:
    """Stress error of an elastic column of ten cells at rest, over rho g H."""
    points, height, unbalanced = settled_column(CELLS, 2, scheme, young, settings)
    first = slice(2 * CELLS)  # the points beside one wall, from bottom to top
    curve = points.sigma[first, 1] / exact_stress(np.zeros(2 * CELLS)), height[first]
    return Observation(stress_error(points, height), f"unbalanced force {unbalanced:.1g} of the weight", curve)


def lost_mass(settings: Settings) -> float:
    """Fraction of the mass of a square filled with points between four walls that is not transferred to the nodes."""
    points = points_at(lattice((0.0, 0.0), (1.0, 1.0), 0.05), 0.05)
    grid = walled_grid((0.0, 0.0), 0.1, (10, 10), rollers="left right bottom top")
    solver = make_solver(points, grid, settings._replace(gravity_y=0.0), body=elastic_body())
    advance_steps(solver, 1)
    return float(abs(node_records(grid)[..., 0].sum() / points.m.sum() - 1.0))


def translation_error(basis: str) -> Observation:
    """Rms change of the velocities in a vibrating block if it also translates, over their rms."""
    moving, resting = (_vibrating(basis, frame) for frame in (FRAME, 0.0))
    change = float(np.sqrt(np.mean((moving - FRAME * np.array([1.0, 0.0]) - resting) ** 2)))
    return Observation(change / float(np.sqrt(np.mean(resting**2))))


def _vibrating(basis: str, frame: float) -> np.ndarray:
    """Velocities (n, 2) of a block with a standing wave after a time of 0.2 m / FRAME; `frame`: its velocity, m/s."""
    points = points_at(lattice((0.5, 0.5), (1.5, 1.5), 0.05), 0.05)
    points.v[:, 0] = frame + WAVE * np.sin(np.pi * (points.x[:, 0] - 1.0))
    grid, body = walled_grid((0.0, 0.0), 0.1, (25, 20)), elastic_body()
    solver = make_solver(points, grid, WEIGHTLESS, body=body, scheme=Scheme(basis=basis))
    advance_to(solver, 0.2 / FRAME)
    return by_id(solver).v


SCENARIOS = (
    Scenario(
        name="grid-crossing",
        mechanism="The gradients of linear shape functions are discontinuous at nodes: a point that crosses a cell "
        "boundary changes the nodal forces abruptly.",
        metric="stress error of a column under its own weight that settles by 4 %, over rho g H",
        bound=0.02,
        source="chosen here: 2 % of the exact solution sigma = -rho g (H - Z); Steffen et al. 2008, "
        "doi:10.1002/nme.2360, on linear shape functions and B-splines",
        remedy="method.basis = quadratic (default) or cubic",
        trials=(
            failing("linear", partial(column_error, Scheme(basis="linear"), SOFT, DAMPED)),
            passing("quadratic", partial(column_error, PAPER, SOFT, DAMPED), default=True),
        ),
        axes=("vertical stress over exact stress at the bottom (-)", "initial height (m)"),
    ),
    Scenario(
        name="translation",
        mechanism="A body in translation crosses cells: with linear shape functions the noise exceeds its own "
        "vibration.",
        metric="relative change of the velocities in a vibrating block by a translation of two cells",
        bound=0.1,
        source="chosen here: 10 %; Galilean invariance requires no change",
        remedy="method.basis = quadratic (default) or cubic",
        trials=(
            failing("linear", partial(translation_error, "linear")),
            passing("quadratic", partial(translation_error, "quadratic"), default=True),
        ),
    ),
    Scenario(
        name="truncated-spline-mass",
        mechanism="The weights of a B-spline truncated at a wall do not sum to one: mass and momentum are lost.",
        metric="fraction of the mass not transferred to the nodes, four walls, four points per cell",
        bound=1e-12,
        source="round-off; derived here from Eq. 17: the sum of the weights lacks (1/2 - xi)^2 / 2 at xi h from the "
        "wall",
        remedy="method.kernel_correction = true (default); Nakamura et al. 2023, doi:10.1016/j.cma.2022.115720",
        trials=(
            failing("kernel_correction = false", partial(lost_mass, TRUNCATED)),
            passing("kernel_correction = true", partial(lost_mass, DAMPED), default=True),
        ),
    ),
    Scenario(
        name="truncated-spline-stress",
        mechanism="The gradients of a B-spline truncated at a wall do not sum to zero: a uniform stress accelerates "
        "the nodes beside the wall.",
        metric="stress error of a column under its own weight, over rho g H",
        bound=0.02,
        source="chosen here: 2 % of the exact solution sigma = -rho g (H - Z); 0.25 % with the correction and ten "
        "cells",
        remedy="method.kernel_correction = true (default); Nakamura et al. 2023, doi:10.1016/j.cma.2022.115720",
        trials=(
            failing("taylor-flip, truncated", partial(column_error, PAPER, 1e8, TRUNCATED)),
            failing("tpic, truncated", partial(column_error, PAPER, 1e8, TRUNCATED_TPIC)),
            passing("taylor-flip, corrected", partial(column_error, PAPER, 1e8, DAMPED), default=True),
        ),
        axes=("vertical stress over exact stress at the bottom (-)", "initial height (m)"),
    ),
)
