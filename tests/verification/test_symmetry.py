"""A collapse in rotated axes, and a plane collapse as a slab in 3D, are equal to round-off.

The growth of round-off is measured with a second run, in which every point is displaced by 1e-12 h. In the few hundred
steps of these tests the difference grows to 3e-12 h and 2e-10 of the largest stress; the difference between rotated
runs is a fiftieth of that. Over a whole collapse both grow without bound, and round-off decides where single particles
come to rest.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from mpmcol.failure_modes.toolkit import (
    DENSITY,
    K_ACTIVE,
    PLAIN,
    SIDES,
    G,
    advance_steps,
    by_id,
    elastic_body,
    joined,
    lattice,
    make_solver,
    points_at,
    sand_body,
    walled_grid,
)
from mpmcol.mpm.boundary import hold_components
from mpmcol.mpm.grid import node_coordinates
from mpmcol.mpm.particles import COLUMN, Points

H, YOUNG = 0.01, 1e6
DAMPED = PLAIN._replace(alpha_d=0.05)
DISPLACEMENT = 1e-12  # in cells
SAND, ELASTIC = sand_body(youngs_modulus=YOUNG), elastic_body(youngs_modulus=YOUNG)


class State(NamedTuple):
    """Positions (in cells), velocities (m/s), and stresses (n, 3, 3) over the weight of the column per area."""

    x: np.ndarray
    v: np.ndarray
    sigma: np.ndarray


def state_of(points: Points, height: float) -> State:
    sigma = points.sigma[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    return State(points.x / H, points.v.copy(), sigma / (DENSITY * G * height))


def assert_equal_to_round_off(got: State, expected: State, displaced: State) -> None:
    """The difference is less than that of the displaced run, which itself is small."""
    for one, same, other in zip(got, expected, displaced, strict=True):
        tolerance = np.abs(other - same).max()
        assert tolerance < 1e3 * DISPLACEMENT
        assert np.abs(one - same).max() < tolerance


def at_active_yield(x: np.ndarray, height: float) -> Points:
    """Sand under its own weight at active yield, as when a gate opens."""
    points = points_at(x, H / 2, COLUMN)
    vertical = -DENSITY * G * (height - x[:, 1])
    points.sigma = np.stack([K_ACTIVE * vertical, vertical, K_ACTIVE * vertical, *3 * [0.0 * vertical]], axis=1)
    return points


def displaced_points(points: Points, by: float) -> Points:
    points.x[:] += by * H * np.random.default_rng(9).uniform(-1.0, 1.0, points.x.shape)
    return points


HEIGHT, WIDTH, LAYERS = 6 * H, 4 * H, 4


@cache
def collapsing_slab(d: int, displacement: float = 0.0) -> State:
    """A column on a rigid floor after 600 steps: in plane strain, or as a slab two cells deep between rollers.

    The rollers are inside the grid, since material must stay two cells away from its ends. Nodes beyond them have no
    effect: the mass and momentum that they receive have the same velocity.
    """
    x = lattice((0.0, 0.0, 3 * H)[:d], (WIDTH, HEIGHT, 5 * H)[:d], H / 2)
    grid = walled_grid((0.0,) * d, H, (16, 8, 8)[:d])
    left, up, *across = node_coordinates(grid)
    floor = up < 0.5 * H
    hold_components(grid, floor | (left < 0.5 * H), floor, *(floor | (z < 3.5 * H) | (z > 4.5 * H) for z in across))
    solver = make_solver(displaced_points(at_active_yield(x, HEIGHT), displacement), grid, DAMPED, SAND)
    advance_steps(solver, 600)
    assert 1.5 * WIDTH < solver.points.x[:, 0].max() < 13 * H
    return state_of(by_id(solver), HEIGHT)


def test_plane_column_and_slab_collapse_alike() -> None:
    plane, slab = collapsing_slab(2), collapsing_slab(3)
    expected = State(*(np.repeat(part, LAYERS, axis=0) for part in plane))
    displaced = State(*(np.repeat(part, LAYERS, axis=0) for part in collapsing_slab(2, DISPLACEMENT)))
    assert_equal_to_round_off(State(slab.x[:, :2], slab.v[:, :2], slab.sigma), expected, displaced)
    assert np.abs(slab.v[:, 2]).max() < 1e-12
    np.testing.assert_allclose(slab.x[:, 2].reshape(-1, LAYERS), np.tile([3.25, 3.75, 4.25, 4.75], (len(plane.x), 1)))


ROTATIONS = {
    "rotated by 90 degrees": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
    "mirrored": [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "x and z swapped": [[0, 0, 1], [0, 1, 0], [1, 0, 0]],
    "upside down": [[1, 0, 0], [0, -1, 0], [0, 0, 1]],
    "gravity along x": [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
    "gravity along z": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
}
CELLS, BASE_CELLS, TALL = 14, 3, 5 * H  # sand must stay two cells away from all ends


def moving_column() -> Points:
    """A box-shaped column off the centre of an elastic base, with random velocities."""
    end, floor = CELLS // 2 * H, -CELLS // 2 * H
    base = points_at(lattice((-end, floor, -end), (end, floor + BASE_CELLS * H, end), H / 2), H / 2)
    column = at_active_yield(lattice((-2 * H, 0.0, -H), (H, TALL, 3 * H), H / 2), TALL)
    column.x[:, 1] += floor + BASE_CELLS * H
    points = joined(base, column)
    points.v[:] = np.random.default_rng(8).normal(0.0, 0.05, points.v.shape)
    return points


def rotated(points: Points, R: np.ndarray) -> Points:
    """The same points in rotated axes."""
    points.x[:], points.v[:] = points.x @ R.T, points.v @ R.T
    sigma = R @ points.sigma[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]] @ R.T
    points.sigma = sigma[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    return points


@cache
def collapsed_column(name: str = "", displacement: float = 0.0) -> State:
    """The column after 300 steps in rotated axes: gravity acts towards another face of the grid, the floor."""
    R = np.array(ROTATIONS.get(name, np.eye(3)), float)
    down = R @ [0.0, -1.0, 0.0]
    axis = int(np.argmax(np.abs(down)))
    grid = walled_grid((-CELLS // 2 * H,) * 3, H, (CELLS,) * 3, no_slip=SIDES[axis][int(down[axis] > 0.0)])
    gravity = dict(zip(("gravity_x", "gravity_y", "gravity_z"), (G * down).tolist(), strict=True))
    points = displaced_points(rotated(moving_column(), R), displacement)
    solver = make_solver(points, grid, DAMPED._replace(**gravity, open_low_sides=True), SAND, body=ELASTIC)
    advance_steps(solver, 300)
    return state_of(rotated(by_id(solver), R.T), TALL)


@pytest.mark.parametrize("name", ROTATIONS)
def test_a_collapse_is_the_same_in_rotated_axes(name: str) -> None:
    expected = collapsed_column()
    assert_equal_to_round_off(collapsed_column(name), expected, collapsed_column("", DISPLACEMENT))
