"""Charts of a fit: each measured quantity over each unknown, and the profile before and after the fit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from mpmcol.case import load_case
from mpmcol.case.title import title_of
from mpmcol.io.results import Results
from mpmcol.measure import ColumnShape, Measurement
from mpmcol.plotting.figures import Heading, add_heading, legend_below, save_figure
from mpmcol.plotting.profiles import LengthAxes, set_up_axes
from mpmcol.studies.fit import Fit
from mpmcol.studies.fit.forward import Evaluation
from mpmcol.studies.fit.quantities import PROFILE, Target
from mpmcol.studies.fit.response import misfit
from mpmcol.studies.fit.values import FittedValue, fitted_values
from mpmcol.units import length_scale

SAMPLES = 61
COARSE: dict[str, Any] = {"color": "C0", "marker": "o", "markerfacecolor": "none"}
FINAL: dict[str, Any] = {"color": "C1", "marker": "s"}
BAND: dict[str, Any] = {"color": "0.85", "zorder": 0}


def response_chart(fit: Fit, path: Path) -> list[Path]:
    """Each scalar quantity and the misfit (rows) over each unknown (columns), the others at their fitted values."""
    rows = [(k, target) for k, target in enumerate(fit.targets) if target.name != PROFILE]
    n = len(fit.unknowns)
    figure = Figure(figsize=(1.5 + 4.0 * n, 0.9 + 2.4 * (len(rows) + 1)), layout="constrained")
    panels = figure.subplots(len(rows) + 1, n, squeeze=False)
    for (number, target), line in zip(rows, panels[:-1], strict=True):
        for k, axes in enumerate(line):
            _response(axes, fit, number, target, k)
    for k, axes in enumerate(panels[-1]):
        _misfit(axes, fit, k)
        unknown = fit.unknowns[k]
        axes.set_xlabel(unknown.key + (f" ({unknown.unit})" if unknown.unit else ""))
    figure.suptitle(_title(fit), parse_math=False)
    handles, labels = panels[0][0].get_legend_handles_labels()
    legend_below(figure, handles, labels, columns=3)
    return save_figure(figure, path, svg=False)


def profile_chart(fit: Fit, path: Path) -> list[Path]:
    """The deposit in the middle of the ranges and that of the run nearest to the answer, as computed; what is measured.

    Drawn are a measured profile, runout and height.
    """
    before, after = _middle(fit), _nearest(fit)
    shape = Results(after.folders[0]).shape
    measured = list(_measured_points(fit, shape))
    reach = max((float(np.max(one.x + one.x_error)) for one in measured), default=0.0)
    unit, factor = length_scale(max(after.deposits[0].max_distance, reach))
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    target = LengthAxes(figure.subplots(), unit, factor)
    set_up_axes(target, shape, [before.deposits[0], after.deposits[0]], reach)
    for one, label, style in ((before, "middle of the ranges", "--"), (after, "run nearest to the answer", "-")):
        deposit: Measurement = one.deposits[0]
        values = ", ".join(
            f"{unknown.name} {unknown.at(float(share)):.4g} {unknown.unit}".rstrip()
            for unknown, share in zip(fit.unknowns, one.shares, strict=True)
        )
        target.axes.plot(
            factor * deposit.profile_x, factor * deposit.profile_y, style, color="C1" if style == "-" else "C0",
            label=f"{label}: {values}",
        )  # fmt: skip
    for number, points in enumerate(measured):
        target.axes.errorbar(
            factor * points.x, factor * points.y, factor * points.y_error, factor * points.x_error, fmt="o",
            color="black", ms=4, capsize=2, clip_on=False, zorder=3, label="" if number else "measured",
        )  # fmt: skip
    answer = ", ".join(map(_answer, fitted_values(fit)))
    add_heading(target.axes, Heading(_title(fit), f"answer: {answer}; lines as computed"))
    legend_below(figure, *target.axes.get_legend_handles_labels(), columns=2)
    return save_figure(figure, path, svg=False)


class _Points(NamedTuple):
    """Measured points of a deposit with their standard errors, (n,), m."""

    x: np.ndarray
    y: np.ndarray
    x_error: float | np.ndarray = 0.0
    y_error: float | np.ndarray = 0.0


def _measured_points(fit: Fit, shape: ColumnShape) -> Iterator[_Points]:
    """Points of a measured profile, the end of a measured runout and the top of a measured height."""
    origin = np.zeros(1)
    for target in fit.targets:
        if target.name == PROFILE:
            yield _Points(target.x, target.values, y_error=target.errors)
        elif target.name == "zeta":
            yield _Points(shape.r_i * (1.0 + target.values), origin, x_error=shape.r_i * target.errors)
        elif target.name == "beta":
            yield _Points(origin, shape.h_i * target.values, y_error=shape.h_i * target.errors)


def _response(axes: Axes, fit: Fit, number: int, target: Target, k: int) -> None:
    """A quantity over an unknown: runs, surface, measured value with its error, solution with its error."""
    solution, unknown = fit.solution, fit.unknowns[k]
    at = sum(len(one.values) for one in fit.targets[:number])
    final = solution.last.level
    for style, own in (
        (COARSE, [one for one in solution.evaluations if one.level != final]),
        (FINAL, [one for one in solution.evaluations if one.level == final]),
    ):
        label = "runs, r_i/h = " + ", ".join(dict.fromkeys(f"{one.level.cells:.3g}" for one in own))
        at_run = [unknown.at(float(one.shares[k])) for one in own for _ in one.values]
        if own:
            axes.plot(
                at_run, np.concatenate([one.values[:, at] for one in own]), linestyle="none", label=label, **style
            )
    x, points = _line(fit, k)
    axes.plot(x, [solution.surface.value(point)[at] for point in points], color="0.3", label="response surface")
    value, error = float(target.values[0]), float(target.errors[0])
    axes.axhspan(value - error, value + error, **BAND)
    axes.axhline(value, color="black", linestyle=":", label="measured, with its standard error")
    _draw_solution(axes, fit, k)
    name = f"{target.name}, corrected" if target.is_corrected and final.studied else target.name
    axes.set_ylabel(name + (f" ({target.unit})" if target.unit else ""))


def _misfit(axes: Axes, fit: Fit, k: int) -> None:
    """Misfit by the response surface over an unknown, in standard errors."""
    solution = fit.solution
    measured = np.concatenate([target.values for target in fit.targets])
    total = np.asarray(sum(solution.causes.values()))
    x, points = _line(fit, k)
    axes.plot(x, [misfit(solution.surface.value(point) - measured, total) ** 0.5 for point in points], color="0.3")
    _draw_solution(axes, fit, k)
    axes.set(ylabel="misfit (standard errors)", ylim=(0.0, None))


def _line(fit: Fit, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Values (SAMPLES,) of an unknown over its range, and the shares (SAMPLES, n) of all, the others as fitted."""
    points = np.tile(fit.solution.shares, (SAMPLES, 1))
    points[:, k] = np.linspace(0.0, 1.0, SAMPLES)
    return fit.unknowns[k].low + points[:, k] * (fit.unknowns[k].high - fit.unknowns[k].low), points


