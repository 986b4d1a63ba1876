"""The runs of a sweep before they are executed: the forecast of `--dry-run`, and shell commands."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mpmcol.sweep.runs import PlannedRun

FORECAST_SCHEMA = 1


def print_forecast(
    runs: list[PlannedRun], jobs: int | None, threads: int | None, *, fresh: bool, to_json: bool, quiet: bool
) -> None:
    """Print sizes, steps and times of the runs; nothing is run."""
    from mpmcol.cli.run_display import MEASURING_SPEED
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.runner import overview, pending_runs
    from mpmcol.sweep.scheduling import allocate, estimate_seconds, makespan
    from mpmcol.units import duration_text

    if not quiet:
        click.echo(MEASURING_SPEED, err=True)
    pending = runs if fresh else pending_runs(runs)
    allocation = allocate(pending or runs, jobs, threads)
    times = estimate_seconds(pending, allocation.threads)
    seconds = dict(zip((run.folder for run in pending), times, strict=True))
    total = makespan(times, allocation.jobs)
    if to_json:
        rows = [
            {"folder": run.folder.name, "inputs": run.inputs, "points": run.discretization.most_points,
             "steps": run.steps, "seconds": seconds.get(run.folder)}
            for run in runs
        ]  # fmt: skip
        counts = {"jobs": allocation.jobs, "threads": allocation.threads, "seconds": total}
        click.echo(as_json({"schema": FORECAST_SCHEMA, **counts, "runs": rows}))
        return
    click.echo("\n".join(_forecast_lines(runs, seconds)))
    click.echo(overview(runs, pending, allocation))
    click.echo(f"about {duration_text(total)} in total; nothing was run" if pending else "nothing was run")


def _forecast_lines(runs: list[PlannedRun], seconds: dict[Path, float]) -> Iterator[str]:
    from mpmcol.units import duration_text

    width = max(len(run.name) for run in runs)
    for run in runs:
        time: Any = seconds.get(run.folder)
        cost = "finished" if time is None else f"about {duration_text(time)}"
        yield f"{run.name:{width}}  {run.discretization.most_points:10,} points  {run.steps:9,} steps  {cost}"


def print_commands(runs: list[PlannedRun], out: Path, threads: int | None, *, fresh: bool, quiet: bool) -> None:
    """Print the commands on stdout and messages on stderr, so that the commands can be piped."""
    from mpmcol.sweep.commands import SLURM_FILE, write_commands
    from mpmcol.sweep.plan import prepare_out, write_plan
    from mpmcol.sweep.runner import discard_runs, make_plan, pending_runs
    from mpmcol.sweep.scheduling import Allocation

    if fresh:
        discard_runs(runs)
    pending = pending_runs(runs)
    if not pending:
        click.echo("all runs are finished; for table and charts repeat the command without --engine", err=True)
        return
    allocation = Allocation(len(pending), threads or 1)
    write_plan(prepare_out(out), make_plan(runs, allocation))
    click.echo("\n".join(write_commands(pending, allocation.threads, out)))
    if not quiet:
        click.echo(f"{len(pending)} runs to execute; with Slurm: sbatch {quote(str(out / SLURM_FILE))}", err=True)
        click.echo("then, for table and charts, repeat the command without --engine", err=True)
