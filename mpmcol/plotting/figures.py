"""Parts that charts share: headings, ticks, legends, labels beside lines, and files."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from math import ceil
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, StrMethodFormatter
from PIL import Image

from mpmcol.io.atomic import atomic_write

MOST_ENTRIES = 7  # of a legend; more lines are labelled beside their ends or grouped
DPI = 150
MARGIN = 0.1  # inch: around what a chart shows
LABEL_SIZE = 8.3  # points
LETTERS_PER_INCH = 14.0  # of a line below the title
RIGHT_EDGE = 0.7  # of the width of the axes: lines that end farther to the right are labelled beside the axes
# Steps of the ticks of a logarithmic axis that covers at most so many decades.
_TICK_STEPS = ((1.3, (1.0, 2.0, 3.0, 5.0, 7.0)), (2.5, (1.0, 2.0, 5.0)), (np.inf, (1.0,)))

_CONNECTOR: dict[str, Any] = {"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 1.0, "shrinkB": 0.0, "relpos": (0.0, 0.5)}

HALO = withStroke(linewidth=2.5, foreground="white")


class Heading(NamedTuple):
    """Title of a chart, and below it a line with the parameters of the run, and one on what the chart does not show."""

    title: str
    caption: str = ""
    note: str = ""


class EndLabel(NamedTuple):
    """Text for a line that ends at x, y (data coordinates): beside the axes; along the line from `start` to there if
    it ends within the axes and `start` is given."""

    x: float
    y: float
    text: str
    colour: Any
    start: tuple[float, float] | None = None


def add_heading(axes: Axes, heading: Heading) -> None:
    """Write title, caption and note above the axes."""
    lines = lines_below_title(axes.figure, heading)
    if lines:
        axes.annotate(
            "\n".join(lines), (0.5, 1.0), (0.0, 4.0), xycoords="axes fraction", textcoords="offset points",
            ha="center", va="bottom", fontsize=LABEL_SIZE, color="0.3",
        )  # fmt: skip
    axes.set_title(heading.title, pad=6.0 + 12.0 * len(lines), parse_math=False)


def with_heading(figure: Figure, heading: Heading) -> Any:
    """Write title, caption and note above all panels of a figure with constrained layout; returns their SubFigure."""
    figure.suptitle(heading.title, parse_math=False)
    panels: Any = figure.subfigures()
    panels.suptitle("\n".join(lines_below_title(figure, heading)), fontsize=LABEL_SIZE, color="0.3")
    return panels


def lines_below_title(figure: Any, heading: Heading) -> list[str]:
    """Caption and note, broken where they are wider than the figure: its layout would make the axes narrower."""
    limit = LETTERS_PER_INCH * figure.bbox.width / figure.dpi
    return [line for text in (heading.caption, heading.note) if text for line in _broken(text, limit)]


def _broken(text: str, limit: float) -> list[str]:
    """A text in equally long lines of about `limit` letters, broken at commas, in longer parts at spaces."""
    parts: list[str] = []
    for part in re.split(r"(?<=,) ", text):
        parts += [part] if _letters(part) < limit else part.split(" ")
    least = _letters(text) / ceil(_letters(text) / limit)
    lines = [parts[0]]
    for part in parts[1:]:
        longer = f"{lines[-1]} {part}"
        if _letters(lines[-1]) < least and _letters(longer) <= limit:
            lines[-1] = longer
        else:
            lines.append(part)
    return lines


def _letters(text: str) -> int:
    """Number of letters of a text without its mathematical markup."""
    return len(re.sub(r"\\[a-z]+", "x", text).replace("$", "").replace("_", ""))


def use_plain_ticks(axis: Axis) -> None:
    """Label a logarithmic axis with plain numbers (0.5, 1, 2, 5, 10); call it when the limits are final.

    An axis of less than half a decade gets equally spaced ticks, others get the more steps per decade the shorter they
    are, so that each axis has several labels.
    """
    low, high = axis.get_view_interval()
    decades = float(np.log10(high / low))
    if decades < 0.5:
        axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    else:
        steps = next(steps for limit, steps in _TICK_STEPS if decades <= limit)
        axis.set_major_locator(LogLocator(subs=steps, numticks=20))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_locator(NullLocator())


def label_ends(labels_of: Mapping[Axes, Sequence[EndLabel]]) -> None:
    """Write labels of lines that end at the right edge of axes beside these, moved apart where they would overlap, and
    others next to the end of their line. The layout of the figure is final after it."""
    for axes in labels_of:
        axes.autoscale_view()  # otherwise limits are adapted to the lines only when the figure is drawn
    beside = {
        axes: [_write_beside(axes, label) for label in labels if _ends_at_edge(axes, label)]
        for axes, labels in labels_of.items()
    }
    for axes, notes in beside.items():
        figure: Any = axes.figure
        lay_out(figure)  # for the size of the axes
        for label in labels_of[axes]:
            if not _ends_at_edge(axes, label):
                _write_within(axes, label)
        height = axes.get_window_extent().height * 72.0 / figure.dpi
        levels = _apart(np.array([note.xyann[1] for note in notes]), 1.35 * LABEL_SIZE / height)
        for note, level in zip(notes, levels, strict=True):
            note.xyann = (note.xyann[0], float(level))


def _end_in_axes(axes: Axes, label: EndLabel) -> np.ndarray:
    """The end of a line in fractions of the axes, (2,)."""
    return axes.transAxes.inverted().transform(axes.transData.transform(label[:2]))


def _ends_at_edge(axes: Axes, label: EndLabel) -> bool:
    return bool(_end_in_axes(axes, label)[0] > RIGHT_EDGE)


def _write_beside(axes: Axes, label: EndLabel) -> Annotation:
    """Write a label beside the axes at the height of the end of its line."""
    return axes.annotate(
        label.text,
        label[:2],
        xytext=(1.025, _end_in_axes(axes, label)[1]),
        textcoords="axes fraction",
        arrowprops=_CONNECTOR | {"color": label.colour},
        va="center",
        annotation_clip=False,
        color=label.colour,
        fontsize=LABEL_SIZE,
    )


def _write_within(axes: Axes, label: EndLabel) -> None:
    """Write a label along its line, above it and up to its end, or next to the end; the size of the axes must be
    final."""
    place: dict[str, Any] = {"xytext": (6.0, 7.0), "va": "center"}
    if label.start:
        across, up = axes.transData.transform(label[:2]) - axes.transData.transform(label.start)
        place = {"xytext": (0.0, 3.0), "va": "bottom", "ha": "right", "rotation_mode": "anchor"}
        place["rotation"] = float(np.degrees(np.arctan2(up, across)))
    text: dict[str, Any] = {"color": label.colour, "fontsize": LABEL_SIZE, "path_effects": [HALO]}
    axes.annotate(label.text, label[:2], textcoords="offset points", **text, **place)


def lay_out(figure: Figure) -> None:
    """Lay the figure out, once: this takes as long as drawing it."""
    figure.dpi = DPI  # of the file: sizes of texts are kept for each resolution
    if engine := figure.get_layout_engine():
        engine.execute(figure)
    figure.set_layout_engine("none")


def _apart(positions: np.ndarray, gap: float) -> np.ndarray:
    """Positions in the same order with at least `gap` between neighbours, near the given ones and, if they fit, in
    0 to 1."""
    order = np.argsort(positions, kind="stable")
    placed = positions[order].copy()
    for i in range(1, len(placed)):
        placed[i] = max(placed[i], placed[i - 1] + gap)
    top = max(1.0, float(positions.max(initial=0.0)))
    for i in reversed(range(len(placed))):
        placed[i] = min(placed[i], top - (len(placed) - 1 - i) * gap)
    result = np.empty_like(placed)
    result[order] = placed
    return result


def legend_below(figure: Figure, handles: Sequence[Any], labels: Sequence[str], columns: int = 2) -> None:
    """Add a legend below all axes; a tuple of handles is drawn side by side."""
    figure.legend(
        list(handles), list(labels), loc="outside lower center", ncols=columns, frameon=False, fontsize=LABEL_SIZE,
        handler_map={tuple: HandlerTuple(ndivide=None)},
    )  # fmt: skip


def save_figure(figure: Figure, path: Path, svg: bool) -> list[Path]:
    """Write a PNG with DPI pixels per inch and, if `svg`, an SVG beside it; raises OutputError."""
    canvas = FigureCanvasAgg(figure)
    lay_out(figure)
    atomic_write(path, _png(canvas))
    if not svg:
        return [path]
    data = io.BytesIO()
    figure.savefig(data, format="svg", bbox_inches="tight")
    atomic_write(path.with_suffix(".svg"), data.getvalue())
    return [path, path.with_suffix(".svg")]


def _png(canvas: FigureCanvasAgg) -> bytes:
    """The figure with a margin of MARGIN around what it shows.

    `savefig` draws a figure twice to find that; here it is cut out of one drawing, unless it extends beyond the figure.
    """
    figure, data = canvas.figure, io.BytesIO()
    canvas.draw()
    shown = figure.get_tightbbox(canvas.get_renderer())
    width, height = figure.get_size_inches()
    if shown.x0 < 0.0 or shown.y0 < 0.0 or shown.x1 > width or shown.y1 > height:
        figure.savefig(data, format="png", dpi=DPI, bbox_inches="tight", pad_inches=MARGIN)
        return data.getvalue()
    drawn = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    left, right = (round(DPI * x) for x in (shown.x0 - MARGIN, shown.x1 + MARGIN))
    upper, lower = (round(DPI * (height - y)) for y in (shown.y1 + MARGIN, shown.y0 - MARGIN))
    page = Image.new("RGB", (right - left, lower - upper), "white")
    page.paste(drawn, (-left, -upper))
    page.save(data, "PNG", dpi=(DPI, DPI))
    return data.getvalue()
