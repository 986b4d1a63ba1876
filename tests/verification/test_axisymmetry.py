"""Axisymmetry: patch tests next to the axis, and the radial vibration of a cylinder."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.problems.bar import period_of
from mpmcol.failure_modes.toolkit import (
    DENSITY,
    NU,
    PLAIN,
    WEIGHTLESS,
    G,
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
from tests.support.breathing_cylinder import bessel, breathing_root

H = 0.1
SETTINGS = WEIGHTLESS._replace(axisymmetric=True)


def test_uniform_expansion_is_exact_next_to_the_axis() -> None:
    """v_r = a r gives L_rr = L_tt = a, even for points one hundredth of a cell from the axis."""
    rng = np.random.default_rng(1)
    r = np.concatenate([H * np.array([0.01, 0.02, 0.1, 0.3, 0.49]), rng.uniform(0.01 * H, 8 * H, 200)])
    x = np.stack([r, rng.uniform(0.01 * H, 7.9 * H, len(r))], axis=1)
    points = points_at(x, H / 2, axisymmetric=True)
    a = 3.0
    points.v[:, 0] = a * r
    gradient = np.zeros((len(r), 3, 3))
    gradient[:, 0, 0] = a
    points.grad_v = gradient
    solver = make_solver(points, walled_grid((0.0, 0.0), H, (10, 8), rollers="left"), SETTINGS)
    advance_steps(solver, 1)
    np.testing.assert_allclose(solver.points.grad_v, np.broadcast_to(np.diag([a, 0.0, a]), (len(r), 3, 3)), atol=1e-12)


def radial_acceleration(points_per_axis: int) -> np.ndarray:
    """Radial acceleration of nodes at r = 0, h, 2h... in a cylinder under uniform stress, over sigma / (rho h)."""
    sigma, spacing = 1e4, H / points_per_axis
    points = points_at(lattice((0.0, 0.0), (8 * H, 6 * H), spacing), spacing, axisymmetric=True)
    points.sigma = np.broadcast_to([sigma, sigma, sigma, 0.0], (len(points), 4))
    solver = make_solver(points, walled_grid((0.0, 0.0), H, (12, 9), rollers="left"), SETTINGS)
    advance_steps(solver, 1)
    return node_records(solver.grid)[:, 3, 4] * DENSITY * H / sigma


def test_uniform_stress_is_in_equilibrium_except_at_the_first_node_off_the_axis() -> None:
    """With four points per cell the quadrature of (r w)' is exact, except where the kernel correction ends, r = h / 2.

    The error acts on the node at r = h alone. It is -1/32 of sigma / (rho h) and decreases with the square of the
    distance between points.
    """
    two, four = radial_acceleration(2), radial_acceleration(4)
    np.testing.assert_allclose(two[2:7], 0.0, atol=1e-12)
    np.testing.assert_allclose(four[2:7], 0.0, atol=1e-12)
    assert two[1] == pytest.approx(-1.0 / 32.0, rel=1e-9)
    assert four[1] == pytest.approx(two[1] / 4.0, rel=1e-9)


def test_self_weight_stress_next_to_the_axis() -> None:
    """Confined cylinder: sigma_r = sigma_t = nu / (1 - nu) sigma_v within 3.5 % in the first two cells, 1 % beyond.

    The 3.5 % come from the quadrature error of -1/32 (see the test above) and do not decrease with h.
    """
    cells, height = 10, 1.0
    x = lattice((0.0, 0.0), (height, height), H / 2)
    grid = walled_grid((0.0, 0.0), H, (cells, cells + 3), rollers="left right bottom")
    settings = PLAIN._replace(axisymmetric=True, alpha_d=0.5)
    solver = make_solver(points_at(x, H / 2, axisymmetric=True), grid, settings)
    advance_to(solver, 30.0 * 4.0 * height / 64.7)
    points = by_id(solver)
    deep = (x[:, 1] < 0.5) & (x[:, 1] > H)
    lateral = -NU / (1.0 - NU) * DENSITY * G * (height - x[deep, 1])
    axis = x[deep, 0] < 0.5 * H
    for component in (0, 2):
        ratio = points.sigma[deep, component] / lateral
        np.testing.assert_allclose(ratio, 1.0, atol=0.035)
        np.testing.assert_allclose(ratio[x[deep, 0] > 2.0 * H], 1.0, atol=0.01)
    np.testing.assert_allclose(points.sigma[deep, 0][axis], points.sigma[deep, 2][axis], rtol=1e-4)


def test_impact_of_an_elastic_cylinder_causes_no_peak_at_the_axis() -> None:
    """Largest hoop stress and hoop strain rate of the first column of points, compared with the next three."""
    radius, speed, c = 1.0, 0.5, 64.7
    x = lattice((0.0, 0.0), (radius, radius), H / 2)
    points = points_at(x, H / 2, axisymmetric=True)
    points.v[:, 1] = -speed
    solver = make_solver(points, walled_grid((0.0, 0.0), H, (15, 15), rollers="left bottom"), SETTINGS)
    stress, rate = np.zeros(len(x)), np.zeros(len(x))
    for k in range(40):
        advance_to(solver, (k + 1) * 0.1 * radius / c)
        now = by_id(solver)
        stress, rate = (
            np.maximum(stress, np.abs(now.sigma[:, 2])),
            np.maximum(rate, np.abs(now.grad_v[:, 2, 2])),
        )
    for largest in (stress, rate):
        columns = [largest[np.isclose(x[:, 0], (k + 0.5) * H / 2)].max() for k in range(4)]
        assert columns[0] == pytest.approx(np.mean(columns[1:]), rel=0.05)


def breathing_period(cells: int) -> float:
    """Period of the radial vibration of an elastic cylinder, over the exact one."""
    z, h, body = breathing_root(), 1.0 / cells, elastic_body()
    x = lattice((0.0, 0.0), (1.0, 2.0 * h), h / 2)
    shape = bessel(1, z * x[:, 0])
    points = points_at(x, h / 2, axisymmetric=True)
    points.v[:, 0] = 1e-3 * shape
    solver = make_solver(
        points, walled_grid((0.0, 0.0), h, (cells + 4, 2), rollers="left bottom top"), SETTINGS, body=body
    )
    exact = 2.0 * np.pi / (z * np.sqrt(body.wave_speed2))
    times, amplitudes = [], []
    while solver.time < 5.0 * exact:
        advance_steps(solver, 1)
        times.append(solver.time)
        amplitudes.append((by_id(solver).m * shape) @ by_id(solver).v[:, 0])
    return float(period_of(np.array(times), np.array(amplitudes)) / exact)


def test_radial_vibration_of_a_cylinder() -> None:
    """Plane strain: within 0.1 % of the exact period at ten cells, with second-order convergence."""
    errors = np.array([breathing_period(cells) for cells in (5, 10, 20)]) - 1.0
    assert 0.0 < errors[1] < 1e-3
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders > 1.8) & (orders < 2.3)), (errors, orders)
