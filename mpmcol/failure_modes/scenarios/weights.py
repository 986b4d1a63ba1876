"""Bases that ring as points cross cells, and splines cut off at walls."""

from __future__ import annotations

from functools import partial

import numpy as np

from mpmcol.failure_modes.problems.column import DAMPED, exact_stress, settled_column, stress_error
from mpmcol.failure_modes.scenario import Reading, Scene, Trial
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

CELLS, SOFT = 10, 3e5  # Pa: the column settles by 4 % of its height, which is 0.4 cells
FRAME, WAVE = 6.5, 0.5  # m/s: a tenth of the wave speed, and the wave in the block
CUT = DAMPED._replace(kernel_correction=False)
TPIC_CUT = CUT._replace(flip_fraction=0.0)


def column_error(scheme: Scheme, young: float, settings: Settings) -> Reading:
    """Of the stress of an elastic column of ten cells at rest."""
    points, height, unbalanced = settled_column(CELLS, 2, scheme, young, settings)
    first = slice(2 * CELLS)  # the points at one wall, from the foot up
    curve = points.sigma[first, 1] / exact_stress(np.zeros(2 * CELLS)), height[first]
    return Reading(stress_error(points, height), f"unbalanced {unbalanced:.1g} of the weight", curve)


def lost_mass(settings: Settings) -> float:
    """Share of the mass of a full square cell by cell between four walls that does not come to the nodes."""
    points = points_at(lattice((0.0, 0.0), (1.0, 1.0), 0.05), 0.05)
    grid = walled_grid((0.0, 0.0), 0.1, (10, 10), rollers="left right bottom top")
    solver = make_solver(points, grid, settings._replace(gravity_y=0.0), body=elastic_body())
    advance_steps(solver, 1)
    return float(abs(node_records(grid)[..., 0].sum() / points.m.sum() - 1.0))


def changed_by_translation(basis: str) -> Reading:
    """Rms of the velocities in a ringing block that flies along against those of the same block that does not."""
    flying, resting = (_ringing(basis, frame) for frame in (FRAME, 0.0))
    change = float(np.sqrt(np.mean((flying - FRAME * np.array([1.0, 0.0]) - resting) ** 2)))
    return Reading(change / float(np.sqrt(np.mean(resting**2))))


def _ringing(basis: str, frame: float) -> np.ndarray:
    """Velocities (n, 2) of a block with a standing wave after two cells of flight with `frame`, m/s."""
    points = points_at(lattice((0.5, 0.5), (1.5, 1.5), 0.05), 0.05)
    points.v[:, 0] = frame + WAVE * np.sin(np.pi * (points.x[:, 0] - 1.0))
    grid, body = walled_grid((0.0, 0.0), 0.1, (25, 20)), elastic_body()
    solver = make_solver(points, grid, WEIGHTLESS, body=body, scheme=Scheme(basis=basis))
    advance_to(solver, 0.2 / FRAME)
    return by_id(solver).v


SCENES = (
    Scene(
        name="grid-crossing",
        mechanism="Linear hats have gradients that jump at nodes: a point that crosses a cell kicks the nodes on both "
        "sides.",
        sign="error of the stress in a column under its weight that settles by 4 %, over rho g H",
        unit="",
        bound=0.02,
        source="closed form sigma = -rho g (H - Z); splines are second order, hats stall (doi:10.1002/nme.2360)",
        remedy="method.basis = quadratic, the default, or cubic",
        trials=(
            Trial("linear", False, partial(column_error, Scheme(basis="linear"), SOFT, DAMPED)),
            Trial("quadratic", True, partial(column_error, PAPER, SOFT, DAMPED), default=True),
        ),
        axes=("vertical stress over that at the foot (-)", "initial height (m)"),
    ),
    Scene(
        name="translation",
        mechanism="A whole scene that flies along crosses cells: with hats its own motion drowns in the noise of that.",
        sign="change of the velocities in a ringing block by a flight of two cells, over the velocities",
        unit="",
        bound=0.1,
        source="Galilean invariance, within a tenth",
        remedy="method.basis = quadratic, the default, or cubic",
        trials=(
            Trial("linear", False, partial(changed_by_translation, "linear")),
            Trial("quadratic", True, partial(changed_by_translation, "quadratic"), default=True),
        ),
    ),
    Scene(
        name="cut-spline-mass",
        mechanism="A spline cut off at a wall hands on less than the point has: mass and momentum vanish.",
        sign="share of the mass that does not come to the nodes, four walls, four points per cell",
        unit="",
        bound=1e-12,
        source="weights must sum to one; the sum lacks (1/2 - xi)^2 / 2 at xi h from the wall",
        remedy="method.kernel_correction = true, the default",
        trials=(
            Trial("kernel_correction = false", False, partial(lost_mass, CUT)),
            Trial("kernel_correction = true", True, partial(lost_mass, DAMPED), default=True),
        ),
    ),
    Scene(
        name="cut-spline-stress",
        mechanism="A spline cut off at a wall has gradients that do not sum to zero: a uniform stress pushes the "
        "wall's points.",
        sign="error of the stress in a column under its weight, over rho g H",
        unit="",
        bound=0.02,
        source="closed form sigma = -rho g (H - Z); 0.25 % with the correction at ten cells",
        remedy="method.kernel_correction = true, the default",
        trials=(
            Trial("taylor-flip, cut off", False, partial(column_error, PAPER, 1e8, CUT)),
            Trial("tpic, cut off", False, partial(column_error, PAPER, 1e8, TPIC_CUT)),
            Trial("taylor-flip, corrected", True, partial(column_error, PAPER, 1e8, DAMPED), default=True),
        ),
        axes=("vertical stress over that at the foot (-)", "initial height (m)"),
    ),
)
