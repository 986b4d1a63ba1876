"""Page with one snapshot: the material points in a view, with axes, colour bar, title and time."""

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
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont
from matplotlib.ticker import MaxNLocator
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from mpmcol.errors import OutputError
from mpmcol.io.snapshot import Meta, Snapshot, read_with_meta
from mpmcol.plotting.captions import geometry_of_snapshot, heading_of_snapshot
from mpmcol.plotting.render.coloring import Coloring, Limits
from mpmcol.plotting.render.gaps import fill_gaps
from mpmcol.plotting.render.projection import circle, complete_by_symmetry, silhouette

COLORMAP = "viridis"
BASE_COLOR = "#b5b5b5"
EDGE: dict[str, Any] = {"color": "0.15", "linewidth": 1.2}
RELEASED: dict[str, Any] = {"color": "0.35", "linewidth": 1, "linestyle": (0, (5, 4))}
PAGE = (1280, 720)  # pixels, the default; texts are larger and smaller in proportion to it
DPI = 100  # of a page of this size
HEAD, FOOT = 0.864, 1.584  # inches of the page for heading and for scales below
SIDE = 0.08  # share of its width for the axis on the left
LOWEST, HIGHEST = 600, 1280  # height of a page of the default width, pixels
BAR = (0.65, 0.16)  # inches: lower edge and thickness of the colour bar
TITLE_SIZE, TEXT_SIZE, SMALL_SIZE = 16, 14, 12  # points

Extent = tuple[float, float, float, float]  # left, right, bottom, top, m


def dots_per_inch(size: tuple[int, int]) -> float:
    """Resolution of a page of `size` pixels, with which its texts fit into both directions."""
    return DPI * min(size[0] / PAGE[0], size[1] / PAGE[1])


