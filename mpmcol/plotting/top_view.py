"""The view from above: where the surface of the deposit has moved since the release (the paper's Figures 9d and 9h)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, PatchCollection
from matplotlib.patches import Patch, Wedge
from PIL import Image, ImageOps

from mpmcol.io.snapshot import Meta, Snapshot
from mpmcol.measure import UNDISTURBED
from mpmcol.plotting.frame import BASE_COLOR, HEAD, add_heading, page, printed, released_outline
from mpmcol.plotting.projection import TOP, circle, visible, whole

MM = 1000.0
PAGE = (1280, 720)  # the proportions that the layout is made for; other sizes get a white border
MOVED_COLOR, STILL_COLOR = "#c23b2e", "#ead7a0"
SURFACES = {
    f"moved by {MM * UNDISTURBED:g} mm or more": MOVED_COLOR,
    f"moved by less than {MM * UNDISTURBED:g} mm": STILL_COLOR,
    "base": BASE_COLOR,
}
LINE: dict[str, Any] = {"color": "black", "linewidth": 1.6}
POINT_SPACINGS = 1.45  # diameter of a point as drawn: discs on a square lattice leave no gaps from sqrt(2) on


def top_view(snapshot: Snapshot, meta: Meta, size: tuple[int, int], undisturbed: float | None) -> Image.Image:
    """The whole deposit from above, axes in mm; a quarter is mirrored, an axisymmetric model revolved.

    meta: of the snapshot; any model but "plane". size: in pixels. undisturbed: radius (m) within which the surface
    did not move, drawn as a circle unless it is None or 0.
    """
    scale = min(size[0] / PAGE[0], size[1] / PAGE[1])
    page_size = round(scale * PAGE[0]), round(scale * PAGE[1])
    figure = page(page_size)
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
    return ImageOps.pad(printed(figure, page_size), size, color="white")


def _surface(snapshot: Snapshot, meta: Meta) -> tuple[np.ndarray, np.ndarray]:
    """The column's points (m, 3) that can be seen from above, lowest first, and whether (m,) they have moved."""
    column = snapshot.column
    x, moved = snapshot.arrays["position"][column], snapshot.displacement_magnitude[column] >= UNDISTURBED
    seen = visible(x @ TOP.T, float(meta["point_size"]))
    x, index = whole(x[seen], str(meta["model"]))
    order = np.argsort(x[:, 1])
    return x[order], moved[seen][index[order]]


def _draw_points(axes: Axes, x: np.ndarray, moved: np.ndarray, meta: Meta) -> None:
    """Discs of their true size, x in mm; an axisymmetric model is revolved, its points are rings."""
    diameter = POINT_SPACINGS * MM * float(meta["point_size"])
    style: dict[str, Any] = {"facecolors": np.where(moved, MOVED_COLOR, STILL_COLOR), "linewidths": 0}
    if meta["model"] == "axisymmetric":
        outer = np.abs(x[:, 0]) + 0.5 * diameter
        rings = [Wedge((0.0, 0.0), r, 0.0, 360.0, width=min(diameter, r)) for r in outer]
        axes.add_collection(PatchCollection(rings, **style))
    else:
        place: dict[str, Any] = {"units": "xy", "offsets": x[:, [0, 2]], "offset_transform": axes.transData}
        axes.add_collection(EllipseCollection([diameter], [diameter], [0.0], **place, **style))


def _draw_circles(axes: Axes, snapshot: Snapshot, meta: Meta, undisturbed: float | None) -> None:
    """Where the column stood (dashed), which need not be a circle, and the undisturbed radius."""
    x, minus_z = MM * released_outline(snapshot, meta, TOP).T
    axes.plot(x, -minus_z, **LINE, linestyle=(0, (6, 3)), label=f"released, $r_i$ = {MM * float(meta['r_i']):.0f} mm")
    if undisturbed and meta.get("section", "cylinder") == "cylinder":
        x, _, z = MM * circle(undisturbed, 0.0).T
        axes.plot(x, z, **LINE, label=f"undisturbed radius, {MM * undisturbed:.0f} mm")
