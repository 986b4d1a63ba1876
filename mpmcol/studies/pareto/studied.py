"""Error of the grid of a case, if the shipped study has configurations like it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mpmcol.case import Case
from mpmcol.case.values import leaf_values
from mpmcol.errors import UsageError
from mpmcol.studies.pareto.error_interval import SAME_SPACING, ErrorInterval, error_intervals
from mpmcol.studies.pareto.recommend import differences_from_study, largest_errors, studied_configurations
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import neighbouring_cases, parameters_of, study_case

SAME_SOFTNESS = 1.25  # of rho g h_i / E: a column that is softer by more has not been studied
FURTHER_KEYS = ("geometry.base", "grid.points_per_cell", "geometry.model", "geometry.section")


@dataclass(frozen=True)
class StudiedError:
    """Errors of the configuration of the study that is like a case, or the next coarser one."""

    variant: str
    cells: float  # r_i / h
    errors: Mapping[str, float]  # quantity -> relative error not exceeded by 90 % of runs
    intervals: Mapping[str, ErrorInterval]  # quantity -> interval of the relative error, with its sign
    cases: Sequence[str]  # of the study, between which the case lies
    is_finer: bool = False  # the grid of the case is finer than that of the study

    def __str__(self) -> str:
        return (
            f"{self.intervals[ZETA]} in runout and {self.intervals[BETA]} in height, as in the study at r_i/h = "
            f"{self.cells:g}{' and finer' * self.is_finer}"
        )


def studied_error(case: Case) -> StudiedError | None:
    """Find the errors of the configurations that are like a case in all but size; None if there are none."""
    try:
        column = parameters_of(case)
        cases = neighbouring_cases(column)
    except UsageError:
        return None
    cells = case.geometry.r_i / case.grid.spacing
    groups = studied_configurations(cases)
    coarser = [
        (studied, variant)
        for variant, studied in groups
        if studied <= SAME_SPACING * cells and _is_like(case, variant, cases)
    ]
    if not coarser:
        return None
    studied, variant = max(coarser)
    errors, intervals = largest_errors(groups[variant, studied]), error_intervals(variant, cells, column)
    return StudiedError(variant, studied, errors, intervals, cases, cells > SAME_SPACING * studied)


def _is_like(case: Case, variant: str, cases: list[str]) -> bool:
    there = study_case(cases[0], variant)
    values, others = leaf_values(case), leaf_values(there)
    return (
        not differences_from_study(case, variant, cases)
        and all(values[key] == others[key] for key in FURTHER_KEYS)
        and _softness(case) <= SAME_SOFTNESS * _softness(there)
    )


def _softness(case: Case) -> float:
    return float(case.material.density * case.geometry.gravity * case.geometry.h_i / case.material.youngs_modulus)
