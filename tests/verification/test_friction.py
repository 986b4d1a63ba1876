"""Coulomb friction on floor and walls, and the impulses on walls, against closed forms."""

from __future__ import annotations

from functools import cache
from math import cos, radians, sin, tan
from pathlib import Path

import numpy as np
import pytest

import mpmcol
from mpmcol.failure_modes.toolkit import (
    G,
    advance_steps,
    advance_to,
    elastic_body,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
)
from mpmcol.mpm.boundary import CONTACT, NO_SLIP, Boundary, BoundaryType, apply_boundaries, face
from mpmcol.mpm.contact import Contacts, friction_work, make_contacts, wall_impulses
from mpmcol.mpm.grid import allocate_grid
from mpmcol.mpm.kernels.loop import L_DAMPING, L_GRID, L_NODE_WORK, L_WALLS
from mpmcol.mpm.kernels.step import STRESS_ORDERS
from mpmcol.mpm.particles import BASE, COLUMN, Points
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.solver import Solver

H, SIDE, STIFF = 0.1, 0.4, 1e7  # m, m, Pa
SLOPE, MU = radians(24.0), tan(radians(15.0))
WIDTH, PRESSURE = 0.5, 1000.0  # m, Pa
PLATE = Settings(gravity_x=G * sin(SLOPE), gravity_y=-G * cos(SLOPE), cfl=0.4)
LEVEL = Settings(gravity_y=-G, cfl=0.4)
WEIGHTLESS = Settings(gravity_y=0.0, cfl=0.4)
DIMENSIONS = pytest.mark.parametrize("d", [2, 3])


def block(d: int, settings: Settings, mu: float, low: float = 0.0, floor: BoundaryType = CONTACT) -> Solver:
    """An elastic block, `low` above a floor: wall 0; wall 1 is at the high end of x; both have friction mu."""
    corner = np.array([1.0, low, 0.2][:d])
    points = points_at(lattice(tuple(corner), tuple(corner + SIDE), H / 2), H / 2)
    grid = allocate_grid((0.0,) * d, H, (40, 12, 8)[:d])
    boundaries = [numbered(face(grid, floor, 1, 0), 0, mu), numbered(face(grid, CONTACT, 0, 1), 1, mu)]
    apply_boundaries(grid, boundaries)
    solver = make_solver(points, grid, settings, body=elastic_body(youngs_modulus=STIFF))
    solver.contacts = make_contacts(grid, boundaries)
    return solver


def numbered(boundary: Boundary, wall: int, mu: float) -> Boundary:
    return boundary._replace(wall=wall, friction=mu)


def momentum(points: Points) -> np.ndarray:
    return points.m @ points.v


def settle(solver: Solver) -> None:
    """Load the block by the normal component of gravity, with damping."""
    settings = solver.settings
    solver.settings = settings._replace(gravity_x=0.0, alpha_d=0.5)
    advance_to(solver, 0.3)
    solver.settings = settings
    solver.contacts.sums[:] = 0.0


@cache
def sliding(d: int, mu: float) -> tuple[float, np.ndarray, Contacts, float]:
    """A settled block that slides down a plate: acceleration, impulses on walls, contacts, ratio of J_t to mu J_n."""
    solver = block(d, PLATE, mu)
    settle(solver)
    solver.points.v[:, 0] += 1.0
    start, began = momentum(solver.points), solver.time
    advance_to(solver, began + 0.8)
    duration, mass = solver.time - began, solver.points.m.sum()
    impulses = wall_impulses(solver.contacts, 2)
    gravity = mass * duration * np.array([PLATE.gravity_x, PLATE.gravity_y, 0.0])[:d]
    balance = momentum(solver.points) - start - gravity + impulses[:, :d].sum(axis=0)
    return (momentum(solver.points) - start)[0] / mass / duration, balance / mass, solver.contacts, -impulses[0, 1]