def _draw_solution(axes: Axes, fit: Fit, k: int) -> None:
    unknown, found = fit.unknowns[k], fitted_values(fit)[k]
    grid = "" if fit.is_grid_known else " (grid not known)"
    label = "nearest value" if found.error is None else f"fitted, with its standard error{grid}"
    axes.axvline(found.value, color="C3", label=label)
    if found.error is not None:
        low, high = max(found.value - found.error, unknown.low), min(found.value + found.error, unknown.high)
        axes.axvspan(low, high, color="C3", alpha=0.15, linewidth=0)


def _title(fit: Fit) -> str:
    return f"Fit: {title_of(load_case(fit.source, fit.overrides))}"


def _answer(found: FittedValue) -> str:
    """A fitted value with its unit, in a few words."""
    error = "" if found.error is None else f" +- {found.error:.2g}"
    value = f"{found.key.rpartition('.')[2]} {found.value:.4g}{error} {found.unit}".rstrip()
    return value if error else f"{value} (no standard error)"


def _middle(fit: Fit) -> Evaluation:
    """The evaluation in the middle of the ranges."""
    return fit.solution.evaluations[0]


def _nearest(fit: Fit) -> Evaluation:
    """The evaluation on the grid of the answer whose values are nearest to the fitted ones."""
    solution = fit.solution
    own = [one for one in solution.evaluations if one.level == solution.last.level]
    return min(own, key=lambda one: float(np.linalg.norm(one.shares - solution.shares)))
