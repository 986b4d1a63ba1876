"""Chart of a case: error over core-seconds, one line for each scheme variant, the Pareto front, failures as crosses."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from math import ceil
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.experiments import Experiment
from mpmcol.plotting.figures import save_figure, use_plain_ticks
from mpmcol.plotting.styles import experiment_style
from mpmcol.studies.pareto.reference import ConvergedReference
from mpmcol.studies.pareto.score import ScoredConfiguration
from mpmcol.studies.pareto.selection import CRITERIA, pareto_front

TITLES = {"zeta.front_height": r"runout $\zeta$ (front_height)", "beta": r"height $\beta$", "profile": "profile, area"}
MARKERS = "osv^D<>pPX*h"
LEGEND_COLUMNS, LEGEND_LINE, OTHER_ENTRIES = 6, 0.25, 4  # line height in inches; entries that are not variants
PANEL = 5.5  # inches
SMALLEST = 1e-3  # smaller errors are drawn at this value


def case_chart(
    path: Path,
    title: str,
    scored: Sequence[ScoredConfiguration],
    reference: ConvergedReference,
    experiment: Experiment,
    baseline: str,
) -> list[Path]:
    """Draw one panel for each criterion; return the files written.

    Args:
        scored: configurations of the case.
        experiment: its scatter is the smallest error that a comparison with it can resolve.
        baseline: variant whose cost stands for that of failed configurations.
    """
    styles = _styles(list(dict.fromkeys(one.configuration.variant for one in scored)))
    height = PANEL + LEGEND_LINE * (ceil((len(styles) + OTHER_ENTRIES) / LEGEND_COLUMNS))
    figure = Figure(figsize=(13.0, height))
    figure.subplots_adjust(
        left=0.06, right=0.99, top=1.0 - 0.7 / height, bottom=1.0 - (PANEL - 0.6) / height, wspace=0.2
    )
    for axes, quantity in zip(figure.subplots(1, len(CRITERIA)), CRITERIA, strict=True):
        axes.set(xscale="log", yscale="log", xlabel="core-seconds of a run", title=TITLES[quantity])
        for variant, style in styles.items():
            own = [one for one in scored if one.configuration.variant == variant]
            _draw_variant(axes, own, quantity, variant, style)
        _draw_front(axes, scored, quantity)
        _draw_failures(axes, scored, baseline)
        _draw_floors(axes, quantity, reference, experiment)
        axes.grid(color="0.92")
        use_plain_ticks(axes.xaxis)
        use_plain_ticks(axes.yaxis)
    figure.axes[0].set_ylabel("relative error not exceeded by 90 % of runs")
    figure.suptitle(title)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=LEGEND_COLUMNS, frameon=False, fontsize="small")
    return save_figure(figure, path, svg=False)


def _styles(variants: Sequence[str]) -> dict[str, dict[str, Any]]:
    colours, markers = cycle(f"C{i}" for i in range(10)), cycle(MARKERS)
    return {variant: {"color": next(colours), "marker": next(markers)} for variant in variants}


def _draw_variant(
    axes: Axes, scored: Sequence[ScoredConfiguration], quantity: str, variant: str, style: dict[str, Any]
) -> None:
    shown = [one for one in scored if quantity in one.errors and one.is_complete]
    x = [one.cost["core_seconds"] for one in shown]
    y = [max(one.errors[quantity].p90, SMALLEST) for one in shown]
    axes.plot(x, y, linewidth=1.0, markersize=5.0, fillstyle="none", label=variant, **style)


def _draw_front(axes: Axes, scored: Sequence[ScoredConfiguration], quantity: str) -> None:
    front = pareto_front(scored, quantity)
    x, y = [bound.scored.cost["core_seconds"] for bound in front], [max(bound.error, SMALLEST) for bound in front]
    axes.step(x, y, where="post", color="0.75", linewidth=5.0, zorder=-1, label="Pareto front")


def _draw_failures(axes: Axes, scored: Sequence[ScoredConfiguration], baseline: str) -> None:
    """Draw crosses at the upper edge, at the cost of the baseline with as many cells."""
    costs = {
        one.configuration.cells: one.cost["core_seconds"]
        for one in scored
        if one.configuration.variant == baseline and one.runs
    }
    failed = [one for one in scored if one.failures and one.configuration.cells in costs]
    x = [costs[one.configuration.cells] for one in failed]
    mark: dict[str, Any] = {"color": "black", "marker": "x", "linestyle": "none", "clip_on": False}
    axes.plot(x, [1.0] * len(x), transform=axes.get_xaxis_transform(), label="failed (causes in the report)", **mark)


def _draw_floors(axes: Axes, quantity: str, reference: ConvergedReference, experiment: Experiment) -> None:
    """Draw the uncertainty of the reference and the scatter of the experiment."""
    axes.axhspan(
        SMALLEST, reference.uncertainty(quantity), color="0.9", zorder=-2, label="uncertainty of the reference"
    )
    law = experiment.law(quantity.partition(".")[0])
    if law and law.pieces:
        label = f"scatter of {experiment.label(law.quantity)}"
        axes.axhline(law.scatter, color=experiment_style(experiment).colour, linestyle="--", linewidth=1.2, label=label)
