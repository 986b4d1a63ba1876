"""Judgement of a finished run in words: agreement with an experiment, error of grid and model, what to do for less."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot
from typing import Any

from mpmcol.case import Case, compared_experiment
from mpmcol.case.slope import remedy_of_motion
from mpmcol.experiments import Experiment, mark
from mpmcol.io.results import Results
from mpmcol.studies.model_error import IN_STUDY, difference_in_study
from mpmcol.studies.pareto.shipped import unstudied
from mpmcol.studies.pareto.studied import StudiedError, studied_error
from mpmcol.units import length_scale

FRONT = "front_height"
NAMES = {"zeta": "runout", "beta": "height"}
OTHER_GRID = "compare with a run at half the grid.spacing"
STILL_MOVING = "the column still moved at the end: not compared with experiments"


def judge(results: Results, with_grid: bool = True) -> list[str]:
    """Lines on runout and height of a run that is done; `with_grid` also on the error of the grid.

    Without these lines there is no verdict that this error leaves undecided: a statement of accuracy follows.
    """
    error = studied_error(results.case)
    experiment, reason = experiment_or_reason(results.case)
    if not results.summary["at_rest"]:
        experiment, reason = None, "; ".join(filter(None, [STILL_MOVING, remedy_of_motion(results.case)]))
    lines = [
        _quantity_line(results.summary, quantity, results.case, experiment, error, with_grid) for quantity in NAMES
    ]
    causes = [*_grid_lines(results.case, error), *_model_lines(experiment, error)] if with_grid else []
    return [*lines, *([reason] if reason else []), *causes]


def experiment_or_reason(case: Case) -> tuple[Experiment | None, str]:
    """The experiment with which a case is compared; or None, and why there is none."""
    found = compared_experiment(case)
    return (found, "") if found.laws else (None, found.title)


def _quantity_line(
    summary: Mapping[str, Any],
    quantity: str,
    case: Case,
    experiment: Experiment | None,
    error: StudiedError | None,
    with_grid: bool,
) -> str:
    length, value = measured_value(summary, quantity, case.geometry.r_i)
    unit, factor = length_scale(max(case.geometry.r_i, case.geometry.h_i))  # as in the table of a run
    text = f"{NAMES[quantity]} {factor * length:.4g} {unit}, {quantity} = {value:.3f}"
    expected = experiment.expected(quantity, case.geometry.a) if experiment else None
    if quantity == "zeta" and length < 0.0:
        text += ": the front has not advanced by a cell"
    if experiment is None or expected is None:
        return text
    law = experiment.law(quantity)
    difference, scatter = value / expected[0] - 1.0, expected[1] / expected[0]
    source = f"{experiment.citation}{mark(law.verified) if law else ''}"
    text += f": {difference:+.1%} against {source} ({expected[0]:.3f}, scatter {scatter:.0%})"
    if error is None:
        return f"{text}, {verdict(difference, scatter, None)}" if with_grid or abs(difference) <= scatter else text
    interval = error.intervals[IN_STUDY[quantity]]
    ratio = interval.factor * (1.0 + difference)  # of what finer grids give over the experiment
    return f"{text}; on finer grids {ratio - 1.0:+.1%}: {verdict(ratio - 1.0, scatter, interval.relative * ratio)}"


def verdict(difference: float, scatter: float, grid: float | None) -> str:
    """Whether a relative difference is within the scatter of an experiment and the error of the grid, in words.

    grid: error of the difference by the grid; None if it is not known.
    """
    difference = abs(difference)
    if difference <= scatter:
        return "agrees within the scatter"
    if grid is None:
        return "undecided: beyond the scatter, but the error of the grid is not known"
    if difference <= hypot(scatter, grid):
        return "undecided within the error of the grid"
    return "differs by more than the scatter and the error of the grid"


def measured_value(summary: Mapping[str, Any], quantity: str, r_i: float) -> tuple[float, float]:
    """Length in m and dimensionless value of a quantity of NAMES, of a column of radius r_i (m); in 3D the means."""
    if quantity == "beta":
        return float(summary["height"]), float(summary["beta"])
    pair = (summary["front"][FRONT], summary["zeta"][FRONT])
    front, value = (one["mean"] if isinstance(one, Mapping) else one for one in pair)
    return float(front) - r_i, float(value)


def _grid_lines(case: Case, error: StudiedError | None) -> Iterator[str]:
    if not case.geometry.is_rectangle:
        yield f"error of the grid: not studied for outlines; {OTHER_GRID}"
    elif error is None:
        advice = OTHER_GRID if unstudied(case) else "--accuracy 5% chooses studied ones"
        yield f"error of the grid: not studied for these settings; {advice}"
    else:
        half = 50.0 * max(error.errors.values())
        yield f"error of the grid: {error}; for half of it: --accuracy {half:.2g}%"


def _model_lines(experiment: Experiment | None, error: StudiedError | None) -> Iterator[str]:
    """What remains on fine grids; the error of a coarse grid may cancel it."""
    if experiment is None or error is None:
        return
    found = {NAMES[name]: difference_in_study(name, experiment, error.cases) for name in NAMES}
    texts = [f"{difference:+.1%} in {name}" for name, difference in found.items() if difference is not None]
    if texts:
        left = f"{' and '.join(texts)} against {experiment.citation}"
        yield f"error of the model, which is left on fine grids: {left}"
