"""The search for the unknowns: bracketing by the ends of the ranges, then least squares on a response surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mpmcol.studies.fit.forward import Evaluation, Forward, values_of
from mpmcol.studies.fit.levels import Level
from mpmcol.studies.fit.quantities import Target, grid_covariance
from mpmcol.studies.fit.response import (
    Precision,
    Surface,
    best_point,
    corrected,
    design,
    fit_surface,
    misfit,
    pooled_variance,
    precision,
)
from mpmcol.sweep.engine import Notify

MOST_STEPS = 6  # of the search, at each level
CONVERGED = 0.5  # change of the unknowns, in their standard errors, at which the search ends
LEAST_CHANGE = 1e-3  # smallest change, in the range, for which runs are computed
LEAST_ERROR = 0.005  # relative standard deviation of a run, at least
CAUSES = ("measurement", "grid", "scatter")


@dataclass(frozen=True)
class Solution:
    """The unknowns with the least misfit, as shares (n,) of their ranges, and what they rest on."""

    shares: np.ndarray
    fitted: np.ndarray  # (m,) targets at the solution
    surface: Surface
    precision: Precision | None  # of the shares; None: the targets do not determine the unknowns
    chi_squared: float
    last: Evaluation  # the evaluation next to the solution
    evaluations: tuple[Evaluation, ...]
    causes: dict[str, np.ndarray]  # covariance (m, m) of the differences between computed and measured by cause
    is_converged: bool = True  # whether the last step was smaller than CONVERGED standard errors

    @property
    def step(self) -> np.ndarray:
        """Distance (n,) of the solution from the values of the last runs."""
        return np.asarray(np.abs(self.shares - self.last.shares))


class Search:
    """Evaluations so far, and the steps of the search."""

    def __init__(self, forward: Forward, notify: Notify) -> None:
        self.forward, self.notify = forward, notify
        self.targets: Sequence[Target] = forward.targets
        self.measured = np.concatenate([target.values for target in self.targets])
        self.evaluations: list[Evaluation] = []

    def begin(self, level: Level) -> np.ndarray:
        """Evaluate the centre and the ends of the ranges; returns the shares of the best."""
        self._evaluate(level, list(design(len(self.forward.unknowns))))
        return min(self.evaluations, key=self._misfit).shares

    def run(self, level: Level, shares: np.ndarray) -> Solution:
        """Search from `shares` on, with runs of a level, until the unknowns change by less than their errors."""
        for _ in range(MOST_STEPS):
            solution = self.solution(self._at(level, shares))
            if self._is_converged(solution):
                return solution
            shares = solution.shares
        best = self.solution(min((one for one in self.evaluations if one.level == level), key=self._misfit))
        return replace(best, is_converged=self._is_converged(best))

    def correct(self, level: Level) -> None:
        """Correct the runs of a level, which are known, for another error of the grid."""
        for k, one in enumerate(self.evaluations):
            if one.level.name == level.name:
                values = values_of(self.targets, one.deposits, one.courses, level.factors)
                self.evaluations[k] = replace(one, level=level, values=values)

    def solution(self, here: Evaluation) -> Solution:
        """Least squares on the response surface near an evaluation."""
        surface, runs = self.surface(here.level, here.shares)
        causes = self._causes(here, runs)
        total = np.asarray(sum(causes.values()))
        shares = best_point(surface, here.shares, self.measured, total)
        fitted = surface.value(shares)
        return Solution(
            shares, fitted, surface, precision(surface.gradient(shares), causes),
            misfit(fitted - self.measured, total), here, tuple(self.evaluations), causes,
        )  # fmt: skip

    def surface(self, level: Level, centre: np.ndarray) -> tuple[Surface, float]:
        """The response surface of a level: that of the first, corrected level by level; and the runs it rests on."""
        levels = list(dict.fromkeys(one.level.name for one in self.evaluations))
        of_level = {name: [one for one in self.evaluations if one.level.name == name] for name in levels}
        surface = fit_surface(*_points(of_level[levels[0]]), centre)
        weight = 1.0
        for name in levels[: levels.index(level.name) + 1]:
            variance = self._variance() / self.forward.repeats
            surface, weight = corrected(surface, *_points(of_level[name]), variance, centre)
        return surface, weight * self.forward.repeats

    def _at(self, level: Level, shares: np.ndarray) -> Evaluation:
        known = [one for one in self.evaluations if one.level == level and np.array_equal(one.shares, shares)]
        return known[0] if known else self._evaluate(level, [shares])[0]

    def _evaluate(self, level: Level, shares: list[np.ndarray]) -> list[Evaluation]:
        found = self.forward.evaluate(level, shares)
        self.evaluations += found
        for one in found:
            self.notify(self._line(one))
        return found

    def _variance(self) -> np.ndarray:
        """Variance (m,) of a single run, at least that of LEAST_ERROR."""
        variance = pooled_variance([one.values for one in self.evaluations])
        return np.asarray(np.maximum(variance, (LEAST_ERROR * self.measured) ** 2))

    def _causes(self, here: Evaluation, runs: float) -> dict[str, np.ndarray]:
        """Covariance of the differences between computed and measured values, by cause; runs: that they rest on."""
        stated = np.concatenate([target.errors for target in self.targets])
        grid = np.zeros((len(stated), len(stated)))
        if here.level.errors is not None:
            grid = grid_covariance(self.targets, here.deposits[0], here.level.errors)
        return dict(zip(CAUSES, (np.diag(stated**2), grid, np.diag(self._variance() / runs)), strict=True))

    def _misfit(self, one: Evaluation) -> float:
        return misfit(one.mean - self.measured, np.asarray(sum(self._causes(one, len(one.values)).values())))

    def _is_converged(self, solution: Solution) -> bool:
        errors = np.zeros(len(solution.shares)) if solution.precision is None else solution.precision.errors
        return bool((solution.step < np.maximum(CONVERGED * errors, LEAST_CHANGE)).all())

    def _line(self, one: Evaluation) -> str:
        unknowns = ", ".join(
            f"{unknown.name} = {unknown.at(float(share)):g}"
            for unknown, share in zip(self.forward.unknowns, one.shares, strict=True)
        )
        values = ", ".join(
            f"{target.name} {value[0]:.4g} (measured {target.values[0]:.4g})"
            for target, value in zip(self.targets, np.split(one.mean, self._ends()), strict=True)
            if len(target.values) == 1
        )
        return f"{one.level.name}: {unknowns}: {values or 'profile computed'}"

    def _ends(self) -> np.ndarray:
        return np.cumsum([len(target.values) for target in self.targets])[:-1]


def _points(evaluations: Sequence[Evaluation]) -> tuple[np.ndarray, np.ndarray]:
    """Shares (k, n) and means (k, m) of evaluations."""
    return np.array([one.shares for one in evaluations]), np.array([one.mean for one in evaluations])
