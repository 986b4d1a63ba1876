"""Material of a polygon in the cells of a lattice of points: exact volumes, and the weight above a position.

A cell that the polygon cuts holds the part of it inside the polygon. If that is at least half of the cell, the cell's
point has its volume; smaller parts are added to the nearest such point, so that no point is small, and the sum is exact
to round-off.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mpmcol.case.outline import Outline

LEAST_SHARE = 0.5  # of its cell: the smallest volume of a point
ROUND_OFF = 1e-11  # shares that are closer to 0 or 1 are 0 or 1


def point_shares(
    outline: Outline, x_lines: np.ndarray, y_lines: np.ndarray, per_radian: bool, layers: np.ndarray | None = None
) -> np.ndarray:
    """Volume of each point over that of its cell, (n_x, n_y); 0 for cells without a point.

    Args:
        outline: counterclockwise.
        x_lines, y_lines: edges of the cells, (n_x + 1,) and (n_y + 1,), m, from 0 to at least the size of the outline.
        per_radian: whether volumes are per radian about x = 0 (axisymmetric), not per metre (plane strain).
        layers: number of the layer of each row of cells, (n_y,): small parts are added to points of the same layer, so
            that the mass of each layer is also exact. A layer without a point is added to the nearest ones.
    """
    power = 2 if per_radian else 1
    cell = np.outer(np.diff(x_lines**power) / power, np.diff(y_lines))
    volume = _volumes(outline, x_lines, y_lines, power)
    share = volume / cell
    share = np.where(np.abs(share - np.round(share)) < ROUND_OFF, np.round(share), share)
    is_point = share > LEAST_SHARE - ROUND_OFF
    if not is_point.any():
        return np.zeros_like(share)
    sizes = x_lines[1] - x_lines[0], y_lines[1] - y_lines[0]
    merged = np.zeros_like(share)
    np.add.at(merged, tuple(_nearest_points(is_point, sizes, layers)), share * cell)
    return merged / cell


def _nearest_points(is_point: np.ndarray, sizes: tuple[float, float], layers: np.ndarray | None) -> np.ndarray:
    """Indices (2, n_x, n_y) of the nearest cell with a point, of the same layer if that has one."""
    from scipy.ndimage import distance_transform_edt  # here, since it takes long to import

    nearest = np.empty((2, *is_point.shape), np.intp)
    rows = np.zeros(is_point.shape[1], np.intp) if layers is None else layers
    for layer in np.unique(rows):
        own = rows == layer
        candidates = is_point & own if (is_point & own).any() else is_point
        found = distance_transform_edt(~candidates, sizes, return_distances=False, return_indices=True)
        nearest[:, :, own] = found[:, :, own]
    return nearest


def _volumes(outline: Outline, x_lines: np.ndarray, y_lines: np.ndarray, power: int) -> np.ndarray:
    """Integral of x^(power - 1) over the part of each cell inside the polygon, (n_x, n_y).

    The polygon is counterclockwise: the material is on the right of edges that run downward, and on the left of those
    that run upward. By Green's theorem, an edge therefore adds, with the sign of -dy, the part of its own cell that is
    on its right, and in the same row all cells farther to the right.
    """
    n_x, n_y = len(x_lines) - 1, len(y_lines) - 1
    lines = np.append(x_lines, 2.0 * x_lines[-1] - x_lines[-2])  # edges on the last line lie in a cell beyond it
    rights, widths = lines[1:] ** power / power, np.diff(lines**power) / power
    beside, heights = np.zeros((n_x + 1, n_y + 1)), np.zeros((n_x + 1, n_y + 1))
    for start, end in _edges(outline):
        x, y = _split(start, end, x_lines, y_lines)
        i = np.clip(np.searchsorted(x_lines, 0.5 * (x[1:] + x[:-1]), "right") - 1, 0, n_x)
        j = np.clip(np.searchsorted(y_lines, 0.5 * (y[1:] + y[:-1]), "right") - 1, 0, n_y)
        mean = 0.5 * (x[1:] + x[:-1]) if power == 1 else (x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / 6.0
        np.add.at(beside, (i, j), -np.diff(y) * (rights[i] - mean))
        np.add.at(heights, (i, j), -np.diff(y))
    farther = np.cumsum(heights, axis=0) - heights
    return (beside + widths[:, None] * farther)[:n_x, :n_y]


def _edges(outline: Outline) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    points = np.array(outline)
    return zip(points, np.roll(points, -1, axis=0), strict=True)


def _split(start: np.ndarray, end: np.ndarray, x_lines: np.ndarray, y_lines: np.ndarray) -> tuple[np.ndarray, ...]:
    """Coordinates of an edge at its ends and where it crosses the lines of the lattice, in order along it."""
    parts = [np.array([0.0, 1.0])]
    for a, b, lines in zip(start, end, (x_lines, y_lines), strict=True):
        crossed = lines[(lines > min(a, b)) & (lines < max(a, b))]
        parts.append((crossed - a) / (b - a) if a != b else crossed)
    t = np.sort(np.concatenate(parts))
    x, y = (a + t * (b - a) for a, b in zip(start, end, strict=True))
    return x, y


def material_above(outline: Outline, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the material above positions (n,), (n,), m, without gaps of the outline; 0 beside it."""
    above = np.zeros_like(y)
    for (x_0, y_0), (x_1, y_1) in _edges(outline):
        crossed = (x >= min(x_0, x_1)) & (x < max(x_0, x_1))
        if x_0 != x_1:
            edge = y_0 + (x[crossed] - x_0) / (x_1 - x_0) * (y_1 - y_0)
            above[crossed] += np.sign(x_0 - x_1) * np.maximum(edge - y[crossed], 0.0)
    return above
