"""The runs of a study: shipped cases with some values replaced."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpmcol.case import load_case
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from mpmcol.sweep.engine import Outcome, execute_runs
from mpmcol.sweep.runner import SweepObserver, run_sweep
from mpmcol.sweep.runs import PlannedRun, plan_run
from mpmcol.sweep.table import Row, make_rows

CFL = "time.cfl"
SNAPSHOTS = "output.snapshots"
DEFAULTS = {SNAPSHOTS: "1"}
MOST_REPEATS = 20  # of a run: the last has a little less than half the Courant number


def repeated_cfl(cfl: float, count: int, first: float = 0.0, step: float = -0.03) -> tuple[str, ...]:
    """Return the Courant numbers of repeated runs, as values for `--set`.

    Collapse is sensitive to round-off: the fronts of runs whose time steps differ by a hundredth scatter as if the runs
    were independent. Repetitions therefore differ in `time.cfl` by a few per cent.

    Args:
        first: relative difference of the first value from `cfl`.
        step: relative difference between successive values.
    """
    return tuple(f"{cfl * (1.0 + (first + step * i)):.6g}" for i in range(count))


REPEATED_CFL = repeated_cfl(0.5, 4, first=-0.08, step=0.04)  # 0.46, 0.48, 0.5, 0.52


@dataclass(frozen=True)
class StudyRun:
    """One run: a shipped case with some values replaced. Studies in the same folder share equal runs."""

    case: str
    a: float
    h: float  # requested node spacing, m
    overrides: tuple[tuple[str, str], ...] = tuple(DEFAULTS.items())  # key of the case, value

    def plan(self, out: Path) -> PlannedRun:
        """Return the run as the sweep engine takes it, with its folder in `out`."""
        values: dict[str, Any] = {"geometry.aspect": self.a, "grid.spacing": self.h, **dict(self.overrides)}
        parts = [f"{key.rpartition('.')[2]}-{value}" for key, value in self.overrides if key != SNAPSHOTS]
        name = "-".join((self.case, f"a{self.a:g}", f"h{self.h * 1e3:g}mm", *parts))
        case = load_case(self.case, [f"{key}={value}" for key, value in values.items()])
        return plan_run(case, out, {"case": self.case, **values}, name)


@dataclass(frozen=True)
class CompletedRun:
    """A run that is done: its row in the table of a sweep, and its folder."""

    row: Row
    folder: Path

    @property
    def results(self) -> Results:
        """Everything that the run has written."""
        return Results(self.folder)


CompletedRuns = Mapping[StudyRun, CompletedRun]  # unsuccessful runs are missing


@dataclass(frozen=True)
class EndedRuns:
    """The runs of a study that have ended, successfully or not."""

    folder: Path
    outcomes: Mapping[StudyRun, Outcome]

    @cached_property
    def completed(self) -> CompletedRuns:
        """Runs that are done."""
        rows = make_rows(list(self.outcomes.values()))
        return {
            run: CompletedRun(row, outcome.run.folder)
            for (run, outcome), row in zip(self.outcomes.items(), rows, strict=True)
            if outcome.status == "done"
        }

    @cached_property
    def failures(self) -> Mapping[StudyRun, str]:
        """Messages of the runs that are not done."""
        return {run: one.result.message for run, one in self.outcomes.items() if one.status != "done"}

    def completed_of(self, runs: Iterable[StudyRun]) -> list[CompletedRun]:
        """Return those of the given runs that are done, in the order given."""
        return [self.completed[run] for run in runs if run in self.completed]


def study_run(case: str, a: float, h: float, **overrides: str) -> StudyRun:
    """Make a run with values replaced; a double underscore in a keyword stands for the dot of a key."""
    values = {**DEFAULTS, **{key.replace("__", "."): value for key, value in overrides.items()}}
    return StudyRun(case, a, h, tuple(values.items()))


def carry_out(
    runs: Iterable[StudyRun],
    out: Path,
    *,
    jobs: int | None = None,
    threads: int | None = None,
    fresh: bool = False,
    observer: SweepObserver | None = None,
) -> EndedRuns:
    """Carry out each run once; runs that have ended in the folder `out` are not repeated unless `fresh`."""
    needed = list(dict.fromkeys(runs))
    outcomes = run_sweep(
        [run.plan(out) for run in needed], out, jobs=jobs, threads=threads, fresh=fresh, observer=observer
    )
    return _ended(needed, outcomes, out)


def find_ended(runs: Iterable[StudyRun], out: Path) -> EndedRuns:
    """Return those of the runs that have already ended in the folder `out`; nothing is run."""
    planned = {run: run.plan(out) for run in dict.fromkeys(runs)}
    ended = {run: point for run, point in planned.items() if read_status(point.folder).has_ended}
    return _ended(list(ended), list(execute_runs(list(ended.values()))), out)


def _ended(runs: Sequence[StudyRun], outcomes: Sequence[Outcome], out: Path) -> EndedRuns:
    return EndedRuns(out, dict(zip(runs, outcomes, strict=True)))
