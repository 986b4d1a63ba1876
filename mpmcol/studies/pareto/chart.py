"""The chart of a scene: usual error over core-seconds, one line per family, the front drawn, failures as crosses."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from math import ceil
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.experiments import Experiment
from mpmcol.plotting.charts import EXPERIMENT_COLOUR, save_figure
from mpmcol.studies.pareto.reference import Reference
from mpmcol.studies.pareto.score import Scored
from mpmcol.studies.pareto.selection import CHOSEN_BY, pareto_front

NAMES = {"zeta.front_height": r"runout $\zeta$ (front_height)", "beta": r"height $\beta$", "profile": "profile, area"}
MARKERS = "osv^D<>pPX*h"
COLUMNS, LINE, OTHERS = 6, 0.25, 4  # of the legend: a line's height in inches, and entries that are no families
PANEL = 5.5  # inches
LEAST = 1e-3  # errors below are drawn there


def scene_chart(
    path: Path, title: str, scored: Sequence[Scored], reference: Reference, experiment: Experiment, base: str
) -> list[Path]:
    """Draw one panel for each quantity that settings are chosen by; returns the files written.

    Args:
        base: family whose cost stands for that of settings that failed.
        experiment: its scatter is the error that no comparison with it can go below.
    """
    styles = _styles(list(dict.fromkeys(one.setting.family for one in scored)))
    height = PANEL + LINE * (ceil((len(styles) + OTHERS) / COLUMNS))
    figure = Figure(figsize=(13.0, height))
    figure.subplots_adjust(
        left=0.06, right=0.99, top=1.0 - 0.7 / height, bottom=1.0 - (PANEL - 0.6) / height, wspace=0.2
    )
    for axes, quantity in zip(figure.subplots(1, len(CHOSEN_BY)), CHOSEN_BY, strict=True):
        axes.set(xscale="log", yscale="log", xlabel="core-seconds of a run", title=NAMES[quantity])
        for family, style in styles.items():
            _draw_family(axes, [one for one in scored if one.setting.family == family], quantity, family, style)
        _draw_front(axes, scored, quantity)
        _draw_failures(axes, scored, base)
        _draw_floors(axes, quantity, reference, experiment)
        axes.grid(color="0.92", which="both")
    figure.axes[0].set_ylabel("relative error that nine of ten runs keep within")
    figure.suptitle(title)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=COLUMNS, frameon=False, fontsize="small")
    return save_figure(figure, path, svg=False)


def _styles(families: Sequence[str]) -> dict[str, dict[str, Any]]:
    colours, markers = cycle(f"C{i}" for i in range(10)), cycle(MARKERS)
    return {family: {"color": next(colours), "marker": next(markers)} for family in families}


def _draw_family(axes: Axes, scored: Sequence[Scored], quantity: str, family: str, style: dict[str, Any]) -> None:
    shown = [one for one in scored if quantity in one.errors and one.is_complete]
    x = [one.cost["core_seconds"] for one in shown]
    y = [max(one.errors[quantity].usual, LEAST) for one in shown]
    axes.plot(x, y, linewidth=1.0, markersize=5.0, fillstyle="none", label=family, **style)


def _draw_front(axes: Axes, scored: Sequence[Scored], quantity: str) -> None:
    front = pareto_front(scored, quantity)
    x, y = [kept.one.cost["core_seconds"] for kept in front], [max(kept.error, LEAST) for kept in front]
    axes.step(x, y, where="post", color="0.75", linewidth=5.0, zorder=-1, label="not beaten in cost and error")


def _draw_failures(axes: Axes, scored: Sequence[Scored], base: str) -> None:
    """Crosses at the upper edge, at the cost of the base family with as many cells."""
    costs = {one.setting.cells: one.cost["core_seconds"] for one in scored if one.setting.family == base and one.runs}
    x = [costs[one.setting.cells] for one in scored if one.failures and one.setting.cells in costs]
    mark: dict[str, Any] = {"color": "black", "marker": "x", "linestyle": "none", "clip_on": False}
    axes.plot(x, [1.0] * len(x), transform=axes.get_xaxis_transform(), label="failed (causes in the table)", **mark)


def _draw_floors(axes: Axes, quantity: str, reference: Reference, experiment: Experiment) -> None:
    """What is not known of the reference, and the scatter of the experiment."""
    axes.axhspan(LEAST, reference.uncertainty(quantity), color="0.9", zorder=-2, label="uncertainty of the reference")
    law = experiment.law(quantity.partition(".")[0])
    if law and law.pieces:
        dashed: dict[str, Any] = {"color": EXPERIMENT_COLOUR, "linestyle": "--", "linewidth": 1.2}
        axes.axhline(law.scatter, label="scatter of experiments", **dashed)
