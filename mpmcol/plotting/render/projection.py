"""Geometry of the 3D views: completion by symmetry, parallel projection and removal of hidden points.

Positions are (n, 3) in m, y upward, with the column axis at x = z = 0. Projected positions, (n, 3) in m, are measured
to the right, upward and toward the viewer.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

MIRRORS = {"quarter": ((1, 1), (-1, 1), (-1, -1), (1, -1))}  # signs of x and z
# projection of the view from above: z to the right, x upward, y toward the viewer, which is right-handed
TOP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
HIDDEN_DEPTH = 1.0  # point sizes behind the visible surface beyond which a point, drawn as a sphere, is hidden


def view_projection(azimuth: float, elevation: float) -> np.ndarray:
    """Projection (3, 3) with the rows right, up and toward the viewer.

    azimuth: of the viewer, degrees from the z axis toward the x axis. elevation: degrees above the horizontal.
    """
    a, e = np.radians((azimuth, elevation))
    toward = np.array([np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    return np.array([right, np.cross(toward, right), toward])


def complete_by_symmetry(x: np.ndarray, model: str) -> tuple[np.ndarray, np.ndarray]:
    """Points (m, 3) of the complete heap, and (m,) the index of the modelled point (n, 3) of each.

    A quarter model is mirrored at its planes of symmetry; other models are complete.
    """
    signs = MIRRORS.get(model, ((1, 1),))
    return np.concatenate([x * (i, 1, k) for i, k in signs]), np.tile(np.arange(len(x)), len(signs))


def visible(projected: np.ndarray, point_size: float) -> np.ndarray:
    """Mask (n,) of the points that are at least partly visible; interior points need not be drawn.

    The view plane is divided into cells of `point_size` / 3 (m). A point covers the 3 x 3 cells around it. It is
    hidden if it lies behind the visible surface of all 5 x 5 cells around it; empty cells are ignored.
    """
    lowest = projected[:, :2].min(axis=0)
    column, row = np.rint((projected[:, :2] - lowest) / (point_size / 3.0)).astype(int).T
    nearest = np.full((column.max() + 7, row.max() + 7), -np.inf)
    np.maximum.at(nearest, (column + 3, row + 3), projected[:, 2])
    surface = sliding_window_view(nearest, (3, 3)).max(axis=(2, 3))
    rearmost = sliding_window_view(np.where(np.isinf(surface), np.inf, surface), (5, 5)).min(axis=(2, 3))
    return projected[:, 2] >= rearmost[column, row] - HIDDEN_DEPTH * point_size


def circle(radius: float, y: float) -> np.ndarray:
    """Points (m, 3) of a closed circle about the axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return np.column_stack([radius * np.cos(angle), np.full_like(angle, y), radius * np.sin(angle)])


def silhouette(x: np.ndarray, projection: np.ndarray, point_size: float) -> np.ndarray:
    """Closed projected outline (m, 2) of a convex body of cubes with side `point_size` (m) at the points (n, 3)."""
    angle = np.radians(np.arange(1.0, 360.0, 2.0))  # no multiple of 90 degrees, where a whole face is the farthest
    outward = np.column_stack([np.cos(angle), np.sin(angle)]) @ projection[:2]
    farthest = np.array([np.argmax(x @ direction) for direction in outward])
    outline = (x[farthest] + 0.5 * point_size * np.sign(outward)) @ projection[:2].T
    return np.vstack([outline, outline[:1]])
