"""A column under its own weight between rollers: stress, settlement, and the active thrust on the gate."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.grid import node_coordinates, node_records, set_fixed
from mpmcol.kernels import transfer_2d
from mpmcol.kernels.cycle import L_UNBALANCED
from mpmcol.kernels.grid import clear
from mpmcol.kernels.transfer import make_p2g
from mpmcol.solver import Solver
from mpmcol.state import COLUMN, Points
from tests.verification.blocks import (
    DENSITY,
    K_ACTIVE,
    NU,
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

HEIGHT = 1.0
WEIGHT = DENSITY * G * HEIGHT
DAMPED = PLAIN._replace(alpha_d=0.5)
STIFF = elastic_body(youngs_modulus=1e8)


def settled_column(cells: int) -> tuple[Points, np.ndarray]:
    """Elastic points at rest and their initial heights."""
    h = HEIGHT / cells
    x = lattice((0.0, 0.0), (2.0 * h, HEIGHT), h / 2)
    grid = walled_grid((0.0, 0.0), h, (2, cells + 3), rollers="left right bottom")
    solver = make_solver(points_at(x, h / 2), grid, DAMPED, body=STIFF)
    advance_to(solver, 30.0 * 4.0 * HEIGHT / np.sqrt(STIFF.wave_speed2))
    assert solver.ledger[L_UNBALANCED] < 1e-4
    return by_id(solver), x[:, 1]


def stress_error(points: Points, initial_height: np.ndarray) -> float:
    """sum |s_p - s_a| V_p / (rho g H V), s_a = -rho0 g (H - Z): exact at finite strain, too."""
    exact = -DENSITY * G * (HEIGHT - initial_height)
    return float(np.abs(points.sigma[:, 1] - exact) @ points.V / (WEIGHT * points.V.sum()))


def test_stress_is_within_half_a_percent_at_ten_cells_and_second_order() -> None:
    errors = [stress_error(*settled_column(cells)) for cells in (5, 10, 20)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[1] < 0.005
    assert np.all((orders > 1.85) & (orders < 2.15)), (errors, orders)


def test_settlement_and_lateral_stress() -> None:
    points, initial_height = settled_column(20)
    modulus = STIFF.wave_speed2 * DENSITY
    top = initial_height > HEIGHT - 1.0 / 40.0
    settlement = np.mean(initial_height[top] - points.x[top, 1])
    assert settlement == pytest.approx(WEIGHT * HEIGHT / (2.0 * modulus), rel=0.003)
    np.testing.assert_allclose(points.sigma[:, 0], NU / (1.0 - NU) * points.sigma[:, 1], rtol=1e-10)
    np.testing.assert_allclose(points.sigma[:, 2], points.sigma[:, 0], rtol=1e-10)


def sand_behind_a_gate(cells: int, width: int = 4) -> Solver:
    """Sand at rest between the wall and a smooth gate `width` cells away, its weight brought up in stages.

    Weight that comes at once makes the stress overshoot; that leaves a thrust of 1.10 times the active one.
    """
    h = HEIGHT / cells
    points = points_at(lattice((0.0, 0.0), (width * h, HEIGHT), h / 2), h / 2, kind=COLUMN)
    grid = walled_grid((0.0, 0.0), h, (width + 5, cells + 4))
    x, y = node_coordinates(grid)
    set_fixed(grid, (x < 0.5 * h) | (x > (width - 0.5) * h), y < 0.5 * h)
    solver = make_solver(points, grid, DAMPED)
    period = 4.0 * HEIGHT / np.sqrt(solver.bodies[COLUMN].wave_speed2)
    for stage in range(1, 51):
        solver.settings = DAMPED._replace(gravity_y=-G * stage / 50.0)
        advance_to(solver, solver.time + 0.1 * period)
    advance_to(solver, solver.time + 20.0 * period)
    return solver


def test_active_thrust_on_the_gate() -> None:
    """1/2 K_a rho g H^2 with K_a = 0.2948, as the sum of the forces on the nodes of the gate and beyond."""
    solver = sand_behind_a_gate(10)
    solver.sort()
    clear(solver.grid, solver.tiles)
    make_p2g(transfer_2d)(solver.points.rows.reshape(-1), solver.grid, solver.tiles, solver.settings)
    force = node_records(solver.grid)[:, :, 4].sum(axis=1)
    thrust = 0.5 * K_ACTIVE * DENSITY * G * HEIGHT**2
    assert pytest.approx(0.2948, abs=5e-5) == K_ACTIVE
    assert force[4:].sum() == pytest.approx(thrust, rel=0.01)
    assert force[0] == pytest.approx(-thrust, rel=0.01)
    points = solver.points
    inner = (points.x[:, 1] < 0.8 * HEIGHT) & (points.x[:, 0] < 0.2 * HEIGHT)
    ratio = points.sigma[inner, 0].sum() / points.sigma[inner, 1].sum()
    assert ratio == pytest.approx(K_ACTIVE, rel=0.01)
