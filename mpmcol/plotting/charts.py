"""Charts from arrays: deposit profiles, front and height over time, energy balance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from mpmcol.case.title import run_title
from mpmcol.experiments import Experiment
from mpmcol.io.glossary import ENERGY_UNITS
from mpmcol.measure import Array, ColumnShape, Measurement
from mpmcol.plotting.figures import (
    LABEL_SIZE,
    MOST_ENTRIES,
    EndLabel,
    Heading,
    add_heading,
    label_ends,
    legend_below,
    save_figure,
)
from mpmcol.plotting.measured_series import MeasuredSeries
from mpmcol.plotting.profiles import (
    LengthAxes,
    draw_experiment,
    draw_fronts,
    draw_gravity,
    draw_over_bed,
    draw_points,
    origin,
    outline,
    reach_of,
    set_up_axes,
)
from mpmcol.plotting.styles import (
    DEPOSIT_STYLE,
    ENERGY_NAMES,
    ENERGY_STYLES,
    FRONT_LABELS,
    FRONT_STYLES,
    TIME_COLOURS,
    experiment_style,
)
from mpmcol.units import length_scale

TIME_LABEL = r"time since release $t\,/\,\sqrt{h_i/g}$ (-)"
LEAST_RANGE = 0.02  # of the height over h_i: smallest range of its axis
LEAST_RESIDUAL = 1e-3  # per cent: smallest half-range of the axis of the residual


def profile_chart(
    path: Path,
    shape: ColumnShape,
    deposits: Sequence[tuple[float, Measurement]],
    experiment: Experiment,
    *,
    heading: Heading | None = None,
    points: Sequence[MeasuredSeries] = (),
    gravity: float = 9.81,
    svg: bool = False,
    at_rest: bool = True,
    over_bed: tuple[Array, Array] | None = None,
) -> list[Path]:
    """Draw profiles at the given times (s since release), and column and gate at release, with equal axes.

    Earlier profiles are coloured by time. The last one is drawn bold with its three fronts; it is labelled as the
    deposit if `at_rest`. The experiment is shown by front and height of its laws with their scatter, and by its
    digitised profiles if they apply; `points` are measurements of the user. `over_bed` is the last surface over that
    of a granular bed at the release, (bins,) distances and heights, m; the profiles show material of the column only.
    """
    figure = Figure(layout="constrained")
    reach = reach_of(shape, experiment, points)
    target = LengthAxes(figure.add_subplot(aspect="equal"), *length_scale(max(reach, shape.h_i)))
    flatness = set_up_axes(target, shape, [deposit for _, deposit in deposits], reach)
    figure.set_size_inches(8.0, min(6.6 * flatness, 8.0) + 2.1)
    if shape.model == "plane":
        draw_gravity(target.axes, shape.slope_deg)
    tau = shape.fall_time(gravity)
    last = _draw_in_time(figure, target, deposits, tau, ", deposit" if at_rest else ", last state")
    known, names = draw_experiment(target, shape, experiment)
    fronts, text = draw_fronts(target, deposits[-1][1])
    measured, series = draw_points(target, points)
    add_heading(target.axes, heading or Heading(run_title("", shape.model, shape.rectangle_a)))
    surface = [draw_over_bed(target, over_bed)] if over_bed else []
    handles, labels = (
        [last, *surface, tuple(fronts), *known, *measured],
        [*(str(line.get_label()) for line in (last, *surface)), text, *names, *series],
    )
    legend_below(figure, handles, labels)
    return save_figure(figure, path, svg)


def _draw_in_time(
    figure: Figure, target: LengthAxes, deposits: Sequence[tuple[float, Measurement]], tau: float, name: str
) -> Any:
    """Draw all profiles and, for those before the last, a scale of their times; returns the line of the last."""
    end = deposits[-1][0]
    last = end if end > 0.0 else 1.0
    for time, deposit in deposits:
        is_last = deposit is deposits[-1][1]
        label = rf"$t$ = {time:.3g} s = {time / tau:.2g} $\sqrt{{h_i/g}}${name if is_last else ''}"
        style = DEPOSIT_STYLE if is_last else {"color": TIME_COLOURS(time / last), "linewidth": 1.4}
        (line,) = target.axes.plot(*outline(deposit, target.factor), label=label, **style)
    if len(deposits) > 1 and end > 0.0:
        bar = figure.colorbar(
            ScalarMappable(Normalize(0.0, last), TIME_COLOURS), cax=target.axes.inset_axes((1.015, 0.0, 0.02, 1.0))
        )
        times = [time for time, _ in deposits]
        bar.set_ticks(times, labels=[f"{time:.3g}" for time in times])
        bar.set_label("time since release (s)")
        bar.ax.hlines(times[:-1], 0.0, 1.0, color="white", linewidth=1.0)
    return line


def front_chart(
    path: Path,
    shape: ColumnShape,
    time: Array,
    fronts: Mapping[str, Array],
    height: Array,
    experiment: Experiment,
    *,
    heading: Heading | None = None,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Draw the runout by each front definition and the height, both normalised, over t / sqrt(h_i / g).

    Args:
        path: of the PNG; with `svg`, an SVG is written beside it.
        shape: the column as released.
        time: (n,) since release, s.
        fronts: front definition -> (n,) positions, m.
        height: (n,) of the pile, m.
        experiment: its final values are drawn with bands for their scatter.
        heading: title and caption (default: model and aspect ratio).
        gravity: m/s2.
    """
    figure, upper, lower = history_panels(heading or Heading(run_title("", shape.model, shape.rectangle_a)))
    tau = time / shape.fall_time(gravity)
    for name, front in fronts.items():
        style = {key: value for key, value in FRONT_STYLES[name].items() if key != "marker"}
        upper.plot(tau, front / shape.r_i - 1.0, label=FRONT_LABELS[name], **style)
    place = f"at the {origin(shape)}" if shape.outline is None else "of the deposit"
    lower.plot(tau, height / shape.h_i, color="black", label=f"height {place}")
    for axes, quantity in ((upper, "zeta"), (lower, "beta")):
        draw_band(axes, experiment, quantity, shape.a)
        axes.legend(frameon=False, fontsize=LABEL_SIZE)
    keep_range(lower)
    upper.set_ylim(bottom=min(0.0, upper.get_ylim()[0]))
    return save_figure(figure, path, svg)


