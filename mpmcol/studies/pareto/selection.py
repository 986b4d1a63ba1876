"""Selection from a scored study: the Pareto front, the cheapest configuration for an error, effects of choices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mpmcol.studies.convergence import MIN_SPACINGS
from mpmcol.studies.pareto.reference import PROFILE
from mpmcol.studies.pareto.score import BETA, ZETA, ScoredConfiguration
from mpmcol.studies.pareto.study import StudyDefinition

GOALS = (0.10, 0.05, 0.02, 0.01)  # relative errors
CRITERIA = (ZETA, BETA, PROFILE)  # quantities by which configurations are selected


@dataclass(frozen=True)
class ErrorBound:
    """A configuration, and the error that neither it nor any finer one of its variant exceeds (90 % of runs)."""

    scored: ScoredConfiguration
    error: float


@dataclass(frozen=True)
class Effect:
    """Effect of a scheme variant at one spacing relative to the baseline."""

    case: str
    variant: str
    cells: float
    cost_ratio: float  # core-seconds over those of the baseline
    steps_ratio: float  # points times steps over those of the baseline
    change: dict[str, tuple[float, float]]  # quantity -> relative change of the mean, its standard error


def of_case(scored: Sequence[ScoredConfiguration], case: str) -> list[ScoredConfiguration]:
    """Return the configurations of a case."""
    return [one for one in scored if one.configuration.case == case]


def error_bounds(scored: Sequence[ScoredConfiguration], quantity: str) -> list[ErrorBound]:
    """Return error bounds for the configurations of a case.

    An error that grows again on a finer grid was small by coincidence; the bound is therefore the largest error of a
    configuration and all finer ones of its variant. Configurations with failed or missing runs are left out, as are
    variants at fewer than MIN_SPACINGS spacings.
    """
    bounds = []
    for variant in dict.fromkeys(one.configuration.variant for one in scored):
        own = [
            one for one in scored
            if one.configuration.variant == variant and quantity in one.errors and one.is_complete
        ]  # fmt: skip
        largest = 0.0
        for one in sorted(own, key=lambda one: -one.configuration.cells) if len(own) >= MIN_SPACINGS else ():
            largest = max(largest, one.errors[quantity].p90)
            bounds.append(ErrorBound(one, largest))
    return bounds


def pareto_front(scored: Sequence[ScoredConfiguration], quantity: str) -> list[ErrorBound]:
    """Return the configurations of a case that no other dominates in cost and error, cheapest first."""
    front: list[ErrorBound] = []
    bounds = error_bounds(scored, quantity)
    for bound in sorted(bounds, key=lambda bound: (bound.scored.cost["core_seconds"], bound.error)):
        if not front or bound.error < front[-1].error:
            front.append(bound)
    return front


def cheapest(scored: Sequence[ScoredConfiguration], quantity: str, goal: float) -> ScoredConfiguration | None:
    """Return the cheapest configuration of a case with an error of at most `goal`."""
    return next((bound.scored for bound in pareto_front(scored, quantity) if bound.error <= goal), None)


def effects(study: StudyDefinition, scored: Sequence[ScoredConfiguration]) -> Iterator[Effect]:
    """Yield the effect of each variant at each spacing at which the baseline was run."""
    baseline = {
        (one.configuration.case, one.configuration.cells): one
        for one in scored
        if one.configuration.variant == study.baseline
    }
    for one in scored:
        configuration = one.configuration
        other = baseline.get((configuration.case, configuration.cells))
        if other is None or other is one or not one.errors or not other.errors or not _pairs(one, other, BETA):
            continue
        yield Effect(
            configuration.case,
            configuration.variant,
            configuration.cells,
            one.cost["core_seconds"] / other.cost["core_seconds"],
            one.cost["point_steps"] / other.cost["point_steps"],
            {quantity: _change(one, other, quantity) for quantity in (ZETA, BETA)},
        )


def _change(one: ScoredConfiguration, other: ScoredConfiguration, quantity: str) -> tuple[float, float]:
    """Mean of the ratios of runs at equal spacings, less one, and its standard error; nan with a single pair."""
    ratios = [value / reference for value, reference in _pairs(one, other, quantity)]
    error = np.std(ratios, ddof=1) / np.sqrt(len(ratios)) if len(ratios) > 1 else np.nan
    return float(np.mean(ratios)) - 1.0, float(error)


def _pairs(one: ScoredConfiguration, other: ScoredConfiguration, quantity: str) -> list[tuple[float, float]]:
    """The values of runs of both at equal spacings; empty if different runs of them failed."""
    there = {run.row["spacing_used"]: run.row[quantity] for run in other.runs}
    return [(run.row[quantity], there[h]) for run in one.runs if (h := run.row["spacing_used"]) in there]
