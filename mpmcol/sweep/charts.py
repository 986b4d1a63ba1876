"""Charts of a sweep: runout and height over the aspect ratio or another varied key, beside experiments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.experiments import Experiment, Law
from mpmcol.measure import FRONTS
from mpmcol.plotting.figures import (
    MOST_ENTRIES,
    EndLabel,
    Heading,
    add_heading,
    label_ends,
    legend_below,
    save_figure,
    use_plain_ticks,
)
from mpmcol.plotting.styles import FRONT_STYLES, RUN_COLOURS, TIME_COLOURS, experiment_style
from mpmcol.sweep.fits import Slope
from mpmcol.sweep.series import ASPECT_COLUMN, Series
from mpmcol.sweep.table import FINER_GRIDS, unit_of

ASPECT_LABEL = r"aspect ratio $a = h_i/r_i$ (-)"
LABELS = {"zeta": r"runout $\zeta = (r_f - r_i)/r_i$ (-)", "beta": r"final height $\beta = h_f/h_i$ (-)"}
OF_MANY = "\nby front_connected; bars: by all three definitions"
SERIES_MARKERS = "os^Dv<>"
MOST_SERIES = MOST_ENTRIES - 3  # with legend entries; more series are labelled at their last marker
MIDDLE = "front_connected"  # drawn where there are several series, with a bar over all definitions
NOT_AT_REST = "not at rest"
FINER_COLOUR = "tab:blue"
FINER_STYLE: dict[str, Any] = {"linestyle": "none", "color": FINER_COLOUR, "capsize": 4, "zorder": 1}
MARGIN = 1.15  # factor by which a logarithmic axis extends beyond the data
_CURVE = 100


def sweep_chart(
    path: Path,
    quantity: str,
    axis: str,
    series: Sequence[Series],
    experiment: Experiment,
    *,
    heading: Heading,
    others: Sequence[Experiment] = (),
    slopes: Sequence[Slope] = (),
) -> list[Path]:
    """Draw "zeta" or "beta" over `axis`; return the paths written.

    Args:
        path: PNG to write.
        axis: a column of the rows: "a", or a key of the case. Text values get equidistant ticks.
        series: rows that are not at rest are drawn in grey. A single series shows each definition of the front,
            several series show front_connected with a bar over the three definitions.
        experiment: drawn with its scatter.
        others: experiments whose laws are thin lines.
        heading: title and caption.
        slopes: fitted lines; their formulas are in the legend entries of the markers.
    """
    figure = Figure(figsize=(8.0, 6.4), layout="constrained")
    axes = figure.subplots()
    values = [row[axis] for line in series for row in line.rows]
    if axis == ASPECT_COLUMN:
        axes.set(xscale="log", yscale="log", xlim=(min(values) / MARGIN, max(values) * MARGIN), xlabel=ASPECT_LABEL)
        ends = _draw_laws(axes, quantity, experiment, others, min(values) / MARGIN, max(values) * MARGIN)
    else:
        _frame_other(axes, axis, values)
        ends = []
    ticks = {value: i for i, value in enumerate(dict.fromkeys(values))} if _are_text(values) else {}
    for i, line in enumerate(series):
        end = _draw_series(axes, quantity, axis, line, style=_series_style(i, len(series)), ticks=ticks)
        ends += end if len(series) > MOST_SERIES else []
    if axis != ASPECT_COLUMN:
        ends += _draw_bands(axes, quantity, experiment, {row["a"] for line in series for row in line.rows})
    for slope in slopes:
        _draw_slope(axes, slope, series)
    axes.set(ylabel=LABELS[quantity] + (OF_MANY if quantity == "zeta" and any(line.label for line in series) else ""))
    add_heading(axes, heading)
    axes.grid(color="0.9", which="major")
    if axis == ASPECT_COLUMN:
        use_plain_ticks(axes.xaxis)
        use_plain_ticks(axes.yaxis)
    _add_legend(figure, axes, series, slopes, ends)
    label_ends({axes: ends})
    return save_figure(figure, path, svg=False)


def _are_text(values: Sequence[Any]) -> bool:
    return any(isinstance(value, (str, bool)) for value in values)


def _frame_other(axes: Axes, axis: str, values: Sequence[Any]) -> None:
    unit = unit_of(axis)
    axes.set(xlabel=axis if unit == "1" else f"{axis} ({unit})")
    if _are_text(values):
        texts = list(dict.fromkeys(map(str, values)))
        axes.set_xticks(range(len(texts)), texts)


def _draw_laws(
    axes: Axes, quantity: str, experiment: Experiment, others: Sequence[Experiment], low: float, high: float
) -> list[EndLabel]:
    """The experiment with its scatter and the gaps between the pieces of its law; then all other laws, named at their
    ends."""
    law, style = experiment.law(quantity), experiment_style(experiment)
    if law and law.pieces:
        bold: dict[str, Any] = {"color": style.colour, "linestyle": style.line, "linewidth": 1.8}
        label = f"{experiment.label(quantity)}, scatter {law.scatter:.0%}"
        for a, value in _curves(law, low, high):
            axes.plot(a, value, label=label, **bold)
            scatter = law.scatter * value
            axes.fill_between(a, value - scatter, value + scatter, color=style.colour, alpha=0.13, linewidth=0)
        gaps = ((one.hi, two.lo) for one, two in pairwise(law.pieces))
        for left, right in ((left, right) for left, right in gaps if max(left, low) < min(right, high)):
            label = f"{experiment.label(quantity)}: transition, no law"
            axes.axvspan(left, right, color="0.93", zorder=-2, label=label)
    ends = []
    for other in others:
        own = other.law(quantity)
        if own is None or not own.pieces or own == law:
            continue
        style, name = experiment_style(other), other.label(quantity)
        line: dict[str, Any] = {"linewidth": 0.9, "color": style.colour, "linestyle": style.line, "label": name}
        marker = style.marker if other.column else ""  # only one column was tested
        curves = _curves(own, low, high)
        for a, value in curves:
            axes.plot(a, value, marker=marker, markevery=[-1], **line)
        ends += [EndLabel(a[-1], value[-1], name, style.colour, (a[0], value[0])) for a, value in curves[-1:]]
    return ends


def _curves(law: Law, low: float, high: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Each piece of a law between two aspect ratios: a (n,) and value (n,)."""
    inside = [piece for piece in law.pieces if piece.lo < high and piece.hi > low]
    aspects = [np.geomspace(max(piece.lo, low), min(piece.hi, high), _CURVE) for piece in inside]
    return [(a, piece.prefactor * a**piece.exponent) for a, piece in zip(aspects, inside, strict=True)]


