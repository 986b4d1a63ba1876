"""Cutaway view of a 3D model: the heap from an elevated viewpoint, with the quarter toward the viewer removed.

A quarter model is first completed by symmetry. The image then shows the whole heap, as experiments do, and on the two
cut faces the vertical section, with the undisturbed core. The x and z axes lie along the cut edges of the base.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

from mpmcol.io.snapshot import Snapshot
from mpmcol.plotting.render.coloring import Coloring, widest
from mpmcol.plotting.render.frame import (
    BASE_COLOR,
    PAGE,
    RELEASED,
    SMALL_SIZE,
    View,
    canvas_size,
    fit,
    read_for_rendering,
    released_outline,
)
from mpmcol.plotting.render.projection import circle, complete_by_symmetry, view_projection, visible
from mpmcol.plotting.render.walls import wall_boxes, wall_surface
from mpmcol.units import length_scale

VIEWER = view_projection(azimuth=35.0, elevation=28.0)
CUT_SHADES = (0.8, 0.65)  # brightness of the cut faces x = 0 and z = 0, relative to the surface
TICK = {"arrowstyle": "-", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
SIDE_SHADE = 0.9  # of the rim of the base
AXES = {"x": np.array([1.0, 0.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}  # along the cut edges of the base
WALL_SPACING = 0.5  # of the points on walls, over that of the material points
BASE_MARGIN = 1.12  # radius of the base shown over the radius of the heap


@dataclass(frozen=True)
class CutawayView(View):
    """View with the quarter x > 0, z > 0 removed.

    base_radius, base: radius and depth to which the base is shown, m; no depth for a rigid floor. released: outline
    (m, 2) of the column at release.
    """

    base_radius: float
    base: float
    released: np.ndarray

    @property
    def note(self) -> str:
        """That a quarter model is mirrored and that the heap is cut open."""
        return " (quarter mirrored, cut open)" if self.meta["model"] == "quarter" else " (cut open)"

    def points(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """The visible points of the column and of the surfaces of walls, projected."""
        size = float(self.meta["point_size"])
        walls, wall_colors = wall_surface(
            wall_boxes(self.meta, self.base_radius), WALL_SPACING * size, self.base_radius
        )
        x, index = complete_by_symmetry(snapshot.arrays["position"][snapshot.column], str(self.meta["model"]))
        colors = self.colors(snapshot)[snapshot.column][index]
        behind = _behind_cut(x)
        shaded = colors[behind] * _shade(x[behind], size)[:, None]
        projected, colors = np.concatenate([x[behind], walls]) @ VIEWER.T, np.concatenate([shaded, wall_colors])
        seen = visible(projected, size)
        return projected[seen], colors[seen]

    def draw_behind(self, axes: Axes) -> None:
        """Draw the base."""
        for corners, shade in _base_faces(self.base_radius, self.base):
            color = np.array(to_rgb(BASE_COLOR)) * shade
            axes.add_patch(Polygon(corners @ VIEWER[:2].T, facecolor=color, linewidth=0))

    def draw_before(self, axes: Axes) -> None:
        """Draw the outline of the column at release, where the gate is, and the x and z axes."""
        axes.plot(*self.released.T, **RELEASED)
        top = self.released[np.argmax(self.released[:, 1])]
        axes.annotate(
            "gate", top, (0, 3), textcoords="offset points", ha="center", va="bottom", size=SMALL_SIZE, color="0.35"
        )
        for name, direction in AXES.items():
            _draw_axis(axes, name, direction, self.base_radius, self.base)


def fit_view(
    paths: Sequence[Path], size: tuple[int, int] | None, coloring: Coloring, reach: float = 0.0
) -> CutawayView:
    """The view that contains the column at release and in all snapshots, on a circular part of the base.

    size: of the page, pixels; None for that of PAGE. reach: distance (m) from the axis that is shown at least.
    """
    size = size or PAGE
    depth, limits = 0.0, []
    radius = BASE_MARGIN * reach
    corners = []
    for path in paths:
        snapshot, meta = read_for_rendering(path)
        position, column = snapshot.arrays["position"], snapshot.column
        x, _ = complete_by_symmetry(position[column], str(meta["model"]))
        projected = x @ VIEWER[:2].T
        corners += [projected.min(axis=0), projected.max(axis=0)]
        radius = max(radius, BASE_MARGIN * float(np.hypot(x[:, 0], x[:, 2]).max()))
        if not column.all():
            depth = max(depth, 0.5 * float(meta["point_size"]) - float(position[~column, 1].min()))
        limits.append(coloring.limits(snapshot, meta))
    released = released_outline(snapshot, meta, VIEWER)
    rims = np.concatenate([circle(radius, 0.0), circle(radius, -depth)])
    walls, _ = wall_surface(wall_boxes(meta, radius), float(meta["point_size"]), radius)
    corners += [*released, *(walls @ VIEWER[:2].T), *(rims[_behind_cut(rims)] @ VIEWER[:2].T)]
    (left, bottom), (right, top) = np.min(corners, axis=0), np.max(corners, axis=0)
    extent = fit((left, right, bottom, top), canvas_size(size))
    return CutawayView(extent, coloring, widest(limits), size, meta, radius, depth, released)


def _base_faces(radius: float, depth: float) -> Iterator[tuple[np.ndarray, float]]:
    """Corners (m, 3) and brightness of the faces of the base without the removed quarter, the rearmost first."""
    angle = np.linspace(0.5 * np.pi, 2.0 * np.pi, 271)  # from the z axis over -x and -z to the x axis
    rim = radius * np.column_stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)])
    down, axis = np.array([0.0, -depth, 0.0]), np.zeros(3)
    if depth > 0.0:
        yield np.concatenate([rim, rim[::-1] + down]), SIDE_SHADE
        for i, shade in ((0, CUT_SHADES[0]), (-1, CUT_SHADES[1])):
            yield np.array([axis, rim[i], rim[i] + down, axis + down]), shade
    yield np.concatenate([rim, [axis]]), 1.0


def _draw_axis(axes: Axes, name: str, direction: np.ndarray, radius: float, depth: float) -> None:
    """Draw ticks from the axis of the heap to the radius of the base, below its lower cut edge."""
    unit, factor = length_scale(radius)
    origin, along = VIEWER[:2] @ np.array([0.0, -depth, 0.0]), VIEWER[:2] @ direction
    below: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "top", "size": SMALL_SIZE}
    for tick in MaxNLocator(4).tick_values(0.0, factor * radius)[1:]:
        if tick < 0.85 * factor * radius:
            place = origin + tick / factor * along
            axes.annotate("", place, (0, -9), textcoords="offset points", arrowprops=TICK)
            axes.annotate(f"{tick:g}", place, (0, -11), **below)
    axes.annotate(f"{name} ({unit})", origin + radius * along, (0, -10), **below)


def _behind_cut(x: np.ndarray) -> np.ndarray:
    """Mask (n,) of the points outside the removed quarter."""
    return (x[:, 0] <= 0.0) | (x[:, 2] <= 0.0)


def _shade(x: np.ndarray, point_size: float) -> np.ndarray:
    """Brightness (n,) of the points: reduced in the outermost layer of the cut faces."""
    faces = [(np.abs(x[:, i]) < point_size) & (x[:, 2 - i] > 0.0) for i in (0, 2)]
    return np.select(faces, CUT_SHADES, 1.0)
