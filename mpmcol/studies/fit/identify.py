"""Whether the measurements determine the unknowns, and which further measurement would determine them better."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import sqrt

import numpy as np

from mpmcol.studies.fit.forward import Evaluation
from mpmcol.studies.fit.quantities import QUANTITIES, Target
from mpmcol.studies.fit.search import Solution
from mpmcol.studies.fit.surface import fit_surface, precision
from mpmcol.studies.fit.unknowns import Unknown

DEGENERATE = 0.95  # magnitude of a correlation from which on two unknowns cannot be separated
UNIFORM = 1.0 / sqrt(12.0)  # standard deviation of an unknown of which only the range is known, in ranges
FURTHER_ERROR = 0.03  # relative standard error that is assumed of a further measurement
USEFUL = 0.7  # ratio of standard errors from which on a further measurement is proposed
END = 1e-3  # of the range: distance from an end at which a value counts as the end


def remarks(unknowns: Sequence[Unknown], targets: Sequence[Target], solution: Solution) -> Iterator[str]:
    """What a user must know about the values: ends of ranges, unknowns that are not determined, better measurements."""
    for unknown, share in zip(unknowns, solution.shares, strict=True):
        if not END < share < 1.0 - END:
            end = unknown.low if share < 0.5 else unknown.high
            yield (
                f"{unknown.key} is at the end of its range, {end:g}: the measurements ask for a value beyond it, or no "
                "value leads to them; extend the range"
            )
    yield from _undetermined(unknowns, targets, solution)
    for difference in solution.last.level.differences:
        yield f"the error of the grid may not apply: {difference}"
    if not solution.last.at_rest:
        yield "a column still moved at the end of a run; raise stages.collapse.max_time_factor"


def _undetermined(unknowns: Sequence[Unknown], targets: Sequence[Target], solution: Solution) -> Iterator[str]:
    found = solution.precision
    names = ", ".join(target.name for target in targets)
    if found is None:
        yield f"{' and '.join(one.key for one in unknowns)} not determined by {names}{_better(targets, solution)}"
        return
    for unknown, error in zip(unknowns, found.errors, strict=True):
        if error > UNIFORM:
            yield f"{unknown.key} is not determined within its range by {names}{_better(targets, solution)}"
    for i, j in combinations(range(len(unknowns)), 2):
        if abs(correlation := found.correlation[i, j]) > DEGENERATE:
            yield (
                f"{unknowns[i].key} and {unknowns[j].key} cannot be separated by {names} (correlation "
                f"{correlation:.2f}): fix one of them{_better(targets, solution)}"
            )


def _better(targets: Sequence[Target], solution: Solution) -> str:
    """The further quantity that would reduce the largest standard error most, if one reduces it enough."""
    errors = {name: error for name in QUANTITIES if (error := _error_with(name, targets, solution)) is not None}
    now = np.inf if solution.precision is None else float(solution.precision.errors.max())
    if not errors or min(errors.values()) > USEFUL * now:
        return "; no other quantity of the deposit would determine them much better"
    best = min(errors, key=lambda name: errors[name])
    return (
        f"; {best} ({QUANTITIES[best].meaning}), measured within {FURTHER_ERROR:.0%}, would reduce the largest "
        f"standard error to {errors[best]:.0%} of the range"
    )


def _error_with(name: str, targets: Sequence[Target], solution: Solution) -> float | None:
    """Largest standard error of the shares with a further quantity; None if it is no new one or does not help."""
    own = [one for one in solution.evaluations if one.level == solution.evaluations[0].level]
    values = np.array([[one.scalars[name]] for one in own])
    value = value_at(own, name, solution.shares)
    if name in {target.name for target in targets} or not np.isfinite(values).all() or value == 0.0:
        return None
    slope = fit_surface(np.array([one.shares for one in own]), values, solution.shares).gradient(solution.shares)
    gradient = np.vstack((solution.surface.gradient(solution.shares), slope))
    further = (FURTHER_ERROR * value) ** 2
    causes = {cause: _extended(covariance) for cause, covariance in solution.causes.items()}
    causes["further"] = np.diag([*np.zeros(len(gradient) - 1), further])
    found = precision(gradient, causes)
    return None if found is None else float(found.errors.max())


def value_at(evaluations: Sequence[Evaluation], name: str, shares: np.ndarray) -> float:
    """A quantity in the evaluation nearest to `shares`."""
    return min(evaluations, key=lambda one: float(np.linalg.norm(one.shares - shares))).scalars[name]


def _extended(covariance: np.ndarray) -> np.ndarray:
    """The covariance with a further quantity that has none."""
    return np.pad(covariance, ((0, 1), (0, 1)))
