"""Walls with friction: the table of their nodes, and their action on one node."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcol.mpm.boundary import CONTACT, CONTACT_BIT, NO_SLIP, ROLLER, apply_boundaries, face, set_inactive_nodes
from mpmcol.mpm.contact import (
    FRICTION_WORK,
    friction_work,
    has_friction,
    make_contacts,
    no_contacts,
    slide,
    touch_walls,
    wall_impulses,
)
from mpmcol.mpm.grid import NODE, Grid, allocate_grid, grid_shape
from mpmcol.mpm.simd import splat, vector

H, DT, M = 0.5, 0.1, 2.0
ZERO, Y = splat(0.0), vector(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def grid_of(d: int = 3) -> Grid:
    return allocate_grid((0.0,) * d, H, (6, 5, 4)[:d])


def numbers(grid: Grid) -> np.ndarray:
    return (grid.ax[:, None, None] + grid.ay[:, None] + grid.az).reshape(grid_shape(grid)) // NODE


def lanes(x: float, y: float, z: float) -> np.ndarray:
    return vector(0.0, x, y, z, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("d", [2, 3])
def test_the_table_holds_the_marked_nodes_and_their_walls(d: int) -> None:
    grid = grid_of(d)
    floor = face(grid, CONTACT, 1, 0)._replace(wall=0, friction=0.3)
    end = face(grid, CONTACT, 0, 1)._replace(wall=2, friction=0.5)
    side = face(grid, ROLLER, 0, 0)._replace(wall=1)
    boundaries = [floor, end, side, face(grid, ROLLER, 1, 1)]
    apply_boundaries(grid, boundaries)
    set_inactive_nodes(grid, np.array([1]))  # marks remain
    contacts = make_contacts(grid, boundaries)
    expected = np.zeros(grid_shape(grid), bool)
    expected[[0, -1]] = expected[:, 0] = True
    marked = (grid.fixed & CONTACT_BIT).astype(bool)[numbers(grid)]
    np.testing.assert_array_equal(marked, expected)
    slots = contacts.slot[numbers(grid)[marked]]
    np.testing.assert_array_equal(slots, np.arange(marked.sum()))
    corner, low = (contacts.slot[numbers(grid)[(i, 0, 0)[:d]]] for i in (-1, 0))
    assert contacts.wall[corner].tolist() == [2, 0, -1] and contacts.wall[low].tolist() == [1, 0, -1]
    assert contacts.side[corner].tolist() == [1.0, -1.0, 0.0] and contacts.side[low].tolist() == [0.0, -1.0, 0.0]
    assert contacts.friction[corner].tolist() == [0.5, 0.3, 0.0]
    assert has_friction(contacts) and not has_friction(no_contacts())


def test_coulombs_law() -> None:
    """|v_t| is reduced by mu v_n, in the direction of sliding, but not reversed; away from the wall it is unchanged."""
    presses, v = slide(lanes(3.0, -2.0, 4.0), Y, -1.0, 0.5)
    assert presses == 1.0
    np.testing.assert_allclose(v, lanes(3.0, 0.0, 4.0) * 0.8, rtol=1e-15)
    np.testing.assert_array_equal(slide(lanes(3.0, -2.0, 4.0), Y, -1.0, 2.5)[1], ZERO)
    np.testing.assert_array_equal(slide(lanes(3.0, -2.0, 4.0), Y, -1.0, 0.0)[1], lanes(3.0, 0.0, 4.0))
    for v, side in ((lanes(3.0, 2.0, 4.0), -1.0), (lanes(3.0, -2.0, 4.0), 1.0), (lanes(3.0, 0.0, 4.0), -1.0)):
        presses, after = slide(v, Y, side, 0.5)
        assert presses == 0.0
        np.testing.assert_array_equal(after, v)


def test_impulse_and_work_on_a_floor_with_friction() -> None:
    grid = grid_of()
    floor = face(grid, CONTACT, 1, 0)._replace(wall=0, friction=0.5)
    contacts = make_contacts(grid, [floor])
    raw, f = lanes(2.0, -1.0, 0.0), lanes(10.0, -10.0, 0.0)  # v* = (3, -2, 0)
    held, v, a, work = touch_walls(contacts, 3, M, raw, f, ZERO, ZERO, ZERO, ZERO, DT)
    np.testing.assert_allclose(v, lanes(2.0, 0.0, 0.0), rtol=1e-15)
    np.testing.assert_allclose(a, lanes(0.0, 10.0, 0.0), atol=1e-14)
    assert np.all(held > 0.0)
    np.testing.assert_allclose(wall_impulses(contacts, 1), [[M * 1.0, M * -2.0, 0.0]], rtol=1e-15)
    np.testing.assert_allclose(work[1:4], [1.0 * (2.0 + 2.0), -2.0 * (-1.0 + 0.0), 0.0], rtol=1e-15)
    assert friction_work(contacts) == pytest.approx(0.5 * M * 1.0 * 4.0, rel=1e-15)


def test_impulses_on_walls_that_hold_their_nodes_leave_the_motion_unchanged() -> None:
    """A component goes to the wall with that normal; the floor takes the others."""
    grid = grid_of()
    walls = [face(grid, NO_SLIP, 1, 0)._replace(wall=0), face(grid, ROLLER, 0, 0)._replace(wall=1)]
    contacts = make_contacts(grid, walls)
    slot = int(contacts.slot[numbers(grid)[0, 0, 1]])
    state = (lanes(1.0, 1.0, 1.0), ZERO, lanes(7.0, 8.0, 9.0), lanes(4.0, 5.0, 6.0))
    raw, f = lanes(1.0, 2.0, 3.0), lanes(10.0, 20.0, 30.0)
    for new, old in zip(touch_walls(contacts, slot, M, raw, f, *state, DT), state, strict=True):
        np.testing.assert_array_equal(new, old)
    np.testing.assert_allclose(wall_impulses(contacts, 2), M * np.array([[0.0, 4.0, 6.0], [2.0, 0.0, 0.0]]), rtol=1e-15)
    assert not contacts.sums[:, FRICTION_WORK].any()