def canvas_box(size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Left and upper edge, width and height of the part of a page that shows the material, pixels."""
    dpi = dots_per_inch(size)
    left, top = int(SIDE * size[0]), int(HEAD * dpi)
    return left, top, size[0] - left - int(0.3 * SIDE * size[0]), size[1] - top - int(FOOT * dpi)


def canvas_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height of the part of a page that shows the material, pixels."""
    return canvas_box(size)[2:]


def page_around(canvas: tuple[float, float]) -> tuple[int, int]:
    """Width and height of the page whose canvas has this width and height, pixels; inverse of `canvas_size`."""
    width, height = canvas[0] / (1.0 - 1.3 * SIDE), canvas[1]
    around = DPI * (HEAD + FOOT)  # heading and scales, of a page that is as wide or as high as the default one
    return round(width), round(min(height + around * width / PAGE[0], height / (1.0 - around / PAGE[1])))


def fitting_page(flatness: float) -> tuple[int, int]:
    """Width and height of a page of the default width for material of this height over its width, pixels."""
    width = canvas_size(PAGE)[0]
    return PAGE[0], min(max(page_around((width, flatness * width))[1], LOWEST), HIGHEST)


@dataclass(frozen=True)
class View(ABC):
    """A view of a run, the same for every frame of an animation.

    extent: part of the view plane that is shown, m. coloring: quantity by which points are coloured; limits: its values
    at the ends of the colour scale. size: width and height of the page, pixels.
    """

    extent: Extent
    coloring: Coloring
    limits: Limits
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
    def draw_behind(self, axes: Axes) -> None:
        """Draw what the points cover, in the coordinates of the first two columns of `points`."""

    @abstractmethod
    def draw_before(self, axes: Axes) -> None:
        """Draw outlines, boundaries and scales of length over the points."""

    @property
    def point_pixels(self) -> float:
        """Diameter of a material point, pixels; larger than the point spacing, to close gaps in sheared material."""
        left, right, _, _ = self.extent
        return max(1.3 * float(self.meta["point_size"]) / (right - left) * canvas_size(self.size)[0], 1.0)

    def colors(self, snapshot: Snapshot) -> np.ndarray:
        """Red, green and blue (n, 3), 0 to 1, of all points."""
        low, high = self.limits
        return colormaps[COLORMAP]((self.coloring.values(snapshot) - low) / (high - low))[:, :3]


class Page:
    """The page of a view: all but the points and the time is drawn once for all snapshots."""

    def __init__(self, view: View) -> None:
        self._view = view
        behind, axes = self._layer()
        view.draw_behind(axes)
        self._behind = as_image(behind, view.size)
        before, axes = self._layer()
        view.draw_before(axes)
        add_title(before, view.meta, view.note)
        _add_color_bar(before, view)
        before.patch.set_visible(False)
        self._before = as_image(before, view.size, "RGBA")

    def draw(self, snapshot: Snapshot, points_image: Path | None) -> Image.Image:
        """The finished page; Matplotlib draws the points if there is no image of them."""
        page = self._behind.copy()
        if points_image is None:
            points, corner = self._scatter(snapshot), (0, 0)
        else:
            points, corner = Image.open(points_image), canvas_box(self._view.size)[:2]
        points = without_gaps(points, self._view.point_pixels)
        page.paste(points, corner, points)
        page.paste(self._before, (0, 0), self._before)
        add_time(page, snapshot)
        return page

    def _layer(self) -> tuple[Figure, Axes]:
        """An empty figure with axes, not visible, for the part of the page that shows the material."""
        figure = new_figure(self._view.size)
        width, height = self._view.size
        left, top, across, up = canvas_box(self._view.size)
        axes = figure.add_axes((left / width, 1.0 - (top + up) / height, across / width, up / height))
        axes.set(xlim=self._view.extent[:2], ylim=self._view.extent[2:], autoscale_on=False)
        axes.set_axis_off()
        return figure, axes

    def _scatter(self, snapshot: Snapshot) -> Image.Image:
        figure, axes = self._layer()
        figure.patch.set_visible(False)
        x, colors = self._view.points(snapshot)
        order = np.argsort(x[:, 2], kind="stable")
        area = (self._view.point_pixels * 72 / figure.dpi) ** 2
        axes.scatter(x[order, 0], x[order, 1], s=area, c=colors[order], marker="s", linewidths=0)
        return as_image(figure, self._view.size, "RGBA")


def without_gaps(points: Image.Image, diameter: float) -> Image.Image:
    """An image of points (RGBA) with the gaps between them filled."""
    pixels = np.array(points)
    alpha = pixels[:, :, 3]
    filled = Image.fromarray(fill_gaps(pixels[:, :, :3], alpha > 0, diameter).astype(np.uint8))
    inside = np.array(filled.filter(ImageFilter.MinFilter(3))) > 0  # the edge remains smooth
    alpha[inside] = 255
    return Image.fromarray(pixels)


def read_for_rendering(path: Path) -> tuple[Snapshot, Meta]:
    """Points and metadata of a snapshot file, without points at non-finite positions (of a failed run).

    Raises OutputError if the file cannot be read or lacks metadata.
    """
    snapshot, meta = read_with_meta(path)
    missing = sorted({"title", "model", "point_size", "spacing", "r_i", "h_i"} - meta.keys())
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
        upslope = np.array([geometry_of_snapshot(meta).lean * h_i, 0.0, 0.0])
        return silhouette(np.concatenate([circle(r_i, 0.0), circle(r_i, h_i) - upslope]), projection, 0.0)
    return silhouette(x, projection, point_size)


def fit(extent: Extent, canvas: tuple[int, int]) -> Extent:
    """Widen the extent about its centre by a margin and to the aspect ratio of the canvas (equal axes)."""
    left, right, bottom, top = extent
    scale = 1.08 * max((right - left) / canvas[0], (top - bottom) / canvas[1])
    half_width, half_height = scale * canvas[0] / 2, scale * canvas[1] / 2
    x, y = (left + right) / 2, (bottom + top) / 2
    return x - half_width, x + half_width, y - half_height, y + half_height


def new_figure(size: tuple[int, int]) -> Figure:
    """An empty figure of `size` pixels, whose text and lines scale with the image."""
    dpi = dots_per_inch(size)
    return Figure(figsize=(size[0] / dpi, size[1] / dpi), dpi=dpi)


def as_image(figure: Figure, size: tuple[int, int], mode: str = "RGB") -> Image.Image:
    """The figure as an image of exactly `size` pixels."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert(mode).crop((0, 0, *size))


def add_title(figure: Figure, meta: Meta, note: str) -> None:
    """Add the title at the upper left, and the parameters of the run below it."""
    heading, head = heading_of_snapshot(meta), HEAD / figure.get_figheight()
    figure.text(0.03, 1 - 0.35 * head, f"{heading.title}{note}", size=TITLE_SIZE, va="center", parse_math=False)
    figure.text(0.03, 1 - 0.75 * head, heading.caption, size=SMALL_SIZE, va="center", color="0.3")


def add_time(page: Image.Image, snapshot: Snapshot) -> None:
    """Write the time at the upper right, and the stage, unless it is the collapse."""
    dpi = dots_per_inch(page.size)
    stage = "" if snapshot.stage == "collapse" else f"{snapshot.stage}, "
    font = ImageFont.truetype(findfont("DejaVu Sans"), TITLE_SIZE / 72 * dpi)
    place = (0.97 * page.size[0], 0.35 * HEAD * dpi)
    ImageDraw.Draw(page).text(place, f"{stage}t = {snapshot.time:.3f} s", fill="black", font=font, anchor="rm")


def _add_color_bar(figure: Figure, view: View) -> None:
    label, ends = view.coloring.scale(view.limits)
    scale = ScalarMappable(Normalize(*ends), colormaps[COLORMAP])
    low, thickness = (inches / figure.get_figheight() for inches in BAR)
    axes = figure.add_axes((0.28, low, 0.5, thickness))
    beyond = "max" if view.coloring.from_zero else "both"
    extend = beyond if view.coloring.percentile < 100.0 else "neither"  # values beyond an end have its colour
    bar = figure.colorbar(scale, cax=axes, orientation="horizontal", ticks=MaxNLocator(6), extend=extend)
    bar.ax.tick_params(labelsize=SMALL_SIZE)
    bar.set_label(label, size=SMALL_SIZE)