def _draw_bands(axes: Axes, quantity: str, experiment: Experiment, aspects: set[float]) -> list[EndLabel]:
    """The experiment's value for each aspect ratio, as a horizontal line with its scatter."""
    style, ends = experiment_style(experiment), []
    for a in sorted(aspects):
        if expected := experiment.expected(quantity, a):
            value, half = expected
            axes.axhspan(value - half, value + half, color=style.colour, alpha=0.13, linewidth=0)
            name = experiment.label(quantity)
            label = f"{name}, scatter" if len(aspects) > 1 else f"{name}, a = {a:.4g}, scatter"
            axes.axhline(value, color=style.colour, linestyle=style.line, linewidth=1.2, label=label)
            ends.append(EndLabel(axes.get_xlim()[1], value, f"a = {a:.4g}", style.colour))
    return ends if len(ends) > 1 else []


def _series_style(i: int, count: int) -> dict[str, Any]:
    """Marker of a series; the colours of many series are a sequence from light to dark."""
    many = TIME_COLOURS(i / max(count - 1, 1))
    colour = RUN_COLOURS[i] if count <= len(RUN_COLOURS) else many
    return {"color": colour, "marker": SERIES_MARKERS[i % len(SERIES_MARKERS)] if count > 1 else "o"}


def _draw_series(
    axes: Axes, quantity: str, axis: str, line: Series, *, style: Mapping[str, Any], ticks: Mapping[Any, int]
) -> list[EndLabel]:
    """Markers of a series, grey for runs that are not at rest; a named series gets a label at its last marker."""
    end: list[EndLabel] = []
    for at_rest, paint in ((True, style["color"]), (False, "0.65")):
        rows = [row for row in line.rows if bool(row["at_rest"]) is at_rest]
        if not rows:
            continue
        x = [ticks.get(row[axis], row[axis]) for row in rows]
        mark: dict[str, Any] = {"linestyle": "none", "fillstyle": "none", "marker": style["marker"], "color": paint}
        y = [row["beta" if quantity == "beta" else f"zeta.{MIDDLE}"] for row in rows]
        if not line.label:
            _draw_finer_grids(axes, quantity, x, rows)
        if quantity == "beta":
            axes.plot(x, y, label=_marker_label(line.label or "beta", at_rest), **mark)
        elif not line.label:
            for front in FRONTS:
                own = mark | {"marker": FRONT_STYLES[front]["marker"]}
                axes.plot(x, [row[f"zeta.{front}"] for row in rows], label=_marker_label(front, at_rest), **own)
        else:
            zeta = np.array([[row[f"zeta.{front}"] for front in FRONTS] for row in rows])
            bars = np.abs(np.array([zeta.min(axis=1), zeta.max(axis=1)]) - y)
            axes.errorbar(x, y, yerr=bars, capsize=3, label=_marker_label(line.label, at_rest), **mark)
        last = int(np.argmax(x))
        end = [EndLabel(x[last], y[last], line.label, style["color"])]
    return end if line.label else []


