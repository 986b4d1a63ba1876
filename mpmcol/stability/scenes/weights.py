"""Bases that ring as points cross cells, and splines cut off at walls."""

from __future__ import annotations

from functools import partial

from mpmcol.grid import node_records
from mpmcol.stability.blocks import advance_steps, elastic_body, lattice, make_solver, points_at, walled_grid
from mpmcol.stability.problems.column import DAMPED, exact_stress, settled_column, stress_error
from mpmcol.stability.scene import Reading, Scene, Trial
from mpmcol.state import PAPER, Scheme, Settings

CELLS, SOFT = 10, 3e5  # Pa: the column settles by 4 % of its height, which is 0.4 cells
CUT = DAMPED._replace(kernel_correction=False)
TPIC_CUT = CUT._replace(flip_fraction=0.0)


def column_error(scheme: Scheme, young: float, settings: Settings) -> Reading:
    """Of the stress of an elastic column of ten cells at rest."""
    points, height, unbalanced = settled_column(CELLS, 2, scheme, young, settings)
    stress = points.sigma[:, 1] / exact_stress(0.0 * height)
    return Reading(stress_error(points, height), f"unbalanced {unbalanced:.1g} of the weight", (stress, height))


def lost_mass(settings: Settings) -> float:
    """Share of the mass of a full square cell by cell between four walls that does not come to the nodes."""
    points = points_at(lattice((0.0, 0.0), (1.0, 1.0), 0.05), 0.05)
    grid = walled_grid((0.0, 0.0), 0.1, (10, 10), rollers="left right bottom top")
    solver = make_solver(points, grid, settings._replace(gravity_y=0.0), body=elastic_body())
    advance_steps(solver, 1)
    return float(abs(node_records(grid)[..., 0].sum() / points.m.sum() - 1.0))


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
