"""Cost of each configuration of a study, and its errors relative to the grid-converged values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpmcol.measure.profile_distance import area_between, mean_height
from mpmcol.studies.pareto.reference import PROFILE, QUANTITIES, ConvergedReference, make_reference
from mpmcol.studies.pareto.study import Configuration, StudyDefinition
from mpmcol.studies.runs import CompletedRun, EndedRuns

ZETA, BETA = "zeta.front_height", "beta"
COSTS = ("core_seconds", "point_steps", "peak_memory_bytes", "written_bytes")
P90 = 1.28  # standard deviations: 90 % of normally distributed values are below the mean plus this


@dataclass(frozen=True)
class RelativeError:
    """Relative error of the runs of a configuration in one quantity."""

    bias: float  # error of their mean
    scatter: float  # standard deviation of one run
    runs: int

    @property
    def p90(self) -> float:
        """Magnitude of the error that about 90 % of runs do not exceed."""
        return abs(self.bias) + P90 * self.scatter


@dataclass(frozen=True)
class ScoredConfiguration:
    """A configuration with its successful runs, their errors, and the causes of failed runs."""

    configuration: Configuration
    runs: Sequence[CompletedRun]
    errors: Mapping[str, RelativeError]  # by quantity; empty without runs or reference
    failures: Sequence[str]  # message of each failed run

    @property
    def causes(self) -> str:
        """Causes of failed runs, each once."""
        return "; ".join(dict.fromkeys(self.failures))

    @property
    def is_complete(self) -> bool:
        """Whether all runs were carried out successfully."""
        return len(self.runs) == len(self.configuration.runs)

    @cached_property
    def cost(self) -> dict[str, float]:
        """Cost of one run: least CPU time without compilation, points times steps, peak memory, bytes written."""
        rows = [run.row for run in self.runs]
        return {
            "core_seconds": min(row["core_seconds"] for row in rows),
            "point_steps": float(np.mean([row["points"] * row["steps"] for row in rows])),
            "peak_memory_bytes": float(max(row["peak_memory_bytes"] for row in rows)),
            "written_bytes": float(np.mean([_size(run) for run in self.runs])),
        }


def make_references(
    study: StudyDefinition, configurations: Sequence[Configuration], ended: EndedRuns
) -> dict[str, ConvergedReference]:
    """Make the reference of each case for which there are enough runs."""
    levels: dict[tuple[str, str], dict[float, list[CompletedRun]]] = {(c.case, c.variant): {} for c in configurations}
    for one in configurations:
        if runs := ended.completed_of(one.runs):
            levels[one.case, one.variant][one.cells] = runs
    references = {case: make_reference([levels[case, variant] for variant in study.reference]) for case in study.cases}
    return {case: reference for case, reference in references.items() if reference}


def score(configuration: Configuration, ended: EndedRuns, reference: ConvergedReference | None) -> ScoredConfiguration:
    """Compute the errors of the runs of a configuration."""
    runs = ended.completed_of(configuration.runs)
    errors = _errors(runs, reference) if runs and reference else {}
    failures = [ended.failures[run] for run in configuration.runs if run in ended.failures]
    return ScoredConfiguration(configuration, runs, errors, failures)


def _errors(runs: Sequence[CompletedRun], reference: ConvergedReference) -> dict[str, RelativeError]:
    errors = {}
    for quantity in QUANTITIES:
        ratios = np.array([run.row[quantity] for run in runs]) / reference.values[quantity].value
        errors[quantity] = RelativeError(float(ratios.mean()) - 1.0, _deviation(ratios), len(runs))
    heights = [mean_height([run.results.measure(-1)], reference.x) for run in runs]
    areas = np.array([area_between(height, reference.height) for height in heights])
    return errors | {PROFILE: RelativeError(float(areas.mean()), _deviation(areas), len(runs))}


def _deviation(values: np.ndarray) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else 0.0


def _size(run: CompletedRun) -> int:
    return sum(path.stat().st_size for path in run.folder.rglob("*") if path.is_file())
