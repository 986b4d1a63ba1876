"""`mpmcol status`: progress of a sweep or a run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import PATH, format_duration, json_option

if TYPE_CHECKING:
    from mpmcol.sweep.plan import Plan
    from mpmcol.sweep.progress import TrackedRun

STATUS_SCHEMA = 2
STATUS_TEXTS = {
    "unfinished": "unfinished: the process was killed",
    "stopped": "stopped   by a signal or the wall-clock limit",
    "damaged": "damaged: result.json cannot be read",
    "missing": "not started",
}


@click.command()
@click.argument("folder", metavar="DIR", type=PATH)
@json_option("the status")
def status(folder: Path, to_json: bool) -> None:
    """Show progress and remaining time of a sweep, study or run.

    DIR is the folder of a sweep or of a single run; the runs of a study are in the folder "runs" inside the study's
    folder.
    """
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.progress import ProgressTracker, find_plan

    plan, root = find_plan(folder)
    runs = ProgressTracker(root, plan).runs()
    if to_json:
        click.echo(as_json(_record(folder, plan, runs)))
    else:
        click.echo("\n".join(_lines(folder, plan, runs)))


def _record(folder: Path, plan: Plan, runs: list[TrackedRun]) -> dict[str, Any]:
    from mpmcol.sweep.progress import count_by_status, time_left

    return {
        "schema": STATUS_SCHEMA,
        "folder": str(folder),
        "version": plan.version,
        "counts": count_by_status(runs),
        "seconds_left": time_left(runs, plan.jobs),
        "runs": [
            {"folder": run.entry.folder, "inputs": run.entry.inputs, "status": run.status.name,
             "progress": run.progress, "seconds": run.seconds, "message": run.status.failure}
            for run in runs
        ],
    }  # fmt: skip


def _lines(folder: Path, plan: Plan, runs: list[TrackedRun]) -> Iterator[str]:
    from mpmcol.provenance import code_version
    from mpmcol.sweep.progress import count_by_status, time_left

    counts = ", ".join(f"{count} {name}" for name, count in count_by_status(runs).items())
    yield f"{folder}: {plan.title or 'untitled'}, {counts}"
    width = max(len(run.entry.folder) for run in runs)
    for run in runs:
        yield f"  {run.entry.folder:{width}}  {_status_text(run)}".rstrip()
    found, left = {run.status.name for run in runs}, time_left(runs, plan.jobs)
    if "running" in found and left is not None:
        yield f"about {format_duration(left)} left"
    elif "running" not in found and found - {"done", "failed"}:
        cost = "" if left is None else f", in about {format_duration(left)}"
        yield f"no run is being executed; repeat the command to complete the missing ones{cost}"
    if plan.version not in ("", code_version()):
        yield (
            f"note: planned by mpmcol {plan.version}; this is {code_version()}, with which the same command starts new "
            "runs"
        )


def _status_text(run: TrackedRun) -> str:
    if run.status.name == "running":
        return f"running   {run.progress:.0%} in {format_duration(run.seconds)}"
    if run.status.name == "failed":
        return f"failed    {run.status.failure}"
    if run.status.name == "done":
        return f"done      {format_duration(run.seconds)}"
    return STATUS_TEXTS.get(run.status.name, run.status.name)
