"""The material points of a run as an image or an animation, drawn fast.

`mpmcol render` draws each frame with its surroundings, which takes seconds. Here Matplotlib draws the surroundings
once; each point is a square of pixels that NumPy adds.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from functools import cached_property
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import font_manager
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from PIL import Image, ImageDraw, ImageFont

from mpmcol.io.snapshot import Snapshot, read_snapshot
from mpmcol.plotting.render import FIT_VIEW
from mpmcol.plotting.render.animation import gif_with
from mpmcol.plotting.render.coloring import COLORINGS
from mpmcol.plotting.render.frame import COLORMAP, View, as_image, page_around
from mpmcol.plotting.render.gaps import fill_gaps

WIDTH = 800  # pixels
LEFT, RIGHT, TOP, BOTTOM = 90, 24, 48, 160  # margins around the material, pixels
LOWEST, HIGHEST = 0.25, 1.0  # height of the image of the material over its width
DPI = 120  # for text that is readable where the image is shown at half of its size
LEAST_SIDE = 2  # of a point, pixels: smaller ones leave gaps where the material has dilated
LIGHTEST = 248  # level from which on a grey counts as white


class PointImages:
    """Images of snapshots in one view with common scales.

    paths: snapshot files. view: "side" or "3d". color: a key of COLORINGS. flatness: height over width of the material.
    """

    def __init__(self, paths: Sequence[Path], view: str, color: str, flatness: float) -> None:
        width = WIDTH - LEFT - RIGHT
        height = width * min(max(flatness, LOWEST), HIGHEST)
        self._paths = paths
        self._view: View = FIT_VIEW[view](paths, page_around((width, height)), COLORINGS[color], 0.0)

    def image(self, index: int) -> Image.Image:
        """One snapshot."""
        return self._draw(read_snapshot(self._paths[index]))

    def images(self) -> list[Image.Image]:
        """All snapshots."""
        return [self.image(i) for i in range(len(self._paths))]

    @cached_property
    def _canvas(self) -> tuple[int, int]:
        """Width and height of the image of the material, pixels."""
        left, right, bottom, top = self._view.extent
        width = WIDTH - LEFT - RIGHT
        return width, round(width * (top - bottom) / (right - left))

    @cached_property
    def _behind(self) -> Image.Image:
        """What the points cover."""
        return self._layer(self._view.draw_behind, "RGB")

    @cached_property
    def _before(self) -> Image.Image:
        """Outlines, axes and colour bar, on a transparent ground."""
        return self._layer(self._view.draw_before, "RGBA")

    def _layer(self, draw: Callable[[Axes], None], mode: str) -> Image.Image:
        width, height = self._canvas
        total = height + TOP + BOTTOM
        figure = Figure(figsize=(WIDTH / DPI, total / DPI), dpi=DPI)
        axes = figure.add_axes((LEFT / WIDTH, BOTTOM / total, width / WIDTH, height / total))
        axes.set(xlim=self._view.extent[:2], ylim=self._view.extent[2:], autoscale_on=False)
        axes.set_axis_off()
        draw(axes)
        if mode == "RGBA":
            figure.patch.set_visible(False)
            bar = figure.add_axes((LEFT / WIDTH, 60 / total, width / WIDTH, 14 / total))
            label, ends = self._view.coloring.scale(self._view.limits)
            scale = ScalarMappable(Normalize(*ends), COLORMAP)
            figure.colorbar(scale, cax=bar, orientation="horizontal", label=label)
        return as_image(figure, (WIDTH, total), mode)

    def _draw(self, snapshot: Snapshot) -> Image.Image:
        width, height = self._canvas
        pixels = np.array(self._behind)
        material = pixels[TOP : TOP + height, LEFT : LEFT + width]
        paint_points(material, *self._view.points(snapshot), self._view.extent, self._view.point_pixels)
        image = Image.fromarray(pixels)
        image.paste(self._before, (0, 0), self._before)
        ImageDraw.Draw(image).text((LEFT, 9), f"t = {snapshot.time:.3f} s", fill="black", font=_font())
        return image


def paint_points(image: np.ndarray, x: np.ndarray, colors: np.ndarray, extent: tuple[float, ...], side: float) -> None:
    """Add squares to an image, where points nearer to the viewer cover others, and fill the gaps between them.

    Args:
        image: (rows, columns, 3), 0 to 255, changed in place.
        x: positions (n, 3), m, to the right, upward and toward the viewer.
        colors: (n, 3), 0 to 1.
        extent: left, right, bottom and top of the image, m.
        side: of a square, pixels.
    """
    rows, columns = image.shape[:2]
    left, right, bottom, top = extent
    order = np.argsort(x[:, 2], kind="stable")
    offset = np.arange(max(ceil(side), LEAST_SIDE))
    column = np.rint((x[order, 0] - left) / (right - left) * columns - side / 2.0).astype(int)[:, None] + offset
    row = np.rint((top - x[order, 1]) / (top - bottom) * rows - side / 2.0).astype(int)[:, None] + offset
    column[(column < 0) | (column >= columns)] = columns  # beyond the last one, which is left out below
    row[(row < 0) | (row >= rows)] = rows
    nearest = np.full((rows + 1) * (columns + 1), -1)
    # of several values for a pixel the last one remains
    nearest[row[:, :, None] * (columns + 1) + column[:, None, :]] = np.arange(len(x))[:, None, None]
    nearest = nearest.reshape(rows + 1, columns + 1)[:rows, :columns]
    covered = nearest >= 0
    image[covered] = np.rint(255.0 * colors[order]).astype(np.uint8)[nearest[covered]]
    fill_gaps(image, covered, len(offset))


def encode_animation(images: Sequence[Image.Image]) -> bytes:
    """A GIF that repeats, with the colours of the first image, which has the colour bar."""
    first = images[0].quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    _restore_white(first)
    return gif_with(first, images)


def _restore_white(image: Image.Image) -> None:
    """Make the lightest greys white; the choice of a palette mixes white with the greys of the text."""
    palette = np.array(image.getpalette()).reshape(-1, 3)
    palette[(palette >= LIGHTEST).all(axis=1)] = 255
    image.putpalette(palette.ravel().tolist())


def encode_image(image: Image.Image) -> bytes:
    """A PNG with at most 256 colours."""
    buffer = io.BytesIO()
    image.quantize(256, dither=Image.Dither.NONE).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def _font() -> Any:
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 19)
