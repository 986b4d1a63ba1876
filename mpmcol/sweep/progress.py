"""Progress of a sweep and its remaining time, from the files of its runs."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from mpmcol.errors import OutputError
from mpmcol.io.names import CASE_FILE, GIVEN_CASE_FILE
from mpmcol.io.run_status import Moment, RunStatus, last_moment, read_status, resumed_at, running_for, time_reached
from mpmcol.sweep.plan import PLAN_FILE, Plan, PlanEntry, read_plan

MOST_PROGRESS = 0.95  # of a run that has not ended, also if it takes longer than estimated


@dataclass(frozen=True)
class TrackedRun:
    """A run of the plan with its present status."""

    entry: PlanEntry
    status: RunStatus
    progress: float  # share of its work that is done, 0 to 1
    seconds: float  # wall-clock time of it; of a run that is executed since it was started or resumed
    resumed: float = 0.0  # share of its work that was done before these seconds
    reached: Moment | None = None  # of a run that stopped before its end: the last row of its history

    @property
    def cost_left(self) -> float:
        """What is left of its cost."""
        return self.entry.cost * (1.0 - self.progress)


@dataclass
class ProgressTracker:
    """Reads the status of the runs of a plan; runs that have ended are read once."""

    out: Path
    plan: Plan
    _ended: dict[str, TrackedRun] = field(default_factory=dict)

    def runs(self) -> list[TrackedRun]:
        """Every run with its present status."""
        return [self._ended.get(entry.folder) or self._read(entry) for entry in self.plan.runs]

    def _read(self, entry: PlanEntry) -> TrackedRun:
        folder = self.out / entry.folder
        status = read_status(folder)
        if status.has_ended:
            self._ended[entry.folder] = TrackedRun(entry, status, 1.0, status.seconds)
            return self._ended[entry.folder]
        if status.name != "running":
            return TrackedRun(entry, status, 0.0, 0.0, reached=last_moment(folder))
        resumed = _share(resumed_at(folder), entry)
        progress = max(_share(time_reached(folder) or 0.0, entry), resumed)
        return TrackedRun(entry, status, progress, running_for(folder), resumed)


def _share(time: float, entry: PlanEntry) -> float:
    """Share of the work of a run that is done at a time since release."""
    return min(max(time, 0.0) / entry.end, MOST_PROGRESS)


def find_plan(folder: Path) -> tuple[Plan, Path]:
    """The plan of a sweep, or a plan with the single run in this folder, and the folder that the runs are in.

    Raises:
        OutputError: the folder contains neither, or the plan or the case is damaged.
    """
    if (folder / PLAN_FILE).exists():
        return read_plan(folder), folder
    case = next((folder / name for name in (CASE_FILE, GIVEN_CASE_FILE) if (folder / name).exists()), None)
    if case is None:
        raise OutputError(f"{folder}: expected the folder of a sweep (with {PLAN_FILE}) or of a run (with {CASE_FILE})")
    from mpmcol.case.title import title_of
    from mpmcol.io.stored_case import read_stored_case
    from mpmcol.sweep.runs import PlannedRun

    run = PlannedRun({}, read_stored_case(case), folder.resolve())
    entry = PlanEntry(run.folder.name, {}, run.cost, run.end)
    return Plan(title_of(run.case), "", 1, 1, (entry,)), run.folder.parent


def total_progress(runs: list[TrackedRun]) -> float:
    """Share of the work of all runs that is done, 0 to 1."""
    return 1.0 - sum(run.cost_left for run in runs) / sum(run.entry.cost for run in runs)


def time_left(runs: list[TrackedRun], jobs: int) -> float | None:
    """Estimated seconds until all runs have ended, from the mean speed so far; None without any progress.

    The remaining work is distributed evenly over the jobs, but a single run is never split.
    """
    timed = [run for run in runs if run.seconds > 0.0 and run.progress > run.resumed and run.status.name != "failed"]
    done = sum(run.entry.cost * (run.progress - run.resumed) for run in timed)
    if not done:
        return None
    left = [run.cost_left for run in runs]
    return max(sum(left) / jobs, max(left)) * sum(run.seconds for run in timed) / done


def count_by_status(runs: list[TrackedRun]) -> dict[str, int]:
    """Number of runs with each status."""
    return dict(Counter(run.status.name for run in runs))