def _draw_finer_grids(axes: Axes, quantity: str, x: Sequence[Any], rows: Sequence[Mapping[str, Any]]) -> None:
    """Intervals of 90 % of what finer grids would give, where the runs have statements of accuracy."""
    column = f"{quantity}.{FINER_GRIDS}"
    known = [(at, row) for at, row in zip(x, rows, strict=True) if row.get(column) is not None]
    if known:
        middle, low = (np.array([row[name] for _, row in known]) for name in (column, f"{column}.low"))
        axes.errorbar([at for at, _ in known], middle, yerr=middle - low, label=FINER_GRIDS, **FINER_STYLE)


def _marker_label(name: str, at_rest: bool) -> str:
    return name if at_rest else f"{name} ({NOT_AT_REST})"


def _draw_slope(axes: Axes, slope: Slope, series: Sequence[Series]) -> None:
    """A fitted line over the range of the data that it was fitted to."""
    index = next(i for i, line in enumerate(series) if line.label == slope.series)
    inside = [row["a"] for row in series[index].rows if row["at_rest"] and slope.lo <= row["a"] < slope.hi]
    a = np.geomspace(min(inside), max(inside), 2)
    colour = FINER_COLOUR if slope.front == FINER_GRIDS else _series_style(index, len(series))["color"]
    dashes = FRONT_STYLES.get(slope.front, {}).get("linestyle", "-")
    line: dict[str, Any] = {"color": colour, "linewidth": 0.9, "linestyle": dashes, "label": _slope_label(slope)}
    axes.plot(a, slope.prefactor * a**slope.exponent, **line)


def _add_legend(
    figure: Figure, axes: Axes, series: Sequence[Series], slopes: Sequence[Slope], ends: Sequence[EndLabel]
) -> None:
    """Entries for markers, with the fits to them, and for the experiment; what has a label at its end has none."""
    fits: dict[str, list[str]] = {}
    for slope in slopes:
        fits.setdefault(slope.series or slope.front or "beta", []).append(_formula(slope))
    skipped = {end.text for end in ends} | {_slope_label(slope) for slope in slopes}
    entries: dict[str, Any] = {}
    for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
        if label not in skipped:
            text = (
                NOT_AT_REST
                if label.endswith(f"({NOT_AT_REST})")
                else ": ".join([label, "; ".join(fits.get(label, []))])
            )
            entries.setdefault(text.removesuffix(": "), handle)
    legend_below(figure, list(entries.values()), list(entries))


def _formula(slope: Slope) -> str:
    width = "" if slope.half_width is None else rf" \pm {slope.half_width:.2f}"
    law = "" if slope.law_exponent is None else rf" (law $a^{{{slope.law_exponent:.2f}}}$)"
    return rf"$\{slope.quantity.partition('.')[0]} \propto a^{{{slope.exponent:.2f}{width}}}$" + law


def _slope_label(slope: Slope) -> str:
    return ": ".join(filter(None, (", ".join(filter(None, (slope.series, slope.front))), _formula(slope))))
