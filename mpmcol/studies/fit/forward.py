"""Runs of the case for values of the unknowns, on the grid of a level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path

import numpy as np

from mpmcol.case import load_case
from mpmcol.errors import UsageError
from mpmcol.io.results import Results
from mpmcol.measure import Measurement
from mpmcol.studies.fit.course import course_of
from mpmcol.studies.fit.levels import Level
from mpmcol.studies.fit.quantities import GridFactors, Target, measured_deposit, scalars_of
from mpmcol.studies.fit.unknowns import SPACING, Unknown, settings
from mpmcol.studies.runs import CFL, SNAPSHOTS, repeated_cfl
from mpmcol.sweep.engine import KeptPool, unsuccessful
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run

FINER = 0.03  # relative difference of the spacings of repeated runs, at least one cell in r_i
ROUNDING = 1e-6  # of r_i / h


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
    courses: tuple[Mapping[str, float], ...]  # of each run: quantities of the collapse in time

    @property
    def mean(self) -> np.ndarray:
        """Mean of the targets (m,)."""
        return np.asarray(self.values.mean(axis=0))

    @property
    def quantities(self) -> list[dict[str, float]]:
        """All quantities of each run."""
        return [{**scalars_of(one), **course} for one, course in zip(self.deposits, self.courses, strict=True)]


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
        if name := _without_value(self.targets, deposits, courses):
            raise UsageError(
                f"{folders[0]}: the run has no value of {name} (a repose angle needs a flank of several cells, a stop "
                "time a front that stops); narrow the range of the unknowns, or use other quantities"
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


def _without_value(
    targets: Sequence[Target], deposits: Sequence[Measurement], courses: Sequence[Mapping[str, float]]
) -> str:
    """Name of the first target that a run does not have; "" if there is none."""
    runs = list(zip(deposits, courses, strict=True))
    names = (target.name for target in targets for run in runs if not np.isfinite(target.of(*run)).all())
    return next(names, "")


def _named(run: PlannedRun) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in run.inputs.items() if key != SPACING)
