"""Side view of a two-dimensional model: the plane of the model, with the wall or axis on the left."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from mpmcol.io.snapshot import Snapshot
from mpmcol.plotting.render.coloring import Coloring
from mpmcol.plotting.render.frame import EDGE, RELEASED, View, canvas_size, fit, read_for_rendering


class SideView(View):
    """x to the right, y upward."""

    @property
    def note(self) -> str:
        """That a two-sided release is modelled as one half."""
        return " (half model by symmetry)" if self._is_half else ""

    def points(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """All points, base points first, so that the column is drawn over the base."""
        order = np.argsort(snapshot.column, kind="stable")
        return snapshot.arrays["position"][order], self.colors(snapshot)[order]

    def draw_surroundings(self, axes: Axes, snapshot: Snapshot) -> None:
        """Add the column at release (dashed), the wall (solid) or axis of symmetry (dash-dot), and the floor."""
        r_i, h_i = float(self.meta["r_i"]), float(self.meta["h_i"])
        axes.plot([0, r_i, r_i], [h_i, h_i, 0], **RELEASED)
        symmetric = self.meta["model"] == "axisymmetric" or self._is_half
        axes.plot([0, 0], [0, 2 * h_i], linestyle="dashdot" if symmetric else "solid", **EDGE)
        self._add_floor(axes, has_base=not snapshot.column.all())

    def _add_floor(self, axes: Axes, has_base: bool) -> None:
        """Add a line for a rigid floor; an elastic base, which extends beyond the image, gets a zigzag edge."""
        left, right, bottom, _ = self.extent
        end = right + left / 2  # half of the margin on the left of the wall
        if not has_base:
            axes.plot([0, end], [0, 0], **EDGE)
            return
        y = np.linspace(bottom, float(self.meta["point_size"]), 16)
        zigzag = 0.003 * (right - left) * np.where(np.arange(16) % 2, 1, -1)
        axes.fill_betweenx(y, end + zigzag, right, color="white", linewidth=0)

    @property
    def _is_half(self) -> bool:
        return self.meta.get("release") == "two-sided"


def fit_view(paths: Iterable[Path], size: tuple[int, int], coloring: Coloring) -> SideView:
    """The view that contains the column at release and in all snapshots, and the full depth of the base."""
    boxes, limit = [], 0.0
    for path in paths:
        snapshot, meta = read_for_rendering(path)
        column = snapshot.x[snapshot.column]
        boxes.append([*column.max(axis=0), -snapshot.x[:, 1].min()])
        limit = max(limit, coloring.limit(snapshot, meta))
        boxes.append([float(meta["r_i"]), float(meta["h_i"]), 0.0])
    right, top, depth = np.max(boxes, axis=0).astype(float)
    return SideView(fit((0.0, right, -depth, top), canvas_size(size)), coloring, limit, size, meta)