def keep_range(axes: Axes) -> None:
    """Give the vertical axis a range of at least LEAST_RANGE, so that rounding of a constant value is not magnified."""
    low, high = axes.get_ylim()
    missing = LEAST_RANGE - (high - low)
    if missing > 0.0:
        axes.set_ylim(low - missing / 2.0, high + missing / 2.0)
    axes.ticklabel_format(axis="y", useOffset=False)


def history_panels(heading: Heading) -> tuple[Figure, Axes, Axes]:
    """Two panels over time: runout above, height below."""
    figure = Figure(figsize=(7.0, 6.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
    add_heading(upper, heading)
    upper.set(ylabel=r"runout $\zeta = (r - r_i)/r_i$ (-)")
    lower.set(ylabel=r"height $h / h_i$ (-)", xlabel=TIME_LABEL)
    for axes in (upper, lower):
        axes.grid(color="0.9")
    figure.align_ylabels()
    return figure, upper, lower


def draw_band(axes: Axes, experiment: Experiment, quantity: str, a: float) -> None:
    """The experiment's final value as a line, with a band for its scatter; nothing where it has no law."""
    if expected := experiment.expected(quantity, a):
        value, half = expected
        style = experiment_style(experiment)
        axes.axhspan(value - half, value + half, color=style.colour, alpha=0.13, linewidth=0)
        label = f"{experiment.label(quantity)}: final value, scatter"
        axes.axhline(value, color=style.colour, linestyle=style.line, linewidth=1.2, label=label)


def energy_chart(
    path: Path,
    shape: ColumnShape,
    time: Array,
    energies: Mapping[str, Array],
    *,
    heading: Heading | None = None,
    gravity: float = 9.81,
    svg: bool = False,
) -> list[Path]:
    """Draw the potential energy released since the first time, the other energies, and the residual of the balance.

    All are in per cent of the potential energy of the column at release. `energies` has (n,) arrays in J under
    "potential", "residual" and the keys of ENERGY_STYLES; "wall_friction" may be missing. The smallest ones are drawn
    as their sum where there are more than MOST_ENTRIES lines.
    """
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[4, 1])
    tau = time / shape.fall_time(gravity)
    total = shape.potential_energy(gravity)

    def change(name: str) -> Array:
        return 100.0 * (energies[name] - energies[name][0]) / total

    upper.plot(tau, -change("potential"), color="black", linewidth=2.2, label="potential energy released")
    shown, others = _largest({name: change(name) for name in ENERGY_STYLES if name in energies}, MOST_ENTRIES - 1)
    for name, values in shown.items():
        upper.plot(tau, values, **ENERGY_STYLES[name])
    if others:
        names = ", ".join(ENERGY_NAMES[name] for name in others)
        upper.plot(tau, sum(others.values()), color="0.7", linewidth=1.0, label=f"{names}: sum")
    residual = change("residual")
    lower.plot(tau, residual, color="black")
    largest = float(np.abs(residual).max())
    limit = max(1.2 * largest, LEAST_RESIDUAL)
    add_heading(upper, heading or Heading(run_title("", shape.model, shape.rectangle_a)))
    scale = f"% of {total:.3g} {ENERGY_UNITS[shape.model][1]}"
    upper.set(ylabel=f"energy ({scale},\nthe potential energy at release)")
    lower.set(ylabel="residual (%)", xlabel=TIME_LABEL, ylim=(-limit, limit))
    for axes in (upper, lower):
        axes.grid(color="0.9")
        axes.axhline(0.0, color="0.4", linewidth=0.8, zorder=1)
        axes.margins(x=0.0)
    figure.align_ylabels()
    ends = [
        EndLabel(tau[-1], y := float(line.get_ydata()[-1]), f"{line.get_label()}, {y:.1f} %", line.get_color())
        for line in upper.lines
        if not str(line.get_label()).startswith("_")
    ]
    end = EndLabel(tau[-1], float(residual[-1]), f"largest residual {largest:.1g} %", "black")
    label_ends({upper: ends, lower: [end]})
    return save_figure(figure, path, svg)


def _largest(changes: Mapping[str, Array], most: int) -> tuple[dict[str, Array], dict[str, Array]]:
    """The energies (n,) by name in at most `most` lines: those with a line of their own, and the others, smallest."""
    order = sorted(changes, key=lambda name: -float(np.abs(changes[name]).max()))
    own = order if len(order) <= most else order[: most - 1]
    return tuple({name: changes[name] for name in changes if (name in own) is is_own} for is_own in (True, False))  # type: ignore[return-value]
