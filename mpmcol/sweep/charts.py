"""Charts of a sweep: runout and height over the aspect ratio or another varied key, beside experiments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from mpmcol.experiments import EXPERIMENTS, Experiment, Law
from mpmcol.measure import FRONTS
from mpmcol.plotting.charts import EXPERIMENT_COLOUR, FRONT_STYLES, save_figure
from mpmcol.sweep.fits import Slope
from mpmcol.sweep.series import ASPECT_COLUMN, Series
from mpmcol.sweep.table import unit_of

ASPECT_LABEL = r"aspect ratio $a = h_i/r_i$ (-)"
LABELS = {"zeta": r"runout $\zeta = (r_f - r_i)/r_i$ (-)", "beta": r"final height $\beta = h_f/h_i$ (-)"}
COLOURS = ("black", "#2166ac", "#1b7837", "#762a83", "#b35806", "#01665e")
DASHES: tuple[Any, ...] = ("--", "-.", (0, (1, 1)), (0, (8, 3)))
LAW_COLOURS = ("0.5", "#8073ac", "#5aae61", "#e08214", "#4393c3")  # with DASHES, twenty distinct styles
MARGIN = 1.15  # factor by which a logarithmic axis extends beyond the data
_CURVE = 100


def sweep_chart(
    path: Path,
    quantity: str,
    axis: str,
    series: Sequence[Series],
    experiment: Experiment,
    *,
    slopes: Sequence[Slope] = (),
    title: str = "",
    svg: bool = False,
) -> list[Path]:
    """Draw "zeta" or "beta" over `axis`; return the paths written.

    Args:
        path: PNG to write; with `svg`, an SVG is written beside it.
        axis: a column of the rows: "a", or a key of the case. Text values get equidistant ticks.
        series: rows that are not at rest are drawn in grey. A single series shows each definition of the front,
            several series show front_connected with a bar over the three definitions.
        experiment: drawn with its scatter; laws of other experiments on this kind of column are thin lines.
        slopes: fitted lines.
    """
    figure = Figure(figsize=(7.0, 6.6), layout="constrained")
    axes = figure.subplots()
    values = [row[axis] for line in series for row in line.rows]
    if axis == ASPECT_COLUMN:
        _frame_aspect(axes, values)
        _draw_laws(axes, quantity, experiment, min(values) / MARGIN, max(values) * MARGIN)
    else:
        _frame_other(axes, axis, values)
        _draw_bands(axes, quantity, experiment, {row["a"] for line in series for row in line.rows})
    ticks = {value: i for i, value in enumerate(dict.fromkeys(values))} if _are_text(values) else {}
    for line, colour in zip(series, COLOURS * len(series), strict=False):
        _draw_series(axes, quantity, axis, line, colour=colour, ticks=ticks, is_single=len(series) == 1)
    for slope in slopes:
        _draw_slope(axes, slope, series)
    axes.set(ylabel=LABELS[quantity], title=title)
    axes.grid(color="0.9", which="major")
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize="small")
    return save_figure(figure, path, svg)


def _are_text(values: Sequence[Any]) -> bool:
    return any(isinstance(value, (str, bool)) for value in values)


def _frame_aspect(axes: Axes, values: Sequence[float]) -> None:
    """Logarithmic axes with plain tick labels."""
    axes.set(xscale="log", yscale="log", xlim=(min(values) / MARGIN, max(values) * MARGIN), xlabel=ASPECT_LABEL)
    for one in (axes.xaxis, axes.yaxis):
        one.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0, 7.0)))
        one.set_major_formatter(StrMethodFormatter("{x:g}"))
        one.set_minor_formatter(NullFormatter())


def _frame_other(axes: Axes, axis: str, values: Sequence[Any]) -> None:
    unit = unit_of(axis)
    axes.set(xlabel=axis if unit == "1" else f"{axis} ({unit})")
    if _are_text(values):
        texts = list(dict.fromkeys(map(str, values)))
        axes.set_xticks(range(len(texts)), texts)


def _draw_laws(axes: Axes, quantity: str, experiment: Experiment, low: float, high: float) -> None:
    """The experiment with its scatter and the gaps between the pieces of its law; then all other laws."""
    law = experiment.law(quantity)
    if law and law.pieces:
        bold: dict[str, Any] = {"color": EXPERIMENT_COLOUR, "linewidth": 1.6}
        label = f"{experiment.label(quantity)}, scatter {law.scatter:.0%}"
        for i, (a, value) in enumerate(_curves(law, low, high)):
            axes.plot(a, value, label=label if i == 0 else None, **bold)
            scatter = law.scatter * value
            axes.fill_between(a, value - scatter, value + scatter, color=EXPERIMENT_COLOUR, alpha=0.15, linewidth=0)
        for i, (left, right) in enumerate((one.hi, two.lo) for one, two in pairwise(law.pieces) if one.hi < two.lo):
            label = f"{experiment.label(quantity)}: transition, no law"
            axes.axvspan(left, right, color="0.93", zorder=-2, label=label if i == 0 else None)
    others = _others(quantity, experiment, law)
    for k, (name, other) in enumerate(others.items()):
        style: dict[str, Any] = {"color": LAW_COLOURS[k % len(LAW_COLOURS)], "linestyle": DASHES[k % len(DASHES)]}
        for i, (a, value) in enumerate(_curves(other, low, high)):
            axes.plot(a, value, linewidth=0.9, label=name if i == 0 else None, **style)


def _others(quantity: str, experiment: Experiment, law: Law | None) -> dict[str, Law]:
    """All other laws for this kind of column, each once, under the first experiment that has it."""
    found: dict[Law, str] = {}
    for other in EXPERIMENTS.values():
        own = other.law(quantity) if other.model == experiment.model else None
        if own and own != law:
            found.setdefault(own, other.label(quantity))
    return {name: own for own, name in found.items()}


def _curves(law: Law, low: float, high: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Each piece of a law between two aspect ratios: a (n,) and value (n,)."""
    inside = [piece for piece in law.pieces if piece.lo < high and piece.hi > low]
    aspects = [np.geomspace(max(piece.lo, low), min(piece.hi, high), _CURVE) for piece in inside]
    return [(a, piece.prefactor * a**piece.exponent) for a, piece in zip(aspects, inside, strict=True)]


