"""`mpmcol sweep`: runs for many values of some keys, with a table, fits and charts."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcol.cli.options import (
    format_duration,
    jobs_option,
    json_option,
    out_option,
    quiet_option,
    report_option,
    threads_option,
)

if TYPE_CHECKING:
    from mpmcol.sweep.runs import PlannedRun

FORECAST_SCHEMA = 1


@click.command()
@click.argument("case", default="lube-cylinder")
@click.option("--aspect", metavar="VALUES", help="Aspect ratios h_i/r_i, the same as --set geometry.aspect=VALUES.")
@click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUES",
    help="Vary or replace a value of the case. May be repeated.",
)  # fmt: skip
@click.option("--zip", "zipped", is_flag=True, help="Combine the first values of all keys, then the second, and so on.")
@out_option("sweeps/NAME")
@jobs_option
@threads_option
@click.option(
    "--engine", type=click.Choice(["local", "dask", "commands"]), default="local", show_default=True,
    help="Where to run: this machine; a dask cluster; or nowhere: print shell commands and write a Slurm array job.",
)  # fmt: skip
@click.option("--scheduler", metavar="ADDRESS", help="Scheduler of the dask cluster, for example tcp://10.0.0.1:8786.")
@click.option("--dry-run", is_flag=True, help="Check all runs and estimate their cost; run and write nothing.")
@report_option
@json_option("table, fits and names of files")
@quiet_option
def sweep(
    case: str,
    aspect: str | None,
    settings: tuple[str, ...],
    zipped: bool,
    out: Path | None,
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

    CASE is a TOML file or the name of a shipped case; by default the cylinder of the paper. Writes a table, power-law
    fits and charts of runout and height.

    VALUES are single values and ranges, separated by commas: 0.5:7 (steps of 0.5), 0.5:7:0.25 (steps of 0.25), 0.5:7/14
    (14 values), 0.55,0.9,1.7:3:0.1, plane,axisymmetric. The values of several keys are combined in all ways, unless
    --zip is given.

    Each run has its own results folder. Repeating the command completes missing runs. Ctrl-C and SIGTERM stop the runs
    with a checkpoint (exit code 75).
    """
    _check_engine(engine, scheduler, jobs, to_json, report)
    from mpmcol.sweep.axes import parse_axes
    from mpmcol.sweep.runs import plan_runs

    axes, problems = parse_axes(aspect, settings)
    folder = out or _default_folder(case, settings, zipped)
    runs = plan_runs(case, axes, folder, zipped, problems)
    if dry_run:
        _print_forecast(runs, jobs, threads, to_json)
    elif engine == "commands":
        _print_commands(runs, folder, threads, quiet)
    else:
        code = _execute(runs, folder, jobs=jobs, threads=threads, scheduler=scheduler, to_json=to_json, quiet=quiet)
        if report:
            _write_report(folder, quiet)
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


def _default_folder(case: str, settings: tuple[str, ...], zipped: bool) -> Path:
    """A folder for each case and each set of values other than the aspect ratio."""
    digest = sha256(repr((sorted(settings), zipped)).encode()).hexdigest()[:6]
    return Path("sweeps") / (f"{Path(case).stem}-{digest}" if settings else Path(case).stem)


def _execute(
    runs: list[PlannedRun],
    out: Path,
    *,
    jobs: int | None,
    threads: int | None,
    scheduler: str | None,
    to_json: bool,
    quiet: bool,
) -> int:
    """Execute the runs, and print what came of them; returns the exit code."""
    from mpmcol.cli.sweep_display import SweepDisplay, as_record, failures, summary_lines
    from mpmcol.sweep.engine import exit_code
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.report import write_report
    from mpmcol.sweep.runner import run_sweep
    from mpmcol.sweep.runs import notes

    with SweepDisplay(out, quiet) as display:
        for note in notes(runs):
            display.notify(f"note: {note}")
        outcomes = run_sweep(runs, out, jobs=jobs, threads=threads, scheduler=scheduler, observer=display)
    report = write_report(outcomes, out)
    if to_json:
        click.echo(as_json(as_record(report)))
    elif quiet:
        for line in failures(report):
            click.echo(line, err=True)
    else:
        click.echo("\n".join(summary_lines(report)))
    return exit_code(outcomes)


def _write_report(folder: Path, quiet: bool) -> None:
    from mpmcol.report import write_report

    path = write_report([folder])
    if not quiet:
        click.echo(f"report in {path}", err=True)


def _print_forecast(runs: list[PlannedRun], jobs: int | None, threads: int | None, to_json: bool) -> None:
    from mpmcol.cli.run_display import MEASURING_SPEED
    from mpmcol.sweep.plan import as_json
    from mpmcol.sweep.runner import overview, pending_runs
    from mpmcol.sweep.runs import notes
    from mpmcol.sweep.scheduling import allocate, estimate_seconds, makespan

    click.echo(MEASURING_SPEED, err=True)
    pending = pending_runs(runs)
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
    for note in notes(runs):
        click.echo(f"note: {note}")
    click.echo(overview(runs, pending, allocation))
    click.echo(f"about {format_duration(total)} in total; nothing was run" if pending else "nothing was run")


def _forecast_lines(runs: list[PlannedRun], seconds: dict[Path, float]) -> Iterator[str]:
    width = max(len(run.name) for run in runs)
    for run in runs:
        time: Any = seconds.get(run.folder)
        cost = "finished" if time is None else f"about {format_duration(time)}"
        yield f"{run.name:{width}}  {run.discretization.most_points:10,} points  {run.steps:9,} steps  {cost}"


def _print_commands(runs: list[PlannedRun], out: Path, threads: int | None, quiet: bool) -> None:
    """Print the commands on stdout and messages on stderr, so that the commands can be piped."""
    from mpmcol.sweep.commands import SLURM_FILE, write_commands
    from mpmcol.sweep.plan import prepare_out, write_plan
    from mpmcol.sweep.runner import make_plan, pending_runs
    from mpmcol.sweep.scheduling import Allocation

    pending = pending_runs(runs)
    if not pending:
        click.echo("all runs are finished; for table and charts repeat the command without --engine", err=True)
        return
    allocation = Allocation(len(pending), threads or 1)
    write_plan(prepare_out(out), make_plan(runs, allocation))
    click.echo("\n".join(write_commands(pending, allocation.threads, out)))
    if not quiet:
        click.echo(f"{len(pending)} runs to execute; with Slurm: sbatch {out / SLURM_FILE}", err=True)
        click.echo("then, for table and charts, repeat the command without --engine", err=True)
