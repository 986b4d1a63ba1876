"""Walls with Coulomb friction, and the impulses on all walls whose force is asked for, from node impulses.

A marked node (`CONTACT_BIT` of its mask) has a row in a table: for each axis the wall whose normal has that axis, and
the sums of its impulses. Rows are written by one tile each, so that sums do not depend on the number of threads.
The side walls of a channel in plane strain act on the points instead (`mpmcol.mpm.kernels.side_walls`).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from mpmcol.mpm.boundary import CONTACT, Boundary
from mpmcol.mpm.grid import NODE, Grid, grid_shape
from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import extract, reduce_sum, splat, sqrt, vector, where_positive

NO_WALL = -1
CONTACT_ORDER = (1, 0, 2)  # axes in the order in which the walls of a node act: the floor first
FRICTION_WORK, SUMS = 9, 10  # of a row: the impulse on the wall with normal axis k is at 3 k to 3 k + 2


class Contacts(NamedTuple):
    """Table of the nodes on walls that have friction or whose impulse is recorded, and the side walls of a channel."""

    slot: np.ndarray  # (n_addresses,) int32: row of a marked node; empty without walls
    wall: np.ndarray  # (n, 3) int8: number of the wall whose normal is along the axis, or NO_WALL
    side: np.ndarray  # (n, 3): sign of the direction into a wall with friction; 0 for others
    friction: np.ndarray  # (n, 3): coefficient mu
    # (n + 1, SUMS): impulses on the walls (N s) and work of friction (J) since the start of the ledger; the last row is
    # that of the side walls
    sums: np.ndarray
    side_friction: float  # 2 mu / W of the side walls of a channel of width W, 1/m; 0: none


def make_contacts(grid: Grid, boundaries: Iterable[Boundary], side_friction: float = 0.0) -> Contacts:
    """The table of all nodes of boundaries with the number of a wall; it must comprise all that are ever marked."""
    walls = [each for each in boundaries if each.wall is not None]
    shape = grid_shape(grid)
    marked = np.zeros(shape, bool)
    for each in walls:
        marked |= each.nodes
    address = (grid.ax[:, None, None] + grid.ay[:, None] + grid.az).reshape(shape)[marked] // NODE
    slot = np.zeros(len(grid.fixed) if walls else 0, np.int32)
    slot[address] = np.arange(len(address))
    wall = np.full((len(address), 3), NO_WALL, np.int8)
    side, friction = np.zeros((2, len(address), 3))
    for each in walls:
        rows = np.broadcast_to(each.nodes, shape)[marked]
        wall[rows, each.axis] = NO_WALL if each.wall is None else each.wall
        if each.type == CONTACT:
            side[rows, each.axis] = 1.0 if each.side else -1.0
            friction[rows, each.axis] = each.friction
    return Contacts(slot, wall, side, friction, np.zeros((len(address) + 1, SUMS)), side_friction)


def no_contacts() -> Contacts:
    """The table of a model without such walls."""
    none = np.zeros((0, 3))
    return Contacts(np.zeros(0, np.int32), np.zeros((0, 3), np.int8), none, none, np.zeros((1, SUMS)), 0.0)


def wall_impulses(contacts: Contacts, walls: int) -> np.ndarray:
    """Impulse (walls, 3) on each of the first `walls` walls since the start of the ledger, N s."""
    impulses = contacts.sums[:-1, :FRICTION_WORK].reshape(-1, 3, 3)
    return np.array([impulses[contacts.wall == number].sum(axis=0) for number in range(walls)]).reshape(walls, 3)


def has_friction(contacts: Contacts) -> bool:
    """Whether any wall is one with friction."""
    return bool(contacts.side.any() or contacts.side_friction)


def friction_sums(contacts: Contacts) -> np.ndarray:
    """Work of friction (n,) since the start of the ledger at each node of walls with it, and on the side walls, J."""
    return contacts.sums[np.append(contacts.side.any(axis=1), contacts.side_friction > 0.0), FRICTION_WORK]


def friction_work(contacts: Contacts) -> float:
    """Work of friction on all walls since the start of the ledger, J."""
    return float(friction_sums(contacts).sum())


def side_work(contacts: Contacts) -> float:
    """Work of friction on the side walls since the start of the ledger, J."""
    return float(contacts.sums[-1, FRICTION_WORK])


@device
def normal_of(axis: int) -> Any:
    """One in the lane of the velocity component along an axis."""
    return vector(0.0, int(axis == 0), int(axis == 1), int(axis == 2), 0.0, 0.0, 0.0, 0.0)


@device
def slide(v: Any, normal: Any, side: float, friction: float) -> tuple[float, Any]:
    """Whether a node of velocity v (m/s) presses on a wall (1 or 0), and its velocity after contact.

    The wall stops the normal component v_n; by Coulomb's law its tangential impulse is at most mu times the normal one:
    v_t max(0, 1 - mu v_n / |v_t|). A node that moves away from the wall is free.
    """
    approach = side * reduce_sum(normal * v)
    if not approach > 0.0:
        return 0.0, v
    tangential, limit = where_positive(normal, 0.0, v), friction * approach
    speed = sqrt(reduce_sum(tangential * tangential))
    return 1.0, tangential * (1.0 - limit / speed if speed > limit else 0.0)


@device
def slide_on_walls(contacts: Contacts, slot: int, v: Any) -> Any:
    """The nodal velocity v (m/s) after contact with the walls of a row, for a stress update without motion."""
    for axis in CONTACT_ORDER:
        _, v = slide(v, normal_of(axis), contacts.side[slot, axis], contacts.friction[slot, axis])
    return v


@device
def touch_walls(
    contacts: Contacts, slot: int, m: float, raw: Any, f: Any, held: Any, v: Any, a: Any, work: Any, dt: float
) -> tuple[Any, Any, Any, Any]:
    """Contact of a node with the walls of a row, and the impulses on them.

    raw: velocity (m/s) before the step. f: force per mass without damping (m/s2). held, v, a, work: as `constrain`
    returns them. Nodes of walls with friction have no local damping, which would add to the friction of a steady
    flow. A wall receives the impulse m (v* - v~), v* without its reaction; where other boundaries hold a component, the
    wall with that normal receives its impulse, or the first wall of the node. Work per mass of the impulse:
    (v* - v~) . (v + v~) / 2, v before the step; it is friction except along the normals of the walls pressed on.

    Returns held, v, a and work, each with the contact; held is one in all components that have no damping.
    """
    walls, sides, frictions, sums = contacts.wall, contacts.side, contacts.friction, contacts.sums
    undamped, zero = raw + dt * f, splat(0.0)
    has_friction = abs(sides[slot, 0]) + abs(sides[slot, 1]) + abs(sides[slot, 2])
    arrested, free = where_positive(held, undamped, 0.0), where_positive(held, 0.0, undamped)
    contact = splat(has_friction)
    start = where_positive(contact, free, v)
    v_after, pressed = start, zero
    rest = vector(0.0, int(walls[slot, 0] < 0), int(walls[slot, 1] < 0), int(walls[slot, 2] < 0), 0.0, 0.0, 0.0, 0.0)
    for axis in CONTACT_ORDER:
        if walls[slot, axis] < 0:
            continue
        normal = normal_of(axis)
        presses, slid = slide(v_after, normal, sides[slot, axis], frictions[slot, axis])
        impulse = m * (where_positive(normal + rest, arrested, 0.0) + (v_after - slid))
        for k in range(3):
            sums[slot, 3 * axis + k] += extract(impulse, 1 + k)
        v_after, pressed, rest = slid, pressed + presses * normal, zero
    lost = (start - v_after) * (raw + v_after)
    sums[slot, FRICTION_WORK] += 0.5 * m * reduce_sum(where_positive(pressed, 0.0, lost))
    a_after = where_positive(contact, (v_after - raw) * (1.0 / dt), a)
    return held + contact, v_after, a_after, work + lost
