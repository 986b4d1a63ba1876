"""Charts of a deposit against the digitised surface and failure line of an experiment, with their difference."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from mpmcol.experiments import Experiment
from mpmcol.experiments.height_difference import height_difference
from mpmcol.measure import Array, Measurement
from mpmcol.plotting.figures import save_figure
from mpmcol.plotting.styles import DEPOSIT_STYLE, experiment_style
from mpmcol.studies.runs import CompletedRun
from mpmcol.studies.validation import measures

Line = tuple[Array, Array]


def draw_rods(path: Path, run: CompletedRun, width: float) -> None:
    """Draw surface and failure line of the rods of Bui et al. 2008; `width` of the band in mm."""
    deposit = run.results.measure()
    lines = measures.rods_failure_line(run), measures.points_of(measures.FAILURE)
    _draw(path, run, deposit, measures.points_of(measures.SURFACE), width, measures.RODS, lines)


def draw_shape(path: Path, run: CompletedRun, width: float) -> None:
    """Draw the universal shape, scaled to the deposit; `width` of the band relative to the height."""
    deposit = run.results.measure()
    _draw(path, run, deposit, measures.scaled_shape(deposit), 1e3 * width * deposit.height, measures.SHAPE_OF)


def _draw(
    path: Path,
    run: CompletedRun,
    deposit: Measurement,
    surface: Line,
    width: float,
    experiment: Experiment,
    failure: tuple[Line, Line] | None = None,
) -> None:
    colour, name = experiment_style(experiment).colour, experiment.citation
    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
    upper.plot(1e3 * deposit.profile_x, 1e3 * deposit.profile_y, label="deposit", **DEPOSIT_STYLE)
    upper.plot(*_mm(surface), "x", color=colour, markersize=5, label=f"{name}: surface")
    if failure:
        computed, digitised = failure
        upper.plot(*_mm(computed), color="0.4", linestyle="--", label="failure line")
        upper.plot(*_mm(digitised), "+", color=colour, label=f"{name}: failure line")
    station, apart = height_difference(deposit.profile, surface)
    lower.axhspan(-width, width, color=colour, alpha=0.15, linewidth=0, label="band of the RMS")
    lower.plot(1e3 * station, 1e3 * apart, color="black", label=f"deposit minus surface of {name}")
    shape = run.results.shape
    title = f"{run.row['case']}, $a$ = {shape.a:g}, $h$ = {1e3 * shape.spacing:.3g} mm"
    upper.set(ylabel="height (mm)", ylim=(0.0, None), title=title)
    lower.set(xlabel="distance from the wall (mm)", ylabel="difference (mm)", xlim=(0.0, None))
    lower.axhline(0.0, color="black", linewidth=0.8)
    for axes in (upper, lower):
        axes.grid(color="0.9")
        axes.legend(frameon=False, fontsize="small")
    save_figure(figure, path, svg=False)


def _mm(line: Line) -> Line:
    return 1e3 * line[0], 1e3 * line[1]
