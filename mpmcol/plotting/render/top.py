"""View from above: where the surface of the deposit moved since release (Figures 9d and 9h of the paper)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.patches import Patch
from PIL import Image, ImageOps

from mpmcol.io.snapshot import Meta, Snapshot
from mpmcol.measure import UNDISTURBED
from mpmcol.plotting.render.frame import (
    BASE_COLOR,
    PAGE,
    SMALL_SIZE,
    TEXT_SIZE,
    add_time,
    add_title,
    as_image,
    new_figure,
    released_outline,
)
from mpmcol.plotting.render.projection import TOP, circle, complete_by_symmetry, visible
from mpmcol.plotting.render.walls import wall_boxes
from mpmcol.units import length_scale, length_text

MOVED_COLOR, UNDISTURBED_COLOR = "#c23b2e", "#ead7a0"
LINE: dict[str, Any] = {"color": "black", "linewidth": 1.6}
PLACE = (0.1375, 0.1, 0.5, 0.75)  # of the axes: whole pixels, so that the picture is symmetric
PIXELS = 500  # across the picture of the surface
POINT_SPACINGS = 1.45  # diameter of a point over the spacing; above sqrt(2) discs on a square lattice overlap
NEIGHBOURS = 8  # of which the topmost is seen


def draw_top_view(snapshot: Snapshot, meta: Meta, size: tuple[int, int], undisturbed: float | None) -> Image.Image:
    """The complete deposit from above, z to the right and x upward; a quarter model is mirrored, an axisymmetric one
    revolved.

    meta: of the snapshot; any model except "plane". size: pixels. undisturbed: radius (m) within which the surface did
    not move, drawn as a circle unless it is None or 0.
    """
    # the layout has the aspect ratio of PAGE, other sizes get a white border
    scale = min(size[0] / PAGE[0], size[1] / PAGE[1])
    page_size = round(scale * PAGE[0]), round(scale * PAGE[1])
    figure = new_figure(page_size)
    axes = figure.add_axes(PLACE, aspect="equal", facecolor=BASE_COLOR)
    x, moved = _surface(snapshot, meta)
    reach = 1.08 * max(float(np.hypot(x[:, 0], x[:, 2]).max()), float(meta["r_i"]))
    unit, factor = length_scale(reach)
    extent = [factor * end for end in (-reach, reach, -reach, reach)]
    axes.imshow(_picture(x, moved, meta, reach), extent=extent, origin="lower", interpolation="bilinear")  # type: ignore[arg-type]
    _draw_circles(axes, snapshot, meta, undisturbed, factor)
    _draw_walls(axes, meta, factor, reach)
    axes.set(xlim=extent[:2], ylim=extent[2:])
    axes.set_xlabel(f"z ({unit})", size=SMALL_SIZE)
    axes.set_ylabel(f"x ({unit})", size=SMALL_SIZE)
    axes.tick_params(labelsize=SMALL_SIZE)
    limit = length_text(UNDISTURBED * float(meta["r_i"]))
    surfaces = {f"moved by {limit} or more": MOVED_COLOR, f"moved by less than {limit}": UNDISTURBED_COLOR}
    surfaces["base"] = BASE_COLOR
    patches = [Patch(facecolor=color, edgecolor="0.3", label=label) for label, color in surfaces.items()]
    beside: dict[str, Any] = {"loc": "center left", "bbox_to_anchor": (0.66, 0.5)}
    named = [line for line in axes.lines if not str(line.get_label()).startswith("_")]
    figure.legend(handles=[*patches, *named], frameon=False, fontsize=TEXT_SIZE, **beside)
    add_title(figure, meta, "")
    page = as_image(figure, page_size)
    add_time(page, snapshot)
    return ImageOps.pad(page, size, color="white")


def _draw_walls(axes: Axes, meta: Meta, factor: float, reach: float) -> None:
    """The outlines of walls in 3D up to `reach` (m)."""
    for number, ((x0, _, z0), (x1, _, z1)) in enumerate(wall_boxes(meta, reach)):
        corners = factor * np.array([(z0, x0), (z1, x0), (z1, x1), (z0, x1), (z0, x0)])
        axes.plot(*corners.T, color="0.25", linewidth=1.2, label="_" if number else "wall")


def _surface(snapshot: Snapshot, meta: Meta) -> tuple[np.ndarray, np.ndarray]:
    """Column points (m, 3) visible from above, and whether (m,) each has moved."""
    column = snapshot.column
    x, limit = snapshot.arrays["position"][column], UNDISTURBED * float(meta["r_i"])
    moved = snapshot.displacement_magnitude[column] >= limit
    seen = visible(x @ TOP.T, float(meta["point_size"]))
    x, index = complete_by_symmetry(x[seen], str(meta["model"]))
    return x, moved[seen][index]


def _picture(x: np.ndarray, moved: np.ndarray, meta: Meta, reach: float) -> np.ndarray:
    """Colours (PIXELS, PIXELS, 4) of the surface, by rows of x and columns of z from -reach to reach.

    A pixel shows the topmost of the points that cover it, else the nearest one, so that gaps between points that are
    narrower than two grid cells are closed. Beyond the deposit the picture is transparent.
    """
    from scipy.ndimage import distance_transform_edt  # here: they take longer to import than all other charts need
    from scipy.spatial import KDTree

    line = reach * (2.0 * (np.arange(PIXELS) + 0.5) / PIXELS - 1.0)
    if meta["model"] == "axisymmetric":
        tree, places = KDTree(np.abs(x[:, :1])), np.hypot(line[:, None], line)[..., None]
    else:
        tree, places = KDTree(x[:, [0, 2]]), np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1)
    size, closed = float(meta["point_size"]), float(meta["spacing"])
    distance, near = tree.query(places, NEIGHBOURS, distance_upper_bound=closed + 0.5 * size)
    height = np.append(x[:, 1], -np.inf)[near]  # the last one stands for a missing neighbour
    seen = np.argmax(np.where(distance <= 0.5 * POINT_SPACINGS * size, height, -np.inf), axis=-1)
    point = np.take_along_axis(near, seen[..., None], axis=-1)[..., 0]
    inside = np.isfinite(distance[..., 0])
    depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1] * 2.0 * reach / PIXELS
    shown = inside & (depth > closed)
    picture = np.zeros((PIXELS, PIXELS, 4))
    picture[shown] = np.array([to_rgba(UNDISTURBED_COLOR), to_rgba(MOVED_COLOR)])[moved[point[shown]].astype(int)]
    return picture


def _draw_circles(axes: Axes, snapshot: Snapshot, meta: Meta, undisturbed: float | None, factor: float) -> None:
    """Add the outline of the column at release (dashed) and the undisturbed radius of a cylinder."""
    label = f"column at release, $r_i$ = {length_text(float(meta['r_i']))}"
    axes.plot(*(factor * released_outline(snapshot, meta, TOP)).T, **LINE, linestyle=(0, (6, 3)), label=label)
    if undisturbed and meta.get("section", "cylinder") == "cylinder":
        x, _, z = factor * circle(undisturbed, 0.0).T
        axes.plot(z, x, **LINE, label=f"undisturbed radius, {length_text(undisturbed)}")
