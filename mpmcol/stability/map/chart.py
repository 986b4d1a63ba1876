"""The chart of a map: a panel for each combination, in it a square for each run, by colour and by symbol."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from mpmcol.chart import save_figure
from mpmcol.stability.map.definition import Map
from mpmcol.stability.map.rows import Panel, panels_of
from mpmcol.stability.map.text import SYMBOLS, counted, legend
from mpmcol.stability.map.verdict import Judged

# Lightness falls from one verdict to the next, so that they are told apart without colours, too.
COLOURS = {"stands": "#a6d0ec", "degrades": "#f0a030", "fails": "#5b1a3a", "open": "#ffffff"}
INK = {"stands": "black", "degrades": "black", "fails": "white", "open": "black"}
CROSS = "\N{MULTIPLICATION SIGN}"
MARKS = {"stands": "", "fails": CROSS, "open": "?"}
SQUARE = 0.36  # inches
MARGINS = (1.1, 0.75)  # inches beside and below a panel
HEAD, FOOT = 0.7, 0.8


def map_chart(path: Path, map_: Map, judged: Sequence[Judged]) -> list[Path]:
    """Draw all panels, wrapped into rows; returns the files written."""
    panels = list(panels_of(judged))
    columns = min(map_.side_by_side, len(panels))
    lines = ceil(len(panels) / columns)
    width = columns * (SQUARE * max(len(panel.values_across) for panel in panels) + MARGINS[0])
    height = lines * (SQUARE * max(len(panel.rows) for panel in panels) + MARGINS[1]) + HEAD + FOOT
    figure = Figure(figsize=(max(width, 6.0), height), layout="constrained")
    grid = figure.subplots(lines, columns, squeeze=False)
    for i, axes in enumerate(grid.flat):
        if i < len(panels):
            before = panels[i - 1] if i % columns else None
            _draw_panel(axes, panels[i], before)
        else:
            axes.set_axis_off()
    figure.suptitle(f"{map_.title}\n{counted(judged)}", fontsize="medium")
    _draw_legend(figure, judged)
    return save_figure(figure, path, svg=False)


def _draw_panel(axes: Axes, panel: Panel, before: Panel | None) -> None:
    """Rows are named where the panel to the left has others."""
    for j, row in enumerate(panel.rows):
        for i, one in enumerate(row):
            _draw_square(axes, i, j, one)
    across, down = panel.values_across, panel.values_down
    shown = before is None or (before.values_down, before.down) != (down, panel.down)
    axes.set(xlim=(0, len(across)), ylim=(len(down), 0), aspect="equal")
    axes.set_xticks([i + 0.5 for i in range(len(across))], across, fontsize="small")
    axes.set_yticks([j + 0.5 for j in range(len(down))], down if shown else [], fontsize="small")
    axes.tick_params(length=0)
    axes.set_title(panel.title, fontsize="small")
    axes.set_xlabel(panel.across.rpartition(".")[2], fontsize="small", labelpad=1.0)
    axes.spines[:].set_visible(False)


def _draw_square(axes: Axes, i: int, j: int, one: Judged) -> None:
    name = one.verdict.name
    axes.add_patch(Rectangle((i, j), 1, 1, facecolor=COLOURS[name], edgecolor="white", linewidth=1.5))
    if one.place.is_default:
        frame: dict[str, Any] = {"fill": False, "edgecolor": "black", "linewidth": 1.5, "zorder": 3}
        axes.add_patch(Rectangle((i + 0.06, j + 0.06), 0.88, 0.88, **frame))
    mark = MARKS.get(name, "".join(SYMBOLS[sign] for sign in one.verdict.beyond[:2]))
    axes.text(i + 0.5, j + 0.52, mark, ha="center", va="center", fontsize=9, color=INK[name])


def _draw_legend(figure: Figure, judged: Sequence[Judged]) -> None:
    """Verdicts that occur, the frame of the default, and what the symbols mean."""
    names = [name for name in COLOURS if any(one.verdict.name == name for one in judged)]
    words = {"open": "not run ?", "fails": f"fails {CROSS}"}
    handles = [Patch(facecolor=COLOURS[name], edgecolor="0.5", label=words.get(name, name)) for name in names]
    handles.append(Patch(fill=False, edgecolor="black", label="default method"))
    symbols = f"degrades by (the two worst): {legend()}"
    half = symbols.index(", ", len(symbols) // 2) + 2
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize="small",
        title=f"{symbols[:half]}\n{symbols[half:]}", title_fontsize="small",
    )  # fmt: skip
