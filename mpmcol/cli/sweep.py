"""`mpmcol sweep`: runs for many values of some keys, with a table, fits and charts."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import (
    accuracy_option,
    aspect_option,
    dry_run_option,
    fresh_option,
    jobs_option,
    json_option,
    out_option,
    overrides_option,
    quiet_option,
    report_option,
    threads_option,
)
from mpmcol.cli.report import report_at_end

if TYPE_CHECKING:
    from mpmcol.sweep.runs import PlannedRun

FORECAST_SCHEMA = 1


@click.command()
@click.argument("case", required=False)
@aspect_option
@click.option(
    "--slope", metavar="VALUES", help="Slope of the base in degrees, for example 0:20:5, the same as "
    "--set geometry.slope_deg=VALUES.",
)  # fmt: skip
@overrides_option
@click.option("--zip", "zipped", is_flag=True, help="Combine the first values of all keys, then the second, and so on.")
@accuracy_option()
@out_option("sweeps/CASE-KEYS")
@fresh_option
@jobs_option
@threads_option
@click.option(
    "--engine", type=click.Choice(["local", "dask", "commands"]), default="local", show_default=True,
    help="Where to run: this machine; a dask cluster; or nowhere: print shell commands and write a Slurm array job.",
)  # fmt: skip
@click.option("--scheduler", metavar="ADDRESS", help="Scheduler of the dask cluster, for example tcp://10.0.0.1:8786.")
@dry_run_option
@report_option
@json_option("table, fits and names of files")
@quiet_option
def sweep(
    case: str | None,
    aspect: str | None,
    slope: str | None,
    overrides: tuple[str, ...],
    zipped: bool,
    accuracy: float | None,
    out: Path | None,
    fresh: bool,
    jobs: int | None,
    threads: int | None,
    engine: str,
    scheduler: str | None,
    dry_run: bool,
    report: bool,
    to_json: bool,
    quiet: bool,
) -> None:
    """Run a case for many values of its keys.

    CASE is a TOML file or the name of a shipped case; by default the cylinder of the paper, with --slope the inclined
    channel. Writes a table, power-law fits and charts of runout and height.

    VALUES are single values and ranges, separated by commas: 0.5:7 (steps of 0.5), 0.5:7:0.25 (steps of 0.25), 0.5:7/14
    (14 values), 0.55,0.9,1.7:3:0.1, plane,axisymmetric. The values of several keys are combined in all ways, unless
    --zip is given.

    With --accuracy, each run gets the configuration that mpmcol run --accuracy chooses for its column; runs that are
    unlike those of the study, such as a higher column, are named.

    Each run has its own results folder. Repeating the command completes missing runs. Ctrl-C and SIGTERM stop the runs
    with a checkpoint (exit code 75).
    """
    _check_engine(engine, scheduler, jobs, to_json, report)
    from mpmcol.api.sweeps import planned_runs
    from mpmcol.sweep.axes import parse_axes
    from mpmcol.sweep.names import sweep_name

    case = case or ("cylinder" if slope is None else "inclined-channel")
    axes, problems = parse_axes(aspect, overrides, slope)
    folder = out or Path("sweeps") / sweep_name(case, axes, accuracy)
    notes: list[str] = []
    runs = planned_runs(case, axes, folder, zipped=zipped, accuracy=accuracy, problems=problems, notify=notes.append)
    if not quiet:
        click.echo("".join(f"{note}\n" for note in notes), err=True, nl=False)
    if dry_run:
        _print_forecast(runs, jobs, threads, fresh=fresh, to_json=to_json, quiet=quiet)
    elif engine == "commands":
        _print_commands(runs, folder, threads, fresh=fresh, quiet=quiet)
    else:
        code = _execute(
            runs, folder, jobs=jobs, threads=threads, scheduler=scheduler, fresh=fresh, to_json=to_json, quiet=quiet
        )
        if report:
            report_at_end(folder, overwrite=fresh, quiet=quiet)
        click.get_current_context().exit(code)


def _check_engine(engine: str, scheduler: str | None, jobs: int | None, to_json: bool, report: bool) -> None:
    """Refuse options that contradict the engine."""
    if (engine == "dask") != (scheduler is not None):
        raise click.UsageError("--engine dask requires --scheduler ADDRESS, and --scheduler requires --engine dask")
    if engine != "local" and jobs is not None:
        raise click.UsageError("--jobs requires --engine local; a cluster schedules its runs itself")
    if engine == "commands" and to_json:
        raise click.UsageError("--json prints results, and --engine commands runs nothing; omit one of them")
    if engine == "commands" and report:
        raise click.UsageError("--report reports results, and --engine commands runs nothing; omit one of them")


def _execute(
    runs: list[PlannedRun],
    out: Path,
    *,
    jobs: int | None,
    threads: int | None,
    scheduler: str | None,
    fresh: bool,
    to_json: bool,
    quiet: bool,
) -> int:
    """Execute the runs, and print what came of them; returns the exit code."""
    from mpmcol.cli.sweep_display import SweepDisplay, as_record, failures, summary_lines
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.report import write_report
    from mpmcol.sweep.runner import run_sweep

    with SweepDisplay(out, quiet) as display:
        outcomes = run_sweep(runs, out, jobs=jobs, threads=threads, scheduler=scheduler, fresh=fresh, observer=display)
    report = write_report(outcomes, out)
    if to_json:
        click.echo(as_json(as_record(report)))
    elif quiet:
        for line in failures(report):
            click.echo(line, err=True)
    else:
        click.echo("\n".join(summary_lines(report)))
    return exit_code(outcomes)


def _print_forecast(
    runs: list[PlannedRun], jobs: int | None, threads: int | None, *, fresh: bool, to_json: bool, quiet: bool
) -> None:
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


def _print_commands(runs: list[PlannedRun], out: Path, threads: int | None, *, fresh: bool, quiet: bool) -> None:
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
