"""Free fall of a block: exact parabola, mass and momentum, position updates, local damping."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.failure_modes.problems.fall import H, thrown_block
from mpmcol.failure_modes.toolkit import (
    PLAIN,
    WEIGHTLESS,
    G,
    advance_steps,
    by_id,
    kinetic_energy,
    potential_energy,
)
from mpmcol.mpm.grid import node_records

THROWN = (0.7, 1.5, -0.4)  # m/s
both_dimensions = pytest.mark.parametrize("d", [2, 3])


@both_dimensions
def test_parabola_is_exact_over_10_000_steps(d: int) -> None:
    v0, g = np.array(THROWN[:d]), np.array([2.0, -G, -3.0][:d])
    solver, start = thrown_block(THROWN[:d], PLAIN._replace(gravity_x=2.0, gravity_z=-3.0))
    advance_steps(solver, 10_000)
    points, t = by_id(solver), solver.time
    np.testing.assert_allclose(points.x, start.x + v0 * t + 0.5 * g * t**2, rtol=1e-12)
    np.testing.assert_allclose(points.v, np.broadcast_to(v0 + g * t, points.v.shape), rtol=1e-12)
    np.testing.assert_allclose(points.J, 1.0, rtol=1e-12)


@pytest.mark.parametrize("v", [(20.0, 0.0, 0.0), (0.0, -20.0, 0.0), (0.0, 0.0, 20.0)], ids="xyz")
def test_a_block_flies_straight_along_each_axis(v: tuple[float, float, float]) -> None:
    """Over ten cells, so that points are sorted again on the way, along each axis."""
    solver, start = thrown_block(v, WEIGHTLESS)
    advance_steps(solver, 1000)
    points = by_id(solver)
    assert solver.time * 20.0 > 9.0 * H
    np.testing.assert_allclose(points.x, start.x + solver.time * np.array(v), rtol=1e-12)
    np.testing.assert_allclose(points.v, np.broadcast_to(v, points.v.shape), atol=1e-10)


@both_dimensions
def test_mass_and_momentum_are_conserved_to_round_off(d: int) -> None:
    solver, start = thrown_block(THROWN[:d])
    rng = np.random.default_rng(2)
    solver.points.v[:] += rng.normal(0.0, 1.0, start.v.shape)
    solver.points.grad_v = np.pad(rng.normal(0.0, 1.0, (len(start), d, d)), ((0, 0), (0, 3 - d), (0, 3 - d)))
    solver.points.sigma = rng.normal(0.0, 1e3, (len(start), 6))
    mass, momentum = start.m.sum(), start.m @ solver.points.v
    advance_steps(solver, 500)
    nodes = node_records(solver.grid).reshape(-1, 8)
    expected = momentum + mass * np.array([0.0, -G, 0.0][:d]) * solver.time
    assert nodes[:, 0].sum() == pytest.approx(mass, rel=1e-13)
    np.testing.assert_allclose(solver.points.m @ solver.points.v, expected, rtol=1e-11)
    np.testing.assert_allclose(nodes[:, 0] @ nodes[:, 1 : 1 + d], expected, rtol=1e-11)


@pytest.mark.parametrize(("factor", "share"), [(1.0, -0.5), (0.5, 0.0), (0.0, 0.5)], ids=["paper", "trapezoid", "end"])
def test_error_of_the_position_updates(factor: float, share: float) -> None:
    """The error is `share` times a dt t, a the acceleration: Eq. 27 as printed lags, the end velocity leads."""
    solver, start = thrown_block((0.0, 0.0), PLAIN._replace(position_factor=factor))
    sum_dt2 = 0.0
    for _ in range(200):
        sum_dt2 += solver.dt**2
        advance_steps(solver, 1)
    error = by_id(solver).x[:, 1] - start.x[:, 1] + 0.5 * G * solver.time**2
    np.testing.assert_allclose(error, -share * G * sum_dt2, atol=1e-14)


@pytest.mark.parametrize(("speed", "factor"), [(-0.5, 0.95), (5.0, 1.05)], ids=["down", "up"])
def test_damping_of_5_percent_changes_the_force_by_5_percent(speed: float, factor: float) -> None:
    """-alpha_d |f| sign(v): a falling block accelerates at 0.95 g, a rising one decelerates at 1.05 g."""
    solver, _ = thrown_block((0.0, speed), PLAIN._replace(alpha_d=0.05))
    advance_steps(solver, 1000)
    np.testing.assert_allclose(solver.points.v[:, 1], speed - factor * G * solver.time, rtol=1e-12)


@pytest.mark.parametrize("speed", [-3.0, 0.0, 0.2, 3.0])
def test_damping_never_adds_energy(speed: float) -> None:
    solver, _ = thrown_block((0.3, speed), PLAIN._replace(alpha_d=0.05))
    energy = [kinetic_energy(solver.points) + potential_energy(solver.points)]
    for _ in range(100):
        advance_steps(solver, 20)
        energy.append(kinetic_energy(solver.points) + potential_energy(solver.points))
    assert np.all(np.diff(energy) < 0.0)