@DIMENSIONS
def test_a_block_slides_down_a_plate_with_the_acceleration_of_coulomb_friction(d: int) -> None:
    """g (sin 24 - tan 15 cos 24) = 1.58876 m/s2 within 0.1 %."""
    exact = G * (sin(SLOPE) - MU * cos(SLOPE))
    assert exact == pytest.approx(1.58876, abs=1e-5)
    acceleration, balance, contacts, pressed = sliding(d, MU)
    assert acceleration == pytest.approx(exact, rel=1e-3)
    np.testing.assert_allclose(balance, 0.0, atol=1e-12)
    assert wall_impulses(contacts, 2)[0, 0] == pytest.approx(MU * pressed, rel=1e-5)
    assert not wall_impulses(contacts, 2)[1].any()
    speed = 1.0 + 0.5 * acceleration * 0.8
    assert friction_work(contacts) == pytest.approx(MU * pressed * speed, rel=2e-3)


@DIMENSIONS
def test_without_friction_a_block_slides_freely(d: int) -> None:
    acceleration, balance, contacts, _ = sliding(d, 0.0)
    assert acceleration == pytest.approx(G * sin(SLOPE), rel=1e-12)
    np.testing.assert_allclose(balance, 0.0, atol=1e-12)
    assert friction_work(contacts) == wall_impulses(contacts, 2)[0, 0] == 0.0


@DIMENSIONS
def test_a_block_sticks_below_the_angle_of_friction(d: int) -> None:
    """It shears elastically and comes to rest with damping; the floor carries the weight."""
    solver = block(d, PLATE._replace(alpha_d=0.5), tan(radians(30.0)))
    advance_to(solver, 0.5)
    x = solver.points.x.copy()
    solver.contacts.sums[:] = 0.0
    began = solver.time
    advance_to(solver, began + 0.2)
    assert np.abs(solver.points.x - x).max() < 1e-6  # 1e-1 if it slid
    force = wall_impulses(solver.contacts, 2)[0] / (solver.time - began)
    weight = solver.points.m.sum() * np.array([PLATE.gravity_x, PLATE.gravity_y, 0.0])
    np.testing.assert_allclose(force, weight, atol=1e-3 * np.abs(weight).max())


def test_the_benchmark_of_cb_geo_for_a_floor_with_friction() -> None:
    """0.40554 m/s after 0.1 s: a body on a plane of 30 degrees with mu = 0.1 (github.com/cb-geo/mpm-benchmarks)."""
    slope = radians(30.0)
    solver = block(2, PLATE._replace(gravity_x=G * sin(slope), gravity_y=-G * cos(slope)), 0.1)
    settle(solver)
    solver.points.v[:, 0] += 1.0
    start, began = momentum(solver.points), solver.time
    advance_to(solver, began + 0.1)
    acceleration = (momentum(solver.points) - start)[0] / solver.points.m.sum() / (solver.time - began)
    assert 0.1 * acceleration == pytest.approx(0.40554, rel=1e-3)


@DIMENSIONS
def test_a_block_that_is_thrown_up_leaves_the_floor(d: int) -> None:
    """Without weight, no wall exerts an impulse on it: there is no adhesion."""
    solver = block(d, WEIGHTLESS, 0.5)
    solver.points.v[:, 1] = 1.0
    solver.points.v[:, 0] = 0.5
    start = momentum(solver.points)
    advance_to(solver, 0.2)
    assert not wall_impulses(solver.contacts, 2).any()
    np.testing.assert_allclose(momentum(solver.points), start, rtol=1e-13, atol=1e-13)
    assert solver.points.x[:, 1].min() > 0.2


@DIMENSIONS
def test_the_impulse_of_a_wall_on_a_block_is_its_change_of_momentum(d: int) -> None:
    """A block in free flight hits the wall at the end of the domain and rebounds."""
    solver = block(d, WEIGHTLESS, 0.0, low=0.3)
    solver.points.v[:, 0] = 2.0
    start = momentum(solver.points)
    advance_to(solver, 1.6)
    impulses = wall_impulses(solver.contacts, 2)
    assert momentum(solver.points)[0] < -0.5 * start[0]
    np.testing.assert_allclose(impulses[1, :d], start - momentum(solver.points), atol=1e-12 * start[0])
    assert not impulses[0].any()


