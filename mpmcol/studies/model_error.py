"""Error of the model: difference of grid-converged values of the shipped study from experiments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mpmcol.case import Case, applicable_experiments, conditions_of
from mpmcol.experiments import Experiment, mark
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import converged_values, study_case

IN_STUDY = {"zeta": ZETA, "beta": BETA}


@dataclass(frozen=True)
class ModelError:
    """Difference of the model from one experiment, in one quantity."""

    experiment: str  # author and year, marked if unverified
    expected: float  # value by the law of the experiment for the case
    scatter: float  # relative standard deviation of the experiment
    difference: float | None  # relative, of grid-converged values; the largest in the study; None: not studied

    @property
    def part(self) -> float | None:
        """Part of the interval, relative to the grid-converged value."""
        if self.difference is None:
            return None
        ratio = 1.0 / (1.0 + self.difference)  # experiment over model
        return abs(1.0 - ratio) + NORMAL_90 * self.scatter * ratio


def model_errors(name: str, case: Case, cases: Sequence[str]) -> list[ModelError]:
    """Return the differences of the model from the laboratory experiments that a case can be compared with.

    They are known for the grid-converged values of those `cases` of the study with which these can be compared as well.
    """
    found: dict[tuple[float, float], ModelError] = {}  # records that agree are one experiment
    for experiment in applicable_experiments(case):
        law, expected = experiment.law(name), experiment.expected(name, case.geometry.a)
        if law and expected and experiment.kind == "laboratory":
            label = f"{experiment.citation}{mark(law.verified)}"
            difference = difference_in_study(name, experiment, cases)
            found.setdefault(expected, ModelError(label, expected[0], law.scatter, difference))
    return list(found.values())


def difference_in_study(name: str, experiment: Experiment, cases: Sequence[str]) -> float | None:
    """Relative difference of grid-converged values of the study from an experiment; None if no case is comparable.

    Of several `cases`, that by which the interval of a statement is widest.
    """
    found = [
        converged_values()[one][IN_STUDY[name]] / expected[0] - 1.0
        for one in cases
        if one in converged_values()
        and not experiment.misfit(conditions_of(study_case(one)))
        and (expected := experiment.expected(name, study_case(one).geometry.a))
    ]
    return max(found, key=lambda difference: ModelError("", 0.0, 0.0, difference).part or 0.0, default=None)
