"""Chart of a case: error over core-seconds, one line for each scheme variant, the Pareto front, failures as crosses.

Variants beyond those that a legend can hold are grey points; the table of the study names them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.experiments import Experiment
from mpmcol.plotting.figures import HALO, MOST_ENTRIES, save_figure, use_plain_ticks
from mpmcol.plotting.styles import experiment_style
from mpmcol.studies.pareto.reference import ConvergedReference
from mpmcol.studies.pareto.score import ScoredConfiguration
from mpmcol.studies.pareto.selection import CRITERIA, pareto_front

TITLES = {"zeta.front_height": r"runout $\zeta$ (front_height)", "beta": r"height $\beta$", "profile": "profile, area"}
MARKERS, COLOURS = "osv^D>P", 10
OTHER_STYLE: dict[str, Any] = {"color": "0.6", "marker": ".", "linestyle": "none"}
SMALLEST = 1e-3  # smaller errors are drawn at this value
NOTE: dict[str, Any] = {"fontsize": "x-small", "color": "0.3"}


def case_chart(
    path: Path,
    title: str,
    scored: Sequence[ScoredConfiguration],
    reference: ConvergedReference,
    experiment: Experiment,
    baseline: str,
    variants: Sequence[str],
) -> list[Path]:
    """Draw one panel for each criterion; return the files written.

    Args:
        scored: configurations of the case.
        experiment: its scatter is the smallest error that a comparison with it can resolve.
        baseline: variant whose cost stands for that of failed configurations.
        variants: all of the study; colour and marker of one are the same in all its charts.
    """
    failed = _failures(scored, baseline)
    named = _named_variants(scored, baseline, MOST_ENTRIES - 2 - bool(failed))  # beside the front and other variants
    figure = Figure(figsize=(13.0, 5.6))
    figure.subplots_adjust(left=0.06, right=0.99, top=0.87, bottom=0.22, wspace=0.2)
    for axes, quantity in zip(figure.subplots(1, len(CRITERIA)), CRITERIA, strict=True):
        axes.set(xscale="log", yscale="log", xlabel="core-seconds of a run", title=TITLES[quantity])
        for variant in named:
            own = [one for one in scored if one.configuration.variant == variant]
            number = variants.index(variant)
            marker = MARKERS[number % len(MARKERS)]
            _draw(axes, own, quantity, label=variant, color=f"C{number % COLOURS}", marker=marker)
        others = [one for one in scored if one.configuration.variant not in named]
        if others:
            _draw(axes, others, quantity, label="other choices (see the table)", **OTHER_STYLE)
        _draw_front(axes, scored, quantity)
        if failed:
            _draw_failures(axes, failed)
        _draw_floors(axes, quantity, reference, experiment)
        axes.grid(color="0.92")
        use_plain_ticks(axes.xaxis)
        use_plain_ticks(axes.yaxis)
    figure.axes[0].set_ylabel("relative error not exceeded by 90 % of runs")
    figure.suptitle(title)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=4, frameon=False, fontsize="small")
    return save_figure(figure, path, svg=False)


def _named_variants(scored: Sequence[ScoredConfiguration], baseline: str, most: int) -> list[str]:
    """The baseline and the variants that are most often on the Pareto fronts, in the order of the study."""
    variants = list(dict.fromkeys(one.configuration.variant for one in scored))
    if len(variants) <= most + 1:  # a group of one is no shorter
        return variants
    optimal = Counter(
        bound.scored.configuration.variant for quantity in CRITERIA for bound in pareto_front(scored, quantity)
    )
    preferred = sorted(variants, key=lambda variant: (variant != baseline, -optimal[variant]))[:most]
    return [variant for variant in variants if variant in preferred]


def _draw(axes: Axes, scored: Sequence[ScoredConfiguration], quantity: str, **style: Any) -> None:
    shown = [one for one in scored if quantity in one.errors and one.is_complete]
    x = [one.cost["core_seconds"] for one in shown]
    y = [max(one.errors[quantity].p90, SMALLEST) for one in shown]
    axes.plot(x, y, linewidth=1.0, markersize=5.0, fillstyle="none", **style)


def _draw_front(axes: Axes, scored: Sequence[ScoredConfiguration], quantity: str) -> None:
    front = pareto_front(scored, quantity)
    x, y = [bound.scored.cost["core_seconds"] for bound in front], [max(bound.error, SMALLEST) for bound in front]
    axes.step(x, y, where="post", color="0.75", linewidth=5.0, zorder=-1, label="Pareto front")


def _failures(scored: Sequence[ScoredConfiguration], baseline: str) -> list[float]:
    """Core-seconds of the baseline at the spacings of failed configurations, whose own cost is not known."""
    costs = {
        one.configuration.cells: one.cost["core_seconds"]
        for one in scored
        if one.configuration.variant == baseline and one.runs
    }
    return [costs[one.configuration.cells] for one in scored if one.failures and one.configuration.cells in costs]


def _draw_failures(axes: Axes, costs: Sequence[float]) -> None:
    """Draw crosses at the upper edge."""
    mark: dict[str, Any] = {"color": "black", "marker": "x", "linestyle": "none", "clip_on": False}
    axes.plot(costs, [1.0] * len(costs), transform=axes.get_xaxis_transform(), label="failed (see the report)", **mark)


def _draw_floors(axes: Axes, quantity: str, reference: ConvergedReference, experiment: Experiment) -> None:
    """Draw the uncertainty of the reference and the scatter of the experiment, with their names."""
    axes.axhspan(SMALLEST, reference.uncertainty(quantity), color="0.9", zorder=-2)
    axes.annotate("uncertainty of the grid-converged value", (0.02, 0.06), xycoords="axes fraction", **NOTE)
    law = experiment.law(quantity.partition(".")[0])
    if law and law.pieces:
        colour = experiment_style(experiment).colour
        axes.axhline(law.scatter, color=colour, linestyle="--", linewidth=1.2)
        text = f"scatter of {experiment.label(law.quantity)}"
        place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "bottom"}
        axes.annotate(text, (0.98, law.scatter), path_effects=[HALO], **place, **NOTE | {"color": colour})
