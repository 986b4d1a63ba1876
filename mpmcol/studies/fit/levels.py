"""Grids of a fit: coarse ones for the search and one for the answer, with their errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.fit.quantities import AS_COMPUTED, GridErrors, GridFactors, Target
from mpmcol.studies.fit.unknowns import Unknown, settings
from mpmcol.studies.pareto.error_interval import ErrorInterval, error_intervals
from mpmcol.studies.pareto.recommend import Recommendation, options, recommend
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import parameters_of
from mpmcol.studies.pareto.studied import studied_error

ACCURACIES = (0.2, 0.1)  # of the search, on coarse grids
LEAST_GRID_ERROR = 0.01  # relative: convergence with the spacing is not smooth enough for less


@dataclass(frozen=True)
class StudiedGrid:
    """Errors of runs on a grid, by quantity of the shipped study.

    bounds: relative errors that 90 % of runs do not exceed. intervals: of the relative errors, with their sign.
    """

    variant: str
    bounds: Mapping[str, float]
    intervals: Mapping[str, ErrorInterval]


@dataclass(frozen=True)
class Level:
    """A configuration of the case for all runs of a part of the search.

    differences: of the case from those of the study, whose errors may not apply to it.
    """

    name: str
    overrides: tuple[str, ...]
    cells: float  # r_i / h
    text: str
    studied: StudiedGrid | None = None
    differences: tuple[str, ...] = ()

    @property
    def factors(self) -> GridFactors:
        """Correction of runout and height for the error of the grid."""
        if self.studied is None:
            return AS_COMPUTED
        return GridFactors(*(self.studied.intervals[name].factor for name in (ZETA, BETA)))

    @property
    def errors(self) -> GridErrors | None:
        """Relative standard errors of runout and height by the grid; None if they are not known."""
        if self.studied is None:
            return None
        corrected = {name: one.relative for name, one in self.studied.intervals.items()}
        pairs = ((own[ZETA], own[BETA]) for own in (corrected, self.studied.bounds))
        return GridErrors(*(_standard_error(error) for pair in pairs for error in pair))


def _standard_error(error: float) -> float:
    """The standard error of which 90 % of errors are not larger than this one."""
    return max(error / NORMAL_90, LEAST_GRID_ERROR)


def levels_for(accuracy: float | None) -> list[float | None]:
    """Accuracies of the levels of a search, the last of which gives the answer; None: the grid of the case."""
    return [None] if accuracy is None else [*(one for one in ACCURACIES if one > 1.5 * accuracy), accuracy]


def make_level(
    source: str | Path, overrides: Sequence[str], unknowns: Sequence[Unknown], targets: Sequence[Target],
    shares: np.ndarray, accuracy: float | None, number: int,
) -> Level:  # fmt: skip
    """The configuration of level `number`, chosen for values of the unknowns.

    If all targets are corrected for the error of the grid, the accuracy is that of corrected values. Where the study
    has no configuration within the accuracy, it is the most accurate one.

    Raises:
        UsageError: the study has none for this case, or an unknown is a key that configurations of the study set.
    """
    values = [*overrides, *settings(unknowns, shares)]
    if accuracy is None:
        return _own_level(source, values)
    corrected = all(target.is_corrected for target in targets)
    return _level(f"level{number}", _advice(source, values, accuracy, corrected), unknowns)


def level_at(
    source: str | Path, overrides: Sequence[str], unknowns: Sequence[Unknown], shares: np.ndarray, level: Level
) -> Level:
    """The same runs with the error of the grid at other values of the unknowns."""
    if level.studied is None:
        return level
    case = load_case(source, [*overrides, *level.overrides, *settings(unknowns, shares)])
    intervals = error_intervals(level.studied.variant, level.cells, parameters_of(case))
    return replace(level, studied=replace(level.studied, intervals=intervals))


def _advice(source: str | Path, overrides: Sequence[str], accuracy: float, corrected: bool) -> Recommendation:
    """The cheapest configuration within an accuracy, or the most accurate one, whose error the answer contains."""
    try:
        return recommend(source, overrides, accuracy, corrected)
    except UsageError:
        known = list(options(source, overrides))
        if not known:
            raise
        return min(known, key=lambda one: one.corrected_error if corrected else one.error)


def _level(name: str, advice: Recommendation, unknowns: Sequence[Unknown]) -> Level:
    for one in unknowns:
        if one.key in advice.values:
            raise UsageError(f"{one.key} is set by --accuracy; omit --accuracy, or set it and vary another key")
    studied = StudiedGrid(advice.variant, advice.errors, advice.intervals)
    text = (
        f'"{advice.variant}" at r_i/h = {advice.cells:g}, error in the study {studied.intervals[ZETA]} in runout and '
        f"{studied.intervals[BETA]} in height"
    )
    return Level(name, tuple(advice.overrides), advice.cells, text, studied, tuple(map(str, advice.differences)))


def _own_level(source: str | Path, values: Sequence[str]) -> Level:
    case = load_case(source, values)
    found, cells = studied_error(case), case.geometry.r_i / case.grid.spacing
    studied = None if found is None else StudiedGrid(found.variant, found.errors, found.intervals)
    return Level("level1", (), cells, f"the grid of the case, r_i/h = {cells:g}", studied)