@DIMENSIONS
def test_the_ledger_of_a_block_that_falls_on_a_plate_and_slides_closes(d: int) -> None:
    """Change of potential energy, grid kinetic energy, work of the stress, damping and walls add up to zero."""
    solver = block(d, PLATE._replace(alpha_d=0.05), MU, low=0.05)
    gravity, m = np.array([PLATE.gravity_x, PLATE.gravity_y, 0.0])[:d], solver.points.m
    start = m @ (solver.points.x @ gravity)
    advance_to(solver, 0.5)
    fallen = float(solver.points.m @ (solver.points.x @ gravity) - start)
    grid, stress, damping, walls = solver.ledger[[L_GRID, L_NODE_WORK, L_DAMPING, L_WALLS]]
    assert grid + stress + damping + walls == pytest.approx(fallen, rel=1e-12)
    assert friction_work(solver.contacts) == pytest.approx(walls, rel=0.01)
    assert walls > 0.05 * fallen


@DIMENSIONS
def test_with_large_friction_a_floor_equals_one_without_slip(d: int) -> None:
    """The points of a settled block that is tilted by 6 degrees are equal, and so are the impulses."""
    points = []
    for floor in (CONTACT, NO_SLIP):
        solver = block(d, LEVEL._replace(gravity_x=0.1 * G), 10.0, floor=floor)
        settle(solver)
        advance_steps(solver, 40)
        order = np.argsort(solver.points.id)
        points.append((solver.points.x[order], wall_impulses(solver.contacts, 2)))
    np.testing.assert_allclose(points[0][0], points[1][0], rtol=1e-12)
    np.testing.assert_allclose(points[0][1], points[1][1], rtol=1e-9, atol=1e-9)


def block_between_side_walls(mu: float, speed: float) -> Solver:
    """A weightless block with a stress across the channel only, which moves without deformation."""
    solver = block(2, WEIGHTLESS, 0.0, low=0.3)
    points, stress = solver.points, np.zeros((len(solver.points), 6))
    stress[:, 2] = -PRESSURE
    points.sigma, points.kind[:] = stress, COLUMN
    points.v[:, 0] = speed
    solver.bodies = (solver.bodies[BASE], solver.bodies[BASE])
    solver.contacts = solver.contacts._replace(side_friction=2.0 * mu / WIDTH)
    return solver


@pytest.mark.parametrize("stress_order", STRESS_ORDERS)
def test_side_walls_decelerate_a_block_by_the_friction_of_the_pressure_on_them(stress_order: str) -> None:
    """a = -(2 mu / W) p / rho until it stops, where it remains; the work is the loss of kinetic energy."""
    solver = block_between_side_walls(0.4, speed=1.0)
    solver.scheme = solver.scheme._replace(stress_order=stress_order)
    points, mass = solver.points, solver.points.m.sum()
    deceleration = 2.0 * 0.4 / WIDTH * PRESSURE / (mass / (points.V0.sum()))
    advance_to(solver, 0.5 / deceleration)
    assert momentum(points)[0] / mass == pytest.approx(1.0 - deceleration * solver.time, rel=1e-12)
    assert friction_work(solver.contacts) == pytest.approx(0.5 * mass - kinetic_energy(points), rel=1e-12)
    advance_to(solver, 2.0 / deceleration)
    assert np.abs(solver.points.v).max() < 1e-15
    assert friction_work(solver.contacts) == pytest.approx(0.5 * mass, rel=1e-12)


def test_a_column_between_side_walls_with_friction_falls_slower_and_its_ledger_closes(tmp_path: Path) -> None:
    case = ("coarse-channel", "grid.spacing=0.015", "output.snapshots=1", "stages.collapse.max_time_factor=3")
    free, held = (
        mpmcol.run(mpmcol.load_case(case[0], [*case[1:], *more]), tmp_path / str(len(more)), threads=1).summary
        for more in ([], ["friction.side_walls=20 deg", "friction.channel_width=0.04"])
    )
    assert held["front"]["front_height"] < 0.97 * free["front"]["front_height"]
    assert abs(held["ledger"]["residual"]) < 1e-10 * held["ledger"]["potential"]
    assert 0.05 < held["dissipation"]["wall_friction"] < 0.5
    assert "wall_friction" not in free["ledger"]
