"""Runs of the case for values of the unknowns, on two grids: a coarse one for the search and one for the answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.io.results import Results
from mpmcol.measure import Measurement
from mpmcol.studies.convergence import NORMAL_90
from mpmcol.studies.fit.course import course_of
from mpmcol.studies.fit.quantities import AS_COMPUTED, GridFactors, Target, measured_deposit, scalars_of
from mpmcol.studies.fit.unknowns import SPACING, Unknown, settings
from mpmcol.studies.pareto.error_interval import ErrorInterval, error_intervals
from mpmcol.studies.pareto.recommend import Recommendation, options, recommend
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import neighbouring_cases, parameters_of
from mpmcol.studies.pareto.studied import studied_error
from mpmcol.studies.runs import CFL, SNAPSHOTS, repeated_cfl
from mpmcol.sweep.engine import KeptPool, unsuccessful
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run

FINER = 0.03  # relative difference of the spacings of repeated runs, at least one cell in r_i
ROUNDING = 1e-6  # of r_i / h
ACCURACIES = (0.2, 0.1)  # of the search, on coarse grids
LEAST_GRID_ERROR = 0.01  # relative: convergence with the spacing is not smooth enough for less


@dataclass(frozen=True)
class Level:
    """A configuration of the case for all runs of a part of the search.

    intervals: of the relative error of the grid by quantity of the shipped study; None: not studied.
    differences: of the case from those of the study, whose errors may not apply to it.
    """

    name: str
    overrides: tuple[str, ...]
    cells: float  # r_i / h
    intervals: Mapping[str, ErrorInterval] | None
    text: str
    variant: str = ""  # of the study
    differences: tuple[str, ...] = ()

    @property
    def factors(self) -> GridFactors:
        """Correction of runout and height for the error of the grid."""
        if self.intervals is None:
            return AS_COMPUTED
        return GridFactors(self.intervals[ZETA].factor, self.intervals[BETA].factor)

    @property
    def errors(self) -> dict[str, float] | None:
        """Relative standard errors of the corrected "runout" and "height" by the grid."""
        if self.intervals is None:
            return None
        names = {"runout": ZETA, "height": BETA}
        return {name: max(self.intervals[own].relative / NORMAL_90, LEAST_GRID_ERROR) for name, own in names.items()}


@dataclass(frozen=True)
class Evaluation:
    """Repeated runs for one set of values of the unknowns."""

    level: Level
    shares: np.ndarray  # (n,) values of the unknowns in their ranges, 0 to 1
    values: np.ndarray  # (runs, m) targets, corrected for the error of the grid
    deposits: tuple[Measurement, ...]
    folders: tuple[Path, ...]
    at_rest: bool
    core_seconds: float
    courses: tuple[Mapping[str, float], ...] = ()  # of each run: quantities of the collapse in time

    @property
    def mean(self) -> np.ndarray:
        """Mean of the targets (m,)."""
        return np.asarray(self.values.mean(axis=0))

    @property
    def quantities(self) -> list[dict[str, float]]:
        """All quantities of each run."""
        courses = self.courses or ({},) * len(self.deposits)
        return [{**scalars_of(one), **course} for one, course in zip(self.deposits, courses, strict=True)]


@dataclass(frozen=True)
class Forward:
    """Runs a case for values of its unknowns in the folder `out`; runs that have ended there are not repeated."""

    source: str | Path
    overrides: tuple[str, ...]
    unknowns: tuple[Unknown, ...]
    targets: tuple[Target, ...]
    out: Path
    repeats: int
    kept: KeptPool
    jobs: int | None = None
    threads: int | None = None
    fresh: bool = False
    observer: SweepObserver | None = None

    def evaluate(self, level: Level, shares: Sequence[np.ndarray]) -> list[Evaluation]:
        """Run the case for several sets of values at once.

        Raises an MpmcolError with the exit code of the runs if none of a set was successful.
        """
        planned = [self.planned(level, one) for one in shares]
        outcomes = run_sweep(
            [run for runs in planned for run in runs], self.out,
            jobs=self.jobs, threads=self.threads, fresh=self.fresh, observer=self.observer, kept=self.kept,
        )  # fmt: skip
        done = {one.run.folder for one in outcomes if one.status == "done"}
        for runs in planned:
            if not any(run.folder in done for run in runs):
                own = [one for one in outcomes if one.run.folder in {run.folder for run in runs}]
                raise unsuccessful(own, f"no run with {_named(runs[0])} was successful: {own[0].result.message}")
        return [
            self._evaluation(level, one, [run.folder for run in runs if run.folder in done])
            for one, runs in zip(shares, planned, strict=True)
        ]

    def planned(self, level: Level, shares: np.ndarray) -> list[PlannedRun]:
        """Repeated runs, which differ in time step and spacing by a few per cent."""
        values = settings(self.unknowns, shares)
        base = load_case(self.source, [*self.overrides, *level.overrides, *values])
        cfl, step = repeated_cfl(base.time.cfl, self.repeats), max(1, round(FINER * level.cells))
        planned = []
        for number in range(self.repeats):
            h = base.geometry.r_i / (ceil(level.cells - ROUNDING) + number * step)
            grid = {SPACING: f"{h:.9g}", CFL: cfl[number], SNAPSHOTS: "1"}
            texts = [*self.overrides, *level.overrides, *values, *(f"{key}={text}" for key, text in grid.items())]
            inputs = {one.key: one.at(float(share)) for one, share in zip(self.unknowns, shares, strict=True)}
            names = [f"{one.name}-{inputs[one.key]:g}" for one in self.unknowns]
            name = "-".join([level.name, *names, f"{number + 1}"])
            planned.append(plan_run(load_case(self.source, texts), self.out, {**inputs, SPACING: h}, name))
        return planned

    def _evaluation(self, level: Level, shares: np.ndarray, folders: Sequence[Path]) -> Evaluation:
        results = [Results(folder) for folder in folders]
        deposits = tuple(measured_deposit(one) for one in results)
        courses = tuple(course_of(one) for one in results)
        values = values_of(self.targets, deposits, courses, level.factors)
        if not np.isfinite(values).all():
            raise UsageError(
                f"{folders[0]}: the deposit has no value of one of the measured quantities (a repose angle needs a "
                "flank of several cells); narrow the range of the unknowns, or use other quantities"
            )
        return Evaluation(
            level, shares, values, deposits, tuple(folders), all(one.came_to_rest for one in results),
            sum(float(one.summary["core_seconds"]) for one in results), courses,
        )  # fmt: skip


def values_of(
    targets: Sequence[Target],
    deposits: Sequence[Measurement],
    courses: Sequence[Mapping[str, float]],
    factors: GridFactors,
) -> np.ndarray:
    """Values (runs, m) of the targets in runs, corrected for the error of the grid."""
    return np.array(
        [
            np.concatenate([target.of(deposit, course, factors) for target in targets])
            for deposit, course in zip(deposits, courses, strict=True)
        ]
    )


def levels_for(accuracy: float | None) -> list[float | None]:
    """Accuracies of the levels of a search, the last of which gives the answer; None: the grid of the case."""
    return [None] if accuracy is None else [*(one for one in ACCURACIES if one > 1.5 * accuracy), accuracy]


def make_level(
    source: str | Path, overrides: Sequence[str], unknowns: Sequence[Unknown], shares: np.ndarray,
    accuracy: float | None, number: int,
) -> Level:  # fmt: skip
    """The configuration of level `number`, chosen for values of the unknowns.

    Where the study has none within the accuracy, it is the most accurate one.

    Raises:
        UsageError: the study has none for this case, or an unknown is a key that configurations of the study set.
    """
    values = [*overrides, *settings(unknowns, shares)]
    if accuracy is None:
        return _own_level(source, values)
    return _level(f"level{number}", _advice(source, values, accuracy), unknowns)


def level_at(
    source: str | Path, overrides: Sequence[str], unknowns: Sequence[Unknown], shares: np.ndarray, level: Level
) -> Level:
    """The same runs with the error of the grid at other values of the unknowns."""
    if level.intervals is None:
        return level
    case = load_case(source, [*overrides, *level.overrides, *settings(unknowns, shares)])
    cases = neighbouring_cases(parameters_of(case))
    return replace(level, intervals=error_intervals(level.variant, level.cells, cases))


def _advice(source: str | Path, overrides: Sequence[str], accuracy: float) -> Recommendation:
    """The cheapest configuration whose corrected values have an accuracy, or the most accurate one."""
    try:
        return recommend(source, overrides, accuracy, corrected=True)
    except UsageError:
        known = list(options(source, overrides))
        if not known:
            raise
        return min(known, key=lambda one: one.corrected_error)


def _level(name: str, advice: Recommendation, unknowns: Sequence[Unknown]) -> Level:
    for one in unknowns:
        if one.key in advice.values:
            raise UsageError(f"{one.key} is set by --accuracy; omit --accuracy, or set it and vary another key")
    differences, intervals = tuple(map(str, advice.differences)), advice.intervals
    text = (
        f'"{advice.variant}" at r_i/h = {advice.cells:g}, error in the study {intervals[ZETA]} in runout and '
        f"{intervals[BETA]} in height"
    )
    return Level(name, tuple(advice.overrides), advice.cells, intervals, text, advice.variant, differences)


def _own_level(source: str | Path, values: Sequence[str]) -> Level:
    case = load_case(source, values)
    studied, cells = studied_error(case), case.geometry.r_i / case.grid.spacing
    text = f"the grid of the case, r_i/h = {cells:g}"
    if studied is None:
        return Level("level1", (), cells, None, text)
    return Level("level1", (), cells, studied.intervals, text, studied.variant)


def _named(run: PlannedRun) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in run.inputs.items() if key != SPACING)
