"""Faces of the walls whose forces are recorded: their rows of nodes, areas of the rows, and feet of the walls."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpmcol.case.walls import BACK_WALL, FLOOR, GATE_WALL
from mpmcol.measure.wall_forces import AXES
from mpmcol.mpm.boundary import AXIS
from mpmcol.mpm.grid import grid_shape, node_coordinates
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import splat
from mpmcol.setup.discretization import Discretization
from mpmcol.setup.geometry import VERTICAL
from mpmcol.setup.model import Model, make_boundaries
from mpmcol.setup.wall_boxes import WallBox

SAMPLES = 64  # per cell, of shape functions along a face


@dataclass(frozen=True)
class WallFace:
    """A face of a wall: its nodes, and their rows, along y of a vertical face and along x of a horizontal one."""

    wall: int  # number of the wall
    name: str  # "low_x", "high_x", "top", "low_z", "high_z": the side of the wall that it is on; "side": all around
    normals: np.ndarray  # (n, 3) into the wall at each node
    nodes: np.ndarray  # (n,) rows of its nodes in the table of contacts
    row: np.ndarray  # (n,) number of the row of each node
    position: np.ndarray  # (rows,) of each row, y or x, m
    area: np.ndarray  # (rows,) m2 (m per metre of width, m2 per radian)


@dataclass(frozen=True)
class WallFoot:
    """Where the moment on a wall is about: its foot on the column's side, at the level of the base.

    That on the floor is about the wall, axis or plane of symmetry at x = 0, at the level of the floor. The foot of a
    gate in three dimensions is the line around the column; each part of the gate overturns about its own.
    """

    wall: int
    normals: np.ndarray  # (n, 3) horizontal, from the column to the wall, at each node of the table; 0 for the floor
    distance: np.ndarray  # (n,) of the nodes from the foot along them, m


def contact_positions(model: Model) -> np.ndarray:
    """Positions (n, d) of the nodes in the table of contacts, m, in its order."""
    shape = grid_shape(model.grid)
    marked = np.zeros(shape, bool)
    for each in make_boundaries(model.grid, model.discretization, gate_opening=0.0):
        if each.wall is not None:
            marked |= each.nodes
    x = np.stack(np.broadcast_arrays(*node_coordinates(model.grid)), axis=-1)
    return np.asarray(x[marked])


def wall_feet(discretization: Discretization, positions: np.ndarray) -> tuple[WallFoot, ...]:
    """The feet of floor, gate, back wall and [[walls]], with the positions (n, d) of the nodes of the table."""
    spans = {box.name: _ends(discretization, box.low[0], box.high[0]) for box in discretization.wall_boxes}
    feet = {name: (low, 1.0) if low + high > 0.0 else (high, -1.0) for name, (low, high) in spans.items()}
    feet |= {BACK_WALL: (0.0, -1.0), FLOOR: (0.0, 1.0)}
    found = []
    for number, wall in enumerate(discretization.walls):
        if wall.name == GATE_WALL:  # it holds horizontal components only, so that the distance has no effect
            found.append(WallFoot(number, discretization.outward(positions), np.zeros(len(positions))))
        elif wall.name in feet:
            x, direction = feet[wall.name]
            level = np.zeros(3) if wall.name == FLOOR else direction * np.eye(3)[0]  # nodes of a floor have no arm
            normals = np.broadcast_to(level, (len(positions), 3))
            found.append(WallFoot(number, normals, direction * (positions[:, 0] - x)))
    return tuple(found)


def _ends(discretization: Discretization, low: int, high: int, axis: int = 0) -> tuple[float, float]:
    first, h = discretization.origin[axis], discretization.h
    return first + h * low, first + h * high


@dataclass(frozen=True)
class _Side:
    """A side of a wall: its name, direction and length, and which nodes of the table of contacts belong to it."""

    name: str
    axes: tuple[int, ...]  # of its normals
    normals: np.ndarray  # (3,) or (n, 3) into the wall
    length: float  # of each row of its nodes, m; per metre 1, per radian the radius
    limits: tuple[float, float] = (-np.inf, np.inf)  # of its nodes along the axis, m

    @property
    def along(self) -> int:
        """Axis along which its rows are one behind the other."""
        return 0 if self.axes == (VERTICAL,) else VERTICAL


def wall_faces(model: Model) -> tuple[WallFace, ...]:
    """The faces of all recorded walls; of the floor in two dimensions only."""
    discretization, positions = model.discretization, contact_positions(model)
    return tuple(
        _face(model, number, side, nodes, positions)
        for number, wall in enumerate(discretization.walls)
        for side in _sides(discretization, wall.name, positions)
        if len(nodes := _nodes_of(side, model.contacts.wall == number, positions))
    )


def _nodes_of(side: _Side, on_wall: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Rows in the table of contacts of the nodes of a side; on_wall: (n, 3) by axis."""
    low, high = side.limits
    x = positions[:, side.axes[0]]
    return np.flatnonzero(on_wall[:, side.axes].any(axis=1) & (x > low) & (x <= high))


