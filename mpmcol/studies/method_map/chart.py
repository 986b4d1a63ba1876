"""Chart of a map: a square for each point, whose colour and symbol show its rating."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from mpmcol.plotting.charts import save_figure
from mpmcol.studies.method_map.assessment import AssessedPoint
from mpmcol.studies.method_map.definition import MapDefinition
from mpmcol.studies.method_map.text import SYMBOLS, Panel, counts, legend, panels_of

# Lightness decreases from one rating to the next, so that they differ without colour as well.
COLOURS = {"passes": "#a6d0ec", "degrades": "#f0a030", "fails": "#5b1a3a", "not run": "#f2f2f2"}
INK = {"passes": "black", "degrades": "black", "fails": "white", "not run": "black"}
CROSS = "\N{MULTIPLICATION SIGN}"
MARKS = {"passes": "", "fails": CROSS, "not run": "?"}
SQUARE = 0.36  # inches, of a point
GAP, ABOVE, BELOW = 0.32, 0.32, 0.48  # inches beside, above and below a panel
LETTER = 0.08  # inches, width of a letter in the names of rows
HEAD, FOOT = 0.45, 0.95  # inches above and below all panels
MIN_WIDTH = 6.5  # inches

Frame = tuple[float, float, float, float]  # left, top, width, height


def map_chart(path: Path, definition: MapDefinition, assessed: Sequence[AssessedPoint]) -> list[Path]:
    """Draw all panels, wrapped into lines, with squares of equal size; return the files written."""
    panels = list(panels_of(assessed))
    wrap = min(definition.side_by_side, len(panels))
    frames = list(_frames(panels, wrap))
    width = max(max(left + w for left, _, w, _ in frames) + GAP, MIN_WIDTH)
    height = max(top + h for _, top, _, h in frames) + BELOW + FOOT
    figure = Figure(figsize=(width, height))
    for i, (panel, (left, top, w, h)) in enumerate(zip(panels, frames, strict=True)):
        axes = figure.add_axes((left / width, 1.0 - (top + h) / height, w / width, h / height))
        _draw_panel(axes, panel, _is_named(panels, i, wrap))
    figure.suptitle(f"{definition.title}\n{counts(assessed)}", y=1.0 - 0.1 / height, va="top", fontsize="medium")
    _draw_legend(figure, assessed)
    return save_figure(figure, path, svg=False)


def _frames(panels: Sequence[Panel], wrap: int) -> Iterator[Frame]:
    """Yield the frames of the panels, in inches from the left and upper edge, aligned in columns and lines."""
    columns = [range(column, len(panels), wrap) for column in range(wrap)]
    margins = [max(_margin(panels, i, wrap) for i in column) for column in columns]
    widths = [SQUARE * max(len(panels[i].values_across) for i in column) for column in columns]
    top = HEAD
    for first in range(0, len(panels), wrap):
        line = panels[first : first + wrap]
        top += ABOVE
        for i, panel in enumerate(line):
            left = sum(margins[: i + 1]) + sum(widths[:i])
            yield left, top, SQUARE * len(panel.values_across), SQUARE * len(panel.rows)
        top += SQUARE * max(len(panel.rows) for panel in line) + BELOW


def _is_named(panels: Sequence[Panel], i: int, wrap: int) -> bool:
    """Whether a panel names its rows, since the one to the left has different rows."""
    panel, before = panels[i], panels[i - 1]
    return i % wrap == 0 or (before.down, before.values_down) != (panel.down, panel.values_down)


def _margin(panels: Sequence[Panel], i: int, wrap: int) -> float:
    return GAP + LETTER * max(map(len, panels[i].values_down)) * _is_named(panels, i, wrap)


def _draw_panel(axes: Axes, panel: Panel, named: bool) -> None:
    for j, row in enumerate(panel.rows):
        for i, one in enumerate(row):
            _draw_square(axes, i, j, one)
    across, down = panel.values_across, panel.values_down
    axes.set(xlim=(0, len(across)), ylim=(len(down), 0))
    axes.set_xticks([i + 0.5 for i in range(len(across))], across, fontsize="small")
    axes.set_yticks([j + 0.5 for j in range(len(down))], down if named else [""] * len(down), fontsize="small")
    axes.tick_params(length=0)
    axes.set_title(panel.title, fontsize="small", pad=4.0)
    axes.set_xlabel(panel.across.rpartition(".")[2], fontsize="small", labelpad=1.0)
    axes.spines[:].set_visible(False)


def _draw_square(axes: Axes, i: int, j: int, one: AssessedPoint) -> None:
    rating = one.rating
    axes.add_patch(Rectangle((i, j), 1, 1, facecolor=COLOURS[rating], edgecolor="white", linewidth=1.5))
    if one.point.is_default:
        frame: dict[str, Any] = {"fill": False, "edgecolor": "black", "linewidth": 1.5, "zorder": 3}
        axes.add_patch(Rectangle((i + 0.06, j + 0.06), 0.88, 0.88, **frame))
    mark = MARKS.get(rating, "".join(SYMBOLS[metric] for metric in one.assessment.exceeded[:2]))
    axes.text(i + 0.5, j + 0.52, mark, ha="center", va="center", fontsize=9, color=INK[rating])


def _draw_legend(figure: Figure, assessed: Sequence[AssessedPoint]) -> None:
    """Explain the ratings that occur, the frame of the default method, and the symbols of the metrics."""
    ratings = [rating for rating in COLOURS if any(one.rating == rating for one in assessed)]
    labels = {"not run": "not run ?", "fails": f"fails {CROSS}"}
    handles = [
        Patch(facecolor=COLOURS[rating], edgecolor="0.5", label=labels.get(rating, rating)) for rating in ratings
    ]
    handles.append(Patch(fill=False, edgecolor="black", label="default method"))
    symbols = f"degrades by (two worst metrics): {legend()}"
    half = symbols.index(", ", len(symbols) // 2) + 2
    figure.legend(
        handles=handles, loc="lower center", ncols=len(handles), frameon=False, fontsize="small",
        title=f"{symbols[:half]}\n{symbols[half:]}", title_fontsize="small",
    )  # fmt: skip
