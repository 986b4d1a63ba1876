"""Cutaway view of a 3D model: the heap from an elevated viewpoint, with the quarter toward the viewer removed.

A quarter model is first completed by symmetry. The image then shows the whole heap, as experiments do, and on the two
cut faces the vertical section, with the undisturbed core. The projection is parallel, so that the scale bar holds for
horizontal lengths across the image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from mpmcol.io.snapshot import Snapshot
from mpmcol.plotting.render.coloring import Coloring
from mpmcol.plotting.render.frame import (
    BASE_COLOR,
    RELEASED,
    View,
    canvas_size,
    fit,
    read_for_rendering,
    released_outline,
)
from mpmcol.plotting.render.projection import circle, complete_by_symmetry, view_projection, visible

VIEWER = view_projection(azimuth=35.0, elevation=28.0)
CUT_SHADES = (0.8, 0.65)  # brightness of the cut faces x = 0 and z = 0, relative to the surface
BASE_MARGIN = 1.12  # radius of the base shown over the radius of the heap


@dataclass(frozen=True)
class CutawayView(View):
    """View with the quarter x > 0, z > 0 removed.

    base_radius: radius to which the base is shown, m. released: outline (m, 2) of the column at release.
    """

    base_radius: float
    released: np.ndarray

    @property
    def note(self) -> str:
        """That a quarter model is mirrored and that the heap is cut open."""
        return " (quarter mirrored, cut open)" if self.meta["model"] == "quarter" else " (cut open)"

    def points(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """The visible points, projected."""
        size = float(self.meta["point_size"])
        x, colors = snapshot.arrays["position"], self.colors(snapshot)
        shown = snapshot.column | (np.hypot(x[:, 0], x[:, 2]) < self.base_radius)
        x, index = complete_by_symmetry(x[shown], str(self.meta["model"]))
        colors = colors[shown][index]
        if snapshot.column.all():
            floor = _floor_points(self.base_radius, size)
            x, colors = np.vstack([x, floor]), np.vstack([colors, np.tile(to_rgb(BASE_COLOR), (len(floor), 1))])
        behind = _behind_cut(x)
        x, colors = x[behind], colors[behind]
        projected = x @ VIEWER.T
        seen = visible(projected, size)
        return projected[seen], colors[seen] * _shade(x[seen], size)[:, None]

    def draw_surroundings(self, axes: Axes, snapshot: Snapshot) -> None:
        """Add the outline of the column at release."""
        axes.plot(*self.released.T, **RELEASED)


def fit_view(paths: Sequence[Path], size: tuple[int, int], coloring: Coloring) -> CutawayView:
    """The view that contains the column at release and in all snapshots, on a circular part of the base."""
    limit = radius = depth = 0.0
    corners = []
    for path in paths:
        snapshot, meta = read_for_rendering(path)
        position, column = snapshot.arrays["position"], snapshot.column
        x, _ = complete_by_symmetry(position[column], str(meta["model"]))
        projected = x @ VIEWER[:2].T
        corners += [projected.min(axis=0), projected.max(axis=0)]
        radius = max(radius, BASE_MARGIN * float(np.hypot(x[:, 0], x[:, 2]).max()))
        depth = max(depth, -float(position[:, 1].min()))
        limit = max(limit, coloring.limit(snapshot, meta))
    released = released_outline(snapshot, meta, VIEWER)
    corners += [*released, *_base_outline(radius, depth)]
    (left, bottom), (right, top) = np.min(corners, axis=0), np.max(corners, axis=0)
    return CutawayView(
        fit((left, right, bottom, top), canvas_size(size)), coloring, limit, size, meta, radius, released
    )


def _base_outline(radius: float, depth: float) -> np.ndarray:
    """Projected rims (m, 2) of the base, top and bottom, without the removed quarter."""
    rims = np.concatenate([circle(radius, 0.0), circle(radius, -depth)])
    return rims[_behind_cut(rims)] @ VIEWER[:2].T


def _behind_cut(x: np.ndarray) -> np.ndarray:
    """Mask (n,) of the points outside the removed quarter."""
    return (x[:, 0] <= 0.0) | (x[:, 2] <= 0.0)


def _floor_points(radius: float, point_size: float) -> np.ndarray:
    """Points (m, 3) just below y = 0 that represent a rigid floor, which has no material points."""
    line = point_size * (np.arange(-np.ceil(radius / point_size), np.ceil(radius / point_size)) + 0.5)
    x, z = (values.ravel() for values in np.meshgrid(line, line))
    inside = np.hypot(x, z) < radius
    return np.column_stack([x, np.full_like(x, -0.5 * point_size), z])[inside]


def _shade(x: np.ndarray, point_size: float) -> np.ndarray:
    """Brightness (n,) of the points: reduced in the outermost layer of the cut faces."""
    faces = [(np.abs(x[:, i]) < point_size) & (x[:, 2 - i] > 0.0) for i in (0, 2)]
    return np.select(faces, CUT_SHADES, 1.0)