def _sides(discretization: Discretization, name: str, positions: np.ndarray) -> Iterator[_Side]:
    into = np.eye(3)
    if name == FLOOR and discretization.dimension == 2:
        yield _Side("top", (VERTICAL,), -into[VERTICAL], 1.0)
    elif name == BACK_WALL:
        yield _Side("high_x", (0,), -into[0], 1.0)
    elif name == GATE_WALL:
        side, axes = ("low_x", (0,)) if discretization.dimension == 2 else ("side", (0, 2))
        yield _Side(side, axes, discretization.outward(positions), discretization.gate_length)
    for box in discretization.wall_boxes:
        if box.name == name:
            yield from _box_sides(discretization, box)


def _box_sides(discretization: Discretization, box: WallBox) -> Iterator[_Side]:
    """The faces of a box. Nodes inside it, which only points at its edges reach, count to the nearer face."""
    spans = [_ends(discretization, box.low[axis], box.high[axis], axis) for axis in range(discretization.dimension)]
    is_ring = discretization.faces[0][0] == AXIS
    for axis in (axis for axis in range(discretization.dimension) if axis != VERTICAL):
        low, high = spans[axis]
        last = discretization.cells[axis]
        middle = np.inf if box.high[axis] == last else -np.inf if box.low[axis] == 0 else 0.5 * (low + high)
        across = [spans[k][1] - spans[k][0] for k in (0, 2)[: discretization.dimension - 1] if k != axis]
        length, into = float(np.prod(across)), np.eye(3)[axis]
        yield _Side(f"low_{AXES[axis]}", (axis,), into, low if is_ring else length, (-np.inf, middle))
        yield _Side(f"high_{AXES[axis]}", (axis,), -into, high if is_ring else length, (middle, np.inf))
    width = 1.0 if discretization.dimension == 2 else spans[2][1] - spans[2][0]
    yield _Side("top", (VERTICAL,), -np.eye(3)[VERTICAL], width)


def _face(model: Model, wall: int, side: _Side, nodes: np.ndarray, positions: np.ndarray) -> WallFace:
    discretization, along = model.discretization, side.along
    position, row = np.unique(positions[nodes, along].round(12), return_inverse=True)
    rows = np.rint((position - discretization.origin[along]) / discretization.h).astype(np.intp)
    normals = np.broadcast_to(side.normals, (len(positions), 3))[nodes]
    area = side.length * _row_areas(model, along)[rows]
    return WallFace(wall, side.name, normals, nodes, row.reshape(-1), position, area)


def _row_areas(model: Model, axis: int) -> np.ndarray:
    """Part of an axis whose pressure a node carries, the integral of its shape function, (n,), m; of a radius, m2.

    It is h, and less at the first two and last two nodes of the domain.
    """
    is_radius = model.collapse.settings.axisymmetric and axis == 0
    n = grid_shape(model.grid)[axis]
    evaluate = SHAPE_FUNCTIONS[model.scheme.basis].evaluate
    areas = np.zeros(n + 4)
    for s in (np.arange((n - 1) * SAMPLES) + 0.5) / SAMPLES:
        base, *weights = evaluate(splat(s), splat(0.5), splat(n - 1.5), model.collapse.settings.kernel_correction)
        radius = s * model.grid.h if is_radius else 1.0
        areas[int(base[0]) : int(base[0]) + 4] += radius * np.array(weights[:4])[:, 0]
    return model.grid.h / SAMPLES * areas[:n]
