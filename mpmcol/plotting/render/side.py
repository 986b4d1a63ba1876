"""Side view of a two-dimensional model: the plane of the model, with the wall or axis on the left."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from mpmcol.case.geometry import GeometryTable
from mpmcol.experiments import OUTLINE
from mpmcol.io.snapshot import Snapshot
from mpmcol.plotting.captions import geometry_of_snapshot, tables_of_snapshot
from mpmcol.plotting.profiles import draw_gate, draw_gravity, draw_walls, with_walls
from mpmcol.plotting.render.coloring import Coloring, widest
from mpmcol.plotting.render.frame import (
    BASE_COLOR,
    EDGE,
    RELEASED,
    SMALL_SIZE,
    Extent,
    View,
    canvas_size,
    fitting_page,
    read_for_rendering,
)
from mpmcol.plotting.render.walls import walls_on_grid
from mpmcol.units import length_scale

MARGIN = 0.02  # of width and height, left of the wall, below the base, and beyond the front
PALE = 0.55  # share of white in the colours of a granular bed
ABOVE = 0.08  # of the height, above the column
LONGEST = 1.5  # distance to the end of a wall that is shown as a whole, over the reach of the flow
_RIGHT, _UP = 1.0 - 2.0 * MARGIN, 1.0 - MARGIN - ABOVE  # shares of width and height for the material


@dataclass(frozen=True)
class SideView(View):
    """x to the right, y upward. base: depth of the elastic base, m; 0 for a rigid floor."""

    base: float

    @property
    def note(self) -> str:
        """That a two-sided release is modelled as one half, and how a granular bed is shown."""
        notes = ["half model by symmetry"] * self._is_half + ["bed: paler"] * self._has_bed
        return f" ({'; '.join(notes)})" if notes else ""

    def points(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """The points of the column, and in paler colours those of a granular bed."""
        shown = snapshot.column | self._has_bed
        colors = self.colors(snapshot)
        colors[~snapshot.column] = PALE + (1.0 - PALE) * colors[~snapshot.column]
        return snapshot.arrays["position"][shown], colors[shown]

    def draw_behind(self, axes: Axes) -> None:
        """Draw the base, or the floor below a granular bed."""
        right = self.extent[1]
        floor = -self.base if self._has_bed else 0.0
        axes.add_patch(Rectangle((0, -self.base), right, self.base + floor, facecolor=BASE_COLOR, linewidth=0))
        axes.plot([0, right], [floor, floor], **EDGE)

    def draw_before(self, axes: Axes) -> None:
        """Draw the column at release (dashed), gate, wall (solid) or axis of symmetry (dash-dot), gravity, and axes."""
        left, _, _, top = self.extent
        r_i = float(self.meta["r_i"])
        symmetric = self.meta["model"] == "axisymmetric" or self._is_half
        # halves of points beyond the wall or axis
        axes.axvspan(left, 0, facecolor="white", linewidth=0)
        axes.plot(*self._released_surface(), **RELEASED)
        if self._has_bed:
            axes.plot([0, self.extent[1]], [0, 0], **RELEASED)
        axes.plot([0, 0], [0, top], linestyle="dashdot" if symmetric else "solid", **EDGE)
        draw_gravity(axes, float(self.meta.get("slope_deg", 0.0)), SMALL_SIZE)
        if self._case.get("stages", {}).get("gate", True):
            draw_gate(axes, r_i, self._geometry.lean, SMALL_SIZE)
        draw_walls(axes, list(self._walls()))
        self._add_ticks(axes)

    def _walls(self) -> Iterator[tuple[float, float, float]]:
        """Faces and heights of the walls, as they are in the grid, m; those without an end reach that of the view."""
        _, right, _, top = self.extent
        for wall in walls_on_grid(self.meta):
            yield wall["from"], wall.get("to", right), wall.get("height", top)

    def _released_surface(self) -> np.ndarray:
        """Line (2, n), m: the top of the column, or the closed outline of one that is no rectangle."""
        if self.meta.get("section") == OUTLINE and (outline := self._geometry.polygon):
            return np.array([*outline, outline[0]]).T
        r_i, h_i = float(self.meta["r_i"]), float(self.meta["h_i"])
        return np.array([[0.0, r_i], [h_i, h_i]])

    @property
    def _has_bed(self) -> bool:
        return self._geometry.base == "granular"

    @cached_property
    def _geometry(self) -> GeometryTable:
        return geometry_of_snapshot(self.meta)

    @cached_property
    def _case(self) -> dict[str, Any]:
        return tables_of_snapshot(self.meta)

    def _add_ticks(self, axes: Axes) -> None:
        """Label the material's side of both axes in m or mm."""
        _, right, _, top = self.extent
        unit, factor = length_scale(max(float(self.meta["r_i"]), float(self.meta["h_i"])))
        axes.set_axis_on()
        axes.spines[["top", "right"]].set_visible(False)
        axes.patch.set_visible(False)
        for axis, end, steps in ((axes.xaxis, right, 10), (axes.yaxis, top, 6)):
            values = MaxNLocator(steps).tick_values(0.0, factor * end)
            shown = [value for value in values if 0.0 <= value <= factor * end]
            axis.set_ticks([value / factor for value in shown], labels=[f"{value:g}" for value in shown])
        axes.tick_params(labelsize=SMALL_SIZE)
        axes.set_xlabel(f"{self._origin} ({unit})", size=SMALL_SIZE, labelpad=2)
        axes.set_ylabel(f"height ({unit})", size=SMALL_SIZE)

    @property
    def _origin(self) -> str:
        if self.meta["model"] == "axisymmetric":
            return "radius"
        return "distance from the plane of symmetry" if self._is_half else "distance from the wall"

    @property
    def _is_half(self) -> bool:
        return self.meta.get("release") == "two-sided"


