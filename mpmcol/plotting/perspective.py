"""The view of a 3D model: the heap seen from above at an angle, cut open toward the viewer.

A quarter is mirrored to the whole and the front quarter is left out of it: one picture then shows the round heap, as
the experiments do, and in the two cut faces the section, with the core that stayed and the material that slid.
The projection is parallel, so that the scale holds for horizontal lengths across the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from mpmcol.io.snapshot import Snapshot
from mpmcol.plotting.frame import BASE_COLOR, RELEASED, View, canvas_size, fit, read_drawable, released_outline
from mpmcol.plotting.projection import circle, viewed_from, visible, whole

VIEWER = viewed_from(azimuth=35.0, elevation=28.0)
CUT_SHADES = (0.8, 0.65)  # brightness of the cut faces x = 0 and z = 0: tells them from the surface and each other
BASE_MARGIN = 1.12  # radius of the base that is shown, over that of the heap


@dataclass(frozen=True)
class SolidView(View):
    """Besides what every view has: `base_radius`, m, as far as the base is shown, and `released`, outline (m, 2)."""

    base_radius: float
    released: np.ndarray

    @property
    def note(self) -> str:
        """What the picture shows that was not modelled, and what it leaves out."""
        return " (quarter mirrored, cut open)" if self.meta["model"] == "quarter" else " (cut open)"

    def points(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """The points that can be seen, projected."""
        size = float(self.meta["point_size"])
        x, colors = snapshot.arrays["position"], self.colors(snapshot)
        shown = snapshot.column | (np.hypot(x[:, 0], x[:, 2]) < self.base_radius)
        x, index = whole(x[shown], str(self.meta["model"]))
        colors = colors[shown][index]
        if snapshot.column.all():
            floor = _layer(self.base_radius, size)
            x, colors = np.vstack([x, floor]), np.vstack([colors, np.tile(to_rgb(BASE_COLOR), (len(floor), 1))])
        behind = _behind_cut(x)
        x, colors = x[behind], colors[behind]
        projected = x @ VIEWER.T
        seen = visible(projected, size)
        return projected[seen], colors[seen] * _shade(x[seen], size)[:, None]

    def draw_surroundings(self, axes: Axes, snapshot: Snapshot) -> None:
        """Where the column stood."""
        axes.plot(*self.released.T, **RELEASED)


def frame(paths: Sequence[Path], size: tuple[int, int]) -> SolidView:
    """The view that holds the whole column as released and in all the snapshots, on a round piece of its base."""
    limit = radius = depth = 0.0
    corners = []
    for path in paths:
        snapshot, meta = read_drawable(path)
        position, column = snapshot.arrays["position"], snapshot.column
        x, _ = whole(position[column], str(meta["model"]))
        projected = x @ VIEWER[:2].T
        corners += [projected.min(axis=0), projected.max(axis=0)]
        radius = max(radius, BASE_MARGIN * float(np.hypot(x[:, 0], x[:, 2]).max()))
        depth = max(depth, -float(position[:, 1].min()))
        limit = max(limit, float(snapshot.displacement_magnitude[column].max()))
    limit = max(limit, float(meta["point_size"]))
    released = released_outline(snapshot, meta, VIEWER)
    corners += [*released, *_base_outline(radius, depth)]
    (left, bottom), (right, top) = np.min(corners, axis=0), np.max(corners, axis=0)
    return SolidView(fit((left, right, bottom, top), canvas_size(size)), limit, size, meta, radius, released)


def _base_outline(radius: float, depth: float) -> np.ndarray:
    """Rim (m, 2) of the base, top and bottom, projected, without the quarter that is cut away."""
    rims = np.concatenate([circle(radius, 0.0), circle(radius, -depth)])
    return rims[_behind_cut(rims)] @ VIEWER[:2].T


def _behind_cut(x: np.ndarray) -> np.ndarray:
    """Mask (n,) of the points that are not in the quarter that is cut away."""
    return (x[:, 0] <= 0.0) | (x[:, 2] <= 0.0)


def _layer(radius: float, point_size: float) -> np.ndarray:
    """Points (m, 3) just below y = 0: a rigid floor has none of its own."""
    line = point_size * (np.arange(-np.ceil(radius / point_size), np.ceil(radius / point_size)) + 0.5)
    x, z = (values.ravel() for values in np.meshgrid(line, line))
    inside = np.hypot(x, z) < radius
    return np.column_stack([x, np.full_like(x, -0.5 * point_size), z])[inside]


def _shade(x: np.ndarray, point_size: float) -> np.ndarray:
    """Brightness (n,) of the points: less in the outermost layer of the cut faces."""
    faces = [(np.abs(x[:, i]) < point_size) & (x[:, 2 - i] > 0.0) for i in (0, 2)]
    return np.select(faces, CUT_SHADES, 1.0)
