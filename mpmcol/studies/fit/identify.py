"""Remarks on the answer: whether the measurements determine the unknowns, and which further ones would."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import sqrt

import numpy as np

from mpmcol.studies.fit.agreement import agreement_of
from mpmcol.studies.fit.further import Further, further_measurements
from mpmcol.studies.fit.quantities import Target
from mpmcol.studies.fit.response import fit_plane, precision
from mpmcol.studies.fit.search import MOST_STEPS, Solution
from mpmcol.studies.fit.unknowns import Unknown

DEGENERATE = 0.95  # magnitude of a correlation from which on two unknowns cannot be separated
UNIFORM = 1.0 / sqrt(12.0)  # standard deviation of an unknown of which only the range is known, in ranges
USEFUL = 0.7  # ratio of standard errors from which on a further measurement is proposed


def remarks(unknowns: Sequence[Unknown], targets: Sequence[Target], solution: Solution) -> Iterator[str]:
    """What a user must know about the values: misfit, ends of ranges, unknowns that are not determined."""
    agreement = agreement_of(targets, solution)
    if agreement.statement:
        yield agreement.statement
    for unknown, share, at_end in zip(unknowns, solution.shares, agreement.at_end, strict=True):
        if at_end:
            end = unknown.low if share < 0.5 else unknown.high
            yield f"{unknown.key} is at the end of its range, {end:g}, {_at_end(agreement.is_reproduced)}"
    if not solution.is_converged:
        yield _not_converged(unknowns, solution)
    yield from _undetermined(unknowns, targets, solution)
    yield from _grid(targets, solution)
    if not solution.last.at_rest:
        yield "a column still moved at the end of a run; raise stages.collapse.max_time_factor"


def _at_end(is_reproduced: bool) -> str:
    if is_reproduced:
        return (
            "where the measurements are reproduced within their errors: values beyond it may agree as well; extend the "
            "range"
        )
    return "and the measurements are not reproduced there: no value of its range leads to them"


def _not_converged(unknowns: Sequence[Unknown], solution: Solution) -> str:
    widths = [one.high - one.low for one in unknowns]
    steps = ", ".join(
        f"{one.key} by {width * step:.2g}" for one, width, step in zip(unknowns, widths, solution.step, strict=True)
    )
    return (
        f"the search did not converge in {MOST_STEPS} steps; the values are those next to the runs with the least "
        f"misfit, from which they differ: {steps}; narrow the ranges or raise --repeats"
    )


def _grid(targets: Sequence[Target], solution: Solution) -> Iterator[str]:
    level = solution.last.level
    for difference in level.differences:
        yield f"the error of the grid may not apply: {difference}"
    missing = [one.name for one in targets if not one.has_grid_error]
    if level.errors is not None and missing:
        yield f"the error of the grid in {', '.join(missing)} is not known, and in no standard error"


def _undetermined(unknowns: Sequence[Unknown], targets: Sequence[Target], solution: Solution) -> Iterator[str]:
    found, names = solution.precision, ", ".join(target.name for target in targets)
    problems = []
    if found is None:
        problems.append(f"{' and '.join(one.key for one in unknowns)} not determined by {names}")
    else:
        for unknown, error in zip(unknowns, found.errors, strict=True):
            if error > UNIFORM:
                problems.append(f"{unknown.key} is not determined within its range by {names}")
        for i, j in combinations(range(len(unknowns)), 2):
            if abs(correlation := found.correlation[i, j]) > DEGENERATE:
                keys = f"{unknowns[i].key} and {unknowns[j].key}"
                problems.append(
                    f"{keys} cannot be separated by {names} (correlation {correlation:.2f}): fix one of them, or "
                    "measure another quantity"
                )
    yield from problems
    if problems:
        yield _better(targets, solution)


def _better(targets: Sequence[Target], solution: Solution) -> str:
    """The further measurement that would reduce the largest standard error most, if one determines the unknowns better.

    Planes through the results give the slopes, so that unknowns that act alike everywhere have slopes in proportion.
    """
    own = [one for one in solution.evaluations if one.level == solution.evaluations[0].level]
    shares = np.array([one.shares for one in own])
    slopes = fit_plane(shares, np.array([one.mean for one in own]), solution.shares)
    further = list(further_measurements(own, targets, solution.shares))
    now = _largest_error(slopes, solution.causes)
    errors = {one.name: _error_with(one, shares, slopes, solution) for one in further}
    if not errors or min(errors.values()) > min(USEFUL * now, UNIFORM):
        examined = ", ".join(errors) or "none"
        return f"no other quantity that runs give would determine them much better (examined: {examined})"
    best = min(further, key=lambda one: errors[one.name])
    return (
        f"{best.name} ({best.meaning}), measured within {best.within}, would reduce the largest standard error to "
        f"{errors[best.name]:.0%} of the range"
    )


def _error_with(further: Further, shares: np.ndarray, slopes: np.ndarray, solution: Solution) -> float:
    """Largest standard error of the shares with a further measurement."""
    gradient = np.vstack((slopes, fit_plane(shares, further.values, solution.shares)))
    more = len(further.value)
    causes = {cause: np.pad(own, ((0, more), (0, more))) for cause, own in solution.causes.items()}
    causes["further"] = np.diag([*np.zeros(len(slopes)), *further.variance])
    return _largest_error(gradient, causes)


def _largest_error(gradient: np.ndarray, causes: dict[str, np.ndarray]) -> float:
    """Largest standard error of the shares; infinite if they are not determined."""
    found = precision(gradient, causes)
    return np.inf if found is None else float(found.errors.max())
