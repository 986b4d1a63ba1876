"""View from above: where the surface of the deposit moved since release (Figures 9d and 9h of the paper)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.patches import Patch, Wedge
from PIL import Image, ImageOps

from mpmcol.io.snapshot import Meta, Snapshot
from mpmcol.measure import UNDISTURBED
from mpmcol.plotting.render.frame import BASE_COLOR, HEAD, add_heading, as_image, new_figure, released_outline
from mpmcol.plotting.render.projection import TOP, circle, complete_by_symmetry, visible

MM = 1000.0
PAGE = (1280, 720)  # pixels; the layout has this aspect ratio, other sizes get a white border
MOVED_COLOR, UNDISTURBED_COLOR = "#c23b2e", "#ead7a0"
SURFACES = {
    f"moved by {MM * UNDISTURBED:g} mm or more": MOVED_COLOR,
    f"moved by less than {MM * UNDISTURBED:g} mm": UNDISTURBED_COLOR,
    "base": BASE_COLOR,
}
LINE: dict[str, Any] = {"color": "black", "linewidth": 1.6}
POINT_SPACINGS = 1.45  # drawn diameter of a point over the spacing; above sqrt(2) discs on a square lattice overlap


def draw_top_view(snapshot: Snapshot, meta: Meta, size: tuple[int, int], undisturbed: float | None) -> Image.Image:
    """The complete deposit from above, axes in mm; a quarter model is mirrored, an axisymmetric one revolved.

    meta: of the snapshot; any model except "plane". size: pixels. undisturbed: radius (m) within which the surface did
    not move, drawn as a circle unless it is None or 0.
    """
    scale = min(size[0] / PAGE[0], size[1] / PAGE[1])
    page_size = round(scale * PAGE[0]), round(scale * PAGE[1])
    figure = new_figure(page_size)
    axes = figure.add_axes((0.18, 0.12, 0.48, 0.98 - HEAD - 0.12), aspect="equal", facecolor=BASE_COLOR)
    x, moved = _surface(snapshot, meta)
    _draw_points(axes, MM * x, moved, meta)
    _draw_circles(axes, snapshot, meta, undisturbed)
    reach = 1.08 * MM * max(float(np.hypot(x[:, 0], x[:, 2]).max()), float(meta["r_i"]))
    # From above, z counts downward where x counts to the right.
    axes.set(xlim=(-reach, reach), ylim=(reach, -reach))
    axes.set_xlabel("x (mm)", size=14)
    axes.set_ylabel("z (mm)", size=14)
    axes.tick_params(labelsize=12)
    patches = [Patch(facecolor=color, edgecolor="0.3", label=label) for label, color in SURFACES.items()]
    beside: dict[str, Any] = {"loc": "center left", "bbox_to_anchor": (0.68, 0.5)}
    figure.legend(handles=[*patches, *axes.lines], frameon=False, fontsize=14, **beside)
    add_heading(figure, str(meta["title"]), snapshot)
    return ImageOps.pad(as_image(figure, page_size), size, color="white")


def _surface(snapshot: Snapshot, meta: Meta) -> tuple[np.ndarray, np.ndarray]:
    """Column points (m, 3) visible from above, lowest first, and whether (m,) each has moved."""
    column = snapshot.column
    x, moved = snapshot.arrays["position"][column], snapshot.displacement_magnitude[column] >= UNDISTURBED
    seen = visible(x @ TOP.T, float(meta["point_size"]))
    x, index = complete_by_symmetry(x[seen], str(meta["model"]))
    order = np.argsort(x[:, 1])
    return x[order], moved[seen][index[order]]


def _draw_points(axes: Axes, x: np.ndarray, moved: np.ndarray, meta: Meta) -> None:
    """Add the points as discs, or as rings for an axisymmetric model; x in mm."""
    diameter = POINT_SPACINGS * MM * float(meta["point_size"])
    style: dict[str, Any] = {"facecolors": np.where(moved, MOVED_COLOR, UNDISTURBED_COLOR), "linewidths": 0}
    if meta["model"] == "axisymmetric":
        outer = np.abs(x[:, 0]) + 0.5 * diameter
        rings = [Wedge((0.0, 0.0), r, 0.0, 360.0, width=min(diameter, r)) for r in outer]
        axes.add_collection(PatchCollection(rings, **style))
    else:
        positions: dict[str, Any] = {"units": "xy", "offsets": x[:, [0, 2]], "offset_transform": axes.transData}
        axes.add_collection(EllipseCollection([diameter], [diameter], [0.0], **positions, **style))


def _draw_circles(axes: Axes, snapshot: Snapshot, meta: Meta, undisturbed: float | None) -> None:
    """Add the outline of the column at release (dashed) and the undisturbed radius of a cylinder."""
    x, minus_z = MM * released_outline(snapshot, meta, TOP).T
    axes.plot(
        x, -minus_z, **LINE, linestyle=(0, (6, 3)), label=f"column at release, $r_i$ = {MM * float(meta['r_i']):.0f} mm"
    )
    if undisturbed and meta.get("section", "cylinder") == "cylinder":
        x, _, z = MM * circle(undisturbed, 0.0).T
        axes.plot(x, z, **LINE, label=f"undisturbed radius, {MM * undisturbed:.0f} mm")
