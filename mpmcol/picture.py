"""One picture of a snapshot: what it shows, and everything around the points: scales, title, time."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image

from mpmcol.errors import OutputError
from mpmcol.snapshot import Snapshot, read_meta, read_snapshot

COLORS = "viridis"
BASE_COLOR = "#b5b5b5"
EDGE: dict[str, Any] = {"color": "0.15", "linewidth": 1.2}
HEAD, FOOT = 0.1, 0.17


def canvas_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height, in pixels, of the part of a picture that shows the material."""
    return size[0], size[1] - int(HEAD * size[1]) - int(FOOT * size[1])


@dataclass(frozen=True)
class View:
    """What a picture shows, the same in every frame of an animation: lengths in m, `size` in pixels.

    extent: left, right, bottom, top. limit: displacement at the upper end of the colour scale. The material is
    drawn over the full width, between a line of text above (HEAD of the height) and the scales below (FOOT).
    """

    extent: tuple[float, float, float, float]
    limit: float
    size: tuple[int, int]
    meta: dict[str, str | int | float]

    @property
    def point_pixels(self) -> float:
        """Diameter of a material point, larger than their spacing so that sheared material shows no gaps."""
        left, right, _, _ = self.extent
        return max(1.3 * float(self.meta["point_size"]) / (right - left) * self.size[0], 1.0)


def frame(paths: Iterable[Path], size: tuple[int, int]) -> View:
    """The view that holds the column as released and in all the snapshots, and the full depth of the base."""
    boxes, limit = [], 0.0
    for path in paths:
        snapshot = read_snapshot(path)
        column = snapshot.x[snapshot.column]
        boxes.append([*column.max(axis=0), -snapshot.x[:, 1].min()])
        limit = max(limit, float(snapshot.displacement_magnitude[snapshot.column].max()))
        meta = _drawable_meta(path)
        boxes.append([float(meta["r_i"]), float(meta["h_i"]), 0.0])
    right, top, depth = np.max(boxes, axis=0).astype(float)
    limit = max(limit, float(meta["point_size"]))
    return View(_fit((0.0, right, -depth, top), canvas_size(size)), limit, size, meta)


def _drawable_meta(path: Path) -> dict[str, str | int | float]:
    meta = read_meta(path)
    missing = sorted({"title", "model", "point_size", "r_i", "h_i"} - meta.keys())
    if missing:
        raise OutputError(f"{path}: cannot be drawn, it does not say its {', '.join(missing)}; write it with them")
    return meta


def _fit(extent: tuple[float, float, float, float], canvas: tuple[int, int]) -> tuple[float, float, float, float]:
    """Widen the extent, about its centre, by a margin and to the proportions of the canvas (equal axes)."""
    left, right, bottom, top = extent
    scale = 1.08 * max((right - left) / canvas[0], (top - bottom) / canvas[1])
    half_width, half_height = scale * canvas[0] / 2, scale * canvas[1] / 2
    x, y = (left + right) / 2, (bottom + top) / 2
    return x - half_width, x + half_width, y - half_height, y + half_height


def compose(snapshot: Snapshot, view: View, painted: Path | None) -> Image.Image:
    """The finished picture: points, scale bar, colour bar, title and time."""
    width, height = view.size
    # Text and lines keep their share of the picture: every page is 7.2 inches high.
    figure = Figure(figsize=(7.2 * width / height, 7.2), dpi=height / 7.2)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, int(FOOT * height) / height, 1, canvas_size(view.size)[1] / height))
    axes.set_axis_off()
    if painted is None:
        _scatter(axes, snapshot, view, figure.dpi)
    else:
        axes.imshow(np.asarray(Image.open(painted)), extent=view.extent, interpolation="auto")
    axes.set(xlim=view.extent[:2], ylim=view.extent[2:], aspect="auto")
    _add_surroundings(axes, view)
    _add_floor(axes, view, has_base=not snapshot.column.all())
    _add_text(figure, snapshot, view)
    _add_scale_bar(figure, view)
    _add_color_bar(figure, view)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB").crop((0, 0, width, height))


def _scatter(axes: Axes, snapshot: Snapshot, view: View, dpi: float) -> None:
    area = (view.point_pixels * 72 / dpi) ** 2
    style: dict[str, Any] = {"s": area, "marker": "s", "linewidths": 0}
    column, base = snapshot.x[snapshot.column], snapshot.x[~snapshot.column]
    axes.scatter(base[:, 0], base[:, 1], color=BASE_COLOR, **style)
    moved = snapshot.displacement_magnitude[snapshot.column]
    axes.scatter(column[:, 0], column[:, 1], c=moved, cmap=COLORS, vmin=0, vmax=view.limit, **style)


def _add_surroundings(axes: Axes, view: View) -> None:
    """Where the column stood (dashed), and the wall (solid) or the axis of symmetry (dash-dot)."""
    r_i, h_i = float(view.meta["r_i"]), float(view.meta["h_i"])
    axes.plot([0, r_i, r_i], [h_i, h_i, 0], color="0.35", linewidth=1, linestyle=(0, (5, 4)))
    symmetric = view.meta["model"] == "axisymmetric" or _is_half(view)
    axes.plot([0, 0], [0, 2 * h_i], linestyle="dashdot" if symmetric else "solid", **EDGE)


def _add_floor(axes: Axes, view: View, has_base: bool) -> None:
    """A line where there is no base; a base, which goes on beyond the picture, gets a torn edge."""
    left, right, bottom, _ = view.extent
    end = right + left / 2  # beyond the material by half of the margin that is left of the wall
    if not has_base:
        axes.plot([0, end], [0, 0], **EDGE)
        return
    y = np.linspace(bottom, float(view.meta["point_size"]), 16)
    zigzag = 0.003 * (right - left) * np.where(np.arange(16) % 2, 1, -1)
    axes.fill_betweenx(y, end + zigzag, right, color="white", linewidth=0)


def _is_half(view: View) -> bool:
    return view.meta.get("release") == "two-sided"


def _add_text(figure: Figure, snapshot: Snapshot, view: View) -> None:
    y = 1 - HEAD / 2
    stage = "" if snapshot.stage == "collapse" else f"{snapshot.stage}, "
    title = str(view.meta["title"]) + (" (half model by symmetry)" if _is_half(view) else "")
    figure.text(0.03, y, title, size=16, va="center", parse_math=False)
    figure.text(0.97, y, f"{stage}t = {snapshot.time:.3f} s", size=16, va="center", ha="right")


def _add_scale_bar(figure: Figure, view: View) -> None:
    """A bar of 1, 2 or 5 times a power of ten mm, about a sixth of the width, in the lower left corner."""
    width = 1000 * (view.extent[1] - view.extent[0])
    power = 10 ** np.floor(np.log10(width / 6))
    length = max(step * power for step in (1, 2, 5) if step * power <= width / 6)
    left, middle = 0.03, FOOT / 2
    bar = figure.add_axes((left, middle, length / width, 0.008))
    bar.set(xticks=[], yticks=[], facecolor="black")
    figure.text(left + length / width / 2, middle - 0.015, f"{length:g} mm", size=14, va="top", ha="center")


def _add_color_bar(figure: Figure, view: View) -> None:
    scale = ScalarMappable(Normalize(0, 1000 * view.limit), colormaps[COLORS])
    axes = figure.add_axes((0.35, FOOT / 2, 0.6, 0.025))
    bar = figure.colorbar(scale, cax=axes, orientation="horizontal", ticks=MaxNLocator(6))
    bar.ax.tick_params(labelsize=14)
    bar.set_label("displacement magnitude (mm)", size=14)
