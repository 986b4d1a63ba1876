"""Faces of the walls whose forces are recorded: their rows of nodes, areas of the rows, and feet of the walls."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mpmcol.case.walls import BACK_WALL, FLOOR, GATE_WALL
from mpmcol.mpm.grid import grid_shape, node_coordinates
from mpmcol.mpm.shape_functions import SHAPE_FUNCTIONS
from mpmcol.mpm.simd import splat
from mpmcol.setup.discretization import Discretization
from mpmcol.setup.geometry import VERTICAL
from mpmcol.setup.model import Model, make_boundaries

SAMPLES = 64  # per cell, of shape functions along a face
AXES = ("x", "y", "z")


@dataclass(frozen=True)
class WallFace:
    """A face of a wall: its nodes, and their rows, along y of a vertical face and along x of a horizontal one."""

    wall: int  # number of the wall
    name: str  # "low_x", "high_x", "top", "low_z", "high_z": the side of the wall that it is on
    axis: int  # of its normal
    sign: float  # of the direction into the wall
    nodes: np.ndarray  # rows of its nodes in the table of contacts
    row: np.ndarray  # (n,) number of the row of each node
    position: np.ndarray  # (rows,) of each row, y or x, m
    area: np.ndarray  # (rows,) m2 (m per metre of width, m2 per radian)


@dataclass(frozen=True)
class WallFoot:
    """Where the moment on a wall is about: a line through its foot on the column's side, at the level of the base."""

    wall: int
    x: float  # m
    direction: float  # 1 or -1: from the column to the wall along x, in which a positive moment overturns it


def contact_positions(model: Model) -> np.ndarray:
    """Positions (n, d) of the nodes in the table of contacts, m, in its order."""
    shape = grid_shape(model.grid)
    marked = np.zeros(shape, bool)
    for each in make_boundaries(model.grid, model.discretization, gate_opening=0.0):
        if each.wall is not None:
            marked |= each.nodes
    x = np.stack(np.broadcast_arrays(*node_coordinates(model.grid)), axis=-1)
    return np.asarray(x[marked])


def wall_feet(discretization: Discretization) -> tuple[WallFoot, ...]:
    """The feet of gate and back wall, in two dimensions, and of all walls of [[walls]]."""
    spans = {box.name: _ends(discretization, box.low[0], box.high[0]) for box in discretization.wall_boxes}
    feet = {name: (low, 1.0) if low + high > 0.0 else (high, -1.0) for name, (low, high) in spans.items()}
    if discretization.dimension == 2:
        feet |= {BACK_WALL: (0.0, -1.0), GATE_WALL: (discretization.r_i, 1.0)}
    return tuple(
        WallFoot(number, *feet[wall.name]) for number, wall in enumerate(discretization.walls) if wall.name in feet
    )


def _ends(discretization: Discretization, low: int, high: int, axis: int = 0) -> tuple[float, float]:
    first, h = discretization.origin[axis], discretization.h
    return first + h * low, first + h * high


def wall_faces(model: Model) -> tuple[WallFace, ...]:
    """The faces of all recorded walls; of floor, back wall and gate in two dimensions only."""
    discretization, positions = model.discretization, contact_positions(model)
    boxes = {box.name: box for box in discretization.wall_boxes}
    faces: list[WallFace] = []
    for number, wall in enumerate(discretization.walls):
        if wall.name not in boxes and discretization.dimension == 3:
            continue
        sides = _box_sides(discretization, wall.name) if wall.name in boxes else iter([SIDES[wall.name]])
        for name, axis, sign, low, high in sides:
            own = (model.contacts.wall[:, axis] == number) & (positions[:, axis] > low) & (positions[:, axis] <= high)
            if own.any():
                faces.append(_face(model, number, name, axis, sign, np.flatnonzero(own), positions))
    return tuple(faces)


# name, axis and sign of the face of a wall, and limits of its nodes along the axis
SIDES = {
    FLOOR: ("top", VERTICAL, -1.0, -np.inf, np.inf),
    BACK_WALL: ("high_x", 0, -1.0, -np.inf, np.inf),
    GATE_WALL: ("low_x", 0, 1.0, -np.inf, np.inf),
}


def _box_sides(discretization: Discretization, name: str) -> Iterator[tuple[str, int, float, float, float]]:
    """The faces of a box. Nodes inside it, which only points at its edges reach, count to the nearer face."""
    (box,) = (box for box in discretization.wall_boxes if box.name == name)
    for axis in (axis for axis in range(discretization.dimension) if axis != VERTICAL):
        low, high = _ends(discretization, box.low[axis], box.high[axis], axis)
        last = discretization.cells[axis]
        middle = np.inf if box.high[axis] == last else -np.inf if box.low[axis] == 0 else 0.5 * (low + high)
        yield f"low_{AXES[axis]}", axis, 1.0, -np.inf, middle
        yield f"high_{AXES[axis]}", axis, -1.0, middle, np.inf
    yield "top", VERTICAL, -1.0, -np.inf, np.inf


def _face(
    model: Model, wall: int, name: str, axis: int, sign: float, nodes: np.ndarray, positions: np.ndarray
) -> WallFace:
    discretization, grid = model.discretization, model.grid
    along = 0 if axis == VERTICAL else VERTICAL
    across = [k for k in range(discretization.dimension) if k not in (axis, along)]
    position, row = np.unique(positions[nodes, along].round(12), return_inverse=True)
    area = _row_areas(model, along)[np.rint((position - discretization.origin[along]) / grid.h).astype(np.intp)]
    for k in across:
        area = area * np.ptp(positions[nodes, k])
    if model.collapse.settings.axisymmetric and along == VERTICAL:
        area = area * positions[nodes, 0].max()
    return WallFace(wall, name, axis, sign, nodes, row.reshape(-1), position, area)


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
