"""Charts of several runs: one line for each run in deposit profile, front and height over time, and energies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.case import compared_experiment
from mpmcol.errors import UsageError
from mpmcol.experiments import Experiment, without_laws
from mpmcol.io.atomic import make_folder
from mpmcol.io.results import Results
from mpmcol.measure import Array, ColumnShape, Measurement
from mpmcol.plotting.captions import common_heading, noted, run_names
from mpmcol.plotting.charts import TIME_LABEL, draw_band, history_panels, keep_range
from mpmcol.plotting.figures import MOST_ENTRIES, Heading, add_heading, legend_below, save_figure
from mpmcol.plotting.measured_series import MeasuredSeries
from mpmcol.plotting.profiles import (
    RELEASED,
    LengthAxes,
    distance_label,
    draw_experiment,
    draw_gate,
    draw_gravity,
    draw_points,
    draw_walls,
    outline,
    reach_of,
    set_up_axes,
)
from mpmcol.plotting.styles import RUN_COLOURS, RUN_LINES
from mpmcol.units import length_scale

MOST_RUNS = MOST_ENTRIES - 2  # besides the experiment and measurements of the user
COMPARED_ENERGIES = {
    "potential": ("potential, released", -1.0),
    "kinetic": ("kinetic", 1.0),
    "plastic": ("plastic work", 1.0),
}


@dataclass(frozen=True)
class ComparedRun:
    """A run with its name in the legend and its history since the release."""

    results: Results
    name: str
    history: dict[str, Array]
    style: dict[str, Any]

    @property
    def shape(self) -> ColumnShape:
        """The column as released."""
        return self.results.shape

    @property
    def tau(self) -> Array:
        """Time since release over sqrt(h_i / g)."""
        return self.history["time"] / self.results.fall_time

    @property
    def label(self) -> str:
        """The name, marked if the run is not at rest."""
        return self.name if self.results.came_to_rest else f"{self.name} (not at rest)"


def chart_comparison(
    runs: Sequence[Results], *, points: Sequence[MeasuredSeries] = (), svg: bool = False, out: Path
) -> list[Path]:
    """Draw profile.png (last state of each run), front.png and energy.png into the folder `out`; returns the paths.

    Profiles are in m or mm if all columns have the same r_i, else relative to r_i. The experiment is drawn if all runs
    have the same one and the same aspect ratio. Lines are named by the keys of the cases that differ, if these are one
    or two, else by the folders.

    Raises:
        UsageError: too many runs, runs of different kinds of column, a run that ended before the release, or
            measurements beside columns of different sizes.
        OutputError: a file cannot be read or written.
    """
    _require_comparable(runs)
    compared = [_compared(*one) for one in zip(runs, run_names(runs), range(len(runs)), strict=True)]
    experiment = _common_experiment(runs)
    heading = common_heading(f"Comparison of {len(runs)} runs", [(run.case, run.shape) for run in runs])
    heading = heading._replace(caption=", ".join(filter(None, (heading.caption, _different_slopes(compared)))))
    folder = make_folder(out)
    return [
        *_profiles(folder / "profile.png", compared, experiment, noted(heading, experiment), points, svg),
        *_histories(folder / "front.png", compared, experiment, noted(heading, experiment), svg),
        *_energies(folder / "energy.png", compared, heading, svg),
    ]


def _require_comparable(runs: Sequence[Results]) -> None:
    if len(runs) > MOST_RUNS:
        raise UsageError(
            f"{len(runs)} runs: one chart can show {MOST_RUNS}; leave some out, or compare them by `mpmcol sweep`"
        )
    folders = [run.folder.resolve() for run in runs]
    if twice := next((run.folder for run in runs if folders.count(run.folder.resolve()) > 1), None):
        raise UsageError(f"{twice}: given twice; give each run once")
    first = runs[0]
    for run in runs[1:]:
        kinds = [_kind(one.shape) for one in (first, run)]
        if kinds[0] != kinds[1]:
            raise UsageError(
                f"{first.folder} is {kinds[0]} and {run.folder} is {kinds[1]}: their runout and height "
                "follow different laws and cannot be compared in one chart; plot them separately"
            )


def _kind(shape: ColumnShape) -> str:
    """What determines the meaning of distances and masses; a rectangle and an outline are of one kind."""
    if shape.is_round:
        return "a cylinder"
    return "a box" if shape.dimension == 3 else "plane strain"


def _compared(results: Results, name: str, i: int) -> ComparedRun:
    style = {"color": RUN_COLOURS[i], "linestyle": RUN_LINES[i], "linewidth": 1.6}
    return ComparedRun(results, name, results.released_history, style)


def _common_experiment(runs: Sequence[Results]) -> Experiment:
    """The experiment of all runs; one without laws if they have different ones, or different aspect ratios."""
    found = list(dict.fromkeys(compared_experiment(run.case) for run in runs))
    shape = runs[0].shape
    if len(found) == 1 and all(np.isclose(run.shape.a, shape.a, rtol=0.01) for run in runs):
        return found[0]
    reasons = [one.title for one in found if not one.laws]
    return without_laws("; ".join(reasons) or "no experiment drawn: these runs are compared with different values")


def _profiles(
    path: Path,
    runs: Sequence[ComparedRun],
    experiment: Experiment,
    heading: Heading,
    points: Sequence[MeasuredSeries],
    svg: bool,
) -> list[Path]:
    figure = Figure(layout="constrained")
    axes, shape = figure.add_subplot(aspect="equal"), runs[0].shape
    deposits = [run.results.measure() for run in runs]
    same_size = all(np.isclose(run.shape.r_i, shape.r_i, rtol=1e-3) for run in runs)
    if points and not same_size:
        raise UsageError("measurements are in m, but the columns have different r_i; plot each run with its own points")
    reach = reach_of(shape, experiment, points)
    unit, factor = length_scale(max(reach, *(deposit.max_distance for deposit in deposits)))
    target = LengthAxes(axes, unit, factor)
    if same_size:
        tallest = max((run.shape for run in runs), key=lambda one: one.h_i)
        flatness = set_up_axes(target, tallest, deposits, reach)
        _draw_other_columns(axes, [run for run in runs if run.shape is not tallest], tallest, lambda one: factor)
    else:
        flatness = _set_up_relative(axes, runs, deposits)
    if shape.model == "plane" and all(run.shape.slope_deg == shape.slope_deg for run in runs):
        draw_gravity(axes, shape.slope_deg)
    lines: list[Any] = []
    for run, deposit in zip(runs, deposits, strict=True):
        scale = factor if same_size else 1.0 / run.shape.r_i
        lines += axes.plot(*outline(deposit, scale), label=run.label, **run.style)
    known, names = draw_experiment(target, shape, experiment) if same_size else ([], [])
    measured, series = draw_points(target, points)
    figure.set_size_inches(8.0, min(6.6 * flatness, 8.0) + 2.1)
    add_heading(axes, heading)
    legend_below(figure, [*lines, *known, *measured], [*(run.label for run in runs), *names, *series])
    return save_figure(figure, path, svg)


def _set_up_relative(axes: Axes, runs: Sequence[ComparedRun], deposits: Sequence[Measurement]) -> float:
    """Axes for columns of different sizes, relative to r_i; returns height over length."""
    length = max(deposit.max_distance / run.shape.r_i for run, deposit in zip(runs, deposits, strict=True))
    top = max(run.shape.a for run in runs)
    axes.set(
        xlim=(-0.03 * length, 1.03 * length),
        ylim=(-0.04 * length, top + 0.07 * length),
        xlabel=f"{distance_label(runs[0].shape)} over $r_i$ (-)",
        ylabel="height over $r_i$ (-)",
    )
    if any(run.shape.gate for run in runs):
        draw_gate(axes, 1.0)
    axes.axhline(0.0, color="black", linewidth=0.8, zorder=0)
    _draw_other_columns(axes, runs, None, lambda one: 1.0 / one.r_i)
    return top / length


def _draw_other_columns(
    axes: Axes, runs: Sequence[ComparedRun], drawn: ColumnShape | None, factor_of: Callable[[ColumnShape], float]
) -> None:
    """Column at release and walls of each run that differ from those drawn; the edges of walls have its colour."""
    known = [] if drawn is None else [drawn]
    for run in runs:
        shape, factor = run.shape, factor_of(run.shape)
        if not any(np.array_equal(shape.surface, one.surface) for one in known):
            axes.plot(*(factor * shape.surface), **RELEASED)
        if not (shape.has_sectors or any(shape.obstacles == one.obstacles for one in known)):
            walls = [(one.low_x, one.high_x, one.height) for one in shape.obstacles]
            draw_walls(axes, walls, factor, facecolor="none", edgecolor=run.style["color"])
        known.append(shape)


def _different_slopes(runs: Sequence[ComparedRun]) -> str:
    """A note if the bases are inclined differently: the charts show distances along the base."""
    slopes = list(dict.fromkeys(run.shape.slope_deg for run in runs))
    return f"slopes of {', '.join(f'{slope:g}' for slope in slopes)} deg; drawn along the base" if slopes[1:] else ""


def _histories(
    path: Path, runs: Sequence[ComparedRun], experiment: Experiment, heading: Heading, svg: bool
) -> list[Path]:
    figure, upper, lower = history_panels(heading)
    for run in runs:
        upper.plot(run.tau, run.history["front_height"] / run.shape.r_i - 1.0, label=run.label, **run.style)
        lower.plot(run.tau, run.history["height"] / run.shape.h_i, **run.style)
    for axes, quantity in ((upper, "zeta"), (lower, "beta")):
        draw_band(axes, experiment, quantity, runs[0].shape.a)
    keep_range(lower)
    handles, labels = upper.get_legend_handles_labels()
    upper.set(ylabel=r"runout $\zeta$ by front_height (-)")
    legend_below(figure, handles, labels)
    return save_figure(figure, path, svg)


def _energies(path: Path, runs: Sequence[ComparedRun], heading: Heading, svg: bool) -> list[Path]:
    """Potential energy released, kinetic energy and plastic work, in per cent of the potential energy at release."""
    figure = Figure(figsize=(7.0, 7.0), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True)
    for axes, (name, (title, sign)) in zip(panels, COMPARED_ENERGIES.items(), strict=True):
        for run in runs:
            energy = sign * (run.history[name] - run.history[name][0])
            total = run.shape.potential_energy(run.results.case.geometry.gravity)
            axes.plot(run.tau, 100.0 * energy / total, label=run.label, **run.style)
        axes.set_ylabel(f"{title} (%)")
        axes.grid(color="0.9")
    panels[-1].set_xlabel(TIME_LABEL)
    add_heading(panels[0], heading._replace(title=f"{heading.title}, energies over potential energy at release"))
    figure.align_ylabels()
    legend_below(figure, *panels[0].get_legend_handles_labels())
    return save_figure(figure, path, svg)
