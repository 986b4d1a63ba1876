"""A sweep from its points to their outcomes, in a folder that says what it is doing."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path

from mpmcol.io.run_status import read_status
from mpmcol.provenance import code_version
from mpmcol.sweep.dask_engine import dask_pool
from mpmcol.sweep.engine import Outcome, execute_runs
from mpmcol.sweep.plan import Plan, PlanEntry, prepare_out, write_plan
from mpmcol.sweep.runs import PlannedRun
from mpmcol.sweep.scheduling import Allocation, allocate, cores


class SweepObserver:
    """Is told what happens; this one does nothing with it."""

    def say(self, line: str) -> None:
        """One line for a person."""

    def begin(self, plan: Plan) -> None:
        """The runs are about to start."""

    def ended(self, outcome: Outcome) -> None:
        """A point has ended, or had before."""

    def tick(self) -> None:
        """Some time has gone by."""


def run_sweep(
    points: Sequence[PlannedRun],
    out: Path,
    jobs: int | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    observer: SweepObserver | None = None,
) -> list[Outcome]:
    """Carry out all points in the folder `out`, on this machine or on the cluster of a dask scheduler.

    Returns the outcomes in the order of the points. Raises UsageError if the folder holds something else, OutputError
    if nothing can be written there or no scheduler answers.
    """
    prepare_out(out)
    observer = observer or SweepObserver()
    left = todo(points)
    with ExitStack() as stack:
        pool = stack.enter_context(dask_pool(scheduler, out)) if scheduler and left else None
        shares = Allocation(pool.slots, threads or 1) if pool else allocate(left or points, jobs, threads)
        plan = make_plan(points, shares)
        write_plan(out, plan)
        observer.begin(plan)
        observer.say(introduce(points, left, shares, scheduler))
        runs = stack.enter_context(
            closing(execute_runs(points, shares, pool=pool, say=observer.say, tick=observer.tick))
        )
        outcomes: dict[Path, Outcome] = {}
        for outcome in runs:
            outcomes[outcome.run.folder] = outcome
            observer.ended(outcome)
    return [outcomes[point.folder] for point in points]


def todo(points: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The points that have not ended yet."""
    return [point for point in points if not read_status(point.folder).has_ended]


def make_plan(points: Sequence[PlannedRun], shares: Allocation) -> Plan:
    """What the sweep's folder keeps of the points."""
    kept = tuple(PlanEntry(point.folder.name, point.inputs, point.work, point.end) for point in points)
    return Plan(points[0].case.title, code_version(), shares.jobs, shares.threads, kept)


def introduce(
    points: Sequence[PlannedRun], left: Sequence[PlannedRun], shares: Allocation, scheduler: str | None = None
) -> str:
    """One line: how many points there are, and how they will be run."""
    ended = len(points) - len(left)
    told = f"{len(points)} point{'s' if len(points) > 1 else ''}" + (f", {ended} of them ended before" if ended else "")
    if not left:
        return f"{told}: nothing to run"
    if scheduler:
        return f"{told}: {shares}, on the workers of {scheduler}"
    count = cores()
    over = " (more than there are)" if shares.jobs * shares.threads > count else ""
    return f"{told}: {shares}, on {count} core{'s' if count > 1 else ''}{over}"
