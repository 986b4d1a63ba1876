"""Points in space as a picture needs them: completed to the whole heap, projected in parallel, the hidden left out.

Positions are (n, 3) in m, y upward, the axis of the column is x = z = 0. Projected positions, (n, 3) in m too, count
to the right, upward and toward the viewer.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

MIRRORS = {"quarter": ((1, 1), (-1, 1), (-1, -1), (1, -1))}  # signs of x and z
TOP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
HIDDEN = 1.0  # point sizes behind the front from which on a point, which is a ball, is out of sight


def viewed_from(azimuth: float, elevation: float) -> np.ndarray:
    """Projection (3, 3), rows right, up and toward the viewer, who stands at these angles.

    azimuth: degrees from the z axis toward the x axis. elevation: degrees above the horizontal.
    """
    a, e = np.radians((azimuth, elevation))
    toward = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    return np.array([right, np.cross(toward, right), toward])


def whole(x: np.ndarray, model: str) -> tuple[np.ndarray, np.ndarray]:
    """Points (m, 3) of the whole heap, and (m,) which of the modelled points (n, 3) each of them is.

    A quarter is mirrored at its planes of symmetry.
    """
    signs = MIRRORS.get(model, ((1, 1),))
    return np.concatenate([x * (i, 1, k) for i, k in signs]), np.tile(np.arange(len(x)), len(signs))


def visible(projected: np.ndarray, point_size: float) -> np.ndarray:
    """Mask (n,) of the points that can be seen at least in part: the many inner points need not be drawn.

    A point hides what is behind the 3 x 3 cells around it, a square as wide as `point_size` (m), and is hidden itself
    where it lies behind the front of all 5 x 5 cells around it, those left out that show no point at all.
    """
    lowest = projected[:, :2].min(axis=0)
    column, row = np.rint((projected[:, :2] - lowest) / (point_size / 3.0)).astype(int).T
    nearest = np.full((column.max() + 7, row.max() + 7), -np.inf)
    np.maximum.at(nearest, (column + 3, row + 3), projected[:, 2])
    front = sliding_window_view(nearest, (3, 3)).max(axis=(2, 3))
    rearmost = sliding_window_view(np.where(np.isinf(front), np.inf, front), (5, 5)).min(axis=(2, 3))
    return projected[:, 2] >= rearmost[column, row] - HIDDEN * point_size


def circle(radius: float, y: float) -> np.ndarray:
    """Points (m, 3) of a circle about the axis, closed."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return np.column_stack([radius * np.cos(angle), np.full_like(angle, y), radius * np.sin(angle)])


def silhouette(x: np.ndarray, projection: np.ndarray, point_size: float) -> np.ndarray:
    """Closed outline (m, 2), projected, of a convex body that cubes of `point_size` (m) at the points (n, 3) fill."""
    angle = np.radians(np.arange(1.0, 360.0, 2.0))  # none along an axis, where a whole face is the farthest
    outward = np.column_stack([np.cos(angle), np.sin(angle)]) @ projection[:2]
    farthest = np.array([np.argmax(x @ direction) for direction in outward])
    outline = (x[farthest] + 0.5 * point_size * np.sign(outward)) @ projection[:2].T
    return np.vstack([outline, outline[:1]])
