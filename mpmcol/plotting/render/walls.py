"""Walls of `[[walls]]` in the views of a 3D model: their boxes, and their surfaces as points.

As points the surfaces are hidden by material before them, and hide material behind them, with every back end.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmcol.io.snapshot import Meta
from mpmcol.plotting.captions import tables_of_snapshot
from mpmcol.plotting.render.projection import MIRRORS

COLOR = 0.55  # grey level
VERTICAL = 1  # axis
SHADES = (0.8, 1.0, 0.65)  # brightness of faces with the normal x, y or z

EDGES = ("from", "to", "height", "half_width", "side_from", "side_to")

Box = tuple[tuple[float, float, float], tuple[float, float, float]]  # lowest and highest corner, m


def walls_on_grid(meta: Meta) -> list[dict[str, Any]]:
    """Tables of the walls of a case, with their edges on the nodes to which the run moved them; 0 is on a node."""
    h = float(meta["spacing"])
    walls = tables_of_snapshot(meta).get("walls", [])
    return [{key: h * round(value / h) if key in EDGES else value for key, value in wall.items()} for wall in walls]


def wall_boxes(meta: Meta, reach: float) -> list[Box]:
    """The walls of a 3D model, as they are in the grid, those of a quarter with their mirror images.

    reach: distance (m) from the axis at which walls without an end along x or z are cut. Those without a height are as
    high as the column.
    """
    if meta["model"] not in ("quarter", "full"):
        return []
    boxes: dict[Box, None] = {}
    for wall in walls_on_grid(meta):
        half, height = wall.get("half_width", reach), wall.get("height", float(meta["h_i"]))
        x = wall["from"], wall.get("to", max(reach, wall["from"]))
        z = wall.get("side_from", -half), wall.get("side_to", half)
        for sign_x, sign_z in MIRRORS.get(str(meta["model"]), ((1, 1),)):
            (x0, x1), (z0, z1) = sorted(sign_x * end for end in x), sorted(sign_z * end for end in z)
            boxes[(x0, 0.0, z0), (x1, height, z1)] = None
    return list(boxes)


def wall_surface(boxes: list[Box], spacing: float, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3), m, on the walls without their part in the quarter x > 0, z > 0, and their colours (n, 3).

    spacing: about that between points, m. reach: distance from the axis at which walls are cut, m.
    """
    parts = [part for box in boxes for part in _behind_cut(box)]
    faces = [face for part in parts for face in (*_faces(part, spacing), (_rim(part, spacing, reach), 0))]
    x = np.concatenate([np.zeros((0, 3)), *(points for points, _ in faces)])
    shades = np.concatenate([np.zeros(0), *(np.full(len(points), SHADES[axis]) for points, axis in faces)])
    near = np.hypot(x[:, 0], x[:, 2]) <= (1.0 + 1e-9) * reach
    return x[near], np.repeat(COLOR * shades[near, None], 3, axis=1)


def _behind_cut(box: Box) -> Iterator[Box]:
    """The parts of a box at z < 0, and at x < 0 and z > 0; all of it at x < 0."""
    (x0, y0, z0), (x1, y1, z1) = box
    if x1 <= 0.0:
        yield box
        return
    if z0 < 0.0:
        yield (x0, y0, z0), (x1, y1, min(z1, 0.0))
    if x0 < 0.0 < z1:
        yield (x0, y0, max(z0, 0.0)), (0.0, y1, z1)


def _faces(box: Box, spacing: float) -> Iterator[tuple[np.ndarray, int]]:
    """Points on the faces of a box, without the lower one, and the axis of the normal of each."""
    low, high = np.array(box)
    for axis, ends in enumerate(zip(low, high, strict=True)):
        for end in ends[axis == VERTICAL :]:
            lines = [_line(a, b, spacing) for a, b in zip(low, high, strict=True)]
            lines[axis] = np.array([end])
            yield np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3), axis


def _rim(box: Box, spacing: float, reach: float) -> np.ndarray:
    """Points (n, 3) where the cylinder of radius `reach` (m) cuts a box."""
    (x0, y0, z0), (x1, y1, z1) = box
    angle, y = np.meshgrid(_line(0.0, 2.0 * np.pi, spacing / reach), _line(y0, y1, spacing))
    x, z = reach * np.cos(angle), reach * np.sin(angle)
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()])[((x0 <= x) & (x <= x1) & (z0 <= z) & (z <= z1)).ravel()]


def _line(start: float, end: float, spacing: float) -> np.ndarray:
    return np.linspace(start, end, max(round((end - start) / spacing), 1) + 1)
