"""Criteria of the map: when a run passes, when it degrades, when it fails.

A run *fails* if it did not end successfully: the simulation diverged, or its process crashed. It *degrades* if a
metric exceeds its limit, and *passes* otherwise. The metrics, the larger the worse, are

* `zeta`, `beta`: error of runout (front_height) and height, relative to the mean of the case's own method on a finer
  grid; `profile`: the area between the deposit and that on the finer grid, over its area;
* `detachment`: distance of the farthest point ahead of the front, over the front: points that were ejected;
* `volume`: largest |J - 1| of any point at any time;
* `step_reduction`: the share by which the time step decreased.

The limit of a metric follows from repeated runs of the case's own method at the spacing of the map: 1.5 times their
mean plus 4 standard deviations, widened for one further run. It is at least a floor: the scatter of experiments (10 %
in runout, 5 % in height and profile), or what no well-behaved run exceeds. A choice therefore degrades if it adds more
than half of the error of the grid, and no run degrades by scatter alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from shlex import quote
from typing import Literal, NamedTuple

import numpy as np

from mpmcol.errors import OutputError
from mpmcol.io.run_status import read_status
from mpmcol.measure import Array, Measurement
from mpmcol.measure.profile_distance import area_between, mean_height, stations
from mpmcol.studies.method_map.points import MapPoint
from mpmcol.studies.runs import CompletedRun, EndedRuns
from mpmcol.sweep.engine import Outcome

MEAN_FACTOR = 1.5  # on the mean of the own method
DEVIATIONS = 4.0  # standard deviations of the own method
FLOORS = {"zeta": 0.1, "beta": 0.05, "profile": 0.05, "detachment": 0.25, "volume": 0.1, "step_reduction": 0.25}

Rating = Literal["passes", "degrades", "fails", "not run"]


class MapObservation(NamedTuple):
    """Quantities of a completed run to which the criteria apply."""

    deposit: Measurement
    volume: float  # largest |J - 1|
    step_reduction: float  # 1 - smallest over largest time step


@dataclass(frozen=True)
class MapReference:
    """Reference of a case: results on the finer grid, and limits of the metrics."""

    zeta: float
    beta: float
    x: Array  # m
    height: Array  # m, at x
    limits: Mapping[str, float]  # by metric
    means: Mapping[str, float]  # of the case's own method, by metric
    deviations: Mapping[str, float]  # standard deviations of the own method
    runs: int  # of the own method


@dataclass(frozen=True)
class Assessment:
    """Rating of a run, its metrics, and those that exceed their limits, the worst first."""

    rating: Rating
    metrics: Mapping[str, float]
    exceeded: Sequence[str] = ()
    cause: str = ""  # of the failure


@dataclass(frozen=True)
class AssessedPoint:
    """A point of the map, its run as far as it has ended, and its assessment."""

    point: MapPoint
    outcome: Outcome | None
    run: CompletedRun | None
    assessment: Assessment

    @property
    def rating(self) -> Rating:
        """Rating of the assessment."""
        return self.assessment.rating

    @property
    def is_gap(self) -> bool:
        """Whether the default method of the case does not pass here."""
        return self.point.is_default and self.rating in ("degrades", "fails")


def observe(run: CompletedRun) -> MapObservation:
    """Read the quantities to which the criteria apply."""
    results = run.results
    low, high = results.summary["worst_J"]
    dt = results.history["dt"]
    return MapObservation(results.measure(-1), max(high - 1.0, 1.0 - low), 1.0 - float(dt.min() / dt.max()))


def make_reference(case: str, own: Sequence[CompletedRun], finer: Sequence[CompletedRun], folder: Path) -> MapReference:
    """Make the reference of a case from runs of its own method, at the spacing of the map and at the finer one.

    Raises OutputError for fewer than two runs at the spacing of the map, or none at the finer one.
    """
    if len(own) < 2 or not finer:
        raise OutputError(
            f"case {case}: {len(own)} runs of its own method and {len(finer)} on the finer grid were successful, "
            "expected at least 2 and 1, since all other runs are compared with them; "
            f"`mpmcol status {quote(str(folder))}` lists the causes"
        )
    return reference_of([observe(run) for run in own], [run.results.measure(-1) for run in finer])


def reference_of(own: Sequence[MapObservation], finer: Sequence[Measurement]) -> MapReference:
    """Return the means on the finer grid, and limits from the metrics of the own method."""
    x = stations([*finer, *(one.deposit for one in own)])
    zeta, beta = (float(np.mean(values)) for values in zip(*map(_zeta_and_beta, finer), strict=True))
    bare = MapReference(zeta, beta, x, mean_height(finer, x), {}, {}, {}, len(own))
    found = [metrics_of(one, bare) for one in own]
    means = {metric: float(np.mean([one[metric] for one in found])) for metric in FLOORS}
    deviations = {metric: float(np.std([one[metric] for one in found], ddof=1)) for metric in FLOORS}
    width = DEVIATIONS * sqrt(1.0 + 1.0 / len(own))
    limits = {
        metric: max(MEAN_FACTOR * means[metric] + width * deviations[metric], floor) for metric, floor in FLOORS.items()
    }
    return MapReference(zeta, beta, x, bare.height, limits, means, deviations, len(own))


def metrics_of(one: MapObservation, reference: MapReference) -> dict[str, float]:
    """Return the metrics of a run."""
    deposit = one.deposit
    zeta, beta = _zeta_and_beta(deposit)
    return {
        "zeta": abs(zeta / reference.zeta - 1.0),
        "beta": abs(beta / reference.beta - 1.0),
        "profile": area_between(mean_height([deposit], reference.x), reference.height),
        "detachment": deposit.front["front_max"] / deposit.front["front_height"] - 1.0,
        "volume": one.volume,
        "step_reduction": one.step_reduction,
    }


def rate(metrics: Mapping[str, float], limits: Mapping[str, float]) -> Assessment:
    """Rate a successful run; a metric that is NaN exceeds every limit."""
    exceeded = [metric for metric, limit in limits.items() if not metrics[metric] <= limit]
    exceeded.sort(key=lambda metric: metrics[metric] / limits[metric], reverse=True)
    return Assessment("degrades" if exceeded else "passes", metrics, exceeded)


def assess(point: MapPoint, ended: EndedRuns, reference: MapReference) -> AssessedPoint:
    """Assess a point of the map by its run."""
    outcome, run = ended.outcomes.get(point.run), ended.completed.get(point.run)
    if run is not None:
        assessment = rate(metrics_of(observe(run), reference), reference.limits)
    elif outcome is not None:
        assessment = Assessment("fails", {}, (), _cause(outcome))
    else:
        assessment = Assessment("not run", {})
    return AssessedPoint(point, outcome, run, assessment)


def _cause(outcome: Outcome) -> str:
    """Return the cause of the failure that the run reports, or how its process ended."""
    result = read_status(outcome.run.folder).result or {}
    return str(result.get("failure", {}).get("cause") or outcome.result.message)


def _zeta_and_beta(deposit: Measurement) -> tuple[float, float]:
    return deposit.zeta["front_height"], deposit.beta
