"""A rotating elastic ball: half a revolution about an axis of the grid and about an oblique axis.

R = 1, h = 0.2, eight points per cell, nu = 0.2, CFL 0.4, c_p = 16.7 omega R: the disc of test_disc.py in 3D.

The ball grows, as does the disc. The rate of deformation of rigid rotation is zero, so no stress opposes the motion of
the points along tangents. In each step that stretches both directions normal to the axis by 1/2 omega^2 dt^2, which
det(I + dt L) = 1 + omega^2 dt^2 includes in J; the position update of Eq. 27 adds the same amount, which J does not
include.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    WEIGHTLESS,
    advance_steps,
    by_id,
    elastic_body,
    kinetic_energy,
    lattice,
    make_solver,
    points_at,
    walled_grid,
)
from mpmcol.mpm.particles import Points

H, NU, DENSITY = 0.2, 0.2, 1.0
YOUNG = DENSITY * 16.7**2 * (1.0 + NU) * (1.0 - 2.0 * NU) / (1.0 - NU)
AXES = {"y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0), "oblique": (1.0, -2.0, 3.0)}


class Rotation(NamedTuple):
    axis: np.ndarray
    angular_momentum: np.ndarray  # over its initial norm
    energy: float  # over its initial value
    residual: float  # rms of the velocity minus rigid rotation, over omega R
    J: np.ndarray
    drift: float  # sum of omega^2 dt^2
    across: float  # radius of gyration about the axis, over its initial value
    along: float  # rms distance along the axis, over its initial value
    centre: np.ndarray


def angular_momentum(points: Points) -> np.ndarray:
    return points.m @ np.cross(points.x, points.v)


def gyration(points: Points, axis: np.ndarray) -> tuple[float, float]:
    """Radius of gyration about the axis, and root mean square distance along it."""
    along, share = (points.x @ axis) ** 2, points.m / points.m.sum()
    return float(np.sqrt(share @ (np.sum(points.x**2, axis=1) - along))), float(np.sqrt(share @ along))


@cache
def rotation(name: str) -> Rotation:
    axis = np.array(AXES[name]) / np.linalg.norm(AXES[name])
    x = lattice((-1.2,) * 3, (1.2,) * 3, H / 2)
    points = points_at(x[np.linalg.norm(x, axis=1) < 1.0], H / 2, density=DENSITY)
    points.v[:] = np.cross(axis, points.x)
    points.grad_v = np.broadcast_to(np.cross(axis, np.eye(3)).T, (len(points), 3, 3))
    settings, body = WEIGHTLESS._replace(cfl=0.4), elastic_body(DENSITY, YOUNG, NU)
    solver = make_solver(points, walled_grid((-2.0,) * 3, H, (20,) * 3), settings, body=body)
    start, energy, (across, along) = angular_momentum(points), kinetic_energy(points), gyration(points, axis)
    drift = 0.0
    while solver.time < np.pi:
        radius, dt = gyration(points, axis)[0], solver.dt
        omega = float(angular_momentum(points) @ axis / (points.m.sum() * radius**2))
        advance_steps(solver, 10)
        drift += 10.0 * (omega * dt) ** 2

    points = by_id(solver)
    (wide, high), left = gyration(points, axis), angular_momentum(points)
    rigid = np.cross(left @ axis / (points.m.sum() * wide**2) * axis, points.x)
    residual = float(np.sqrt(points.m @ np.sum((points.v - rigid) ** 2, axis=1) / points.m.sum()))
    return Rotation(
        axis, left / np.linalg.norm(start), kinetic_energy(points) / energy, residual, points.J, drift, wide / across,
        high / along, points.m @ points.x / points.m.sum(),
    )  # fmt: skip


@pytest.mark.parametrize("name", AXES)
def test_the_ball_keeps_rotating(name: str) -> None:
    """It gains 0.6 % of angular momentum; its energy is that of a rigid ball with its increased inertia."""
    ball = rotation(name)
    np.testing.assert_allclose(ball.angular_momentum, 1.006 * ball.axis, atol=0.001)
    assert ball.energy == pytest.approx((1.006 / ball.across) ** 2, abs=0.001)
    assert ball.residual < 0.015
    np.testing.assert_allclose(ball.centre, 0.0, atol=1e-12)


@pytest.mark.parametrize("name", AXES)
def test_volume_drift(name: str) -> None:
    """J and the lengths normal to the axis grow by omega^2 dt^2 per step; the length along the axis does not change."""
    ball = rotation(name)
    assert 0.01 < ball.drift < 0.02
    assert ball.J.mean() - 1.0 == pytest.approx(ball.drift, rel=0.05)
    assert ball.J.std() < 0.02 * ball.drift
    assert ball.across - 1.0 == pytest.approx(ball.drift, rel=0.05)
    assert ball.along == pytest.approx(1.0, abs=0.05 * ball.drift)


def test_results_do_not_depend_on_the_axis() -> None:
    """Axes of the grid agree to round-off, the oblique one up to the error of the lattice of points."""
    y, z, oblique = (rotation(name) for name in AXES)
    assert y.energy == pytest.approx(z.energy, rel=1e-10)
    assert oblique.energy == pytest.approx(z.energy, rel=1e-3)
    assert oblique.angular_momentum @ oblique.axis == pytest.approx(z.angular_momentum @ z.axis, rel=1e-4)
