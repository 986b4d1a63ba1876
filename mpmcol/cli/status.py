"""`mpmcol status`: progress of a sweep or a run."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from datetime import datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import json_option, results_argument

if TYPE_CHECKING:
    from mpmcol.sweep.plan import Plan
    from mpmcol.sweep.progress import TrackedRun

STATUS_SCHEMA = 2
STATUS_TEXTS = {
    "unfinished": "unfinished: the process was killed",
    "stopped": "stopped   by a signal or the wall-clock limit",
    "missing": "not started",
}


@click.command()
@results_argument()
@click.option(
    "--follow", is_flag=True, help="Show progress until all runs have ended; exit with the code of their state."
)
@json_option("the status")
def status(folder: Path, follow: bool, to_json: bool) -> None:
    """Show progress and remaining time of a sweep, study or run.

    DIR is the folder of a sweep or of a single run; the runs of a study are in the folder "runs" inside the study's
    folder. With --follow, progress goes to stderr; the exit code is 0 if all runs are done, 75 if one was
    stopped, 5 if one is damaged, 3 if one diverged, and 1 otherwise. Without it the exit code is 0 in every state.
    """
    from mpmcol.cli.follow import follow_runs, state_code
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.progress import ProgressTracker, find_plan

    plan, root = find_plan(folder)
    tracker = ProgressTracker(root, plan)
    if follow:
        follow_runs(tracker)
    runs = tracker.runs()
    if to_json:
        click.echo(as_json(_record(folder, plan, runs)))
    else:
        click.echo("\n".join(_lines(folder, plan, runs)))
    if follow:
        click.get_current_context().exit(state_code(runs))


def _record(folder: Path, plan: Plan, runs: list[TrackedRun]) -> dict[str, Any]:
    from mpmcol.sweep.progress import count_by_status, time_left

    return {
        "schema": STATUS_SCHEMA,
        "folder": str(folder),
        "version": plan.version or _version_of(runs[0]),
        "counts": count_by_status(runs),
        "seconds_left": time_left(runs, plan.jobs),
        "runs": [
            {"folder": run.entry.folder, "inputs": run.entry.inputs, "status": run.status.name,
             "progress": run.progress, "seconds": run.seconds, "message": run.status.failure}
            for run in runs
        ],
    }  # fmt: skip


def _version_of(run: TrackedRun) -> str | None:
    """The version that ended a single run; null while it runs."""
    return ((run.status.result or {}).get("versions") or {}).get("mpmcol")


def _lines(folder: Path, plan: Plan, runs: list[TrackedRun]) -> Iterator[str]:
    from mpmcol.provenance import code_version
    from mpmcol.sweep.progress import count_by_status, time_left
    from mpmcol.units import duration_text

    counts = ", ".join(f"{count} {name}" for name, count in count_by_status(runs).items())
    yield f"{folder}: {plan.title or 'untitled'}, {counts}"
    width = max(len(run.entry.folder) for run in runs)
    for run in runs:
        yield f"  {run.entry.folder:{width}}  {_status_text(run)}".rstrip()
    found, left = {run.status.name for run in runs}, time_left(runs, plan.jobs)
    if "running" in found and left is not None:
        end = datetime.now() + timedelta(seconds=left)
        yield f"about {duration_text(left)} left, until {end:%H:%M}"
    elif "running" not in found and found - {"done", "failed"}:
        cost = "" if left is None else f", in about {duration_text(left)}"
        yield f"no run is being executed; {_how_to_complete(folder, found)}{cost}"
    if plan.version not in ("", code_version()):
        yield (
            f"note: planned by mpmcol {plan.version}; this is {code_version()}, with which the same command starts new "
            "runs"
        )


def _how_to_complete(folder: Path, found: Collection[str]) -> str:
    """What to do about the runs that have not ended: a sweep replaces a damaged run, a single run does not."""
    from mpmcol.io.names import CHECKPOINT_FILES
    from mpmcol.sweep.plan import PLAN_FILE

    resumes = any((folder / name).exists() for name in CHECKPOINT_FILES)
    if "damaged" not in found or resumes:
        return "repeat the command to complete the missing ones"
    if (folder / PLAN_FILE).exists():
        return "repeat the command to complete the missing ones and to replace the damaged ones"
    return "the result is damaged: run the case again with --fresh"


def _status_text(run: TrackedRun) -> str:
    from mpmcol.units import duration_text

    if run.status.name == "running":
        since = f", resumed at {run.resumed:.0%}" if run.resumed else ""
        return f"running   {run.progress:.0%}, for {duration_text(run.seconds)}{since}"
    if run.status.name == "failed":
        return f"failed    {run.status.failure}"
    if run.status.name == "done":
        return f"done      {duration_text(run.seconds)}"
    if run.status.name == "damaged":
        return f"damaged   result.json: {run.status.problem}"
    return STATUS_TEXTS.get(run.status.name, run.status.name) + _reached_text(run)


def _reached_text(run: TrackedRun) -> str:
    """The end of the history of a run that stopped; "" if it has none."""
    if run.reached is None:
        return ""
    stage, step, time = run.reached
    return f", after step {step:,} at t = {time:.3g} s ({stage})"
