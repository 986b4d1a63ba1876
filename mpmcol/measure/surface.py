"""The top surface of a column, and what of it has not moved since the release."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mpmcol.measure.sections import Array, columns, locate
from mpmcol.measure.shape import ColumnShape

UNDISTURBED = 1e-3  # m: a point that moved less since release is undisturbed (the paper's Figure 9)


def undisturbed_radius(x: Array, displacement: Array, shape: ColumnShape) -> float:
    """Radius (m) within which no point of the top surface has moved by 1 mm since release; 0 if none.

    It ends half-way between the last point at rest and the first that moved. The surface is the top points of
    the columns as released; of a box, those of its section.
    """
    released = x - displacement
    top = _top(released, shape)
    distance, number = locate(released[top], shape)
    order = np.argsort(distance[number >= 0], kind="stable")
    top, distance = top[number >= 0][order], distance[number >= 0][order]
    moved = np.linalg.norm(displacement[top], axis=1) >= UNDISTURBED
    still = int(np.argmax(moved)) if moved.any() else len(top)
    if still == 0:
        return 0.0
    return float(distance[still - 1 : still + 1].mean() if still < len(top) else distance[-1] + shape.point_size / 2.0)


def _top(x: Array, shape: ColumnShape) -> NDArray[np.intp]:
    """Rows of the topmost points of all vertical columns that are one point wide."""
    column = columns(x, shape.point_size, shape)
    order = np.lexsort((x[:, 1], column))
    return order[np.diff(column[order], append=-1) != 0]


def failure_line(x: Array, displacement: Array, shape: ColumnShape, threshold: float) -> tuple[Array, Array]:
    """Where what has stayed ends and what has moved begins: distances (rows,) and heights (rows,) m, upward.

    One for each row of points as released, in two dimensions: the inner edge of its first point that has moved by
    `threshold` (m) since, or the end of a row of which none has.
    """
    released = x - displacement
    row = np.floor(released[:, 1] / shape.point_size).astype(np.intp)
    edge = np.zeros(row.max(initial=-1) + 1)
    np.maximum.at(edge, row, released[:, 0] + shape.point_size / 2.0)
    moved = np.linalg.norm(displacement, axis=1) >= threshold
    np.minimum.at(edge, row[moved], released[moved, 0] - shape.point_size / 2.0)
    return edge, shape.point_size * (np.arange(len(edge), dtype=np.float64) + 0.5)
