"""Boundary conditions: held components of each type, and their action on one node."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.mpm.boundary import (
    FREE,
    GATE,
    NO_SLIP,
    TYPES,
    Boundary,
    BoundaryType,
    apply_boundaries,
    constrain,
    face,
    hold_components,
    inactive_nodes,
    particle_limits,
    reaction_factors,
    set_inactive_nodes,
)
from mpmcol.mpm.grid import NODE, Grid, allocate_grid, grid_shape
from mpmcol.mpm.lanes import X
from mpmcol.mpm.settings import Settings
from mpmcol.mpm.simd import vector

CELLS, H, DT = (6, 5, 9), 0.5, 0.01
V = vector(0.0, 3.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0)
F = vector(0.0, 10.0, 20.0, -30.0, 0.0, 0.0, 0.0, 0.0)


def held(grid: Grid) -> np.ndarray:
    """Held components (n_x, n_y[, n_z], 3) by the bits of boundaries."""
    address = grid.ax[:, None, None] + grid.ay[:, None] + grid.az
    bits = grid.fixed[address // NODE].reshape(grid_shape(grid))
    return (bits[..., None] >> np.arange(3)) % 2 == 1


@pytest.mark.parametrize("side", [0, 1], ids=["low", "high"])
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("kind", TYPES, ids=lambda kind: kind.name)
def test_a_face_holds_the_components_of_its_type(kind: BoundaryType, d: int, side: int) -> None:
    for axis in range(d):
        grid = allocate_grid((0.0,) * d, H, CELLS[:d])
        apply_boundaries(grid, [face(grid, kind, axis, side)])
        on_face = np.zeros((*grid_shape(grid), 3), bool)
        components = {"all": range(d), "normal": [axis], "none": []}[kind.holds]
        np.moveaxis(on_face, axis, 0)[-side][..., list(components)] = True
        np.testing.assert_array_equal(held(grid), on_face)


def test_a_zone_reaches_its_number_of_cells_from_the_face() -> None:
    grid = allocate_grid((0.0, 0.0), H, CELLS[:2])
    apply_boundaries(grid, [face(grid, GATE, 0, 1, cells=2)])
    np.testing.assert_array_equal(held(grid)[..., 0].all(axis=1), [False] * 4 + [True] * 3)


def test_boundaries_replace_earlier_ones_and_keep_nodes_of_inactive_points() -> None:
    grid = allocate_grid((0.0, 0.0), H, CELLS[:2])
    set_inactive_nodes(grid, np.array([3, 7]))
    apply_boundaries(grid, [face(grid, NO_SLIP, 1, 0)])
    apply_boundaries(grid, [face(grid, FREE, 1, 0)])
    assert not held(grid).any()
    np.testing.assert_array_equal(inactive_nodes(grid), [3, 7])
    set_inactive_nodes(grid, np.array([5]))
    np.testing.assert_array_equal(inactive_nodes(grid), [5])


def test_boundaries_on_the_same_node_add_up() -> None:
    one, other = (allocate_grid((0.0, 0.0), H, CELLS[:2]) for _ in range(2))
    x_nodes, y_nodes = np.arange(7)[:, None] > 4, np.arange(6)[None, :] < 2
    apply_boundaries(one, [Boundary(GATE, 0, x_nodes), Boundary(GATE, 1, y_nodes)])
    hold_components(other, x_nodes, y_nodes)
    np.testing.assert_array_equal(held(one), held(other))
    np.testing.assert_array_equal(held(one)[6, 0], [True, True, False])


@pytest.mark.parametrize("mask", [0b010, 0b010000], ids=["boundary", "inactive points"])
@pytest.mark.parametrize("wall_impulse", [True, False])
def test_a_held_component_stops_and_its_reaction_reaches_the_particles(wall_impulse: bool, mask: int) -> None:
    """Twice the work on the boundary per mass is v^2, with the work of the forces v (v + dt f)."""
    factors = reaction_factors(Settings(wall_impulse=wall_impulse), DT)
    is_held, v, a, work = constrain(np.uint8(mask), V, F, 0.5 * F, DT, factors)
    np.testing.assert_array_equal(is_held, vector(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    np.testing.assert_allclose(v, np.where(is_held, 0.0, V + DT * 0.5 * F))
    assert a[2] == pytest.approx(2.0 / DT if wall_impulse else 0.0)
    np.testing.assert_array_equal(np.delete(a, 2), np.delete(0.5 * F, 2))
    expected = (-2.0) * (-2.0 + DT * 20.0) if wall_impulse else 4.0
    np.testing.assert_allclose(work, expected * np.array(is_held))


@pytest.mark.parametrize(("d", "axisymmetric", "low"), [(2, False, 0.1), (2, True, 0.3), (3, False, 0.1)])
def test_particles_keep_their_distance_from_the_faces(d: int, axisymmetric: bool, low: float) -> None:
    grid = allocate_grid((1.0, 2.0, 3.0)[:d], H, CELLS[:d])
    lower, upper = particle_limits(grid, Settings(axisymmetric=axisymmetric, axis_gap=0.3))
    origin = np.array((1.0, 2.0, 3.0)[:d])
    gaps = np.array((low, 0.1, 0.1)[:d])
    np.testing.assert_allclose(lower[X : X + d], origin + H * gaps)
    np.testing.assert_allclose(upper[X : X + d], origin + H * (np.array(CELLS[:d]) - 0.1))
    others = np.delete(np.arange(8), range(X, X + d))
    assert np.all(np.isneginf(lower[others])) and np.all(np.isposinf(upper[others]))
