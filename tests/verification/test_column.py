"""A column under self-weight between rollers: stress, settlement, and active thrust on the gate."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.problems.column import DAMPED, HEIGHT, WEIGHT, settled_column, stress_error
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    K_ACTIVE,
    NU,
    G,
    advance_to,
    elastic_body,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.boundary import hold_components
from mpmcol.mpm.grid import node_coordinates, node_records
from mpmcol.mpm.kernels.grid_update import clear
from mpmcol.mpm.kernels.transfer import make_p2g
from mpmcol.mpm.particles import COLUMN, Points
from mpmcol.mpm.settings import PAPER, Scheme
from mpmcol.mpm.solver import Solver
from tests.support.sand_column import filtered

STIFF = elastic_body(youngs_modulus=1e8)
AT_REST = 1e-4  # unbalanced force over weight
both_dimensions = pytest.mark.parametrize("d", [2, 3])


def settled(cells: int, d: int, scheme: Scheme = PAPER, young: float = 1e8) -> tuple[Points, np.ndarray]:
    """Points of an elastic column at rest, and their initial heights."""
    points, initial_height, unbalanced = settled_column(cells, d, scheme, young)
    assert unbalanced < AT_REST
    return points, initial_height


@both_dimensions
def test_stress_is_within_half_a_percent_at_ten_cells_and_second_order(d: int) -> None:
    errors = [stress_error(*settled(cells, d)) for cells in (5, 10, 20)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[1] < 0.005
    assert np.all((orders > 1.85) & (orders < 2.15)), (errors, orders)


@pytest.mark.slow
def test_cubic_shape_functions_are_second_order() -> None:
    """The error at ten cells is 0.21 %, with quadratic B-splines 0.25 %."""
    errors = [stress_error(*settled(cells, 2, Scheme(basis="cubic"))) for cells in (5, 10, 20)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[1] < 0.0022
    assert np.all((orders > 1.85) & (orders < 2.15)), (errors, orders)


def test_linear_shape_functions_are_first_order_and_fail_where_points_cross_cells() -> None:
    """In a stiff column the stress is constant per cell; in a soft one, which settles by 4 %, it does not converge."""
    stiff, soft = (
        [stress_error(*settled(cells, 2, Scheme(basis="linear"), young)) for cells in (5, 10, 20)]
        for young in (1e8, 3e5)
    )
    np.testing.assert_allclose(stiff, [0.05, 0.025, 0.0125], rtol=1e-6)
    assert min(soft) > 0.08
    assert stress_error(*settled(10, 2, PAPER, 3e5)) < 0.01


@both_dimensions
def test_settlement_and_lateral_stress(d: int) -> None:
    points, initial_height = settled(20, d)
    modulus = STIFF.wave_speed2 * DENSITY
    top = initial_height > HEIGHT - 1.0 / 40.0
    settlement = np.mean(initial_height[top] - points.x[top, 1])
    assert settlement == pytest.approx(WEIGHT * HEIGHT / (2.0 * modulus), rel=0.003)
    np.testing.assert_allclose(points.sigma[:, 0], NU / (1.0 - NU) * points.sigma[:, 1], rtol=1e-10)
    np.testing.assert_allclose(points.sigma[:, 2], points.sigma[:, 0], rtol=1e-10)
    np.testing.assert_allclose(points.sigma[:, 3:], 0.0, atol=1e-8 * WEIGHT)


def sand_behind_a_gate(cells: int, d: int, width: int = 4, with_filter: bool = False) -> Solver:
    """Sand at rest between a wall and a smooth gate `width` cells away; in 3D between two walls and two gates.
    Gravity is applied in steps: applied at once, it causes overshoot that leaves a thrust of 1.10 times the active one.
    """
    h = HEIGHT / cells
    x = lattice((0.0,) * d, (width * h, HEIGHT, width * h)[:d], h / 2)
    points = points_at(x, h / 2, kind=COLUMN)
    grid = walled_grid((0.0,) * d, h, (width + 5, cells + 4, width + 5)[:d])
    x, y, *z = node_coordinates(grid)
    gate = [(c < 0.5 * h) | (c > (width - 0.5) * h) for c in (x, *z)]
    hold_components(grid, gate[0], y < 0.5 * h, *gate[1:])
    solver = make_solver(points, grid, DAMPED)
    sand = solver.bodies[COLUMN]
    damped = filtered(DAMPED, sand, h) if with_filter else DAMPED
    period = 4.0 * HEIGHT / np.sqrt(sand.wave_speed2)
    for stage in range(1, 51):
        solver.settings = damped._replace(gravity_y=-G * stage / 50.0)
        advance_to(solver, solver.time + 0.1 * period)
    advance_to(solver, solver.time + 20.0 * period)
    return solver


@pytest.mark.parametrize(("d", "with_filter"), [(2, False), (3, False), (2, True)])
def test_active_thrust_on_the_gate(d: int, with_filter: bool) -> None:
    """1/2 K_a rho g H^2 with K_a = 0.2948 is the sum of the forces on the nodes at and beyond the gate."""
    solver, width = sand_behind_a_gate(10, d, width=4, with_filter=with_filter), 0.4 * HEIGHT
    solver.sort()
    clear(solver.grid, solver.tiles)
    state = solver.state()
    make_p2g(d, "quadratic")(state.rows, state.grid, state.tiles, state.shares, state.settings)
    thrust = 0.5 * K_ACTIVE * DENSITY * G * HEIGHT**2 * width ** (d - 2)
    assert pytest.approx(0.2948, abs=5e-5) == K_ACTIVE
    points = solver.points
    inner = (points.x[:, 1] < 0.8 * HEIGHT) & np.all(points.x[:, ::2] < 0.5 * width, axis=1)
    for axis in (0, 2)[: d - 1]:
        force = np.moveaxis(node_records(solver.grid)[..., 4 + axis], axis, 0).reshape(10, -1).sum(axis=1)
        assert force[4:].sum() == pytest.approx(thrust, rel=0.01)
        assert force[0] == pytest.approx(-thrust, rel=0.01)
        ratio = points.sigma[inner, axis].sum() / points.sigma[inner, 1].sum()
        assert ratio == pytest.approx(K_ACTIVE, rel=0.01)