def fit_view(paths: Iterable[Path], size: tuple[int, int] | None, coloring: Coloring, reach: float = 0.0) -> SideView:
    """The view that contains the column at release and in all snapshots, and the full depth of the base.

    size: of the page, pixels; None for one whose height suits the material. reach: distance (m) from the wall or axis
    that is shown at least.
    """
    boxes, limits = [], []
    for path in paths:
        snapshot, meta = read_for_rendering(path)
        column = snapshot.x[snapshot.column]
        base = -snapshot.x[~snapshot.column, 1].min(initial=0.0) + 0.5 * float(meta["point_size"])
        boxes.append([*column.max(axis=0), 0.0 if snapshot.column.all() else base])
        limits.append(coloring.limits(snapshot, meta))
        boxes.append([max(float(meta["r_i"]), reach), float(meta["h_i"]), 0.0])
    right, top, depth = np.max(boxes, axis=0).astype(float)
    right = _with_walls(right, [(wall["from"], wall.get("to", np.inf)) for wall in walls_on_grid(meta)])
    size = size or fitting_page((top + depth) / right * _RIGHT / _UP)
    return SideView(_fit(right, top, depth, canvas_size(size)), coloring, widest(limits), size, meta, depth)


def _with_walls(reach: float, walls: Sequence[tuple[float, float]]) -> float:
    """Distance (m) up to which walls are shown: all of those that the flow reaches, if they are not too long."""
    shown = with_walls(reach, walls)
    return max([shown] + [high for low, high in walls if low < shown and high <= LONGEST * reach])


def _fit(right: float, top: float, depth: float, canvas: tuple[int, int]) -> Extent:
    """Extent with equal scales that begins left of the wall and below the base, and contains the material."""
    scale = max(right / _RIGHT / canvas[0], (top + depth) / _UP / canvas[1])
    left, bottom = -MARGIN * scale * canvas[0], -depth - MARGIN * scale * canvas[1]
    return left, left + scale * canvas[0], bottom, bottom + scale * canvas[1]
