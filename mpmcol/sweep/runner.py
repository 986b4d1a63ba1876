"""A sweep from its planned runs to their outcomes, with its plan in the sweep's folder and reports to an observer."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path

from mpmcol.case.title import title_without_aspect
from mpmcol.io.run_folder import discard_run
from mpmcol.io.run_status import read_status
from mpmcol.provenance import code_version
from mpmcol.setup.cores import available_cores
from mpmcol.sweep.dask_engine import dask_pool
from mpmcol.sweep.engine import KeptPool, Outcome, execute_runs
from mpmcol.sweep.plan import Plan, PlanEntry, prepare_out, write_plan
from mpmcol.sweep.runs import PlannedRun
from mpmcol.sweep.scheduling import Allocation, allocate


class SweepObserver:
    """Receives the events of a sweep; this base class ignores them."""

    def notify(self, line: str) -> None:
        """Receive a one-line message."""

    def started(self, plan: Plan) -> None:
        """The runs are about to start."""

    def run_ended(self, outcome: Outcome) -> None:
        """A run has ended, now or before this sweep."""

    def tick(self) -> None:
        """Called several times a second while runs are executed."""


def run_sweep(
    runs: Sequence[PlannedRun],
    out: Path,
    *,
    jobs: int | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    fresh: bool = False,
    observer: SweepObserver | None = None,
    kept: KeptPool | None = None,
) -> list[Outcome]:
    """Execute all runs in the folder `out`, on this machine or on the cluster of a dask scheduler.

    Returns the outcomes in the order of the runs. With `fresh`, results that these runs have already are discarded.
    kept: processes that serve several sweeps.

    Raises:
        UsageError: the folder contains other files.
        OutputError: the folder cannot be written, or no scheduler answers.
    """
    prepare_out(out)
    observer = observer or SweepObserver()
    if fresh:
        discard_runs(runs)
    pending = pending_runs(runs)
    with ExitStack() as stack:
        pool = stack.enter_context(dask_pool(scheduler, out)) if scheduler and pending else None
        allocation = Allocation(pool.slots, threads or 1) if pool else allocate(pending or runs, jobs, threads)
        pool = pool or (kept.serve(allocation.jobs) if kept and pending else None)
        plan = make_plan(runs, allocation)
        write_plan(out, plan)
        observer.started(plan)
        observer.notify(overview(runs, pending, allocation, scheduler))
        executing = execute_runs(runs, allocation, pool=pool, notify=observer.notify, tick=observer.tick)
        outcomes: dict[Path, Outcome] = {}
        for outcome in stack.enter_context(closing(executing)):
            outcomes[outcome.run.folder] = outcome
            observer.run_ended(outcome)
    return [outcomes[run.folder] for run in runs]


def discard_runs(runs: Sequence[PlannedRun]) -> None:
    """Remove the results of runs, finished or not. Raises OutputError, also if one of them is being executed."""
    for run in runs:
        discard_run(run.folder)


def pending_runs(runs: Sequence[PlannedRun]) -> list[PlannedRun]:
    """The runs that have not ended."""
    return [run for run in runs if not read_status(run.folder).has_ended]


def make_plan(runs: Sequence[PlannedRun], allocation: Allocation) -> Plan:
    """The plan that is stored in the sweep's folder."""
    entries = tuple(PlanEntry(run.folder.name, run.inputs, run.cost, run.end) for run in runs)
    return Plan(title_without_aspect(runs[0].case.title), code_version(), allocation.jobs, allocation.threads, entries)


def overview(
    runs: Sequence[PlannedRun], pending: Sequence[PlannedRun], allocation: Allocation, scheduler: str | None = None
) -> str:
    """One line: the number of runs, and how they are executed."""
    ended = len(runs) - len(pending)
    counts = f"{len(runs)} run{'s' if len(runs) > 1 else ''}" + (f", {ended} already finished" if ended else "")
    if not pending:
        return f"{counts}: nothing to run"
    if scheduler:
        return f"{counts}: {allocation}, on the workers of {scheduler}"
    cores = available_cores()
    over = " (more threads than cores)" if allocation.jobs * allocation.threads > cores else ""
    return f"{counts}: {allocation}, on {cores} core{'s' if cores > 1 else ''}{over}"
