"""Analysis of the runs of a sample: statistics of each measured quantity, and probabilities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpmcol.io.columns import unit_of
from mpmcol.io.glossary import RESULT
from mpmcol.io.run_status import read_status
from mpmcol.io.values import flatten
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.uncertainty.plan import UncertaintyPlan
from mpmcol.studies.uncertainty.statistics import Probability, Statistics, probability_of, statistics_of
from mpmcol.studies.uncertainty.variance_shares import VarianceShares, variance_shares
from mpmcol.sweep.engine import Outcome

FRONT = "front.front_height"
QUANTITIES = (ZETA, FRONT, BETA, "repose_angle_deg")  # of result.json
WALL_QUANTITIES = ("peak", "sustained", "moment")  # of each wall in wall_forces


@dataclass(frozen=True)
class Quantity:
    """A measured quantity over the sample.

    values: of the runs that have one, (count,). grid_deviation: standard deviation of the error of the grid, from the
    study of configurations; None if it was not studied.
    """

    name: str  # in result.json
    unit: str
    values: np.ndarray
    statistics: Statistics
    shares: VarianceShares | None
    grid_deviation: float | None

    @property
    def grid_share(self) -> float | None:
        """Variance of the error of the grid over its sum with the variance of the sample."""
        if self.grid_deviation is None:
            return None
        grid, sample = self.grid_deviation**2, self.statistics.standard_deviation**2
        return grid / (grid + sample) if grid + sample else 0.0


@dataclass(frozen=True)
class Passing:
    """Probability that the front (`FRONT`) passes a distance from the wall or axis, m."""

    distance: float
    probability: Probability


@dataclass(frozen=True)
class Analysis:
    """What the runs of a sample give; quantities with fewer than two values are missing."""

    plan: UncertaintyPlan
    done: int  # runs that are done, the others are in no statistics
    not_at_rest: int  # of these, columns that still moved at the end
    quantities: Sequence[Quantity]
    passes: Sequence[Passing]


def analyse(plan: UncertaintyPlan, outcomes: Sequence[Outcome], distances: Sequence[float] = ()) -> Analysis:
    """Analyse the outcomes of the planned runs, in their order.

    Args:
        distances: from the wall or axis, m, of which the probability that the front passes them is asked.
    """
    done = [i for i, outcome in enumerate(outcomes) if outcome.status == "done"]
    results = [read_status(outcomes[i].run.folder).result or {} for i in done]
    measured = [_corrected(plan, i, _measured(result)) for i, result in zip(done, results, strict=True)]
    x = np.array([plan.sample.numbers(one.key) for one in plan.inputs]).reshape(-1, len(outcomes)).T[done]
    names = dict.fromkeys(name for one in measured for name in one)
    columns = {name: np.array([one.get(name, np.nan) for one in measured], dtype=np.float64) for name in names}
    return Analysis(
        plan=plan,
        done=len(done),
        not_at_rest=sum(not result.get("at_rest") for result in results),
        quantities=[_quantity(plan, name, x, y) for name, y in columns.items() if _is_reported(name, y)],
        passes=[Passing(one, probability_of(columns[FRONT] > one)) for one in distances if FRONT in columns],
    )


def _measured(result: Mapping[str, Any]) -> dict[str, float]:
    """The quantities of a run; those of 3D are means around the axis."""
    flat = dict(flatten(result, unnamed=("mean",)))
    names = [*QUANTITIES, *_wall_names(result)]
    return {name: float(flat[name]) for name in names if isinstance(flat.get(name), (int, float))}


def _corrected(plan: UncertaintyPlan, i: int, measured: dict[str, float]) -> dict[str, float]:
    """Runout, front and height of run `i`, corrected for the error of the grid at the means of the inputs."""
    if not (plan.corrected and plan.recommendation):
        return measured
    intervals, r_i = plan.recommendation.intervals, plan.runs[i].case.geometry.r_i
    runout = intervals[ZETA].factor
    changed = {
        ZETA: lambda zeta: runout * zeta,
        FRONT: lambda front: r_i + runout * (front - r_i),
        BETA: lambda beta: intervals[BETA].factor * beta,
    }
    return {name: changed[name](value) if name in changed else value for name, value in measured.items()}


def _grid_error(plan: UncertaintyPlan, name: str) -> float | None:
    """Relative error of 90 % of a quantity by the grid; None if it was not studied."""
    advice = plan.recommendation
    if advice is None or name not in advice.errors:
        return None
    return advice.intervals[name].relative if plan.corrected else advice.errors[name]


def _is_reported(name: str, values: np.ndarray) -> bool:
    """Whether two runs have a value; forces that are zero in all runs, as on a gate without contact, are left out."""
    found = values[np.isfinite(values)]
    return len(found) > 1 and (name in QUANTITIES or bool(found.any()))


def _wall_names(result: Mapping[str, Any]) -> Iterator[str]:
    for wall in result.get("wall_forces") or {}:
        yield from (f"wall_forces.{wall}.{name}" for name in WALL_QUANTITIES)


def _quantity(plan: UncertaintyPlan, name: str, x: np.ndarray, y: np.ndarray) -> Quantity:
    found = np.isfinite(y)
    statistics = statistics_of(y[found])
    error, shares = _grid_error(plan, name), variance_shares(plan.inputs, x[found], y[found], plan.seed)
    if shares and plan.seeds:  # neighbouring runs have different fields
        shares = replace(shares, scatter=None)
    return Quantity(
        name=name,
        unit=unit_of(RESULT, name, plan.means.geometry.model) or "",
        values=y[found],
        statistics=statistics,
        shares=shares,
        grid_deviation=None if error is None else error / NORMAL_90 * abs(statistics.mean),
    )