def _draw_bands(axes: Axes, quantity: str, experiment: Experiment, aspects: set[float]) -> None:
    """The experiment's value for each aspect ratio, as a horizontal line with its scatter."""
    for a in sorted(aspects):
        if expected := experiment.expected(quantity, a):
            value, half = expected
            axes.axhspan(value - half, value + half, color=EXPERIMENT_COLOUR, alpha=0.15, linewidth=0)
            label = f"{experiment.label(quantity)}, a = {a:.4g}, scatter"
            axes.axhline(value, color=EXPERIMENT_COLOUR, linewidth=1.2, label=label)


def _draw_series(
    axes: Axes, quantity: str, axis: str, line: Series, *, colour: str, ticks: Mapping[Any, int], is_single: bool
) -> None:
    """Markers of a series, grey for runs that are not at rest."""
    for at_rest, paint in ((True, colour), (False, "0.65")):
        rows = [row for row in line.rows if bool(row["at_rest"]) is at_rest]
        if not rows:
            continue
        x = [ticks.get(row[axis], row[axis]) for row in rows]
        suffix = "" if at_rest else " (not at rest)"
        mark: dict[str, Any] = {"color": paint, "linestyle": "none", "fillstyle": "none"}
        if quantity == "beta":
            axes.plot(x, [row["beta"] for row in rows], marker="o", label=f"{line.label or 'beta'}{suffix}", **mark)
        elif is_single:
            for front in FRONTS:
                y = [row[f"zeta.{front}"] for row in rows]
                axes.plot(x, y, marker=FRONT_STYLES[front]["marker"], label=f"{front}{suffix}", **mark)
        else:
            zeta = np.array([[row[f"zeta.{front}"] for front in FRONTS] for row in rows])
            middle = zeta[:, FRONTS.index("front_connected")]
            bars = np.abs(np.array([zeta.min(axis=1), zeta.max(axis=1)]) - middle)
            axes.errorbar(x, middle, yerr=bars, marker="s", capsize=3, label=f"{line.label}{suffix}", **mark)


def _draw_slope(axes: Axes, slope: Slope, series: Sequence[Series]) -> None:
    """A fitted line over the range of the data that it was fitted to."""
    index = next(i for i, line in enumerate(series) if line.label == slope.series)
    inside = [row["a"] for row in series[index].rows if row["at_rest"] and slope.lo <= row["a"] < slope.hi]
    a = np.geomspace(min(inside), max(inside), 2)
    colour = COLOURS[index % len(COLOURS)]
    dashes = FRONT_STYLES.get(slope.front, {}).get("linestyle", "-")
    name = ", ".join(filter(None, (slope.series, slope.front)))
    label = f"{name}: {_formula(slope)}" if name else _formula(slope)
    axes.plot(a, slope.prefactor * a**slope.exponent, color=colour, linewidth=0.9, linestyle=dashes, label=label)


def _formula(slope: Slope) -> str:
    width = "" if slope.half_width is None else rf" \pm {slope.half_width:.2f}"
    law = "" if slope.law_exponent is None else rf" (law $a^{{{slope.law_exponent:.2f}}}$)"
    return rf"$\{slope.quantity.partition('.')[0]} \propto a^{{{slope.exponent:.2f}{width}}}$" + law
