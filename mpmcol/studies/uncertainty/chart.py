"""Chart of an uncertainty study: a histogram of each quantity, and bars with the shares of its variance."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator, PercentFormatter

from mpmcol.plotting.captions import common_heading
from mpmcol.plotting.figures import LABEL_SIZE, MOST_ENTRIES, legend_below, lines_below_title, save_figure
from mpmcol.plotting.styles import RUN_COLOURS
from mpmcol.setup.column_shape import column_shape
from mpmcol.studies.uncertainty.analysis import FRONT, Analysis, Passing, Quantity
from mpmcol.studies.uncertainty.record import label
from mpmcol.studies.uncertainty.statistics import differ
from mpmcol.sweep.names import short_names

LABELS = {
    "zeta.front_height": r"runout $\zeta$ (front_height)",
    FRONT: "front from wall or axis (m)",
    "beta": r"height $\beta$",
    "repose_angle_deg": r"angle of repose ($\degree$)",
}
MOST_PANELS = 8
PANELS_PER_ROW = 4
HATCHES = ("", "//", "\\\\", "..", "xx", "++", "oo")
SCATTER: dict[str, Any] = {"color": "0.85", "edgecolor": "0.5", "hatch": "----", "linewidth": 0.5}
EDGES: dict[str, Any] = {"edgecolor": "0.25", "linewidth": 0.5}
INTERACTIONS: dict[str, Any] = EDGES | {"color": "0.55"}
INTERVAL: dict[str, Any] = {"color": RUN_COLOURS[2], "alpha": 0.35, "linewidth": 0.0}
MEDIAN: dict[str, Any] = {"color": "black", "linewidth": 1.6}
TAILS: dict[str, Any] = {"color": "black", "linewidth": 1.0, "linestyle": (0, (4, 2))}
MOST_INPUTS = 3  # in the heading
NOTED = 0.07  # share from which a bar has its number


def uncertainty_chart(path: Path, analysis: Analysis) -> list[Path]:
    """Draw the chart of at least one quantity; return the files written.

    Of more than MOST_PANELS quantities the first ones are drawn.
    """
    shown = analysis.quantities[:MOST_PANELS]
    columns = min(len(shown), PANELS_PER_ROW)
    rows = -(-len(shown) // columns)
    split = [one for one in shown if one.shares and one.shares.is_given]
    heights = [2.7 * rows, *([0.9 + 0.45 * len(split)] if split else [])]
    figure = Figure(figsize=(3.1 * columns + 1.0, 0.5 + sum(heights)), layout="constrained")
    upper, *lower = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False).flat
    panels = np.ravel(upper.subplots(rows, columns, squeeze=False))
    for axes, one in zip(panels, shown, strict=False):
        _draw_histogram(axes, one, analysis.passes if one.name == FRONT else ())
    for axes in panels[len(shown) :]:
        axes.set_axis_off()
    for axes in panels[::columns]:
        axes.set_ylabel("runs")
    handles = _statistics_handles()
    for part in lower:
        handles |= _draw_shares(part.subplots(), split, analysis)
    legend_below(figure, list(handles.values()), list(handles), columns=3)
    plan = analysis.plan
    heading = common_heading(
        plan.means.title, [(run.case, column_shape(run.case, run.discretization)) for run in plan.runs]
    )
    figure.suptitle(f"{heading.title}: {analysis.done} runs", parse_math=False)
    inputs = [f"{one.key} = {one.distribution}" for one in plan.inputs[:MOST_INPUTS]]
    more = [f"{len(plan.inputs) - MOST_INPUTS} more"] if len(plan.inputs) > MOST_INPUTS else []
    sample = heading._replace(note="; ".join([*inputs, *more, *plan.remarks]))
    upper.suptitle("\n".join(lines_below_title(figure, sample)), fontsize=LABEL_SIZE, color="0.3")
    return save_figure(figure, path, svg=False)


def _draw_histogram(axes: Axes, one: Quantity, passes: Sequence[Passing]) -> None:
    """Counts of runs, with the median and its interval, and the quantiles 5 and 95 %."""
    axes.hist(one.values, bins="auto" if differ(one.values) else 1, color="0.8", edgecolor="0.4", linewidth=0.6)
    statistics = one.statistics
    if statistics.median_interval:
        axes.axvspan(*statistics.median_interval, **INTERVAL)
    axes.axvline(statistics.quantiles["median"], **MEDIAN)
    for name in ("p5", "p95"):
        axes.axvline(statistics.quantiles[name], **TAILS)
    _draw_passes(axes, passes)
    axes.set_xlabel(LABELS.get(one.name, label(one)))
    text = f"mean {statistics.mean:.4g}, standard deviation {statistics.standard_deviation:.2g}"
    axes.set_title(text, fontsize=LABEL_SIZE)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.yaxis.set_major_locator(MaxNLocator(4, integer=True))


def _draw_passes(axes: Axes, passes: Sequence[Passing]) -> None:
    """A line with the probability at each distance; beside a line far away the histogram would be narrow."""
    low, high = axes.get_xlim()
    style: dict[str, Any] = {"fontsize": LABEL_SIZE, "color": RUN_COLOURS[6], "va": "top"}
    far = []
    for passing in passes:
        distance, probability = passing.distance, f"P = {passing.probability.value:.2g}"
        is_right = distance > 0.5 * (low + high)
        if not low - (high - low) < distance < high + (high - low):
            far.append(f"{probability} at {distance:g} m")
            continue
        axes.axvline(distance, color=RUN_COLOURS[6], linewidth=1.6, linestyle=":")
        position, side = (distance, 0.97), "right" if is_right else "left"
        axes.annotate(f" {probability} ", position, xycoords=("data", "axes fraction"), ha=side, **style)
    axes.annotate("\n".join(far), (0.98, 0.87), xycoords="axes fraction", ha="right", **style)


def _statistics_handles() -> dict[str, Any]:
    """Handles of the legend for the lines of the histograms."""
    return {
        "median, with its 90 % interval": (Patch(**INTERVAL), Line2D([], [], **MEDIAN)),
        "quantiles 5 and 95 %": Line2D([], [], **TAILS),
    }


def _draw_shares(axes: Axes, shown: Sequence[Quantity], analysis: Analysis) -> dict[str, Any]:
    """A stacked bar for each quantity; returns the handles of the legend by their labels."""
    names = short_names(one.key for one in analysis.plan.inputs)
    positions = np.arange(len(shown))[::-1]
    ends = np.zeros(len(shown))
    handles: dict[str, Any] = {}
    for text, shares, style in _layers(shown, names, analysis.plan.residual):
        bars = axes.barh(positions, shares, left=ends, height=0.62, **style)
        texts = [f"{share:.0%}" if share >= NOTED else "" for share in shares]
        background: dict[str, Any] = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
        axes.bar_label(bars, texts, label_type="center", fontsize=LABEL_SIZE, bbox=background)
        for note, share in zip(axes.texts[-len(shown) :], shares, strict=True):
            note.set_visible(bool(share >= NOTED))
        handles[text] = bars
        ends += shares
    axes.set_yticks(positions, [bar_label(one) for one in shown])
    axes.set(xlim=(0.0, max(1.0, float(ends.max(initial=0.0)))), xlabel="share of the variance of the sample")
    axes.xaxis.set_major_formatter(PercentFormatter(1.0))
    axes.spines[["top", "right"]].set_visible(False)
    return handles


def bar_label(one: Quantity) -> str:
    """Name of a quantity, with a remark if its shares are not reliable."""
    remark = "\n(not reliable)" if one.shares and one.shares.note else ""
    return LABELS.get(one.name, label(one)) + remark


def _layers(
    shown: Sequence[Quantity], names: dict[str, str], rest_name: str
) -> list[tuple[str, np.ndarray, dict[str, Any]]]:
    """Legend text, share of each quantity, and style of the parts of the bars; the last is the residual.

    Inputs beyond those that a legend can hold are one part.
    """
    shares = [one.shares for one in shown if one.shares]
    first = {key: np.array([one.first_order[key] for one in shares]) for key in names}
    residual = np.array([one.residual for one in shares])
    interactions = np.clip(1.0 - residual - sum(first.values()), 0.0, None)
    own = list(first)[: MOST_ENTRIES - 3] if len(first) > MOST_ENTRIES - 2 else list(first)
    layers = [
        (names[key], first[key], EDGES | {"color": RUN_COLOURS[1 + i], "hatch": HATCHES[i]})
        for i, key in enumerate(own)
    ]
    if rest := [first[key] for key in first if key not in own]:
        layers.append(("other inputs", np.sum(rest, axis=0), EDGES | {"color": "0.7"}))
    if len(names) > 1:
        layers.append(("interactions", interactions, INTERACTIONS))
    return [*layers, (rest_name, residual, SCATTER)]
