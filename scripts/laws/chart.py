"""Chart of the study of laws: runout, height and stop time over their values in the experiments."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt

from mpmcol.plotting.styles import RUN_COLOURS, RUN_LINES
from scripts.laws.study import QUANTITIES, Quantity, Study
from scripts.laws.tables import Row


def draw(study: Study, rows: Sequence[Row], file: Path) -> None:
    """A row of panels for each quantity, a column for each kind of column; each law over its own experiment."""
    columns = [column for column in study.columns if any(row.column == column for row in rows)]
    size = (4.8 * len(columns), 9.0)
    figure, panels = plt.subplots(
        3, len(columns), figsize=size, sharex=True, sharey="row", squeeze=False, layout="constrained"
    )
    for of_quantity, quantity in zip(panels, QUANTITIES, strict=True):
        for axes, column in zip(of_quantity, columns, strict=True):
            draw_panel(axes, study, [row for row in rows if row.column == column], quantity)
        of_quantity[0].set_ylabel(f"{QUANTITIES[quantity]} / experiment")
    for column, top, bottom in zip(columns, panels[0], panels[-1], strict=True):
        top.set_title(column)
        bottom.set(xscale="log", xlabel="aspect ratio $a$", xticks=(0.5, 1, 2, 5, 10), xticklabels=(0.5, 1, 2, 5, 10))
        bottom.minorticks_off()
    lines = {line.get_label(): line for axes in panels.flat for line in axes.get_lines()}
    figure.legend(lines.values(), lines.keys(), loc="outside lower center", ncols=3)
    figure.savefig(file, dpi=150)
    plt.close(figure)


def draw_panel(axes: Any, study: Study, rows: Sequence[Row], quantity: Quantity) -> None:
    """One quantity in one kind of column, and the scatter of the experiment; gaps where there is no published value."""
    for k, (name, law) in enumerate(study.laws.items()):
        own = [(row, study.expected(row.column, name, quantity, row.a)) for row in rows if row.law == name]
        found = [(row.a, getattr(row, quantity) / expected[0], expected[1]) for row, expected in own if expected]
        if found:
            a, ratios, scatter = zip(*found, strict=True)
            axes.plot(
                a, ratios, marker="o", markersize=4.0, color=RUN_COLOURS[k], linestyle=RUN_LINES[k], label=law.title
            )
            axes.axhspan(1.0 - scatter[0], 1.0 + scatter[0], color="0.92", zorder=0)
