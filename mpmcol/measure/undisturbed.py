"""Undisturbed part of the top surface of a column, and the failure line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mpmcol.measure.sections import Array, column_index, locate
from mpmcol.measure.shape import ColumnShape

UNDISTURBED = 0.01  # limit of the displacement of undisturbed points over r_i: 1 mm in Figure 9 of the paper


def undisturbed_radius(x: Array, displacement: Array, shape: ColumnShape) -> float:
    """Radius within which no point of the top surface has moved by r_i/100 or more since release, m; 0 if none.

    It lies half-way between the last undisturbed point and the first that moved. The top surface consists of the
    topmost points of the vertical columns as released; for a box, those of its section.
    """
    released = x - displacement
    top = _top(released, shape)
    distance, number = locate(released[top], shape)
    order = np.argsort(distance[number >= 0], kind="stable")
    top, distance = top[number >= 0][order], distance[number >= 0][order]
    moved = np.linalg.norm(displacement[top], axis=1) >= UNDISTURBED * shape.r_i
    still = int(np.argmax(moved)) if moved.any() else len(top)
    if still == 0:
        return 0.0
    return float(distance[still - 1 : still + 1].mean() if still < len(top) else distance[-1] + shape.point_size / 2.0)


def _top(x: Array, shape: ColumnShape) -> NDArray[np.intp]:
    """Indices of the topmost points of all vertical columns, which are one point wide."""
    column = column_index(x, shape.point_size, shape)
    order = np.lexsort((x[:, 1], column))
    return order[np.diff(column[order], append=-1) != 0]


def failure_line(x: Array, displacement: Array, shape: ColumnShape, threshold: float) -> tuple[Array, Array]:
    """Boundary between undisturbed and displaced material in 2D: distances (rows,) and heights (rows,), m, upward.

    For each row of points as released, the inner edge of the first point that has moved by `threshold` (m) or more
    since; the end of the row if no point has.
    """
    released = x - displacement
    row = np.floor(released[:, 1] / shape.point_size).astype(np.intp)
    edge = np.zeros(row.max(initial=-1) + 1)
    np.maximum.at(edge, row, released[:, 0] + shape.point_size / 2.0)
    moved = np.linalg.norm(displacement, axis=1) >= threshold
    np.minimum.at(edge, row[moved], released[moved, 0] - shape.point_size / 2.0)
    return edge, shape.point_size * (np.arange(len(edge), dtype=np.float64) + 0.5)
