"""Image of one snapshot: the material points in a view, with scale bar, colour bar, title and time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image

from mpmcol.errors import OutputError
from mpmcol.io.snapshot import Meta, Snapshot, read_meta, read_snapshot
from mpmcol.plotting.render.coloring import Coloring
from mpmcol.plotting.render.projection import circle, complete_by_symmetry, silhouette

COLORMAP = "viridis"
BASE_COLOR = "#b5b5b5"
EDGE: dict[str, Any] = {"color": "0.15", "linewidth": 1.2}
RELEASED: dict[str, Any] = {"color": "0.35", "linewidth": 1, "linestyle": (0, (5, 4))}
HEAD, FOOT = 0.1, 0.17  # shares of the height for the heading and for the scales

Extent = tuple[float, float, float, float]  # left, right, bottom, top, m


def canvas_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height, in pixels, of the part of the image that shows the material."""
    return size[0], size[1] - int(HEAD * size[1]) - int(FOOT * size[1])


@dataclass(frozen=True)
class View(ABC):
    """A view of a run, the same for every frame of an animation.

    extent: part of the view plane that is shown, m. coloring: quantity by which points are coloured; limit: its value
    at the upper end of the colour scale. size: width and height of the image, pixels. The material takes the full width
    between the heading (HEAD) and the scales (FOOT).
    """

    extent: Extent
    coloring: Coloring
    limit: float
    size: tuple[int, int]
    meta: Meta

    @property
    @abstractmethod
    def note(self) -> str:
        """Addition to the title: how the image completes or cuts the model."""

    @abstractmethod
    def points(self, snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """Positions (m, 3), m, to the right, upward and toward the viewer, and colours (m, 3) of the points shown."""

    @abstractmethod
    def draw_surroundings(self, axes: Axes, snapshot: Snapshot) -> None:
        """Add outlines and boundaries, in the coordinates of the first two columns of `points`."""

    @property
    def point_pixels(self) -> float:
        """Diameter of a material point, pixels; larger than the point spacing, to close gaps in sheared material."""
        left, right, _, _ = self.extent
        return max(1.3 * float(self.meta["point_size"]) / (right - left) * self.size[0], 1.0)

    def colors(self, snapshot: Snapshot) -> np.ndarray:
        """Red, green and blue (n, 3), 0 to 1, of all points; those of the base are grey."""
        colors = colormaps[COLORMAP](self.coloring.values(snapshot) / self.limit)[:, :3]
        colors[~snapshot.column] = to_rgb(BASE_COLOR)
        return colors


def read_for_rendering(path: Path) -> tuple[Snapshot, Meta]:
    """Points and metadata of a snapshot file, without points at non-finite positions (of a failed run).

    Raises OutputError if the file cannot be read or lacks metadata.
    """
    snapshot, meta = read_snapshot(path), read_meta(path)
    missing = sorted({"title", "model", "point_size", "r_i", "h_i"} - meta.keys())
    if missing:
        raise OutputError(
            f"{path}: cannot be rendered; metadata {', '.join(missing)} missing. Use a snapshot of `mpmcol run`."
        )
    finite = np.isfinite(snapshot.arrays["position"]).all(axis=1)
    return replace(snapshot, arrays={name: values[finite] for name, values in snapshot.arrays.items()}), meta


def released_outline(snapshot: Snapshot, meta: Meta, projection: np.ndarray) -> np.ndarray:
    """Projected outline (m, 2), m, of the column of a 3D model at release; its section must be convex."""
    r_i, h_i, point_size = (float(meta[name]) for name in ("r_i", "h_i", "point_size"))
    released = (snapshot.arrays["position"] - snapshot.arrays["displacement"])[snapshot.column]
    x, _ = complete_by_symmetry(released, str(meta["model"]))
    if meta.get("section", "cylinder") == "cylinder":  # exact circles are smoother than the points
        return silhouette(np.concatenate([circle(r_i, 0.0), circle(r_i, h_i)]), projection, 0.0)
    return silhouette(x, projection, point_size)


def fit(extent: Extent, canvas: tuple[int, int]) -> Extent:
    """Widen the extent about its centre by a margin and to the aspect ratio of the canvas (equal axes)."""
    left, right, bottom, top = extent
    scale = 1.08 * max((right - left) / canvas[0], (top - bottom) / canvas[1])
    half_width, half_height = scale * canvas[0] / 2, scale * canvas[1] / 2
    x, y = (left + right) / 2, (bottom + top) / 2
    return x - half_width, x + half_width, y - half_height, y + half_height


def compose(snapshot: Snapshot, view: View, points_image: Path | None) -> Image.Image:
    """The finished image; Matplotlib draws the points if there is no image of them."""
    figure = new_figure(view.size)
    axes = figure.add_axes((0, int(FOOT * view.size[1]) / view.size[1], 1, canvas_size(view.size)[1] / view.size[1]))
    axes.set_axis_off()
    if points_image is None:
        _scatter(axes, snapshot, view, figure.dpi)
    else:
        axes.imshow(np.asarray(Image.open(points_image)), extent=view.extent, interpolation="auto")
    axes.set(xlim=view.extent[:2], ylim=view.extent[2:], aspect="auto")
    view.draw_surroundings(axes, snapshot)
    add_heading(figure, f"{view.meta['title']}{view.note}", snapshot)
    _add_scale_bar(figure, view)
    _add_color_bar(figure, view)
    return as_image(figure, view.size)


def new_figure(size: tuple[int, int]) -> Figure:
    """An empty figure of `size` pixels, always 7.2 inches high, so that text and lines scale with the image."""
    width, height = size
    return Figure(figsize=(7.2 * width / height, 7.2), dpi=height / 7.2)


def as_image(figure: Figure, size: tuple[int, int]) -> Image.Image:
    """The figure as an image of exactly `size` pixels."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB").crop((0, 0, *size))


def add_heading(figure: Figure, title: str, snapshot: Snapshot) -> None:
    """Add the title at the upper left, stage and time at the upper right."""
    y = 1 - HEAD / 2
    stage = "" if snapshot.stage == "collapse" else f"{snapshot.stage}, "
    figure.text(0.03, y, title, size=16, va="center", parse_math=False)
    figure.text(0.97, y, f"{stage}t = {snapshot.time:.3f} s", size=16, va="center", ha="right")


def _scatter(axes: Axes, snapshot: Snapshot, view: View, dpi: float) -> None:
    x, colors = view.points(snapshot)
    order = np.argsort(x[:, 2], kind="stable")
    area = (view.point_pixels * 72 / dpi) ** 2
    axes.scatter(x[order, 0], x[order, 1], s=area, c=colors[order], marker="s", linewidths=0)


def _add_scale_bar(figure: Figure, view: View) -> None:
    """Add a bar of 1, 2 or 5 times a power of ten mm, at most a sixth of the width, in the lower left corner."""
    width = 1000 * (view.extent[1] - view.extent[0])
    power = 10 ** np.floor(np.log10(width / 6))
    length = max(step * power for step in (1, 2, 5) if step * power <= width / 6)
    left, middle = 0.03, FOOT / 2
    bar = figure.add_axes((left, middle, length / width, 0.008))
    bar.set(xticks=[], yticks=[], facecolor="black")
    figure.text(left + length / width / 2, middle - 0.015, f"{length:g} mm", size=14, va="top", ha="center")


def _add_color_bar(figure: Figure, view: View) -> None:
    scale = ScalarMappable(Normalize(0, view.coloring.factor * view.limit), colormaps[COLORMAP])
    axes = figure.add_axes((0.35, FOOT / 2, 0.6, 0.025))
    bar = figure.colorbar(scale, cax=axes, orientation="horizontal", ticks=MaxNLocator(6))
    bar.ax.tick_params(labelsize=14)
    bar.set_label(view.coloring.label, size=14)
