"""Parts that charts share: labels beside lines, and files."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from mpmcol.plotting.figures import (
    DPI,
    LABEL_SIZE,
    MARGIN,
    EndLabel,
    Heading,
    add_heading,
    label_ends,
    lay_out,
    save_figure,
)


@pytest.fixture
def axes() -> Axes:
    return Figure(figsize=(6.0, 4.0), layout="constrained").subplots()


def levels(axes: Axes) -> list[float]:
    """Heights of the labels beside the axes, as fractions of these."""
    return [note.xyann[1] for note in axes.texts]


def test_a_label_is_at_the_height_of_the_end_of_its_line(axes: Axes) -> None:
    """Although the limits of the axes follow from the lines."""
    ends = [0.0, 0.5, 2.0]
    for end in ends:
        axes.plot([0.0, 1.0], [0.0, end])
    label_ends({axes: [EndLabel(1.0, end, f"{end}", "black") for end in ends]})
    (low, high), found = axes.get_ylim(), levels(axes)
    np.testing.assert_allclose(found, [(end - low) / (high - low) for end in ends], atol=1e-6)


def test_labels_of_lines_that_end_together_are_moved_apart(axes: Axes) -> None:
    axes.plot([0.0, 1.0], [0.0, 1.0])
    label_ends({axes: [EndLabel(1.0, 1.0, name, "black") for name in "abc"]})
    height = axes.get_window_extent().height * 72.0 / DPI
    np.testing.assert_allclose(np.diff(levels(axes)), 1.35 * LABEL_SIZE / height)
    assert max(levels(axes)) <= 1.0


@pytest.mark.parametrize(("start", "end"), [((1.0, 1.0), (2.0, 4.0)), ((1.0, 4.0), (2.0, 1.0))])
def test_a_label_within_the_axes_is_written_along_its_line(
    axes: Axes, start: tuple[float, float], end: tuple[float, float]
) -> None:
    """Parallel to the line and above it, whether it rises or falls."""
    axes.set(xscale="log", yscale="log", xlim=(0.5, 10.0), ylim=(0.1, 20.0))
    label_ends({axes: [EndLabel(*end, "law", "black", start)]})
    (note,) = axes.texts
    last, first = (axes.transData.transform(point) for point in (end, start))
    assert note.get_rotation() == pytest.approx(np.degrees(np.arctan2(*(last - first)[::-1])) % 360.0)
    box = note.get_window_extent()
    middle = np.array([(box.x0 + box.x1) / 2.0, (box.y0 + box.y1) / 2.0])
    assert middle[0] < last[0]
    line = first[1] + (middle[0] - first[0]) * (last - first)[1] / (last - first)[0]
    assert middle[1] > line


@pytest.mark.parametrize("layout", ["constrained", None])
def test_a_picture_shows_everything_with_a_margin(tmp_path: Path, layout: Literal["constrained"] | None) -> None:
    """Without a layout a text is beyond the figure. The box of a text is up to a few pixels larger than its ink."""
    figure = Figure(figsize=(6.0, 4.0), layout=layout)
    figure.subplots().text(1.2, 0.5, "beyond the axes")
    (path,) = save_figure(figure, tmp_path / "chart.png", svg=False)
    with Image.open(path) as image:
        ink = np.asarray(image.convert("L")) < 250
        assert image.info["dpi"] == pytest.approx((DPI, DPI), rel=1e-3)
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    margins = [rows[0], columns[0], ink.shape[0] - 1 - rows[-1], ink.shape[1] - 1 - columns[-1]]
    np.testing.assert_allclose(margins, MARGIN * DPI, atol=8.0)


def test_a_caption_wider_than_the_figure_is_broken() -> None:
    """Otherwise the layout makes the axes narrower."""
    parts = [rf"$\varphi_{i}$ = {i}$\degree$ and some more words" for i in range(6)]
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    add_heading(axes := figure.subplots(), Heading("title", ", ".join(parts), "a reason " * 12))
    lay_out(figure)
    assert axes.get_window_extent().width > 0.75 * figure.bbox.width
    lines = axes.texts[0].get_text().split("\n")
    caption, reason = lines[:3], lines[3:]
    assert " ".join(caption) == ", ".join(parts) and all(line.count("$") % 2 == 0 for line in lines)
    assert len(reason) == 2 and abs(len(reason[0]) - len(reason[1])) < 20
